"""Inverse kinematics of one finger: a planar chain with coupled joints, solved in closed form
except for one root.

The sideways swing puts the finger's plane through the target. In this plane, the distance from
knuckle to fingertip depends only on the middle joint, because the last joint follows it. The
distance grows as the joint stretches, so the middle joint is found by bisection. The knuckle then
turns the finger to the target. (If its last joint is bent backwards, a finger is longest just
before it is straight, by half a millimetre.) The joints are then clamped to their ranges, so a
finger points towards a target that it cannot reach.
"""

from __future__ import annotations

import numpy as np

from models.arithmetic import Array
from training.second_subject.hand import FIRST, LAST, SECOND, SWING, TENDON, SecondHand

_HALVINGS = 16
"""Number of bisections, which divide a range of 90 degrees to a thousandth of a degree."""

_AHEAD = 0.01
"""Least distance (m) of a target in front of the knuckle, since a finger does not bend
backwards."""


def reach(hand: SecondHand, targets: Array, start: Array) -> Array:
    """`ANGLES` (n, 5, 5) with which the fingertips come as near to targets as the joints allow.

    Args:
        hand: The hand.
        targets: (n, 5, 3) m, in the hand frame.
        start: (n, 5, 5) angles. `roll` and `last` do not change; the other angles are computed.
    """
    low, high = hand.reach_limits
    local = np.einsum("fji,nfj->nfi", hand.saddle, targets - hand.knuckle)
    ahead = np.maximum(local[..., 1], _AHEAD)
    out = start.copy()
    out[..., SWING] = np.clip(np.arctan2(-local[..., 0], ahead), low[:, SWING], high[:, SWING])
    # After clamping, use the target's projection on the reachable plane.
    forward = -local[..., 0] * np.sin(out[..., SWING]) + ahead * np.cos(out[..., SWING])
    down = -local[..., 2]
    span = np.hypot(forward, down)
    near, far = (np.broadcast_to(limit[:, SECOND], span.shape) for limit in (low, high))
    straight, bent = near.copy(), far.copy()
    for _ in range(_HALVINGS):
        middle = 0.5 * (straight + bent)
        along, across = _chord(hand, middle, out[..., LAST])
        too_long = np.hypot(along, across) > span
        straight = np.where(too_long, middle, straight)
        bent = np.where(too_long, bent, middle)
    out[..., SECOND] = 0.5 * (straight + bent)
    along, across = _chord(hand, out[..., SECOND], out[..., LAST])
    first = np.arctan2(down, forward) - np.arctan2(across, along) + hand.zero[:, 0]
    out[..., FIRST] = np.clip(first, low[:, FIRST], high[:, FIRST])
    return out


def _chord(hand: SecondHand, second: Array, last: Array) -> tuple[Array, Array]:
    """Position (m) of the fingertip along and across the first bone, for a flexion of the middle
    joint."""
    third = second + TENDON * second + last
    along = hand.bones[:, 0] + hand.bones[:, 1] * np.cos(second) + hand.bones[:, 2] * np.cos(third)
    across = hand.bones[:, 1] * np.sin(second) + hand.bones[:, 2] * np.sin(third)
    return along, across
