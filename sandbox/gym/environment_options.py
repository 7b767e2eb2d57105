"""Options of an environment and of its resets (a curriculum), and the settings of its trials."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from math import pi
from typing import Any

import numpy as np

from models.errors import InputError
from models.objects import MechanismPart
from sandbox.recording.versions import STATES
from sandbox.trial.settings import LABELS as RUN_LABELS
from sandbox.trial.settings import Settings, encoded, recorded_settings, setting_names
from tasks.registry import find_task, hands_of
from tasks.task import Task
from tasks.variation import RANGES, TOUCHES, Variation

ACTIONS = {
    "touch": "places of touches, m on the surface",
    "delta": "steps of touches along the surface's axes, in multiples of `step`, -1 to 1",
    "hand": "steps of touches along the hand's own axes, in multiples of `step`, -1 to 1",
    "pose": "poses of the hand",
}
"""Description of each kind of action."""

TRUE_LABELS = "true"
"""Value of `labels` for which the touch in a finger's slot has that finger's label."""

LABELS = (*(name for name in RUN_LABELS if name != "device"), TRUE_LABELS)
"""Labellers that infer labels from touches, and `TRUE_LABELS`."""

OBSERVED = {
    "touches": "for each finger, whether its slot touches, and the place, m on the surface",
    "velocities": "velocities of the hand's degrees of freedom, m/s and rad/s",
    "commanded": "the commanded pose (48,) of the hand, m and rad",
    "phase": "one of five phases of the hand's arrival: away, waiting, above, coming down, down",
    "contact": "for each finger, its force on objects, N, and the used share of its servos' limit",
    "properties": "for each object, its mass, kg, and half its length, width and height, m",
}
"""Description of each optional part of an observation."""

REWARDS = {
    "progress": "increase of the task's progress, and 1 at success",
    "reach": "like `progress`, plus at most 0.2 for bringing three fingertips to an object",
    "sparse": "1 at success",
}
"""Description of each reward."""

AGENT = "agent"
"""Name of the device of an agent's touches."""

STEP = 0.010
"""Default of `step`, m."""

_OWN = ("task", "seed", "hands")
"""Settings of a run that an environment sets itself."""

_REPLACED = {
    "names": f'Write labels="{TRUE_LABELS}" instead of names="told"; leave out names="found"',
}
"""Remedy for each option that an earlier version had."""


@dataclass(frozen=True)
class EnvOptions:
    """Choices of an agent's actions, observations and rewards.

    Attributes:
        action: One of `ACTIONS`.
        true_labels: True if the touch in a finger's slot gets the label of this finger.
        observe: Parts from `OBSERVED` in addition to those that are always observed.
        reward: One of `REWARDS`.
        goal: True for goal dictionaries (`sandbox.gym.rewards`). Their reward replaces the one that
            `reward` chooses.
        step: Largest step of a touch in a control period of 16 ms, along each axis, for the actions
            `delta` and `hand`, m.

    Raises:
        InputError: A value is not allowed.
    """

    action: str = "touch"
    true_labels: bool = False
    observe: tuple[str, ...] = ()
    reward: str = "progress"
    goal: bool = False
    step: float = STEP

    def __post_init__(self) -> None:
        check_choice("action", self.action, tuple(ACTIONS))
        check_choice("reward", self.reward, tuple(REWARDS))
        check_choice("goal", self.goal, (False, True))
        for name in self.observe:
            check_choice("observe", name, ("all", *OBSERVED))
        number = isinstance(self.step, int | float) and not isinstance(self.step, bool)
        if not number or not 0.0 < self.step <= 0.1:
            raise InputError(
                "out of range", where="step", got=self.step, expected="above 0, up to 0.1 m"
            )


def check_choice(option: str, got: object, choices: Sequence[object]) -> None:
    """Checks the value of an option.

    Raises:
        InputError: The value is not one of the choices.
    """
    if got not in choices:
        raise InputError(
            "no such choice", where=option, got=got, expected=", ".join(map(str, choices))
        )


def observed_parts(observe: str | Iterable[str]) -> tuple[str, ...]:
    """Returns names of optional parts of an observation in the order of `OBSERVED`.

    `all` stands for all of them. Unknown names come last.
    """
    if isinstance(observe, Iterable) and not isinstance(observe, str):
        asked = tuple(observe)
    else:
        asked = (observe,)
    if "all" in asked:
        return tuple(OBSERVED)
    known = tuple(name for name in OBSERVED if name in asked)
    return known + tuple(name for name in asked if name not in OBSERVED)


def run_settings(
    task: str,
    person: Mapping[str, Any],
    settings: Mapping[str, Any] | None,
    single: Mapping[str, Any],
    known: Sequence[str],
) -> Settings:
    """Returns the settings of the trials of an environment.

    Args:
        task: Name of the task, or its place (`FILE.py`, `FILE.py:CLASS` or `MODULE:CLASS`).
        person: `side`, `size` and `turn` of the first hand (`HandSettings`). A value of None is
            taken from `settings`.
        settings: Settings in the form of a recording's header; None starts from the defaults.
        single: Single settings by name.
        known: Names of the environment's other options, for error messages.

    Raises:
        InputError: A setting is unknown or not allowed.
    """
    allowed = set(setting_names()) - set(_OWN)
    if unknown := [name for name in single if name not in allowed]:
        settings_alone = sorted(allowed - set(known))
        raise InputError(
            "not an option of this environment",
            where=unknown[0],
            expected=f"{', '.join(known)}, or a setting of a run: {', '.join(settings_alone)}",
            remedy=_REPLACED.get(unknown[0]),
        )
    kind = find_task(task)
    plain = encoded(Settings()) if settings is None else settings
    if not isinstance(plain, Mapping):
        raise InputError(
            "the settings of a run are not a mapping",
            where="settings",
            got=plain,
            expected="a mapping, as the entry `settings` of a recording's header",
        )
    agent = {"device": {"name": AGENT, "options": {}}, "second_device": None}
    whole = {**plain, **agent, "task": task, "seed": 0}
    base = recorded_settings({"states": STATES, "settings": whole})
    first, *others = base.hands
    chosen = {name: _plain(value) for name, value in person.items() if value is not None}
    # Layouts and the rest posture belong to one side only.
    first = first.on(chosen.get("side", first.side))
    own = {name: _plain(value) for name, value in single.items()}
    values = base.changed(**own, hands=(replace(first, **chosen), *others))
    if any(hand.in_air is not None for hand in values.hands):
        raise InputError(
            "these settings are for a hand in the air, but an agent needs touches",
            where="settings",
            expected="hands without `in_air`",
        )
    if values.variation.degrades_touches:
        raise InputError(
            "disturbances of touches are not available for an agent",
            where="variation",
            got=", ".join(name for name in TOUCHES if getattr(values.variation, name)),
            remedy="Disturb the agent's actions instead",
        )
    if hands_of(kind) > 1 and not others:
        values = replace(values, hands=(*values.hands, values.hands[0].opposite))
    return values


def _plain(value: Any) -> Any:
    """Converts NumPy numbers to Python numbers, and a mapping to a `Variation`."""
    if isinstance(value, Mapping):
        return Variation(**value)
    return value.item() if isinstance(value, np.generic) else value


NEAREST = 0.95
"""Largest value of `Curriculum.near`."""


@dataclass(frozen=True)
class Curriculum:
    """Changes to one trial; none by default.

    Attributes:
        near: Share of the way from its start to its goal, and of the rotation, by which the start
            of each object is moved to the goal.
        size: Factor on the objects' edges.
        mass: Factor on their masses.
        friction: Factor on every coefficient of sliding friction.
        start: Shift of every object's start, in a direction that follows from the seed, m.
    """

    near: float = 0.0
    size: float = 1.0
    mass: float = 1.0
    friction: float = 1.0
    start: float = 0.0

    @classmethod
    def of(cls, options: Mapping[str, Any] | None) -> Curriculum:
        """Reads the options of a reset.

        Raises:
            InputError: An option is unknown, is not a number, or is out of range.
        """
        known = {f.name for f in fields(cls)}
        for name, value in (options or {}).items():
            if name not in known:
                raise InputError(
                    "not an option of reset",
                    where="reset(options=)",
                    got=name,
                    expected=", ".join(sorted(known)),
                )
            low, high = RANGES.get(name, (0.0, NEAREST))
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not number or not low <= value <= high:
                raise InputError(
                    f"{name} is out of range",
                    where="reset(options=)",
                    got=value,
                    expected=f"{low:g} to {high:g}",
                )
        return cls(**{name: float(value) for name, value in (options or {}).items()})

    def settings(self, settings: Settings) -> Settings:
        """Returns the settings of a trial with these changes."""
        changes = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "near"}
        if self == Curriculum(near=self.near):
            return settings
        return replace(settings, variation=replace(settings.variation, **changes))

    def task(self, task: Task) -> Task:
        """Returns a drawn trial whose objects start nearer to their goals.

        Raises:
            InputError: The start of an object cannot be moved.
        """
        if not self.near:
            return task
        goals = {goal.object: goal for goal in task.goals}
        moved = []
        for thing in task.objects:
            goal = goals.get(thing.name)
            if goal is None:
                moved.append(thing)
                continue
            lies = goal.on is None and abs(goal.position[2] - thing.position[2]) < 1e-3
            lies = lies and not isinstance(thing, MechanismPart)
            if not (lies and is_dataclass(thing) and is_dataclass(task)) or _bolted(thing):
                raise InputError(
                    "this object cannot start on the way to its goal",
                    where="reset(options=), near",
                    got=f"{thing.name} of {task.name}",
                    expected="an object that the task moves along the table",
                )
            # The rotation in the shorter direction.
            turn = (goal.yaw - thing.yaw + pi) % (2 * pi) - pi
            way = zip(thing.position, goal.position, strict=True)
            x, y, z = (a + self.near * (b - a) for a, b in way)
            moved.append(replace(thing, position=(x, y, z), yaw=thing.yaw + self.near * turn))
        changed: Task = replace(task, objects=tuple(moved))  # type: ignore[type-var]
        return changed


def _bolted(thing: Any) -> bool:
    return "bolt" in {f.name for f in fields(thing)} and thing.bolt is not None
