"""Finger loads: the force of each finger, the force that a grip stores, and how near its limit is.

Fingers that close on a thing press across its faces, and their servos also pull along them: the
grip holds the thing in a place where it would not stay by itself. Both are read from MuJoCo's
contacts; how much of their limit the servos use is read from its actuators.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.frames import FINGERS
from models.scene import Scene


@dataclass(frozen=True)
class FingerLoad:
    """Load of one finger.

    Attributes:
        force: N, sum of the forces of all its contacts with objects.
        pressing: N, the part across the faces of objects.
        sideways: N, the part along them, which friction bears.
        used: Share of its servos' limit that its most loaded servo uses, 0 to 1.
    """

    force: float = 0.0
    pressing: float = 0.0
    sideways: float = 0.0
    used: float = 0.0


@dataclass(frozen=True)
class HandLoad:
    """Load of one hand.

    Attributes:
        fingers: Loads of its fingers, thumb first.
        used: Share of their limit that the servos of the palm use at most, 0 to 1.
    """

    fingers: tuple[FingerLoad, ...]
    used: float

    @property
    def at_limit(self) -> bool:
        """True if some servo gives all the force that it may."""
        return max(self.used, *(finger.used for finger in self.fingers)) >= FULL


FULL = 0.999
"""Share of a servo's limit from which on the limit counts as reached."""


class FingerLoads:
    """Reads the loads of all hands of a scene.

    Args:
        scene: The scene.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    def read(self, data: mujoco.MjData) -> list[HandLoad]:
        """The current load of each hand."""
        hands = len(self._scene.spec.hands)
        forces = np.zeros((hands * len(FINGERS), 3))
        if data.ncon:
            one = np.zeros(6)
            for contact, pair in enumerate(self._owners[data.contact.geom].tolist()):
                for part in pair:
                    if part >= 0:
                        mujoco.mj_contactForce(self._scene.model, data, contact, one)
                        across, x, y = one[:3].tolist()
                        along = sqrt(x * x + y * y)
                        forces[part] += sqrt(across * across + along * along), across, along
        used = self._used(data)
        fingers = [
            FingerLoad(force, pressing, sideways, used[part // len(FINGERS)][part % len(FINGERS)])
            for part, (force, pressing, sideways) in enumerate(forces.tolist())
        ]
        return [
            HandLoad(tuple(fingers[len(FINGERS) * i : len(FINGERS) * (i + 1)]), used[i][-1])
            for i in range(hands)
        ]

    def _used(self, data: mujoco.MjData) -> list[list[float]]:
        """Largest share of a limit, of each finger of each hand, and last of its palm."""
        model = self._scene.model
        shares = [[0.0] * (len(FINGERS) + 1) for _ in self._scene.spec.hands]
        for actuator, (hand, part) in self._servos.items():
            first = int(model.actuator_outadr[actuator])
            force = data.actuator_force[first : first + int(model.actuator_outnum[actuator])]
            limit = float(model.actuator_forcerange[actuator, 1])
            share = float(np.sqrt(np.sum(force * force))) / limit if limit > 0.0 else 0.0
            shares[hand][part] = max(shares[hand][part], min(share, 1.0))
        return shares

    @cached_property
    def _owners(self) -> NDArray[np.int64]:
        """(geoms,) owner of each geom, 5 times the hand plus the finger; -1 without an owner."""
        model = self._scene.model
        bodies = np.full(model.nbody, -1)
        for i, hand in enumerate(self._scene.spec.hands):
            for link in hand.links:
                bodies[model.body(link.body).id] = len(FINGERS) * i + link.finger
        return bodies[model.geom_bodyid]

    @cached_property
    def _servos(self) -> dict[int, tuple[int, int]]:
        """Hand and finger of each actuator of a hand; -1 as its finger is the palm."""
        model, servos = self._scene.model, {}
        for i, hand in enumerate(self._scene.spec.hands):
            fingers = {model.body(link.body).id: link.finger for link in hand.links}
            for actuator in range(model.nactuator):
                if model.actuator(actuator).name.startswith(f"{hand.name}_"):
                    # All servos of a hand act on joints.
                    joint = int(model.actuator_trnid[actuator, 0])
                    servos[actuator] = i, fingers.get(int(model.jnt_bodyid[joint]), -1)
        return servos
