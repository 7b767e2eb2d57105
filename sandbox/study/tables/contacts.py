"""Finds what pushes each object in a simulation: digits of hands, other objects, or the table.

The frames of a trial have the result. Contact sensors, which tasks use as well, give the force
between an object and the table or another object. For a hand they give only the net force of all
digits, so the forces of single digits are read from the solver's list of contacts. The order of
this list is undefined, but the result does not depend on it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array, total
from models.frames import FINGERS
from models.scene import TABLE, Scene, touching_sensor
from tasks.sensing import SUPPORT

PALM = "p"
"""Letter of the palm among the letters of digits."""

LETTERS = (str.lower, str.upper)
"""Functions that convert the letter of a digit: of the first hand, and of the second hand."""


@dataclass(frozen=True)
class ObjectPushes:
    """Digits and other bodies that push one object at one moment.

    Attributes:
        digits: First letters of the digits that push it, thumb first, and `p` for the palm; capital
            letters for a second hand.
        grip: Sum of the normal forces of all hands on it, N.
        by: Other bodies that push it: the table, names of objects.
        on: The bodies in `by` that bear it: their upward force is more than `SUPPORT` of its
            weight.
    """

    digits: str = ""
    grip: float = 0.0
    by: tuple[str, ...] = ()
    on: tuple[str, ...] = ()


class ContactSample(NamedTuple):
    """Copy of the contact data of one moment.

    `geoms`, `addresses` and `forces` are None while no hand touches an object.

    Attributes:
        sensors: Readings of all contact sensors.
        geoms: (n, 2) ids of the two geoms of each contact of the solver.
        addresses: (n,) index of the normal force of each contact in `forces`; negative if it has
            none.
        forces: All constraint forces of the solver, N.
    """

    sensors: Array
    geoms: NDArray[np.int32] | None = None
    addresses: NDArray[np.int32] | None = None
    forces: Array | None = None


class ContactReader:
    """Finds the digits and other bodies that push each object of a simulation.

    Args:
        scene: The scene. It has elliptic friction cones, as all scenes of this program.
        data: State of the simulation, which each call of `copy` reads.
    """

    def __init__(self, scene: Scene, data: mujoco.MjData) -> None:
        model = scene.model
        # The array of sensor readings stays valid during the simulation. The arrays of contacts
        # do not, so they are not stored here.
        self._data, self._readings = data, data.sensordata
        self._scene = scene
        letters, palms = {}, {}
        for hand, letter_of in zip(scene.spec.hands, LETTERS, strict=False):
            for link in hand.links:
                body = model.body(link.body).id
                letters[body] = letter_of(FINGERS[link.finger][0])
                palms[int(model.body_rootid[body])] = letter_of(PALM)
        objects = {body: name for name, body in scene.object_bodies.items()}
        # By geom: the name of its object, or the letter of its digit.
        self._object: dict[int, str] = {}
        self._digit: dict[int, str] = {}
        for geom in range(model.ngeom):
            body = int(model.geom_bodyid[geom])
            while body > 0 and body not in objects and body not in letters:
                body = int(model.body_parentid[body])
            if body in objects:
                self._object[geom] = objects[body]
            elif body in letters:
                self._digit[geom] = letters[body]
            elif (body := int(model.geom_bodyid[geom])) > 0:
                self._digit[geom] = palms.get(int(model.body_rootid[body]), PALM)
        hands = [hand.name for hand in scene.spec.hands]
        self._hands = [
            int(model.sensor(touching_sensor(name, hand)).adr[0])
            for name in scene.object_bodies
            for hand in hands
        ]
        # For each object, every other body that may push it: name, address of the sensor, and sign
        # of the sensor's force.
        self._others: dict[str, list[tuple[str, int, float]]] = {n: [] for n in scene.object_bodies}
        names = list(scene.object_bodies)
        for i, name in enumerate(names):
            for other in (TABLE, *names[i + 1 :]):
                adr = int(model.sensor(touching_sensor(name, other)).adr[0])
                # The sensor gives the force of the first body on the second body.
                self._others[name].append((other, adr, -1.0))
                if other in self._others:
                    self._others[other].append((name, adr, 1.0))
        self._weight = {
            name: -float(model.opt.gravity[2] * model.body_subtreemass[body])
            for name, body in scene.object_bodies.items()
        }

    def copy(self) -> ContactSample:
        """Copies the contact data of this moment."""
        readings = self._readings
        sensors, item = readings.copy(), readings.item
        for adr in self._hands:
            if item(adr):
                break
        else:
            return ContactSample(sensors)
        contact = self._data.contact
        forces = self._data.efc_force.copy()
        return ContactSample(sensors, contact.geom.copy(), contact.efc_address.copy(), forces)

    def pushes(self, contacts: ContactSample) -> Mapping[str, ObjectPushes]:
        """Returns the contacts that push each object, by the object's name."""
        digits: dict[str, dict[str, float]] = {name: {} for name in self._weight}
        if contacts.geoms is not None:
            assert contacts.addresses is not None and contacts.forces is not None
            for pair, address in zip(
                contacts.geoms.tolist(), contacts.addresses.tolist(), strict=True
            ):
                normal = float(contacts.forces[address]) if address >= 0 else 0.0
                if normal > 0.0:
                    for mine, other in (pair, pair[::-1]):
                        if mine in self._object and other in self._digit:
                            by_letter = digits[self._object[mine]]
                            letter = self._digit[other]
                            by_letter[letter] = by_letter.get(letter, 0.0) + normal
        readings = contacts.sensors.tolist()
        return {name: self._object_pushes(name, own, readings) for name, own in digits.items()}

    def _object_pushes(
        self, name: str, digits: dict[str, float], readings: list[float]
    ) -> ObjectPushes:
        by, on = [], []
        for other, adr, sign in self._others[name]:
            touches, *force = readings[adr : adr + 4]
            if touches > 0 and any(force):
                by.append(other)
                if sign * force[2] > SUPPORT * self._weight[name]:
                    on.append(other)
        one = "".join(f[0] for f in FINGERS) + PALM
        order = one + one.upper()
        return ObjectPushes(
            "".join(sorted(digits, key=order.index)),
            total(sorted(digits.values())),
            tuple(sorted(by)),
            tuple(sorted(on)),
        )
