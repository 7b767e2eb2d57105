"""Yaw-normalised encoder: quadratic encoding in a frame that turns with the hand.

A turned hand moves its fingers like a hand that is not turned. But a polynomial of touches in the
surface's frame must learn every direction separately, and approximates sines and cosines by
quadratics. Here a first quadratic predicts the hand's yaw, its rotation about the surface's normal.
The touches are rotated back by this yaw about their middle. A second quadratic predicts the pose in
the rotated frame, and the result is rotated forward again. A third quadratic repeats this with the
improved yaw. In the normalised frame there is less variation to learn, and directions with little
training data profit from other directions.

In the paper of 2015, the device was fixed in front of the person, and one quadratic was used. This
encoder is our own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import comb, cos, fsum, sin
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.encoder import Encoder
from encoders.input_vector import CONTACT_VECTOR_SIZE, LIFTED
from encoders.regression.polynomial import (
    FLAGS,
    PolynomialEncoder,
    QuadraticEncoder,
    collapse,
    is_ridge,
    stored_coefficients,
)
from models import arithmetic
from models.arithmetic import Array, stacked_applied, stacked_product, vector_matrix
from models.errors import EncoderError
from models.frames import FINGERS
from models.pose import POSE_SIZE, ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp, log, turn_about_normal, turned_about_normal
from models.surface import METRES_PER_INCH

SPREADS = (0.25, 0.15)
"""Standard deviations (rad) of the yaw error that is simulated in training, for each round (second
and third quadratic). They are similar to the errors of the yaw from the previous quadratic on
unseen trials: 0.22 and 0.18 rad root mean square, in five folds of the built-in capture."""

_COPIES = 3
"""Number of copies of every training frame, each with a different yaw error."""

_COEF = (comb(CONTACT_VECTOR_SIZE + 2, 2), POSE_SIZE)
"""Shape (136, 48) of one quadratic's coefficients."""

_UP = np.array([1.0, -1.0])
"""Factors that convert the surface's coordinates, with y down, to the pose's coordinates, with y
up."""


class YawNormalisedEncoder(Encoder):
    """Quadratic encoder in a frame that turns with the hand.

    Args:
        ridge: Penalty of the first quadratic; see `PolynomialEncoder`.
        turned_ridge: Penalty of the quadratics in the normalised frame.

    Attributes:
        coef_: (1 + rounds, 136, 48) coefficients of the quadratics, in order of use.
    """

    def __init__(self, ridge: float = 0.03, turned_ridge: float = 0.1) -> None:
        self.ridge, self.turned_ridge = ridge, turned_ridge
        self.coef_: Array
        self._learned = False

    def fit(self, U: ArrayLike, Q: ArrayLike) -> Self:
        """Learns from contact vectors (T, 15) and relative poses (T, 48).

        Equal inputs give equal encoders: the yaw errors come from a fixed seed.

        Raises:
            EncoderError: Shapes or values are invalid.
        """
        U, Q = np.asarray(U, float), np.asarray(Q, float)
        widths = (U.shape[-1:], Q.shape[-1:])
        if widths != ((CONTACT_VECTOR_SIZE,), (POSE_SIZE,)):
            raise EncoderError(
                "this encoder needs contact vectors and poses",
                got=(U.shape, Q.shape),
                expected=f"(T, {CONTACT_VECTOR_SIZE}) and (T, {POSE_SIZE})",
            )
        stages: list[PolynomialEncoder] = [QuadraticEncoder(self.ridge).fit(U, Q)]
        rng = np.random.default_rng(0)
        turn = yaw_of(Q)
        for spread in SPREADS:
            wrong = np.concatenate([turn + rng.normal(0, spread, len(Q)) for _ in range(_COPIES)])
            inputs, middle = normalised_touches(np.tile(U, (_COPIES, 1)), wrong)
            outputs = _to_normalised(np.tile(Q, (_COPIES, 1)), wrong, middle)
            stages.append(QuadraticEncoder(self.turned_ridge).fit(inputs, outputs))
        return self._from_stages(stages)

    def load(self, coef: ArrayLike) -> Self:
        """Takes over coefficients (1 + rounds, 136, 48) of an earlier fit.

        Raises:
            EncoderError: The coefficients have another shape.
        """
        coef = np.asarray(coef, float)
        if coef.shape[1:] != _COEF or not len(coef):
            raise EncoderError(
                "coefficients do not fit the encoder",
                got=coef.shape,
                expected=f"(n, {_COEF[0]}, {_COEF[1]})",
            )
        ridges = [self.ridge, *([self.turned_ridge] * (len(coef) - 1))]
        return self._from_stages(
            [
                PolynomialEncoder(2, ridge).load(c, CONTACT_VECTOR_SIZE)
                for ridge, c in zip(ridges, coef, strict=True)
            ]
        )

    def predict(self, U: ArrayLike) -> Array:
        """Relative poses (T, 48) of contact vectors (T, 15), or (48,) of one contact vector (15,).

        Raises:
            EncoderError: The inputs have another width, or the encoder is not fitted.
        """
        self._check_learned()
        U = np.asarray(U, float)
        if U.shape[-1:] != (CONTACT_VECTOR_SIZE,):
            raise EncoderError(
                "wrong number of inputs", got=U.shape, expected=f"(T, {CONTACT_VECTOR_SIZE})"
            )
        if U.ndim == 1:
            pose = self._one(U)
            if pose is not None:
                return pose
        rows = U.reshape(-1, U.shape[-1])
        first, *others = self._stages
        Q = first.predict(rows)
        for stage in others:
            turn = yaw_of(Q)
            inputs, middle = normalised_touches(rows, turn)
            Q = _from_normalised(stage.predict(inputs), turn, middle)
        result: Array = Q.reshape(*U.shape[:-1], POSE_SIZE)
        return result

    def configuration(self) -> dict[str, Any]:
        """Both penalties."""
        return {"ridge": self.ridge, "turned_ridge": self.turned_ridge}

    def arrays(self) -> dict[str, NDArray[Any]]:
        """The coefficients, in single precision."""
        self._check_learned()
        return {"coef": self.coef_.astype(np.float32)}

    def restore(self, arrays: Mapping[str, NDArray[Any]], U: Array, Q: Array) -> Self:
        """See `Encoder.restore`."""
        for ridge in (self.ridge, self.turned_ridge):
            if not is_ridge(ridge):
                raise EncoderError(
                    "the ridge is out of range", got=ridge, expected="0 or more, finite"
                )
        return self.load(stored_coefficients(arrays, (1 + len(SPREADS), *_COEF)))

    def _check_learned(self) -> None:
        if not self._learned:
            raise EncoderError("the encoder has learned nothing yet", remedy="Call fit first")

    def _from_stages(self, stages: list[PolynomialEncoder]) -> Self:
        self._stages = stages
        self.coef_ = np.stack([s.coef_ for s in stages])
        self._one = YawNormalisedPose(self.coef_)
        self._learned = True
        return self


def yaw_of(q: ArrayLike) -> Array:
    """Yaw (...) rad of poses (..., 48) about the surface's normal; 0 is straight up the screen.

    Of all rotations about the normal, the one nearest to the root's rotation defines the yaw.
    """
    R = exp(np.asarray(q, float)[..., ROOT_ROTATION])
    return arithmetic.atan2(R[..., 1, 0] - R[..., 0, 1], R[..., 0, 0] + R[..., 1, 1])


def normalised_touches(U: Array, turn: Array) -> tuple[Array, Array]:
    """Rotates touches back by a yaw about their middle.

    Args:
        U: (T, 15) contact vectors.
        turn: (T,) rad, yaw of the hand.

    Returns:
        Inputs (T, 15): positions relative to the middle in inches, y up, 0 where lifted, and flags;
        and the middle (T, 2) m relative to the leftmost contact, y up.
    """
    down = U[:, 2 * len(FINGERS) :]
    places = U[:, : 2 * len(FINGERS)].reshape(len(U), len(FINGERS), 2) * _UP
    touching = down[..., None]
    middle = (places * touching).sum(axis=1) / np.maximum(down.sum(axis=1), 1.0)[:, None]
    x, y = np.moveaxis((places - middle[:, None]) * touching, -1, 0)
    c, s = arithmetic.cos(turn)[:, None], arithmetic.sin(turn)[:, None]
    turned = np.stack([c * x + s * y, c * y - s * x], axis=-1)
    flat = turned.reshape(len(U), 2 * len(FINGERS))
    return np.hstack([flat, down]), middle * METRES_PER_INCH


def _to_normalised(Q: Array, turn: Array, middle: Array) -> Array:
    """Transforms relative poses (T, 48) to the normalised frame, with the touches' middle as
    origin."""
    back = _about_normal(-turn)
    out = Q.copy()
    out[:, :2] -= middle
    return _rotated(out, back)


def _from_normalised(Q: Array, turn: Array, middle: Array) -> Array:
    """Inverse of `_to_normalised`."""
    out = _rotated(Q, _about_normal(turn))
    out[:, :2] += middle
    return out


def turned_root(errors: Array, turn: Array) -> Array:
    """Errors (T, 48) of poses, with position and rotation errors of the root rotated about the
    normal.

    Args:
        errors: (T, 48) differences of poses, m and rad.
        turn: (T,) rad, angle of the rotation. To transform errors to the frame that turns with the
            hand, pass the negative of the hand's yaw.
    """
    out = np.array(errors)
    rotation = _about_normal(turn)
    for part in (ROOT_POSITION, ROOT_ROTATION):
        out[:, part] = stacked_applied(rotation, errors[:, part])
    return out


def _about_normal(turn: Array) -> Array:
    vectors = np.zeros((len(turn), 3))
    vectors[:, 2] = turn
    return exp(vectors)


def _rotated(Q: Array, rotation: Array) -> Array:
    out = Q.copy()
    out[:, ROOT_POSITION] = stacked_applied(rotation, Q[:, ROOT_POSITION])
    out[:, ROOT_ROTATION] = log(stacked_product(rotation, exp(Q[:, ROOT_ROTATION])))
    return out


_MIDDLE = 0.0
"""Both coordinates of a lifted finger in the normalised frame, whose origin is the touches'
middle."""


class _Quadratic:
    """Quadratic forms v' A v, one per output; v is 1 and the coordinates of one set of fingers."""

    def __init__(self, coef: Array, fingers: tuple[int, ...], lifted: float) -> None:
        reduced = collapse(fingers, 2, lifted)
        places = [FLAGS + fingers[0], *(2 * f + axis for f in fingers for axis in range(2))]
        row = {place: i for i, place in enumerate(places)}
        self._outputs = coef.shape[1]
        A = np.zeros((len(places), len(places), self._outputs))
        for pair, values in zip(
            reduced.factors.T.tolist(), reduced.coefficients(coef), strict=True
        ):
            A[row[pair[0]], row[pair[1]]] += values
        self._first = A.reshape(len(places), -1)
        self._shape = (len(places), self._outputs)

    def __call__(self, v: Array) -> Array:
        return vector_matrix(v, vector_matrix(v, self._first).reshape(self._shape))


class YawNormalisedPose:
    """Fitted yaw-normalised encoder, prepared for single contact vectors.

    Args:
        coef: (1 + rounds, 136, 48) coefficients of the encoder's quadratics.
    """

    def __init__(self, coef: Array) -> None:
        self._coef = coef
        self._sets: dict[tuple[float, ...], tuple[tuple[int, ...], list[_Quadratic]]] = {}

    def __call__(self, u: Array) -> Array | None:
        """Relative pose (48,) of a contact vector (15,); None for an invalid contact vector."""
        numbers = u.tolist()
        flags = tuple(numbers[FLAGS:])
        prepared = self._sets.get(flags)
        if prepared is None:
            prepared = self._prepare(flags)
            if prepared is None:
                return None
        fingers, (first, *others) = prepared
        for f, flag in enumerate(flags):
            if flag == 0.0 and (numbers[2 * f] != LIFTED or numbers[2 * f + 1] != LIFTED):
                return None
        x = [numbers[2 * f] for f in fingers]
        y = [-numbers[2 * f + 1] for f in fingers]
        v = [1.0]
        for f in fingers:
            v += numbers[2 * f : 2 * f + 2]
        # Of all quadratics but the last, only the root's rotation is computed, for the yaw.
        w = first(np.array(v))
        turn = turn_about_normal(w)
        mx, my = fsum(x) / len(x), fsum(y) / len(y)
        x, y = [a - mx for a in x], [a - my for a in y]
        for stage in others[:-1]:
            w = stage(_normalised_inputs(x, y, turn))
            turn = turn_about_normal(turned_about_normal(w, turn))
        q = others[-1](_normalised_inputs(x, y, turn))
        c, s = cos(turn), sin(turn)
        px, py = float(q[0]), float(q[1])
        q[0] = c * px - s * py + mx * METRES_PER_INCH
        q[1] = s * px + c * py + my * METRES_PER_INCH
        q[ROOT_ROTATION] = turned_about_normal(q[ROOT_ROTATION], turn)
        return q

    def _prepare(self, flags: tuple[float, ...]) -> tuple[tuple[int, ...], list[_Quadratic]] | None:
        if not set(flags) <= {0.0, 1.0} or not any(flags) or len(self._coef) < 2:
            return None
        fingers = tuple(f for f in range(len(FINGERS)) if flags[f])
        last = len(self._coef) - 1
        quadratics = [
            _Quadratic(
                coef if i == last else coef[:, ROOT_ROTATION],
                fingers,
                _MIDDLE if i else LIFTED,
            )
            for i, coef in enumerate(self._coef)
        ]
        self._sets[flags] = fingers, quadratics
        return self._sets[flags]


def _normalised_inputs(x: Sequence[float], y: Sequence[float], turn: float) -> Array:
    """Vector of 1 and the coordinates relative to the touches' middle, y up, rotated back by
    `turn`."""
    c, s = cos(turn), sin(turn)
    v = [1.0]
    for a, b in zip(x, y, strict=True):
        v.append(c * a + s * b)
        v.append(c * b - s * a)
    return np.array(v)
