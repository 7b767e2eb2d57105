"""Variations, which make trials harder or easier: other sizes, masses and friction, worse touches.

A variation does not belong to a task. The task draws its trial in the ranges of its version, and
the variation then changes the trial. The changes are stored with the result, so that a varied trial
is never compared with an unvaried trial.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import asdict, dataclass, is_dataclass, replace
from itertools import combinations
from math import cos, sin

import numpy as np

from models import arithmetic
from models.arithmetic import Array, length
from models.errors import HandSandboxError, InputError
from models.objects import Box, MechanismPart, Scalable, SceneObject, Wrench
from models.plugins import failure
from models.surface import Surface
from tasks.task import Goal, Task, over_a_side


@dataclass(frozen=True)
class Variation:
    """Changes to the trials that a task draws; none by default.

    Attributes:
        size: Factor on the objects' edges; it does not change their masses or the friction of a
            bolt.
        mass: Factor on the objects' masses.
        resistance: Factor on the springs, damping and friction of a mechanism's joints.
        friction: Factor on every coefficient of sliding friction: table, objects and hands.
        start: Distance (m) by which the starts of the objects that a person carries are shifted.
            The directions follow from the seed; see `Task.shifted`.
        room: Factor on the room that the task leaves between its objects, such as the width of a
            gate; see `Task.with_room`.
        noise: Standard deviation (m) of white noise on each coordinate of every touch in every
            frame.
        dropped: Number of times per second at which the screen briefly loses a touch.
        ghosts: False touches per second.
        latency: Time (s) by which touches are delayed.

    Raises:
        InputError: A value is out of range.
    """

    size: float = 1.0
    mass: float = 1.0
    resistance: float = 1.0
    friction: float = 1.0
    start: float = 0.0
    room: float = 1.0
    noise: float = 0.0
    dropped: float = 0.0
    ghosts: float = 0.0
    latency: float = 0.0

    def __post_init__(self) -> None:
        for name, (least, most) in RANGES.items():
            value = getattr(self, name)
            if not least <= value <= most:
                raise InputError(
                    f"{name} is out of range",
                    where="variation",
                    got=value,
                    expected=f"{least:g} to {most:g}",
                )

    @property
    def neutral(self) -> bool:
        """True if the variation changes nothing."""
        return self == Variation()

    @property
    def degrades_touches(self) -> bool:
        """True if the variation degrades touches."""
        return any(getattr(self, name) != 0.0 for name in TOUCHES)

    def as_json(self) -> dict[str, float]:
        """All values, by name."""
        return asdict(self)


RANGES = {
    "size": (0.1, 5.0),
    "mass": (0.01, 100.0),
    "resistance": (0.01, 100.0),
    "friction": (0.01, 10.0),
    "start": (0.0, 0.2),
    "room": (0.05, 10.0),
    "noise": (0.0, 0.05),
    "dropped": (0.0, 10.0),
    "ghosts": (0.0, 20.0),
    "latency": (0.0, 2.0),
}
"""Smallest and largest allowed value of each attribute. Values outside were probably mistyped."""

TOUCHES = ("noise", "dropped", "ghosts", "latency")
"""Attributes that change touches and not the scene."""

_STREAM = 7_005
_TRIES = 2_000


def vary(task: Task, variation: Variation, surface: Surface) -> Task:
    """Changes the objects of a drawn trial and their starts.

    Returns the same task if neither objects nor starts change. Friction and touches do not change
    here: the session changes friction, which belongs to the whole scene, and the devices change
    touches.

    Args:
        task: The drawn trial.
        variation: The changes.
        surface: The surface as placed in the world. No start is shifted off it.

    Raises:
        InputError: The task or one of its objects does not support the change, or its own code
            fails.
    """
    if replace(variation, friction=1.0, **dict.fromkeys(TOUCHES, 0.0)).neutral:
        return task
    try:
        return _varied(task, variation, surface)
    except HandSandboxError:
        raise
    except (Exception, SystemExit) as error:
        where = f"{task.name}, seed {task.seed}"
        raise InputError("the task cannot be varied", where=where, got=failure(error)) from error


def _varied(task: Task, variation: Variation, surface: Surface) -> Task:
    """The trial under a variation that changes the scene; see `vary`."""
    if variation.resistance != 1.0 and not any(
        isinstance(obj, MechanismPart) and obj.joint for obj in task.objects
    ):
        raise InputError(
            "the resistance of joints cannot be varied: no object of this task has joints",
            where=task.name,
            remedy="Vary something else",
        )
    if not is_dataclass(task):
        raise InputError("only tasks that are dataclasses can be varied", where=task.name)
    if variation.room != 1.0:
        task = task.with_room(variation.room)
        assert is_dataclass(task)
    objects = tuple(_changed(obj, variation, task.name) for obj in task.objects)
    steps = {t.name: _step(u, t) for t, u in zip(objects, task.objects, strict=True)}
    if variation.start:
        objects = _moved(objects, _shifted(task), variation.start, task, surface)
    goals = tuple(_goal(goal, variation.size, steps[goal.object]) for goal in task.goals)
    if variation.size != 1.0:
        goals = tuple(
            _on_its_slide(goal, old, task, objects, variation.size)
            for goal, old in zip(goals, task.goals, strict=True)
        )
        goals = _goals_of_parts(goals, task, objects, variation.size)
    changed: Task = replace(task, objects=objects, goals=goals)
    return changed


def _changed(obj: SceneObject, variation: Variation, where: str) -> SceneObject:
    """An object with another size and mass in the same place."""
    if isinstance(obj, MechanismPart):
        return obj.varied(variation.size, variation.mass, variation.resistance)
    if variation.size != 1.0:
        obj = _sized(obj, variation.size, where)
    if variation.mass != 1.0:
        if not is_dataclass(obj):
            raise InputError("the mass of this object cannot be varied", where=where, got=obj.name)
        heavier: SceneObject = replace(obj, mass=obj.mass * variation.mass)
        return heavier
    return obj


def _sized(obj: SceneObject, size: float, where: str) -> SceneObject:
    x, y, z = obj.position
    if isinstance(obj, Box):
        a, b, c = (size * half for half in obj.half_size)
        # The point on which the object stands does not move.
        return replace(obj, half_size=(a, b, c), position=(x, y, z + c - obj.half_size[2]))
    if not isinstance(obj, Scalable):
        raise InputError(
            "this object has one size only",
            where=where,
            got=obj.name,
            remedy="Vary something else, or add a method `scaled(size)` to its class",
        )
    return obj.scaled(size)


def _step(old: SceneObject, new: SceneObject) -> tuple[float, float, float]:
    """Shift (3,) m of an object's middle caused by another size, along the object's own axes."""
    x, y, z = (b - a for a, b in zip(old.position, new.position, strict=True))
    c, s = cos(old.yaw), sin(old.yaw)
    return float(c * x + s * y), float(c * y - s * x), z


def _goal(goal: Goal, size: float, step: tuple[float, float, float]) -> Goal:
    """The goal of an object whose middle was shifted by a step, (3,) m along its own axes."""
    x, y, z = goal.position
    if goal.on is not None:
        # A goal on another object moves with the sizes of both objects.
        return replace(goal, position=(size * x, size * y, size * z))
    c, s = cos(goal.yaw), sin(goal.yaw)
    u, v, w = step
    return replace(goal, position=(float(x + c * u - s * v), float(y + s * u + c * v), z + w))


def _goals_of_parts(
    goals: tuple[Goal, ...], task: Task, objects: tuple[SceneObject, ...], size: float
) -> tuple[Goal, ...]:
    """Goals after objects were resized.

    Goals of parts that a resized mechanism carries are scaled about its first body. A goal at the
    end of a slide is then at the end of the resized slide.

    Args:
        goals: Goals; those of first bodies and of other objects are already correct.
        task: The trial before it was resized, with the same number of goals.
        objects: Objects in their new size.
        size: Factor on all lengths.
    """
    first = {
        name: old.name
        for old in task.objects
        if isinstance(old, MechanismPart) and old.carrier is None
        for name in old.together
    }
    # The first body's place: its goal if it has one, else where it starts.
    before = {old.name: old.position for old in task.objects}
    after = {new.name: new.position for new in objects}
    before |= {goal.object: goal.position for goal in task.goals if goal.on is None}
    after |= {goal.object: goal.position for goal in goals if goal.on is None}
    placed = []
    for goal, old in zip(goals, task.goals, strict=True):
        root = first.get(goal.object, goal.object)
        if goal.on is None and root != goal.object:
            x, y, z = (
                c + size * (b - a)
                for a, b, c in zip(before[root], old.position, after[root], strict=True)
            )
            goal = replace(goal, position=(x, y, z))
        placed.append(goal)
    return tuple(placed)


def _on_its_slide(
    goal: Goal, before: Goal, task: Task, objects: tuple[SceneObject, ...], size: float
) -> Goal:
    """Scales the goal of a mechanism's first body that moves on a slide, like the slide itself.

    Other goals are returned unchanged.
    """
    pairs = {old.name: (old, new) for old, new in zip(task.objects, objects, strict=True)}
    old, new = pairs[goal.object]
    if goal.on is not None or not isinstance(old, MechanismPart):
        return goal
    joint = old.joint
    slides = joint is not None and joint.kind == "slide"
    if old.carrier is not None or not slides or not isinstance(new, MechanismPart):
        return goal
    low = joint.range[0] if joint is not None and joint.range else 0.0
    end, other = old.placed(low)[0], new.placed(size * low)[0]
    x, y, z = (c + size * (b - a) for a, b, c in zip(end, before.position, other, strict=True))
    return replace(goal, position=(x, y, z))


def _shifted(task: Task) -> list[str]:
    """Names of the objects whose starts the task shifts.

    Raises:
        InputError: The task names no objects, or objects that it does not have.
    """
    names = list(task.shifted())
    known = [thing.name for thing in task.objects]
    unknown = [name for name in names if name not in known]
    if unknown or not names:
        raise InputError(
            "`shifted` does not name objects of the task",
            where=task.name,
            got=", ".join(map(str, unknown)) or "none",
            expected=f"some of: {', '.join(known)}",
            remedy="If no start can be shifted, raise an InputError with the reason",
        )
    return names


def _moved(
    objects: tuple[SceneObject, ...],
    names: Collection[str],
    way: float,
    task: Task,
    surface: Surface,
) -> tuple[SceneObject, ...]:
    """All objects, some of them with shifted starts on the surface.

    No shifted object comes nearer to another object or to its goal. None projects over a side of an
    upright surface.

    Args:
        objects: All objects.
        names: Names of the objects that are shifted.
        way: Length (m) of the shift.
        task: The drawn trial.
        surface: The surface as placed in the world.
    """
    own = [i for i, thing in enumerate(objects) if thing.name in names]
    bolted = [
        objects[i].name
        for i in own
        if isinstance(thing := objects[i], MechanismPart)
        or (isinstance(thing, Wrench) and thing.bolt is not None)
    ]
    fixed = bolted or [objects[i].name for i in own if not is_dataclass(objects[i])]
    if fixed:
        raise InputError(
            "the start of this object cannot be varied",
            where=task.name,
            got=fixed[0],
            remedy="Vary something else",
        )
    rng = np.random.default_rng([task.seed, _STREAM])
    places = np.array([t.position for t in objects])
    apart = list(_distances(places))
    for _ in range(_TRIES):
        angles = rng.uniform(-np.pi, np.pi, len(own))
        if task.plane == "front":
            # Objects are shifted to the left or right only; higher up nothing would support them.
            steps = np.sign(angles)[:, None] * [1.0, 0.0, 0.0]
        else:
            steps = np.column_stack(
                [arithmetic.cos(angles), arithmetic.sin(angles), np.zeros(len(own))]
            )
        new = places.copy()
        new[own] += way * steps
        on = surface.to_surface(new[own])
        inside = np.all((on[:, 0] >= 0.0) & (on[:, 0] <= surface.size[0]))
        if task.plane != "front":
            inside &= np.all((on[:, 1] >= 0.0) & (on[:, 1] <= surface.size[1]))
        if inside and all(d >= e for d, e in zip(_distances(new), apart, strict=True)):
            moved = list(objects)
            for i in own:
                x, y, z = new[i].tolist()
                moved[i] = replace(objects[i], position=(x, y, z))  # type: ignore[type-var]
            if not any(_easier(moved[i], objects[i], task, surface) for i in own):
                return tuple(moved)
    raise InputError(
        "the surface has no room for starts shifted so far",
        where=f"{task.name}, seed {task.seed}",
        got=f"{1000 * way:g} mm",
    )


def _easier(moved: SceneObject, before: SceneObject, task: Task, surface: Surface) -> bool:
    """True if an object came nearer to its goal, or to a side where no finger reaches it."""
    goals = [g.position for g in task.goals if g.object == moved.name and g.on is None]
    nearer = any(
        length(np.subtract(moved.position, goal)) < length(np.subtract(before.position, goal))
        for goal in goals
    )
    return nearer or (task.plane == "front" and over_a_side(moved, surface))


def _distances(places: Array) -> Iterator[float]:
    """Distances (m) between all pairs of positions (n, 3) m."""
    for a, b in combinations(places, 2):
        yield length(a - b)
