"""Binary messages with the hands' skins, sent once per hand before the frames that move them.

Little-endian: a header of 16 bytes, 15 names and frames of bones, and arrays over n vertices and
m triangles, each beginning at a multiple of four bytes.

    offset  type     content
    0       uint8    PROTOCOL
    1       uint8    SKIN_KIND, 2
    2       uint16   length of the JSON, bytes
    4       uint32   n
    8       uint32   m
    12      uint32   0
    16      JSON     names of the bodies that carry it, palm first
            float32  15 x 7: their poses in the bind pose of the vertices, as in a frame
            float32  n x 3: vertices, m
            uint8    n x 4: indices of the bones that carry a vertex
            uint8    n x 4: weights of these bones, of 255
            uint8    n x 4: colour, sRGB, and 255
            uint16   m x 3: triangles, counterclockwise from outside
"""

from __future__ import annotations

import json
import struct

import numpy as np
from numpy.typing import NDArray

from models.hand import SceneHand
from models.pose import POSE_SIZE
from models.rotations import matrix_to_quaternion
from models.skeleton import Skeleton
from models.skin.colours import CUFF, NAIL, SLEEVE, tone_colours
from models.skin.skin import BONES, Skin, frames
from sandbox.server.protocol.protocol import PROTOCOL

SKIN_KIND = 2
_HEADER = struct.Struct("<BBHIII")
_FLAT = {"nail": NAIL, "cuff": CUFF, "sleeve": SLEEVE}


def pack_skin(hand: SceneHand) -> bytes:
    """Encodes the skin of a hand; empty if it has no skeleton, or other bones than the skin."""
    skeleton = hand.skeleton
    if skeleton is None or len(skeleton.bones) != BONES - 1:
        return b""
    names = [hand.palm, *(link.body for link in hand.links)]
    return _packed(skeleton, tuple(names))


def _packed(skeleton: Skeleton, names: tuple[str, ...]) -> bytes:
    skin = Skin.builtin().fitted(skeleton)
    places, turns = frames(skeleton, np.zeros(POSE_SIZE))
    bind = np.concatenate([places, matrix_to_quaternion(turns)], axis=1)
    text = json.dumps(names).encode()
    head = _HEADER.pack(PROTOCOL, SKIN_KIND, len(text), len(skin.rest), len(skin.triangles), 0)
    parts = (
        head,
        text,
        bind.astype("<f4").tobytes(),
        skin.rest.astype("<f4").tobytes(),
        skin.bones.tobytes(),
        skin.weights.tobytes(),
        _colours(skin).tobytes(),
        skin.triangles.astype("<u2").tobytes(),
    )
    return b"".join(part + b"\0" * (-len(part) % 4) for part in parts)


def _colours(skin: Skin) -> NDArray[np.uint8]:
    """(n, 4) sRGB colours of the vertices, and 255."""
    colours = np.ones((len(skin.rest), 4))
    for part in skin.parts:
        flat = _FLAT.get(part.name.partition("_")[0])
        colours[part.vertices, :3] = (
            tone_colours(skin.tone[part.vertices]) if flat is None else flat
        )
    return np.round(255 * colours).astype(np.uint8)
