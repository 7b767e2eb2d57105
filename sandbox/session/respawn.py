"""Respawn: returns objects that leave the workspace to their start, or to the nearest free place.

The workspace is where a finger on the touch surface can reach an object. No touch could bring back
an object outside the workspace. After a moment such an object is put down at rest, and counted. The
session does this and not the task, because tasks only read the simulation.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from itertools import pairwise
from math import fsum

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.correction import PAD_HEIGHT
from models.arithmetic import Array, squared_lengths, stacked_applied
from models.objects import MechanismPart, SceneObject
from models.scene import CONTROL_PERIOD, Scene
from models.surface import METRES_PER_INCH, Surface
from sandbox.session.collision_gating import FINGERTIP
from tasks.task import reaches_a_side

AWAY = 0.5
"""Time (s) for which an object must be out of reach before it returns, so that the person can
follow it."""
GRIP = 0.005
"""For a grip, the point of the fingertips' plane nearest to an object's centre must be at least
this deep (m) in the object. In front of an upright surface, fingertips move only in this plane."""
CEILING = 0.5
"""Height (m) above a flat surface that no lifted object reaches."""
FLOOR = -0.05
"""World z (m): an object whose centre is lower has sunk through the table."""
BORDER = 0.030
"""Smallest distance (m) from the surface's border to the centre of an object that is put down
elsewhere than at its start."""
ROOM = 0.005
"""Smallest gap (m) between an object that is put down and its neighbours."""
BESIDE_GOAL = 0.030
"""Smallest distance (m) from every goal to a place for an object, if the place is nearer to a goal
than the object's start.
"""
GRID = 0.010
"""Distance (m) between two candidate places."""
FARTHEST = 0.40
"""Largest distance (m) of a candidate place from the start."""
NEAREST = 64
"""Largest number of candidate places that are checked by MuJoCo's contacts, if the balls around
objects leave no place free."""


class Respawn:
    """Watches the objects of a scene that can leave the workspace, and puts them back.

    Args:
        scene: The scene.
        surfaces: Touch surfaces, one per hand.
        goals: (n, 3) m, goal positions of objects. Places that are no nearer to a goal than the
            object's start are tried first. A place nearer than the start must be at least
            `BESIDE_GOAL` from every goal.

    Attributes:
        counts: Number of returns of each object, by name; without the objects that never left.
    """

    def __init__(self, scene: Scene, surfaces: Sequence[Surface], goals: ArrayLike = ()) -> None:
        self._scene, self._surfaces = scene, tuple(surfaces)
        self._regions = [_Region(surface) for surface in surfaces]
        # Objects that cannot leave are obstacles where an object is put down.
        self._all = [_Place(scene, t) for t in scene.spec.objects]
        by_name = {place.name: place for place in self._all}
        # A free mechanism is several objects that come and go together.
        self._parts = {
            place.name: [place, *(by_name[n] for n in place.together if n != place.name)]
            if place.free
            else [place]
            for place in self._all
        }
        self._objects = [place for place in self._all if place.can_leave]
        self._away = {place.name: 0 for place in self._objects}
        self._goals = np.asarray(goals, float).reshape(-1, 3)
        # Computed once, because all candidate places are tried at every step while none is free.
        self._shifts = {place.name: self._reachable(place) for place in self._objects}
        self.counts: dict[str, int] = {}

    def step(self, data: mujoco.MjData, hands: Callable[[], tuple[Array, Array]]) -> list[str]:
        """Puts back the objects that have been away for long enough; call once per control period.

        Args:
            data: The simulation; changed, and brought up to date, if an object is put back.
            hands: Returns the middles (n, 3) and radii (n,), m, of balls that cover the parts of
                the hands that can be solid. These balls must stay clear.

        Returns:
            Names of the objects that were put back.
        """
        back = []
        for place in self._objects:
            parts = self._parts[place.name]
            out = not any(self._within(data, p, r) for p in parts for r in self._regions)
            self._away[place.name] = self._away[place.name] + 1 if out else 0
            if self._away[place.name] * CONTROL_PERIOD >= AWAY and self._put(data, place, *hands()):
                self._away[place.name] = 0
                self.counts[place.name] = self.counts.get(place.name, 0) + 1
                back.append(place.name)
                # Another object that is put back in the same step must not land on this one.
                mujoco.mj_forward(self._scene.model, data)
        return back

    def _within(self, data: mujoco.MjData, place: _Place, region: _Region) -> bool:
        """True if a finger on a surface could reach an object at its current place."""
        position, surface = data.xpos[place.body], region.surface
        reach = place.radius + FINGERTIP
        _, _, z = at = position.tolist()
        x, up, off = region.seen(at)
        width, height, flat = region.width, region.height, region.flat
        near = (
            z > FLOOR
            and -reach < x < width + reach
            and -reach < -up < height + reach
            and abs(off) < (CEILING if flat else reach)
        )
        if near and not flat:
            if self._over_a_side(data, place, surface, x, off):
                return False
            # The person cannot see depth. Fingers close in one plane, which must cut the object.
            foot = position - (off - PAD_HEIGHT) * surface.rotation[:, 2]
            rotation = data.xmat[place.body].reshape(3, 3)
            return bool(place.thing.clearance(foot[None], position, rotation)[0] < -GRIP)
        if not near or (0.0 < x < width and 0.0 < -up < height):
            return near
        # The centre is beside the surface: a finger at the border can only push the object away,
        # unless a part of the object is over the surface.
        points = surface.to_world(_border(width, height), off)
        rotation = data.xmat[place.body].reshape(3, 3)
        return bool(place.thing.clearance(points, position, rotation).min() < 0.0)

    def _over_a_side(
        self, data: mujoco.MjData, place: _Place, surface: Surface, x: float, off: float
    ) -> bool:
        """True if an object in front of an upright surface extends beyond the surface's left or
        right side. No finger reaches its outer face then, and it cannot be gripped.

        Args:
            data: The simulation.
            place: The object.
            surface: The surface.
            x: m, position of the object's centre along the surface.
            off: m, distance of the object's centre from the surface.
        """
        width = METRES_PER_INCH * surface.width_in
        far = min(x, width - x)
        if far <= 0.0:
            return True
        if far > place.radius:
            return False
        rotation = data.xmat[place.body].reshape(3, 3)
        return reaches_a_side(place.thing, data.xpos[place.body], rotation, surface, (x, off))

    def _put(self, data: mujoco.MjData, place: _Place, points: Array, radii: Array) -> bool:
        """Puts an object at the free place nearest to its start; False without a free place.

        The start is free if the object touches nothing there. Another place is free if the balls
        around the objects are apart, so that fingers have room between the objects. If no place is
        free by this rule, a place where the object touches no other object counts as free.
        """
        others = [p for p in self._all if p is not place and p.name not in place.together]
        shifts = self._shifts[place.name]
        tried, bodies = copy.copy(data), [other.body for other in others]

        def apart(shift: Array) -> bool:
            return self._clear_of_hands(tried, place, shift, points, radii) and self._touches_none(
                tried, place, shift, bodies
            )

        start = np.zeros(3)
        if apart(start):
            place.put(data, start)
            return True
        free = np.ones(len(shifts), bool)
        for other in others:
            beside = np.sqrt(squared_lengths(place.home + shifts - data.xpos[other.body]))
            free &= beside > place.radius + other.radius + ROOM
        for shift in shifts[free]:
            if self._clear_of_hands(tried, place, shift, points, radii):
                place.put(data, shift)
                return True
        # A ball around a long object is much larger than the object.
        for shift in shifts[:NEAREST]:
            if apart(shift):
                place.put(data, shift)
                return True
        return False

    def _clear_of_hands(
        self, tried: mujoco.MjData, place: _Place, shift: Array, points: Array, radii: Array
    ) -> bool:
        """True if an object at its start, moved by a shift (3,) m, and the objects that it carries
        are clear of all balls. A copy of the state, `tried`, is changed for this test."""
        parts = self._parts[place.name]
        if len(parts) == 1 and place.anywhere:
            clear = place.thing.clearance(points, place.home + shift, place.turn)
            return bool(np.all(clear > radii + ROOM))
        place.put(tried, shift)
        mujoco.mj_kinematics(self._scene.model, tried)
        return all(
            np.all(
                part.thing.clearance(
                    points, tried.xpos[part.body], tried.xmat[part.body].reshape(3, 3)
                )
                > radii + ROOM
            )
            for part in parts
        )

    def _touches_none(
        self, tried: mujoco.MjData, place: _Place, shift: Array, others: list[int]
    ) -> bool:
        """True if an object at its start, moved by a shift (3,) m, touches no other object.

        Args:
            tried: A copy of the simulation's state, in which the object is moved.
            place: The object.
            shift: The shift (3,), m.
            others: Bodies of the other objects.
        """
        model = self._scene.model
        place.put(tried, shift)
        mujoco.mj_kinematics(model, tried)
        mujoco.mj_collision(model, tried)
        root = model.body_rootid
        of_pairs = root[model.geom_bodyid[tried.contact.geom]]
        mine = (of_pairs == root[place.body]).any(axis=1)
        theirs = np.isin(of_pairs, root[others]).any(axis=1)
        return not bool((mine & theirs).any())

    def _reachable(self, place: _Place) -> Array:
        """(n, 3) m, shifts from an object's start to candidate places; zero comes first."""
        if not place.anywhere:
            return _SHIFTS[:1]
        # An object on rails, or in front of an upright surface, keeps its depth.
        anywhere = place.free and any(_flat(s) for s in self._surfaces)
        shifts = _SHIFTS if anywhere else _SHIFTS[_SHIFTS[:, 1] == 0.0]
        there = np.any([_inside(s, place.home + shifts) for s in self._surfaces], axis=0)
        there |= ~shifts.any(axis=1)
        if not len(self._goals):
            return np.asarray(shifts[there])
        # The loss of an object must not bring it nearer to its goal.
        away = [squared_lengths(place.home + shifts - goal) for goal in self._goals]
        nearest = np.min(away, axis=0)
        fair = nearest >= nearest[0]
        beside = ~fair & (nearest >= BESIDE_GOAL * BESIDE_GOAL)
        return np.concatenate([shifts[there & fair], shifts[there & beside]])


class _Region:
    """A touch surface, as plain floats, since objects are checked in every step.

    Args:
        surface: The surface.

    Attributes:
        surface: As given.
        width, height: m, size of the surface.
        flat: True if it lies on the table.
    """

    def __init__(self, surface: Surface) -> None:
        self.surface = surface
        self.width = METRES_PER_INCH * surface.width_in
        self.height = METRES_PER_INCH * surface.height_in
        self.flat = _flat(surface)
        self._corner = surface.corner.tolist()
        self._axes = None if surface.aligned else surface.rotation.T.tolist()

    def seen(self, position: list[float]) -> list[float]:
        """Surface coordinates (m) of a world position (3,) m: to the right, up, and distance."""
        away = [p - c for p, c in zip(position, self._corner, strict=True)]
        if self._axes is None:
            return away
        x, y, z = away
        return [a * x + b * y + c * z for a, b, c in self._axes]


class _Place:
    """An object's addresses in MuJoCo's arrays, and its start."""

    def __init__(self, scene: Scene, thing: SceneObject) -> None:
        model = scene.model
        self.thing, self.name = thing, thing.name
        self.body = body = scene.object_bodies[thing.name]
        joints = np.flatnonzero(model.jnt_bodyid == body)
        types = model.jnt_type[joints]
        self.free = bool(np.any(types == mujoco.mjtJoint.mjJNT_FREE))
        slides = types == mujoco.mjtJoint.mjJNT_SLIDE
        # An object hinged to the table cannot leave. An object that slides along two axes, or on a
        # slide without ends, can leave.
        endless = slides & (model.jnt_limited[joints] == 0)
        self.anywhere = self.free or int(slides.sum()) >= 2
        self.can_leave = self.anywhere or bool(endless.any())
        self.radius = scene.object_radius(thing.name)
        # The other parts of a mechanism move with the object.
        self.together = thing.together if isinstance(thing, MechanismPart) else ()
        if not self.can_leave:
            return
        first, last = joints[0], joints[-1]
        end = model.nq if last + 1 == model.njnt else model.jnt_qposadr[last + 1]
        self._qpos = slice(int(model.jnt_qposadr[first]), int(end))
        end = model.nv if last + 1 == model.njnt else model.jnt_dofadr[last + 1]
        self._dofs = slice(int(model.jnt_dofadr[first]), int(end))
        # The bodies that the object carries come to rest with it.
        if self.free:
            root = model.body_rootid
            carried = int((root[model.dof_bodyid] == root[body]).sum())
            self._dofs = slice(self._dofs.start, self._dofs.start + carried)
        rotation = np.empty(9)
        mujoco.mju_quat2Mat(rotation, model.body_quat[body])
        self.turn = rotation.reshape(3, 3)
        self.home = model.body_pos[body].copy()
        self._start = model.qpos0[self._qpos].copy()
        self._slides = [
            (
                int(model.jnt_qposadr[j]) - self._qpos.start,
                stacked_applied(self.turn, model.jnt_axis[j]),
            )
            for j in joints[slides]
        ]

    def put(self, data: mujoco.MjData, shift: Array) -> None:
        """Puts the object at rest at its start, moved by a shift (3,) m in the world."""
        start = self._start.copy()
        if self.free:
            start[:3] += shift
        for at, axis in self._slides:
            start[at] += fsum((axis * shift).tolist())
        data.qpos[self._qpos] = start
        data.qvel[self._dofs] = 0.0
        data.qacc_warmstart[self._dofs] = 0.0


def _flat(surface: Surface) -> bool:
    return bool(surface.rotation[2, 2] > 0.7)


def _inside(surface: Surface, positions: Array) -> NDArray[np.bool_]:
    """(n,) bool, True for world positions (n, 3) m more than `BORDER` inside the surface's edge."""
    xy, size = surface.to_surface(positions), surface.size
    if not _flat(surface):
        # An object that stands on the table is at the lower edge of an upright surface.
        xy, size = xy[:, :1], size[:1]
    return np.asarray(np.all((xy > BORDER) & (xy < size - BORDER), axis=1))


_SHARES = np.linspace(0.0, 1.0, 50)
"""Positions of checked points along a side of a surface, as shares of its length."""


def _border(width: float, height: float) -> Array:
    """(n, 2) m, points along the border of a surface of this size."""
    share = _SHARES[:, None]
    corners = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height], [0.0, 0.0]])
    sides: list[Array] = [a + share * (b - a) for a, b in pairwise(corners)]
    return np.asarray(np.concatenate(sides), float)


def _shifts() -> Array:
    """(n, 3) m, shifts along the table, shortest first, in the same order on every machine."""
    steps = np.arange(-round(FARTHEST / GRID), round(FARTHEST / GRID) + 1)
    x, y = (a.ravel() for a in np.meshgrid(steps, steps))
    order = np.lexsort((y, x, x * x + y * y))
    return np.asarray(GRID * np.column_stack([x, y, np.zeros_like(x)])[order], float)


_SHIFTS = _shifts()
