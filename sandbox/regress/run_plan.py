"""Plan of a regression run: tasks, seeds, and one configuration for all trials.

`Origin` holds everything that determines the results of a run, besides tasks and seeds: the
settings that the user gave, and the program.
"""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from encoders.regression.model_registry import MODELS
from models.errors import InputError
from models.plugins import failure
from sandbox.recording.versions import STATES, versions
from sandbox.trial.assembly import digests, drawn
from sandbox.trial.settings import Settings, encoded
from sandbox.trial.trial_options import SecondOptions, TrialOptions, trial_settings
from tasks.registry import TASKS, claim_name, find_task, is_built_in, task_names
from tasks.task import Task

PLAIN, HARD = "plain", "hard"
ARMS = {PLAIN: (PLAIN,), HARD: (HARD,), "both": (PLAIN, HARD)}
"""Value of `--arm` -> the selected arms."""

HARD_SETTINGS: dict[str, str] = {
    "box-to-goal": "size=0.51",
    "wrench-turn": "size=0.7",
    "wrench-slide": "size=0.44",
    "stack": "size=0.6",
    "stack-three": "size=0.63",
    "stack-vertical": "size=0.27",
    "carry-together": "size=0.675",
    "slalom": "size=0.64",
    "chords": "size=0.7",
    "dial": "size=0.71",
    "gather": "room=0.73",
    "books": "size=0.655",
    "insert": "room=0.15",
    "close-case": "friction=0.37",
    "single-keys": "size=0.5",
}
"""Variation in the hard arm (`--vary`), by task."""

_HARD_MARK = f" ({HARD})"


def row_name(task: str, arm: str) -> str:
    """Name of a task in an arm, in reports and baselines: `stack`, `stack (hard)`."""
    return task + _HARD_MARK if arm == HARD else task


def arm_of(row: str) -> str:
    """Arm of a row by its name."""
    return HARD if row.endswith(_HARD_MARK) else PLAIN


def setting_of(row: str) -> str:
    """Variation in a row's trials; empty in the plain arm."""
    return HARD_SETTINGS.get(row.removesuffix(_HARD_MARK), "") if arm_of(row) == HARD else ""


ALL = "all"
"""Name that selects every task of the registry."""
MOST_SEEDS = 100_000
"""Largest number of seeds in a range. A larger range was probably mistyped, and is refused."""


@dataclass(frozen=True)
class TrialJob:
    """One trial to run, in any process.

    Attributes:
        settings: Settings of the trial.
        record: Folder for a recording of the trial; None does not record.
        own_task: The task's class if it is not in the registry.
        record_all: False removes the recording of a successful trial.
        arm: Arm of the trial.
    """

    settings: Settings
    record: Path | None = None
    own_task: type[Task] | None = None
    record_all: bool = False
    arm: str = PLAIN

    @property
    def recording(self) -> Path | None:
        """Path of the recording; None if the trial is not recorded."""
        return None if self.record is None else self.record / file_name(self.name, self.seed)

    @property
    def name(self) -> str:
        """Name of the task in its arm."""
        return row_name(
            self.own_task.name if self.own_task else _name(self.settings.task), self.arm
        )

    @property
    def seed(self) -> int:
        """Seed of the trial."""
        return self.settings.seed


@dataclass(frozen=True)
class Row:
    """A task in an arm: a row of the report.

    Attributes:
        task: See `RegressionPlan`.
        arm: The arm.
    """

    task: str | type[Task]
    arm: str

    @property
    def name(self) -> str:
        """Name of the task in its arm."""
        return row_name(_name(self.task), self.arm)

    @property
    def kind(self) -> type[Task]:
        """Class of the task."""
        return find_task(self.task) if isinstance(self.task, str) else self.task

    def scene(self, scene: Mapping[str, Any]) -> Mapping[str, Any]:
        """Options of this row's trials, from the options of all trials."""
        return scene if self.arm == PLAIN else {**scene, "vary": setting_of(self.name)}


@dataclass(frozen=True)
class RegressionPlan:
    """All combinations of tasks and seeds, with equal settings except the hard arm's variation.

    Attributes:
        tasks: Names, places such as `FILE.py:Class`, or classes that are not in the registry.
        seeds: Seeds of every task.
        scene: Options of `sandbox run` that differ from its defaults.
        record: Folder for recordings of failed trials; None does not record.
        record_all: True also keeps the recordings of successful trials.
        arms: Arms that are played; tasks without a hard arm are played in the plain arm only.

    Raises:
        InputError: An option is unknown, two tasks have the same name, or no task has one of the
            arms.
    """

    tasks: tuple[str | type[Task], ...]
    seeds: tuple[int, ...]
    scene: Mapping[str, Any] = field(default_factory=dict)
    record: Path | None = None
    record_all: bool = False
    arms: tuple[str, ...] = (PLAIN,)

    def __post_init__(self) -> None:
        unknown = set(self.scene) - {f.name for f in fields(TrialOptions)} | (
            set(self.scene)
            & {"task", "seed", "device", "device_options", "record", "events", "dump", "given"}
        )
        if unknown:
            raise InputError("no such option of a trial", got=", ".join(sorted(unknown)))
        claimed: dict[str, tuple[str, type[Task]]] = {}
        for task in self.tasks:
            place, own_task = _place(task)
            with registered(own_task):
                # Trials of two tasks with one name would be counted as trials of one task.
                claim_name(claimed, place, find_task(place))
        if HARD in self.arms and self.scene.get("vary"):
            raise InputError(
                "the hard arm has its own variation, so --vary cannot be used with it",
                got=self.scene["vary"],
            )
        if self.tasks and not self.rows:
            raise InputError(
                "none of these tasks has a hard arm",
                got=", ".join(map(_name, self.tasks)),
                remedy="Play the plain arm",
            )

    @property
    def rows(self) -> tuple[Row, ...]:
        """Tasks in their arms, in order."""
        rows = (Row(task, arm) for arm in self.arms for task in self.tasks)
        return tuple(row for row in rows if row.arm == PLAIN or setting_of(row.name))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the tasks in their arms, in order."""
        return tuple(row.name for row in self.rows)

    def jobs(self) -> list[TrialJob]:
        """All trials, ordered by seed: a stopped run has played all tasks about equally often.

        Raises:
            InputError: An option has an invalid value.
        """
        return [
            TrialJob(
                replace(settings, seed=seed),
                self.record,
                _place(row.task)[1],
                self.record_all,
                row.arm,
            )
            for seed in self.seeds
            for row, settings in zip(self.rows, self.settings, strict=True)
        ]

    @cached_property
    def settings(self) -> tuple[Settings, ...]:
        """Settings of every row's trials, with seed 0.

        Raises:
            InputError: An option has an invalid value.
        """
        return tuple(_settings(row.task, row.scene(self.scene)) for row in self.rows)

    def check_drawn(self) -> None:
        """Checks, before the run, that at least one trial of every task can be drawn.

        If a task's own code fails for some seeds only, the trials of these seeds crash.

        Raises:
            InputError: No trial of a task can be drawn; the error has the reason for the first
                trial.
        """
        for task in self.tasks:
            if isinstance(task, str) and is_built_in(find_task(task)):
                # If a built-in task cannot be drawn, its first trial ends the run.
                continue
            reasons: list[InputError] = []
            for job in replace(self, tasks=(task,), arms=(PLAIN,)).jobs():
                try:
                    with registered(job.own_task):
                        drawn(job.settings)
                except InputError as error:
                    reasons.append(error)
                except (Exception, SystemExit) as error:
                    where, got = f"{job.name}, seed {job.seed}", failure(error)
                    reasons.append(InputError("the task cannot be drawn", where=where, got=got))
                else:
                    break
            else:
                raise reasons[0]

    def configuration(self) -> dict[str, Any]:
        """All settings that affect results, except task, seed and the variation of the hard arm.

        Results can be compared only if these settings are equal.

        Raises:
            InputError: An option has an invalid value.
        """
        settings = _settings(self.tasks[0], self.scene)
        values = encoded(settings)
        for each in ("task", "seed"):
            del values[each]
        if not set(self.scene) & {f.name for f in fields(SecondOptions)}:
            # The task determines whether there is a second hand.
            values["hands"] = values["hands"][:1]
            values["second_device"] = None
            values["surface"]["shared"] = False
        return {"settings": values, "digests": digests(settings)}

    def origin(self) -> Origin:
        """Everything that determines the trials, besides tasks and seeds.

        Raises:
            InputError: An option has an invalid value.
        """
        configuration = self.configuration()
        models, settings = configuration["digests"], configuration["settings"]
        # An option that is given with its default value counts as not given.
        plain = TrialOptions()
        given = {k: value for k, value in self.scene.items() if value != getattr(plain, k)}
        if given.get(ENCODER, settings["pipeline"]["encoder"]) not in MODELS:
            given[ENCODER] = f"of one's own, {models['encoder']}"
            settings["pipeline"]["encoder"] = given[ENCODER]
        here = versions()
        program = {"states": STATES, "version": here["hand-sandbox"], "models": models}
        if "commit" in here:
            program["commit"] = here["commit"]
        return Origin(json.loads(json.dumps(given, default=str)), program, settings)

    def versions(self) -> dict[str, int]:
        """Version of every row's task."""
        return {row.name: row.kind.version for row in self.rows}

    def time_limits(self) -> dict[str, float]:
        """Time limit (s) of every row's task."""
        return {row.name: float(row.kind.time_limit) for row in self.rows}

    def command(self, name: str, seed: int, crashed: bool = False) -> str:
        """A command line that runs a trial again, records it and replays the recording.

        If the run kept a recording, the command line replays it and writes a film. A crashed trial
        cannot be replayed: the command line only runs it again, up to its error.

        Args:
            name: Name of the row.
            seed: Seed of the trial.
            crashed: True if the trial crashed.
        """
        run = self.run_words(name, seed)
        if not run:
            asked = next(row.task for row in self.rows if row.name == name)
            assert not isinstance(asked, str)
            return _python_command(asked, seed, self.scene)
        file = file_name(name, seed)
        if crashed:
            return shlex.join(run)
        if self.record is not None:
            kept = self.record / file
            film = kept.with_suffix(".webp")
            return shlex.join(["sandbox", "replay", str(kept), "--film", str(film)])
        again = shlex.join([*run, "--record", file])
        return f"{again} && {shlex.join(['sandbox', 'replay', file])}"

    def run_words(self, name: str, seed: int) -> list[str]:
        """Words of the command that runs a trial; empty for a class, which no command can name.

        Args:
            name: Name of the row.
            seed: Seed of the trial.
        """
        row = next(row for row in self.rows if row.name == name)
        if not isinstance(row.task, str):
            return []
        return ["sandbox", "run", row.task, "--seed", str(seed), *options(row.scene(self.scene))]


def file_name(row: str, seed: int) -> str:
    """File name of a trial's recording: `stack-7.jsonl`, in the hard arm `stack-hard-7.jsonl`."""
    return f"{row.replace(' (', '-').removesuffix(')')}-{seed}.jsonl"


def _settings(task: str | type[Task], scene: Mapping[str, Any]) -> Settings:
    place, own_task = _place(task)
    with registered(own_task):
        return trial_settings(TrialOptions(task=place, given=frozenset(scene), **scene))


def _place(task: str | type[Task]) -> tuple[str, type[Task] | None]:
    """Name or place of a task, and its class if it is not in the registry."""
    return (task, None) if isinstance(task, str) else (task.name, task)


def _name(task: str | type[Task]) -> str:
    return find_task(task).name if isinstance(task, str) else task.name


def _python_command(own_task: type[Task], seed: int, scene: Mapping[str, Any]) -> str:
    """A command line that runs a trial of a task class, which `sandbox run` cannot name."""
    module, name = own_task.__module__, own_task.__qualname__
    program = (
        "from sandbox.regress.execute import run_job; "
        "from sandbox.regress.run_plan import RegressionPlan; "
        f"from {module} import {name} as T; "
        f"print(run_job(RegressionPlan((T,), ({seed},), {dict(scene)!r}).jobs()[0]))"
    )
    return shlex.join(["python", "-c", program])


def options(scene: Mapping[str, Any]) -> Iterator[str]:
    """Yields the options of a scene as words of a command line."""
    for name, value in scene.items():
        flag = "--" + name.replace("_", "-")
        if isinstance(value, bool):
            if value:
                yield flag
            elif getattr(TrialOptions, name) is True:
                yield "--no-" + flag.removeprefix("--")
        elif isinstance(value, tuple | list):
            for each in value:
                yield from (flag, str(each))
        elif value is not None:
            yield from (flag, str(value))


def find_tasks(names: Sequence[str]) -> tuple[str, ...]:
    """Names or places of tasks, each task once; `all` means all tasks, also of installed packages.

    Raises:
        InputError: No task has such a name. Or an installed task cannot be used; it is not left
            out, because a gate that ignores broken tasks would pass.
    """
    asked = task_names() if ALL in names else names
    return tuple({find_task(name): name for name in asked}.values())


def parse_seeds(text: str) -> tuple[int, ...]:
    """Parses seeds: `0:120` means 0 to 119, as in Python; `7,9,20:30` means 7, 9 and 20 to 29.

    Raises:
        InputError: The text has another form.
    """
    seeds: list[int] = []
    try:
        for part in text.split(","):
            first, colon, end = part.partition(":")
            low = int(first)
            high = int(end) if colon else low + 1
            if low < 0 or high <= low or high - low > MOST_SEEDS:
                raise ValueError
            seeds += range(low, high)
    except ValueError:
        raise InputError(
            "not a list of seeds", where="--seeds", got=text, expected="such as 0:120 or 3,17,40:50"
        ) from None
    return tuple(dict.fromkeys(seeds))


@contextmanager
def registered(own_task: type[Task] | None) -> Iterator[None]:
    """Registers a task class for the duration of a `with` block.

    Raises:
        InputError: Another task has the same name.
    """
    if own_task is None or TASKS.get(own_task.name) is own_task:
        yield
        return
    if own_task.name in TASKS:
        raise InputError(
            "another task has this name",
            where=f"{own_task.__module__}.{own_task.__qualname__}",
            got=own_task.name,
            remedy="Give the task another name",
        )
    TASKS[own_task.name] = own_task
    try:
        yield
    finally:
        del TASKS[own_task.name]


ENCODER = "encoder"
"""Option of a trial that names the encoder."""


@dataclass(frozen=True)
class Origin:
    """Everything that determines the trials of a run, besides tasks and seeds; JSON values.

    Attributes:
        given: Options of `sandbox run` that the user gave; an encoder that is not built in is
            named by its digest. Results can be compared only if these options are equal.
        program: The program that ran: `states` (see `sandbox.recording.versions`), `version`,
            `models` (the digests of encoder and labels), and in a checkout `commit`.
        settings: All settings of a trial, except task, seed and settings that follow from the
            task. They are stored so that messages can name changed defaults; empty in an early
            baseline.
    """

    given: Mapping[str, Any]
    program: Mapping[str, Any]
    settings: Mapping[str, Any] = field(default_factory=dict)

    @property
    def decides_states(self) -> tuple[Any, Any]:
        """The parts of `program` on which states depend: `states` and `models`."""
        return self.program.get("states"), self.program.get("models")

    def __str__(self) -> str:
        """The program in words, such as `states 2 (hand-sandbox 0.2.0, commit abc1234)`."""
        at = self.program.get("commit")
        version = self.program.get("version", "unknown") + (f", commit {at}" if at else "")
        return f"states {self.program.get('states')} (hand-sandbox {version})"


def flat(values: Mapping[str, Any]) -> dict[str, Any]:
    """Nested values as a flat dictionary with dotted names, converted to JSON values."""

    def walk(prefix: str, value: Any) -> Iterator[tuple[str, Any]]:
        if isinstance(value, dict):
            for name, inner in value.items():
                yield from walk(f"{prefix}.{name}" if prefix else name, inner)
        else:
            yield prefix, value

    return dict(walk("", json.loads(json.dumps(values))))
