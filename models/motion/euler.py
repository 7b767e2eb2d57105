"""Euler angles without jumps: of all equivalent triples, the one nearest to the previous triple.

R = R_a(alpha) R_b(beta) R_c(gamma), with different axes a, b and c. A rotation has two families of
triples, (alpha, beta, gamma) and (alpha + pi, pi - beta, gamma + pi), each up to full turns. At the
poles, beta = +-pi/2, only alpha +- gamma is determined; gamma then keeps its previous value.
"""

from __future__ import annotations

import numpy as np

from models.arithmetic import Array

POLE = 1e-7
"""Cosine of the middle angle below which the outer two angles cannot be distinguished."""

ZONE = np.deg2rad(75.0)
"""Middle angle (rad) beyond which a joint may change from one family to the other."""

TURN = 2.0 * np.pi


def angles_of(rotations: Array, order: str) -> Array:
    """Angles (..., 3) rad of rotations (..., 3, 3) in a given Euler order, the middle one within
    +-pi/2."""
    a, b, c = ("XYZ".index(letter) for letter in order)
    sign = 1.0 if (b - a) % 3 == 1 else -1.0
    sine = sign * rotations[..., a, c]
    cosine = np.hypot(rotations[..., a, a], rotations[..., a, b])
    middle = np.arctan2(sine, cosine)
    first = np.arctan2(-sign * rotations[..., b, c], rotations[..., c, c])
    pole = cosine < POLE
    if np.any(pole):
        # With gamma = 0, column b of the matrix is column b of R_a(alpha).
        alone = np.arctan2(sign * rotations[..., c, b], rotations[..., b, b])
        first = np.where(pole, alone, first)
    # Near a pole, rounding errors in the matrix change the first angle strongly. The last angle is
    # computed after undoing the first rotation, and so compensates for these errors.
    sine_a, cosine_a = sign * np.sin(first), np.cos(first)
    last = np.arctan2(
        sign * (cosine_a * rotations[..., b, a] + sine_a * rotations[..., c, a]),
        cosine_a * rotations[..., b, b] + sine_a * rotations[..., c, b],
    )
    return np.stack([first, middle, last], axis=-1)


class ContinuousEuler:
    """Converts rotations of joints over time to angles, each nearest to the previous one.

    Args:
        order: Euler order, such as `ZXY`.

    Attributes:
        biggest_step: Largest change of any angle from one moment to the next (rad).
        biggest_at: The later of these two moments, counted from 0, and the joint.
    """

    def __init__(self, order: str) -> None:
        self.order = order
        self.biggest_step = 0.0
        self.biggest_at = (0, 0)
        self._count = 0
        self._last: Array | None = None

    def angles(self, rotations: Array) -> Array:
        """Angles (n, J, 3) rad of the rotations (n, J, 3, 3) of the next n moments."""
        raw = angles_of(rotations, self.order)
        if not len(raw):
            return raw
        before = np.zeros_like(raw[0]) if self._last is None else self._last
        out = np.empty_like(raw)
        calm = np.asarray((np.abs(raw[..., 1]) < ZONE).all(axis=0))
        out[:, calm] = _unwrapped(raw[:, calm], before[calm])
        if not calm.all():
            out[:, ~calm] = self._frame_by_frame(raw[:, ~calm], before[~calm])
        whole = out if self._last is None else np.concatenate([before[None], out])
        if len(whole) > 1:
            steps = np.abs(np.diff(whole, axis=0)).max(axis=-1)
            if steps.max() > self.biggest_step:
                self.biggest_step = float(steps.max())
                moment, joint = np.unravel_index(int(steps.argmax()), steps.shape)
                later = self._count + int(moment) + (self._last is None)
                self.biggest_at = later, int(joint)
        self._count += len(out)
        self._last = out[-1].copy()
        return out

    def _frame_by_frame(self, raw: Array, before: Array) -> Array:
        """Angles of joints that come near a pole. At each moment, the family that is nearer to the
        previous angles is chosen."""
        other = _second_family(raw)
        poles = np.abs(np.cos(raw[..., 1])) < POLE
        near = np.abs(raw[..., 1]) >= ZONE
        out = np.empty_like(raw)
        for i in range(len(raw)):
            one, two = _nearest(raw[i], before), _nearest(other[i], before)
            nearer = np.abs(one - before).sum(axis=-1) <= np.abs(two - before).sum(axis=-1)
            first = np.where(near[i], nearer, np.cos(before[..., 1]) > 0)
            chosen = np.where(first[..., None], one, two)
            if poles[i].any():
                chosen = np.where(poles[i][..., None], self._at_pole(raw[i], before), chosen)
            out[i] = before = chosen
        return out

    def _at_pole(self, raw: Array, before: Array) -> Array:
        """Angles at a pole. Only the sum or the difference of the first and the last angle is
        known, so the last angle keeps its previous value."""
        a, b, _ = ("XYZ".index(letter) for letter in self.order)
        parity = 1.0 if (b - a) % 3 == 1 else -1.0
        share = np.sign(raw[..., 1]) * parity
        first = raw[..., 0] + share * (raw[..., 2] - before[..., 2])
        return _nearest(np.stack([first, raw[..., 1], before[..., 2]], axis=-1), before)


def _nearest(angles: Array, before: Array) -> Array:
    """The same angles, shifted by full turns to be nearest to the previous angles."""
    return np.asarray(angles + TURN * np.round((before - angles) / TURN))


def _second_family(angles: Array) -> Array:
    """The other family's angles for the same rotations."""
    return np.asarray(angles * [1.0, -1.0, 1.0] + np.pi)


def _unwrapped(raw: Array, before: Array) -> Array:
    """Angles (n, J, 3) in the family of the previous angles (J, 3), without jumps by full turns."""
    second = np.cos(before[..., 1]) < 0
    chosen = np.where(second[..., None], _second_family(raw), raw)
    return np.asarray(np.unwrap(np.concatenate([before[None], chosen]), axis=0)[1:])
