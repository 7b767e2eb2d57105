"""Retargeting: a robot's hand takes the pose of a person's hand, fingertip to fingertip.

Each step solves a damped least-squares problem: fingertips go to their places, joints stay within
their ranges and near the middle of them, and the palm stays near its place. This place follows from
the place of the person's palm: its distance to every fingertip is multiplied by the finger's scale.
Fingers that touch weigh more than fingers in the air.

MuJoCo places and differentiates the fingertips, and all products are in fixed order. So the result
depends only on MuJoCo's version and the system's libm.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arithmetic import (
    Array,
    matrix_product,
    matrix_vector,
    solve_positive,
    squared_lengths,
    stacked_applied,
    times_transposed,
    vector_matrix,
)
from models.errors import InputError
from models.frames import FINGERS
from models.pose import ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp, quaternion_exp
from models.single_pose import SinglePose
from models.skeleton import Skeleton

ROOT = 6
"""Degrees of freedom of the palm."""
ROOT_PLACE = 7
"""Number of coordinates of the palm's place in `qpos`."""

PALM_MOVES, PALM_TURNS = 2e-4, 5e-3
"""Variances (m2, rad2) of the palm's movement, relative to 1 rad2 of a finger's joint. Fingers move
their fingertips; the palm moves only if a finger cannot reach its place."""
TOUCHING, IN_THE_AIR = 2e-6, 2e-4
"""Damping (m2) of fingertips that touch, and of other fingertips."""
HOMING = 0.15
"""In a step, each joint covers this share of the way to the middle of its range, and the palm this
share of the way to its place, as far as the fingertips allow."""
LONGEST_STEP = 0.35
"""Largest change of a joint in a step (rad or m), within which the derivative is accurate."""
STEPS, FIRST_STEPS = 6, 60
"""Number of steps for the next pose of a movement, and for a first pose."""
CLOSE = 5e-5
"""Distance (m) of touching fingertips from their places below which no more steps are needed."""
REACHED = 0.005
"""A fingertip counts as having reached its touch within this distance (m)."""
_GRID = 2000
"""Number of parts into which a joint's range is divided, to find the part in which its follower is
within the follower's range."""
_ROUNDING = 1e-6
"""Angle (rad) by which a follower may leave its range, since models contain rounded numbers."""
_PASSES = 3
"""Largest number of times that a step is solved, each time without the joints that are at their
limits."""


class Retargeter:
    """Follows poses of one person's hand with a robot's hand.

    Each pose starts from the last result, so an object serves one movement at a time.

    Args:
        model: MuJoCo's model of the robot's hand alone: a palm on three slides and a ball joint,
            j further joints, and a site at the tip of each of the n fingers, with the finger's
            name.
        skeleton: The person's hand.
        scales: (n,) length of each finger relative to that of the person.
        offset: (3,) m, origin of the robot's palm in the frame of the person's hand.
        turn: (4,) quaternion, person's hand from robot's palm.
        followers: For each of the j joints, the number of the joint that it follows, or its own
            number; and the coefficients of a polynomial in the followed joint's angle, the constant
            coefficient first.
        palm: Variances (m2, rad2) of the palm's movement from its place.

    Attributes:
        off: (n,) m, distance of each fingertip from its place after the last step.
    """

    def __init__(
        self,
        model: Any,
        skeleton: Skeleton,
        scales: Array,
        offset: Array,
        turn: Array,
        followers: tuple[NDArray[np.int64], Sequence[tuple[float, ...]]],
        palm: tuple[float, float] = (PALM_MOVES, PALM_TURNS),
    ) -> None:
        self._model, self._data = model, mujoco.MjData(model)
        self._tips = SinglePose(skeleton).tips
        self._scales, self._offset, self._turn = scales, offset, turn
        count = model.nv
        self._master, laws = followers
        self._ratio = np.array([law[1] for law in laws])
        # Followers whose polynomial is not just a ratio.
        self._curved = [
            (joint, int(self._master[joint]), law)
            for joint, law in enumerate(laws)
            if law[0] or any(law[2:])
        ]
        low, high = model.jnt_range[4:].T.copy()
        # The range of a followed joint is limited so that its followers stay within their ranges.
        for joint, (master, law) in enumerate(zip(self._master, laws, strict=True)):
            if master != joint:
                ends = _within(law, (low[joint], high[joint]), (low[master], high[master]))
                low[master], high[master] = max(low[master], ends[0]), min(high[master], ends[1])
        self._low, self._high = low, high
        self._middle = 0.5 * (low + high)
        # Matrix from movements of free joints to those of all joints, including followers.
        self._free = np.array([m == j for j, m in enumerate(self._master)])
        self._spread = np.zeros((count, count))
        self._spread[:ROOT, :ROOT] = np.eye(ROOT)
        for joint, (master, ratio) in enumerate(zip(self._master, self._ratio, strict=True)):
            self._spread[ROOT + joint, ROOT + master] = ratio
        self._coupled = not self._free.all()
        self._weights = np.concatenate(
            [np.full(3, palm[0]), np.full(3, palm[1]), np.where(self._free, 1.0, 0.0)]
        )
        self._fingers = len(scales)
        self._raw = np.zeros((3 * self._fingers, count))
        self._sites = [int(model.site(name).id) for name in FINGERS[: self._fingers]]
        self._rows = [(self._raw[3 * f : 3 * f + 3], s) for f, s in enumerate(self._sites)]
        self.off = np.zeros(self._fingers)
        self._last: Array | None = None
        self._touching: tuple[int, ...] = ()
        self._lacking: frozenset[int] = frozenset()

    @property
    def missed(self) -> frozenset[int]:
        """Labels of the touching fingers that did not reach their places, or that this hand
        lacks."""
        off = (f for f in self._touching if self.off[f] > REACHED)
        return frozenset(off) | self._lacking

    def reset(self) -> None:
        """Forgets the last result; the next pose is solved from the beginning."""
        self._last = None

    def follow(self, q: Array, fingers: Collection[int] = range(len(FINGERS))) -> Array:
        """Joint positions (7 + j,) of the robot's hand for a pose (48,) of the person's hand.

        Args:
            q: The pose.
            fingers: Labels of the fingers that touch; their tips have priority.
        """
        targets = self._tips(q)[: self._fingers]
        place, turn = self._palm(q, targets)
        self._touching = touching = tuple(sorted(f for f in fingers if f < self._fingers))
        self._lacking = frozenset(fingers) - frozenset(touching)
        damping = np.full(3 * self._fingers, IN_THE_AIR)
        for finger in touching:
            damping[3 * finger : 3 * finger + 3] = TOUCHING
        qpos = self._data.qpos
        steps = STEPS
        if self._last is None:
            qpos[ROOT_PLACE:] = self._all(self._middle)
            qpos[:3], qpos[3:ROOT_PLACE] = place, turn
            steps = FIRST_STEPS
        else:
            # The palm moves with the person's palm. Its distance from its own place does not
            # change.
            before, before_turn, now = self._last[:3], self._last[3:7], self._last[7:]
            away = np.empty(4)
            back = before_turn * np.array([1.0, -1.0, -1.0, -1.0])
            mujoco.mju_mulQuat(away, back, now[3:7])
            qpos[:] = now
            qpos[:3] = place + (now[:3] - before)
            mujoco.mju_mulQuat(qpos[3:7], turn, away)
        for _ in range(steps):
            errors = self._errors(targets)
            if self._last is not None and touching and self._worst(touching) < CLOSE:
                break
            self._step(errors, place, turn, damping)
        self._errors(targets)
        self._last = np.concatenate([place, turn, qpos])
        return np.array(qpos)

    def _worst(self, fingers: Collection[int]) -> float:
        return max(self.off[finger] for finger in fingers)

    def _palm(self, q: Array, targets: Array) -> tuple[Array, Array]:
        """Place (3,) m and quaternion (4,) near which the robot's palm should stay."""
        rotation = exp(q[ROOT_ROTATION])
        palm = q[ROOT_POSITION] + stacked_applied(rotation, self._offset)
        wanted = targets + self._scales[:, None] * (palm - targets)
        place = wanted[0]
        for row in wanted[1:]:
            place = place + row
        turn = np.empty(4)
        mujoco.mju_mulQuat(turn, quaternion_exp(q[ROOT_ROTATION]), self._turn)
        return place / self._fingers, turn

    def _errors(self, targets: Array) -> Array:
        """Vectors (3 n,) m from the fingertips to their places."""
        mujoco.mj_kinematics(self._model, self._data)
        errors = targets - self._data.site_xpos.take(self._sites, 0)
        self.off = np.sqrt(squared_lengths(errors))
        return np.asarray(errors).ravel()

    def _step(self, errors: Array, place: Array, turn: Array, damping: Array) -> None:
        model, data = self._model, self._data
        mujoco.mj_comPos(model, data)
        for rows, site in self._rows:
            mujoco.mj_jacSite(model, data, rows, None, site)
        for joint, master, law in self._curved:
            slope = _polynomial(_derivative(law), float(data.qpos[ROOT_PLACE + master]))
            self._spread[ROOT + joint, ROOT + master] = slope
        jacobian = matrix_product(self._raw, self._spread) if self._coupled else self._raw
        home = np.empty(model.nv)
        home[:3] = place - data.qpos[:3]
        # Rotation of the palm back to its place, in its own frame.
        mujoco.mju_subQuat(home[3:ROOT], turn, data.qpos[3:ROOT_PLACE])
        angles = data.qpos[ROOT_PLACE:]
        home[ROOT:] = self._middle - angles
        home *= HOMING
        least, most = self._low - angles, self._high - angles
        weights = self._weights.copy()
        fixed = np.zeros(model.nv)
        for _ in range(_PASSES):
            wanted = np.where(weights > 0.0, home, fixed)
            weighted = jacobian * weights
            normal = times_transposed(weighted, jacobian)
            normal.flat[:: len(normal) + 1] += damping
            pull = solve_positive(normal, errors - matrix_vector(jacobian, wanted))
            step = wanted + weights * vector_matrix(pull, jacobian)
            joints = step[ROOT:]
            over = ((joints < least) | (joints > most)) & (weights[ROOT:] > 0.0)
            if not over.any():
                break
            fixed[ROOT:] = np.where(over, np.clip(joints, least, most), fixed[ROOT:])
            weights[ROOT:][over] = 0.0
        step = np.clip(step, -LONGEST_STEP, LONGEST_STEP)
        whole = step.copy()
        whole[ROOT:] = 0.0
        mujoco.mj_integratePos(model, data.qpos, whole, 1.0)
        new = np.clip(angles + step[ROOT:], self._low, self._high)
        data.qpos[ROOT_PLACE:] = self._all(new)

    def _all(self, angles: Array) -> Array:
        """Angles (j,) of all joints. Angles of followers are computed from those of the joints that
        they follow."""
        out = angles[self._master] * self._ratio
        for joint, master, law in self._curved:
            out[joint] = _polynomial(law, float(angles[master]))
        return out


def _polynomial(law: Sequence[float], x: float) -> float:
    """Value of a polynomial, given its coefficients, the constant coefficient first."""
    value = 0.0
    for c in reversed(law):
        value = value * x + c
    return value


def _derivative(law: Sequence[float]) -> list[float]:
    return [power * c for power, c in enumerate(law)][1:]


def _within(
    law: tuple[float, ...], own: tuple[float, float], other: tuple[float, float]
) -> tuple[float, float]:
    """Range of a joint in which its follower is within the follower's own range.

    If there are several such ranges, the result is the longest of them.

    Args:
        law: The follower's polynomial.
        own: Least and greatest angle of the follower.
        other: Least and greatest angle of the joint that it follows.

    Raises:
        InputError: There is no such range.
    """
    if not any(law[2:]):
        ends = sorted(((own[0] - law[0]) / law[1], (own[1] - law[0]) / law[1]))
        return ends[0], ends[1]
    places = [other[0] + i / _GRID * (other[1] - other[0]) for i in range(_GRID + 1)]
    good = [own[0] - _ROUNDING <= _polynomial(law, x) <= own[1] + _ROUNDING for x in places]
    best, start = (0, -1), 0
    for i, fits in enumerate([*good, False]):
        if not fits:
            best = max(best, (start, i - 1), key=lambda part: part[1] - part[0])
            start = i + 1
    if best[1] < best[0]:
        raise InputError(
            "a coupled joint is outside of its range at all angles of the joint that it follows",
            where="[coupled]",
            got=str(list(law)),
        )
    return places[best[0]], places[best[1]]
