"""Touch frames, hand frames and landmark frames: all contacts, all 3-D hands, or all hands in a
picture, of one device at one moment."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cache
from operator import index

from models.errors import FrameError

FINGERS = ("thumb", "index", "middle", "ring", "little")
"""Finger names by label; a label is an index into this tuple."""


@cache
def finger_bits(fingers: frozenset[int]) -> int:
    """Labels of fingers as a bit mask."""
    return sum(1 << f for f in fingers)


SURE = 0.8
"""Probability of a label below which views show that the label is uncertain."""


@dataclass(frozen=True, slots=True)
class Contact:
    """One finger on the surface, from the device to the views.

    A device sets the id, the position, and the other values that it measures. The reconstructor
    smooths the position, and sets the label, its probability and the state. A probability or state
    set by a device has no effect. Numbers of NumPy and similar libraries are converted to Python's
    own types, since recordings contain no others.

    Attributes:
        id: Constant from touch-down to touch-up; unique among the contacts of one frame.
        x: Surface position, metres to the right of the top left corner.
        y: Surface position, metres down from the top left corner.
        size: Contact diameter in metres; None where the device does not measure it. A size that
            is not a number above 0, as some hardware sends without measuring it, becomes None.
        label: Finger (thumb 0 to little 4). From a device, it is set only if the *device* knows the
            finger. In a reconstruction, it is the labeller's result; None before a result, and for
            contacts that are not fingers.
        extent: Width and height of the contact in metres, both above 0; None if the device does not
            measure both. It distinguishes palms from fingers.
        state: `active`; `lost` during the grace period after it was lost; `palm` (drawn as a faint
            patch); `ignored` (drawn grey).
        probability: Probability of the label, 0 to 1; 1 without a label and for a device's label.

    Raises:
        FrameError: A value is not a number, or is impossible for a contact.
    """

    id: int
    x: float
    y: float
    size: float | None = None
    label: int | None = None
    extent: tuple[float, float] | None = None
    state: str = "active"
    probability: float = 1.0

    def __post_init__(self) -> None:
        if not (
            type(self.id) is int
            and type(self.x) is type(self.y) is float
            and (self.label is None or type(self.label) is int)
            and self.size is self.extent is None
        ):
            self._make_plain()
        if not _SMALLEST_ID <= self.id <= -1 - _SMALLEST_ID:
            raise FrameError("a contact's id has more than 64 bits", got=self.id)
        if not (math.isfinite(self.x) and math.isfinite(self.y)):
            raise FrameError(
                "a contact's position must be finite",
                where=f"contact {self.id}",
                got=(self.x, self.y),
                expected="metres on the surface",
            )
        if self.label is not None and self.label not in range(len(FINGERS)):
            raise FrameError(
                "no such finger", where=f"contact {self.id}", got=self.label, expected="0 to 4"
            )
        if self.extent is not None and not all(0.0 < e < math.inf for e in self.extent):
            raise FrameError(
                "a contact's width and height must be finite and above 0",
                where=f"contact {self.id}",
                got=self.extent,
                expected="metres",
            )

    @property
    def sure(self) -> bool:
        """True if the label's probability is high enough; False marks an uncertain label."""
        return self.probability >= SURE

    def _make_plain(self) -> None:
        """Converts all numbers to Python's own.

        Raises:
            FrameError: A value is not a number.
        """
        try:
            size = None if self.size is None else float(self.size)
            plain = {
                "id": index(self.id),
                "x": float(self.x),
                "y": float(self.y),
                "size": size if size is not None and 0.0 < size < math.inf else None,
                "label": None if self.label is None else index(self.label),
                "extent": None
                if self.extent is None
                else (float(self.extent[0]), float(self.extent[1])),
            }
        except (TypeError, ValueError, IndexError) as error:
            raise FrameError(
                "a contact has a value that is not a number",
                where=f"contact {self.id!r}",
                got=str(error),
                expected="an id and a label that are integers, and lengths that are numbers",
            ) from None
        for name, value in plain.items():
            object.__setattr__(self, name, value)


@dataclass(frozen=True, slots=True)
class TouchFrame:
    """All contacts of one device at one moment.

    Numbers of NumPy and similar libraries are converted to Python's own types, as in a `Contact`.

    Attributes:
        time: Seconds on the device's own monotonic clock.
        contacts: The contacts that are down, in any order; ids are unique.
        lift: Position of the device's lift control, 0 (down) to 1; None if the device has none.
        cancelled: Ids that the system has cancelled since the last frame. The person did not lift
            these fingers, so the hand must not let go because of them.
        source: Name of the sender, for messages and logs.

    Raises:
        FrameError: A value is not a number, or is impossible for a frame.
    """

    time: float
    contacts: tuple[Contact, ...] = ()
    lift: float | None = None
    cancelled: frozenset[int] = field(default_factory=frozenset)
    source: str = ""

    def __post_init__(self) -> None:
        if not (
            type(self.time) is float
            and type(self.contacts) is tuple
            and (self.lift is None or type(self.lift) is float)
            and not self.cancelled
        ):
            self._make_plain()
        if not math.isfinite(self.time):
            raise FrameError("a frame's time must be finite", got=self.time, expected="seconds")
        if len({c.id for c in self.contacts}) != len(self.contacts):
            raise FrameError(
                "two contacts of one frame share an id",
                got=sorted(c.id for c in self.contacts),
                expected="unique ids",
            )
        if self.lift is not None and not 0.0 <= self.lift <= 1.0:
            raise FrameError("the lift control is out of range", got=self.lift, expected="0 to 1")

    def _make_plain(self) -> None:
        """Converts all numbers to Python's own.

        Raises:
            FrameError: A value is not a number, or an element of `contacts` is not a contact.
        """
        try:
            plain = {
                "time": float(self.time),
                "contacts": tuple(self.contacts),
                "lift": None if self.lift is None else float(self.lift),
                "cancelled": frozenset(map(index, self.cancelled)),
            }
        except (TypeError, ValueError) as error:
            raise FrameError(
                "a frame has a value that is not a number",
                got=str(error),
                expected="a time and a lift that are numbers, and ids that are integers",
            ) from None
        for name, value in plain.items():
            object.__setattr__(self, name, value)


_SMALLEST_ID = -(2**63)
"""Smallest id of a contact, since recordings and tables store integers of 64 bits."""

Vector = tuple[float, float, float]

SIDES = ("right", "left")
"""The two hands of a person."""

_UNIT = 1e-3
"""Tolerance for the length of a unit vector; devices send six digits."""


@dataclass(frozen=True, slots=True)
class TrackedFinger:
    """A finger as a 3-D device sees it, in the frame of its `HandFrame`.

    Attributes:
        id: Constant while the finger is visible; unique among the fingers of one hand.
        tip: Position of the fingertip (m), as the device reports it. If the device models bones,
            the position may be a point within the last bone.
        direction: Unit vector along the finger, as the device reports it.
        length: Finger length (m) as the device reports it: the visible length (first Leap
            software), or the sum of the bones.
        finger: Thumb 0 to little 4 if the *device* knows the finger; None otherwise.
        joints: Positions (m) of knuckle, PIP, DIP and tip, or for the thumb of CMC, MCP, IP and
            tip. The tip is the end of the last bone. None if the device does not model bones.
        extended: True if the device reports the finger as stretched, False if as bent; None if it
            reports neither.
    """

    id: int
    tip: Vector
    direction: Vector
    length: float
    finger: int | None = None
    joints: tuple[Vector, Vector, Vector, Vector] | None = None
    extended: bool | None = None

    def __post_init__(self) -> None:
        where = f"finger {self.id}"
        _finite(self.tip, where, "tip")
        _finite(self.direction, where, "direction")
        for joint in self.joints or ():
            _finite(joint, where, "joints")
        _unit(self.direction, where, "direction")
        if not (math.isfinite(self.length) and self.length > 0.0):
            raise FrameError(
                "a finger's length is not a positive number",
                where=where,
                got=self.length,
                expected="metres above 0",
            )
        if self.finger is not None and self.finger not in range(len(FINGERS)):
            raise FrameError("no such finger", where=where, got=self.finger, expected="0 to 4")

    @property
    def end(self) -> Vector:
        """Position (m) of the finger's end: the end of its last bone if the device models bones,
        otherwise `tip`."""
        return self.tip if self.joints is None else self.joints[3]


@dataclass(frozen=True, slots=True)
class TrackedHand:
    """A hand as a 3-D device sees it, in the frame of its `HandFrame`.

    Attributes:
        id: Constant while the hand is visible; unique in its frame.
        palm: Centre of the palm (m).
        normal: Unit vector out of the palm; it points down if the palm faces down.
        direction: Unit vector from the palm towards the fingers.
        fingers: The visible fingers, in any order.
        side: `right`, `left`, or None where the device does not know.
        confidence: Confidence of the device, 0 to 1; 1 where it reports none.
        sphere_radius: Radius of the ball that the hand could hold (m); None where the device does
            not report it.
        wrist: m, position of the wrist; None where the device does not know it.
    """

    id: int
    palm: Vector
    normal: Vector
    direction: Vector
    fingers: tuple[TrackedFinger, ...] = ()
    side: str | None = None
    confidence: float = 1.0
    sphere_radius: float | None = None
    wrist: Vector | None = None

    def __post_init__(self) -> None:
        where = f"hand {self.id}"
        _finite(self.palm, where, "palm")
        _finite(self.normal, where, "normal")
        _finite(self.direction, where, "direction")
        _unit(self.normal, where, "normal")
        _unit(self.direction, where, "direction")
        (a, b, c), (x, y, z) = self.normal, self.direction
        if abs(a * x + b * y + c * z) > 0.9:
            raise FrameError(
                "the palm's normal and direction are nearly parallel", where=where, got=self.normal
            )
        if self.side is not None and self.side not in SIDES:
            raise FrameError("no such side", where=where, got=self.side, expected="right or left")
        ids = [f.id for f in self.fingers]
        if len(set(ids)) != len(ids):
            raise FrameError("two fingers share an id", where=where, got=sorted(ids))
        named = [f.finger for f in self.fingers if f.finger is not None]
        if len(set(named)) != len(named):
            raise FrameError("the device names a finger twice", where=where, got=sorted(named))


@dataclass(frozen=True, slots=True)
class HandFrame:
    """All 3-D hands of one device at one moment.

    Axes are the world's, origin at the device: x right, y away from the person, z up.

    Attributes:
        time: Seconds on the device's own monotonic clock.
        hands: The visible hands, in any order.
        source: Name of the device, for messages and logs.
        dialect: Version of a Leap's software, by its messages: `v1`, `v2`, `v3` or `bridge`; None
            where it is unknown.
    """

    time: float
    hands: tuple[TrackedHand, ...] = ()
    source: str = ""
    dialect: str | None = None

    def __post_init__(self) -> None:
        if not math.isfinite(self.time):
            raise FrameError("a frame's time must be finite", got=self.time, expected="seconds")
        ids = [h.id for h in self.hands]
        if len(set(ids)) != len(ids):
            raise FrameError("two hands of one frame share an id", got=sorted(ids))


LANDMARKS = 21
"""Number of landmarks of a hand in a picture: the wrist, then four for each finger, from thumb to
little finger, each from the palm outwards. Those of a finger are knuckle, PIP, DIP and tip; those
of the thumb are CMC, MCP, IP and tip. The numbering is MediaPipe's."""

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class SeenHand:
    """A hand in a camera's picture.

    Attributes:
        side: `right` or `left`, as the engine classifies the hand.
        score: Confidence of the engine in the side, 0 to 1.
        image: Landmarks (21, 2) in pixels: x right, y down, from the picture's top left corner.
        world: Landmarks (21, 3) m as the engine estimates them, relative to the middle of the hand:
            x right and y down in the picture, z away from the camera. Lengths are those of an
            average hand.
    """

    side: str
    score: float
    image: tuple[Point, ...]
    world: tuple[Vector, ...]

    def __post_init__(self) -> None:
        where = f"{self.side} hand"
        if self.side not in SIDES:
            raise FrameError("no such side", got=self.side, expected="right or left")
        if not 0.0 <= self.score <= 1.0:
            raise FrameError("the score is out of range", where=where, got=self.score)
        for name, points, size in (("image", self.image, 2), ("world", self.world, 3)):
            sound = len(points) == LANDMARKS and all(
                len(p) == size and all(map(math.isfinite, p)) for p in points
            )
            if not sound:
                raise FrameError(
                    "the landmarks are not finite numbers",
                    where=f"{where}, {name}",
                    expected=f"{LANDMARKS} points of {size} numbers",
                )


@dataclass(frozen=True, slots=True)
class LandmarkFrame:
    """All hands in one picture of a camera.

    Attributes:
        time: Seconds on the device's own monotonic clock.
        hands: The hands in the picture, in any order.
        size: Width and height of the picture in pixels.
        taken: Seconds on the camera's clock at which the picture was taken. A session replaces
            `time`, but not this value, which distinguishes successive pictures.
        source: Name of the device, for messages and logs.
    """

    time: float
    hands: tuple[SeenHand, ...] = ()
    size: tuple[int, int] = (640, 480)
    taken: float = 0.0
    source: str = ""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.time) and math.isfinite(self.taken)):
            raise FrameError("a frame's time must be finite", got=self.time, expected="seconds")
        if min(self.size) < 1:
            raise FrameError("the picture has no size", got=self.size, expected="pixels")


Frame = TouchFrame | HandFrame | LandmarkFrame
"""One input frame of a device: touches, hands in the air, or hands in a picture."""


def _finite(vector: Vector, where: str, name: str) -> None:
    # A sum is finite only if all its terms are; one test of the sum is quicker than three.
    if len(vector) == 3 and math.isfinite(vector[0] + vector[1] + vector[2]):
        return
    if len(vector) != 3 or not all(map(math.isfinite, vector)):
        raise FrameError(
            f"{name} must be three finite numbers", where=where, got=vector, expected="metres"
        )


def _unit(vector: Vector, where: str, name: str) -> None:
    x, y, z = vector
    if abs(x * x + y * y + z * z - 1.0) < _UNIT:
        return  # The length then differs from 1 by about half of `_UNIT` at most.
    length = math.sqrt(math.fsum(c * c for c in vector))
    if abs(length - 1.0) > _UNIT:
        raise FrameError(
            f"{name} is not a unit vector", where=where, got=vector, expected="length 1"
        )
