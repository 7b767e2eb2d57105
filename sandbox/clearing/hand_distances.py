"""Distances of all parts of a hand from things, at any pose: MuJoCo's collision detection in a copy
of the scene, in which a hand is always there and never pushes anything."""

from __future__ import annotations

import copy
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arithmetic.arrays import Array
from models.hand import CONTACT_HAND
from models.scene import Scene

REACH = 0.02
"""m, farthest distance that is measured."""

_IDLE = (
    mujoco.mjtDisableBit.mjDSBL_LIMIT
    | mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS
    | mujoco.mjtDisableBit.mjDSBL_EQUALITY
)
"""Constraints that are no contacts."""


class Near(NamedTuple):
    """Parts of a hand that are near things.

    Attributes:
        parts: Indices (n,) of geoms; a part may come twice, as for two ends of a capsule.
        distances: (n,) m between surfaces, negative inside.
        things: Indices (n,) of the geoms that they are near.
    """

    parts: list[int]
    distances: list[float]
    things: list[int]


class HandDistances:
    """Measures how near the parts of one hand are to objects and to other hands.

    The inner part of a last link, which its fingertip does not need, is a part of its own under the
    link's geom; the fingertip is one under the link's `tip_geom`.

    Args:
        scene: The scene, as it was compiled: before any part of it was made a ghost.
        hand: Index of the hand.

    Attributes:
        dofs: Slice of the hand's degrees of freedom.
    """

    def __init__(self, scene: Scene, hand: int) -> None:
        self._hand = scene.qpos_slice(hand)
        own = scene.spec.hands[hand]
        self._model = model = copy.copy(scene.model)
        parts = scene.parts(hand)
        self._parts = frozenset(parts)
        # What hands meet at all, and the other hands.
        things = (model.geom_conaffinity & CONTACT_HAND) > 0
        for other in range(len(scene.spec.hands)):
            things[scene.parts(other)] = scene.spec.hands_collide
        things[parts] = False
        model.geom_contype[:] = model.geom_conaffinity[:] = 0
        model.geom_contype[parts] = CONTACT_HAND
        model.geom_conaffinity[things] = CONTACT_HAND
        for body in range(model.nbody):
            of_body = model.geom_bodyid == body
            model.body_contype[body] = np.bitwise_or.reduce(model.geom_contype[of_body])
            model.body_conaffinity[body] = np.bitwise_or.reduce(model.geom_conaffinity[of_body])
        for link in own.links:
            if link.tip_geom != link.geom:
                _shorten(model, model.geom(link.geom).id, link.solid_from)
        model.geom_margin[parts] = REACH
        # Within a gap a contact has no row.
        model.geom_gap[:] = 0.0
        # MuJoCo looks at the parts of a body only where the body's own margin lets it.
        model.body_margin[model.geom_bodyid[parts]] = REACH
        # One row for each contact: how its distance changes.
        model.geom_condim[:] = 1
        model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        model.opt.disableflags |= int(_IDLE)
        self._data = mujoco.MjData(model)
        start = int(model.joint(own.first_joint).dofadr[0])
        inside = [j for j in range(model.njnt) if model.jnt_qposadr[j] in _range(self._hand)]
        last = inside[-1]
        ends = model.jnt_dofadr[last + 1] if last + 1 < model.njnt else model.nv
        self.dofs = slice(start, int(ends))

    def near(self, data: mujoco.MjData, qpos: Array | None = None, ahead: float = 0.0) -> Near:
        """Parts of the hand that are near things, and how near.

        Args:
            data: State of the simulation, where all things are.
            qpos: Joint positions (m,) of the hand; None takes those of the state.
            ahead: s for which things go on as they move now.
        """
        own = self._data
        own.qpos[:] = data.qpos
        if ahead:
            mujoco.mj_integratePos(self._model, own.qpos, data.qvel, ahead)
        if qpos is not None:
            own.qpos[self._hand] = qpos
        mujoco.mj_kinematics(self._model, own)
        mujoco.mj_collision(self._model, own)
        if not own.ncon:
            return _NOTHING
        contact = own.contact
        pairs = contact.geom.tolist()
        mine = self._parts
        # MuJoCo orders two geoms by their kind.
        first = [a in mine for a, _ in pairs]
        parts = [a if f else b for (a, b), f in zip(pairs, first, strict=True)]
        things = [b if f else a for (a, b), f in zip(pairs, first, strict=True)]
        return Near(parts, contact.dist.tolist(), things)

    def gradients(self, rows: list[int]) -> Array:
        """Derivatives (k, dofs) of some of the distances that `near` returned last, by the hand's
        velocities.

        Args:
            rows: Indices (k,) into them.
        """
        model, own = self._model, self._data
        mujoco.mj_comPos(model, own)
        mujoco.mj_makeConstraint(model, own)
        every = own.efc_J.reshape(own.nefc, model.nv)
        at = own.contact.efc_address.take(rows)
        gradients: Array = every.take(at, 0)[:, self.dofs]
        return gradients


_NOTHING = Near([], [], [])


def _range(part: slice) -> range:
    return range(part.start, part.stop)


def _shorten(model: mujoco.MjModel, geom: int, share: float) -> None:
    """Makes a link's capsule end before its fingertip begins."""
    # The capsule's axis is its own z, and its body's y.
    half: float = model.geom_size[geom, 1]
    middle: NDArray[np.float64] = model.geom_pos[geom]
    model.geom_pos[geom] = share * middle
    # MuJoCo takes a geom with the frame of its body's inertia to be there, wherever its own place.
    model.geom_sameframe[geom] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
    model.geom_size[geom, 1] = max(share * half, 1e-6)
