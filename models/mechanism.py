"""Mechanisms from MJCF, such as knobs, keys, drawers and lids: bodies joined by hinges and slides.

MuJoCo compiles the description separately from the scene, as it does for a `MjcfObject`. Every body
of the mechanism then becomes an object of the scene, so that tasks, views and hands treat it as
they treat any other object.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import atan2, cos, sin, sqrt
from numbers import Real
from pathlib import Path
from typing import Any, NoReturn
from xml.etree.ElementTree import Element, SubElement

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array, length, matrix_product, squared_lengths, stacked_applied
from models.errors import InputError
from models.hand import CONTACT_HAND, CONTACT_OBJECT, CONTACT_TABLE
from models.mechanism_description import PROBE, PROBE_RADIUS, Compiled, compile_mechanism
from models.mjcf_object import (
    GEOM_KINDS,
    check_object_name,
    check_position,
    described_in,
    geom_element,
    mesh_assets,
    mesh_points,
    solid_geoms,
)
from models.objects import Joint, MechanismPart, mjcf_text

TOUCH = 0.0005
"""Largest gap (m) between surfaces at which a finger counts as touching a part. A finger that
presses a key bounces by less than this between two steps. Contacts within the gap exert no force in
MuJoCo 4; forces begin at the surface."""
_FAR = 100.0
"""Largest distance (m) that is measured."""
_LONGEST = 1.0
"""Longest range (m) of a slide. A longer range exceeds any reach, and was probably written in mm or
degrees by mistake."""
_ROUNDING = 1e-9
"""Distance (m or rad) beyond a joint's range that still counts as within it."""
_DEGREES = 'Angles in MJCF are degrees unless it says <compiler angle="radian"/>; a start is in rad'
"""Next step for a hinge that starts outside of its range."""
_FIXED_BITS = (CONTACT_OBJECT, CONTACT_HAND | CONTACT_OBJECT)
_FREE_BITS = (CONTACT_OBJECT | CONTACT_TABLE, CONTACT_HAND | CONTACT_OBJECT | CONTACT_TABLE)
"""MuJoCo's contype and conaffinity of parts of fixed and of free mechanisms. Parts of a fixed
mechanism do not collide with the table, since a part such as a key may move below its surface."""


@dataclass(frozen=True)
class Mechanism:
    """Bodies from MJCF that are joined by hinges and slides: a first body, which stands in the
    world, and the bodies that it carries.

    A scene uses these parts of the description: bodies, geoms, masses and friction as for a
    `MjcfObject`; the margins of geoms (skins around them); and the axis, position, range,
    stiffness, springref, damping, frictionloss, armature and ref of every joint. The first body is
    fixed in place unless it has a free joint, a hinge or a slide. Parts of one mechanism do not
    collide with each other, and parts of a fixed mechanism do not collide with the table.

    Attributes:
        name: Name of the first body. Any other body is called NAME/BODY.
        mjcf: A whole description, `<mujoco>...`, or the path of a file, such as
            `Path(__file__).parent / "desk.xml"`. A relative path starts at the current folder.
        position: (3,) m, origin of the first body.
        yaw: Yaw (rad) about the vertical, of the first body.
        start: Name of a body in the description -> value (rad or m) at which its joint starts.
            Other joints start as described.
        size: Factor on all lengths.
        mass: Factor on all masses.
        resistance: Factor on stiffness, damping and friction of all joints.

    Raises:
        InputError: MuJoCo cannot compile the description, it is not a mechanism, a joint has no
            range or starts outside of it, or a slide is longer than 1 m.
    """

    name: str
    mjcf: str | Path = field(repr=False)
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw: float = 0.0
    start: Mapping[str, float] = field(default_factory=dict)
    size: float = 1.0
    mass: float = 1.0
    resistance: float = 1.0

    def __post_init__(self) -> None:
        check_object_name(self.name, "Mechanism")
        where = described_in(self.mjcf, self.name)
        check_position(self.position, where)
        for what in ("size", "mass", "resistance"):
            value = vars(self)[what]
            if not isinstance(value, Real) or not 0.0 < float(value) < float("inf"):
                raise InputError(
                    f"its {what} is out of range",
                    where=where,
                    got=repr(value),
                    expected="a number above 0",
                )
        for body, value in self.start.items():
            if not isinstance(value, Real):
                raise InputError(
                    f"the start of {body} is not a number", where=where, got=repr(value)
                )
        named = {self._described(part.number): part.joint for part in self.parts if part.joint}
        unknown = sorted(set(self.start) - set(named))
        if unknown:
            raise InputError(
                "no such joint to start",
                where=where,
                got=", ".join(unknown),
                expected=", ".join(sorted(named)),
            )
        for body, joint in named.items():
            low, high = joint.range or (-np.inf, np.inf)
            if joint.kind == "slide" and joint.range and high - low > _LONGEST:
                raise InputError(
                    f"the slide of {body or self.name} is too long",
                    where=where,
                    got=f"{low:g} to {high:g} m",
                    expected=f'at most {_LONGEST:g} m from end to end, such as range="0 0.05"',
                )
            if not low <= joint.start <= high:
                raise InputError(
                    f"{body} starts outside of its range",
                    where=where,
                    got=f"{joint.start:g} {joint.unit}",
                    expected=f"{low:g} to {high:g} {joint.unit}",
                    remedy=_DEGREES if joint.kind == "hinge" else None,
                )

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """The bodies as objects of a scene, carriers first; a task needs all of them."""
        return tuple(Part(self, number) for number in range(len(self.compiled.bodies)))

    def part(self, body: str) -> Part:
        """The part of a body, by its name in the description.

        Raises:
            InputError: The description has no such body.
        """
        for part in self.parts:
            if self._described(part.number) == body:
                return part
        raise InputError(
            "this mechanism has no such body",
            where=described_in(self.mjcf, self.name),
            got=body,
            expected=", ".join(self._described(part.number) for part in self.parts),
        )

    def body(self) -> NoReturn:
        """Always raises: the parts of a mechanism are objects of a scene, the mechanism is not.

        Raises:
            InputError: Always.
        """
        raise InputError(
            "a mechanism is not an object itself, its parts are",
            where=described_in(self.mjcf, self.name),
            remedy="For a mechanism `desk`, return *desk.parts among the objects",
        )

    def scaled(self, size: float) -> Mechanism:
        """The same mechanism with all lengths multiplied by a factor, at the same place."""
        slides = {
            self._described(part.number)
            for part in self.parts
            if part.joint and part.joint.kind == "slide"
        }
        start = {
            body: value * (size if body in slides else 1.0) for body, value in self.start.items()
        }
        return replace(self, size=size * self.size, start=start)

    @cached_property
    def compiled(self) -> Compiled:
        """MuJoCo's model of the description."""
        return compile_mechanism(self.mjcf, self.name)

    def _described(self, number: int) -> str:
        """Name of a body in the description."""
        return str(self.compiled.model.body(number + 1).name)


@dataclass(frozen=True)
class Part(MechanismPart):
    """One body of a mechanism, as an object of a scene.

    Attributes:
        mechanism: The mechanism.
        number: Index of the body, 0 for the first body.
    """

    mechanism: Mechanism
    number: int

    @cached_property
    def name(self) -> str:
        """Name of the body and of its joint in the scene."""
        own = self.mechanism
        return f"{own.name}/{own._described(self.number)}" if self.number else own.name

    @property
    def mass(self) -> float:
        """Mass (kg) of the body."""
        return self.mechanism.mass * float(self._model.body_mass[self._body])

    @cached_property
    def position(self) -> tuple[float, float, float]:
        """Origin (3,) m of the body at the start."""
        x, y, z = self._start[0].tolist()
        return x, y, z

    @cached_property
    def yaw(self) -> float:
        """Yaw (rad) of the body's x axis about the vertical at the start."""
        rotation = self._start[1]
        return atan2(rotation[1, 0], rotation[0, 0])

    @property
    def mjcf(self) -> str | Path:
        """Description of the mechanism."""
        return self.mechanism.mjcf

    @cached_property
    def carrier(self) -> str | None:
        """Name of the part that carries this part; None for the first body."""
        if not self.number:
            return None
        return self.mechanism.parts[int(self._model.body_parentid[self._body]) - 1].name

    @cached_property
    def together(self) -> tuple[str, ...]:
        """Names of all parts of the mechanism."""
        return tuple(part.name for part in self.mechanism.parts)

    @property
    def fixed(self) -> bool:
        """True for the first body of a fixed mechanism."""
        return self.number == 0 and self.mechanism.compiled.fixed

    @cached_property
    def joint(self) -> Joint | None:
        """Hinge or slide of this part; None for a first body that is fixed or free."""
        at = self._joint_index
        if at is None:
            return None
        model, own = self._model, self.mechanism
        slide = model.jnt_type[at] == mujoco.mjtJoint.mjJNT_SLIDE
        unit = own.size if slide else 1.0
        low, high = (unit * model.jnt_range[at]).tolist()
        described = unit * float(model.qpos0[model.jnt_qposadr[at]])
        return Joint(
            "slide" if slide else "hinge",
            (low, high) if model.jnt_limited[at] else None,
            own.start.get(own._described(self.number), described),
        )

    def placed(self, value: float) -> tuple[tuple[float, float, float], float]:
        """Position (3,) m and yaw (rad) of the body with its joint at a value (rad or m) and all
        other joints at their starts.

        Raises:
            InputError: The part has no joint, or the value is outside of the joint's range.
        """
        if self.joint is None:
            raise InputError("this part has no joint", where="Part.placed", got=self.name)
        low, high = self.joint.range or (-np.inf, np.inf)
        if not low - _ROUNDING <= value <= high + _ROUNDING:
            raise InputError(
                f"the joint of {self.name} cannot be at this value",
                where="Part.placed",
                got=f"{value:g}",
                expected=f"{low:g} to {high:g} {'m' if self.joint.kind == 'slide' else 'rad'}",
                remedy="Choose a goal within the joint's range, or a longer range in the MJCF",
            )
        position, rotation = self._pose(value)
        x, y, z = position.tolist()
        return (x, y, z), atan2(rotation[1, 0], rotation[0, 0])

    @cached_property
    def lowest(self) -> float:
        """Height (m) of the lowest solid point at the start; infinite without a solid geom."""
        position, rotation = self._start
        size, lowest = self.mechanism.size, np.inf
        for kind, place, turn, dimensions, geom in self._solid:
            down = -matrix_product(rotation, turn)[2]
            if kind == "mesh":
                reach = mesh_reach(
                    down, mesh_points(self._model, int(self._model.geom_dataid[geom]))
                )
            else:
                reach = REACHES[kind](down, dimensions)
            reach += float(self._model.geom_margin[geom])
            middle = float(stacked_applied(rotation, place)[2])
            lowest = min(lowest, float(position[2]) + size * (middle - reach))
        return lowest

    def varied(self, size: float, mass: float, resistance: float) -> Part:
        """The same part of the mechanism in another size, with other masses and joints.

        The lowest point of a free mechanism keeps its height.

        Args:
            size: Factor on all lengths.
            mass: Factor on all masses.
            resistance: Factor on stiffness, damping and friction of joints.
        """
        own = self.mechanism.scaled(size) if size != 1.0 else self.mechanism
        if size != 1.0 and not (own.compiled.fixed or own.parts[0].joint):
            x, y, z = own.position
            below = min(part.lowest for part in self.mechanism.parts) - z
            own = replace(own, position=(x, y, z + (1.0 - size) * below))
        changed = replace(own, mass=own.mass * mass, resistance=own.resistance * resistance)
        return changed.parts[self.number]

    def body(self) -> Element:
        """MJCF of the body and of all bodies that it carries."""
        model, own, at = self._model, self.mechanism, self._body
        position, turn = self._local(None if self.joint is None else self.joint.start)
        body = Element(
            "body", {"name": self.name, "pos": mjcf_text(position), "quat": mjcf_text(turn)}
        )
        if model.body_gravcomp[at]:
            body.set("gravcomp", f"{float(model.body_gravcomp[at]):.9g}")
        if self._joint_index is not None:
            body.append(self._joint_element(self._joint_index))
        elif not self.fixed:
            SubElement(body, "freejoint", {"name": self.name})
        inertia = own.size**2 * own.mass * model.body_inertia[at]
        SubElement(
            body,
            "inertial",
            {
                "pos": mjcf_text(own.size * model.body_ipos[at]),
                "quat": mjcf_text(model.body_iquat[at]),
                "mass": f"{self.mass:.9g}",
                "diaginertia": mjcf_text(inertia),
            },
        )
        bits = _FIXED_BITS if own.compiled.fixed or own.parts[0].joint else _FREE_BITS
        for number, geom in enumerate(self._geoms):
            name = f"{self.name}_{number}"
            element = geom_element(model, geom, name, own.name, own.size, bits)
            if geom in {solid[-1] for solid in self._solid}:
                element.set("gap", f"{TOUCH:.9g}")
                if model.geom_margin[geom]:
                    element.set("margin", f"{own.size * float(model.geom_margin[geom]):.9g}")
            body.append(element)
        for part in own.parts:
            if part.carrier == self.name:
                body.append(part.body())
        return body

    def assets(self) -> list[Element]:
        """MJCF mesh assets of the whole mechanism, from its first body; empty for other parts."""
        if self.number:
            return []
        geoms = [geom for part in self.mechanism.parts for geom in part._geoms]
        return mesh_assets(self._model, geoms, self.mechanism.name, self.mechanism.size)

    def clearance(self, points: ArrayLike, position: Array, rotation: Array) -> Array:
        """Signed distances (n,) m of world points to the part's solid geoms, negative inside.

        Args:
            points: (n, 3) m, points in the world.
            position: (3,) m, current position of the body.
            rotation: (3, 3) current rotation of the body.
        """
        size = self.mechanism.size
        away = np.atleast_2d(np.asarray(points, float)) - position
        local = matrix_product(away, np.ascontiguousarray(rotation)) / size
        distances = np.full(len(local), np.inf)
        for kind, place, turn, dimensions, geom in self._solid:
            distance = DISTANCES.get(kind)
            own = (
                self._measured(local, geom)
                if distance is None
                else distance(matrix_product(local - place, turn), dimensions)
            )
            distances = np.minimum(distances, own - self._model.geom_margin[geom])
        return size * distances

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest corner (3,), (3,) m of a box around the solid geoms, in the body's
        frame; both at its origin if it has no solid geom."""
        corners = [] if self._solid else [np.zeros(3)]
        for _, place, turn, _, geom in self._solid:
            middle, half = self._model.geom_aabb[geom, :3], self._model.geom_aabb[geom, 3:]
            centre = place + stacked_applied(turn, middle)
            reach = stacked_applied(np.abs(turn), half) + self._model.geom_margin[geom]
            corners += [centre - reach, centre + reach]
        size = self.mechanism.size
        return size * np.min(corners, axis=0), size * np.max(corners, axis=0)

    @property
    def _model(self) -> Any:
        return self.mechanism.compiled.model

    @property
    def _body(self) -> int:
        return self.number + 1

    @property
    def _joint_index(self) -> int | None:
        """MuJoCo's index of the hinge or slide; None if the body has neither."""
        at = int(self._model.body_jntadr[self._body])
        free = at < 0 or self._model.jnt_type[at] == mujoco.mjtJoint.mjJNT_FREE
        return None if free else at

    @cached_property
    def _geoms(self) -> list[int]:
        return np.flatnonzero(self._model.geom_bodyid == self._body).tolist()

    @cached_property
    def _solid(self) -> list[tuple[str, Array, Array, Array, int]]:
        """Every solid geom: kind, position (3,) m and rotation (3, 3) in the body, size, index."""
        model, solid = self._model, []
        for geom in self._geoms:
            if solid_geoms(model)[geom]:
                kind, _ = GEOM_KINDS[int(model.geom_type[geom])]
                turn = _matrix(model.geom_quat[geom])
                solid.append((kind, model.geom_pos[geom], turn, model.geom_size[geom], geom))
        return solid

    @cached_property
    def _start(self) -> tuple[Array, Array]:
        """Position (3,) m and rotation (3, 3) in the world at the start."""
        return self._pose(None if self.joint is None else self.joint.start)

    def _pose(self, value: float | None) -> tuple[Array, Array]:
        """Position (3,) m and rotation (3, 3) in the world, with the part's joint at a value."""
        position, turn = self._local(value)
        if not self.number:
            return position, _matrix(turn)
        carrier = self.mechanism.parts[int(self._model.body_parentid[self._body]) - 1]
        base, rotation = carrier._start
        own = matrix_product(rotation, _matrix(turn))
        return base + stacked_applied(rotation, position), own

    def _local(self, value: float | None) -> tuple[Array, Array]:
        """Position (3,) m and quaternion (4,) in the carrier, the joint at a value (rad or m)."""
        model, own = self._model, self.mechanism
        if self.number:
            position = own.size * model.body_pos[self._body]
            turn = model.body_quat[self._body].copy()
        else:
            position = np.array(own.position)
            turn = np.array([cos(own.yaw / 2), 0.0, 0.0, sin(own.yaw / 2)])
        at = self._joint_index
        if at is None or value is None:
            return position, turn
        axis, ref = model.jnt_axis[at], float(model.qpos0[model.jnt_qposadr[at]])
        if model.jnt_type[at] == mujoco.mjtJoint.mjJNT_SLIDE:
            moved = (value - own.size * ref) * axis
            return position + stacked_applied(_matrix(turn), moved), turn
        # The body turns about the hinge, whose position does not change.
        place = own.size * model.jnt_pos[at]
        about, turned, away = np.empty(4), np.empty(4), np.empty(3)
        mujoco.mju_axisAngle2Quat(about, axis, value - ref)
        mujoco.mju_mulQuat(turned, turn, about)
        mujoco.mju_rotVecQuat(away, place, about)
        return position + stacked_applied(_matrix(turn), place - away), turned

    def _joint_element(self, at: int) -> Element:
        """MJCF of the hinge or slide, with angles in degrees."""
        model, own, joint = self._model, self.mechanism, self.joint
        assert joint is not None
        hinge = joint.kind == "hinge"
        unit = float(np.rad2deg(1.0)) if hinge else 1.0
        scale = 1.0 if hinge else own.size
        dof = int(model.jnt_dofadr[at])
        spring = scale * float(model.qpos_spring[model.jnt_qposadr[at]])
        resisting = {
            "stiffness": _polynomial(model.jnt_stiffness[at], model.jnt_stiffnesspoly[at]),
            "damping": _polynomial(model.dof_damping[dof], model.dof_dampingpoly[dof]),
            "frictionloss": [float(model.dof_frictionloss[dof])],
        }
        element = Element(
            "joint",
            {
                "name": self.name,
                "type": joint.kind,
                "axis": mjcf_text(model.jnt_axis[at]),
                "pos": mjcf_text(own.size * model.jnt_pos[at]),
                "limited": "false" if joint.range is None else "true",
                "ref": f"{unit * joint.start:.9g}",
                "springref": f"{unit * spring:.9g}",
                "armature": f"{float(model.dof_armature[dof]):.9g}",
                **{key: mjcf_text(own.resistance * np.array(c)) for key, c in resisting.items()},
                "solreflimit": ".004 1",
                "solimplimit": ".95 .99 .001",
                "solreffriction": ".004 1",
                "solimpfriction": ".9999 .9999 .001",
            },
        )
        if joint.range is not None:
            element.set("range", mjcf_text(unit * np.array(joint.range)))
        return element

    def _measured(self, local: Array, geom: int) -> Array:
        """Distances (n,) m of points (n, 3) m in the body's frame to a geom without a formula."""
        model, data = self._model, self._measuring
        probe = int(model.geom(PROBE).id)
        rotation = data.xmat[self._body].reshape(3, 3)
        distances = np.empty(len(local))
        for i, point in enumerate(local):
            data.mocap_pos[0] = data.xpos[self._body] + stacked_applied(rotation, point)
            mujoco.mj_kinematics(model, data)
            far = mujoco.mj_geomDistance(model, data, geom, probe, _FAR, None)
            distances[i] = float(far) + PROBE_RADIUS
        return distances

    @cached_property
    def _measuring(self) -> Any:
        data = mujoco.MjData(self._model)
        mujoco.mj_kinematics(self._model, data)
        return data


def _polynomial(linear: float, higher: Array) -> list[float]:
    """Coefficients of a spring or damper for MJCF: the linear coefficient, then those of higher
    orders if any is not zero (MuJoCo 4)."""
    return [float(linear), *(higher.tolist() if np.any(higher) else ())]


def _matrix(quaternion: Array) -> Array:
    """Rotation (3, 3) of a quaternion (4,)."""
    flat = np.empty(9)
    mujoco.mju_quat2Mat(flat, quaternion)
    return flat.reshape(3, 3)


def sphere_distance(points: Array, size: Array) -> Array:
    """Signed distances (n,) m of points (n, 3) to a sphere; `size` is its radius."""
    return np.asarray(np.sqrt(squared_lengths(points)) - size[0])


def capsule_distance(points: Array, size: Array) -> Array:
    """Signed distances (n,) m of points (n, 3) to a capsule along z; `size` is its radius and half
    its length."""
    along = np.clip(points[:, 2], -size[1], size[1])
    beside = points.copy()
    beside[:, 2] -= along
    return sphere_distance(beside, size)


def cylinder_distance(points: Array, size: Array) -> Array:
    """Signed distances (n,) m of points (n, 3) to a cylinder along z; `size` is its radius and half
    its height."""
    out = np.sqrt(squared_lengths(points[:, :2])) - size[0]
    return _outside(np.column_stack([out, np.abs(points[:, 2]) - size[1]]))


def box_distance(points: Array, size: Array) -> Array:
    """Signed distances (n,) m of points (n, 3) to a box; `size` is half its edges."""
    return _outside(np.abs(points) - size)


DISTANCES: dict[str, Callable[[Array, Array], Array]] = {
    "sphere": sphere_distance,
    "capsule": capsule_distance,
    "cylinder": cylinder_distance,
    "box": box_distance,
}
"""Kind of a geom -> its distance function, in the geom's own frame."""


def _outside(beyond: Array) -> Array:
    """Signed distances (n,), from signed distances (n, k) of points to each pair of faces."""
    out = np.sqrt(squared_lengths(np.maximum(beyond, 0.0)))
    return np.asarray(out + np.minimum(beyond.max(axis=1), 0.0))


def sphere_reach(way: Array, size: Array) -> float:
    """Reach (m) of a sphere along a unit vector (3,); `size` is its radius."""
    return float(size[0])


def capsule_reach(way: Array, size: Array) -> float:
    """Reach (m) of a capsule along a unit vector (3,); `size` is its radius and half its length."""
    return float(size[0] + abs(way[2]) * size[1])


def cylinder_reach(way: Array, size: Array) -> float:
    """Reach (m) of a cylinder along a unit vector (3,); `size` is radius and half the height."""
    return float(length(way[:2]) * size[0] + abs(way[2]) * size[1])


def box_reach(way: Array, size: Array) -> float:
    """Reach (m) of a box along a unit vector (3,); `size` is half its edges."""
    x, y, z = np.abs(way * size).tolist()
    return float(x + y + z)


def ellipsoid_reach(way: Array, size: Array) -> float:
    """Reach (m) of an ellipsoid along a unit vector (3,); `size` is half its axes."""
    x, y, z = ((way * size) ** 2).tolist()
    return sqrt(x + y + z)


def mesh_reach(way: Array, points: Array) -> float:
    """Reach (m) of the convex hull of points (n, 3) m along a unit vector (3,)."""
    return float(np.max(stacked_applied(points, way)))


REACHES: dict[str, Callable[[Array, Array], float]] = {
    "sphere": sphere_reach,
    "capsule": capsule_reach,
    "cylinder": cylinder_reach,
    "box": box_reach,
    "ellipsoid": ellipsoid_reach,
}
"""Kind of a geom -> its reach function, in the geom's own frame; meshes use `mesh_reach`. The reach
along a direction is the largest coordinate of the geom's points in this direction."""
