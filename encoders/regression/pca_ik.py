"""PCA-IK: inverse kinematics in few principal components, the paper's baseline for its encoder.

Chung, Kim, Han and Pollard (2015), section 3, after Mulatto, Formaglio, Malvezzi and Prattichizzo
(2013). The paper gives it one paragraph: the number of components follows from the number of
contacts (12, 9, 6 and 3 for 5, 4, 3 and 2, hence 3 k - 3), the compliance is 0.1 for translation
and 25 for rotation, 100 iterations suffice, and the nearest neighbour is found by touch positions.
Choices that it leaves open are options here; the defaults follow the interpretations argued below.

Free variables. k fingertips give 3 k equations. With 3 k - 3 components, three unknowns are left:
the translation of the root. All rotations, including the wrist's, are then in the components. This
agrees with the paper's use of "hand pose" for joint angles and wrist together, and with the number
of equations that remain when positions are relative to one contact. Other interpretations:
components of the ball joints alone with a free root, as in inverse kinematics of a free-floating
hand (3 more unknowns than equations); or components of the whole pose and nothing else (3 fewer, so
that fingertips miss).

Compliance. As damping, each step minimises

    |tips still off|^2 + 0.1 |change of translations|^2 + 25 |change of rotations|^2

in centimetres and radians. Damping acts on the step, not on the distance from the start, so that
fingertips do reach their touches in the end ("tries to fit the target position excessively"). In
these units 100 iterations come close to the target; in metres and radians, or in centimetres and
degrees, rotations would hardly have changed by then, and the paper found 100 to be enough. As
softness, the mechanical meaning (a more compliant part moves more), the costs are 1 / 0.1 and
1 / 25 instead. For other units, give other numbers.

Start. The paper uses the nearest neighbour to label the fingers; here inverse kinematics starts
from it as well. The components are then directions in which that pose changes. Alternatively, the
neighbour is first projected onto the components ("represent hand pose"), or the mean pose is the
start.

A single contact has no components (3 k - 3 = 0): the mean pose of the training frames for that
finger is shifted, or with a free root also rotated, until the fingertip is at its target. The paper
excludes this case.
"""

from __future__ import annotations

from math import fsum
from typing import Any

import numpy as np

from encoders.regression.touch_ik import TouchIkEncoder
from models.arithmetic import (
    Array,
    Mask,
    eigen,
    matrix_product,
    matrix_vector,
    solve_positive,
    times_transposed,
    transposed_times,
    vector_matrix,
)
from models.errors import EncoderError
from models.frames import FINGERS
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION
from models.skeleton import ADULT, Skeleton

COMPLIANCE_TRANSLATION = 0.1
COMPLIANCE_ROTATION = 25.0
"""The paper's two values."""

FREE = {"translation": (3, slice(3, POSE_SIZE)), "root": (6, JOINTS), "nothing": (0, slice(0, 48))}
"""Option `free` -> number of free variables of the root, and the part of the pose that the
components describe."""

READINGS = ("damping", "softness")
STARTS = ("neighbour", "projected", "mean")

_SQUARE_CM = 1e-4
"""m2; the costs of steps are in square centimetres."""

_DEGREES_PER_RADIAN = 57.29577951308232
_WHISPER = 1e-10
"""Share of the mean diagonal added to normal equations, so that they are never singular."""


def step_costs(translation: float, rotation: float, reading: str) -> Array:
    """Costs (48,) of changing each number of the pose, m2 per m2 or rad2, from two compliances.

    Raises:
        EncoderError: A compliance is negative, or 0 where it would be divided by, or there is no
            such interpretation.
    """
    if reading not in READINGS:
        raise EncoderError("no such reading", got=reading, expected=", ".join(READINGS))
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


class PcaIkEncoder(TouchIkEncoder):
    """Inverse kinematics in principal components of the training poses.

    `fit(U, Q)` learns from contact vectors (T, 15) and relative poses (T, 48); `predict(U)` gives
    relative poses. The module's docstring explains the options.

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
        settled: See `TouchIkEncoder`.
        pad_height: See `TouchIkEncoder`.

    Attributes:
        components_: (48, n) principal directions of the training poses, in order of variance;
            orthonormal in centimetres and degrees.
        explained_: (n,) share of the variance in the first 1, 2, .. n of them.
        mean_: See `TouchIkEncoder`.
        pad_height_: See `TouchIkEncoder`.
        tip_misfit_: See `TouchIkEncoder`.
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
        super().__init__(skeleton, iterations, settled, pad_height)
        self.compliance_translation = compliance_translation
        self.compliance_rotation = compliance_rotation
        self.reading = reading
        self.free = free
        self.start = start
        self.components = components

    def configuration(self) -> dict[str, Any]:
        """See `Encoder.configuration`."""
        return {
            **super().configuration(),
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
        """Directions (48, m) in which the pose may change: free variables, then the components."""
        root, _ = FREE[self.free]
        used = self.components_[:, : self.n_components(contacts)]
        return np.concatenate([np.eye(POSE_SIZE)[:, :root], used], axis=1)

    def _learn(self, Q: Array) -> None:
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

    def _step(self, q: Array, start: Array, off: Array, J: Array) -> Array:
        basis, cost = self._ways[off.shape[1] // 3]
        if not basis.shape[1]:
            return np.zeros_like(q)
        # Pose by pose: side by side with others, each takes the step that it takes alone.
        step = np.empty_like(q)
        for i, (far, jacobian) in enumerate(zip(off, J, strict=True)):
            JB = matrix_product(jacobian, basis)
            normal = transposed_times(JB, JB)
            normal += cost
            diagonal = normal.reshape(-1)[:: len(cost) + 1]
            diagonal += _WHISPER * fsum(diagonal.tolist()) / len(cost)
            step[i] = matrix_vector(basis, solve_positive(normal, vector_matrix(far, JB)))
        return step

    def _check_options(self) -> None:
        super()._check_options()
        step_costs(self.compliance_translation, self.compliance_rotation, self.reading)
        if self.free not in FREE:
            raise EncoderError("no such freedom", got=self.free, expected=", ".join(FREE))
        if self.start not in STARTS:
            raise EncoderError("no such start", got=self.start, expected=", ".join(STARTS))
        if self.components is not None and self.components < 0:
            raise EncoderError("the number of components is out of range", got=self.components)
