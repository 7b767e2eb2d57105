"""Vectors, turns (rotations) and the stream's lines inside Maya and Blender, which may lack NumPy.

The parser of lines is strict, since any program can write to the ports of these programs. For
Python 3.7 and later.
"""

from __future__ import annotations

import math
import re
from typing import Dict, List, Sequence, Tuple

Vector = Tuple[float, float, float]
Quaternion = Tuple[float, float, float, float]  # w, x, y, z; of length 1
Rows = List[List[float]]  # of a 3 x 3 matrix


class Refused(Exception):  # noqa: N818
    """A rig or a line cannot be used; the message has the reason."""


def plus(a: Sequence[float], b: Sequence[float]) -> Vector:
    """The sum a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def minus(a: Sequence[float], b: Sequence[float]) -> Vector:
    """The difference a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def times(a: Sequence[float], factor: float) -> Vector:
    """A vector, multiplied by a factor."""
    return (factor * a[0], factor * a[1], factor * a[2])


def dot(a: Sequence[float], b: Sequence[float]) -> float:
    """The scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Sequence[float], b: Sequence[float]) -> Vector:
    """The vector product of two vectors."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a: Sequence[float]) -> float:
    """Length of a vector."""
    return math.sqrt(dot(a, a))


def normal(a: Sequence[float]) -> Vector:
    """The unit vector in the direction of a vector."""
    size = length(a)
    if size < 1e-9:
        raise Refused("joints at the same place have no direction")
    return times(a, 1.0 / size)


def unit(q: Sequence[float]) -> Quaternion:
    """A quaternion of nearly unit length, normalised."""
    size = math.sqrt(sum(v * v for v in q))
    if len(q) != 4 or not 0.9 < size < 1.1:
        raise ValueError("not a unit quaternion")
    return (q[0] / size, q[1] / size, q[2] / size, q[3] / size)


def product(a: Quaternion, b: Quaternion) -> Quaternion:
    """The product of two quaternions: turns by b, then by a."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


def inverse(q: Quaternion) -> Quaternion:
    """The inverse of a turn."""
    return (q[0], -q[1], -q[2], -q[3])


def rotated(q: Quaternion, a: Sequence[float]) -> Vector:
    """A vector, turned by a quaternion."""
    u = (q[1], q[2], q[3])
    t = times(cross(u, a), 2.0)
    return plus(plus(a, times(t, q[0])), cross(u, t))


def rows_of(q: Quaternion) -> Rows:
    """The matrix of a turn."""
    columns = [rotated(q, axis) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    return [[column[i] for column in columns] for i in range(3)]


def quaternion_of(m: Rows) -> Quaternion:
    """The quaternion of a rotation matrix."""
    w = math.sqrt(max(0.0, 1.0 + m[0][0] + m[1][1] + m[2][2])) / 2.0
    x = math.sqrt(max(0.0, 1.0 + m[0][0] - m[1][1] - m[2][2])) / 2.0
    y = math.sqrt(max(0.0, 1.0 - m[0][0] + m[1][1] - m[2][2])) / 2.0
    z = math.sqrt(max(0.0, 1.0 - m[0][0] - m[1][1] + m[2][2])) / 2.0
    # The largest of the four numbers determines the signs of the others.
    if w >= max(x, y, z):
        signs = (1.0, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1])
    elif x >= max(y, z):
        signs = (m[2][1] - m[1][2], 1.0, m[0][1] + m[1][0], m[0][2] + m[2][0])
    elif y >= z:
        signs = (m[0][2] - m[2][0], m[0][1] + m[1][0], 1.0, m[1][2] + m[2][1])
    else:
        signs = (m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], 1.0)
    return unit([math.copysign(v, sign) for v, sign in zip((w, x, y, z), signs)])


def between(a: Sequence[float], b: Sequence[float]) -> Quaternion:
    """The shortest turn from one direction to another."""
    one, two = normal(a), normal(b)
    axis, cosine = cross(one, two), dot(one, two)
    if cosine < -0.999999:
        other = (1.0, 0.0, 0.0) if abs(one[0]) < 0.9 else (0.0, 1.0, 0.0)
        axis = normal(cross(one, other))
        return (0.0, axis[0], axis[1], axis[2])
    size = math.sqrt((1.0 + cosine) ** 2 + dot(axis, axis))
    return ((1.0 + cosine) / size, axis[0] / size, axis[1] / size, axis[2] / size)


POLE = 1e-7
"""Cosine of the turn about y; below it, the turns about x and z cannot be separated."""


def angles_of(q: Quaternion, before: Sequence[float]) -> Vector:
    """Angles (degrees) about the fixed axes x, then y, then z, nearest to the angles before."""
    m = rows_of(q)
    if math.hypot(m[2][1], m[2][2]) < POLE:
        # Only the sum or the difference of the turns about x and z is known; the angle about x
        # stays as it was.
        about_x = math.radians(before[0])
    else:
        about_x = math.atan2(m[2][1], m[2][2])
    s, c = math.sin(about_x), math.cos(about_x)
    x = math.degrees(about_x)
    y = math.degrees(math.atan2(-m[2][0], math.hypot(m[0][0], m[1][0])))
    # This turn compensates for any turn about x.
    z = math.degrees(math.atan2(s * m[0][2] - c * m[0][1], c * m[1][1] - s * m[1][2]))
    angles = []
    for triple in ((x, y, z), (x + 180.0, 180.0 - y, z + 180.0)):
        near = [v + 360.0 * round((b - v) / 360.0) for v, b in zip(triple, before)]
        angles.append((sum(abs(v - b) for v, b in zip(near, before)), near))
    best = min(angles)[1]
    return (best[0], best[1], best[2])


def palm_frame(
    places: Sequence[Sequence[Vector]], fingers: Sequence[int], side: str, up: Vector
) -> Rows:
    """Rows of the matrix whose columns are the axes of a rig's palm in the rig's world.

    x points across the palm, towards the little finger of a right hand or the thumb of a left hand;
    y along the fingers; z out of the back of the hand.

    Args:
        places: Positions of the joints of every chain, from the palm outwards.
        fingers: Finger of each chain, thumb 0 .. little 4.
        side: `right` or `left`.
        up: Direction of the back of the hand, used if the chains do not determine it.
    """
    long = sorted((f, list(p)) for f, p in zip(fingers, places) if f > 0)
    long = long or sorted((f, list(p)) for f, p in zip(fingers, places))
    along: Vector = (0.0, 0.0, 0.0)
    for _, chain in long:
        along = plus(along, minus(chain[-1], chain[0]))
    along = normal(along)
    across = times(minus(long[-1][1][0], long[0][1][0]), -1.0 if side == "left" else 1.0)
    if length(cross(across, along)) < 1e-6:
        # One chain does not determine the back of a hand.
        other = up if abs(dot(up, along)) < 0.9 else (up[2], up[0], up[1])
        across = cross(along, other)
    back = normal(cross(across, along))
    x = cross(along, back)
    return [[x[i], along[i], back[i]] for i in range(3)]


def into(frame: Rows, origin: Vector, place: Vector) -> Vector:
    """Converts a place to a frame with the given origin, whose axes are the columns of a matrix."""
    d = minus(place, origin)
    return (
        sum(frame[i][0] * d[i] for i in range(3)),
        sum(frame[i][1] * d[i] for i in range(3)),
        sum(frame[i][2] * d[i] for i in range(3)),
    )


LONGEST = 4096
FARTHEST = 1000.0  # m
BONES = 64


class Line:
    """One line of the stream; `kind` is moment, rig or stop."""

    def __init__(self, text: str) -> None:
        if len(text) >= LONGEST or not re.match(r"hs1( [A-Za-z0-9_.\-]+)+\Z", text):
            raise Refused("not a line of Hand Sandbox")
        words = text.split(" ")
        self.run, self.side, self.kind = "", "", ""
        self.time = 0.0
        self.place: Vector = (0.0, 0.0, 0.0)
        self.turn: Quaternion = (1.0, 0.0, 0.0, 0.0)
        # By finger: vector to the tip / length, direction in which it bulges, length (m).
        self.chains: Dict[int, Tuple[Vector, Vector, float]] = {}
        self.turns: Dict[int, Quaternion] = {}
        self.bones: List[Tuple[str, int, Vector, Quaternion]] = []
        self.ends: Dict[int, Vector] = {}
        try:
            self.run, self.side, self.kind = words[1], words[2], words[3]
            if self.kind == "rig":
                self._rig(words[4:])
            elif self.kind != "stop":
                self.kind = "moment"
                self._moment(words[3:])
            elif len(words) > 4:
                raise ValueError("words after stop")
        except (ValueError, IndexError) as error:
            raise Refused("the line is incomplete or damaged: %s" % error) from None

    def _moment(self, words: List[str]) -> None:
        self.time = _finite(words[1:2], 1)[0]
        if words[2] != "p" or int(words[0]) < 0 or not 0.0 <= self.time < 1e7:
            raise ValueError("not a moment")
        n = _finite(words[3:10], 7)
        self.place, self.turn = _vector(n[:3], FARTHEST), unit(n[3:])
        at = 10
        while at < len(words):
            if words[at] == "c":
                n, finger = _finite(words[at + 2 : at + 9], 7), int(words[at + 1])
                if not (0 <= finger < 5 and 1e-3 < n[6] < 10.0):
                    raise ValueError("not a finger")
                self.chains[finger] = (_vector(n[:3], 1.001), _vector(n[3:6], 1.001), n[6])
                at += 9
            elif words[at] == "j":
                joint = int(words[at + 1])
                if not 0 <= joint < BONES:
                    raise ValueError("not a joint")
                self.turns[joint] = unit(_finite(words[at + 2 : at + 6], 4))
                at += 6
            else:
                raise ValueError("an unknown word")

    def _rig(self, words: List[str]) -> None:
        at = 0
        while at < len(words):
            if words[at] == "b":
                n, parent = _finite(words[at + 3 : at + 10], 7), int(words[at + 2])
                if not -1 <= parent < len(self.bones) < BONES or (parent < 0) == bool(self.bones):
                    raise ValueError("not a tree of joints")
                self.bones.append((words[at + 1], parent, _vector(n[:3], FARTHEST), unit(n[3:])))
                at += 10
            elif words[at] == "e":
                joint = int(words[at + 1])
                if not 0 <= joint < len(self.bones):
                    raise ValueError("a fingertip of an unknown joint")
                self.ends[joint] = _vector(_finite(words[at + 2 : at + 5], 3), FARTHEST)
                at += 5
            else:
                raise ValueError("an unknown word")


def _finite(words: Sequence[str], count: int) -> List[float]:
    numbers = [float(word) for word in words]
    if len(numbers) != count or not all(math.isfinite(v) for v in numbers):
        raise ValueError("not the expected numbers")
    return numbers


def _vector(numbers: Sequence[float], longest: float) -> Vector:
    vector: Vector = (numbers[0], numbers[1], numbers[2])
    if length(vector) > longest:
        raise ValueError("too far away")
    return vector
