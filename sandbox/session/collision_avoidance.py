"""Collision avoidance of a hand whose links are all solid.

The touches fix the places of the touching fingertips; the rest of the hand may take any plausible
pose. Some poses leave these fingertips in place and are clear of objects. `CollisionAvoidance`
commands the likeliest of these poses, given the encoder's pose. If no object is near, it commands
the encoder's pose itself.

A pose is likely if it is near the encoder's pose and near the corrected pose of the step before. If
no pose is clear, the active margins change from step to step. Nearness to the pose of the step
before then prevents trembling. It does not change the pose at which a correction finally settles.

`HandDistances` measures the distances between parts of the hand and objects. It uses MuJoCo's
collision detection in a copy of the scene, in which the hand is always present and pushes nothing.

`SolidLinks` makes each part solid separately, once the touching fingertips are solid and the part
is clear of objects. A part that becomes solid inside an object would throw the object away.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import replace
from math import expm1
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from encoders.reconstruction.reconstructor import Reconstruction
from models.arithmetic import (
    Array,
    length,
    matrix_vector,
    solve_positive,
    times_transposed,
    vector_matrix,
)
from models.hand import CONTACT_HAND
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION
from models.scene import CONTROL_PERIOD, Scene
from models.single_pose import SinglePose
from models.skeleton import Skeleton
from models.surface import Surface

MARGIN = 0.005
"""Margin between objects and the parts of a hand that do not touch, m: the distance that a hand
moves in a control period at 0.3 m/s."""
BESIDE = 0.002
"""Largest margin between the inner links of a touching finger and the object at its tip, m. The tip
of a pressing finger is commanded into the object; its links stay behind by this margin."""
NOTICED = 0.003
"""A part is constrained while its distance is less than its margin plus this number, m. Otherwise a
correction could move the part into its margin. A part that was corrected in the last step stays
constrained up to the largest measured distance; otherwise it would fall back as soon as it is
clear."""

BEND, SWAY, MOVE, TILT = 0.35, 0.12, 0.02, 0.12
"""Standard deviations around the encoder's pose: of a joint's flexion (rad), of its two other
components (rad), of the palm's position (m) and of its rotation (rad)."""
STEADY = 0.17
"""Standard deviations around the previous correction, as a share of those around the encoder's
pose."""
TIP_SIGMA = 0.0002
"""Standard deviation of the touching fingertips' places, m."""
CLEAR_SIGMA = 0.0005
"""Standard deviation of the margins, m."""

AHEAD = 0.08
"""Time by which distances of a moving hand are predicted, s: about the delay of the correction and
the servos."""
FAR = 0.02
"""Largest predicted movement, m. After a larger movement, an object may be on the other side of a
link."""
SLOW = 0.02
"""Speed below which no movement is predicted, m/s."""

TAU = 0.02
"""Time constant of the correction, s."""
SPEED = 6.0
"""Largest speed of the correction of rotations, rad/s. The largest speed of the correction of the
palm's position is a tenth of this number, in m/s."""

_SLACK = 1e-6
_SHORT = 1e-4
"""Tolerated violation of a margin that was dropped, m."""
_ROUNDS = 12
"""Number of iterations that are allowed in addition to three for each margin. They are for joints
that have to be held at the ends of their ranges."""
_STILL = 1e-5
"""Size below which a correction that is no longer needed ends, rad and m."""


class CollisionAvoidance:
    """Corrects the commanded poses of one hand.

    Args:
        scene: The scene.
        hand: Index of the hand.
        skeleton: The hand's skeleton; its pose is the hand's joint positions.
        surface: Touch surface of the hand.
        distances: Distances of the hand's parts.
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
        self._kinematics: dict[tuple[int, ...], SinglePose] = {}
        # By touching fingers: indices of the joint positions of the palm and these fingers, in the
        # hand and in the scene.
        self._held: dict[tuple[int, ...], tuple[NDArray[np.int64], NDArray[np.int64]]] = {}
        self._start = int(scene.qpos_slice(hand).start)
        # Two normal distributions are multiplied: one around no correction, one around the previous
        # correction. The product's mean is this share of the previous correction, and its variance
        # is smaller.
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
        """Resets the correction to none."""
        self.offset: Array | None = None
        # The parts whose margins determined the correction of the last step.
        self._led: frozenset[int] = frozenset()
        self._before: tuple[tuple[int, ...], Array] | None = None

    def step(
        self, data: mujoco.MjData, reconstruction: Reconstruction, ghost: bool = False
    ) -> Reconstruction:
        """Returns the reconstruction with the corrected pose to command.

        Args:
            data: Current state of the simulation.
            reconstruction: Current reconstruction from touches.
            ghost: True while the hand passes through everything and need not avoid objects.
        """
        fingers = () if ghost else tuple(sorted(reconstruction.touches))
        wanted = self._clear_correction(data, reconstruction, fingers) if fingers else None
        if not fingers:
            self._before = None
        if wanted is None:
            self._led = frozenset()
        self.offset = self._towards(wanted)
        if self.offset is None:
            return reconstruction
        q = reconstruction.q + self.offset
        joints = q[JOINTS]
        np.minimum(np.maximum(joints, self._low, out=joints), self._high, out=joints)
        return replace(reconstruction, q=q)

    def _towards(self, wanted: Array | None) -> Array | None:
        """Returns the next correction on the way to the target correction; None is no correction.

        Args:
            wanted: The target correction (48,); None for no correction.
        """
        if self.offset is None and wanted is None:
            return None
        now = np.zeros(POSE_SIZE) if self.offset is None else self.offset
        if wanted is None and float(np.abs(now).max()) < _STILL:
            return None
        step = (0.0 if wanted is None else wanted) - now
        step *= self._share
        sizes = np.abs(step)
        sizes[ROOT_POSITION] *= 10.0
        fastest = float(sizes.max()) / (SPEED * CONTROL_PERIOD)
        if fastest > 1.0:
            step /= fastest
        step += now
        return step

    def _clear_correction(
        self,
        data: mujoco.MjData,
        reconstruction: Reconstruction,
        fingers: tuple[int, ...],
    ) -> Array | None:
        """Returns the likeliest correction (48,) that clears the hand; None if none is needed."""
        kinematics = self._kinematics.get(fingers)
        if kinematics is None:
            kinematics = self._kinematics[fingers] = SinglePose(self._skeleton, fingers)
            held = _joints_of(self._skeleton, fingers)
            self._held[fingers] = held, held + self._start
        q0 = reconstruction.q
        at = kinematics.tips(q0)
        offset = self.offset
        q, reached = q0, at
        if offset is not None:
            q = q0 + offset
            reached = kinematics.tips(q)
        qpos = kinematics.joint_positions()
        if reconstruction.down:
            # The simulated palm and touching fingers may lag behind the command when they press:
            # measure distances at their simulated places.
            held, there = self._held[fingers]
            qpos[held] = data.qpos.take(there)
        else:
            # Measure distances at the place of the hand after its descent.
            qpos[ROOT_POSITION] += self._landing(reconstruction, fingers, at)
        velocity = self._velocity(reconstruction, fingers, at)
        near = self._distances.near(data, qpos)
        rows, lacking = self._lacking(near, fingers)
        parts = [near.parts[row] for row in rows]
        rows_ahead: list[int] = []
        speed = length(velocity)
        if speed > SLOW:
            # The predicted places of hand and objects.
            ahead = min(AHEAD, FAR / speed)
            qpos[ROOT_POSITION] += ahead * velocity
            near = self._distances.near(data, qpos, ahead)
            rows_ahead, more = self._lacking(near, fingers)
            parts += [near.parts[row] for row in rows_ahead]
            lacking += more
        if not lacking or (offset is None and max(lacking) <= 0.0):
            return None
        # The Jacobian at q, the last pose for which the kinematics were computed.
        J = kinematics.jacobian(q)
        gradients = [
            self._distances.gradients(some, ahead)
            for some, ahead in ((rows, False), (rows_ahead, True))
            if some
        ]
        G = kinematics.by_pose(np.concatenate(gradients))
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
        """Velocity (3,) of the commanded fingertips of a hand that is down, m/s."""
        middle: Array = np.add.reduce(at, 0) / len(at)
        before, self._before = self._before, (fingers, middle)
        if before is None or before[0] != fingers or not reconstruction.down:
            return np.zeros(3)
        velocity: Array = (middle - before[1]) / CONTROL_PERIOD
        return velocity

    def _landing(
        self, reconstruction: Reconstruction, fingers: tuple[int, ...], at: Array
    ) -> Array:
        """Displacement (3,) from the commanded hand above the surface to its landing place, m."""
        heights = (at - self._surface.corner) * self._up
        high = float(np.add.reduce(heights, None)) / len(fingers) - reconstruction.tip_height
        return -high * self._up

    def _lacking(self, near: Near, fingers: tuple[int, ...]) -> tuple[list[int], list[float]]:
        """Returns the relevant pairs, as indices into `near`, and each pair's violation of its
        margin, m.

        A negative violation is the distance beyond the margin.
        """
        ends, inner = self._touching(fingers)
        parts, distances, geoms = near
        # Distance of each touching fingertip from each object, m.
        tips: dict[tuple[int, int], float] = {}
        for row, part in enumerate(parts):
            if part in ends:
                key = ends[part], self._thing[geoms[row]]
                tips[key] = min(tips.get(key, MARGIN), distances[row])
        rows, lacking = [], []
        for row, part in enumerate(parts):
            if part in ends:
                continue
            margin = MARGIN
            if tips and part in inner:
                tip = tips.get((inner[part], self._thing[geoms[row]]), MARGIN)
                if tip < MARGIN:
                    margin = min(BESIDE, tip + BESIDE)
            if distances[row] < margin + NOTICED or part in self._led:
                rows.append(row)
                lacking.append(margin - distances[row])
        return rows, lacking

    def _touching(self, fingers: tuple[int, ...]) -> tuple[dict[int, int], dict[int, int]]:
        """Returns the finger of each part of the touching fingers, by the part's geom.

        The first dictionary has the fingertips, the second one the other parts.
        """
        roles = self._roles.get(fingers)
        if roles is None:
            ends = {part: f for part, f in self._end.items() if f in fingers}
            inner = {
                part: f for part, f in self._finger.items() if f in fingers and part not in ends
            }
            roles = self._roles[fingers] = ends, inner
        return roles

    def _likeliest(self, A: Array, r: Array, exact: int, q0: Array) -> tuple[Array, list[int]]:
        """Finds the likeliest correction that leaves the tips in place and keeps the margins.

        Without tips and margins, the likeliest correction is a share of the previous correction.

        The method is an active-set search. A margin that would pull a part towards an object is
        dropped. If dropped margins are violated, the most violated margin is added again. A joint
        that would leave its range is held at the range's end.

        Args:
            A: (exact + n, 48) derivatives of tips and distances.
            r: (exact + n,) m, change that each row needs, counted from the pose without a
                correction.
            exact: Number of the tips' rows.
            q0: (48,) legal pose without the correction.

        Returns:
            The correction (48,), and the active margins as indices after the tips' rows.
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
                # Compute the products for all rows once. Selecting rows afterwards gives the same
                # numbers.
                AV = A * variance
                every = times_transposed(AV, A)
                every.reshape(-1)[:: len(r) + 1] += noise
                missing = r - matrix_vector(A, held)
                moved = False
            at = np.array(keep)
            weights = solve_positive(every.take(at, 0).take(at, 1), missing.take(at))
            pulls = weights[exact:]
            if len(pulls) and (worst := int(pulls.argmin())) >= 0 and pulls[worst] < 0.0:
                dropped.append(keep.pop(exact + worst))
                continue
            offset = vector_matrix(weights, AV.take(at, 0)) + held
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
"""Number of the palm's joint positions: three slides and a quaternion. Each bone then has four
joint positions."""


def _variance() -> Array:
    """Variance (48,) of the pose around the encoder's pose."""
    sigma = np.empty(POSE_SIZE)
    sigma[ROOT_POSITION] = MOVE
    sigma[ROOT_ROTATION] = TILT
    sigma[JOINTS] = SWAY
    # The first component of a joint's rotation is its flexion, about the axis across the finger.
    sigma[JOINTS.start :: 3] = BEND
    return sigma * sigma


REACH = 0.02
"""Largest measured distance, m."""

_IDLE = (
    mujoco.mjtDisableBit.mjDSBL_LIMIT
    | mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS
    | mujoco.mjtDisableBit.mjDSBL_EQUALITY
)
"""Constraint types of MuJoCo other than contacts."""


class Near(NamedTuple):
    """Pairs of a part of the hand and a near geom.

    Attributes:
        parts: Indices (n,) of the parts' geoms. A part may occur twice, for example with a contact
            at each end of its capsule.
        distances: Distances (n,) between surfaces, m; negative inside.
        things: Indices (n,) of the near geoms, which belong to objects or other hands.
    """

    parts: Sequence[int]
    distances: Sequence[float]
    things: Sequence[int]


class HandDistances:
    """Measures the distances of one hand's parts to objects and to other hands.

    The last link of a finger has two parts: the fingertip (the link's `tip_geom`) and the rest of
    the link (the link's `geom`).

    Args:
        scene: The scene as compiled, before any part became a ghost.
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
        # Geoms that can collide with hands, and the other hands' geoms.
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
        # A contact within its gap would have no constraint row.
        model.geom_gap[:] = 0.0
        # MuJoCo tests the geoms of a body only within the body's own margin.
        model.body_margin[model.geom_bodyid[parts]] = REACH
        # One constraint row for each contact: the derivative of its distance.
        model.geom_condim[:] = 1
        model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        model.opt.disableflags |= int(_IDLE)
        # Current and predicted places.
        self._now, self._ahead = mujoco.MjData(model), mujoco.MjData(model)
        start = int(model.joint(own.first_joint).dofadr[0])
        inside = [j for j in range(model.njnt) if model.jnt_qposadr[j] in _range(self._hand)]
        last = inside[-1]
        ends = model.jnt_dofadr[last + 1] if last + 1 < model.njnt else model.nv
        self.dofs = slice(start, int(ends))

    def near(self, data: mujoco.MjData, qpos: Array | None = None, ahead: float = 0.0) -> Near:
        """Returns the parts of the hand near other geoms, with their distances.

        Args:
            data: State of the simulation, with the places of all geoms.
            qpos: Joint positions (m,) of the hand; None uses the joint positions of the state.
            ahead: Time for which objects move on with their current velocity, s.
        """
        own = self._ahead if ahead else self._now
        own.qpos[:] = data.qpos
        if ahead:
            mujoco.mj_integratePos(self._model, own.qpos, data.qvel, ahead)
        if qpos is not None:
            own.qpos[self._hand] = qpos
        mujoco.mj_kinematics(self._model, own)
        mujoco.mj_collision(self._model, own)
        if not own.ncon:
            return _NOTHING
        contact, mine = own.contact, self._parts
        # MuJoCo orders the two geoms of a contact by their type.
        pairs = [(a, b) if a in mine else (b, a) for a, b in contact.geom.tolist()]
        parts, things = zip(*pairs, strict=True)
        return Near(parts, contact.dist.tolist(), things)

    def gradients(self, rows: list[int], ahead: bool = False) -> Array:
        """Returns derivatives (k, dofs) of distances with respect to the hand's joints.

        Args:
            rows: Indices (k,) into the distances that `near` returned last.
            ahead: True refers to the last call of `near` with a time `ahead`. False refers to the
                last call without this argument.
        """
        model, own = self._model, self._ahead if ahead else self._now
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
    # The capsule's axis is its own z axis, and the y axis of its body.
    half: float = model.geom_size[geom, 1]
    middle: NDArray[np.float64] = model.geom_pos[geom]
    model.geom_pos[geom] = share * middle
    # With another value, MuJoCo would use the frame of the body's inertia instead of the geom's.
    model.geom_sameframe[geom] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
    model.geom_size[geom, 1] = max(share * half, 1e-6)


CLEARANCE = 0.0005
"""Smallest distance between a part and objects at which the part becomes solid, m."""

INSIDE = 0.0015
"""Depth in an object, m. A part that is deeper in an object, by the object's own distance function,
does not become solid."""

_ALONG = np.linspace(-1.0, 1.0, 9)
"""Positions of the balls that cover a capsule: distances along its axis from its middle, as shares
of half its length."""


class SolidLinks:
    """Decides step by step which parts of one hand are solid.

    Args:
        scene: The scene.
        hand: Index of the hand.
        distances: Distances of the hand's parts.

    Attributes:
        fingers: Labels of the fingers whose last link is solid, whether they touch or not.
        signature: The solid parts as a bit mask. They affect the next step, and MuJoCo's state does
            not contain them.
    """

    def __init__(self, scene: Scene, hand: int, distances: HandDistances) -> None:
        self._scene, self._hand, self._distances = scene, hand, distances
        links, geom = scene.spec.hands[hand].links, scene.model.geom
        self._parts = tuple(scene.parts(hand))
        # For each finger: its links from the palm outwards, and the solid end of the last link.
        self._links: dict[int, list[int]] = {}
        for link in links:
            self._links.setdefault(link.finger, []).append(geom(link.geom).id)
        self._ends = {link.finger: geom(link.tip_geom).id for link in links}
        of_fingers = {g for own in self._links.values() for g in own} | set(self._ends.values())
        self._palm = [g for g in self._parts if g not in of_fingers]
        sizes = scene.model.geom_size[list(self._parts)]
        self._radii, self._halves = sizes[:, 0], sizes[:, 1]
        self.fingers: frozenset[int] = frozenset()
        self._touching: frozenset[int] = frozenset()
        self._solid: frozenset[int] = frozenset()
        # The pressing and touching fingers once all permitted parts are solid for them; until then
        # None.
        self._complete: tuple[frozenset[int], frozenset[int]] | None = None
        self.signature = self._mask()

    def _mask(self) -> bytes:
        mask = sum(1 << i for i, part in enumerate(self._parts) if part in self._solid)
        return mask.to_bytes((len(self._parts) + 7) // 8, "little")

    def balls(self, data: mujoco.MjData) -> tuple[Array, Array]:
        """Returns centres (n, 3) and radii (n,), m, of balls that cover all parts (capsules)."""
        parts = list(self._parts)
        axes = data.geom_xmat[parts].reshape(-1, 3, 3)[:, :, 2]
        along = _ALONG[:, None] * self._halves
        middles = data.geom_xpos[parts] + along[:, :, None] * axes
        return middles.reshape(-1, 3), np.tile(self._radii, len(_ALONG))

    def update(
        self, data: mujoco.MjData, pressing: frozenset[int], touching: frozenset[int]
    ) -> None:
        """Chooses the solid parts for the next step.

        Args:
            data: Current state of the simulation.
            pressing: Fingers whose tips are solid and touch; without such a finger, the hand is a
                ghost.
            touching: Fingers that touch.
        """
        if self._complete == (pressing, touching):
            return
        before, self._complete = self._solid, None
        solid = self._joined(data, pressing, touching) if pressing else frozenset()
        self._touching = touching
        if solid != before:
            self._solid = solid
            self.signature = self._mask()
            self._scene.set_solid_geoms(self._hand, solid)
            self.fingers = frozenset(
                f for f in self._links if self._links[f][-1] in solid or self._ends[f] in solid
            )

    def _joined(
        self, data: mujoco.MjData, pressing: frozenset[int], touching: frozenset[int]
    ) -> frozenset[int]:
        """Returns the parts that are solid in the next step."""
        # A finger that begins to touch, or that is lifted, becomes a ghost first: it may be inside
        # the object that it held, or about to enter an object.
        anew = touching ^ self._touching
        solid = {
            part
            for f in self._links
            if f not in anew and (f in pressing or f not in touching)
            for part in (*self._links[f], self._ends[f])
            if part in self._solid
        }
        solid.update(part for part in self._palm if part in self._solid)
        missing = {part for part in self._palm if part not in solid}
        for f in self._links:
            if f in pressing or f not in touching:
                missing.update(part for part in self._links[f] if part not in solid)
            if f in pressing and self._links[f][-1] not in solid:
                solid.add(self._ends[f])
        if not missing:
            self._complete = pressing, touching
            return frozenset(solid)
        parts, distances, _ = self._distances.near(data)
        blocked = {p for p, far in zip(parts, distances, strict=True) if far < CLEARANCE}
        for f in self._links:
            last, end = self._links[f][-1], self._ends[f]
            if f not in pressing and end in blocked:
                # The whole last link of a finger that does not touch must be clear.
                blocked.add(last)
        joining = missing - blocked
        if joining:
            solid |= joining - self._inside(data)
        for f in self._links:
            if self._links[f][-1] in solid and self._ends[f] != self._links[f][-1]:
                # The whole link replaces its end.
                solid.discard(self._ends[f])
        return frozenset(solid)

    def _inside(self, data: mujoco.MjData) -> frozenset[int]:
        """Returns the parts that are inside objects, including those that MuJoCo reports as clear.

        MuJoCo reports a capsule as clear of a box if its axis passes through the whole box.
        """
        middles, radii = self.balls(data)
        far = (self._scene.clearance(data, middles) - radii).reshape(len(_ALONG), -1).min(axis=0)
        return frozenset(part for part, d in zip(self._parts, far, strict=True) if d < -INSIDE)
