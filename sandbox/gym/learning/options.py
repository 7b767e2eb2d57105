"""The contract of an environment for learning: everything that can be chosen of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from models.errors import InputError
from sandbox.trial.settings import RunSettings
from tasks.registry import find_task, hands_of

ACTIONS = {
    "touch": "places of touches, m on the surface",
    "delta": "steps of touches along the surface's axes, in shares of `step`",
    "hand": "steps of touches along the hand's own axes, in shares of `step`",
    "pose": "poses of the hand",
}
"""Kind of action -> what it is."""

NAMES = {
    "told": "the touch in a finger's slot is that finger's",
    "found": "which finger a touch is follows from the touches, as for people",
}
"""Choice of names -> what it means."""

OBSERVED = {
    "touches": "for each finger whether its slot touches, and where, m on the surface",
    "names": "for each slot the finger that its touch was taken for, or -1",
    "velocities": "m/s and rad/s of the hand's degrees of freedom",
    "commanded": "the pose (48,) that the person's hand is asked for, m and rad",
    "phase": "one of five phases of the hand's arrival: away, waiting, above, coming down, down",
    "contact": "for each finger its force on things, N, and the share of its servos' limit in use",
    "things": "of each object its mass, kg, and half its length, width and height, m",
}
"""Part of an observation that has to be asked for -> what it is."""

REWARDS = {
    "reach": "progress, and a share for bringing fingertips to things",
    "progress": "what the task's progress grew by, and 1 at success",
    "sparse": "1 at success",
}
"""Choice of reward -> what it is."""

STEP = 0.010
"""m, largest step of a touch in a control period of 16 ms, along each axis."""


@dataclass(frozen=True)
class LearningOptions:
    """Choices of an agent's actions and observations.

    Attributes:
        action: One of `ACTIONS`.
        names: One of `NAMES`.
        observe: Those of `OBSERVED` that are seen besides what is always seen.
        reward: One of `REWARDS`.
        step: m, largest step of a touch, for actions that are steps.

    Raises:
        InputError: There is no such choice.
    """

    action: str = "touch"
    names: str = "told"
    observe: tuple[str, ...] = ()
    reward: str = "reach"
    step: float = STEP

    def __post_init__(self) -> None:
        for where, got, known in (
            ("action", [self.action], ACTIONS),
            ("names", [self.names], NAMES),
            ("observe", self.observe, OBSERVED),
            ("reward", [self.reward], REWARDS),
        ):
            if unknown := [each for each in got if each not in known]:
                raise InputError(
                    "no such choice", where=where, got=unknown[0], expected=", ".join(known)
                )
        if not 0.0 < self.step <= 0.1:
            raise InputError(
                "out of range", where="step", got=self.step, expected="above 0, up to 0.1 m"
            )


def parts(observe: str | Sequence[str]) -> tuple[str, ...]:
    """Names of parts of an observation, in the order of `OBSERVED`; `all` is every one."""
    asked = (observe,) if isinstance(observe, str) else tuple(observe)
    if asked == ("all",):
        return tuple(OBSERVED)
    return tuple(name for name in OBSERVED if name in asked) + tuple(
        name for name in asked if name not in OBSERVED
    )


def run_settings(
    task: str, hand: str, robot: str, settings: Mapping[str, Any] | None, more: Mapping[str, Any]
) -> RunSettings:
    """Settings of the trials of an environment.

    Args:
        task: Name or place of the task.
        hand: `right` or `left`; empty takes that of the settings.
        robot: The robot whose hand it is; empty takes that of the settings.
        settings: What `RunSettings.as_json` gave; None starts from the defaults.
        more: Single settings, by name.

    Raises:
        InputError: A setting is unknown or not allowed.
    """
    known = {f.name for f in fields(RunSettings)} - {"task", "seed", "hands", "robot"}
    if unknown := sorted(set(more) - known):
        raise InputError(
            "not an option of this environment",
            where=unknown[0],
            expected="action, names, observe, reward, step, hand, robot, render_mode, size, "
            "settings, or a setting of a run: " + ", ".join(sorted(known)),
        )
    kind = find_task(task)
    plain = RunSettings().as_json() if settings is None else settings
    base = RunSettings.from_json({**plain, "task": task, "seed": 0})
    first, *others = base.hands
    first = first.on(hand or first.side)
    if hands_of(kind) > 1 and not others:
        others = [first.other]
    base = replace(base, hands=(first, *others), robot=robot or base.robot)
    values = RunSettings.from_json(replace(base, **more).as_json()) if more else base
    if any(each.in_air is not None for each in values.hands):
        raise InputError(
            "an agent touches, and these settings are of a hand in the air", where="settings"
        )
    return values
