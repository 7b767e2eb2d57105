"""PCA-IK: inverse kinematics in few principal components, the paper's baseline for its encoder.

Chung, Kim, Han and Pollard (2015), section 3, after Mulatto, Formaglio, Malvezzi and Prattichizzo
(2013). The paper describes the method in one paragraph. The number of components follows from the
number k of contacts: 12, 9, 6 and 3 for 5, 4, 3 and 2 contacts, hence 3 k - 3. The compliance is
0.1 for translation and 25 for rotation. 100 iterations suffice, and the nearest neighbour is found
by touch positions. Choices that the paper leaves open are options here. The defaults follow the
interpretations below.

Free variables. k fingertips give 3 k equations. With 3 k - 3 components, three unknowns are left:
the translation of the root. All rotations, including the wrist's, are then in the components. This
agrees with the paper's use of "hand pose" for joint angles and wrist together, and with the number
of equations that remain when positions are relative to one contact. There are two other
interpretations. With components of the ball joints alone and a free root, as in inverse kinematics
of a free-floating hand, there are 3 more unknowns than equations. With components of the whole pose
and no free variables, there are 3 fewer, so fingertips miss their targets.

Compliance. As damping, each step minimises

    |tips still off|^2 + 0.1 |change of translations|^2 + 25 |change of rotations|^2

in centimetres and radians. Damping acts on the step, not on the distance from the start, so that
fingertips reach their touches in the end ("tries to fit the target position excessively"). In these
units, 100 iterations come close to the target, as the paper found. In metres and radians, or in
centimetres and degrees, 100 iterations would hardly change the rotations. The mechanical meaning of
compliance is softness: a more compliant part moves more. The costs are then 1 / 0.1 and 1 / 25.

Start. The paper uses the nearest neighbour to label the fingers. Here inverse kinematics starts
from the neighbour's pose as well, and the components are directions in which this pose changes.
Alternatively, the neighbour is first projected onto the components ("represent hand pose"), or the
mean pose is the start.

For a single contact there are no components (3 k - 3 = 0). The mean pose of the training frames for
that finger is shifted, or with a free root also rotated, until the fingertip is at its target. The
paper excludes this case.

Rows with the same touching fingers have equations of the same shape and are processed together. The
nearest neighbour is the training frame with the most similar touches: frames are compared by the
positions of their touches, not by poses. Only frames with the same touching fingers can be
compared. If there are none, this implementation uses frames in which other fingers touch as well.
"""

from __future__ import annotations

from math import fsum
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.encoder import Encoder
from encoders.input_vector import CONTACT_VECTOR_SIZE, contact_vectors
from models.arithmetic import (
    Array,
    Mask,
    eigen,
    matrix_product,
    matrix_vector,
    solve_positive,
    squared_lengths,
    times_transposed,
    transposed_times,
    vector_matrix,
)
from models.errors import EncoderError
from models.frames import FINGERS
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, relative_pose
from models.single_pose import SinglePose, tips_and_jacobians
from models.skeleton import ADULT, Skeleton
from models.surface import METRES_PER_INCH

_CHUNK = 256
"""Number of rows solved together; their Jacobians (1.5 MB) stay in the processor's cache."""

_LARGEST_TURN = 0.5
"""Largest rotation (rad) of a joint in one step; a larger step is scaled down. The Jacobian is not
valid for larger rotations, and weakly damped steps would make the hand tumble."""


class IkSolution(NamedTuple):
    """Solved poses with residuals and numbers of steps."""

    q: Array
    """(T, 48) relative poses."""
    residual: Array
    """(T,) m, largest distance between a touching fingertip and its target."""
    iterations: NDArray[np.int64]
    """(T,) steps taken."""


COMPLIANCE_TRANSLATION = 0.1
COMPLIANCE_ROTATION = 25.0
"""The paper's two compliances, for translation and rotation."""

FREE = {"translation": (3, slice(3, POSE_SIZE)), "root": (6, JOINTS), "nothing": (0, slice(0, 48))}
"""Option `free` -> number of free variables of the root, and slice of the pose that the components
describe."""

READINGS = ("damping", "softness")
STARTS = ("neighbour", "projected", "mean")

_SQUARE_CM = 1e-4
"""Square centimetre (m2), the unit of the costs of steps."""

_DEGREES_PER_RADIAN = 57.29577951308232
_WHISPER = 1e-10
"""Share of the mean diagonal that is added to normal equations, so that they are never singular."""


def step_costs(translation: float, rotation: float, reading: str) -> Array:
    """Costs (48,) of changing each number of the pose, m2 per m2 or rad2, from two compliances.

    Args:
        translation: Compliance of translation.
        rotation: Compliance of rotation.
        reading: Meaning of compliance, one of `READINGS`.

    Raises:
        EncoderError: A compliance is negative, or 0 for softness, or there is no such reading.
    """
    if reading not in READINGS:
        raise EncoderError(
            "no such meaning of compliance",
            where="reading",
            got=reading,
            expected=", ".join(READINGS),
        )
    pair = np.array([translation, rotation], float)
    if not (np.isfinite(pair).all() and (pair >= 0).all()):
        raise EncoderError("compliances must be finite, 0 or more", got=pair.tolist())
    if reading == "softness":
        if not pair.all():
            raise EncoderError("compliances must be above 0 for softness", got=pair.tolist())
        pair = 1.0 / pair
    cost = np.full(POSE_SIZE, pair[1] * _SQUARE_CM)
    # Both sides are in centimetres, so the factors cancel.
    cost[ROOT_POSITION] = pair[0]
    return cost


class PcaIkEncoder(Encoder):
    """Inverse kinematics in principal components of the training poses.

    `fit(U, Q)` learns from contact vectors (T, 15) and relative poses (T, 48); `predict(U)` gives
    relative poses. The module's docstring explains the options. The target of a touching
    fingertip's centre is (x, -y, pad height): over its touch, in the 3-D surface frame with the
    leftmost contact as its origin. Joint ranges are not enforced.

    Args:
        skeleton: Skeleton whose fingertips should meet the touches.
        iterations: Maximum number of steps; 100 as in the paper.
        compliance_translation: Compliance of the root's translation, cm2 per cm2.
        compliance_rotation: Compliance of each rotation-vector component, cm2 per rad2.
        reading: Meaning of compliance, `damping` or `softness`.
        free: Free variables besides the components: `translation`, `root` (translation and
            rotation) or `nothing`.
        start: Start of the steps: `neighbour`, `projected` (the neighbour projected onto the
            components) or `mean`.
        components: Number of components; None uses 3 k - 3 for k contacts.
        settled: A row stops after a step that changes no number of the pose by more than this value
            (m and rad). 0 always takes all steps.
        pad_height: Height (m) of the centre of a touching fingertip above the surface; None
            estimates it.

    Attributes:
        components_: (48, n) principal directions of the training poses, in order of variance;
            orthonormal in centimetres and degrees.
        explained_: (n,) share of the variance that the first 1, 2, .. n components explain.
        mean_: (48,) mean training pose.
        pad_height_: Height (m), the given value or the median over the touching fingertips of the
            training poses.
        tip_misfit_: Root mean square (m), per coordinate, of the offsets of the touching fingertips
            of the training poses from their targets. Causes are noise, rolling fingertips and
            errors of the skeleton's bones.
    """

    def __init__(
        self,
        skeleton: Skeleton = ADULT,
        iterations: int = 100,
        compliance_translation: float = COMPLIANCE_TRANSLATION,
        compliance_rotation: float = COMPLIANCE_ROTATION,
        reading: str = "damping",
        free: str = "translation",
        start: str = "neighbour",
        components: int | None = None,
        settled: float = 1e-9,
        pad_height: float | None = None,
    ) -> None:
        self.skeleton = skeleton
        self.iterations = iterations
        self.settled = settled
        self.pad_height = pad_height
        self.compliance_translation = compliance_translation
        self.compliance_rotation = compliance_rotation
        self.reading = reading
        self.free = free
        self.start = start
        self.components = components
        self.mean_: Array
        self._learned = False

    def fit(self, U: ArrayLike, Q: ArrayLike) -> Self:
        """Learns from contact vectors U (T, 15) and relative poses Q (T, 48).

        Raises:
            EncoderError: Wrong widths, values that are not finite, rows without contact, or an
                option out of its range.
        """
        self._check_options()
        Q = np.asarray(Q, float)
        down, places = touches_of(U)
        if Q.ndim != 2 or Q.shape[1] != POSE_SIZE or len(Q) != len(down) or not len(Q):
            raise EncoderError(
                "inputs and outputs do not have matching shapes",
                got=(np.shape(U), Q.shape),
                expected=f"(T, {CONTACT_VECTOR_SIZE}) and (T, {POSE_SIZE}), T at least 1",
            )
        if not np.isfinite(Q).all():
            raise EncoderError("poses must be finite")
        self._neighbours = TouchNeighbours(down, places, Q)
        hand = SinglePose(self.skeleton)
        tips = np.array([hand.tips(q) for q in Q])
        height = float(np.median(tips[down][:, 2])) if self.pad_height is None else self.pad_height
        misfit = (tips - _targets(places, height))[down]
        self.mean_ = Q.mean(axis=0)
        self.pad_height_, self.tip_misfit_ = height, float(np.sqrt(np.mean(misfit**2)))
        self._learn(Q)
        self._learned = True
        return self

    def predict(self, U: ArrayLike) -> Array:
        """Relative poses (T, 48) of contact vectors (T, 15), or (48,) of one contact vector (15,).

        Raises:
            EncoderError: See `solve`.
        """
        U = np.asarray(U, float)
        return self.solve(U[None]).q[0] if U.ndim == 1 else self.solve(U).q

    def solve(self, U: ArrayLike) -> IkSolution:
        """Solves for the poses of contact vectors (T, 15).

        Raises:
            EncoderError: The encoder is not fitted, or the contact vectors have a wrong width, a
                value that is not finite, a row without contact, or a set of fingers that needs a
                nearest neighbour and occurs in no training frame.
        """
        if not self._learned:
            raise EncoderError("the encoder has learned nothing yet", remedy="Call fit first")
        down, places = touches_of(U)
        targets = _targets(places, self.pad_height_)
        solution = IkSolution(
            np.empty((len(down), POSE_SIZE)), np.empty(len(down)), np.zeros(len(down), np.int64)
        )
        for fingers in np.unique(down, axis=0):
            rows = np.flatnonzero((down == fingers).all(axis=1))
            for first in range(0, len(rows), _CHUNK):
                some = rows[first : first + _CHUNK]
                start = self._start(fingers, places[some])
                partial = self._iterate(start, fingers, targets[some].compress(fingers, 1))
                for whole, part in zip(solution, partial, strict=True):
                    whole[some] = part
        return solution

    def configuration(self) -> dict[str, Any]:
        """See `Encoder.configuration`.

        Raises:
            EncoderError: The skeleton is not that of the built-in hand; other skeletons cannot be
                stored.
        """
        if self.skeleton is not ADULT:
            raise EncoderError(
                "inverse kinematics of another skeleton cannot be stored",
                got=self.skeleton.name,
                expected=ADULT.name,
            )
        return {
            "iterations": self.iterations,
            "settled": self.settled,
            "pad_height": self.pad_height,
            "compliance_translation": self.compliance_translation,
            "compliance_rotation": self.compliance_rotation,
            "reading": self.reading,
            "free": self.free,
            "start": self.start,
            "components": self.components,
        }

    def n_components(self, contacts: int) -> int:
        """Number of components for a number of contacts."""
        wanted = 3 * contacts - 3 if self.components is None else self.components
        return min(wanted, self.components_.shape[1])

    def basis(self, contacts: int) -> Array:
        """Directions (48, m) in which the pose may change: the free variables of the root, then the
        components."""
        root, _ = FREE[self.free]
        used = self.components_[:, : self.n_components(contacts)]
        return np.concatenate([np.eye(POSE_SIZE)[:, :root], used], axis=1)

    def _learn(self, Q: Array) -> None:
        """Learns the components of the training poses (T, 48)."""
        self._cost = step_costs(self.compliance_translation, self.compliance_rotation, self.reading)
        _, part = FREE[self.free]
        scale = np.full(POSE_SIZE, _DEGREES_PER_RADIAN)
        # Units matter only where lengths and angles are mixed; the paper reports these units.
        scale[ROOT_POSITION] = 100.0
        self._scale = scale[part]
        away = (Q - self.mean_)[:, part] * self._scale
        variance, directions = eigen(transposed_times(away, away))
        varies = variance > 1e-12 * max(variance[0], 1e-300)
        variance, directions = variance[varies], directions[:, varies]
        self.components_ = np.zeros((POSE_SIZE, len(variance)))
        self.components_[part] = directions / self._scale[:, None]
        self.explained_ = np.cumsum(variance) / max(float(variance.sum()), 1e-300)
        self._ways = [self._way(contacts) for contacts in range(len(FINGERS) + 1)]

    def _way(self, contacts: int) -> tuple[Array, Array]:
        """Directions (48, m) for a number of contacts, and the cost matrix (m, m) of steps along
        them."""
        basis = self.basis(contacts)
        return basis, transposed_times(basis, self._cost[:, None] * basis)

    def _start(self, fingers: Mask, places: Array) -> Array:
        """First poses (n, 48) for touches (n, 5, 2) of these fingers (5,)."""
        if self.start == "mean":
            return np.tile(self.mean_, (len(places), 1))
        pose = self._neighbours.nearest(fingers, places)
        if self.start == "projected":
            _, part = FREE[self.free]
            count = self.n_components(int(fingers.sum()))
            used = np.ascontiguousarray(self.components_[part, :count])
            away = (pose - self.mean_)[:, None, part] * self._scale**2
            shares = matrix_product(np.ascontiguousarray(away[:, 0]), used)
            pose[:, part] = self.mean_[part] + times_transposed(shares, used)
        return pose

    def _iterate(self, start: Array, fingers: Mask, targets: Array) -> IkSolution:
        """Iterates from poses (n, 48) to bring fingertips to their targets (n, k, 3) m."""
        hand = SinglePose(self.skeleton, np.flatnonzero(fingers).tolist())
        q = start.copy()
        taken = np.zeros(len(q), np.int64)
        # Rows that still move. At first all rows do, and a slice avoids copies.
        moving: slice | NDArray[np.int64] = slice(None)
        for _ in range(self.iterations):
            tips, jacobian = tips_and_jacobians(hand, q[moving])
            off = (targets[moving] - tips).reshape(len(tips), -1)
            J = jacobian.reshape(len(tips), -1, POSE_SIZE)
            step = self._step(off, J)
            turn = np.abs(step[:, 3:]).max(axis=1, keepdims=True)
            step *= np.minimum(1.0, _LARGEST_TURN / np.maximum(turn, _LARGEST_TURN))
            q[moving] += step
            taken[moving] += 1
            far = np.abs(step).max(axis=1) > self.settled
            if not far.any():
                break
            if not far.all():
                moving = np.arange(len(q))[moving][far]
        off = targets - np.array([hand.tips(row) for row in q])
        return IkSolution(q, np.sqrt(squared_lengths(off).max(axis=1)), taken)

    def _step(self, off: Array, J: Array) -> Array:
        """Change (n, 48) of poses, from the fingertips' offsets (n, 3 k) m from their targets and
        their derivative J (n, 3 k, 48)."""
        basis, cost = self._ways[off.shape[1] // 3]
        if not basis.shape[1]:
            return np.zeros((len(off), POSE_SIZE))
        # Each pose is solved separately, so that its step does not depend on the other poses.
        step = np.empty((len(off), POSE_SIZE))
        for i, (far, jacobian) in enumerate(zip(off, J, strict=True)):
            JB = matrix_product(jacobian, basis)
            normal = transposed_times(JB, JB)
            normal += cost
            diagonal = normal.reshape(-1)[:: len(cost) + 1]
            diagonal += _WHISPER * fsum(diagonal.tolist()) / len(cost)
            step[i] = matrix_vector(basis, solve_positive(normal, vector_matrix(far, JB)))
        return step

    def _check_options(self) -> None:
        if self.iterations < 0:
            raise EncoderError(
                "the number of iterations is out of range",
                got=self.iterations,
                expected="0 or more",
            )
        if not 0 <= self.settled < np.inf:
            raise EncoderError(
                "settled must be 0 or more", got=self.settled, expected="0 or more, finite"
            )
        if self.pad_height is not None and not np.isfinite(self.pad_height):
            raise EncoderError("the pad height must be finite", got=self.pad_height)
        step_costs(self.compliance_translation, self.compliance_rotation, self.reading)
        if self.free not in FREE:
            raise EncoderError(
                "no such free variables", where="free", got=self.free, expected=", ".join(FREE)
            )
        if self.start not in STARTS:
            raise EncoderError(
                "no such start", where="start", got=self.start, expected=", ".join(STARTS)
            )
        if self.components is not None and self.components < 0:
            raise EncoderError(
                "the number of components is out of range",
                got=self.components,
                expected="0 or more, or None",
            )


def _targets(places: Array, height: float) -> Array:
    """Targets (T, 5, 3) m of the fingertips' centres for touches (T, 5, 2)."""
    depth = np.full((*places.shape[:-1], 1), height)
    return np.concatenate([places[..., :1], -places[..., 1:], depth], axis=-1)


_PLACES = 2 * len(FINGERS)


def touches_of(U: ArrayLike) -> tuple[Mask, Array]:
    """Masks (T, 5) and positions (T, 5, 2) of the touching fingers of contact vectors (T, 15).

    Positions are in metres relative to the leftmost contact, x right and y down, NaN where a finger
    is lifted. The leftmost contact is determined again, so that a common shift of a row has no
    effect.

    Raises:
        EncoderError: Wrong width, a value that is not finite, a flag that is neither 0 nor 1, or a
            row without any contact.
    """
    U = np.asarray(U, float)
    if U.ndim != 2 or U.shape[1] != CONTACT_VECTOR_SIZE:
        raise EncoderError(
            "wrong number of inputs", got=U.shape, expected=f"contact vectors {CONTACT_VECTOR_SIZE}"
        )
    if not np.isfinite(U).all():
        raise EncoderError("contact vectors must be finite", where=_first_row(~np.isfinite(U)))
    flags = U[:, _PLACES:]
    odd = (flags != 0.0) & (flags != 1.0)
    if odd.any():
        raise EncoderError(
            "a contact flag is neither 0 nor 1", where=_first_row(odd), got=float(flags[odd][0])
        )
    down = flags == 1.0
    if not down.any(axis=1).all():
        raise EncoderError(
            "a contact vector has no contact",
            where=_first_row(~down.any(axis=1, keepdims=True)),
            expected="1 to 5 fingers down",
        )
    places = U[:, :_PLACES].reshape(-1, len(FINGERS), 2) * METRES_PER_INCH
    places = np.where(down[..., None], places, np.nan)
    if not len(places):
        return down, places
    return down, places - contact_vectors(places)[1][:, None, :]


def finger_names(fingers: Mask) -> str:
    """Names of the fingers of a mask (5,), such as 'thumb, index'."""
    return ", ".join(name for name, down in zip(FINGERS, fingers, strict=True) if down)


class TouchNeighbours:
    """Training frames, grouped by the set of their touching fingers.

    The frames for a set are those with exactly these fingers down. If there are none, frames in
    which at least these fingers touch are used, with touches and pose relative to the leftmost of
    these fingers.

    Args:
        down: (T, 5) mask of touching fingers.
        places: (T, 5, 2) m relative to the leftmost contact, as `touches_of` gives them.
        Q: (T, 48) relative poses.
    """

    def __init__(self, down: Mask, places: Array, Q: Array) -> None:
        self._down, self._places, self._poses = down, places, Q
        self._frames: dict[bytes, tuple[Array, Array]] = {}

    def nearest(self, fingers: Mask, places: Array) -> Array:
        """Poses (n, 48) of the frames whose touches are nearest to given touches.

        The nearest frame has the least sum of squared distances over the touching fingers; of equal
        frames, the first is used. A single touch has no layout and is equally near to all frames:
        the result is then the mean pose of all comparable frames.

        Args:
            fingers: (5,) mask of touching fingers.
            places: (n, 5, 2) m relative to the leftmost contact.

        Raises:
            EncoderError: These fingers touch together in no training frame.
        """
        layouts, poses = self._comparable(fingers)
        if fingers.sum() == 1:
            return np.tile(poses.mean(axis=0), (len(places), 1))
        wanted = places[:, fingers].reshape(len(places), -1)
        # |a - b|^2 less |a|^2, which is the same for all frames.
        distance = squared_lengths(layouts) - 2.0 * times_transposed(wanted, layouts)
        nearest: Array = poses[np.argmin(distance, axis=1)]
        return nearest

    def _comparable(self, fingers: Mask) -> tuple[Array, Array]:
        """Layouts (F, 2 k) m and relative poses (F, 48) of the frames for a set of fingers."""
        key = fingers.tobytes()
        if key not in self._frames:
            rows = np.flatnonzero((self._down == fingers).all(axis=1))
            if not len(rows):
                rows = np.flatnonzero(self._down[:, fingers].all(axis=1))
            if not len(rows):
                raise EncoderError(
                    "no training frame has these fingers down together",
                    where=finger_names(fingers),
                    remedy="Add a take with these fingers to the capture",
                )
            kept = np.where(fingers[:, None], self._places[rows], np.nan)
            _, origin = contact_vectors(kept)
            layouts = (kept - origin[:, None, :])[:, fingers].reshape(len(rows), -1)
            self._frames[key] = layouts, relative_pose(self._poses[rows], origin)
        return self._frames[key]


def _first_row(wrong: Mask) -> str:
    return f"row {int(np.flatnonzero(wrong.any(axis=1))[0])}"
