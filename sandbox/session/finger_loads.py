"""Finger loads: the force of each finger, the force that a grip stores, and how near its limit is.

Fingers that close on a thing press across its faces, and their servos also pull along them: the
grip holds the thing in a place where it would not stay by itself. Both are read from MuJoCo's
contacts; how much of their limit the servos use is read from its actuators.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import sqrt

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arithmetic.arrays import Array
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
        stored: N, the part of its force that other fingers on the same objects press back: the
            squeeze that is let go when the grip opens. 0 for a finger that pushes alone.
    """

    force: float = 0.0
    pressing: float = 0.0
    sideways: float = 0.0
    used: float = 0.0
    stored: float = 0.0

    @property
    def at_limit(self) -> bool:
        """True if some servo of the finger gives all the force that it may."""
        return self.used >= FULL


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
    def palm_at_limit(self) -> bool:
        """True if some servo of the palm, which carries all fingers, gives all that it may."""
        return self.used >= FULL

    @property
    def at_limit(self) -> bool:
        """True if some servo gives all the force that it may."""
        return self.palm_at_limit or any(finger.at_limit for finger in self.fingers)


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
        hands, n = len(self._scene.spec.hands), len(FINGERS)
        forces = np.zeros((hands * n, 3))
        # Vectors on each object that is touched, by object and finger.
        pushes: dict[int, dict[int, Array]] = {}
        if data.ncon:
            one, roots = np.zeros(6), self._scene.model.body_rootid[self._scene.model.geom_bodyid]
            pairs = data.contact.geom.tolist()
            for contact, pair in enumerate(self._owners[data.contact.geom].tolist()):
                for side, part in enumerate(pair):
                    if part >= 0:
                        mujoco.mj_contactForce(self._scene.model, data, contact, one)
                        across, x, y = one[:3].tolist()
                        along = sqrt(x * x + y * y)
                        forces[part] += sqrt(across * across + along * along), across, along
                        # A contact's normal points from its first geom to its second one.
                        push = one[:3] @ data.contact.frame[contact].reshape(3, 3)
                        thing = pushes.setdefault(int(roots[pairs[contact][1 - side]]), {})
                        thing[part] = thing.get(part, 0.0) + (push if side == 0 else -push)
        used, stored = self._used(data), _stored(pushes, len(forces))
        fingers = [
            FingerLoad(force, pressing, sideways, used[part // n][part % n], stored[part])
            for part, (force, pressing, sideways) in enumerate(forces.tolist())
        ]
        return [HandLoad(tuple(fingers[n * i : n * (i + 1)]), used[i][-1]) for i in range(hands)]

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


def _stored(pushes: Mapping[int, Mapping[int, Array]], fingers: int) -> list[float]:
    """N, what is stored in each finger's grip, from the force vectors (3,) by object and finger.

    The other fingers' force against a finger's own, and at most as much as its own.
    """
    stored = [0.0] * fingers
    for thing in pushes.values():
        whole = np.sum(list(thing.values()), axis=0)
        for finger, push in thing.items():
            own = float(np.linalg.norm(push))
            if own > 0.0:
                against = -float(push @ (whole - push)) / own
                stored[finger] += min(max(against, 0.0), own)
    return stored
