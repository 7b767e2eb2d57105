"""Read access of tasks to the simulation: poses, speeds and contacts.

Contacts are read from contact sensors, never from the solver's contact list, whose order is not
defined.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from math import acos, atan2

import mujoco
import numpy as np

from models.arithmetic import Array, length
from models.errors import InputError
from models.objects import Joint, MechanismPart
from models.scene import TABLE, Scene, finger_sensor, first_bodies, touching_sensor

SUPPORT = 0.6
"""Share of an object's weight that a part of the scene must carry to count as its support. A single
support carries the whole weight. If an object leans on two parts, they share its weight."""


@dataclass(frozen=True)
class ObjectState:
    """An object at one moment, in the world.

    Attributes:
        position: (3,) m, centre of the object.
        rotation: (3, 3), world from object.
        speed: Speed (m/s) of the centre.
        on_table: True if the table exerts a force on the object.
        held: True if a hand touches the object.
    """

    position: Array
    rotation: Array
    speed: float
    on_table: bool
    held: bool

    @property
    def yaw(self) -> float:
        """Yaw (rad) of the object's x axis, seen from above."""
        return atan2(self.rotation[1, 0], self.rotation[0, 0])

    @property
    def tilt(self) -> float:
        """Angle (rad) between the object's z axis and the vertical."""
        return acos(min(max(self.rotation[2, 2], -1.0), 1.0))

    @property
    def lean(self) -> float:
        """Angle (rad) between the vertical and the nearest of the object's axes; 0 for a box that
        stands on any of its faces."""
        return acos(min(max(map(abs, self.rotation[2].tolist())), 1.0))


@dataclass(frozen=True)
class JointState:
    """A hinge or a slide at one moment.

    Attributes:
        position: Position (rad or m).
        speed: Speed (rad/s or m/s).
        joint: Kind and range of the joint.
    """

    position: float
    speed: float
    joint: Joint

    @property
    def share(self) -> float:
        """Position as a share of the range, 0 at its lowest and 1 at its highest value.

        Raises:
            InputError: The joint has no range.
        """
        if self.joint.range is None:
            raise InputError(
                "a joint without end stops has no share of its range",
                where="JointState.share",
                remedy=f"Use .position, in {self.joint.unit}",
            )
        low, high = self.joint.range
        return (self.position - low) / (high - low)


class Sensing:
    """Reads a simulation without changing it."""

    def __init__(self, scene: Scene, data: mujoco.MjData) -> None:
        self._scene, self._data = scene, data
        model = scene.model
        self._hands = hands = [hand.name for hand in scene.spec.hands]
        # MuJoCo's arrays do not move in memory, so views of them are made only once.
        # Every pair of parts has one sensor, which measures the force of the first on the second.
        self._read: dict[tuple[str, str], Array] = {}
        self._sign: dict[tuple[str, str], float] = {}
        for i, obj in enumerate(scene.spec.objects):
            for other in (TABLE, *hands, *(o.name for o in scene.spec.objects[i + 1 :])):
                adr = int(model.sensor(touching_sensor(obj.name, other)).adr[0])
                first, second = (obj.name, other), (other, obj.name)
                self._read[first] = self._read[second] = data.sensordata[adr : adr + 4]
                self._sign[first], self._sign[second] = -1.0, 1.0
        self._weights = {
            name: -float(model.opt.gravity[2]) * float(model.body_subtreemass[body])
            for name, body in scene.object_bodies.items()
        }
        # The speeds of a free joint begin with the three speeds of the centre. An object on a hinge
        # has one speed, and its centre moves about the axis. A fixed object has no speed.
        self._speeds: dict[str, Array] = {}
        self._levers: dict[str, float] = {}
        # A part that a moving part carries has a speed in addition to that of its own joint.
        fixed = {o.name for o in scene.spec.objects if isinstance(o, MechanismPart) and o.fixed}
        self._carried = {
            o.name: scene.object_bodies[o.name]
            for o in scene.spec.objects
            if isinstance(o, MechanismPart) and o.carrier and o.carrier not in fixed
        }
        self._joints: dict[str, tuple[Array, Array, Joint]] = {}
        self._fingers: dict[str, list[tuple[str, int, Array]]] = {}
        for obj in scene.spec.objects:
            if isinstance(obj, MechanismPart) and obj.fixed:
                self._speeds[obj.name], self._levers[obj.name] = data.qvel[:0], 1.0
                continue
            joint = model.joint(obj.name)
            dof = int(joint.dofadr[0])
            hinged = joint.type[0] == mujoco.mjtJoint.mjJNT_HINGE
            # An object on slides has a speed for each slide.
            types = model.jnt_type[model.jnt_bodyid == scene.object_bodies[obj.name]]
            slides = int(np.sum(types == mujoco.mjtJoint.mjJNT_SLIDE))
            moves = slides or (1 if hinged else 3)
            self._speeds[obj.name] = data.qvel[dof : dof + moves]
            self._levers[obj.name] = _from_axis(joint.pos, joint.axis) if hinged else 1.0
            if not isinstance(obj, MechanismPart):
                continue
            if obj.joint is not None:
                at = int(joint.qposadr[0])
                state = data.qpos[at : at + 1], data.qvel[dof : dof + 1]
                self._joints[obj.name] = (*state, obj.joint)
            self._fingers[obj.name] = [
                (hand.name, finger, data.sensordata[adr : adr + 1])
                for hand in scene.spec.hands
                for finger in sorted(first_bodies(hand))
                for adr in [int(model.sensor(finger_sensor(obj.name, hand.name, finger)).adr[0])]
            ]

    @property
    def hands(self) -> tuple[str, ...]:
        """Names of the hands, which begin with their side."""
        return tuple(self._hands)

    def object(self, name: str) -> ObjectState:
        """Current state of an object.

        Raises:
            InputError: The task has no object of this name.
        """
        if name not in self._speeds:
            raise _unknown(name, self._speeds)
        position, rotation = self._scene.object_pose(self._data, name)
        return ObjectState(
            position,
            rotation,
            self._speed(name),
            self.touching(name, TABLE),
            any(self.touching(name, hand) for hand in self._hands),
        )

    def _speed(self, name: str) -> float:
        """Speed (m/s) of an object's origin."""
        body = self._carried.get(name)
        if body is None:
            return self._levers[name] * length(self._speeds[name])
        kind, velocity = mujoco.mjtObj.mjOBJ_XBODY, np.empty(6)
        mujoco.mj_objectVelocity(self._scene.model, self._data, kind, body, velocity, 0)
        return length(velocity[3:])

    def joint(self, name: str) -> JointState:
        """Current state of the hinge or slide of a mechanism's part.

        Raises:
            InputError: The task has no part of this name, or the part has no joint.
        """
        if name not in self._joints:
            raise _unknown(name, self._joints, "this scene has no joint of this name")
        position, speed, joint = self._joints[name]
        return JointState(float(position[0]), float(speed[0]), joint)

    def fingers(self, name: str) -> frozenset[tuple[str, int]]:
        """Fingers that touch a mechanism's part now, as pairs of hand name and finger label.

        Raises:
            InputError: The task has no moving part of this name.
        """
        if name not in self._fingers:
            raise _unknown(name, self._fingers, "this scene has no moving part of this name")
        return frozenset(
            (hand, finger) for hand, finger, touches in self._fingers[name] if touches[0] > 0
        )

    def touching(self, name: str, other: str) -> bool:
        """True if a force acts between an object and the table, a hand or another object."""
        touches, *force = self._sensor(name, other).tolist()
        return touches > 0 and any(force)

    def force(self, name: str, other: str) -> Array:
        """Force (3,) N, in the world, that the table, a hand or another object exerts on an
        object."""
        return self._sensor(name, other)[1:] * self._sign[name, other]

    def rests_on(self, name: str, other: str) -> bool:
        """True if the table or another object supports an object, by carrying most of its weight.

        A contact from the side, or a leaning corner, does not count as support.

        Raises:
            InputError: The scene has no object `name`, or no part `other`.
        """
        if name not in self._weights:
            raise _unknown(name, self._weights, "this scene has no object of this name")
        up = float(self._sensor(name, other)[3]) * self._sign[name, other]
        return up > SUPPORT * self._weights[name]

    def _sensor(self, name: str, other: str) -> Array:
        """Number of contacts and force (N) between two parts of the scene, as an array (4,)."""
        if (name, other) not in self._read:
            parts = {part for pair in self._read for part in pair}
            raise _unknown(name if name not in parts else other, parts)
        return self._read[name, other]


def _from_axis(position: Array, axis: Array) -> float:
    """Distance (m) from a body's origin to the axis of its hinge.

    Args:
        position: (3,) m, a point on the axis, in the body's frame.
        axis: (3,) unit vector along the axis.
    """
    (x, y, z), (a, b, c) = position.tolist(), axis.tolist()
    return length(np.array([y * c - z * b, z * a - x * c, x * b - y * a]))


def _unknown(
    name: str, names: Iterable[str], what: str = "this scene has no part of this name"
) -> InputError:
    return InputError(
        what,
        where="sensing",
        got=name,
        expected=", ".join(sorted(names)),
    )
