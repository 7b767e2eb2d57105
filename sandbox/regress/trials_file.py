"""The file of a run's trials, from which a stopped or killed run can be resumed.

The file is append-only. It has a head, and a JSON line for every trial that has ended. Each line is
written by one call, and is on the disk before the run waits for the next trial. Only the last line
can be incomplete.
"""

from __future__ import annotations

import json
import os
import stat
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from msgspec import Struct

from models.errors import InputError
from models.json_input import check_layout, checked, decoded, decoded_record
from models.plugins import place_file
from sandbox.devices.device import Closeable
from sandbox.recording.versions import (
    decisive_parts,
    program_root,
    source_digest,
    source_files,
    versions,
)
from sandbox.regress.execute import CRASHED, Trial
from sandbox.regress.run_plan import RegressionPlan, flat
from sandbox.system.files import OPEN, Release, lock

KIND = "trials of sandbox regress"
SCHEMA = 1
"""Version of the file format."""

_NAMES_ONLY = {"configuration.encoder", "configuration.settings.encoder"}
"""Entries that may differ: names of an encoder, such as a path. Its digest identifies it."""
_PACKAGES = ("models", "encoders", "tasks", "sandbox")
_ANEW = "Repeat the command of that run with --resume, or start again without --resume"

Key = tuple[str, str, int]
"""Variation, name of the task, and seed."""

_END = b'{"end": true}'
"""Last line of a complete run, written after its report."""


class _HeadLine(Struct):
    """The first line, without kind and schema: all values on which the results depend."""

    run: dict[str, Any]


class _StoredTrial(Struct):
    """Fields of a trial that are checked; other fields are kept unchecked."""

    task: str
    seed: int
    success: bool
    status: str
    progress: float
    reason: str
    time_s: float | None
    state_hash: str
    fingerprint: str


class _TrialLine(Struct):
    varied: str
    trial: _StoredTrial


def trials_path(output: Path) -> Path:
    """The file of trials next to a report: `report.trials.jsonl` for `report.json`."""
    return output.with_name(f"{output.stem}.trials.jsonl")


def identity(plan: RegressionPlan, vary: Sequence[str] = ()) -> dict[str, Any]:
    """Settings, seeds and program of a run, and all other values on which states depend.

    Runs with equal values have equal trials.

    Args:
        plan: Plan of the unvaried trials.
        vary: Words after `--vary`.
    """
    files, root = {}, program_root()
    sources = [path for name in _PACKAGES for path in source_files(root / name, below=True)]
    for task in plan.tasks:
        file = place_file(task) if isinstance(task, str) else None
        if file is not None:
            files[file.name] = source_digest([file], file.parent)
    return {
        "tasks": plan.versions(),
        "seeds": _ranges(plan.seeds),
        "vary": " ".join(vary),
        "configuration": plan.configuration(),
        # States depend on nothing else: another processor, NumPy or Python may resume a run.
        "depends_on": decisive_parts(versions()),
        "files": files,
        "source code": source_digest(sources, root),
    }


class TrialsFile(Closeable):
    """The trials of a run, in memory and in its file. The file is locked against other runs.

    Args:
        path: The file.
        run: See `identity`.
        resume: True continues with the trials in the file; False renames an unfinished file.

    Attributes:
        trials: The written trials, by variation, task and seed.
        crashed_before: Trials that crashed in the resumed run, to be run again.
        set_aside: New path of the renamed file of an earlier, unfinished run; None without one.

    Raises:
        InputError: The file cannot be written, or another run writes it. With `resume`: the file
            belongs to another run, or is damaged.
    """

    def __init__(self, path: Path, run: Mapping[str, Any], resume: bool = False) -> None:
        self.path, self._run = path, json.loads(json.dumps(run))
        self.trials: dict[Key, Trial] = {}
        self.crashed_before: list[Trial] = []
        self.set_aside: Path | None = None
        self._fd, self._release = _opened(path)
        try:
            if not stat.S_ISREG(os.fstat(self._fd).st_mode):
                raise InputError("this is not a plain file", where=str(path))
            data = path.read_bytes()
            if resume:
                self._resume(data)
            else:
                self._begin(data)
        except OSError as error:
            self.close()
            raise self._unwritten(error) from None
        except InputError:
            self.close()
            raise

    @property
    def has_crashes(self) -> bool:
        """True if a trial crashed, so that it has no result."""
        return any(t["status"] == CRASHED for t in self.trials.values())

    def ended(self, plan: RegressionPlan) -> list[Trial]:
        """Trials of the plan that have a result, in the order of its jobs."""
        trials = (self.trials.get((_varied(plan), job.name, job.seed)) for job in plan.jobs())
        return [t for t in trials if t is not None and t["status"] != CRASHED]

    def append(self, plan: RegressionPlan, trial: Trial) -> None:
        """Writes a trial that has ended.

        Raises:
            InputError: The trial cannot be written.
        """
        try:
            self._write(_json({"varied": _varied(plan), "trial": trial}))
        except OSError as error:
            raise self._unwritten(error) from None
        self.trials[_varied(plan), trial["task"], trial["seed"]] = trial

    def finish(self) -> None:
        """Marks the run as complete, with its report written. The next run may replace the file.

        Raises:
            InputError: The mark cannot be written.
        """
        try:
            self._write(_END)
        except OSError as error:
            raise self._unwritten(error) from None

    def close(self) -> None:
        """Closes the file, so that another run may write it."""
        if self._fd >= 0:
            self._release()
            os.close(self._fd)
            self._fd = -1

    def _resume(self, data: bytes) -> None:
        lines, cut = _lines(data)
        if lines:
            self._read(lines)
            if cut:
                # An incomplete line is not a trial. The next line must not be appended to it.
                os.ftruncate(self._fd, len(data) - len(cut))
        else:
            self._head(data)

    def _begin(self, data: bytes) -> None:
        if data and _lines(data)[0][-1:] != [_END]:
            self.set_aside = _aside(self.path)
            self.close()
            self._fd, self._release = _opened(self.path)
        self._head(data)

    def _head(self, data: bytes) -> None:
        if data:
            os.ftruncate(self._fd, 0)
        self._write(_json({"kind": KIND, "schema": SCHEMA, "run": self._run}))

    def _read(self, lines: list[bytes]) -> None:
        where = str(self.path)
        there, here = flat(_head_of(lines[0], where).run), flat(self._run)
        other = sorted(
            k for k in {*there, *here} - _NAMES_ONLY if there.get(k, "-") != here.get(k, "-")
        )
        if other:
            raise InputError(
                "these trials are from another run",
                where=where,
                got="; ".join(f"{_name(k)} {here.get(k, 'missing')}" for k in other[:4]),
                expected="; ".join(f"{_name(k)} {there.get(k, 'missing')}" for k in other[:4]),
                remedy=_ANEW,
            )
        for number, line in enumerate(lines[1:], start=2):
            if line == _END:
                continue
            varied, trial = _trial_of(line, f"{where}, line {number}")
            key = (varied, trial["task"], trial["seed"])
            # A crashed trial was run again. A trial with a result is never replaced.
            if self.trials.get(key, trial)["status"] == CRASHED or key not in self.trials:
                self.trials[key] = trial
        self.crashed_before = [t for t in self.trials.values() if t["status"] == CRASHED]

    def _write(self, line: bytes) -> None:
        line += b"\n"
        before = os.fstat(self._fd).st_size
        try:
            written = os.write(self._fd, line)
            if written < len(line):
                # The disk is full: writing the rest raises the error.
                os.write(self._fd, line[written:])
            os.fsync(self._fd)
        except OSError:
            with suppress(OSError):
                os.ftruncate(self._fd, before)
            raise

    def _unwritten(self, error: OSError) -> InputError:
        return InputError(
            "the file of trials cannot be written",
            where=str(self.path),
            got=error.strerror,
            remedy="Make room on the disk or choose another place; --resume continues with the "
            "written trials",
        )


def _opened(path: Path) -> tuple[int, Release]:
    """The file, locked until it is closed or the program ends in any way."""
    while True:
        try:
            fd = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | OPEN, 0o666)
        except OSError as error:
            raise InputError(
                "the file of trials cannot be written", where=str(path), got=error.strerror
            ) from None
        try:
            release = lock(fd, path, wait=False)
        except OSError as error:
            os.close(fd)
            raise InputError(
                "the file cannot be locked", where=str(path), got=error.strerror
            ) from None
        if release is None:
            os.close(fd)
            raise InputError(
                "another run writes its trials here",
                where=str(path),
                remedy="Wait until it ends, or give another file with --json",
            )
        if path.exists() and os.path.samestat(path.stat(), os.fstat(fd)):
            return fd, release
        # Another run renamed the file between the two calls.
        release()
        os.close(fd)


def _lines(data: bytes) -> tuple[list[bytes], bytes]:
    """Pair (complete lines, the incomplete last line that a killed program has left)."""
    *lines, cut = data.split(b"\n")
    return lines, cut


def _head_of(line: bytes, where: str) -> _HeadLine:
    what = "not the trials of a run of `sandbox regress`"
    check_layout(line, KIND, SCHEMA, InputError, what=what, where=where, remedy=_ANEW)
    return decoded(line, _HeadLine, InputError, what=what, where=where, remedy=_ANEW)


def _trial_of(line: bytes, where: str) -> tuple[str, Trial]:
    """Pair (the variation, the trial)."""
    what = "this file of trials is damaged"
    remedy = "Start again without --resume"
    values = decoded_record(line, InputError, what=what, where=where, remedy=remedy)
    checked(values, _TrialLine, InputError, what=what, where=where, remedy=remedy)
    return values["varied"], values["trial"]


def _json(value: dict[str, Any]) -> bytes:
    return json.dumps(value).encode()


def _aside(path: Path) -> Path:
    """Renames a file to a free name, and returns the new path."""
    base = path.name.removesuffix(".trials.jsonl")
    number = 1
    while (kept := path.with_name(f"{base}.unfinished-{number}.trials.jsonl")).exists():
        number += 1
    path.rename(kept)
    return kept


def _varied(plan: RegressionPlan) -> str:
    return str(plan.scene.get("vary", ""))


def _ranges(seeds: Sequence[int]) -> str:
    """Sorted seeds, in the form of `--seeds`."""
    parts: list[list[int]] = []
    for seed in sorted(seeds):
        if parts and parts[-1][1] == seed:
            parts[-1][1] = seed + 1
        else:
            parts.append([seed, seed + 1])
    return ",".join(f"{a}:{b}" for a, b in parts)


def _name(key: str) -> str:
    return key.removeprefix("configuration.")
