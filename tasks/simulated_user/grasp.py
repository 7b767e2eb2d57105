"""Grasp planning of the simulated user: positions of thumb and fingers on a box or a handle.

`roomiest_grasp` chooses a grasp with room for the fingers between neighbours and at the goal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from math import cos, sin, tan

import numpy as np

from models.arithmetic import Array
from models.objects import Box, Wrench
from models.surface import Surface
from tasks.simulated_user.user_hand import Hand, beyond_border
from tasks.user import SeenObject

_TIP_RADIUS = 0.007
"""Radius (m) of a fingertip that the user assumes."""
_HOLDS = 0.001
"""Largest distance (m) by which an inner finger of the row is farther from the thumb than the
outermost fingers once the hand has closed. The inner fingers bend until they press as well."""
_CLEAR, _CLEAR_OF_HANDLE = 0.005, 0.0086
"""Clearances (m per side) by which a hand has to be wider than a box or a handle, so that no finger
comes down inside it. A row of fingers beside a handle is seldom quite parallel to it."""

_LEAN = float(np.deg2rad(20.0))
"""Largest angle (rad) between the line from thumb to fingers and the normal of a box's faces. Up to
it, friction still holds the box. The wrist has to turn less by this angle."""
_COMFORT = float(np.deg2rad(95.0))
"""Limit (rad from the natural axis) of the wrist's rotation while carrying."""
_FARTHEST = float(np.deg2rad(100.0))
"""Limit (rad from the natural axis) of the wrist's rotation."""
_OBLIQUE, _SIDESTEP = float(np.deg2rad(60.0)), 0.025
"""Rotation (rad from the natural axis) beyond which the thumb is shifted along the handle, and the
largest shift (m). With the shift, the hand rotates less than the handle requires."""
_COUPLE = 0.018
"""Distance (m) along a handle from the thumb to a single finger. A handle between a thumb and a
directly opposite finger would slip about the line between them instead of turning with the hand."""


@dataclass(frozen=True)
class Grasp:
    """A pinch across a box or a handle.

    Attributes:
        axis: Direction (rad) from thumb to fingers in the world.
        width: Distance (m) between the two faces.
        fingers: Number of touching fingers including the thumb, limited by the room on the faces.
        grip: Position (m) of the middle of the pinch along the object's x axis, from its middle.
        side: Direction (rad) from thumb to fingers relative to the object's x axis.
        skew: Shift (m) of the thumb along the face, from the point opposite the fingers' middle.
        clear: Clearance (m per side) by which the hand has to be wider than the object.
    """

    axis: float
    width: float
    fingers: int
    grip: float = 0.0
    side: float = 0.0
    skew: float = 0.0
    clear: float = _CLEAR

    def axis_on(self, yaw: float) -> float:
        """Axis (rad) of this grasp once the object has turned to a yaw (rad)."""
        return yaw + self.side

    def middle(self, seen: SeenObject) -> Array:
        """Position (2,) m, in the world, of the middle of the pinch on an object."""
        if not self.grip:
            return np.array(seen.position[:2])
        return np.asarray(seen.position[:2] + self.grip * seen.rotation[:2, 0])

    def opening(self, hand: Hand) -> float:
        """Distance (m) from the faces at which the fingertips come down. The hand opens no wider
        than is easy, unless the object requires it."""
        c = hand.configuration
        easy = 0.5 * (c.easy_opening * c.hand_size - self.width) - _TIP_RADIUS
        return min(max(easy, self.clear), c.opening)

    def places(self, centre: Array, gap: float, hand: Hand) -> Array:
        """Positions (fingers, 2) m of the fingertips, thumb first.

        Args:
            centre: (2,) m, the middle of the pinch.
            gap: Distance (m) of thumb and outermost fingers from the faces; negative for fingers
                that press, whose positions are inside the object. The inner fingers are farther out
                because the row is an arc.
            hand: The user's hand.
        """
        along = np.array([cos(self.axis), sin(self.axis)])
        across = np.array([along[1], -along[0]])
        c = hand.configuration
        # At most the span of a real hand.
        reach = min(self.width / 2 + _TIP_RADIUS + gap, 0.5 * c.longest_span * c.hand_size)
        # The row begins with the index finger. It is leftmost if the thumb is at the lower left.
        row = hand.row(self.fingers)
        farther = row[:, 1:] if gap >= 0.0 else np.minimum(row[:, 1:], _HOLDS)
        fingers = centre + (reach + farther) * along + row[:, :1] * across
        if self.skew:
            fingers = fingers - 0.5 * self.skew * across
            centre = centre + 0.5 * self.skew * across
        return np.vstack([centre - reach * along, fingers])


def grasp_across(axis: float, width: float, face: float, hand: Hand) -> Grasp:
    """A grasp of a box across two of its faces.

    If the wrist would have to turn, the thumb is shifted along its face as far as there is room, so
    that the wrist turns less.

    Args:
        axis: Direction (rad) across the faces, away from the thumb.
        width: Distance (m) from face to face.
        face: Length (m) of the faces.
        hand: The user's hand.
    """
    fingers = hand.fitting(face)
    lean = float(np.clip(wrapped(axis - hand.configuration.natural_axis), -_LEAN, _LEAN))
    room = hand.room(face, fingers)
    skew = float(np.clip(-tan(lean) * (width + _TIP_RADIUS), -room, room))
    return Grasp(axis, width, fingers, skew=skew)


def choose_grasp(box: SeenObject, turn: float, hand: Hand) -> Grasp:
    """Chooses the pair of faces that is most comfortable at the start and the end of a turn.

    Args:
        box: The box as seen.
        turn: Turn (rad) that the box is to make.
        hand: The hand of the user whose comfort counts.
    """
    assert isinstance(box.shape, Box)
    natural = hand.natural_axis
    half = box.shape.half_size
    options = []
    for quarter in range(4):
        axis = box.yaw + quarter * np.pi / 2
        start, end = axis - natural, axis + turn - natural
        worst = max(abs(wrapped(start)), abs(wrapped(end)))
        width, face = (half[0], half[1]) if quarter % 2 == 0 else (half[1], half[0])
        options.append((worst, quarter, grasp_across(axis, 2 * width, 2 * face, hand)))
    return min(options, key=lambda o: o[:2])[2]


def choose_handle_grasp(
    seen: SeenObject, turn: float, grip: float, hand: Hand, failed: float | None = None
) -> Grasp:
    """Chooses the side of a handle for the thumb that allows the largest comfortable turn.

    Args:
        seen: The wrench as seen.
        turn: Turn (rad) that the wrench is to make.
        grip: Position (m) along the handle, from the object's middle, where the fingers close.
        hand: The hand of the user whose comfort counts.
        failed: Side (rad) of a grasp that has just failed. The other side is chosen if the wrist
            can reach it.
    """
    assert isinstance(seen.shape, Wrench)
    near, far = seen.shape.handle
    # Room for the fingers' middles, such that the outermost fingers have whole pads on the handle.
    room = max(far - near - 0.011, 0.0)
    fingers = hand.within(room)
    others = hand.length(fingers)
    options = []
    for number, side in enumerate((np.pi / 2, -np.pi / 2)):
        axis = seen.yaw + side
        start = abs(wrapped(axis - hand.natural_axis))
        made = within_comfort(axis, turn, hand)
        end = abs(wrapped(axis + made - hand.natural_axis))
        # The rest of the turn needs another grasp. To avoid it, some discomfort is accepted.
        cost = max(start, end) + 2.0 * (abs(turn) - abs(made))
        if start > _FARTHEST:
            cost += 100.0
        if side == failed:
            cost += 50.0
        # With one finger against the thumb, the handle begins to turn in the intended direction.
        skew = float(np.copysign(_COUPLE, turn)) if fingers == 2 else 0.0
        if fingers > 2 and start > _OBLIQUE:
            skew = -float(np.copysign(_SIDESTEP, wrapped(axis - hand.natural_axis)))
        # All fingers stay on the handle. Without enough room, the thumb comes nearer to the
        # fingers.
        free = max(min(room, 2 * (grip - near - 0.008)) - others, 0.0)
        skew = float(np.clip(skew, -free, free))
        span = 0.5 * (others + abs(skew))
        at = float(np.clip(grip, near + 0.008 + span, far - 0.003 - span))
        width = seen.shape.handle_width
        grasp = Grasp(axis, width, fingers, at, side, skew, _CLEAR_OF_HANDLE)
        options.append((cost, number, grasp))
    return min(options, key=lambda o: o[:2])[2]


def within_comfort(axis: float, turn: float, hand: Hand) -> float:
    """Part (rad) of a turn that a hand can make without regrasping.

    A hand that is already rotated too far may always turn back.

    Args:
        axis: Current direction (rad) from thumb to fingers.
        turn: Wanted turn (rad).
        hand: The user's hand.
    """
    now = wrapped(axis - hand.natural_axis)
    low, high = min(-_COMFORT, now), max(_COMFORT, now)
    return float(np.clip(now + turn, low, high) - now)


def wrapped(angle: float) -> float:
    """Wraps an angle (rad) to -pi to pi."""
    return float((angle + np.pi) % (2 * np.pi) - np.pi)


_ROOM = 0.014
"""Least distance (m) of the middle of a fingertip from a neighbour's face."""
_CROWDED = 150.0
"""Rotation of the wrist (rad) that costs as much as one metre of missing room."""
_AGAIN = 2.0
"""Additional rotation (rad) of the wrist that costs as much as repeating a failed grasp."""
_LINK = ((0.010, 0.010), (0.018, 0.020))
"""Points of a finger behind its tip: distances (m) from the fingertip towards the palm, and
upwards. The finger leans over objects on the side of the palm."""


@dataclass(frozen=True)
class Surroundings:
    """The surroundings of a box to grasp, as the user sees them.

    Attributes:
        surface: The area that fingers can touch.
        neighbours: The other objects.
        goal: (2,) m, goal of the box; None to ignore the goal.
    """

    surface: Surface
    neighbours: tuple[SeenObject, ...] = ()
    goal: Array | None = None


def roomiest_grasp(
    box: SeenObject,
    turn: float,
    hand: Hand,
    around: Surroundings,
    failed: Grasp | None = None,
    lacking: Callable[[Grasp], float] | None = None,
) -> Grasp:
    """Chooses faces and thumb side with the best compromise between room and comfort.

    Args:
        box: The box as seen, upright.
        turn: Turn (rad) that the box is to make.
        hand: The hand of the user whose comfort counts.
        around: Objects that may be in the way, and the surface.
        failed: A grasp that has just failed.
        lacking: Function of a grasp that returns the room (m) missing elsewhere, such as on the way
            to the goal.
    """
    assert isinstance(box.shape, Box)
    half = box.shape.half_size
    natural = hand.natural_axis
    options = []
    for quarter in range(4):
        axis = box.yaw + quarter * np.pi / 2
        start, end = axis - natural, axis + turn - natural
        width, face = (half[0], half[1]) if quarter % 2 == 0 else (half[1], half[0])
        grasp = grasp_across(axis, 2 * width, 2 * face, hand)
        cost = max(abs(wrapped(start)), abs(wrapped(end)))
        cost += _CROWDED * _missing_room(grasp, turn, box, hand, around)
        if lacking is not None:
            cost += _CROWDED * lacking(grasp)
        if failed and abs(wrapped(axis - failed.axis)) < np.pi / 4:
            cost += _AGAIN
        options.append((cost, quarter, grasp))
    return min(options, key=lambda o: o[:2])[2]


def _missing_room(
    grasp: Grasp, turn: float, box: SeenObject, hand: Hand, around: Surroundings
) -> float:
    """Missing room (m) beside neighbours at the start, and at the border at start and goal."""
    places = grasp.places(np.asarray(box.position[:2]), grasp.opening(hand), hand)
    short = max(_ROOM - _nearest(places, grasp.axis, float(box.position[2]), around.neighbours), 0)
    short += beyond_border(places, around.surface)
    if around.goal is not None:
        there = replace(grasp, axis=grasp.axis + turn)
        closed = there.places(around.goal, -hand.configuration.squeeze, hand)
        short += beyond_border(closed, around.surface)
    return short


def _nearest(places: Array, axis: float, height: float, neighbours: Iterable[SeenObject]) -> float:
    """Least distance (m) of the middles of the fingers' last links from the other objects."""
    palm = np.array([sin(axis), -cos(axis)])
    links = [(places + along * palm, height + up) for along, up in ((0.0, 0.0), *_LINK)]
    points = np.vstack([np.column_stack([xy, np.full(len(xy), z)]) for xy, z in links])
    distances = [float(o.shape.clearance(points, o.position, o.rotation).min()) for o in neighbours]
    return min(distances, default=np.inf)
