"""Who pushes what in a simulation: the digits, the table and other things, for the 60 Hz tables.

Tasks read contact sensors, which tell one net force for a whole hand. A grasp is two digits that
push against each other, so what is read here is the solver's list of contacts; its order is not
defined, and nothing here depends on it, since forces are only added up.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.frames import FINGERS
from models.scene import TABLE, Scene
from tasks.sensing import SUPPORT

Array = NDArray[np.float64]

PALM = "p"
"""Stands for the palm among the letters of digits."""


@dataclass(frozen=True)
class Pushes:
    """What pushes a thing at one moment.

    Attributes:
        digits: First letters of the digits that push it, thumb first, `p` for the palm.
        grip: N, sum of the normal forces of all hands on it.
        by: What else pushes it: the table, names of things.
        on: Which of those bear it: push up most of its weight.
    """

    digits: str = ""
    grip: float = 0.0
    by: tuple[str, ...] = ()
    on: tuple[str, ...] = ()


class Contacts(NamedTuple):
    """The solver's contacts at one moment, copied.

    Attributes:
        geoms: (n, 2).
        addresses: (n,) of the normal force in `forces`; negative where there is none.
        frames: (n, 9), whose first three numbers are the normal, from the first geom to the second.
        forces: All of the solver's forces, N.
    """

    geoms: NDArray[np.int32]
    addresses: NDArray[np.int32]
    frames: Array
    forces: Array


@dataclass
class _Sum:
    """What one body does to another."""

    normal: float = 0.0
    up: float = 0.0


@dataclass
class _Found:
    """What pushes a thing, by who."""

    digits: dict[str, float] = field(default_factory=dict)
    others: dict[str, _Sum] = field(default_factory=dict)


class Touching:
    """Tells who pushes what in a scene.

    Args:
        scene: With elliptic friction cones, as all of ours have.
    """

    def __init__(self, scene: Scene) -> None:
        model = scene.model
        self._scene = scene
        letters = {}
        for hand in scene.spec.hands:
            for bone in hand.skeleton.bones:
                body = model.body(hand.element_name(bone.name)).id
                letters[body] = FINGERS[bone.finger][0]
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
            elif int(model.geom_bodyid[geom]) > 0:
                self._digit[geom] = PALM
        self._weight = {
            name: -float(model.opt.gravity[2] * model.body_subtreemass[body])
            for name, body in scene.object_bodies.items()
        }

    @staticmethod
    def copy(data: mujoco.MjData) -> Contacts | None:
        """The contacts now; None where there are none. It takes some microseconds."""
        if data.ncon == 0:
            return None
        found = data.contact
        return Contacts(found.geom.copy(), found.efc_address.copy(), found.frame.copy(),
                        data.efc_force.copy())  # fmt: skip

    def pushes(self, contacts: Contacts | None) -> Mapping[str, Pushes]:
        """What pushes each thing, by its name."""
        found = {name: _Found() for name in self._scene.object_bodies}
        if contacts is not None:
            for geoms, address, frame in zip(contacts.geoms.tolist(), contacts.addresses.tolist(),
                                             contacts.frames, strict=True):  # fmt: skip
                if address < 0:
                    continue
                force = contacts.forces[address : address + 3]
                normal = float(force[0])
                if normal <= 0.0:
                    continue
                # The first geom is pushed back.
                up = float(force @ frame.reshape(3, 3)[: len(force), 2])
                for mine, other, sign in ((geoms[1], geoms[0], 1.0), (geoms[0], geoms[1], -1.0)):
                    self._add(found, mine, other, normal, sign * up)
        return {name: self._told(name, it) for name, it in found.items()}

    def _add(
        self, found: dict[str, _Found], mine: int, other: int, normal: float, up: float
    ) -> None:
        thing = self._thing.get(mine)
        if thing is None:
            return
        if other in self._digit:
            digits = found[thing].digits
            digits[self._digit[other]] = digits.get(self._digit[other], 0.0) + normal
            return
        name = self._thing.get(other, TABLE)
        if name != thing:
            total = found[thing].others.setdefault(name, _Sum())
            total.normal += normal
            total.up += up

    def _told(self, name: str, found: _Found) -> Pushes:
        order = "".join(f[0] for f in FINGERS) + PALM
        return Pushes(
            "".join(sorted(found.digits, key=order.index)),
            float(np.sum(sorted(found.digits.values()))),
            tuple(sorted(found.others)),
            tuple(
                sorted(n for n, s in found.others.items() if s.up > SUPPORT * self._weight[name])
            ),
        )
