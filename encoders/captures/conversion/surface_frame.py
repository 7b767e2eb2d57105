"""Finds the touch surface in a recorder's frame, from the surface's corners or from fingertips.

Fingertips cannot pass through a surface. A surface on which fingertips rested repeatedly is
therefore a plane with many fingertip positions on it and hardly any beyond it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array
from models.errors import CaptureError

ON_PLANE = 0.005
"""Distance (m) from a plane within which a fingertip lies on it; a soft surface needs more."""

BEYOND = 0.02
"""Greatest share of fingertip positions beyond the plane; they count as noise."""

TOUCHING = 0.15
"""Least share of fingertip positions on the plane."""

EXTENT = 0.01
"""Least standard deviation (m) of the positions on the plane, along the plane's narrower side."""

_TRIALS = 400
_MOST_PLACES = 4000


@dataclass(frozen=True)
class SurfaceFrame:
    """The 3-D surface frame in a recorder's frame.

    Attributes:
        origin: (3,) m, the top left corner, or the middle of the touches if the corner is unknown.
        rotation: (3, 3); its columns point right, up the surface, and out of the surface.
    """

    origin: Array
    rotation: Array

    def points(self, recorded: Array) -> Array:
        """Transforms points (..., 3) m from the recorder's frame to the surface frame."""
        return (recorded - self.origin) @ self.rotation


def frame_from_corners(
    top_left: ArrayLike, top_right: ArrayLike, bottom_left: ArrayLike
) -> SurfaceFrame:
    """Frame of a surface with known corners (3,) m, named from the person's view.

    Raises:
        CaptureError: The corners are not finite, or lie on one line.
    """
    corners = np.array([top_left, top_right, bottom_left], float)
    if corners.shape != (3, 3) or not np.isfinite(corners).all():
        raise CaptureError(
            "invalid corners", where="surface", expected="three corners of three finite numbers"
        )
    right, up = corners[1] - corners[0], corners[0] - corners[2]
    out = np.cross(right, up)
    if np.linalg.norm(out) < 1e-3 * max(float(np.linalg.norm(right) * np.linalg.norm(up)), 1e-9):
        raise CaptureError(
            "the corners lie on one line",
            where="surface",
            got=corners.tolist(),
            expected="top left, top right and bottom left of a rectangle",
        )
    x, z = right / np.linalg.norm(right), out / np.linalg.norm(out)
    return SurfaceFrame(corners[0], np.stack([x, np.cross(z, x), z], axis=1))


def frame_from_fingertips(tips: Array, palm: Array, tolerance: float = ON_PLANE) -> SurfaceFrame:
    """Frame of the plane on which fingertips rest; y points in the direction of the hand.

    Args:
        tips: (T, 5, 3) m, NaN where not seen.
        palm: (T, 3) m, middle of the palm, which is on the person's side of the surface.
        tolerance: Distance (m) from the plane within which a fingertip lies on it.

    Raises:
        CaptureError: No plane meets the conditions.
    """
    places = tips[~np.isnan(tips).any(axis=2)]
    if len(places) > _MOST_PLACES:
        places = places[np.linspace(0, len(places) - 1, _MOST_PLACES).astype(int)]
    middle = np.nanmean(palm, axis=0)
    rng = np.random.default_rng(0)
    best, most = None, 0
    for _ in range(_TRIALS if len(places) >= 3 else 0):
        three = places[rng.choice(len(places), 3, replace=False)]
        plane = _plane(three, middle)
        height = (places - plane[0]) @ plane[1]
        on = np.abs(height) < tolerance
        if on.sum() > most and (height < -tolerance).mean() <= BEYOND:
            best, most = on, int(on.sum())
    for _ in range(5 if best is not None else 0):
        plane = _plane(places[best], middle)
        best = np.abs((places - plane[0]) @ plane[1]) < tolerance
    sizes = np.linalg.svd(places[best] - plane[0], compute_uv=False) if best is not None else [0, 0]
    extent = sizes[1] / np.sqrt(max(1, 0 if best is None else best.sum()))
    if best is None or best.mean() < TOUCHING or extent < EXTENT:
        share = 0.0 if best is None else 100 * best.mean()
        raise CaptureError(
            "no plane fits the resting fingertips",
            where="surface",
            got=f"{share:.0f} % of their positions on the best plane",
            expected=f"at least {100 * TOUCHING:g} %, spread out, and hardly any beyond the plane",
            remedy="Give the surface's corners in the --mapping file",
        )
    z = plane[1]
    shown = np.asarray(~np.isnan(tips).any(axis=2)).any(axis=1)
    middles = np.full(palm.shape, np.nan)
    middles[shown] = np.nanmean(tips[shown], axis=1)
    y = np.nanmean(middles - palm, axis=0)
    y -= (y @ z) * z
    y /= np.linalg.norm(y)
    return SurfaceFrame(plane[0], np.stack([np.cross(y, z), y, z], axis=1))


def _plane(places: Array, above: Array) -> tuple[Array, Array]:
    """Fits a plane to positions; returns a point on it and its normal, on the side of `above`."""
    middle = places.mean(axis=0)
    normal = np.linalg.svd(places - middle)[2][2] if len(places) < 50 else _least(places - middle)
    return middle, normal * (1.0 if (above - middle) @ normal >= 0 else -1.0)


def _least(offsets: Array) -> Array:
    """Direction (3,) in which offsets (n, 3) have the least spread."""
    return np.asarray(np.linalg.eigh(offsets.T @ offsets)[1][:, 0])
