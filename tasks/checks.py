"""Checks the results of a task's own code: its drawn trial and its measure."""

from __future__ import annotations

from functools import cache
from math import cos, isfinite, nan, sin
from xml.etree.ElementTree import tostring

import mujoco
import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length, stacked_applied
from models.errors import InputError
from models.hand import Hand
from models.mjcf_object import check_object_name
from models.objects import Box, Cylinder, MechanismPart, SceneObject, Wrench
from models.plugins import failure
from models.scene import TABLE, PaintedRing, Scene, SceneSpec
from models.surface import METRES_PER_INCH, Surface
from tasks.sensing import Sensing
from tasks.task import Measure, Task

DEEPEST = 0.001
"""m, largest overlap of two objects, or of an object and the table, at the start. Contacts are
soft: an object at rest sinks in by some hundredths of a millimetre."""


_SHARES = np.linspace(0.0, 1.0, 50)
"""Of the height of a surface, at which points of its sides are looked at."""

WIDEST = 2.0
"""Largest radius of an object, in lengths of the surface: a larger one is in the wrong unit."""


def check_values(task: Task, where: str) -> None:
    """Checks the values that objects and goals of a task of one's own were made of.

    Args:
        task: The drawn trial.
        where: Task and seed, for messages.

    Raises:
        InputError: Something is no object or no goal, a name is the scene's or a hand's, or a size,
            mass, place, angle, colour or friction is not what it has to be.
    """
    for thing in task.objects:
        _check_kind("object", thing, _OBJECT, where, "a Box, an MjcfObject or a mechanism's part")
        _check_thing(thing, where)
    for goal in task.goals:
        _check_kind("goal", goal, _GOAL, where, "a Goal")
    for ring in _rings(task, where):
        _check_numbers(f"the middle of {ring.name}", ring.middle, 2, where)
        _check_numbers(f"the radius of {ring.name}", ring.radius, 0, where, above=0.0)
        _check_numbers(f"the width of {ring.name}", ring.width, 0, where, above=0.0)
    rings = [ring.name for ring in task.painted]
    names = [thing.name for thing in task.objects]
    for name in rings:
        if rings.count(name) > 1 or name in names:
            raise InputError(
                f"the ring {name} needs a name of its own",
                where=where,
                got=", ".join(names + rings),
            )
    for goal in task.goals:
        if not isinstance(goal.object, str):
            raise InputError(
                "a goal names its object by a text", where=where, got=repr(goal.object)[:80]
            )
        whose = f"the goal of {goal.object}"
        _check_numbers(f"the position of {whose}", goal.position, 3, where)
        _check_numbers(f"the yaw of {whose}", goal.yaw, 0, where)


_OBJECT = ("name", "mass", "position", "yaw", "body")
_GOAL = ("object", "position", "yaw", "on", "shown")


def _check_kind(
    what: str, thing: object, parts: tuple[str, ...], where: str, expected: str
) -> None:
    """Checks that an object or a goal of a task has what such a thing has."""
    if not all(hasattr(thing, part) for part in parts):
        raise InputError(
            f"this is no {what}",
            where=where,
            got=repr(thing)[:80],
            expected=expected,
            remedy="`place` returns the objects, and then the goals: ([box], [Goal(...)])",
        )


def _rings(task: Task, where: str) -> tuple[PaintedRing, ...]:
    """What is painted on the table.

    Raises:
        InputError: It is something else than rings.
    """
    painted: object = task.painted
    if not isinstance(painted, tuple | list) or not all(
        isinstance(ring, PaintedRing) for ring in painted
    ):
        raise InputError(
            "what is painted is wrong",
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


def _check_thing(thing: SceneObject, where: str) -> None:
    name = thing.name
    check_object_name(name, where)
    if name in _names_of_hands():
        raise InputError("an object cannot be called as a part of a hand", where=where, got=name)
    _check_numbers(f"the position of {name}", thing.position, 3, where)
    _check_numbers(f"the yaw of {name}", thing.yaw, 0, where)
    if isinstance(thing, MechanismPart):
        return
    _check_numbers(f"the mass of {name}", thing.mass, 0, where, above=0.0)
    if isinstance(thing, Box):
        _check_numbers(f"half_size of {name}", thing.half_size, 3, where, above=0.0)
    if isinstance(thing, Cylinder):
        _check_numbers(f"the radius of {name}", thing.radius, 0, where, above=0.0)
        _check_numbers(f"half_height of {name}", thing.half_height, 0, where, above=0.0)
    if isinstance(thing, Box | Cylinder):
        _check_numbers(f"the friction of {name}", thing.friction, 0, where, least=0.0)
    if isinstance(thing, Wrench):
        _check_numbers(f"the size of {name}", thing.size, 0, where, above=0.0)
        bolt = 0.0 if thing.bolt is None else thing.bolt
        _check_numbers(f"the bolt of {name}", bolt, 0, where, least=0.0)
    if isinstance(thing, Box | Cylinder | Wrench):
        _check_numbers(f"the rgb of {name}", thing.rgb, 3, where)


def _check_numbers(
    what: str,
    value: object,
    count: int,
    where: str,
    above: float = -np.inf,
    least: float = -np.inf,
) -> None:
    """Checks that a value is so many finite numbers; a count of 0 is a number alone."""
    expected = "a number" if count == 0 else f"{count} numbers"
    if above == 0.0:
        expected += " above 0"
    if least == 0.0:
        expected += ", 0 or more"
    try:
        # A text of digits would become a number here, and fail where it is used.
        written = np.asarray(value).dtype.kind in "US"
        numbers = np.array(np.nan) if written else np.asarray(value, float)
    except (TypeError, ValueError):
        numbers = np.array(np.nan)
    right = numbers.shape == ((count,) if count else ())
    if not (right and np.all(np.isfinite(numbers) & (numbers > above) & (numbers >= least))):
        raise InputError(f"{what} is wrong", where=where, got=repr(value)[:80], expected=expected)


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
    if not changed and len(first) == len(second):
        # All that makes the scene: sizes, friction, shapes and joints, too.
        made, remade = ([tostring(t.body()) for t in draw.objects] for draw in (task, again))
        pairs = zip(task.objects, made, remade, strict=True)
        changed = [thing.name for thing, one, other in pairs if one != other]
    if changed or len(first) != len(second):
        raise InputError(
            "two draws of one seed differ",
            where=where,
            got=f"another {', '.join(changed) or 'number of objects or goals'}",
            expected="the same trial from the same seed",
            remedy="Draw all random numbers from `rng`, not from `random`, a generator or a clock",
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
    if task.plane == "front":
        for obj in task.objects:
            if not (isinstance(obj, MechanismPart) and obj.fixed) and over_a_side(obj, surface):
                raise InputError(
                    f"{obj.name} sticks out over a side of the touch surface",
                    where=where,
                    remedy="Place it further inside: no finger gets to its outer face",
                )
    widest = WIDEST * float(surface.size.max())
    try:
        scene = Scene(SceneSpec((), task.objects, task.table_friction, painted=task.painted))
    except ValueError as error:
        raise InputError(
            "MuJoCo refuses the scene", where=where, got=" ".join(str(error).split())[:300]
        ) from error
    for obj in task.objects:
        radius = scene.object_radius(obj.name)
        if radius > widest:
            raise InputError(
                f"{obj.name} is {2 * radius:.3g} m wide",
                where=where,
                expected=f"at most {2 * widest:.2f} m: sizes are in m",
                remedy='A mesh in mm is scaled in its MJCF: <mesh scale=".001 .001 .001" .../>',
            )
    _check_apart(scene, where, "Place them apart, or the physics would throw them across the table")


def over_a_side(thing: SceneObject, surface: Surface) -> bool:
    """True if an object, as it starts before an upright surface, sticks out over a side of it.

    Nobody can grip it there, so that a session would put it back for ever.

    Args:
        thing: The object; its yaw is about the vertical.
        surface: The surface as placed in the world.
    """
    position = np.asarray(thing.position, float)
    x, _, off = stacked_applied(surface.rotation.T, position - surface.corner).tolist()
    if not 0.0 < x < surface.size[0]:
        return True
    c, s = cos(thing.yaw), sin(thing.yaw)
    turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return reaches_a_side(thing, position, turned, surface, (x, off))


def reaches_a_side(
    thing: SceneObject,
    position: Array,
    rotation: Array,
    surface: Surface,
    place: tuple[float, float],
) -> bool:
    """True if the nearer side of an upright surface runs through an object.

    Args:
        thing: The object.
        position: (3,) m, its middle in the world.
        rotation: (3, 3), world from object.
        surface: The surface as placed in the world.
        place: m, where its middle is along the surface, and how far off it.
    """
    x, off = place
    width, height = METRES_PER_INCH * surface.width_in, METRES_PER_INCH * surface.height_in
    side = 0.0 if x < width / 2 else width
    points = np.column_stack([np.full(len(_SHARES), side), height * _SHARES])
    return bool(thing.clearance(surface.to_world(points, off), position, rotation).min() < 0.0)


def check_varied(task: Task, where: str, plain: Task | None = None) -> None:
    """Checks that the things of a varied trial are apart from each other and from the table.

    Args:
        task: The varied trial.
        where: Task and seed, for messages.
        plain: The trial before it was varied; None does not look at rings.

    Raises:
        InputError: Two things overlap; it names both. Or a thing starts inside of a ring that it
            was outside of.
    """
    before = set() if plain is None else _inside_rings(plain)
    inside = set() if plain is None else _inside_rings(task) - before
    if inside:
        raise InputError(
            "things start inside of the ring, where they are to be brought",
            where=where,
            got=", ".join(sorted(thing for _, thing in inside)),
            remedy="Vary it less",
        )
    scene = Scene(SceneSpec((), task.objects, task.table_friction, painted=task.painted))
    _check_apart(scene, where, "Vary it less: the physics would throw them across the table")


def _inside_rings(task: Task) -> set[tuple[str, str]]:
    """Names of painted rings and of the objects that start in each, in pairs."""
    return {
        (ring.name, thing.name)
        for ring in task.painted
        for thing in task.objects
        if length(np.subtract(thing.position[:2], ring.middle)) <= ring.radius
    }


def _check_apart(scene: Scene, where: str, remedy: str) -> None:
    deepest, pair = _deepest_overlap(scene)
    if deepest > DEEPEST:
        raise InputError(
            f"{pair[0]} and {pair[1]} overlap at the start",
            where=where,
            got=f"{1000 * deepest:.1f} mm deep",
            expected=f"at most {1000 * DEEPEST:g} mm",
            remedy=remedy,
        )


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


def measure(task: Task, sensing: Sensing) -> Measure:
    """Calls a task's `measure`, and checks its result.

    A progress below 0 or above 1 becomes the nearest of the two.

    Raises:
        InputError: `measure` of the task returns something else, such as nothing, or a progress
            that is no number; or it would end the program, which then ended as if all were well.
    """
    try:
        result = task.measure(sensing)
    except SystemExit as error:
        raise InputError(
            "`measure` ends the program",
            where=task.name,
            got=failure(error),
            expected="a Measure, such as `return judge(...)`",
        ) from error
    if not isinstance(result, Measure):
        raise InputError(
            "`measure` did not return a Measure",
            where=task.name,
            got=repr(result)[:80],
            expected="a Measure, such as `return judge(...)`",
            remedy="Every branch of `measure` needs a `return`",
        )
    return result if _plain(result) else _made_plain(result, task.name)


def _plain(result: Measure) -> bool:
    """True if all values are Python's own, and sound."""
    return (
        type(result.reached) is bool
        and type(result.lost) is bool
        and type(result.progress) is float
        and 0.0 <= result.progress <= 1.0
        and isinstance(result.reason, str)
        and (result.first is None or (isinstance(result.first, Measure) and _plain(result.first)))
    )


def _made_plain(result: Measure, task: str) -> Measure:
    """The same measure in Python's own values: NumPy's cannot be written into a recording.

    Raises:
        InputError: `reached` or `lost` is neither true nor false, `progress` is no finite number,
            or `reason` no text.
    """
    first, told = result.first, "of what `measure` returned"
    if first is not None and not isinstance(first, Measure):
        raise InputError(
            f"`first` {told} is no Measure", where=task, got=repr(first)[:80], expected="a Measure"
        )
    if not isinstance(result.reason, str):
        raise InputError(
            f"`reason` {told} is no text", where=task, got=repr(result.reason)[:80], expected="text"
        )
    try:
        reached, lost = bool(result.reached), bool(result.lost)
    except ValueError:
        raise InputError(
            f"`reached` or `lost` {told} is neither true nor false",
            where=task,
            got=f"{result.reached!r} and {result.lost!r}"[:80],
            expected="one truth value each",
            remedy="`(...).all()` makes one of several",
        ) from None
    try:
        progress = float(result.progress)
    except (TypeError, ValueError):
        progress = nan
    if not isfinite(progress):
        raise InputError(
            f"`progress` {told} is no finite number",
            where=task,
            got=repr(result.progress)[:80],
            expected="0 to 1",
            remedy="A division by zero gives such a number",
        )
    return Measure(
        reached,
        min(max(progress, 0.0), 1.0),
        result.reason,
        lost,
        None if first is None else _made_plain(first, task),
    )
