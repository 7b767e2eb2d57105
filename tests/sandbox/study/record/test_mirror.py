"""A second disk has everything that the first has, and its failure costs the session nothing."""

from __future__ import annotations

import shutil
import threading
import time
from pathlib import Path

import pytest

from sandbox.study.record import mirror as module
from sandbox.study.record.mirror import Mirror
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.run.simulated_study import run_simulated, simulated_person
from tests.support.processes import until
from tests.support.study_files import open_study, quiet


def files(study: Path, ppid: str) -> dict[str, bytes]:
    """What a mirror must have."""
    paths = [*(study / "notes").glob("*"), study / "design.toml", *(study / ppid).rglob("*")]
    return {
        path.relative_to(study).as_posix(): path.read_bytes()
        for path in paths
        if path.is_file() and path.name != ".lock"
    }


def test_a_mirror_has_every_file_of_a_person_after_a_session(tmp_path: Path) -> None:
    study = open_study(tmp_path / "first")
    person = study.add(1, **simulated_person(study.design, 1))
    said: list[str] = []
    with Mirror(study.path, person.ppid, tmp_path / "second", said.append):
        run_simulated(study, 1, quiet)
    assert files(tmp_path / "second" / study.path.name, person.ppid) == files(
        study.path, person.ppid
    )
    assert said == []


def test_a_mirror_that_fails_is_told_once_and_catches_up_and_the_record_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = open_study(tmp_path / "first")
    person, said = study.add(), list[str]()
    full = threading.Event()
    copyfile = shutil.copyfile

    def copy(source: Path, target: Path) -> object:
        if full.is_set():
            raise OSError(28, "No space left on device")
        return copyfile(source, target)

    monkeypatch.setattr(shutil, "copyfile", copy)
    full.set()
    with (
        Mirror(study.path, person.ppid, tmp_path / "second", said.append) as mirror,
        SessionFolder(study, person) as session,
    ):
        session.command("note", text="the disk is full")
        until(lambda: bool(said))
        session.command("note", text="and the session goes on")
        full.clear()
        until(lambda: "the mirror has caught up" in said)
        # What is added to a file is added to its copy.
        session.command("note", text="as before")
    assert mirror.behind == 0 and "bytes behind (No space left on device)" in said[0]
    assert len(said) == 2
    copied = tmp_path / "second" / study.path.name
    assert files(copied, person.ppid) == files(study.path, person.ppid)


def test_a_mirror_that_hangs_delays_nothing_and_is_named_at_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = open_study(tmp_path / "first")
    person, said, hangs = study.add(), list[str](), threading.Event()
    monkeypatch.setattr(shutil, "copyfile", lambda *paths: hangs.wait())
    monkeypatch.setattr(module, "LAST", 0.1)
    began = time.monotonic()
    with Mirror(study.path, person.ppid, tmp_path / "second", said.append):
        time.sleep(0.6)
        with SessionFolder(study, person) as session:
            session.command("note", text="nothing waits")
    assert time.monotonic() - began < 5.0
    assert "behind: copy" in said[-1]
    hangs.set()
