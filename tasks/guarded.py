"""Draws trials and builds scenes with a task's own code. Errors of this code become one line.

`tasks.score` calls a task's `measure`. `tasks.check_task` checks all rules for tasks. This module
also refuses varied trials whose objects overlap at the start, since physics would throw them apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

import mujoco
import numpy as np

from models.arithmetic import length
from models.errors import InputError
from models.hand import SceneHand
from models.objects import MechanismPart
from models.scene import TABLE, Scene, SceneSpec
from models.surface import Surface
from tasks.registry import TASK_PLUGINS
from tasks.task import Task

_OBJECT = ("name", "mass", "position", "yaw", "body")
_GOAL = ("object", "position", "yaw", "on", "shown")


def draw_task(kind: type[Task], seed: int, surface: Surface) -> Task:
    """Draws the trial of a seed.

    Args:
        kind: The task.
        seed: Seed of the trial.
        surface: The surface as placed in the world.

    Raises:
        InputError: The seed is negative, the task's own code fails, or the drawn trial is invalid:
            an object or a goal has a wrong type, or a goal names an unknown object.
    """
    where = f"{kind.name}, seed {seed}"
    if seed < 0:
        raise InputError("the seed is out of range", where="seed", got=seed, expected="0 or more")
    with TASK_PLUGINS.guarded(where, "the task cannot be drawn"):
        task = kind.draw(seed, surface)
        for obj in task.objects:
            _check_parts(
                "object", obj, _OBJECT, where, "a Box, an MjcfObject or a mechanism's part"
            )
        for goal in task.goals:
            _check_parts("goal", goal, _GOAL, where, "a Goal")
        _check_names(task, where)
        _check_places(task, where)
    return task


def build_scene(
    task: Task,
    hands: Sequence[SceneHand] = (),
    timestep: float = 0.002,
    hands_collide: bool = False,
) -> Scene:
    """Compiles the scene of a drawn trial.

    Args:
        task: The drawn trial.
        hands: Hands of the scene.
        timestep: Physics time step (s).
        hands_collide: True if the hands collide with each other.

    Raises:
        InputError: MuJoCo cannot build an object of the task.
        SceneError: The control period is not a whole number of time steps.
    """
    where = f"{task.name}, seed {task.seed}"
    with TASK_PLUGINS.guarded(where, "the scene of this task cannot be built"):
        scene = Scene(
            SceneSpec(
                tuple(hands),
                task.objects,
                task.table_friction,
                timestep,
                hands_collide,
                task.painted,
                task.own_friction,
            )
        )
    model = scene.model
    numbers = (model.qpos0, model.geom_size, model.geom_pos, model.geom_friction)
    if not all(np.isfinite(values).all() for values in numbers):
        raise InputError(
            "the scene of this task has a size, place or friction that is not finite",
            where=where,
            remedy="Run `tasks.check_task`, which names the value",
        )
    return scene


def _check_parts(
    what: str, value: object, parts: tuple[str, ...], where: str, expected: str
) -> None:
    """Checks that an object or a goal of a task has the required attributes."""
    if not all(hasattr(value, part) for part in parts):
        raise InputError(
            f"this is no {what}",
            where=where,
            got=repr(value)[:80],
            expected=expected,
            remedy="`place` returns the objects, and then the goals: ([box], [Goal(...)])",
        )


def _check_names(task: Task, where: str) -> None:
    """Checks that a drawn trial has objects, and that its goals name them.

    Raises:
        InputError: The task has no objects, two objects share a name, or a goal names an unknown
            object.
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
    aimed = [goal.object for goal in task.goals]
    twice = sorted({name for name in aimed if aimed.count(name) > 1})
    if twice:
        raise InputError(
            "an object has two goals, and only one of them would be shown",
            where=where,
            got=", ".join(twice),
            expected="at most one goal for each object",
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


def _check_places(task: Task, where: str) -> None:
    """Checks that positions, yaws and masses of a drawn trial are finite.

    Raises:
        InputError: A position is not three finite numbers, or a yaw or a mass is not finite.
    """
    for obj in task.objects:
        # MuJoCo would treat such a mass as absent, and compute a mass from the volume.
        if not isfinite(obj.mass):
            raise InputError(f"the mass of {obj.name} is not finite", where=where, got=obj.mass)
    placed = [(f"the object {obj.name}", obj.position, obj.yaw) for obj in task.objects]
    placed += [(f"the goal of {goal.object}", goal.position, goal.yaw) for goal in task.goals]
    for name, position, yaw in placed:
        if len(position) != 3 or not all(map(isfinite, (*position, yaw))):
            raise InputError(
                f"{name} has no valid position",
                where=where,
                got=f"{position!r}, yaw {yaw!r}"[:80],
                expected="3 finite numbers in m, and a yaw in rad",
            )


DEEPEST = 0.001
"""Largest overlap of two objects (m), or of an object and the table, at the start. Contacts are
soft: an object at rest sinks in by some hundredths of a millimetre."""


def check_varied(task: Task, where: str, plain: Task | None = None) -> None:
    """Checks that the objects of a varied trial are apart from each other and from the table.

    Args:
        task: The varied trial.
        where: Task and seed, for error messages.
        plain: The trial before it was varied; None skips the check of rings.

    Raises:
        InputError: Two objects overlap, or an object starts inside a ring although it started
            outside before the variation.
    """
    before = set() if plain is None else _inside_rings(plain)
    inside = set() if plain is None else _inside_rings(task) - before
    if inside:
        raise InputError(
            "objects start inside of the ring that is their goal",
            where=where,
            got=", ".join(sorted(obj for _, obj in inside)),
            remedy="Vary it less",
        )
    check_apart(
        build_scene(task), where, "Vary it less: the physics would throw them across the table"
    )


def check_apart(scene: Scene, where: str, remedy: str) -> None:
    """Checks that the objects of a scene are apart from each other and from the table.

    Args:
        scene: The scene, in its first state.
        where: Task and seed, for error messages.
        remedy: The next step, for the error message.

    Raises:
        InputError: Two objects overlap; the error names both.
    """
    deepest, pair = _deepest_overlap(scene)
    if deepest > DEEPEST:
        raise InputError(
            f"{pair[0]} and {pair[1]} overlap at the start",
            where=where,
            got=f"{1000 * deepest:.1f} mm deep",
            expected=f"at most {1000 * DEEPEST:g} mm",
            remedy=remedy,
        )


def _inside_rings(task: Task) -> set[tuple[str, str]]:
    """Pairs of a painted ring's name and the name of an object that starts inside it."""
    return {
        (ring.name, obj.name)
        for ring in task.painted
        for obj in task.objects
        if length(np.subtract(obj.position[:2], ring.middle)) <= ring.radius
    }


def _deepest_overlap(scene: Scene) -> tuple[float, tuple[str, str]]:
    """Depth (m) and names of the two bodies that overlap most; 0 if none do."""
    model = scene.model
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
