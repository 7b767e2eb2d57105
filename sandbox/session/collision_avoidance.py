"""Collision avoidance of a hand that is solid all over: how it keeps clear of objects.

The touches decide where the touching fingertips are; all else of a hand may be anywhere plausible.
The encoder's pose is taken as a guess, and of the poses that keep the fingertips and are clear of
objects `CollisionAvoidance` commands the likeliest. Without an object near, that is the encoder's.

Likely is what is near the encoder's pose, and near the pose before: where no pose is clear, what
leads the hand changes from step to step, and without the second the hand would tremble. As the
correction may go on from where it is, it ends where it would without.

`HandDistances` measures how far the parts of the hand are from objects, by MuJoCo's collision
detection in a copy of the scene, in which the hand is always there and never pushes anything.

`SolidLinks` makes every part solid by itself, once the touching fingertips are solid and the part
is clear of objects: a part that became solid inside an object would throw it.
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


class CollisionAvoidance:
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
        self._kinematics: dict[tuple[int, ...], SinglePose] = {}
        # Of the hand's joint positions those of the palm and of touching fingers, and where they
        # are in the scene's.
        self._held: dict[tuple[int, ...], tuple[NDArray[np.int64], NDArray[np.int64]]] = {}
        self._start = int(scene.qpos_slice(hand).start)
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
        """The next correction on the way to the wanted one; None is none."""
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
        """The likeliest correction (48,) at which the hand is clear; None without one."""
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
            # What presses is held back: the palm and touching fingers are seen where they are.
            held, there = self._held[fingers]
            qpos[held] = data.qpos.take(there)
        else:
            # The hand is seen where it will be once it is down.
            qpos[ROOT_POSITION] += self._landing(reconstruction, fingers, at)
        velocity = self._velocity(reconstruction, fingers, at)
        near = self._distances.near(data, qpos)
        rows, lacking = self._lacking(near, fingers)
        parts = [near.parts[row] for row in rows]
        rows_ahead: list[int] = []
        speed = length(velocity)
        if speed > SLOW:
            # Where everything goes.
            ahead = min(AHEAD, FAR / speed)
            qpos[ROOT_POSITION] += ahead * velocity
            near = self._distances.near(data, qpos, ahead)
            rows_ahead, more = self._lacking(near, fingers)
            parts += [near.parts[row] for row in rows_ahead]
            lacking += more
        if not lacking or (offset is None and max(lacking) <= 0.0):
            return None
        # Of q, which was placed last.
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
        """(3,) m/s of the commanded fingertips of a hand that is down."""
        middle: Array = np.add.reduce(at, 0) / len(at)
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
        high = float(np.add.reduce(heights, None)) / len(fingers) - reconstruction.tip_height
        return -high * self._up

    def _lacking(self, near: Near, fingers: tuple[int, ...]) -> tuple[list[int], list[float]]:
        """Contacts that matter, and how much of their margin each lacks, m; negative beyond it."""
        ends, inner = self._touching(fingers)
        parts, distances, geoms = near
        # How far each touching fingertip is from each object.
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

    parts: Sequence[int]
    distances: Sequence[float]
    things: Sequence[int]


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
        # Where everything is, and where it goes.
        self._now, self._ahead = mujoco.MjData(model), mujoco.MjData(model)
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
        # MuJoCo orders two geoms by their kind.
        pairs = [(a, b) if a in mine else (b, a) for a, b in contact.geom.tolist()]
        parts, things = zip(*pairs, strict=True)
        return Near(parts, contact.dist.tolist(), things)

    def gradients(self, rows: list[int], ahead: bool = False) -> Array:
        """Derivatives (k, dofs) of some of the distances that `near` returned last, by the hand's
        velocities.

        Args:
            rows: Indices (k,) into them.
            ahead: Of those that were returned for things that go on.
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
    # The capsule's axis is its own z, and its body's y.
    half: float = model.geom_size[geom, 1]
    middle: NDArray[np.float64] = model.geom_pos[geom]
    model.geom_pos[geom] = share * middle
    # MuJoCo takes a geom with the frame of its body's inertia to be there, wherever its own place.
    model.geom_sameframe[geom] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
    model.geom_size[geom, 1] = max(share * half, 1e-6)


CLEARANCE = 0.0005
"""m, least distance of a part from things when it becomes solid."""

INSIDE = 0.0015
"""m, depth in a thing, by the thing's own distances, at which a part does not become solid."""

_ALONG = np.linspace(-1.0, 1.0, 9)
"""Shares of half a capsule's length, from its middle, at which a ball covers it."""


class SolidLinks:
    """Decides step by step which parts of one hand are solid.

    Args:
        scene: The scene.
        hand: Index of the hand.
        distances: Distances of its parts.

    Attributes:
        fingers: Labels of the fingers whose last link is solid, whether they touch or not.
        signature: Which parts are solid: state outside MuJoCo's that affects the next step.
    """

    def __init__(self, scene: Scene, hand: int, distances: HandDistances) -> None:
        self._scene, self._hand, self._distances = scene, hand, distances
        links, geom = scene.spec.hands[hand].links, scene.model.geom
        self._parts = tuple(scene.parts(hand))
        # Of each finger: its links from the palm outwards, and the solid end of the last.
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
        # Pressing and touching fingers with which all parts are solid that may be; None before.
        self._complete: tuple[frozenset[int], frozenset[int]] | None = None
        self.signature = self._mask()

    def _mask(self) -> bytes:
        mask = sum(1 << i for i, part in enumerate(self._parts) if part in self._solid)
        return mask.to_bytes((len(self._parts) + 7) // 8, "little")

    def balls(self, data: mujoco.MjData) -> tuple[Array, Array]:
        """Middles (n, 3) and radii (n,), m, of balls along all parts, which are capsules."""
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
            pressing: Fingers whose tips are solid and touch; none makes the hand a ghost.
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
        """The parts that are solid next."""
        # A finger that begins to touch or is lifted begins anew: it may be inside of what it
        # held, or on its way into something.
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
                # The whole last link of a finger that does not touch must be out.
                blocked.add(last)
        joining = missing - blocked
        if joining:
            solid |= joining - self._inside(data)
        for f in self._links:
            if self._links[f][-1] in solid and self._ends[f] != self._links[f][-1]:
                # The whole link takes the place of its end.
                solid.discard(self._ends[f])
        return frozenset(solid)

    def _inside(self, data: mujoco.MjData) -> frozenset[int]:
        """Parts that are inside of things, whatever MuJoCo says.

        It takes a capsule for clear of a box that its axis goes right through.
        """
        middles, radii = self.balls(data)
        far = (self._scene.clearance(data, middles) - radii).reshape(len(_ALONG), -1).min(axis=0)
        return frozenset(part for part, d in zip(self._parts, far, strict=True) if d < -INSIDE)
