"""Generates the shipped skin. Needs the extra `training`.

Every vertex has a warmth and a brightness instead of a texture. Warmth (0 to 1) is high where blood
shows through: at fingertips and knuckles, and on the palmar side. Brightness (0 to 1) is high
except in creases and in the shadow of other flesh.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.frames import FINGERS
from models.skin.skin import FULL, normals_of
from training.skin.extras import CUFF_PROFILE, SLEEVE_PROFILE, nail, tube
from training.skin.field import HandField
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

Piece = tuple[str, Array, NDArray[np.int64], NDArray[np.uint8], NDArray[np.uint8], Array]
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
