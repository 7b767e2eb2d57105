"""After a power cut, all that was acknowledged is on the disk: what was flushed, and no more."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sandbox.study.record.copies import JOURNAL
from sandbox.study.record.journal import read_journal
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.trial_files import recording_digest
from tests.support.study_driver import results, resume, run, verify
from tests.support.study_files import SHORT

DURABLE = ("consent", "answer", "form", "trial_end")
"""Kinds of records that a participant has acknowledged once they are written."""
Image = tuple[dict[Path, dict[str, int]], dict[int, bytes]]
"""A disk: numbers of files by name in each folder, and contents by number."""


class Disk:
    """What is on a disk if the power fails now: contents that were flushed, under names that were.

    A name is on the disk once its folder was flushed; a content once its file was. The order in
    which a disk writes what was not flushed is not known, so none of it is there.

    Args:
        root: Folder on the disk.
    """

    def __init__(self, root: Path) -> None:
        self._root = root
        self._names: dict[Path, dict[str, int]] = {}
        self._contents: dict[int, bytes] = {}

    def watched(self, flush: Callable[[int], None]) -> Callable[[int], None]:
        """A flush of the system that this disk sees."""

        def flushed(fd: int) -> None:
            flush(fd)
            path = Path(os.readlink(f"/proc/self/fd/{fd}"))
            if path.is_dir():
                self._names[path] = {p.name: p.stat().st_ino for p in path.iterdir()}
            else:
                number = os.fstat(fd).st_ino
                self._contents[number] = Path(f"/proc/self/fd/{fd}").read_bytes()

        return flushed

    def image(self) -> Image:
        """What is on the disk now."""
        return {folder: dict(names) for folder, names in self._names.items()}, dict(self._contents)

    def restore(self, image: Image, to: Path) -> None:
        """Makes the folder as the disk has it."""
        names, contents = image
        waiting = [(self._root, to)]
        while waiting:
            folder, copy = waiting.pop()
            copy.mkdir(parents=True, exist_ok=True)
            for name, number in names.get(folder, {}).items():
                if folder / name in names or (folder / name).is_dir():
                    waiting.append((folder / name, copy / name))
                else:
                    (copy / name).write_bytes(contents.get(number, b""))


@pytest.mark.skipif(not os.path.exists("/proc/self/fd"), reason="files have no names by number")
def test_everything_that_was_acknowledged_survives_a_power_cut(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Answers were on the disk after half a second; new folders only with what came later."""
    real = (tmp_path / "real").resolve()
    real.mkdir()
    disk, images = Disk(real), list[tuple[Image, dict[str, Any]]]()
    for name in ("fsync", "fdatasync"):
        monkeypatch.setattr(os, name, disk.watched(getattr(os, name)))
    write = SessionFolder.write

    def acknowledged(self: SessionFolder, kind: str, *args: Any, **values: Any) -> Any:
        record = write(self, kind, *args, **values)
        if kind in DURABLE:
            images.append((disk.image(), record))
        return record

    monkeypatch.setattr(SessionFolder, "write", acknowledged)
    monkeypatch.setattr("sandbox.study.run.forms.SimulatedForms.ask", one_by_one)
    folder = run(real, SHORT)
    monkeypatch.undo()
    assert {record["kind"] for _, record in images} == set(DURABLE)
    whole = results(folder)
    for number, (image, record) in enumerate(images):
        out = tmp_path / f"after {number}"
        disk.restore(image, out)
        (journal,) = (out / folder.name).glob(f"*/S001/{JOURNAL}")
        assert record in read_journal(journal), f"{record['kind']} of {record.get('step')} is lost"
        if record["kind"] == "trial_end":
            assert recording_digest(journal.parent / record["file"]) == record["recording"]
        if number % 3 == 0:
            resume(out / folder.name, SHORT)
            assert results(out / folder.name) == whole
            assert verify(out / folder.name) == []


def one_by_one(self: Any, form: Any, language: str, poll: Any, draft: Any) -> dict[str, Any]:
    """Answers as a person gives them, each by itself."""
    for item in form.items:
        draft.store(item.name, self._answer(draft.step or form.name, item))
    return dict(draft.answers)
