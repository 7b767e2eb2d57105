"""Finger loads: each finger's force, the force stored by a grip, and the used servo limits.

Fingers that close on an object press across its faces, and their servos also pull along the faces:
the grip holds the object in a place where the object would not stay by itself. A finger's force and
its stored force are computed from MuJoCo's contacts. The used share of the servos' limits is
computed from MuJoCo's actuators.

The computation takes a third of a millisecond. Therefore its inputs are copied at once, and the
loads are computed only when a caller needs them, in any thread.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from math import sqrt

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.frames import FINGERS
from models.hand import SceneHand
from models.scene import Scene
from sandbox.session.messages import FingerLoad, HandLoad


@dataclass(frozen=True)
class Forces:
    """Copies of MuJoCo's arrays for n contacts.

    Attributes:
        geoms: (n, 2) geoms of each contact.
        frames: (n, 9) frame of each contact.
        address: (n,) first constraint row of each contact; negative without rows.
        rows: (n,) number of constraint rows of each contact.
        constraints: Forces of all constraint rows.
        servos: Forces of the actuators' outputs, N or N m.
        limits: (actuators,) force limits of the actuators, N or N m.
    """

    geoms: NDArray[np.int64]
    frames: Array
    address: NDArray[np.int64]
    rows: NDArray[np.int64]
    constraints: Array
    servos: Array
    limits: Array

    def of(self, contact: int) -> Array:
        """(3,) N, force of a contact in its own frame: normal force, then two tangential forces."""
        force = np.zeros(3)
        first, rows = int(self.address[contact]), min(int(self.rows[contact]), 3)
        if first >= 0:
            force[:rows] = self.constraints[first : first + rows]
        return force


class FingerLoads:
    """Reads the loads of all hands of a scene.

    Args:
        scene: The scene. Its contacts must have elliptic friction cones.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene

    def read(self, data: mujoco.MjData) -> list[HandLoad]:
        """The current load of each hand."""
        return list(self.of(self.forces(data)))

    def keep(self, data: mujoco.MjData) -> Callable[[], tuple[HandLoad, ...]]:
        """A function that computes the current loads later, in any thread."""
        return partial(self.of, self.forces(data))

    def forces(self, data: mujoco.MjData) -> Forces:
        """Copies of the current forces."""
        contact = data.contact
        return Forces(
            contact.geom.copy(),
            contact.frame.copy(),
            contact.efc_address.copy(),
            contact.dim.copy(),
            data.efc_force.copy(),
            data.actuator_force.copy(),
            self._scene.model.actuator_forcerange[:, 1].copy(),
        )

    def of(self, kept: Forces) -> tuple[HandLoad, ...]:
        """The load of each hand at the moment at which the forces were copied."""
        hands, n = len(self._scene.spec.hands), len(FINGERS)
        forces = np.zeros((hands * n, 3))
        # Force vectors on each touched object, by object and finger.
        pushes: dict[int, dict[int, Array]] = {}
        owners = self._owners[kept.geoms]
        for contact in np.flatnonzero((owners >= 0).any(axis=1)).tolist():
            one = kept.of(contact)
            across, x, y = one.tolist()
            along = sqrt(x * x + y * y)
            # A contact's normal points from its first geom to its second geom.
            push = one @ kept.frames[contact].reshape(3, 3)
            for side, part in enumerate(owners[contact].tolist()):
                if part >= 0:
                    forces[part] += sqrt(across * across + along * along), across, along
                    other = int(self._roots[kept.geoms[contact, 1 - side]])
                    thing = pushes.setdefault(other, {})
                    thing[part] = thing.get(part, 0.0) + (push if side == 0 else -push)
        used, stored = self._used(kept), _stored(pushes, len(forces))
        fingers = [
            FingerLoad(force, pressing, sideways, used[part // n][part % n], stored[part])
            for part, (force, pressing, sideways) in enumerate(forces.tolist())
        ]
        return tuple(
            HandLoad(tuple(fingers[n * i : n * (i + 1)]), used[i][-1]) for i in range(hands)
        )

    def _used(self, kept: Forces) -> list[list[float]]:
        """For each hand, the largest used share of a servo's limit of each finger, then of the
        palm."""
        if not self._servos:
            return [[0.0] * (len(FINGERS) + 1) for _ in self._scene.spec.hands]
        actuators, outputs, starts, places = self._outputs
        squares = np.add.reduceat(kept.servos[outputs] ** 2, starts)
        limits = kept.limits[actuators]
        shares = np.sqrt(squares) / np.where(limits > 0.0, limits, np.inf)
        used = np.zeros(len(self._scene.spec.hands) * (len(FINGERS) + 1))
        np.maximum.at(used, places, np.minimum(shares, 1.0))
        largest: list[list[float]] = used.reshape(-1, len(FINGERS) + 1).tolist()
        return largest

    @cached_property
    def _outputs(self) -> tuple[NDArray[np.int64], ...]:
        """Indices of the hands' n actuators and of their m outputs.

        Returns:
            The actuators (n,); their outputs (m,); for each actuator the position (n,) of its
            first output in the second array; and for each actuator the index (n,) of its finger or
            palm among the fingers and palms of all hands.
        """
        model, palm = self._scene.model, len(FINGERS)
        actuators = np.array(list(self._servos), np.int64)
        places = [
            hand * (palm + 1) + (palm if part < 0 else part) for hand, part in self._servos.values()
        ]
        counts = model.actuator_outnum[actuators].astype(np.int64)
        first = model.actuator_outadr[actuators].astype(np.int64)
        outputs = [np.arange(f, f + n) for f, n in zip(first, counts, strict=True)]
        starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
        return actuators, np.concatenate(outputs), starts, np.array(places, np.int64)

    @cached_property
    def _roots(self) -> NDArray[np.int64]:
        """(geoms,) root body of each geom, which identifies its object."""
        model = self._scene.model
        return np.asarray(model.body_rootid[model.geom_bodyid], np.int64)

    @cached_property
    def _owners(self) -> NDArray[np.int64]:
        """(geoms,) owner of each geom: 5 * hand + finger, or -1 if it is no link of a finger."""
        model = self._scene.model
        bodies = np.full(model.nbody, -1)
        for i, hand in enumerate(self._scene.spec.hands):
            for link in hand.links:
                bodies[model.body(link.body).id] = len(FINGERS) * i + link.finger
        return bodies[model.geom_bodyid]

    @cached_property
    def _servos(self) -> dict[int, tuple[int, int]]:
        """Hand and finger of each actuator of a hand; finger -1 means the palm."""
        model, servos = self._scene.model, {}
        for i, hand in enumerate(self._scene.spec.hands):
            fingers = _bodies_of_fingers(model, hand)
            for actuator in range(model.nactuator):
                if model.actuator(actuator).name.startswith(f"{hand.name}_"):
                    # All servos of a hand act on joints.
                    joint = int(model.actuator_trnid[actuator, 0])
                    servos[actuator] = i, fingers.get(int(model.jnt_bodyid[joint]), -1)
        return servos


def _bodies_of_fingers(model: mujoco.MjModel, hand: SceneHand) -> dict[int, int]:
    """Finger of each body of a hand between its palm and its links, links included."""
    palm, fingers = model.body(hand.palm).id, {}
    for link in hand.links:
        body = model.body(link.body).id
        while body != palm:
            fingers[body] = link.finger
            body = int(model.body_parentid[body])
    return fingers


def _stored(pushes: Mapping[int, Mapping[int, Array]], fingers: int) -> list[float]:
    """Force (N) stored in each finger's grip, from the force vectors (3,) by object and finger.

    The stored force is the component of the other fingers' force that is opposite to the finger's
    own force. It is at most as large as the finger's own force.
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
