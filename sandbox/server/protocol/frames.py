"""Binary frames with the poses of all bodies, 60 times a second.

Little-endian: a header of 32 bytes, one pose of seven float32 per body (position in m, quaternion
w, x, y, z), and the rest (score, contacts, goals) as JSON of `protocol.State`.

    offset  type     content
    0       uint8    PROTOCOL
    1       uint8    KIND, 1
    2       uint16   number of bodies
    4       uint32   number of the scene
    8       uint32   number of the frame, from 1
    12      uint32   low half of the newest touch message's seq that took effect in it
    16      float64  s, simulated time
    24      uint32   length of the JSON, bytes
    28      uint32   0
"""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

from sandbox.server.protocol.protocol import PROTOCOL, State, encode

KIND = 1
_HEADER = struct.Struct("<BBHIIIdII")
POSE_BYTES = 7 * 4


def pack(
    scene: int, touch: int, time: float, poses: NDArray[np.float32], state: State
) -> bytearray:
    """Encodes a frame without its number, which each connection sets by `number_frame`."""
    tail = encode(state)
    head = _HEADER.pack(
        PROTOCOL, KIND, len(poses), scene, 0, touch & 0xFFFFFFFF, time, len(tail), 0
    )
    return bytearray(head + np.ascontiguousarray(poses, "<f4").tobytes() + tail)


def number_frame(frame: bytearray, number: int) -> bytes:
    """Sets the number of an encoded frame."""
    struct.pack_into("<I", frame, 8, number & 0xFFFFFFFF)
    return bytes(frame)
