"""Adapts an intended hand pose to the screen: wrist, touching fingers, lifted fingers.

The wrist is placed first, so that the middle of the used fingertips is at its target, and the
touching fingertips are at the screen in the mean. Then every finger reaches for a point on the
screen. This point has to be inside the screen's edge, clear of neighbouring fingers, and within the
ranges of the joints. These constraints are met one after the other in a few rounds (alternating
projections). A finger that cannot reach its point touches elsewhere. Lifted fingers follow simple
rules.

A finger reaches by inverse kinematics: a planar chain with coupled joints, solved in closed form
except for one root. The sideways swing puts the finger's plane through the target. In this plane,
the distance from knuckle to fingertip depends only on the middle joint, because the last joint
follows it. The distance grows as the joint stretches, so the middle joint is found by bisection.
The knuckle then turns the finger to the target. (If its last joint is bent backwards, a finger is
longest just before it is straight, by half a millimetre.) The joints are then clamped to their
ranges, so a finger points towards a target that it cannot reach.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.frames import FINGERS
from models.surface import Surface
from training.second_subject.configuration import SecondConfiguration
from training.second_subject.hand import FIRST, LAST, SECOND, SWING, TENDON, SecondHand, attitude

_ROUNDS = 6
"""Number of rounds in which all constraints on the touches are met."""

_SETTLINGS = 3
"""Number of rounds in which the wrist is raised or lowered so that the fingers reach the screen."""

_STEADY = 0.015
"""Strength of the penalty in `_levelling`, as a standard deviation (m). If the fingertips spread by
this much in a direction, the palm takes half of the slope of their plane in that direction."""

_MARGIN = 0.007
"""Least distance (m) of a fingertip from the screen's edge. The finger's pad touches beside the
fingertip, and this touch must also be on the screen."""

_NEIGHBOURS = np.array(
    [
        [0, 1, 0, 0, 0],
        [0.3, 0, 1, 0.3, 0],
        [0, 1, 0, 1, 0.3],
        [0, 0.3, 1, 0, 1],
        [0, 0, 0.3, 1, 0],
    ]
)
"""Coupling of each finger (row) to each other finger."""


@dataclass(frozen=True)
class MovementPlan:
    """The intended movement of the hand, before the screen is considered; one row per frame.

    Attributes:
        angles: (n, 5, 5) rad, angles of the grip.
        yaw: (n,) rad, yaw of the hand.
        pitch: (n,) rad, fingers up.
        roll: (n,) rad, little finger down.
        height: (n,) m, height of the palm above the height that follows from the grip alone.
        middle: (n, 2) m, target of the middle of the used fingertips.
        used: (n, 5) booleans, fingers that touch at some time of the take.
        close: (n, 5) 1 while a finger touches, 0 while it is fully lifted.
        lift: (n, 5) rad, angle by which a lifted finger is raised.
        curl: (n, 5) booleans, true if a lifted finger is raised by curling.
        coupling: (n, 5) share of its neighbours' bend that a lifted finger follows.
    """

    angles: Array
    yaw: Array
    pitch: Array
    roll: Array
    height: Array
    middle: Array
    used: NDArray[np.bool_]
    close: Array
    lift: Array
    curl: NDArray[np.bool_]
    coupling: Array

    @staticmethod
    def joined(parts: list[MovementPlan]) -> MovementPlan:
        """Concatenates all takes of a day."""
        return MovementPlan(
            *(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(MovementPlan))
        )


def place(
    plan: MovementPlan, hand: SecondHand, surface: Surface, c: SecondConfiguration
) -> tuple[Array, Array, Array]:
    """Positions (n, 3) m and rotations (n, 3, 3) of the wrist, and angles (n, 5, 5) of the
    fingers."""
    in_palm = hand.tips_in_palm(plan.angles)
    down, up = _levelling(in_palm, plan.close)
    pitch, roll = plan.pitch + c.level * up, plan.roll + c.level * down
    root = np.empty((len(pitch), 3))
    for _ in range(_SETTLINGS):
        turn = attitude(plan.yaw, pitch, roll)
        tips = (turn[:, None] @ in_palm[..., None])[..., 0]
        root[:, 2] = c.tip_height + plan.height - _mean(tips, plan.close)[:, 2]
        pitch = pitch - np.maximum(c.wrist - root[:, 2], 0.0) / _mean(in_palm, plan.close)[:, 1]
    root[:, :2] = _middle(tips, plan, surface) - _mean(tips[..., :2], plan.used)
    goals = tips + root[:, None]
    for _ in range(_SETTLINGS):
        touching, off = _touching(goals, root, turn, plan, hand, surface, c)
        root[:, 2] -= (off * plan.close).sum(axis=1) / plan.close.sum(axis=1)
    touching, _ = _touching(goals, root, turn, plan, hand, surface, c)
    lifted = _lifted(touching, root, turn, plan, hand, c)
    share = plan.close[..., None]
    return root, turn, share * touching + (1 - share) * lifted


def _levelling(tips: Array, close: Array) -> tuple[Array, Array]:
    """Roll (n,) and pitch (n,) rad that would bring the touching fingertips to the same height.

    Fits a plane to the fingertips (n, 5, 3) m in the hand frame, by least squares with a penalty on
    its slope, so that two fingers side by side do not turn the palm on edge.
    """
    flat = tips - _mean(tips, close)[:, None]
    weighted = flat * close[..., None]
    spread = np.swapaxes(weighted[..., :2], 1, 2) @ flat[..., :2]
    spread += close.sum(axis=1)[:, None, None] * _STEADY**2 * np.eye(2)
    rise = np.swapaxes(weighted[..., :2], 1, 2) @ flat[..., 2:]
    slope = np.linalg.solve(spread, rise)[..., 0]
    return np.arctan(slope[:, 0]), -np.arctan(slope[:, 1])


def _mean(values: Array, weights: NDArray[np.generic]) -> Array:
    """Mean (n, d) of (n, 5, d) with weights (n, 5)."""
    w = np.asarray(weights, float)[..., None]
    return np.asarray((values * w).sum(axis=1) / w.sum(axis=1))


def _middle(tips: Array, plan: MovementPlan, surface: Surface) -> Array:
    """Target (n, 2) m of the middle of the used fingertips, moved so that they are all on the
    screen."""
    flat = tips[..., :2] - _mean(tips[..., :2], plan.used)[:, None]
    used = plan.used[..., None]
    low = np.where(used, flat, np.inf).min(axis=1)
    high = np.where(used, flat, -np.inf).max(axis=1)
    least = np.array([0, -surface.size[1]]) + _MARGIN - low
    most = np.array([surface.size[0], 0]) - _MARGIN - high
    fits = least <= most
    return np.where(fits, np.clip(plan.middle, least, np.maximum(least, most)), (least + most) / 2)


def _touching(
    goals: Array,
    root: Array,
    turn: Array,
    plan: MovementPlan,
    hand: SecondHand,
    surface: Surface,
    c: SecondConfiguration,
) -> tuple[Array, Array]:
    """Angles (n, 5, 5) with all fingertips on the screen, and their remaining distances (n, 5) m
    from it."""
    spots, angles = goals.copy(), plan.angles
    for _ in range(_ROUNDS):
        spots = _apart(spots, turn, c.tip_width)
        spots[..., 0] = np.clip(spots[..., 0], _MARGIN, surface.size[0] - _MARGIN)
        spots[..., 1] = np.clip(spots[..., 1], _MARGIN - surface.size[1], -_MARGIN)
        spots[..., 2] = c.tip_height
        in_palm = ((spots - root[:, None])[:, :, None] @ turn[:, None])[:, :, 0]
        angles = reach(hand, in_palm, angles)
        spots = (turn[:, None] @ hand.tips_in_palm(angles)[..., None])[..., 0] + root[:, None]
    return angles, spots[..., 2] - c.tip_height


def _apart(spots: Array, turn: Array, width: float) -> Array:
    """Points (n, 5, 3) m, moved so that fingers do not overlap.

    Fingers move sideways across the hand, and so stay in their anatomical order. The thumb stays
    behind a parabola about each fingertip, so that it never jumps to the other side of a fingertip.
    """
    out = spots.copy()
    across, back = turn[:, :2, 0], -turn[:, :2, 1]
    for finger in range(1, len(FINGERS) - 1):
        between = out[:, finger + 1, :2] - out[:, finger, :2]
        side = (between * across).sum(axis=1)
        ahead = (between * back).sum(axis=1)
        short = np.sqrt(np.maximum(width**2 - ahead**2, 0.0)) - side
        step = 0.5 * np.maximum(short, 0.0)[:, None] * across
        out[:, finger, :2] -= step
        out[:, finger + 1, :2] += step
    for finger in range(1, len(FINGERS)):
        between = out[:, 0, :2] - out[:, finger, :2]
        side = (between * across).sum(axis=1)
        ahead = (between * back).sum(axis=1)
        short = width - side**2 / width - ahead
        out[:, 0, :2] += np.maximum(short, 0.0)[:, None] * back
    return out


def _lifted(
    touching: Array,
    root: Array,
    turn: Array,
    plan: MovementPlan,
    hand: SecondHand,
    c: SecondConfiguration,
) -> Array:
    """Angles (n, 5, 5) rad of fingers while they are lifted.

    A lifted finger follows its grip and, to a part, the changes that the screen causes in the bend
    of neighbouring fingers. If it does not clear the screen, it is raised further, by at most 70
    degrees and within the ranges of its joints.
    """
    low, high = hand.reach_limits
    ties = _NEIGHBOURS * plan.close[:, None, :]
    ties = ties / np.maximum(ties.sum(axis=2, keepdims=True), 1.0)
    drawn = plan.coupling[..., None] * (ties @ (touching - plan.angles))
    out = plan.angles.copy()
    out[..., SWING] += 0.5 * drawn[..., SWING]
    out[..., FIRST] += drawn[..., FIRST]
    out[..., SECOND] += drawn[..., SECOND]
    out[..., FIRST] -= np.where(plan.curl, 0.3, 1.0) * plan.lift
    out[..., SECOND] += np.where(plan.curl, 0.8, -0.4) * plan.lift
    out = np.clip(out, low, high)
    up = np.zeros((5, 5))
    up[:, FIRST], up[1:, SECOND], up[0, SWING] = -1.0, -0.6, -0.6
    least, most = np.zeros(out.shape[:2]), np.full(out.shape[:2], np.deg2rad(70))
    enough = _height(out, root, turn, hand) >= c.tip_height + c.clearance
    for _ in range(9):
        middle = 0.5 * (least + most)
        tried = np.clip(out + middle[..., None] * up, low, high)
        clears = _height(tried, root, turn, hand) >= c.tip_height + c.clearance
        least, most = np.where(clears, least, middle), np.where(clears, middle, most)
    further = np.where(enough, 0.0, most)
    return np.clip(out + further[..., None] * up, low, high)


def _height(angles: Array, root: Array, turn: Array, hand: SecondHand) -> Array:
    """Heights (n, 5) m of the fingertips above the screen."""
    return np.asarray(np.einsum("nj,nfj->nf", turn[:, 2], hand.tips_in_palm(angles)) + root[:, 2:])


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
