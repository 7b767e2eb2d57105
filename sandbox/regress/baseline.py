"""The baseline file: results of an earlier run, one line per trial, readable in a diff."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from msgspec import Struct, structs, to_builtins

from models.errors import InputError
from models.json_input import check_layout, decoded, read_bytes
from sandbox.regress.execute import CRASHED, Trial
from sandbox.regress.run_plan import ENCODER, Origin, flat, setting_of
from sandbox.system.files import OPEN, Release, lock, resolved, write_whole
from sandbox.trial.result import ResultRecord, record_fields

SCHEMA = 2
"""Version of the file format."""
KIND = "baseline of sandbox regress"
HEAD = 200
"""Number of bytes at the beginning of a baseline that contain its kind."""
_NAMED = 4
"""Largest number of changed defaults listed in a message."""
ANEW = "--update-baseline (in pytest --sandbox-update-baseline) replaces the baseline"
"""Remedy in errors about a baseline that cannot be compared."""


class BaselineTrial(Struct, frozen=True, array_like=True):
    """A trial in a baseline. The file stores the values of the fields in this order.

    Attributes:
        success, progress, time_s, state_hash: Fields of the trial's result.
        measures: Further measures by name (`sandbox.regress.compared_measures`); empty in an early
            baseline without them.
    """

    success: bool
    progress: float
    time_s: float
    state_hash: str
    measures: dict[str, float] = {}

    def values(self) -> dict[str, Any]:
        """Returns the fields by name, in the form of a run's trials."""
        return structs.asdict(self)


@dataclass(frozen=True)
class BaselineTask:
    """A task's results in a baseline.

    Attributes:
        version: Version of the task.
        fingerprint: Fingerprint of the versions on which states depend; empty if trials had
            different fingerprints.
        depends_on: Parts of the fingerprint, by the names of `versions.DECISIVE`; empty if unknown.
        trials: Results by seed.
        repeats: Second results of some seeds, with a harmless change. They measure churn
            (`sandbox.regress.detectable_changes`).
        vary: The variation; empty in the plain arm.
    """

    version: int
    fingerprint: str
    trials: Mapping[int, BaselineTrial]
    depends_on: Mapping[str, str] = field(default_factory=dict)
    repeats: Mapping[int, BaselineTrial] = field(default_factory=dict)
    vary: str = ""


class _TaskLines(Struct):
    """A task in a baseline's file; trials by seed."""

    version: int
    fingerprint: str
    trials: dict[int, BaselineTrial]
    depends_on: dict[str, str] = {}
    repeats: dict[int, BaselineTrial] = {}
    vary: str = ""


class _BaselineFile(Struct):
    """The fields of a baseline's file after its head."""

    given: dict[str, Any]
    program: dict[str, Any]
    tasks: dict[str, _TaskLines]
    settings: dict[str, Any] = {}


@dataclass(frozen=True)
class Baseline:
    """Results of an earlier run.

    Attributes:
        origin: Settings, models and program of the run.
        tasks: Tasks by name.
        path: Path of the file.
    """

    origin: Origin
    tasks: Mapping[str, BaselineTask] = field(default_factory=dict)
    path: Path = Path("baseline")

    def check(
        self,
        origin: Origin,
        versions: Mapping[str, int],
        across_encoders: bool = False,
        exact: bool = False,
    ) -> None:
        """Checks that a run can be compared with this baseline.

        Another program, other models and other `STATES` are allowed, unless `exact` is true; see
        `differing_program`.

        Args:
            origin: Settings, models and program of the run.
            versions: Versions of its tasks.
            across_encoders: True allows another encoder.
            exact: True requires a program whose states can equal those of the baseline.

        Raises:
            InputError: The encoder, the version of a task or given settings differ; run and
                baseline have no task in common; or `exact` is true and the programs' states differ.
        """
        there, here = flat(self.origin.given), flat(origin.given)
        ignored = {ENCODER} if across_encoders else set()
        other = [
            k for k in sorted({*there, *here} - ignored) if there.get(k, "-") != here.get(k, "-")
        ]
        if other:
            what = "another encoder" if ENCODER in other else "other settings"
            raise InputError(
                f"this baseline was made with {what}",
                where=str(self.path),
                got="; ".join(_setting(k, here) for k in other[:4]),
                expected="; ".join(_setting(k, there) for k in other[:4]),
                remedy=f"Results with different settings cannot be compared. Run with the settings "
                f"of the baseline, or use another file for these settings; {ANEW}"
                + ("; --across-encoders compares two encoders" if other == [ENCODER] else ""),
            )
        if exact and (differing := self.differing_program(origin)):
            raise InputError(
                "states cannot be equal, since the program or its models differ",
                where=f"--exact, {self.path}",
                got=differing,
                remedy=f"Leave out --exact; {ANEW}",
            )
        for name in set(self.tasks) & set(versions):
            if self.tasks[name].version != versions[name]:
                raise InputError(
                    f"this baseline was made with another version of {name}",
                    where=str(self.path),
                    got=f"version {versions[name]}",
                    expected=f"version {self.tasks[name].version}, as in the baseline",
                    remedy=f"Results of two versions of a task cannot be compared; {ANEW}",
                )
        if not set(self.tasks) & set(versions):
            raise InputError(
                "this baseline has none of these tasks",
                where=str(self.path),
                got=", ".join(versions),
                expected=", ".join(self.tasks) or "no task",
                remedy="--update-baseline adds them",
            )

    def differing_program(self, origin: Origin) -> str:
        """Returns a clause that names both programs if their states cannot be equal.

        The clause is empty if `STATES` and models are equal.
        """
        if self.origin.decides_states == origin.decides_states:
            return ""
        models = self.origin.program.get("models") != origin.program.get("models")
        other = " with other models" if models else ""
        return f"the baseline was made by {self.origin}{other}, this run by {origin}"

    def changed_defaults(self, origin: Origin) -> str:
        """Returns a clause that lists the settings with changed defaults, with both values.

        Settings that the user gave, now or for the baseline, are left out.
        """
        there, here = flat(self.origin.settings), flat(origin.settings)
        given = {*flat(self.origin.given), *flat(origin.given)}
        changed = [
            name
            for name in here
            if name in there and name not in given and here[name] != there[name]
        ]
        values = (f"{name} is {here[name]}, was {there[name]}" for name in changed[:_NAMED])
        more = f" and {len(changed) - _NAMED} more" if len(changed) > _NAMED else ""
        return f"defaults have changed since: {'; '.join(values)}{more}" if changed else ""

    def check_seeds(self, names: Sequence[str], seeds: Sequence[int]) -> None:
        """Checks that the baseline has at least one of the run's seeds.

        Raises:
            InputError: The baseline has none of the seeds.
        """
        kept = {seed for name in names if name in self.tasks for seed in self.tasks[name].trials}
        if not kept & set(seeds):
            raise InputError(
                "this baseline has none of these seeds",
                where=str(self.path),
                got=f"{len(kept)} seeds, {min(kept, default=0)} to {max(kept, default=0)}",
                remedy="Run its seeds, or --update-baseline",
            )

    def updated(
        self,
        origin: Origin,
        versions: Mapping[str, int],
        trials: Sequence[Trial],
        repeats: Sequence[Trial] = (),
    ) -> Baseline:
        """Returns the baseline with the run's tasks replaced by the trials of the run.

        Other tasks stay if they have the same settings, states and models, and are removed
        otherwise.

        Args:
            origin: Settings, models and program of the run.
            versions: Versions of the run's tasks.
            trials: Trials of the run.
            repeats: Trials of some of its seeds with a harmless change, which measure churn.

        Raises:
            InputError: A trial has no result.
        """
        lacking = [f"{t['task']} {t['seed']}" for t in trials if t["status"] == CRASHED]
        if lacking:
            raise InputError(
                "a baseline cannot be written from trials that crashed",
                where=str(self.path),
                got=", ".join(lacking[:8]),
            )
        same = flat(self.origin.given) == flat(origin.given)
        same = same and self.origin.decides_states == origin.decides_states
        tasks = dict(self.tasks) if same else {}
        for name, version in versions.items():
            own = [t for t in trials if t["task"] == name]
            one_machine = len({t["fingerprint"] for t in own}) == 1
            tasks[name] = BaselineTask(
                version,
                own[0]["fingerprint"] if one_machine else "",
                {t["seed"]: _of_trial(t) for t in own},
                own[0]["depends_on"] if one_machine else {},
                {t["seed"]: _of_trial(t) for t in repeats if _repeats(t, name)},
                setting_of(name),
            )
        return Baseline(origin, tasks, self.path)

    def text(self) -> str:
        """Returns the text of the file: JSON with a line for every trial."""
        tasks = []
        for name, task in self.tasks.items():
            rows, again = (
                ",\n".join(
                    f"    {json.dumps(str(seed))}: " + json.dumps(to_builtins(k))
                    for seed, k in sorted(some.items())
                )
                for some in (task.trials, task.repeats)
            )
            repeats = f'   "repeats": {{\n{again}\n   }},\n' if again else ""
            vary = f'   "vary": {json.dumps(task.vary)},\n' if task.vary else ""
            tasks.append(
                f'  {json.dumps(name)}: {{\n   "version": {task.version},\n'
                f'   "fingerprint": {json.dumps(task.fingerprint)},\n'
                f'   "depends_on": {json.dumps(dict(task.depends_on))},\n'
                f'{vary}{repeats}   "trials": {{\n{rows}\n   }}\n  }}'
            )
        given, settings, program = (
            json.dumps(part, indent=1, sort_keys=True).replace("\n", "\n ")
            for part in (self.origin.given, self.origin.settings, self.origin.program)
        )
        return (
            f'{{\n "kind": {json.dumps(KIND)},\n "schema": {SCHEMA},\n "given": {given},\n'
            f' "settings": {settings},\n "program": {program},\n "tasks": {{\n'
            + ",\n".join(tasks)
            + "\n }\n}\n"
        )

    def save(self) -> None:
        """Writes the file atomically.

        Raises:
            InputError: The file cannot be written.
        """
        write_whole(self.path, self.text(), "--baseline")


def _repeats(trial: Trial, name: str) -> bool:
    return trial["task"] == name and trial["status"] != CRASHED


def _of_trial(trial: Trial) -> BaselineTrial:
    fields = {name: trial[name] for name in record_fields(ResultRecord.BASELINE)}
    return BaselineTrial(**fields, measures=trial.get("measures") or {})


def load_baseline(path: Path) -> Baseline:
    """Reads a baseline.

    Raises:
        InputError: The file is missing, is not a baseline, is damaged, or is of another version.
    """
    if not path.exists():
        raise InputError(
            "no such baseline",
            where=str(path),
            remedy="--update-baseline writes it from this run",
        )
    where = str(path)
    data = read_bytes(path, InputError, what="the baseline cannot be read")
    check_layout(
        data,
        KIND,
        SCHEMA,
        InputError,
        what="not a baseline of `sandbox regress`",
        where=where,
        remedy=ANEW,
    )
    document = decoded(
        data,
        _BaselineFile,
        InputError,
        what="this baseline is damaged",
        where=where,
        remedy="Restore it from version control, or replace it with --update-baseline",
    )
    tasks = {
        name: BaselineTask(
            task.version,
            task.fingerprint,
            task.trials,
            task.depends_on,
            task.repeats,
            task.vary,
        )
        for name, task in document.tasks.items()
    }
    return Baseline(Origin(document.given, document.program, document.settings), tasks, path)


def replaceable(path: Path) -> Baseline | None:
    """Returns the baseline in a file that may be replaced; None if it is missing or unreadable.

    Raises:
        InputError: The file is not a baseline, and must not be replaced.
    """
    if not path.exists():
        return None
    what = "the baseline cannot be read"
    # Reading a pipe would wait for its writer.
    if not (path.is_file() and _is_ours(read_bytes(path, InputError, what=what))):
        raise InputError(
            "this file is no baseline, so it is not replaced",
            where=str(path),
            expected="a file that --update-baseline wrote, or a new file",
            remedy="Name another file, or remove this file",
        )
    try:
        return load_baseline(path)
    except InputError:
        # A baseline that is damaged or of another version is replaced.
        return None


def _is_ours(data: bytes) -> bool:
    """True for an empty file, and for a file with the kind of a baseline, even if it is damaged."""
    try:
        document = json.loads(data)
    except (ValueError, RecursionError):
        # The file was cut, or two versions were merged into it; its first lines have its kind.
        return not data.strip() or json.dumps(KIND).encode() in data[:HEAD]
    return isinstance(document, dict) and document.get("kind") == KIND


def update(
    path: Path,
    origin: Origin,
    versions: Mapping[str, int],
    trials: Sequence[Trial],
    repeats: Sequence[Trial] = (),
) -> Baseline:
    """Writes the trials of a run into a baseline file. Other tasks in the file stay.

    The file is read again before it is written, since another run may have added its tasks; see
    `Baseline.updated`.

    Raises:
        InputError: A trial has no result, the file is not a baseline, or it cannot be written.
    """
    with _alone(resolved(path, "--baseline")):
        old = replaceable(path) or Baseline(origin, {}, path)
        new = old.updated(origin, versions, trials, repeats)
        new.save()
    return new


@contextmanager
def _alone(path: Path) -> Iterator[None]:
    """Waits until no other run writes a file, and locks it by a lock file beside it."""
    beside = path.with_name(f".{path.name}.lock")
    try:
        while True:
            fd = os.open(beside, os.O_RDWR | os.O_CREAT | OPEN, 0o666)
            release = lock(fd, beside, wait=True)
            with suppress(FileNotFoundError):
                if os.path.samestat(beside.stat(), os.fstat(fd)):
                    break
            # The previous run has removed the lock file between the two calls.
            _end(fd, release)
    except OSError as error:
        raise InputError("the file cannot be locked", where=str(path), got=error.strerror) from None
    try:
        yield
    finally:
        # Windows cannot remove an open file. A remaining lock file does no harm.
        with suppress(OSError):
            beside.unlink()
        _end(fd, release)


def _end(fd: int, release: Release | None) -> None:
    if release is not None:
        release()
    os.close(fd)


def _setting(name: str, given: Mapping[str, Any]) -> str:
    """Returns a setting with its value, for messages."""
    return f"{name} {given[name]}" if name in given else f"{name} left to its default"
