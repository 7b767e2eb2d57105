"""A mirror on a second disk: a copy of every record and recording of a session.

A separate thread copies new data twice a second, and the session never waits for this thread. If
the mirror cannot be written, or its disk hangs, the terminal shows the number of missing bytes, and
the thread copies them as soon as it can.
"""

from __future__ import annotations

import shutil
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

from models.errors import StudyError
from sandbox.devices.device import Closeable
from sandbox.recording.recording import SUFFIX
from sandbox.study.record.durable_files import LOCK_FILES, TEMPORARY
from sandbox.study.record.folder import DESIGN_FILE
from sandbox.study.record.journal import SYNC
from sandbox.study.record.notes import NOTES

LAST = 5.0
"""Longest time that the end of a session waits for the mirror to catch up, s."""


class Mirror(Closeable):
    """Copies a person's folder, and the notes and design of the study, while a session runs.

    Args:
        study: Folder of the study.
        ppid: Pseudonym of the person.
        to: Folder on the second disk; the mirror is a folder in it with the study's name.
        say: Prints a line for the experimenter.

    Raises:
        StudyError: The mirror would be the study's own folder.

    Attributes:
        behind: Number of bytes that were missing in the mirror at the last attempt to copy.
    """

    def __init__(self, study: Path, ppid: str, to: Path, say: Callable[[str], object]) -> None:
        self._study, self._ppid, self._to, self._say = study, ppid, to / study.name, say
        if self._to.resolve() == study.resolve():
            raise StudyError(
                "the mirror is the folder of the study itself",
                where="--mirror",
                got=str(to),
                remedy="Choose a folder on another disk",
            )
        self._done: dict[Path, tuple[int, int]] = {}
        self.behind = 0
        self._failed = ""
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, name="mirror", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Copies the remaining data, and prints what could not be copied."""
        self._end.set()
        self._thread.join(LAST)
        if self._thread.is_alive() or self.behind:
            self._say(
                f"the mirror in {self._to} is {max(self.behind, 1)} bytes or more behind: copy "
                f"{self._study / self._ppid} by hand"
            )

    def _run(self) -> None:
        ended = False
        while not ended:
            # After `close`, copy once more: all data are written by then.
            ended = self._end.wait(SYNC)
            self._copy_all()

    def _copy_all(self) -> None:
        failed, behind = "", 0
        for path in self._sources():
            try:
                state = path.stat()
                if self._done.get(path) != (state.st_size, state.st_mtime_ns):
                    self._copy(path, state.st_size)
                    self._done[path] = (state.st_size, state.st_mtime_ns)
            except FileNotFoundError:
                # The recording was compressed meanwhile. Its compressed file is copied next time.
                continue
            except OSError as error:
                failed = failed or (error.strerror or str(error))
                behind += state.st_size - self._done.get(path, (0, 0))[0]
        self.behind = behind
        if failed and failed != self._failed:
            self._say(f"the mirror is {behind} bytes behind ({failed}); the session goes on")
        elif self._failed and not failed:
            self._say("the mirror has caught up")
        self._failed = failed

    def _sources(self) -> Iterator[Path]:
        yield self._study / DESIGN_FILE
        yield from sorted((self._study / NOTES).glob("*.jsonl"))
        for path in sorted((self._study / self._ppid).rglob("*")):
            ours = path.name not in LOCK_FILES and not path.name.startswith(TEMPORARY)
            if ours and path.is_file():
                yield path

    def _copy(self, path: Path, size: int) -> None:
        """Copies a file, or the data appended since the last copy."""
        copy = self._to / path.relative_to(self._study)
        copy.parent.mkdir(parents=True, exist_ok=True)
        there = copy.stat().st_size if copy.exists() else 0
        grows = path.suffix == ".jsonl" and self._done.get(path, (0, 0))[0] == there > 0
        if grows and there <= size:
            with path.open("rb") as source, copy.open("ab") as target:
                source.seek(there)
                target.write(source.read())
        else:
            part = copy.with_name(f"{TEMPORARY}{copy.name}")
            shutil.copyfile(path, part)
            part.replace(copy)
        if copy.name.endswith(SUFFIX):
            # The uncompressed copy of a compressed recording is removed.
            with suppress(FileNotFoundError):
                copy.with_name(copy.name.removesuffix(SUFFIX)).unlink()
