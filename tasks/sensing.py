"""What a task may see of the simulation: poses, speeds and who touches whom.

Contacts are read from contact sensors, never from the solver's contact list, whose order is not
defined.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.scene import TABLE, Scene, touching_sensor

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ObjectState:
    """An object at one moment, in the world.

    Attributes:
        position: (3,) m, centre.
        rotation: (3, 3).
        speed: m/s of the centre.
        on_table: The table pushes it.
        held: A hand touches it.
    """

    position: Array
    rotation: Array
    speed: float
    on_table: bool
    held: bool

    @property
    def yaw(self) -> float:
        """rad about the vertical of the object's x axis, seen from above."""
        return float(np.arctan2(self.rotation[1, 0], self.rotation[0, 0]))

    @property
    def tilt(self) -> float:
        """rad between the object's z axis and the vertical."""
        return float(np.arccos(np.clip(self.rotation[2, 2], -1.0, 1.0)))


class Sensing:
    """Reads a simulation, and changes nothing in it."""

    def __init__(self, scene: Scene, data: mujoco.MjData) -> None:
        self._scene, self._data = scene, data
        model = scene.model
        hands = [hand.name for hand in scene.spec.hands]
        self._sensors = {
            (thing.name, other): int(model.sensor(touching_sensor(thing.name, other)).adr[0])
            for thing in scene.spec.objects
            for other in (TABLE, *hands)
        }
        self._hands = hands
        self._velocity = {
            thing.name: int(model.joint(thing.name).dofadr[0]) for thing in scene.spec.objects
        }
        # A free joint begins with the three speeds of the centre. What turns about a bolt has one
        # speed, and its centre goes round at the end of a lever.
        self._moves, self._levers = {}, {}
        for thing in scene.spec.objects:
            joint = model.joint(thing.name)
            hinged = joint.type[0] == mujoco.mjtJoint.mjJNT_HINGE
            self._moves[thing.name] = 1 if hinged else 3
            self._levers[thing.name] = float(np.linalg.norm(joint.pos)) if hinged else 1.0

    def object(self, name: str) -> ObjectState:
        """The state of an object."""
        position, rotation = self._scene.object_pose(self._data, name)
        v = self._velocity[name]
        return ObjectState(
            position,
            rotation,
            self._levers[name] * float(np.linalg.norm(self._data.qvel[v : v + self._moves[name]])),
            self.touching(name, TABLE),
            any(self.touching(name, hand) for hand in self._hands),
        )

    def touching(self, name: str, other: str) -> bool:
        """Whether a force passes between an object and the table or a hand."""
        adr = self._sensors[name, other]
        found, *force = self._data.sensordata[adr : adr + 4]
        return bool(found > 0 and np.linalg.norm(force) > 0)
