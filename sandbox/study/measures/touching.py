"""Who pushes what in a simulation: the digits, the table and other things, for the 60 Hz tables.

As for tasks, contact sensors tell what pushes a thing. They tell one net force for a whole hand,
and a grasp is two digits that push against each other: these are read from the solver's list of
contacts. Its order is not defined, and nothing here depends on it, since forces are only added up.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arithmetic.arrays import Array
from models.frames import FINGERS
from models.scene import TABLE, Scene, touching_sensor
from tasks.sensing import SUPPORT

PALM = "p"
"""Stands for the palm among the letters of digits."""

LETTERS = (str.lower, str.upper)
"""Make the letters of the first hand and of the second out of a letter."""


@dataclass(frozen=True)
class ObjectPushes:
    """What pushes a thing at one moment.

    Attributes:
        digits: First letters of the digits that push it, thumb first, `p` for the palm; capital
            letters for a second hand.
        grip: N, sum of the normal forces of all hands on it.
        by: What else pushes it: the table, names of things.
        on: Which of those bear it: push up most of its weight.
    """

    digits: str = ""
    grip: float = 0.0
    by: tuple[str, ...] = ()
    on: tuple[str, ...] = ()


class ContactSample(NamedTuple):
    """What is kept of a moment, copied.

    Attributes:
        sensors: Readings of all contact sensors.
        geoms: (n, 2) of the solver's contacts; None while no hand touches a thing, like the rest.
        addresses: (n,) of their normal forces in `forces`; negative where there is none.
        forces: All of the solver's forces, N.
    """

    sensors: Array
    geoms: NDArray[np.int32] | None = None
    addresses: NDArray[np.int32] | None = None
    forces: Array | None = None


class ContactReader:
    """Tells who pushes what in a simulation.

    Args:
        scene: With elliptic friction cones, as all of ours have.
        data: Is read, moment by moment.
    """

    def __init__(self, scene: Scene, data: mujoco.MjData) -> None:
        model = scene.model
        # MuJoCo's sensors stay where they are; its contacts do not.
        self._data, self._readings = data, data.sensordata
        self._scene = scene
        letters, palms = {}, {}
        for hand, letter_of in zip(scene.spec.hands, LETTERS, strict=False):
            for link in hand.links:
                body = model.body(link.body).id
                letters[body] = letter_of(FINGERS[link.finger][0])
                palms[int(model.body_rootid[body])] = letter_of(PALM)
        things = {body: name for name, body in scene.object_bodies.items()}
        # Of every geom: a thing's name, a digit's letter or the table.
        self._thing: dict[int, str] = {}
        self._digit: dict[int, str] = {}
        for geom in range(model.ngeom):
            body = int(model.geom_bodyid[geom])
            while body > 0 and body not in things and body not in letters:
                body = int(model.body_parentid[body])
            if body in things:
                self._thing[geom] = things[body]
            elif body in letters:
                self._digit[geom] = letters[body]
            elif (body := int(model.geom_bodyid[geom])) > 0:
                self._digit[geom] = palms.get(int(model.body_rootid[body]), PALM)
        hands = [hand.name for hand in scene.spec.hands]
        self._hands = [
            int(model.sensor(touching_sensor(thing, hand)).adr[0])
            for thing in scene.object_bodies
            for hand in hands
        ]
        # By thing: who else may push it, where that is told, and as whose push.
        self._others: dict[str, list[tuple[str, int, float]]] = {n: [] for n in scene.object_bodies}
        names = list(scene.object_bodies)
        for i, thing in enumerate(names):
            for other in (TABLE, *names[i + 1 :]):
                adr = int(model.sensor(touching_sensor(thing, other)).adr[0])
                # A sensor tells the force of its first on its second.
                self._others[thing].append((other, adr, -1.0))
                if other in self._others:
                    self._others[other].append((thing, adr, 1.0))
        self._weight = {
            name: -float(model.opt.gravity[2] * model.body_subtreemass[body])
            for name, body in scene.object_bodies.items()
        }

    def copy(self) -> ContactSample:
        """What is kept of this moment."""
        readings = self._readings
        sensors, item = readings.copy(), readings.item
        for adr in self._hands:
            if item(adr):
                break
        else:
            return ContactSample(sensors)
        found = self._data.contact
        forces = self._data.efc_force.copy()
        return ContactSample(sensors, found.geom.copy(), found.efc_address.copy(), forces)

    def pushes(self, contacts: ContactSample) -> Mapping[str, ObjectPushes]:
        """What pushes each thing, by its name."""
        digits: dict[str, dict[str, float]] = {name: {} for name in self._weight}
        if contacts.geoms is not None:
            assert contacts.addresses is not None and contacts.forces is not None
            for pair, address in zip(
                contacts.geoms.tolist(), contacts.addresses.tolist(), strict=True
            ):
                normal = float(contacts.forces[address]) if address >= 0 else 0.0
                if normal > 0.0:
                    for mine, other in (pair, pair[::-1]):
                        if mine in self._thing and other in self._digit:
                            found = digits[self._thing[mine]]
                            letter = self._digit[other]
                            found[letter] = found.get(letter, 0.0) + normal
        readings = contacts.sensors.tolist()
        return {name: self._told(name, found, readings) for name, found in digits.items()}

    def _told(self, name: str, digits: dict[str, float], readings: list[float]) -> ObjectPushes:
        by, on = [], []
        for other, adr, sign in self._others[name]:
            found, *force = readings[adr : adr + 4]
            if found > 0 and any(force):
                by.append(other)
                if sign * force[2] > SUPPORT * self._weight[name]:
                    on.append(other)
        one = "".join(f[0] for f in FINGERS) + PALM
        order = one + one.upper()
        return ObjectPushes(
            "".join(sorted(digits, key=order.index)),
            sum(sorted(digits.values())),
            tuple(sorted(by)),
            tuple(sorted(on)),
        )
