"""Clearing: the parts of a hand that do not touch keep clear of things.

The touches decide where the touching fingertips are; all else of a hand may be anywhere plausible.
The encoder's pose is taken as a guess, and of the poses that keep the fingertips and are clear of
things the likeliest is commanded. Without a thing near, that is the encoder's.

Likely is what is near the encoder's pose, and near the pose before: where no pose is clear, what
leads the hand changes from step to step, and without the second the hand would tremble. As the
correction may go on from where it is, it ends where it would without.
"""

from __future__ import annotations

from math import expm1

import mujoco
import numpy as np
from numpy.typing import NDArray

from encoders.reconstruction.touch_reconstructor import Reconstruction
from models.arithmetic.arrays import Array
from models.arithmetic.products import (
    length,
    matrix_vector,
    solve_positive,
    times_transposed,
    vector_matrix,
)
from models.one_pose import OnePose
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION
from models.scene import CONTROL_PERIOD, Scene
from models.skeleton import Skeleton
from models.surface import Surface
from sandbox.clearing.hand_distances import HandDistances, Near

MARGIN = 0.005
"""m that parts of a hand without a touch keep from things: as far as a hand moves in a control
period at 0.3 m/s."""
BESIDE = 0.002
"""m that the inner links of a touching finger keep, at most, from the things that its tip is at.
The tip of a finger that presses is commanded into the thing; by this much its links stay behind."""
NOTICED = 0.003
"""m beyond its margin, from which on a part takes part: it must not be led into its margin. One
that was led last takes part as far as distances are measured, or it would fall back once it is
clear."""

BEND, SWAY, MOVE, TILT = 0.35, 0.12, 0.02, 0.12
"""rad of a joint's flexion, rad of its two other components, m and rad of the palm: how far each is
likely to be from the encoder's pose (standard deviations)."""
STEADY = 0.17
"""The same deviations around the correction before, as a share of those around the encoder's
pose."""
TIP_SIGMA = 0.0002
"""m, how exactly fingertips stay where they are."""
CLEAR_SIGMA = 0.0005
"""m, how exactly margins are kept."""

AHEAD = 0.08
"""s, how far a moving hand looks ahead: the correction and the servos follow late, by about as
much."""
FAR = 0.02
"""m, how far it looks ahead at most; beyond, things may lie on a link's other side."""
SLOW = 0.02
"""m/s, below which a hand does not look ahead."""

TAU = 0.02
"""s, time constant with which the correction follows."""
SPEED = 6.0
"""rad/s (and a tenth of it, m/s), largest speed of the correction."""

_SLACK = 1e-6
_SHORT = 1e-4
"""m, by which a margin that was dropped may be broken."""
_ROUNDS = 12
"""Rounds in which joints may be held at the ends of their ranges."""
_STILL = 1e-5
"""rad (and m), below which a correction that is not needed has gone."""


class Clearing:
    """Corrects the commanded poses of one hand.

    Args:
        scene: The scene.
        hand: Index of the hand.
        skeleton: The hand's skeleton; its pose is the hand's joint positions.
        surface: Surface of its touches.
        distances: Distances of its parts.
    """

    def __init__(
        self,
        scene: Scene,
        hand: int,
        skeleton: Skeleton,
        surface: Surface,
        distances: HandDistances,
    ) -> None:
        self._distances = distances
        self._skeleton, self._surface = skeleton, surface
        self._kinematics: dict[tuple[int, ...], OnePose] = {}
        self._held: dict[tuple[int, ...], NDArray[np.int64]] = {}
        self._own = scene.qpos_slice(hand)
        # Of two normal distributions, around no correction and around the one before: the part of
        # the one before that is likeliest, and the variance around it.
        self._part = 1.0 / (1.0 + STEADY * STEADY)
        self._variance = STEADY * STEADY * self._part * _variance()
        self._share = -expm1(-CONTROL_PERIOD / TAU)
        self._up = surface.rotation[:, 2].copy()
        self._low, self._high = skeleton.lower, skeleton.upper
        model = scene.model
        links = scene.spec.hands[hand].links
        self._finger = {
            model.geom(name).id: link.finger
            for link in links
            for name in (link.geom, link.tip_geom)
        }
        last = {link.finger: link for link in links}
        self._thing: list[int] = model.geom_bodyid.tolist()
        self._end = {model.geom(link.tip_geom).id: f for f, link in last.items()}
        self._roles: dict[tuple[int, ...], tuple[dict[int, int], dict[int, int]]] = {}
        self.reset()

    def reset(self) -> None:
        """Forgets the correction."""
        self.offset: Array | None = None
        # The parts that were led last.
        self._led: frozenset[int] = frozenset()
        self._before: tuple[tuple[int, ...], Array] | None = None

    def step(
        self, data: mujoco.MjData, reconstruction: Reconstruction, ghost: bool = False
    ) -> Reconstruction:
        """The reconstruction with the pose to command instead.

        Args:
            data: Current state of the simulation.
            reconstruction: Current reconstruction from touches.
            ghost: True while the hand passes through everything: nothing has to be kept clear of.
        """
        fingers = () if ghost else tuple(sorted(reconstruction.touches))
        wanted = self._wanted(data, reconstruction, fingers) if fingers else None
        if not fingers:
            self._before = None
        if wanted is None:
            self._led = frozenset()
        self.offset = self._towards(wanted)
        if self.offset is None:
            return reconstruction
        q = reconstruction.q + self.offset
        q[JOINTS] = np.minimum(np.maximum(q[JOINTS], self._low), self._high)
        return reconstruction.with_pose(q)

    def _towards(self, wanted: Array | None) -> Array | None:
        """The next correction on the way to the wanted one; None is none."""
        if self.offset is None and wanted is None:
            return None
        now = np.zeros(POSE_SIZE) if self.offset is None else self.offset
        goal = np.zeros(POSE_SIZE) if wanted is None else wanted
        step = self._share * (goal - now)
        sizes = np.abs(step)
        sizes[ROOT_POSITION] *= 10.0
        fastest = float(sizes.max()) / (SPEED * CONTROL_PERIOD)
        if wanted is None and float(np.abs(now).max()) < _STILL:
            return None
        return now + (step / fastest if fastest > 1.0 else step)

    def _wanted(
        self,
        data: mujoco.MjData,
        reconstruction: Reconstruction,
        fingers: tuple[int, ...],
    ) -> Array | None:
        """The likeliest correction (48,) at which the hand is clear; None without one."""
        kinematics = self._kinematics.get(fingers)
        if kinematics is None:
            kinematics = self._kinematics[fingers] = OnePose(self._skeleton, fingers)
            self._held[fingers] = _joints_of(self._skeleton, fingers)
        q0 = reconstruction.q
        at = kinematics.tips(q0)
        offset = self.offset
        q, reached = q0, at
        if offset is not None:
            q = q0 + offset
            reached = kinematics.tips(q)
        qpos = kinematics.joint_positions()
        if reconstruction.down:
            # What presses is held back: the palm and touching fingers are seen where they are.
            held = self._held[fingers]
            qpos[held] = data.qpos[self._own][held]
        else:
            # The hand is seen where it will be once it is down.
            qpos[ROOT_POSITION] += self._landing(reconstruction, fingers, at)
        velocity = self._velocity(reconstruction, fingers, at)
        near = self._distances.near(data, qpos)
        rows, lacking = self._lacking(near, fingers)
        parts = [near.parts[row] for row in rows]
        # Now, and where everything goes.
        seen = [(qpos, 0.0, rows)]
        speed = length(velocity)
        if speed > SLOW:
            ahead = min(AHEAD, FAR / speed)
            gone = qpos.copy()
            gone[ROOT_POSITION] += ahead * velocity
            near = self._distances.near(data, gone, ahead)
            rows, more = self._lacking(near, fingers)
            parts += [near.parts[row] for row in rows]
            seen.append((gone, ahead, rows))
            lacking += more
        if not lacking or (offset is None and max(lacking) <= 0.0):
            return None
        _, J = kinematics.tips_and_jacobian(q)
        gradients = []
        for place, ahead, rows in reversed(seen):
            if rows:
                if len(seen) > 1 and not ahead:
                    self._distances.near(data, place)
                gradients.append(self._distances.gradients(rows))
        G = kinematics.by_pose(np.concatenate(gradients[::-1]))
        A = np.concatenate([J.reshape(-1, POSE_SIZE), G])
        r = np.concatenate([(at - reached).ravel(), lacking])
        if offset is not None:
            r += matrix_vector(A, offset)
        wanted, kept = self._likeliest(A, r, 3 * len(fingers), q0)
        self._led = frozenset(parts[row] for row in kept)
        return wanted

    def _velocity(
        self, reconstruction: Reconstruction, fingers: tuple[int, ...], at: Array
    ) -> Array:
        """(3,) m/s of the commanded fingertips of a hand that is down."""
        middle = at.mean(axis=0)
        before, self._before = self._before, (fingers, middle)
        if before is None or before[0] != fingers or not reconstruction.down:
            return np.zeros(3)
        velocity: Array = (middle - before[1]) / CONTROL_PERIOD
        return velocity

    def _landing(
        self, reconstruction: Reconstruction, fingers: tuple[int, ...], at: Array
    ) -> Array:
        """(3,) m from the commanded hand above the surface to where it comes down."""
        heights = (at - self._surface.corner) * self._up
        high = float(heights.sum()) / len(fingers) - reconstruction.tip_height
        return -high * self._up

    def _lacking(self, near: Near, fingers: tuple[int, ...]) -> tuple[list[int], list[float]]:
        """Contacts that matter, and how much of their margin each lacks, m; negative beyond it."""
        ends, inner = self._touching(fingers)
        # How far each touching fingertip is from each thing.
        tips: dict[tuple[int, int], float] = {}
        for part, distance, geom in zip(*near, strict=True):
            if part in ends:
                key = ends[part], self._thing[geom]
                tips[key] = min(tips.get(key, MARGIN), distance)
        rows, lacking = [], []
        for row, (part, distance, geom) in enumerate(zip(*near, strict=True)):
            if part in ends:
                continue
            margin = MARGIN
            if tips and part in inner:
                tip = tips.get((inner[part], self._thing[geom]), MARGIN)
                if tip < MARGIN:
                    margin = min(BESIDE, tip + BESIDE)
            if distance < margin + NOTICED or part in self._led:
                rows.append(row)
                lacking.append(margin - distance)
        return rows, lacking

    def _touching(self, fingers: tuple[int, ...]) -> tuple[dict[int, int], dict[int, int]]:
        """Fingers by the parts of touching ones: their tips, and what is not a tip."""
        roles = self._roles.get(fingers)
        if roles is None:
            ends = {part: f for part, f in self._end.items() if f in fingers}
            inner = {
                part: f for part, f in self._finger.items() if f in fingers and part not in ends
            }
            roles = self._roles[fingers] = ends, inner
        return roles

    def _likeliest(self, A: Array, r: Array, exact: int, q0: Array) -> tuple[Array, list[int]]:
        """The likeliest correction (48,) whose tips stay, and whose margins are kept; and the
        margins that lead it, by their places behind the tips' rows.

        Without tips and margins, the likeliest is a part of the correction before.

        An active-set search: a margin that would draw a part towards a thing is dropped, the
        one of those dropped that the rest keeps least comes back, and a joint that would leave
        its range is held at its end.

        Args:
            A: (exact + n, 48) derivatives of tips and distances.
            r: (exact + n,) m, how much each should change, seen from no correction.
            exact: Number of the tips' rows.
            q0: (48,) legal pose without the correction.
        """
        variance = self._variance.copy()
        held = np.zeros(POSE_SIZE) if self.offset is None else self._part * self.offset
        low, high = self._low - q0[JOINTS], self._high - q0[JOINTS]
        noise = np.full(len(r), CLEAR_SIGMA**2)
        noise[:exact] = TIP_SIGMA**2
        keep = list(range(len(r)))
        offset = held
        dropped: list[int] = []
        moved = True
        for _ in range(3 * (len(r) - exact) + _ROUNDS):
            if moved:
                # Of all rows; a part of them has the same numbers.
                AV = A * variance
                every = times_transposed(AV, A)
                every.reshape(-1)[:: len(r) + 1] += noise
                missing = r - matrix_vector(A, held)
                moved = False
            weights = solve_positive(every.take(keep, 0).take(keep, 1), missing.take(keep))
            pulls = weights[exact:]
            if len(pulls) and (worst := int(pulls.argmin())) >= 0 and pulls[worst] < 0.0:
                dropped.append(keep.pop(exact + worst))
                continue
            offset = vector_matrix(weights, AV.take(keep, 0)) + held
            if dropped:
                short = r.take(dropped) - matrix_vector(A.take(dropped, 0), offset)
                if short[least := int(short.argmax())] > _SHORT:
                    keep.append(dropped.pop(least))
                    continue
            joints = offset[JOINTS]
            legal = np.minimum(np.maximum(joints, low), high)
            beyond = np.abs(joints - legal) > _SLACK
            joints[:] = legal
            if not beyond.any():
                break
            rows = beyond.nonzero()[0] + JOINTS.start
            held[rows] = offset[rows]
            variance[rows] = 0.0
            moved = True
        return offset, [row - exact for row in keep[exact:]]


def _joints_of(skeleton: Skeleton, fingers: tuple[int, ...]) -> NDArray[np.int64]:
    """Indices of the palm and of some fingers into a hand's joint positions (63,)."""
    at = [*range(_PALM)]
    for i, bone in enumerate(skeleton.bones):
        if bone.finger in fingers:
            at += range(_PALM + 4 * i, _PALM + 4 * (i + 1))
    return np.array(at)


_PALM = 7
"""Joint positions of the palm: three slides and a quaternion. Those of bones follow, 4 each."""


def _variance() -> Array:
    """(48,) of the pose around the encoder's."""
    sigma = np.empty(POSE_SIZE)
    sigma[ROOT_POSITION] = MOVE
    sigma[ROOT_ROTATION] = TILT
    sigma[JOINTS] = SWAY
    # The first component of a joint's turn is its flexion, the axis across the finger.
    sigma[JOINTS.start :: 3] = BEND
    return sigma * sigma
