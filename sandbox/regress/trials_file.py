"""The file of a run's trials, from which a stopped or killed run can be resumed.

It is append-only: a head, and a JSON line for every trial that has ended. Each line is one write,
which is on the disk before the next trial is awaited. Only the last line can be cut.
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
"""Version of the file's layout."""

_NAMES_ONLY = {"configuration.encoder", "configuration.settings.encoder"}
"""Names of an encoder, such as its file's path; its digest identifies it."""
_PACKAGES = ("models", "encoders", "tasks", "sandbox")
_ANEW = "Repeat that run's command with --resume, or leave --resume out and begin anew"

Key = tuple[str, str, int]
"""The variation, the task's name and the seed."""

_END = b'{"end": true}'
"""Last line of a run whose report has all of its trials."""


class _HeadLine(Struct):
    """All values on which the results depend; the first line has them after kind and schema."""

    run: dict[str, Any]


class _StoredTrial(Struct):
    """Fields of a trial that are read; others are kept as they are."""

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
    """Settings, seeds and program of a run, and all else on which states depend. Runs with equal
    values have equal trials.

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
    """The trials of a run, in memory and in its file, which no other run can write meanwhile.

    Args:
        path: The file.
        run: See `identity`.
        resume: True goes on from the trials that the file has; false sets an unfinished file aside.

    Attributes:
        trials: The trials that are written, by what is varied, task and seed.
        crashed_before: Trials that crashed in the run that is resumed, to be run again.
        set_aside: Where the trials of an earlier, unfinished run are now.

    Raises:
        InputError: The file cannot be written, another run writes it, or it is to be resumed and
            belongs to another run or is damaged.
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
        """True if a trial has no result."""
        return any(t["status"] == CRASHED for t in self.trials.values())

    def ended(self, plan: RegressionPlan) -> list[Trial]:
        """Trials of the plan that have a result, in the order of its jobs."""
        trials = (self.trials.get((_varied(plan), job.name, job.seed)) for job in plan.jobs())
        return [t for t in trials if t is not None and t["status"] != CRASHED]

    def append(self, plan: RegressionPlan, trial: Trial) -> None:
        """Writes a trial that has ended.

        Raises:
            InputError: It cannot be written.
        """
        try:
            self._write(_json({"varied": _varied(plan), "trial": trial}))
        except OSError as error:
            raise self._unwritten(error) from None
        self.trials[_varied(plan), trial["task"], trial["seed"]] = trial

    def finish(self) -> None:
        """Notes that all trials have ended and are in the report: the next run replaces the file.

        Raises:
            InputError: It cannot be written.
        """
        try:
            self._write(_END)
        except OSError as error:
            raise self._unwritten(error) from None

    def close(self) -> None:
        """Closes the file, which another run may then write."""
        if self._fd >= 0:
            self._release()
            os.close(self._fd)
            self._fd = -1

    def _resume(self, data: bytes) -> None:
        lines, cut = _lines(data)
        if lines:
            self._read(lines)
            if cut:
                # A cut line is not a trial; the next line must not be appended to it.
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
                "these trials are another run's",
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
            # A crashed trial was run again; a trial with a result keeps it.
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
            "trials cannot be written here",
            where=str(self.path),
            got=error.strerror,
            remedy="Make room or choose another place; --resume goes on from what is written",
        )


def _opened(path: Path) -> tuple[int, Release]:
    """The file, locked until it is closed or the program ends in any way."""
    while True:
        try:
            fd = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | OPEN, 0o666)
        except OSError as error:
            raise InputError(
                "trials cannot be written here", where=str(path), got=error.strerror
            ) from None
        try:
            release = lock(fd, path, wait=False)
        except OSError as error:
            os.close(fd)
            raise InputError("no lock can be had", where=str(path), got=error.strerror) from None
        if release is None:
            os.close(fd)
            raise InputError(
                "another run writes its trials here",
                where=str(path),
                remedy="Wait until it ends, or give this one another --json FILE",
            )
        if path.exists() and os.path.samestat(path.stat(), os.fstat(fd)):
            return fd, release
        # Another run set it aside between the two calls.
        release()
        os.close(fd)


def _lines(data: bytes) -> tuple[list[bytes], bytes]:
    """Pair (whole lines, the part of a last line that a killed program has left)."""
    *lines, cut = data.split(b"\n")
    return lines, cut


def _head_of(line: bytes, where: str) -> _HeadLine:
    what = "not the trials of a run of `sandbox regress`"
    check_layout(line, KIND, SCHEMA, InputError, what=what, where=where, remedy=_ANEW)
    return decoded(line, _HeadLine, InputError, what=what, where=where, remedy=_ANEW)


def _trial_of(line: bytes, where: str) -> tuple[str, Trial]:
    """Pair (the variation, the trial)."""
    what = "this file of trials is damaged"
    remedy = "Leave --resume out and begin anew"
    values = decoded_record(line, InputError, what=what, where=where, remedy=remedy)
    checked(values, _TrialLine, InputError, what=what, where=where, remedy=remedy)
    return values["varied"], values["trial"]


def _json(value: dict[str, Any]) -> bytes:
    return json.dumps(value).encode()


def _aside(path: Path) -> Path:
    """Renames a file so that its content stays."""
    base = path.name.removesuffix(".trials.jsonl")
    number = 1
    while (kept := path.with_name(f"{base}.unfinished-{number}.trials.jsonl")).exists():
        number += 1
    path.rename(kept)
    return kept


def _varied(plan: RegressionPlan) -> str:
    return str(plan.scene.get("vary", ""))


def _ranges(seeds: Sequence[int]) -> str:
    """Seeds in order, as `--seeds` takes them."""
    parts: list[list[int]] = []
    for seed in sorted(seeds):
        if parts and parts[-1][1] == seed:
            parts[-1][1] = seed + 1
        else:
            parts.append([seed, seed + 1])
    return ",".join(f"{a}:{b}" for a, b in parts)


def _name(key: str) -> str:
    return key.removeprefix("configuration.")
