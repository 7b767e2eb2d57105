"""Possible sizes, rates, distances, speeds and angles of hands and touches, and the units of a file
that follow from them.

A file of another program rarely states its units. A reader measures a few quantities of the file,
such as the length of a finger and the time between two frames. `find_units` finds the units in
which all of them are possible. The format's usual unit is used if it fits. Any other unit is
reported. A file is refused if no unit fits, or if several units other than the usual unit fit.
`LiveUnits` does the same for a running device, which is never refused.

The largest possible hand, finger or palm, divided by the smallest, is less than the smallest ratio
of two units (1 in = 2.54 cm). For times, this ratio is less than 1000. So at most one unit fits.
Sources of the bounds:

    hand      Hands are 165 mm (women, 5th percentile) to 211 mm (men, 95th) long in ANSUR (Gordon
              et al. 1989), and 100 mm at the age of two in Snyder et al. 1977. The largest known
              hands of adults have 250 mm. Finger and palm are shares of the hand: 0.53 and 0.50 in
              the built-in skeleton, whose lengths are those of ANSUR's average man.
    reach     Distance from the palm's centre to the farthest fingertip, from a child's fist to a
              large open hand.
    step      Cameras take a few pictures a second or more, marker systems 1000 at most.
    distance  A Leap sees up to 1 m, a headset as far as its wearer's arm. A wrist is 5 to 15 cm
              over the surface that its fingers touch.
    picture   A hand is not much larger than the picture, and at most a quarter of the hand is
              beyond the picture.
    speed     A hand moves at 20 m/s in a throw and at 3 m/s in a stroke over a surface. Devices
              correct its place by a few centimetres between two frames.
    contact   The contact of a resting fingertip has 5 to 28 mm, that of a palm 25 to 120, that of a
              whole hand somewhat more. The outer edge of a forearm is nine times as long as wide.
    touch     Fingertips side by side are 12 mm apart or more. Screens report at 480 Hz at most. A
              resting hand may cause no report for a second.
    object    Objects are moved by fingers. The widest of them, such as a ring or a tray, are wider
              than a hand and no wider than a table.
    angle     A joint of a finger bends by 2 rad at most, that of a thumb by less. Joints of robots'
              hands have ranges of a few degrees to a full turn.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise, product
from math import sqrt
from operator import attrgetter
from statistics import median
from typing import Protocol, TypeVar

import numpy as np

from models.arithmetic import Array, Mask, distance
from models.errors import InputError
from models.frames import TouchFrame, TrackedHand, Vector
from models.reader_report import ReaderReport

UNITS: dict[str, dict[str, float]] = {
    "length": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "in": 0.0254},
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9},
    "angle": {"rad": 1.0, "deg": 0.017453292519943295},
    "image coordinate": {"px": 1.0, "0..1": 640.0},
}
"""Dimension -> its units, each with its size in the first unit. Names are unique. `0..1` is a share
of the picture's width or height; its size here is that of the usual width, 640 px."""


class Timed(Protocol):
    """A row of a file."""

    @property
    def time(self) -> float:
        """Time (s) on the file's clock."""


T = TypeVar("T", bound=Timed)
K = TypeVar("K", bound=Hashable)

Units = Mapping[str, str]
"""Dimension -> name of a unit."""

Values = Sequence[float] | Array
"""Values (n,) of a quantity."""


@dataclass(frozen=True, eq=False)
class Bounds:
    """Range of a quantity. Two objects are never equal, even with equal values.

    Attributes:
        name: Name of the quantity in messages.
        least: Smallest possible value in the first units of `UNITS`.
        most: Largest possible value.
        powers: Dimension -> its power in the quantity.
    """

    name: str
    least: float
    most: float
    powers: tuple[tuple[str, int], ...] = (("length", 1),)

    def includes(self, value: float) -> bool:
        """True if a value in the first units of `UNITS` is possible; False for NaN."""
        return self.least <= value <= self.most

    def scale(self, units: Units) -> float:
        """Factor from given units to the first units of `UNITS`."""
        factor = 1.0
        for dimension, power in self.powers:
            factor *= unit_size(units, dimension) ** power
        return factor

    def unit(self, units: Units) -> str:
        """The quantity's own unit, such as m/s."""
        up = [units[d] for d, power in self.powers if power > 0]
        down = [units[d] for d, power in self.powers if power < 0]
        return "/".join((" ".join(up), *down))


AT_ONCE = 2.0
"""Factor by which a size in a single frame may exceed the bounds of a hand's size, since a device
may briefly be far off."""
HAND = Bounds("the length of the hand", 0.115, 0.286)
FINGER = Bounds("the longest finger", 0.055, 0.138)
PALM = Bounds("the distance from wrist to knuckles", 0.050, 0.126)
REACH = Bounds("the distance from palm to fingertips", 0.02, 0.18)
PALM_AT_ONCE = Bounds(PALM.name, PALM.least / AT_ONCE, AT_ONCE * PALM.most)
FINGER_AT_ONCE = Bounds("the length of a finger", 0.0, AT_ONCE * FINGER.most)
DISTANCE = Bounds("the hand's distance", 0.0, 10.0)
STEP = Bounds("the time between two frames", 0.001, 0.5, (("time", 1),))
HEIGHT = Bounds("the height of the wrist over the surface", 0.02, 0.30)
SPEED = Bounds("the hand's speed", 0.0, 20.0, (("length", 1), ("time", -1)))
ANGLE = Bounds("the angle of a joint", 0.0, 2.8, (("angle", 1),))
RANGE = Bounds("the range of a joint", 0.1, 6.3, (("angle", 1),))
IN_PICTURE = Bounds("the width of a hand in the picture", 4.0, 960.0, (("image coordinate", 1),))
OBJECT = Bounds("the width of the object", 0.001, 2.0)
BEYOND = Bounds("a hand's part beyond the picture", 0.0, 160.0, (("image coordinate", 1),))

CONTACT = Bounds("the size of a touch", 0.001, 0.150)
FEWEST = 20
"""Least number of frames, or of places, by which the units of touches are judged."""
FINGERS_APART = Bounds("the distance between two touches", 0.008, 0.35)
LARGEST_TABLE = 1.6
"""Longest side of a touch table (m), if its size is not given."""
TOUCH_STEP = Bounds("the time between two frames with touches", 0.0021, 2.0, (("time", 1),))
_LONGEST, _SLENDEREST = 0.25, 10.0
"""Longest side of a contact (m), and largest ratio of its longer side to its shorter side."""
_NARROWEST = 1.0 / _SLENDEREST
_SMALL, _LARGE = CONTACT.least**2, _LONGEST**2 / _SLENDEREST
"""Range of width times height (m2) in which contacts of possible shape are neither too small nor
too long."""
USUAL_LEAST, USUAL_MOST = 0.004, 0.040
"""Least and greatest width or height (m) of most contacts; any two of these sizes are possible
together."""
_FINGERTIP = 0.035
"""Largest size of a fingertip (m)."""

MARGIN = 0.25
"""Largest distance of a touch beyond the surface's edge, as a share of the surface's length.
Sensors reach a little beyond their edge. Touches within this margin are moved onto the edge, and
others are refused."""

_FIRST = {dimension: next(iter(units)) for dimension, units in UNITS.items()}


def unit_size(units: Units, dimension: str) -> float:
    """Size of the unit of a dimension, in the dimension's first unit in `UNITS`, such as metres."""
    return UNITS[dimension][units[dimension]]


def parse_units(text: str, where: str = "--unit") -> dict[str, str]:
    """Units by dimension, from `mm`, `ms` or `mm,ms`; an empty text gives none.

    Raises:
        InputError: A name is unknown, or two units are of the same dimension.
    """
    found: dict[str, str] = {}
    for name in filter(None, (part.strip() for part in text.split(","))):
        dimension = next((d for d, units in UNITS.items() if name in units), None)
        if dimension is None or dimension in found:
            raise InputError(
                "no such unit" if dimension is None else "two units of the same quantity",
                where=where,
                got=text,
                expected=", ".join(n for units in UNITS.values() for n in units),
            )
        found[dimension] = name
    return found


def find_units(
    seen: Mapping[Bounds, Values],
    declared: Units,
    given: Units | None = None,
    *,
    where: str,
    report: ReaderReport | None = None,
    error: Callable[..., InputError] = InputError,
) -> dict[str, str]:
    """The units of a file, in which all its quantities are possible.

    Args:
        seen: Values of quantities in the file's own units. The median of each is used, so that
            single wrong values do no harm. A quantity without values is unknown.
        declared: Unit of each dimension, as usual for the format or as the file states it.
        given: Units that a person gave. They are not checked.
        where: The file, for the error.
        report: Receives a sentence about each unit that is not the declared unit.
        error: Class of the error.

    Raises:
        InputError: No units fit, or the declared units do not fit and several others do.
    """
    middles = _middles(seen)
    possible = _possible(middles, declared, given or {})
    if len(possible) != 1:
        raise _refused(middles, declared, possible, where, error)
    units = possible[0]
    if report is not None:
        for sentence in _assumed(middles, declared, units, given or {}):
            report.assume(sentence)
    return units


def forget_beyond(seen: dict[Bounds, list[float]]) -> None:
    """Removes `BEYOND` from the quantities if hands are wide enough for pixels.

    In pixels, a model may guess parts of a hand at any distance outside the picture. In shares of
    the picture, this distance distinguishes shares (0 to 1) from coordinates of -1 to 1.
    """
    if IN_PICTURE.includes(median(seen.get(IN_PICTURE, [0.0]))):
        seen.pop(BEYOND, None)


_MISTAKEN = 0.25
"""Largest accepted share of frames whose time runs backwards."""


def steps_of(times: Sequence[float]) -> list[float]:
    """Times between frames, for `STEP`, without the few that are zero or negative.

    If a clock stands still, or often runs backwards, the result contains its zero or negative
    times, which are impossible.
    """
    steps = [b - a for a, b in pairwise(times)]
    back = [step for step in steps if step < 0.0]
    if len(back) > _MISTAKEN * len(steps):
        return back
    return [step for step in steps if step > 0.0] or [0.0] * bool(steps)


def _middles(seen: Mapping[Bounds, Values]) -> dict[Bounds, float]:
    return {
        bounds: float(np.median(values) if isinstance(values, np.ndarray) else median(values))
        for bounds, values in seen.items()
        if len(values)
    }


def _possible(
    middles: Mapping[Bounds, float], declared: Units, given: Units
) -> list[dict[str, str]]:
    """The units in which all quantities are possible; only the declared units if they fit."""
    fixed = {**declared, **{d: u for d, u in given.items() if d in declared}}
    # Units that a person gave are not checked.
    open_ = declared.keys() - given.keys()
    doubted = {b: v for b, v in middles.items() if open_ & dict(b.powers).keys()}

    def fits(units: Units) -> bool:
        return all(bounds.includes(v * bounds.scale(units)) for bounds, v in doubted.items())

    def counts_frames(units: Units) -> bool:
        # Numbers that differ by one are frame numbers, not times in ms, although 1 ms is possible.
        changed = STEP in doubted and units["time"] != fixed["time"]
        return changed and doubted[STEP] * STEP.scale(units) == STEP.least

    if fits(fixed):
        return [fixed]
    # A dimension whose quantities all fit already is not changed.
    wrong = {
        d
        for b, v in doubted.items()
        if not b.includes(v * b.scale(fixed))
        for d, _ in b.powers
        if d not in given
    }
    free = [d for d in declared if d in wrong]
    choices = [[(d, name) for name in UNITS[d]] for d in free]
    found = [{**fixed, **dict(choice)} for choice in product(*choices)]
    return [units for units in found if fits(units) and not counts_frames(units)]


def _refused(
    middles: Mapping[Bounds, float],
    declared: Units,
    possible: Sequence[Units],
    where: str,
    error: Callable[..., InputError],
) -> InputError:
    """The error for a file that fits no units or several units."""
    if possible:
        several = [",".join(u for d, u in units.items() if u != declared[d]) for units in possible]
        return error(
            "several units are possible",
            where=where,
            got=" or ".join(several),
            remedy=f"Give the file's unit, such as --unit {several[0]}",
        )
    # The message names the first quantity that does not fit.
    bounds, value = next(
        ((b, v) for b, v in middles.items() if not b.includes(v * b.scale(declared))),
        next(iter(middles.items())),
    )
    limits = f"{bounds.least:g} to {bounds.most:g} {bounds.unit(_FIRST)}"
    names = ", ".join(n for d, _ in bounds.powers for n in UNITS[d])
    return error(
        f"{bounds.name} is zero" if value == 0.0 else f"{bounds.name} is impossible in any unit",
        where=where,
        got=f"{value:.3g} {bounds.unit(declared)}",
        expected=f"{limits}, in {names}",
        remedy="Give the file's unit with --unit" if value else None,
    )


def _assumed(
    middles: Mapping[Bounds, float], declared: Units, units: Units, given: Units
) -> list[str]:
    """A sentence for each dimension that is not in its declared unit."""
    sentences = []
    for dimension, name in units.items():
        if name == declared[dimension]:
            continue
        read = f"{dimension}s are read in {name}"
        if dimension in given:
            sentences.append(f"{read}, as --unit says")
            continue
        wrong = {
            b: v * b.scale(declared) for b, v in middles.items() if dimension in dict(b.powers)
        }
        bounds = next((b for b, v in wrong.items() if not b.includes(v)), next(iter(wrong)))
        size = f"{wrong[bounds]:.3g} {bounds.unit(_FIRST)}"
        sentences.append(f"{read}: in {declared[dimension]}, {bounds.name} would be {size}")
    return sentences


def doubt_degrees(largest: float, report: ReaderReport) -> None:
    """Reports a file whose angles would be very small as degrees, but possible as radians.

    Args:
        largest: Greatest absolute angle of the whole file, degrees.
        report: Receives the doubt.
    """
    if 0.0 < largest <= math.pi:
        report.assume(
            f"no joint turns by more than {largest:.2g} degrees: if the file's angles are radians, "
            "the hand hardly moves"
        )


def touch_steps(times: Sequence[float], touched: Sequence[bool]) -> list[float]:
    """Mean time (s) from a frame with touches to the next frame, for `TOUCH_STEP`, in a list.

    The list is empty if there are too few frames. A device that sends only changes is silent while
    nothing touches it, and frames may come in bursts. So neither the steps between all frames nor
    their median give the device's rate.
    """
    steps = [b - a for a, b, on in zip(times, times[1:], touched, strict=False) if on]
    return [math.fsum(steps) / len(steps)] if len(steps) >= FEWEST else []


def in_order(rows: Sequence[T], report: ReaderReport) -> list[T]:
    """Rows of a file in the order of their times; rows that break this order are left out.

    If two rows are in the wrong order, the next row decides which of the two is wrong.
    """
    times = list(map(attrgetter("time"), rows))
    if times == sorted(times):
        return list(rows)
    kept: list[T] = []
    for n, row in enumerate(rows):
        following = rows[n + 1].time if n + 1 < len(rows) else math.inf
        if kept and row.time < kept[-1].time:
            report.leave_out("frames whose time runs backwards")
            alone = len(kept) < 2 or kept[-2].time <= row.time
            if following >= kept[-1].time or not alone:
                continue
            kept.pop()
        kept.append(row)
    return kept


def on_surface(position: float) -> float | None:
    """A position along a surface whose ends are 0 and 1. A position in the margin is moved onto
    the edge.

    None for NaN and for a position beyond the margin.
    """
    return min(max(position, 0.0), 1.0) if -MARGIN <= position <= 1.0 + MARGIN else None


@dataclass
class ContactSizes:
    """Sizes of a device's contacts, checked against the sizes of fingers and hands.

    Args:
        report: Receives the sizes that are left out, and whether most are larger than fingers.
        wanted: Number of sizes that are judged.

    Attributes:
        decided: True once enough sizes were judged. From then on, usual sizes (`USUAL_LEAST` to
            `USUAL_MOST`) need no check.
    """

    report: ReaderReport
    wanted: int = 60

    def __post_init__(self) -> None:
        self._seen: list[float] = []
        self.decided = False

    def known(
        self, size: float | None, extent: tuple[float, float] | None
    ) -> tuple[float | None, tuple[float, float] | None]:
        """Diameter, and width and height of a contact, in m; None for both if they are impossible.

        Args:
            size: Diameter in m. None, or a number that is not above 0, if it is not measured.
            extent: Width and height in m. None, or numbers of which one is not above 0, if they are
                not measured.
        """
        if extent is not None:
            width, height = extent
            # Most sizes are usual. The test is fast, since devices send many sizes.
            if (
                self.decided
                and _SMALL <= width * height <= _LARGE
                and _NARROWEST <= width / height <= _SLENDEREST
            ):
                return size, extent
            if not (width > 0.0 and height > 0.0):
                extent = None
        elif self.decided and size is not None and CONTACT.least <= size <= CONTACT.most:
            return size, None
        if size is not None and size <= 0.0:
            size = None
        if extent is not None:
            short, long = sorted(extent)
            sound = CONTACT.includes(sqrt(short * long))
            sound = sound and long <= min(_LONGEST, _SLENDEREST * short)
        else:
            sound = size is None or CONTACT.includes(size)
        if not sound:
            self.report.leave_out(IMPOSSIBLE_SIZE)
            return None, None
        if not self.decided and (size is not None or extent is not None):
            self._seen.append(sqrt(extent[0] * extent[1]) if extent is not None else size or 0.0)
            self.decided = len(self._seen) >= self.wanted
            if self.decided and (middle := median(self._seen)) > _FINGERTIP:
                self.report.assume(
                    f"most touches are as large as palms ({1000.0 * middle:.0f} mm); "
                    "if they are fingers, their sizes are in another unit"
                )
        return size, extent


class TouchIds:
    """Detects a device that gives touches new ids in most frames, so that ids identify nothing.

    Args:
        report: Receives the doubt.
    """

    def __init__(self, report: ReaderReport) -> None:
        self._report = report
        self._before: dict[int, tuple[float, float]] = {}
        self._judged, self._renamed = 0, 0

    def look(self, frame: TouchFrame) -> None:
        """Examines a frame; has no effect once enough frames with touches were examined."""
        if self._judged == _JUDGED or not (frame.contacts or self._before):
            return
        now = {contact.id: (contact.x, contact.y) for contact in frame.contacts}
        before, self._before = self._before, now
        if not (now and before):
            return
        self._judged += 1
        gone = [before[i] for i in before.keys() - now.keys()]
        new = [now[i] for i in now.keys() - before.keys()]
        near = (
            math.dist(a, b) < FINGERS_APART.least  # any order: only a report follows from it
            for a in new
            for b in gone
        )
        self._renamed += any(near)
        if self._renamed >= FEWEST and 2 * self._renamed > self._judged:
            self._report.assume(
                "touches have new ids in most frames; fingers are followed by their places alone"
            )


_JUDGED = 200
"""Number of pairs of frames with touches that are examined."""

IMPOSSIBLE_SIZE = "sizes that no finger or hand has"

_SAME = 0.2
"""Distance, as a share of a hand's size, within which points of two hands are those of one hand."""
_SOME = 4
"""Every n-th point is compared first; this is n."""
ON_ANOTHER = "hands that lie on another one"


def lie_on(one: Sequence[Sequence[float]], other: Sequence[Sequence[float]], size: float) -> bool:
    """True if a device reports one hand twice: the points of both are at the same places.

    Args:
        one: Points of a hand in any unit, at least one.
        other: The same points of another hand.
        size: Length of a hand in this unit.
    """
    most = len(one) * _SAME * size
    # Two hands are usually so far apart that a few of their points already exceed the limit for the
    # sum of all points.
    return (
        len(one) == len(other)
        and math.fsum(map(distance, one[::_SOME], other[::_SOME])) < most
        and math.fsum(map(distance, one, other)) < most
    )


_BENT = 0.5
"""Sine of the least bend of fingers that shows on which side the palm is."""
_CLEAR = 0.3
"""Least volume spanned by three unit vectors (across, along and closing) that shows the side."""
_ENOUGH, _MORE = 8, 4
"""Least number of frames that contradict a side, and least ratio of their number to that of the
frames that agree."""
_BEGINNING, _EVERY = 32, 16
"""Number of frames that are examined first, and interval of the frames examined after them."""
_SETTLED = 48
"""Number of frames with bent fingers that are examined for each side."""


def bent_side(fingers: Sequence[Sequence[Vector]]) -> str:
    """The side of a hand, inferred from the bend of its fingers, which is towards the palm.

    Args:
        fingers: Knuckle, PIP, DIP and tip, in right-handed coordinates, of two or more fingers. The
            fingers are in order from the index finger's side, without the thumb.

    Returns:
        `right` or `left`; empty for fingers that are nearly straight.
    """
    # Plain floats are faster than arrays; a camera sends many pictures.
    a, b, c = _between(fingers[-1][0], fingers[0][0])
    d = e = f = g = h = i = lengths = 0.0
    for knuckle, pip, _, tip in fingers:
        x, y, z = _between(knuckle, pip)
        u, v, w = _between(pip, tip)
        # Part of the rest of the finger that is perpendicular to its first bone.
        share = (x * u + y * v + z * w) / ((x * x + y * y + z * z) or 1.0)
        d, e, f = d + x, e + y, f + z
        g, h, i = g + u - share * x, h + v - share * y, i + w - share * z
        lengths += math.hypot(u, v, w)  # any order: only a side follows from it
    volume = a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g)
    closing = math.hypot(g, h, i)  # any order: as above
    size = math.hypot(a, b, c) * math.hypot(d, e, f) * closing  # any order: as above
    if not (closing > _BENT * lengths and abs(volume) > _CLEAR * size):
        return ""
    return "right" if volume > 0.0 else "left"


def _between(a: Vector, b: Vector) -> Vector:
    return b[0] - a[0], b[1] - a[1], b[2] - a[2]


class SideDoubt:
    """Compares the sides that a device reports for hands with the bend of their fingers."""

    def __init__(self) -> None:
        self._frames = 0
        # Sides whose verdict no further frame can change.
        self._settled: set[str] = set()
        # Side -> numbers of frames that agree with it, and that contradict it.
        self._agreed: dict[str, int] = {}
        self._contradicted: dict[str, int] = {}

    @property
    def sentence(self) -> str:
        """The doubt as a sentence for people; empty if there is no doubt."""
        for side, against in self._contradicted.items():
            if against >= _ENOUGH and against > _MORE * self._agreed.get(side, 0):
                other = "left" if side == "right" else "right"
                return (
                    f"by the way its fingers bend, the {side} hand is a {other} hand: the reported "
                    "side is wrong, or the positions are mirrored"
                )
        return ""

    def due(self) -> bool:
        """True if the next frame is to be examined."""
        self._frames += 1
        return self._frames <= _BEGINNING or self._frames % _EVERY == 0

    def look_through(self, side: str, fingers: Array) -> None:
        """Examines a hand in frames spread over a recording.

        Args:
            side: The reported side.
            fingers: (T, n, 4, 3), points of n fingers as for `bent_side`, NaN for points that were
                not seen.
        """
        whole = np.flatnonzero(np.isfinite(fingers).all(axis=(1, 2, 3)))
        if not len(whole):
            return
        some = np.unique(np.linspace(0, len(whole) - 1, _SETTLED).astype(int))
        for t in whole[some]:
            self.look(side, fingers[t].tolist())

    def look_at(self, hand: TrackedHand) -> None:
        """Examines a hand of a device that reports fingers and their joints."""
        known = {f.finger: f.joints for f in hand.fingers if f.finger and f.joints}
        self.look(hand.side, [known[finger] for finger in sorted(known)])

    def look(self, side: str | None, fingers: Sequence[Sequence[Vector]]) -> None:
        """Examines a hand in one frame.

        Args:
            side: The reported side; None if the device reports none.
            fingers: As for `bent_side`. Fewer than two fingers have no effect.
        """
        if not side or side in self._settled or len(fingers) < 2:
            return
        shown = bent_side(fingers)
        if not shown:
            return
        counts = self._agreed if shown == side else self._contradicted
        counts[side] = counts.get(side, 0) + 1
        agreed = self._agreed.get(side, 0)
        left = _SETTLED - agreed - self._contradicted.get(side, 0)
        # Enough frames were examined, or the remaining frames cannot outweigh those that agree.
        if left <= 0 or self._contradicted.get(side, 0) + left <= _MORE * agreed:
            self._settled.add(side)


JUMPED = "hands that jump farther than a hand moves"
POINT_JUMPED = "points of a hand that jump farther than a hand moves"
_FROZEN = 1.0
"""Longest time (s) without any change. Even a still hand changes in the last digits, since no
device measures the same value twice."""
_CORRECTION = 0.05
"""Distance (m) by which a device may correct a place from one frame to the next."""


class HandJumps:
    """Finds hands that jump farther than a hand can move, in a recording or while a device runs.

    If a hand stays at the place to which it jumped, only the first frame there counts as a jump. A
    hand that was not in the previous frame may appear anywhere.

    Attributes:
        frozen: Longest time (s) for which the position of a hand did not change in any digit.
    """

    def __init__(self) -> None:
        self.frozen = 0.0
        self.forget()

    def forget(self) -> None:
        """Forgets the places of hands, for a change of clock or unit."""
        # Time since which each hand has been in the same place.
        self._since: dict[Hashable, float] = {}
        # For hands of the previous frame: time and place of the last frame without a jump, and time
        # and place of a jump in the previous frame.
        self._known: dict[Hashable, tuple[float, Vector]] = {}
        self._jumped: dict[Hashable, tuple[float, Vector]] = {}

    def find(self, time: float, places: Mapping[K, Vector]) -> set[K]:
        """The hands that jump in a frame.

        Args:
            time: Time (s), not before that of the last frame.
            places: Place of every hand of the frame, by the hand's identifier.
        """
        known, jumped, since = self._known, self._jumped, self._since
        self._known, self._jumped, self._since = {}, {}, {}
        for hand, place in places.items():
            now, before = (time, place), known.get(hand)
            if before is not None and before[1] == place:
                self._since[hand] = since.get(hand, before[0])
                self.frozen = max(self.frozen, time - self._since[hand])
            if (
                before is None
                or _moves(before, now)
                or (hand in jumped and _moves(jumped[hand], now))
            ):
                self._known[hand] = now
            else:
                self._known[hand], self._jumped[hand] = before, now
        return {hand for hand in places if hand in self._jumped}

    @property
    def doubt(self) -> str:
        """Sentence about a hand that does not move at all; empty if no hand did so for long."""
        if self.frozen < _FROZEN:
            return ""
        return (
            f"a hand did not move in any digit for {self.frozen:.1f} s: the device may have lost it"
        )


def find_jumps(time: Array, places: Array) -> Mask:
    """Booleans (T, M), true for points of a recording that jump, by the rule of `HandJumps`.

    Args:
        time: (T,) s, increasing.
        places: (T, M, 3) m, NaN for points that were not seen.
    """
    moved = np.sqrt((np.diff(places, axis=0) ** 2).sum(axis=2))
    # Few recordings have a jump, and this test of all steps at once is fast. Comparisons with NaN
    # are false.
    far: Mask = moved > (SPEED.most * np.diff(time) + _CORRECTION)[:, None]
    jumped = np.zeros(places.shape[:2], bool)
    points = np.flatnonzero(far.any(axis=0)).tolist()
    if not points:
        return jumped
    seen: Mask = np.asarray(np.isfinite(places).all(axis=2))
    jumps = HandJumps()
    for t, now in enumerate(time.tolist()):
        at: dict[int, Vector] = {m: tuple(places[t, m].tolist()) for m in points if seen[t, m]}
        for m in jumps.find(now, at):
            jumped[t, m] = True
    return jumped


def _moves(before: tuple[float, Vector], now: tuple[float, Vector]) -> bool:
    """True if a hand can move from one place to another in the time between them."""
    return distance(before[1], now[1]) <= SPEED.most * (now[0] - before[0]) + _CORRECTION


@dataclass
class LiveUnits:
    """Finds the units of a running device by its first frames. The device is never refused.

    Args:
        declared: Unit of each dimension that the device is expected to send.
        wanted: Number of frames that are measured before units are decided.

    Attributes:
        units: The units that are assumed.
        notice: Text about assumed units or impossible quantities; empty if the declared units fit.
    """

    declared: Units
    wanted: int = 30
    units: Units = field(init=False)
    notice: str = field(init=False, default="")

    def __post_init__(self) -> None:
        self.units = self.declared
        self._seen: dict[Bounds, list[float]] = {}
        self._frames = 0

    @property
    def decided(self) -> bool:
        """True once enough frames were measured. From then on, `look` has no effect."""
        return self._frames >= self.wanted

    def look(self, seen: Mapping[Bounds, float]) -> None:
        """Adds the quantities of a frame, in the device's own units. A frame without a hand has no
        effect."""
        if self.decided or not seen.keys() & {FINGER, PALM, REACH}:
            return
        for bounds, value in seen.items():
            self._seen.setdefault(bounds, []).append(value)
        self._frames += 1
        if not self.decided:
            return
        forget_beyond(self._seen)
        report = ReaderReport()
        try:
            self.units = find_units(self._seen, self.declared, where="", report=report)
        except InputError as error:
            expected = f", expected {error.expected}" if error.expected else ""
            report.assume(f"{error.what} ({error.got}{expected})")
        self.notice = report.line()
