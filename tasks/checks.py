"""Checks the results of a task's own code: its drawn trial and its measure."""

from __future__ import annotations

import mujoco
import numpy as np

from models.errors import InputError
from models.objects import MechanismPart
from models.scene import TABLE, Scene, SceneSpec
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.task import Measure, Task

DEEPEST = 0.001
"""m, largest overlap of two objects, or of an object and the table, at the start. Contacts are
soft: an object at rest sinks in by some hundredths of a millimetre."""


def check_names(task: Task, where: str) -> None:
    """Checks that a drawn trial has objects, and that its goals name them.

    Args:
        task: The drawn trial.
        where: Task and seed, for messages.

    Raises:
        InputError: The task has no objects, two objects share a name, a goal names an unknown
            object, or a number is not finite.
    """
    names = [obj.name for obj in task.objects]
    if not names or len(set(names)) < len(names):
        raise InputError("a task needs objects with different names", where=where, got=str(names))
    named = {g.object for g in task.goals} | {g.on for g in task.goals if g.on}
    unknown = sorted(named - set(names))
    if unknown:
        raise InputError(
            "a goal names an object that the task does not have",
            where=where,
            got=", ".join(unknown),
            expected=", ".join(names),
        )
    parts = [obj for obj in task.objects if isinstance(obj, MechanismPart)]
    missing = sorted({name for part in parts for name in part.together} - set(names))
    if missing:
        raise InputError(
            "parts of a mechanism are missing among the objects",
            where=where,
            got=", ".join(names),
            expected=f"also {', '.join(missing)}",
            remedy="Return `*mechanism.parts` among the objects",
        )
    numbers = [
        *(x for t in task.objects for x in (*t.position, t.yaw)),
        *(x for g in task.goals for x in (*g.position, g.yaw)),
    ]
    if not np.all(np.isfinite(numbers)):
        raise InputError("a start or a goal is not finite", where=where)


def check_repeatable(task: Task, again: Task, where: str) -> None:
    """Checks that two draws of one seed are equal.

    Args:
        task: A drawn trial.
        again: The same seed, drawn again.
        where: Task and seed, for messages.

    Raises:
        InputError: They differ, so some randomness does not come from the seed.
    """
    first, second = _drawn(task), _drawn(again)
    changed = [name for name in first if second.get(name) != first[name]]
    if changed or len(first) != len(second):
        raise InputError(
            "two draws of one seed differ",
            where=where,
            got=f"another {', '.join(changed) or 'number of objects or goals'}",
            expected="the same trial from the same seed",
            remedy="Draw all random numbers from `rng`, not from `random`, a generator or a clock",
        )


def _drawn(task: Task) -> dict[str, tuple[object, ...]]:
    """The random values of a draw, by object and by goal."""
    objects = {
        obj.name: (*map(float, obj.position), float(obj.yaw), float(obj.mass))
        for obj in task.objects
    }
    goals = {
        f"goal {i} of {goal.object}": (*map(float, goal.position), float(goal.yaw), goal.on)
        for i, goal in enumerate(task.goals)
    }
    return {**objects, **goals}


def check_places(task: Task, surface: Surface, where: str) -> None:
    """Checks that objects are on the surface and apart from each other and from the table.

    Args:
        task: The drawn trial.
        surface: The surface as placed in the world.
        where: Task and seed, for messages.

    Raises:
        InputError: The centre of an object or goal is off the surface, or two objects overlap.
    """
    # A fixed body may stand beside the surface; what moves on it must be within reach.
    centres = {
        f"the object {obj.name}": obj.position
        for obj in task.objects
        if not (isinstance(obj, MechanismPart) and obj.fixed)
    }
    centres |= {f"the goal of {g.object}": g.position for g in task.goals if g.on is None}
    width, height = surface.size
    for what, centre in centres.items():
        x, y = surface.to_surface(centre)
        if not (0 <= x <= width and 0 <= y <= height):
            raise InputError(
                f"{what} is off the touch surface",
                where=where,
                got=f"{1000 * x:.0f} mm right and {1000 * y:.0f} mm down from its top left corner",
                expected=f"within {1000 * width:.0f} x {1000 * height:.0f} mm",
            )
    deepest, pair = _deepest_overlap(task)
    if deepest > DEEPEST:
        raise InputError(
            f"{pair[0]} and {pair[1]} overlap at the start",
            where=where,
            got=f"{1000 * deepest:.1f} mm deep",
            expected=f"at most {1000 * DEEPEST:g} mm",
            remedy="Place them apart, or the physics would throw them across the table",
        )


def _deepest_overlap(task: Task) -> tuple[float, tuple[str, str]]:
    """Depth (m) and names of the two bodies that overlap most; 0 if none do."""
    model = Scene(SceneSpec((), task.objects, task.table_friction)).model
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    deepest, pair = 0.0, ("", "")
    for contact in data.contact[: data.ncon]:
        if -contact.dist > deepest:
            deepest = -float(contact.dist)
            bodies = sorted(int(model.geom_bodyid[geom]) for geom in contact.geom)
            first, second = (model.body(body).name if body else TABLE for body in bodies)
            pair = (first, second)
    return deepest, pair


def measure(task: Task, sensing: Sensing) -> Measure:
    """Calls a task's `measure`, and checks its result.

    Raises:
        InputError: `measure` of the task returns something else, such as nothing.
    """
    result = task.measure(sensing)
    if not isinstance(result, Measure):
        raise InputError(
            "`measure` did not return a Measure",
            where=task.name,
            got=repr(result)[:80],
            expected="a Measure, such as `return judge(...)`",
            remedy="Every branch of `measure` needs a `return`",
        )
    return result
