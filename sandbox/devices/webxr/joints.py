"""Hands from the messages of a headset's page: 25 joints (WebXR), or a controller.

A controller's grip places the palm, and its trigger closes a pinch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import cos, dist, radians, sin, sqrt

import numpy as np

from encoders.air.joint_fit import (
    KNUCKLES,
    THUMB,
    TIPS,
    WRIST,
    JointFit,
    JointFitSettings,
    JointPoints,
)
from encoders.air.joint_fit import PALM as PALM_POINTS
from encoders.paalm.hand_pose import PALM_CENTRE
from models.arithmetic import Array, small_product, total
from models.errors import FrameError
from models.frames import TrackedFinger, TrackedHand, Vector
from models.plausible import DISTANCE, FINGER_AT_ONCE, PALM, PALM_AT_ONCE, Bounds
from models.pose import POSE_SIZE
from models.rotations import quaternion_to_matrix
from models.skeleton import ADULT
from sandbox.server.protocol import JOINTS_OF_A_HAND, HeldController, SeenJoints

Places = tuple[Vector | None, ...]

FINGER_JOINTS = (
    (1, 2, 3, 4),
    (6, 7, 8, 9),
    (11, 12, 13, 14),
    (16, 17, 18, 19),
    (21, 22, 23, 24),
)
"""Indices of the joints of each finger in WebXR's order, from base to tip. The thumb begins with
its metacarpal joint (CMC), a finger with its phalanx-proximal joint (MCP)."""
_KNUCKLES = tuple(joints[0] for joints in FINGER_JOINTS[1:])
_LEAST = 1e-6
"""Smallest length (m) of a bone."""


def quantities(seen: SeenJoints) -> dict[Bounds, float]:
    """Returns the size of the palm in the page's unit; empty if it is unknown."""
    known = [joint for joint in (seen.joints[0], seen.joints[_KNUCKLES[1]]) if joint is not None]
    numbers = [c for joint in known for c in joint if c is not None]
    return {PALM: dist(numbers[:3], numbers[3:])} if len(numbers) == 6 else {}


def seen_hand(seen: SeenJoints, metre: float = 1.0) -> TrackedHand | None:
    """Returns the hand of 25 joints, with the fingers of which all joints are known.

    Returns None if the wrist or one of the four knuckles is unknown: they determine the palm.

    Args:
        seen: The joints.
        metre: Unit of the joints' positions, m.

    Raises:
        FrameError: The joints are not those of a hand.
    """
    return _hand(seen.side, tuple(_place(joint, metre) for joint in seen.joints))


def with_possible_fingers(hand: TrackedHand) -> TrackedHand:
    """Returns the hand without fingers of an impossible length.

    Raises:
        FrameError: The palm has an impossible size.
    """
    known = {finger.finger: finger.joints for finger in hand.fingers}
    middle = known.get(2)
    if hand.wrist and middle and not PALM_AT_ONCE.includes(dist(hand.wrist, middle[0])):
        raise FrameError("hands whose palm is of a size that no hand has", where="headset")
    fingers = tuple(f for f in hand.fingers if FINGER_AT_ONCE.includes(f.length))
    return hand if len(fingers) == len(hand.fingers) else replace(hand, fingers=fingers)


def _place(joint: Sequence[float | None] | None, metre: float = 1.0) -> Vector | None:
    """Returns the position of a joint, m; None if it is not reported or impossibly far away."""
    x, y, z = joint or (None, None, None)
    if x is None or y is None or z is None:
        return None
    farthest = metre * max(abs(x), abs(y), abs(z))
    return _times(metre, (x, y, z)) if DISTANCE.includes(farthest) else None


def held_hand(held: HeldController) -> TrackedHand:
    """Returns the hand around a controller.

    Raises:
        FrameError: The position is missing or impossible, or the quaternion is not a unit
            quaternion.
    """
    position, trigger = _place(held.position), held.trigger or 0.0
    if position is None:
        raise FrameError("no place", where="controller", got=held.position)
    quaternion = np.array(held.quaternion, float)
    size = sqrt(float((quaternion * quaternion).sum()))
    if not abs(size - 1.0) <= _UNIT:
        raise FrameError("not a unit quaternion", where="controller", got=held.quaternion)
    pulled = min(max(trigger, 0.0), 1.0)
    points = controller_points(held.side, pulled, np.array(position), quaternion / size)
    places: list[Vector | None] = [None] * JOINTS_OF_A_HAND
    places[0] = _vector(points[WRIST])
    for finger, joints in enumerate(FINGER_JOINTS):
        first = THUMB if finger == 0 else KNUCKLES[finger - 1]
        own = [*points[first : first + (2 if finger == 0 else 3)], points[TIPS + finger]]
        if finger == 0:
            # The thumb of this program's skeleton has no IP joint.
            own.insert(2, 0.5 * (own[1] + own[2]))
        for joint, point in zip(joints, own, strict=True):
            places[joint] = _vector(point)
    hand = _hand(held.side, tuple(places))
    assert hand is not None
    return hand


_UNIT = 1e-3
"""Tolerance for the length of a unit quaternion."""
_CENTRE = np.array([-0.038, 0.047, -0.055]) + PALM_CENTRE
"""Point (3,) m in the hand's frame, at which the tips meet."""
_AXIS = radians(52.0)
"""Direction (rad from x, in the palm's plane) from the thumb's tip to the fingertips. The resting
thumb of `models.skeleton` faces in this direction."""
_PITCH = 0.019
"""Distance (m) between the tips of index and middle finger."""
_OPEN, _CLOSED = 0.085, 0.010
"""Distance (m) between the centre of the thumb's tip and the middle between the fingertips."""
_BENT = JointFitSettings(free=25.0, steps=40)
"""Settings of the fit. Joints that the tips do not determine stay near the middle of their
ranges."""
_GRIP = {
    "right": np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]),
    "left": np.array([[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]),
}
"""Matrix from the frame of a right hand to the frame of a grip; the matrix of a left grip also
mirrors. WebXR's grip: x points out of the back of a right hand and into the back of a left hand, -z
towards the thumb of a closed hand. The fingers of an open hand then point along -y."""


def controller_points(side: str, trigger: float, position: Array, quaternion: Array) -> Array:
    """(20, 3) m, points of the hand around a controller, in the frame in which its grip is given.

    Controllers do not sense fingers. The points are those of an average hand between an open and a
    closed pinch of thumb, index and middle finger, according to the trigger.

    Args:
        side: `right` or `left`.
        trigger: 0 (open) to 1 (closed).
        position: (3,) m of the grip.
        quaternion: (4,) w, x, y, z of the grip.
    """
    opened, closed = _pinching(_OPEN), _pinching(_CLOSED)
    q = opened + trigger * (closed - opened)
    own = JointPoints(ADULT).points(q) - PALM_CENTRE
    turned = small_product(own, small_product(quaternion_to_matrix(quaternion), _GRIP[side]).T)
    return position + turned


@cache
def _pinching(gap: float) -> Array:
    """The pose (48,) of a hand that pinches with a gap (m) between thumb and fingers."""
    points = JointPoints(ADULT).points(np.zeros(POSE_SIZE))
    wanted = np.full(points.shape, np.nan)
    wanted[list(PALM_POINTS)] = points[list(PALM_POINTS)]
    # Ring and little finger stay at rest.
    for place in (*range(KNUCKLES[2], TIPS), TIPS + 3, TIPS + 4):
        wanted[place] = points[place]
    axis = np.array([cos(_AXIS), sin(_AXIS), 0.0])
    beside = 0.5 * _PITCH * np.array([sin(_AXIS), -cos(_AXIS), 0.0])
    wanted[TIPS] = _CENTRE - 0.5 * gap * axis
    wanted[TIPS + 1] = _CENTRE + 0.5 * gap * axis - beside
    wanted[TIPS + 2] = _CENTRE + 0.5 * gap * axis + beside
    fit = JointFit(ADULT, _BENT).fit(wanted)
    assert fit is not None
    return fit.pose


def _hand(side: str, joints: Places) -> TrackedHand | None:
    wrist = joints[0]
    knuckles = [joints[k] for k in _KNUCKLES]
    known = [k for k in knuckles if k is not None]
    if wrist is None or len(known) < len(knuckles):
        return None
    middle = _mean(known)
    across = _unit(_from(known[0], known[-1]))
    forward = _unit(_from(wrist, middle))
    # For a right hand, `forward` x `across` points out of the palm: its little finger is at +x.
    normal = _cross(across, forward)
    normal = _unit(normal if side == "left" else _times(-1.0, normal))
    fingers = []
    for finger, places in enumerate(FINGER_JOINTS):
        own = [joint for joint in (joints[p] for p in places) if joint is not None]
        if len(own) == len(places):
            fingers.append(_finger(finger, own))
    return TrackedHand(
        0 if side == "right" else 1,
        _mean([wrist, *known]),
        normal,
        forward,
        tuple(fingers),
        side,
        wrist=wrist,
    )


def _finger(finger: int, joints: list[Vector]) -> TrackedFinger:
    bones = [_from(a, b) for a, b in pairwise(joints)]
    knuckle, pip, dip, tip = joints
    return TrackedFinger(
        finger,
        tip,
        _unit(bones[-1]),
        total(_size(bone) for bone in bones),
        finger,
        (knuckle, pip, dip, tip),
    )


def _from(a: Vector, b: Vector) -> Vector:
    return b[0] - a[0], b[1] - a[1], b[2] - a[2]


def _times(factor: float, v: Vector) -> Vector:
    return factor * v[0], factor * v[1], factor * v[2]


def _mean(points: list[Vector]) -> Vector:
    x, y, z = (total(p[i] for p in points) / len(points) for i in range(3))
    return x, y, z


def _size(v: Vector) -> float:
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


def _unit(v: Vector) -> Vector:
    size = _size(v)
    if size < _LEAST:
        raise FrameError("the joints of a hand lie on each other", where="headset", got=v)
    return _times(1.0 / size, v)


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _vector(point: np.ndarray) -> Vector:
    x, y, z = point.tolist()
    return x, y, z
