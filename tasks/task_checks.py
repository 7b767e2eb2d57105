"""Checks, for the author of a task, that it obeys all rules for tasks over some seeds.

    from tasks import check_task

    def test_our_task():
        check_task(PushTheMug)

A session does not make these checks. It draws a trial once, and stops with a one-line error if the
task's own code fails.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from typing import Any
from xml.etree.ElementTree import tostring

import mujoco
import numpy as np

from models.errors import InputError
from models.hand import Hand
from models.mjcf_object import check_object_name
from models.objects import Box, Cylinder, MechanismPart, SceneObject, Wrench
from models.scene import PaintedRing, Scene, SceneSpec
from models.surface import Surface
from tasks.guarded import build_scene, check_apart, draw_task
from tasks.registry import TASK_PLUGINS, completed, find_task
from tasks.score import measure
from tasks.sensing import Sensing
from tasks.task import Task, over_a_side, place_surface

SEEDS = range(10)
"""Seeds with which a task is checked, unless others are given."""

WIDEST = 2.0
"""Largest radius of an object, divided by the longer side of the surface. A larger object probably
has the wrong unit."""


def check_task(
    task: type[Any] | str, seeds: Iterable[int] = SEEDS, surface: Surface | None = None
) -> None:
    """Checks that a task obeys the rules for tasks.

    It is meant for the task's author, like Gymnasium's `check_env` for authors of environments.
    For every seed, the trial is drawn twice, built in MuJoCo, and measured at its start.

    Args:
        task: The class, or its name on the command line: `FILE.py:CLASS`.
        seeds: Seeds of the trials that are drawn.
        surface: The touch surface, which need not be placed; None takes the default tablet. A task
            for two hands gets a surface of double width.

    Raises:
        InputError: The first rule that the task breaks: a member is missing or wrong, two draws of
            a seed differ, a value of an object, goal or ring is invalid, objects overlap or are off
            the surface, or `measure` fails, returns no `Measure`, or changes the simulation.
    """
    if isinstance(task, str):
        kind = find_task(task)
    else:
        kind = completed(task, getattr(task, "__qualname__", repr(task)[:80]))
    size = surface or Surface()
    if kind.hands > 1:
        size = replace(size, width_in=kind.hands * size.width_in)
    placed = place_surface(size, kind)
    for seed in seeds:
        where = f"{kind.name}, seed {seed}"
        drawn = draw_task(kind, seed, placed)
        with TASK_PLUGINS.guarded(where, "the task cannot be checked"):
            _check_values(drawn, where)
            _check_repeatable(drawn, kind.draw(seed, placed), where)
            _check_places(drawn, placed, where)
        _check_measure(drawn, where)


def _check_measure(task: Task, where: str) -> None:
    """Checks that `measure` measures the start of a trial, and only reads the simulation.

    Raises:
        InputError: `measure` fails, returns no `Measure`, or changes the simulation.
    """
    sides = ("right", "left")[: task.hands]
    scene = build_scene(task, [Hand(name=side) for side in sides])
    data = mujoco.MjData(scene.model)
    mujoco.mj_forward(scene.model, data)
    state = np.empty(mujoco.mj_stateSize(scene.model, _STATE))
    after = state.copy()
    mujoco.mj_getState(scene.model, data, state, _STATE)
    measure(task, Sensing(scene, data))
    mujoco.mj_getState(scene.model, data, after, _STATE)
    if not np.array_equal(state, after, equal_nan=True):
        raise InputError(
            "`measure` changes the simulation",
            where=where,
            remedy="A task only reads: work on copies of what `sensing` returns",
        )


_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
"""Parts of MuJoCo's state that `measure` must not change."""


def _check_values(task: Task, where: str) -> None:
    """Checks the values of objects, rings and goals.

    Raises:
        InputError: The scene or a hand already uses a name, or a size, mass, place, angle, colour
            or friction is invalid.
    """
    for obj in task.objects:
        _check_object(obj, where)
    for ring in _rings(task, where):
        _check_numbers(f"the middle of {ring.name}", ring.middle, 2, where)
        _check_numbers(f"the radius of {ring.name}", ring.radius, 0, where, above=0.0)
        _check_numbers(f"the width of {ring.name}", ring.width, 0, where, above=0.0)
    rings = [ring.name for ring in task.painted]
    names = [obj.name for obj in task.objects]
    for name in rings:
        if rings.count(name) > 1 or name in names:
            raise InputError(
                f"a ring shares its name {name} with another ring or an object",
                where=where,
                got=", ".join(names + rings),
                remedy="Give the ring a different name",
            )
    for goal in task.goals:
        if not isinstance(goal.object, str):
            raise InputError(
                "`object` of a goal is not text",
                where=where,
                got=repr(goal.object)[:80],
                expected="the name of an object",
            )
        whose = f"the goal of {goal.object}"
        _check_numbers(f"the position of {whose}", goal.position, 3, where)
        _check_numbers(f"the yaw of {whose}", goal.yaw, 0, where)


def _rings(task: Task, where: str) -> tuple[PaintedRing, ...]:
    """Rings that are painted on the table.

    Raises:
        InputError: `painted` is not a sequence of rings.
    """
    painted: object = task.painted
    if not isinstance(painted, tuple | list) or not all(
        isinstance(ring, PaintedRing) for ring in painted
    ):
        raise InputError(
            "`painted` is not a sequence of rings",
            where=where,
            got=repr(painted)[:80],
            expected="several PaintedRing, such as `(PaintedRing(...),)`",
        )
    return tuple(painted)


@cache
def _names_of_hands() -> frozenset[str]:
    """Names of both hands and of all their bodies and geoms."""
    names = {"right", "left"}
    for side in sorted(names):
        model = Scene(SceneSpec((Hand(name=side),), ())).model
        names |= {model.body(i).name for i in range(model.nbody)}
        names |= {model.geom(i).name for i in range(model.ngeom)}
    return frozenset(names)


def _check_object(obj: SceneObject, where: str) -> None:
    name = obj.name
    check_object_name(name, where)
    if name in _names_of_hands():
        raise InputError(
            "an object cannot have the name of a part of a hand", where=where, got=name
        )
    _check_numbers(f"the position of {name}", obj.position, 3, where)
    _check_numbers(f"the yaw of {name}", obj.yaw, 0, where)
    if isinstance(obj, MechanismPart):
        return
    _check_numbers(f"the mass of {name}", obj.mass, 0, where, above=0.0)
    if isinstance(obj, Box):
        _check_numbers(f"half_size of {name}", obj.half_size, 3, where, above=0.0)
    if isinstance(obj, Cylinder):
        _check_numbers(f"the radius of {name}", obj.radius, 0, where, above=0.0)
        _check_numbers(f"half_height of {name}", obj.half_height, 0, where, above=0.0)
    if isinstance(obj, Box | Cylinder):
        _check_numbers(f"the friction of {name}", obj.friction, 0, where, least=0.0)
    if isinstance(obj, Wrench):
        _check_numbers(f"the size of {name}", obj.size, 0, where, above=0.0)
        bolt = 0.0 if obj.bolt is None else obj.bolt
        _check_numbers(f"the bolt of {name}", bolt, 0, where, least=0.0)
    if isinstance(obj, Box | Cylinder | Wrench):
        _check_numbers(f"the rgb of {name}", obj.rgb, 3, where)


def _check_numbers(
    what: str,
    value: object,
    count: int,
    where: str,
    above: float = -np.inf,
    least: float = -np.inf,
) -> None:
    """Checks that a value is a sequence of `count` finite numbers, or a single number if `count` is
    0."""
    expected = "a number" if count == 0 else f"{count} numbers"
    if above == 0.0:
        expected += " above 0"
    if least == 0.0:
        expected += ", 0 or more"
    try:
        # NumPy would convert a text of digits to a number here, and the text would fail later.
        written = np.asarray(value).dtype.kind in "US"
        numbers = np.array(np.nan) if written else np.asarray(value, float)
    except (TypeError, ValueError):
        numbers = np.array(np.nan)
    right = numbers.shape == ((count,) if count else ())
    if not (right and np.all(np.isfinite(numbers) & (numbers > above) & (numbers >= least))):
        raise InputError(f"{what} is wrong", where=where, got=repr(value)[:80], expected=expected)


def _check_repeatable(task: Task, again: Task, where: str) -> None:
    """Checks that two draws of one seed are equal.

    Raises:
        InputError: The draws differ, so some randomness does not come from the seed.
    """
    first, second = _drawn(task), _drawn(again)
    changed = [name for name in first if second.get(name) != first[name]]
    if not changed and len(first) == len(second):
        # The MJCF of the objects also contains sizes, friction, shapes and joints.
        made, remade = ([tostring(t.body()) for t in draw.objects] for draw in (task, again))
        pairs = zip(task.objects, made, remade, strict=True)
        changed = [obj.name for obj, one, other in pairs if one != other]
    if changed or len(first) != len(second):
        raise InputError(
            "two draws of one seed differ",
            where=where,
            got=f"another {', '.join(changed) or 'number of objects or goals'}",
            expected="the same trial from the same seed",
            remedy="Draw all random numbers from `rng`, not from another generator or a clock",
        )


def _drawn(task: Task) -> dict[str, tuple[object, ...]]:
    """The random values of a draw, by object, by goal and by painted ring."""
    objects = {
        obj.name: (*map(float, obj.position), float(obj.yaw), float(obj.mass))
        for obj in task.objects
    }
    goals = {
        f"goal {i} of {goal.object}": (*map(float, goal.position), float(goal.yaw), goal.on)
        for i, goal in enumerate(task.goals)
    }
    rings = {
        f"ring {ring.name}": (*map(float, ring.middle), float(ring.radius), float(ring.width))
        for ring in task.painted
    }
    return {**objects, **goals, **rings}


def _check_places(task: Task, surface: Surface, where: str) -> None:
    """Checks that objects are on the surface and apart from each other and from the table.

    Raises:
        InputError: The centre of an object or goal is off the surface, or two objects overlap.
    """
    # A fixed body may stand beside the surface, but moving parts must be within reach.
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
    if task.plane == "front":
        for obj in task.objects:
            if not (isinstance(obj, MechanismPart) and obj.fixed) and over_a_side(obj, surface):
                raise InputError(
                    f"{obj.name} sticks out over a side of the touch surface",
                    where=where,
                    remedy="Place it further inside: no finger gets to its outer face",
                )
    widest = WIDEST * float(surface.size.max())
    scene = build_scene(task)
    for obj in task.objects:
        across = scene.object_width(obj.name)
        if across > 2 * widest:
            raise InputError(
                f"{obj.name} is {across:.3g} m wide",
                where=where,
                expected=f"at most {2 * widest:.2f} m: sizes are in m",
                remedy='A mesh in mm is scaled in its MJCF: <mesh scale=".001 .001 .001" .../>',
            )
    check_apart(scene, where, "Place them apart, or the physics would throw them across the table")
