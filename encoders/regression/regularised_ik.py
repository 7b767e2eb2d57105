"""Inverse kinematics with a will of its own: two fair rivals beside the paper's PCA-IK.

Touches fix 3 k of a pose's 48 numbers. PCA-IK decides the rest by leaving most of them out. Here
all 48 move, and what the touches leave open goes towards a desired pose: in the null space of the
fingertips' Jacobian, which the paper of 2015 names as the comparison to make next, or as far as
the training poses' covariance says that it should.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from encoders.regression.pca_ik import COMPLIANCE_ROTATION, COMPLIANCE_TRANSLATION, step_costs
from encoders.regression.touch_ik import TouchIkEncoder
from models.arithmetic.arrays import Array, Mask
from models.errors import EncoderError
from models.skeleton import ADULT, Skeleton

DESIRED = ("mean", "neighbour")

_LEAST_SIGMA = 1e-6
"""m; training poses without any misfit would leave nothing to divide by."""

_FLOOR = 1e-12
"""m2 per m2 and rad2; least cost of a step, so that costs of 0 can still be divided by."""


def leaving_tips(wish: Array, J: Array, cost: Array) -> Array:
    """Wished changes of pose (n, 48) less what would move the fingertips: their null-space part.

    Args:
        wish: (n, 48).
        J: (n, 3 k, 48) derivative of the fingertips.
        cost: (48,) of changing each number, above 0; what is taken away costs least.
    """
    back = np.swapaxes(J / cost, 1, 2)
    moved = np.linalg.solve(J @ back, J @ wish[..., None])
    return wish - (back @ moved)[..., 0]


class NullSpaceIkEncoder(TouchIkEncoder):
    """Fingertips go to their touches, the rest of the pose to a desired one in their null space.

    A step is the damped one of PCA-IK, in all 48 numbers rather than in components, plus the way to
    the desired pose projected into the null space of the fingertips' Jacobian. In 3 k - 3
    components there is nothing to project into: with the root's translation they are as many
    unknowns as equations. Steps begin at the desired pose.

    Args:
        skeleton: Whose fingertips are to meet the touches.
        iterations: Most steps.
        desired: `neighbour` (the training frame with the nearest touches) or `mean`.
        compliance_translation: As in PCA-IK read as damping; also the metric of the projection.
        compliance_rotation: Likewise.
        gain: Share of the way to the desired pose that one step takes.
        settled: See `TouchIkEncoder`.
        pad_height: See `TouchIkEncoder`.
    """

    paced = True

    def __init__(
        self,
        skeleton: Skeleton = ADULT,
        iterations: int = 100,
        desired: str = "mean",
        compliance_translation: float = COMPLIANCE_TRANSLATION,
        compliance_rotation: float = COMPLIANCE_ROTATION,
        gain: float = 1.0,
        settled: float = 1e-9,
        pad_height: float | None = None,
    ) -> None:
        super().__init__(skeleton, iterations, settled, pad_height)
        self.desired = desired
        self.compliance_translation = compliance_translation
        self.compliance_rotation = compliance_rotation
        self.gain = gain

    def configuration(self) -> dict[str, Any]:
        """See `Encoder.configuration`."""
        return {
            **super().configuration(),
            "desired": self.desired,
            "compliance_translation": self.compliance_translation,
            "compliance_rotation": self.compliance_rotation,
            "gain": self.gain,
        }

    def _learn(self, Q: Array) -> None:
        cost = step_costs(self.compliance_translation, self.compliance_rotation, "damping")
        self._cost = np.maximum(cost, _FLOOR)

    def _start(self, fingers: Mask, places: Array) -> Array:
        if self.desired == "mean":
            return np.tile(self.mean_, (len(places), 1))
        return self._neighbours.nearest(fingers, places)

    def _step(self, q: Array, start: Array, off: Array, J: Array) -> Array:
        back = np.swapaxes(J / self._cost, 1, 2)
        damped = J @ back + np.eye(J.shape[1])
        to_tips = (back @ np.linalg.solve(damped, off[..., None]))[..., 0]
        return to_tips + leaving_tips(self.gain * (start - q), J, self._cost)

    def _check_options(self) -> None:
        super()._check_options()
        step_costs(self.compliance_translation, self.compliance_rotation, "damping")
        if self.desired not in DESIRED:
            raise EncoderError("no such desired pose", got=self.desired, expected=str(DESIRED))
        if not 0 <= self.gain <= 1:
            raise EncoderError("no such gain", got=self.gain, expected="0 to 1")


class MapIkEncoder(TouchIkEncoder):
    """The likeliest pose for fingertips at their touches, were poses normally distributed.

    The prior is the mean and the full covariance of the training poses, the touches are
    measurements of the fingertips; Gauss-Newton steps of this Kalman-like update find the most
    probable pose. Where a simulated subject draws its poses from a normal distribution and has the
    skeleton used here, this encoder is given the answer's form: say so beside its errors.

    Args:
        skeleton: Whose fingertips are to meet the touches.
        iterations: Most steps; a handful is enough, the others find nothing left to do.
        tip_sigma: m per coordinate, how far a fingertip may be from its target; None takes what
            the training poses show (`tip_misfit_`).
        settled: See `TouchIkEncoder`.
        pad_height: See `TouchIkEncoder`.

    Attributes:
        covariance_: (48, 48) of the training poses, m and rad.
        mean_, pad_height_, tip_misfit_: See `TouchIkEncoder`.
    """

    paced = True

    def __init__(
        self,
        skeleton: Skeleton = ADULT,
        iterations: int = 100,
        tip_sigma: float | None = None,
        settled: float = 1e-9,
        pad_height: float | None = None,
    ) -> None:
        super().__init__(skeleton, iterations, settled, pad_height)
        self.tip_sigma = tip_sigma

    def configuration(self) -> dict[str, Any]:
        """See `Encoder.configuration`."""
        return {**super().configuration(), "tip_sigma": self.tip_sigma}

    def _learn(self, Q: Array) -> None:
        away = Q - self.mean_
        self.covariance_ = away.T @ away / len(Q)
        sigma = self.tip_misfit_ if self.tip_sigma is None else self.tip_sigma
        self._sigma = max(sigma, _LEAST_SIGMA)

    def _start(self, fingers: Mask, places: Array) -> Array:
        return np.tile(self.mean_, (len(places), 1))

    def _step(self, q: Array, start: Array, off: Array, J: Array) -> Array:
        JC = J @ self.covariance_
        S = JC @ np.swapaxes(J, 1, 2) + self._sigma**2 * np.eye(J.shape[1])
        innovation = off + (J @ (q - start)[..., None])[..., 0]
        weights = np.linalg.solve(S, innovation[..., None])
        return start + (np.swapaxes(JC, 1, 2) @ weights)[..., 0] - q

    def _check_options(self) -> None:
        super()._check_options()
        if self.tip_sigma is not None and not 0 < self.tip_sigma < np.inf:
            raise EncoderError("the tip sigma must be above 0", got=self.tip_sigma)
