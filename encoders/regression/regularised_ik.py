"""Regularised inverse kinematics: two further baselines beside the paper's PCA-IK.

Touches determine 3 k of a pose's 48 numbers. PCA-IK restricts the others to few components. Here
all 48 may change, and the undetermined part moves towards a desired pose: in the null space of the
fingertips' Jacobian, which the paper of 2015 suggests as a further comparison, or by the covariance
of the training poses.
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
"""m, lower bound that avoids a division by zero for training poses without misfit."""

_FLOOR = 1e-12
"""m2 per m2 and rad2, lower bound of a step's cost, which avoids a division by zero."""


def null_space_part(wish: Array, J: Array, cost: Array) -> Array:
    """Null-space part (n, 48) of wished changes of pose, which does not move the fingertips.

    Args:
        wish: (n, 48) wished changes.
        J: (n, 3 k, 48) derivative of the fingertips.
        cost: (48,) positive cost of changing each number; the removed part has the least cost.
    """
    back = np.swapaxes(J / cost, 1, 2)
    moved = np.linalg.solve(J @ back, J @ wish[..., None])
    return wish - (back @ moved)[..., 0]


class NullSpaceIkEncoder(TouchIkEncoder):
    """Inverse kinematics of the fingertips, with a desired pose in the null space.

    A step is the damped step of PCA-IK, in all 48 numbers rather than in components, plus the
    difference to the desired pose projected into the null space of the fingertips' Jacobian. (With
    3 k - 3 components and the root's translation there are as many unknowns as equations, so that
    no null space exists.) Steps begin at the desired pose.

    Args:
        skeleton: Skeleton whose fingertips should meet the touches.
        iterations: Maximum number of steps.
        desired: `neighbour` (the training frame with the nearest touches) or `mean`.
        compliance_translation: See `PcaIkEncoder`, as damping; also the metric of the projection.
        compliance_rotation: Likewise, for rotations.
        gain: Share of the difference to the desired pose that one step makes.
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
        return to_tips + null_space_part(self.gain * (start - q), J, self._cost)

    def _check_options(self) -> None:
        super()._check_options()
        step_costs(self.compliance_translation, self.compliance_rotation, "damping")
        if self.desired not in DESIRED:
            raise EncoderError("no such desired pose", got=self.desired, expected=str(DESIRED))
        if not 0 <= self.gain <= 1:
            raise EncoderError("the gain is out of range", got=self.gain, expected="0 to 1")


class MapIkEncoder(TouchIkEncoder):
    """Maximum a posteriori pose with a normal prior over poses.

    The prior has the mean and the full covariance of the training poses, and the touches are
    measurements of the fingertips; Gauss-Newton steps of this Kalman-like update find the most
    probable pose. On a simulated subject that draws its poses from a normal distribution and has
    this skeleton, the model is exactly right, which must be stated beside its errors.

    Args:
        skeleton: Skeleton whose fingertips should meet the touches.
        iterations: Maximum number of steps; a handful is enough.
        tip_sigma: m per coordinate, standard deviation of a fingertip about its target; None uses
            that of the training poses (`tip_misfit_`).
        settled: See `TouchIkEncoder`.
        pad_height: See `TouchIkEncoder`.

    Attributes:
        covariance_: (48, 48) covariance of the training poses, m and rad.
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
