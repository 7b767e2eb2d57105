"""Harder and easier trials than a task draws: other objects, other friction, a worse touch screen.

A variation is no part of a task: the ranges of its version stay what they are, and a drawn trial is
changed afterwards. What is changed is written beside the result, so that a varied trial is never
compared with one that is not.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, is_dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError
from models.objects import Box, Thing
from models.surface import Surface
from tasks.task import Goal, Task

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Variation:
    """How trials differ from those that a task draws; neutral by default, plain values.

    Attributes:
        size: Factor on the objects' edges; what they weigh, and what friction a bolt has, does not
            change by it.
        mass: Factor on their masses.
        friction: Factor on every coefficient of sliding friction: of table, objects and hands.
        start: m by which every object starts elsewhere, in a direction that follows from the seed.
        noise: m, standard deviation of white noise on either coordinate of every touch and frame.
        dropped: Times per second that the screen loses a touch for a moment.
        ghosts: Times per second that the screen reports a touch where there is none.
        latency: s by which touches come late.

    Raises:
        InputError: A value is out of range.
    """

    size: float = 1.0
    mass: float = 1.0
    friction: float = 1.0
    start: float = 0.0
    noise: float = 0.0
    dropped: float = 0.0
    ghosts: float = 0.0
    latency: float = 0.0

    def __post_init__(self) -> None:
        for name, (least, most) in RANGES.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise InputError(
                    f"no such {name}", where="variation", got=value,
                    expected=f"{least:g} to {most:g}",
                )  # fmt: skip

    @property
    def neutral(self) -> bool:
        """Whether nothing is changed."""
        return self == Variation()

    @property
    def spoils(self) -> bool:
        """Whether touches are changed on their way."""
        return any(getattr(self, name) != 0.0 for name in TOUCHES)

    def as_json(self) -> dict[str, float]:
        """All values, by name."""
        return asdict(self)


RANGES = {
    "size": (0.1, 5.0),
    "mass": (0.01, 100.0),
    "friction": (0.01, 10.0),
    "start": (0.0, 0.2),
    "noise": (0.0, 0.05),
    "dropped": (0.0, 10.0),
    "ghosts": (0.0, 20.0),
    "latency": (0.0, 2.0),
}
"""What is beyond is a slip of the finger, by attribute of a variation."""

TOUCHES = ("noise", "dropped", "ghosts", "latency")
"""What changes touches, and not the scene."""

_STREAM = 7_005
_TRIES = 2_000


def vary(task: Task, variation: Variation, surface: Surface) -> Task:
    """A drawn trial with other objects and another start; one that is not changed is the same.

    Friction is not the trial's, but the whole scene's, and the session's to change; touches are
    changed by a device.

    Args:
        task: As drawn.
        variation: What to change.
        surface: As placed in the world; no object starts beside it.

    Raises:
        InputError: The task or one of its things cannot be changed like that.
    """
    if replace(variation, friction=1.0, **dict.fromkeys(TOUCHES, 0.0)).neutral:
        return task
    if not is_dataclass(task):
        raise InputError("only tasks that are dataclasses can be varied", where=task.name)
    things = tuple(_changed(thing, variation, task.name) for thing in task.objects)
    steps = {t.name: _step(u, t) for t, u in zip(things, task.objects, strict=True)}
    if variation.start:
        things = _moved(things, variation.start, task, surface)
    goals = tuple(_goal(goal, variation.size, steps[goal.object]) for goal in task.goals)
    changed: Task = replace(task, objects=things, goals=goals)
    return changed


def _changed(thing: Thing, variation: Variation, where: str) -> Thing:
    """A thing of another size, with the same place under it, and of another mass."""
    if variation.size != 1.0:
        thing = _sized(thing, variation.size, where)
    if variation.mass != 1.0:
        if not is_dataclass(thing):
            raise InputError("this thing's mass cannot be varied", where=where, got=thing.name)
        heavier: Thing = replace(thing, mass=thing.mass * variation.mass)
        return heavier
    return thing


def _sized(thing: Thing, size: float, where: str) -> Thing:
    x, y, z = thing.position
    if isinstance(thing, Box):
        a, b, c = (size * half for half in thing.half_size)
        # What it stands on stays where it is.
        return replace(thing, half_size=(a, b, c), position=(x, y, z + c - thing.half_size[2]))
    scaled = getattr(thing, "scaled", None)
    if scaled is None:
        raise InputError(
            "this thing has one size only", where=where, got=thing.name,
            remedy="Vary something else, or give its class `scaled(size)`",
        )  # fmt: skip
    resized: Thing = scaled(size)
    return resized


def _step(old: Thing, new: Thing) -> tuple[float, float, float]:
    """(3,) m, from a thing's middle to what it is at another size, along the thing's own axes."""
    x, y, z = (b - a for a, b in zip(old.position, new.position, strict=True))
    c, s = np.cos(old.yaw), np.sin(old.yaw)
    return float(c * x + s * y), float(c * y - s * x), z


def _goal(goal: Goal, size: float, step: tuple[float, float, float]) -> Goal:
    """The goal of a thing whose middle has made a step, (3,) m along its own axes."""
    x, y, z = goal.position
    if goal.on is not None:
        # A place on another thing grows with both.
        return replace(goal, position=(size * x, size * y, size * z))
    c, s = np.cos(goal.yaw), np.sin(goal.yaw)
    u, v, w = step
    return replace(goal, position=(float(x + c * u - s * v), float(y + s * u + c * v), z + w))


def _moved(
    things: tuple[Thing, ...], way: float, task: Task, surface: Surface
) -> tuple[Thing, ...]:
    """Things that start elsewhere, none nearer to another than it was, all before the surface."""
    bolted = [t.name for t in things if getattr(t, "bolt", None) is not None]
    fixed = bolted or [t.name for t in things if not is_dataclass(t)]
    if fixed:
        raise InputError("this thing cannot start elsewhere", where=task.name, got=fixed[0],
                         remedy="Vary something else")  # fmt: skip
    rng = np.random.default_rng([task.seed, _STREAM])
    places = np.array([t.position for t in things])
    apart = list(_distances(places))
    for _ in range(_TRIES):
        angles = rng.uniform(-np.pi, np.pi, len(things))
        if task.plane == "front":
            # To the left or to the right: up there is nothing that bears them.
            steps = np.sign(angles)[:, None] * [1.0, 0.0, 0.0]
        else:
            steps = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(things))])
        new = places + way * steps
        on = surface.to_surface(new)
        inside = np.all((on[:, 0] >= 0.0) & (on[:, 0] <= surface.size[0]))
        if task.plane != "front":
            inside &= np.all((on[:, 1] >= 0.0) & (on[:, 1] <= surface.size[1]))
        if inside and all(d >= e for d, e in zip(_distances(new), apart, strict=True)):
            return tuple(
                replace(t, position=(float(p[0]), float(p[1]), float(p[2])))  # type: ignore[type-var]
                for t, p in zip(things, new, strict=True)
            )
    raise InputError(
        "there is no room to start so far away",
        where=f"{task.name}, seed {task.seed}",
        got=f"{1000 * way:g} mm",
    )


def _distances(places: Array) -> Iterator[float]:
    """m between every two of some places (n, 3)."""
    for a, b in combinations(places, 2):
        yield float(np.linalg.norm(a - b))
