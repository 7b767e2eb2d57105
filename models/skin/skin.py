"""The skin of a hand: a surface that bends with the bones.

The skin of the built-in hand was made once (`python -m training skin` in a checkout) and is
shipped. For other hands it is stretched along their bones, and mirrored for a left hand. Posing is
linear blend skinning: each vertex is the weighted mean of the positions to which its bones would
move it, as in MuJoCo's skins, glTF and three.js.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from functools import cache, cached_property
from importlib.resources import files

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arithmetic import Array
from models.kinematics import Kinematics
from models.pose import POSE_SIZE, ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp
from models.skeleton import ADULT, Skeleton

Colour = tuple[float, float, float]

PALE: Colour = (0.910, 0.735, 0.630)
WARM: Colour = (0.880, 0.560, 0.470)
SHADE: Colour = (0.62, 0.42, 0.36)
"""Colour of skin, colour of skin where blood shows through, and factor on both in a deep crease."""
NAIL: Colour = (0.93, 0.71, 0.65)
CUFF: Colour = (0.93, 0.94, 0.95)
SLEEVE: Colour = (0.16, 0.20, 0.27)


def tone_colours(tone: Array) -> Array:
    """Colours (..., 3) of skin tones (..., 2): warmth and brightness, 0 to 1."""
    pale, warm, shade = (np.array(c) for c in (PALE, WARM, SHADE))
    lit = pale + (warm - pale) * tone[..., :1]
    # A shadow on skin is reddish, since light that has passed through flesh is red.
    return np.asarray(lit * (1.0 - (1.0 - tone[..., 1:]) * (1.0 - shade)))


def linear(colour: Array) -> Array:
    """Converts sRGB values to linear light, both 0 to 1 (IEC 61966-2-1)."""
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)


BONES = 15
"""Number of bones: palm and 14 phalanges."""
SKIN_FILE = "data/skin.npz"
FULL = 255
"""Sum of the integer weights of a vertex. With integers, weights sum to exactly one in every
format."""


@dataclass(frozen=True)
class Part:
    """A group of vertices and triangles of one material: `skin`, `nail_thumb`, ..., `cuff`,
    `sleeve`."""

    name: str
    vertices: slice
    triangles: slice


@dataclass(frozen=True, eq=False)
class Skin:
    """A skin at the zero pose, in the palm's frame.

    Attributes:
        skeleton: The bones that move it.
        rest: (n, 3) m, vertices at the zero pose.
        triangles: (m, 3) vertices, counterclockwise seen from outside.
        bones: (n, 4) bones that move each vertex: 0 is the palm, then the skeleton's bones in their
            order.
        weights: (n, 4) weights of these bones, integers that sum to 255, the largest first.
        tone: (n, 2) numbers from 0 to 1: warmth and brightness of the skin at each vertex. On a
            nail, the first number is the closeness to its free edge, and the second is 1.
        parts: The parts in the order of the vertices.
    """

    skeleton: Skeleton
    rest: Array
    triangles: NDArray[np.int64]
    bones: NDArray[np.uint8]
    weights: NDArray[np.uint8]
    tone: Array
    parts: tuple[Part, ...]

    @staticmethod
    def builtin() -> Skin:
        """The shipped skin, of `ADULT`."""
        return _builtin()

    def part(self, name: str) -> Part:
        """The part of this name."""
        return next(p for p in self.parts if p.name == name)

    def fitted(self, skeleton: Skeleton) -> Skin:
        """The same skin on another hand of 14 bones, of either side.

        The skin on every bone is stretched in length by the bone's length and in width by its
        radius.
        """
        if skeleton is self.skeleton:
            return self
        same = skeleton.side == self.skeleton.side
        # The skin is stretched before it is mirrored, since mirrored bones have mirrored frames.
        target = skeleton if same else skeleton.mirrored()
        places, turns = frames(target, np.zeros(POSE_SIZE))
        here, rotation = frames(self.skeleton, np.zeros(POSE_SIZE))
        local = np.einsum("bji,bnj->bni", rotation, self.rest[None] - here[:, None])
        stretched = local * _stretch(self.skeleton, target)[:, None]
        moved = np.einsum("bij,bnj->bni", turns, stretched) + places[:, None]
        rest = np.einsum("nb,bni->ni", self.shares, moved)
        if same:
            return replace(self, skeleton=skeleton, rest=rest)
        return replace(
            self,
            skeleton=skeleton,
            rest=rest * [-1.0, 1.0, 1.0],
            triangles=self.triangles[:, ::-1],
        )

    @cached_property
    def shares(self) -> Array:
        """Weights (n, 15) of all bones; rows sum to one."""
        return dense(self.bones, self.weights)

    def posed(self, positions: ArrayLike, rotations: ArrayLike) -> Array:
        """Vertices (..., n, 3) m for given positions and rotations of the bones.

        Args:
            positions: (..., 15, 3) m, the palm's origin and the ball joints, in any frame.
            rotations: (..., 15, 3, 3) of palm and bones, in the same frame.
        """
        blended = self._blended(positions, rotations)
        return np.einsum("...nij,nj->...ni", blended[..., :3], self.rest) + blended[..., 3]

    def _blended(self, positions: ArrayLike, rotations: ArrayLike) -> Array:
        """Weighted mean (..., n, 3, 4) of the motions of each vertex's bones."""
        moves = motions(*self._bind, positions, rotations)
        blended = self.shares @ moves.reshape(*moves.shape[:-2], 12)
        return np.asarray(blended.reshape(*blended.shape[:-1], 3, 4))

    @cached_property
    def _bind(self) -> tuple[Array, Array]:
        return frames(self.skeleton, np.zeros(POSE_SIZE))

    def at(self, q: ArrayLike) -> Array:
        """Vertices (..., n, 3) m at poses (..., 48), in the frame in which the poses are given."""
        return self.posed(*frames(self.skeleton, q))


def frames(skeleton: Skeleton, q: ArrayLike) -> tuple[Array, Array]:
    """Positions (..., 15, 3) and rotations (..., 15, 3, 3) of palm and bones at poses (..., 48)."""
    q = np.asarray(q, float)
    placed = Kinematics(skeleton).place(q)
    palm = exp(q[..., ROOT_ROTATION])
    return (
        np.concatenate([q[..., None, ROOT_POSITION], placed.joints], axis=-2),
        np.concatenate([palm[..., None, :, :], placed.rotations], axis=-3),
    )


def motions(here: Array, turn: Array, positions: ArrayLike, rotations: ArrayLike) -> Array:
    """Motions (..., 15, 3, 4) of bones between two placements: a rotation and a translation.

    Args:
        here: (15, 3) m, positions before.
        turn: (15, 3, 3) rotations before.
        positions: (..., 15, 3) m, positions now.
        rotations: (..., 15, 3, 3) rotations now.
    """
    total = np.asarray(rotations, float) @ np.swapaxes(turn, -1, -2)
    shift = np.asarray(positions, float) - (total @ here[..., None])[..., 0]
    return np.concatenate([total, shift[..., None]], axis=-1)


def dense(bones: NDArray[np.uint8], weights: NDArray[np.uint8]) -> Array:
    """Dense weights (n, 15) of all bones, from four bones (n, 4) and their weights (n, 4) out of
    255."""
    out = np.zeros((len(bones), BONES))
    # Unused entries contain bone 0 with weight 0.
    np.add.at(out, (np.arange(len(bones))[:, None], bones), weights / FULL)
    return out


def normals_of(vertices: Array, triangles: NDArray[np.int64]) -> Array:
    """Unit normals (n, 3) of vertices (n, 3): the mean of their triangles' normals, weighted by
    area."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    faces = np.cross(b - a, c - a)
    total = np.stack(
        [
            np.bincount(triangles.ravel(), np.repeat(faces[:, i], 3), len(vertices))
            for i in range(3)
        ],
        axis=1,
    )
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-30)


def _stretch(old: Skeleton, new: Skeleton) -> Array:
    """Stretch factors (15, 3) of the palm and each bone: in width, length and thickness."""
    knuckles = [np.array([s.bones[i].anchor for i in s.first_bone[1:]]) for s in (old, new)]
    wide = np.ptp(knuckles[1][:, 0]) / np.ptp(knuckles[0][:, 0])
    long = knuckles[1][:, 1].mean() / knuckles[0][:, 1].mean()
    thick = new.palm_radius / old.palm_radius
    rows = [(wide, long, thick)]
    for a, b in zip(old.bones, new.bones, strict=True):
        rows.append((b.radius / a.radius, b.length / a.length, b.radius / a.radius))
    return np.array(rows)


@cache
def _builtin() -> Skin:
    with (files("models") / SKIN_FILE).open("rb") as file, np.load(file, allow_pickle=False) as z:
        header = json.loads(bytes(z["header"].tobytes()).decode())
        rest = z["rest"] * header["step"] + np.array(header["corner"])
        tone = z["tone"] / 255.0
        triangles, bones, weights = z["triangles"].astype(np.int64), z["bones"], z["weights"]
    parts = tuple(
        Part(p["name"], slice(*p["vertices"]), slice(*p["triangles"])) for p in header["parts"]
    )
    for array in (rest, tone, triangles, bones, weights):
        array.flags.writeable = False
    return Skin(ADULT, rest, triangles, bones, weights, tone, parts)
