"""Registration: pose of a 3-D device in the surface frame, from touching fingertips.

The centre of a touching fingertip is above its touch, at a known height. Enough fingertips, not on
one line, determine rotation and translation of the device's frame. The first estimate needs no
labels of touches. The plane on which fingertips rest gives heights. Of all rotations about the
plane's normal, the estimate is the one that brings fingertips nearest to touches.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.correction import PAD_HEIGHT
from models.arithmetic import Array
from models.errors import CaptureError

TURNS = 36
"""Number of rotations about the normal from which the search starts. The best start differs from
the true rotation by at most 5 degrees."""

MOST_MISS = 0.012
"""Largest median distance (m) between touches and their fingertips: half the distance between
neighbouring fingers."""

_ROUNDS = 15
_KEPT = 0.7
"""Share of the pairs that are used, the nearest first. The remaining pairs include fingers that are
about to land."""


@dataclass(frozen=True)
class DevicePose:
    """Pose of the device's frame in the 3-D surface frame.

    Attributes:
        rotation: (3, 3) rotation from the device's frame to the surface frame.
        shift: (3,) m, position of the device in the surface frame.
        miss: Median distance (m) of touching fingertips from their touches.
        pairs: Number of touches used.
    """

    rotation: Array
    shift: Array
    miss: float
    pairs: int

    def points(self, device: Array) -> Array:
        """Transforms points (..., 3) m from the device's frame to the surface frame."""
        return np.asarray(device @ self.rotation.T + self.shift)


def first_guess(touches: Array, frame: NDArray[np.int64], tips: Array, near: float) -> DevicePose:
    """Estimates rotation and translation in the plane, without labels of touches.

    Args:
        touches: (R, 2) m, x right and y up.
        frame: (R,) row of `tips` at the time of each touch.
        tips: (F, 5, 3) m, in a frame whose z is the height above the plane of resting fingertips.
        near: Distance (m) from that plane within which a fingertip may touch.

    Raises:
        CaptureError: No rotation brings fingertips to the touches.
    """
    best: DevicePose | None = None
    flat, low = tips[frame, :, :2], np.abs(tips[frame, :, 2]) < near
    usable = low.any(axis=1)
    if usable.sum() < 10:
        raise CaptureError(
            "hardly any touch matches a fingertip on the surface",
            got=f"{int(usable.sum())} touches with a fingertip near the surface",
            expected="at least 10",
            remedy="Keep the hand in the device's view while it touches",
        )
    flat, low, touches = flat[usable], low[usable], touches[usable]
    middle = np.where(low[..., None], flat, 0.0).sum(axis=1) / low.sum(axis=1)[:, None]
    for angle in 2.0 * np.pi * np.arange(TURNS) / TURNS:
        rotation = _plane_turn(angle)
        shift = np.median(touches - middle @ rotation.T, axis=0)
        for _ in range(_ROUNDS):
            there = flat @ rotation.T + shift
            off = np.where(low, np.linalg.norm(there - touches[:, None], axis=2), np.inf)
            nearest = off.argmin(axis=1)
            miss = off[np.arange(len(off)), nearest]
            keep = miss <= np.quantile(miss, _KEPT)
            rotation, shift = _rigid(flat[np.arange(len(off)), nearest][keep], touches[keep])
        score = float(np.median(miss))
        if best is None or score < best.miss:
            whole = np.eye(3)
            whole[:2, :2] = rotation
            best = DevicePose(whole, np.array([*shift, PAD_HEIGHT]), score, int(keep.sum()))
    assert best is not None
    if best.miss > MOST_MISS:
        raise CaptureError(
            "touches and fingertips do not match",
            got=f"{1000 * best.miss:.0f} mm between them (median)",
            expected=f"under {1000 * MOST_MISS:g} mm",
            remedy="Check --side and --surface, and that both were recorded together",
        )
    return best


def register(touches: Array, tips: Array) -> DevicePose:
    """Estimates the rigid motion that brings fingertips to their touches, without outliers.

    Args:
        touches: (R, 2) m, x right and y up.
        tips: (R, 3) m, the touching fingertips in the device's frame; NaN where not seen.

    Raises:
        CaptureError: There are too few touches, or they lie on one line.
    """
    known = ~np.isnan(tips).any(axis=1)
    there = np.column_stack([touches[known], np.full(int(known.sum()), PAD_HEIGHT)])
    here = tips[known]
    if len(here) < 10 or np.linalg.svd(here - here.mean(axis=0), compute_uv=False)[1] < 0.01:
        raise CaptureError(
            "too few touches to locate the device",
            got=f"{len(here)} fingertips that were seen touching",
            expected="at least 10, not on one line",
            remedy="Touch all over the surface, with several fingers at a time",
        )
    keep = np.ones(len(here), bool)
    for _ in range(_ROUNDS):
        rotation, shift = _rigid(here[keep], there[keep])
        miss = np.linalg.norm(here @ rotation.T + shift - there, axis=1)
        keep = miss <= max(3.0 * 1.4826 * float(np.median(miss)) / 1.5, 0.003)
    return DevicePose(rotation, shift, float(np.median(miss)), int(keep.sum()))


def _rigid(here: Array, there: Array) -> tuple[Array, Array]:
    """Least-squares rotation and translation (Kabsch 1976), in the plane or in space."""
    a, b = here.mean(axis=0), there.mean(axis=0)
    u, _, v = np.linalg.svd((here - a).T @ (there - b))
    sign = np.ones(here.shape[1])
    sign[-1] = np.sign(np.linalg.det(u @ v))
    rotation = (u * sign @ v).T
    return rotation, b - rotation @ a


def _plane_turn(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])
