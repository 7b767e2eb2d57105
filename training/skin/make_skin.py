"""Generates the shipped skin, with its nails, cuff and sleeve. Needs the extra `training`.

Every vertex has a warmth and a brightness instead of a texture. Warmth (0 to 1) is high where blood
shows through: at fingertips and knuckles, and on the palmar side. Brightness (0 to 1) is high
except in creases and in the shadow of other flesh.

Positions are in metres, in the palm's frame at the zero pose, as in `field`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arithmetic import Array
from models.frames import FINGERS
from models.skin.skin import FULL, normals_of
from training.skin.field import WRIST_HALF, WRIST_MIDDLE, HandField
from training.skin.mesh import flipped_edges, mesh_of, refined, settled
from training.skin.shapes import step
from training.skin.weights import weights_of

LOW, HIGH = np.array([-0.088, -0.076, -0.104]), np.array([0.072, 0.172, 0.036])
"""Corners (m) of a box around the hand at the zero pose."""
SPACING = 0.0016
"""Spacing (m) of the grid on which the surface is computed."""
FACES = 7600
"""Number of triangles before refinement at creases."""
CREASE_EDGE, NEAR_CREASE = 0.00135, 0.00006
"""Longest edge (m) in a crease, and depth (m) of a widened crease at which refinement begins."""
TIP_EDGE, TIP = 0.0024, 0.011
"""Longest edge (m) at fingertips, and the distance (m) from a fingertip's centre within which edges
must be so short."""
STEP = 4e-6
"""Step (m) to which positions are rounded."""

Faces = NDArray[np.int64]

Piece = tuple[str, Array, Faces, NDArray[np.uint8], NDArray[np.uint8], Array]
"""Name, vertices, triangles, bones, weights, tone."""


def make(field: HandField, faces: int = FACES, spacing: float = SPACING) -> list[Piece]:
    """All parts of the skin of a hand, with about `faces` triangles before refinement."""
    vertices, triangles = mesh_of(field, LOW, HIGH, spacing, faces)
    vertices = settled(field, field.normal, vertices, triangles, 5)
    for _ in range(3):
        vertices, triangles = refined(vertices, triangles, lambda p: _longest(field, p))
        triangles = flipped_edges(vertices, triangles)
        vertices = settled(field, field.normal, vertices, triangles, 2)
    bones, weights = weights_of(field, vertices, triangles)
    tone = tone_of(field, vertices, normals_of(vertices, triangles))
    return [("skin", vertices, triangles, bones, weights, tone), *extras(field)]


def _longest(field: HandField, p: Array) -> Array:
    """Longest edges (n,) m at points (n, 3): short in creases and at fingertips."""
    tips = np.min(
        [np.linalg.norm(p - chain[-1].at(0, 1, 0), axis=1) for chain in field.fingers], axis=0
    )
    longest = np.where(tips < TIP, TIP_EDGE, np.inf)
    return np.where(field.relief(p, 1.6) > NEAR_CREASE, CREASE_EDGE, longest)


def extras(field: HandField) -> list[Piece]:
    """The nails, the cuff and the sleeve; each moves with one bone."""
    pieces: list[Piece] = []
    last = [
        max(i for i, b in enumerate(field.skeleton.bones) if b.finger == f)
        for f in range(len(FINGERS))
    ]
    for finger, name in enumerate(FINGERS):
        places, triangles, edge = nail(field, finger)
        tone = np.stack([edge, np.ones(len(edge))], axis=1)
        pieces.append(
            (f"nail_{name}", places, triangles, *_rigid(len(places), 1 + last[finger]), tone)
        )
    for name, profile, closed in (("cuff", CUFF_PROFILE, False), ("sleeve", SLEEVE_PROFILE, True)):
        places, triangles = tube(profile, closed)
        tone = np.tile([0.0, 1.0], (len(places), 1))
        pieces.append((name, places, triangles, *_rigid(len(places), 0), tone))
    return pieces


def _rigid(count: int, bone: int) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    bones, weights = np.zeros((count, 4), np.uint8), np.zeros((count, 4), np.uint8)
    bones[:, 0], weights[:, 0] = bone, FULL
    return bones, weights


NAIL_RINGS, NAIL_SIDES = 6, 28
NAIL_RAISED, NAIL_SUNK = 0.00042, 0.0011
"""Height (m) of the nail above the skin in the middle, and depth (m) below the skin at the rim.
With less depth, the skin would show through."""
NAIL_SQUARE = 2.7
"""Exponent of the superellipse of the outline; 2 is an ellipse."""
CUFF_SIDES = 56


def nail(field: HandField, finger: int) -> tuple[Array, Faces, Array]:
    """A nail: vertices (n, 3) m, triangles (m, 3), and values (n,) from 0 on the nail's bed to 1 at
    its free edge."""
    limb = field.fingers[finger][-1]
    r, wide = limb.radius, 1.12 if finger == 0 else 1.0
    tilt = np.deg2rad(17.0)
    out = limb.axes @ np.array([0.0, np.sin(tilt), np.cos(tilt)])
    ahead = limb.axes @ np.array([0.0, np.cos(tilt), -np.sin(tilt)])
    half_wide, half_long = 0.74 * wide * r, 0.82 * r
    middle = limb.start + limb.axes @ np.array([0.0, limb.length - 0.20 * r, 0.0])

    rows = [np.zeros((1, 2))]
    for ring in range(1, NAIL_RINGS + 1):
        angle = 2 * np.pi * np.arange(NAIL_SIDES) / NAIL_SIDES
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        size = np.sum(np.abs(circle) ** NAIL_SQUARE, axis=1) ** (-1.0 / NAIL_SQUARE)
        # Rings are closer towards the rim, where the nail bends down.
        share = 1.0 - (1.0 - ring / NAIL_RINGS) ** 1.6
        rows.append(share * circle * size[:, None])
    flat = np.concatenate(rows)
    start = (
        middle
        + flat[:, :1] * half_wide * limb.axes[:, 0]
        + flat[:, 1:] * half_long * ahead
        + 2.5 * r * out
    )
    down = _onto(field, start, -out, 3.6 * r)
    rim = np.linalg.norm(flat, ord=NAIL_SQUARE, axis=1)
    # The middle of the nail is above the skin, and its rim below it.
    lift = NAIL_RAISED - (NAIL_RAISED + NAIL_SUNK) * rim**7
    places = down + lift[:, None] * out
    edge = np.clip((flat[:, 1] - 0.66) / 0.10, 0.0, 1.0)
    return places, _fan(NAIL_RINGS, NAIL_SIDES), edge


def _onto(field: HandField, start: Array, direction: Array, far: float) -> Array:
    """Points at which rays meet the skin, or come nearest to it."""
    walked = np.zeros(len(start))
    for _ in range(30):
        walked = np.minimum(walked + 0.9 * field(start + walked[:, None] * direction), far)
    return start + walked[:, None] * direction


def _fan(rings: int, sides: int) -> Faces:
    """Counterclockwise triangles of a disc, which consists of a middle and rings around it."""
    triangles = [(0, 1 + i, 1 + (i + 1) % sides) for i in range(sides)]
    for ring in range(rings - 1):
        a, b = 1 + ring * sides, 1 + (ring + 1) * sides
        for i in range(sides):
            j = (i + 1) % sides
            triangles += [(a + i, b + i, b + j), (a + i, b + j, a + j)]
    return np.array(triangles, np.int64)


CUFF_PROFILE = (
    (-0.0395, 0.0006),
    (-0.0385, 0.0018),
    (-0.0380, 0.0034),
    (-0.0388, 0.0048),
    (-0.0405, 0.0055),
    (-0.0500, 0.0058),
    (-0.0580, 0.0058),
)
SLEEVE_PROFILE = (
    (-0.0500, 0.0030),
    (-0.0478, 0.0050),
    (-0.0470, 0.0070),
    (-0.0476, 0.0088),
    (-0.0495, 0.0097),
    (-0.0600, 0.0100),
    (-0.0750, 0.0104),
    (-0.0830, 0.0106),
    (-0.0850, 0.0090),
    (-0.0856, 0.0040),
    (-0.0856, -0.0080),
)
"""Points of the profiles of cuff and sleeve, from the inside outwards: position (m) along the
forearm, and height (m) above the wrist's skin."""


def tube(profile: ArrayLike, closed: bool) -> tuple[Array, Faces]:
    """Elliptic tube around the wrist: vertices (n, 3) m and triangles (m, 3).

    Args:
        profile: Points as in `CUFF_PROFILE`.
        closed: True closes the end of the tube at the last point.
    """
    angle = 2 * np.pi * np.arange(CUFF_SIDES) / CUFF_SIDES
    rings = []
    for y, height in np.asarray(profile, float):
        rings.append(
            np.stack(
                [
                    (WRIST_HALF[0] + height) * np.cos(angle),
                    np.full(CUFF_SIDES, y),
                    (WRIST_HALF[1] + height) * np.sin(angle) + WRIST_MIDDLE,
                ],
                axis=1,
            )
        )
    triangles = []
    for ring in range(len(rings) - 1):
        a, b = ring * CUFF_SIDES, (ring + 1) * CUFF_SIDES
        for i in range(CUFF_SIDES):
            j = (i + 1) % CUFF_SIDES
            triangles += [(a + i, b + j, b + i), (a + i, a + j, b + j)]
    points = np.concatenate(rings)
    if closed:
        last = (len(rings) - 1) * CUFF_SIDES
        points = np.concatenate([points, points[last:].mean(axis=0, keepdims=True)])
        triangles += [
            (last + i, last + (i + 1) % CUFF_SIDES, len(points) - 1) for i in range(CUFF_SIDES)
        ]
    return points, np.array(triangles, np.int64)


def packed(pieces: list[Piece]) -> dict[str, Any]:
    """Name -> array of the file of a skin."""
    corner = np.min([p[1].min(axis=0) for p in pieces], axis=0) - STEP
    parts, start, first = [], 0, 0
    for name, places, triangles, *_ in pieces:
        ends = start + len(places), first + len(triangles)
        parts.append({"name": name, "vertices": [start, ends[0]], "triangles": [first, ends[1]]})
        start, first = ends
    header = {"schema": 1, "step": STEP, "corner": corner.tolist(), "parts": parts}
    offsets = np.cumsum([0, *(len(p[1]) for p in pieces[:-1])])
    weights = np.concatenate([p[4] for p in pieces])
    return {
        "header": np.frombuffer(json.dumps(header, sort_keys=True).encode(), np.uint8),
        "rest": np.round((np.concatenate([p[1] for p in pieces]) - corner) / STEP).astype(
            np.uint16
        ),
        "triangles": np.concatenate(
            [p[2] + o for p, o in zip(pieces, offsets, strict=True)]
        ).astype(np.uint16),
        "bones": np.concatenate([p[3] for p in pieces]),
        "weights": weights,
        "tone": np.round(255 * np.concatenate([p[5] for p in pieces])).astype(np.uint8),
    }


def write_skin(path: Path) -> None:
    """Makes the skin of the built-in hand and writes its file."""
    np.savez_compressed(path, **packed(make(HandField())))


CREASE_DARKNESS = 0.44
"""Loss of brightness in the deepest crease."""
DEEPEST = 0.0006
"""Depth (m) of the deepest crease."""
HOLLOWS = ((0.0025, 0.30), (0.006, 0.25), (0.012, 0.18))
"""Distances (m) from the skin within which other flesh casts a shadow, each with the largest loss
of brightness by this shadow."""


def tone_of(field: HandField, vertices: Array, normals: Array) -> Array:
    """Warmth and brightness (n, 2), 0 to 1, of points on the skin."""
    return np.stack(
        [_warmth(field, vertices, normals), _brightness(field, vertices, normals)], axis=1
    )


def _warmth(field: HandField, p: Array, out: Array) -> Array:
    # The palmar side is a little warm, except for the wrist.
    warm = 0.26 * step(-out[:, 2], 0.0, 0.8) * step(p[:, 1], 0.004, 0.030)

    def near(place: Array, reach: float, strength: float) -> None:
        nonlocal warm
        warm = np.maximum(
            warm, strength * np.exp(-np.sum((p - place) ** 2, axis=1) / (2 * reach**2))
        )

    for finger, chain in enumerate(field.fingers):
        last = chain[-1]
        near(last.at(0, 1.0, -0.2), 0.0085, 0.80)
        if finger == 0:
            near(chain[1].at(0, 0.0, 0.7), 0.0085, 0.50)
            near(chain[1].at(0, 0.5, 0.7), 0.0065, 0.62)
            continue
        near(chain[0].at(0, 0.0, 1.0), 0.0075, 0.55)
        near(chain[1].at(0, 0.0, 0.8), 0.0060, 0.72)
        near(chain[2].at(0, 0.0, 0.8), 0.0045, 0.55)
    near(field.fingers[0][0].at(0.4, 0.45, -1.0), 0.013, 0.40)
    near(np.array([0.034, 0.040, -0.018]), 0.015, 0.38)
    return np.clip(warm, 0.0, 1.0)


def _brightness(field: HandField, p: Array, out: Array) -> Array:
    bright = np.ones(len(p))
    for reach, most in HOLLOWS:
        free = np.clip(field(p + reach * out) / reach, 0.0, 1.0)
        bright *= 1.0 - most * (1.0 - free)
    crease = field.relief(p) / DEEPEST
    return np.clip(bright * (1.0 - CREASE_DARKNESS * crease), 0.0, 1.0)
