"""Calibration measures the standard length of every finger of an open hand.

As in the paper, this is the mean length (`calibrated`). For the first Leap software, whose lengths
vary, it is nearly the longest length (`longest_calibration`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.paalm.coupling import LEAST_BENT, Coupling
from encoders.paalm.palm import palm_of
from models.arithmetic import Array
from models.errors import EncoderError
from models.frames import FINGERS, TrackedFinger, TrackedHand, Vector

PAPER_FRAMES = 1000

MOST_SPREAD = 0.12
"""Greatest robust standard deviation of a finger's length, as a share of the length."""

LEAST_APART = 0.012
"""Least distance (m) between neighbouring tips of a spread hand; the device merges nearer tips."""
MOST_TURNED = 50.0
"""Greatest angle (degrees) between a finger and the palm's direction in an open hand; the thumb may
be at 100 degrees."""
MOST_BENT = 60.0
"""Greatest sum of PIP and DIP (degrees) in an open hand whose joints the device reports."""
LEAST_USABLE = 0.5
"""Share of frames in which five fingers must be seen."""

EQUAL_BENDS = 0.1
"""Mean difference (degrees) between PIP and DIP below which they are equal by construction, as in
Leap v2."""

ENOUGH = 20
"""Number of frames with five fingers at their full lengths that suffice to measure a hand."""
LONGEST, NEARLY = 90.0, 0.93
"""Percentile of a finger's lengths that `longest_calibration` takes as the standard length, and
share of the standard length above which the whole finger counts as seen."""

_HOLD_OPEN = "Hold the hand open, palm down, fingers spread, 20 cm above the device"

_OUTLIER = 3.0
"""A length is an outlier if it is twice this number of robust standard deviations or more from the
median. A robust standard deviation is 1.4826 median deviations, but at least 2 mm. A length less
than 12 mm from the median is therefore never an outlier."""


@dataclass(frozen=True)
class HandCalibration:
    """Measurements of one open hand.

    Attributes:
        side: `right` or `left`.
        standard: (5,) m, standard length of every finger. Length ratios are relative to it.
        spread: (5,) m, standard deviation of the lengths.
        tips: (5, 3) m, mean or median positions of the tips in palm coordinates.
        directions: (5, 3) mean or median directions in palm coordinates, of length 1.
        bones: (5, 3) m, lengths of the bones if the device reports joints; None otherwise.
        frames: Number of frames used.
        seconds: Time (s) from the first to the last frame used.
        left_out: Reason -> number of frames not used.
        dialect: Version of the device's software (see `HandFrame`), which decides the coupling of
            joints. None if it is unknown.
        by_tip: True if fingers are solved from the knuckle to the tip, regardless of their measured
            lengths; see `longest_calibration`.
        palm_shift: (3,) m in palm coordinates, from the device's centre of the palm to that of the
            average hand. The knuckles are then those of the average hand. None uses the device's
            centre and measured knuckles.
        coupling: Coupling fitted to the joints that the device reports of this hand; it replaces
            the dialect's coupling. None if it was not fitted.
    """

    side: str
    standard: Array
    spread: Array
    tips: Array
    directions: Array
    bones: Array | None
    frames: int
    seconds: float
    left_out: dict[str, int]
    dialect: str | None = None
    coupling: Coupling | None = None
    by_tip: bool = False
    palm_shift: Vector | None = None

    @property
    def measured(self) -> bool:
        """False if the calibration is from an average hand or from the device's own bones."""
        return self.frames > 0

    @property
    def bases(self) -> Array:
        """Bases (5, 3) m of the visible parts of the fingers, in palm coordinates."""
        return self.tips - self.standard[:, None] * self.directions


def calibrated(
    samples: Iterable[tuple[float, TrackedHand | None]],
    side: str,
    wanted: int = PAPER_FRAMES,
    least: int | None = None,
    dialect: str | None = None,
) -> HandCalibration:
    """Calibrates one hand.

    Args:
        samples: (time in s, the hand or None where it is not seen), one for each frame.
        side: `right` or `left`.
        wanted: Number of frames with five fingers to use.
        least: Least number of such frames; None requires `wanted` frames.
        dialect: Dialect of the frames (see `HandFrame`).

    Raises:
        EncoderError: There are too few frames, the hand was not open, or lengths vary too much.
    """
    left_out: Counter[str] = Counter()
    times: list[float] = []
    rows: list[list[tuple[float, ...]]] = []
    known: list[Array] = []
    for time, hand in samples:
        if len(rows) == wanted:
            break
        if hand is None:
            left_out["the hand was not seen"] += 1
            continue
        if len(hand.fingers) != len(FINGERS):
            left_out["not five fingers"] += 1
            continue
        palm = palm_of(hand, side)
        ordered = in_order(hand, side)
        times.append(time)
        rows.append([(measure(f), *palm.place(f.end), *palm.turn(pointing(f))) for f in ordered])
        if all(f.joints for f in ordered):
            known.append(np.array([f.joints for f in ordered]))
    _enough(len(rows), wanted if least is None else least, left_out, side)
    table = np.array(rows)
    keep = _inliers(table[:, :, 0])
    left_out["lengths far from the others"] = int((~keep).sum())
    table = table[keep]
    lengths = table[:, :, 0]
    spread = 1.4826 * np.median(np.abs(lengths - np.median(lengths, axis=0)), axis=0)
    directions = table[:, :, 4:].mean(axis=0)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    joints = np.array(known) if len(known) == len(rows) else None
    result = HandCalibration(
        side,
        lengths.mean(axis=0),
        spread,
        table[:, :, 1:4].mean(axis=0),
        directions,
        None if joints is None else np.linalg.norm(np.diff(joints, axis=2), axis=3).mean(axis=0),
        len(table),
        times[-1] - times[0],
        {k: v for k, v in left_out.items() if v},
        dialect if joints is None else dialect_of_bones(dialect, joints),
    )
    _check_open(result)
    return result


def longest_calibration(
    samples: Iterable[tuple[float, TrackedHand | None]], side: str, least: int
) -> HandCalibration:
    """Calibrates a hand on all frames of a recording that show five fingers.

    The first software reports varying lengths even for a finger that does not move. In the real
    recording v1-hands, lengths shrink by half while fingertips stay in place within 5 mm, in palm
    coordinates. The standard length is therefore the 90th percentile (`LONGEST`) of the lengths,
    not their mean, and fingers are solved by their tips.

    Args:
        samples: As in `calibrated`.
        side: `right` or `left`.
        least: Least number of frames in which each finger has its full length.

    Raises:
        EncoderError: There are too few frames, or the hand was not open in them.
    """
    times: list[float] = []
    rows: list[list[tuple[float, ...]]] = []
    left_out: Counter[str] = Counter()
    for time, hand in samples:
        if hand is None or len(hand.fingers) != len(FINGERS):
            left_out["the hand was not seen" if hand is None else "not five fingers"] += 1
            continue
        palm = palm_of(hand, side)
        ordered = in_order(hand, side)
        times.append(time)
        rows.append([(measure(f), *palm.place(f.end), *palm.turn(pointing(f))) for f in ordered])
    # Without frames, one row of ones replaces them, and `found` is 0, which raises the error below.
    table = np.array(rows or np.ones((1, len(FINGERS), 7)))
    lengths = table[:, :, 0]
    standard = np.percentile(lengths, LONGEST, axis=0)
    long = lengths > NEARLY * standard
    found = int(long.sum(axis=0).min()) if rows else 0
    if found < least:
        why = ", ".join(f"{n} x {what}" for what, n in left_out.most_common()) or "the frames ended"
        raise EncoderError(
            f"too few frames show five fingers of the {side} hand",
            got=f"{found} of {len(rows) + sum(left_out.values())} ({why})",
            expected=f"{least} with each finger at its full length",
            remedy=_HOLD_OPEN,
        )
    tips = np.array([np.median(table[long[:, f], f, 1:4], axis=0) for f in range(len(FINGERS))])
    along = np.array([np.median(table[long[:, f], f, 4:], axis=0) for f in range(len(FINGERS))])
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    result = HandCalibration(
        side,
        standard,
        np.array([lengths[long[:, f], f].std() for f in range(len(FINGERS))]),
        tips,
        along,
        None,
        len(rows),
        times[-1] - times[0],
        dict(left_out),
        by_tip=True,
    )
    _check_open(result)
    return result


def in_order(hand: TrackedHand, side: str) -> list[TrackedFinger]:
    """The fingers from thumb to little finger, by the device's labels, or else by their order
    across the palm.

    The paper orders fingers by the device's x, which is wrong for a turned hand. The axis across
    the palm points towards the little finger in any orientation of either hand.
    """
    named: dict[int, TrackedFinger] = {f.finger: f for f in hand.fingers if f.finger is not None}
    if len(named) == len(hand.fingers):
        return [named[i] for i in sorted(named)]
    palm = palm_of(hand, side)
    return sorted(hand.fingers, key=lambda f: palm.place(f.end)[0])


def dialect_of_bones(dialect: str | None, joints: Array) -> str | None:
    """The dialect of a device, corrected from the joints (n, 5, 4, 3) that it reported.

    Packed recordings of v2 and v3 have the same fields and are read as v2. Only in v2, the two last
    joints of a finger bend equally.
    """
    apart = float(np.abs(np.diff(_bends(joints), axis=2)).mean())
    return "v3" if dialect == "v2" and apart > EQUAL_BENDS else dialect


def coupling_of_joints(joints: Array) -> Coupling | None:
    """The coupling of PIP and DIP in joints (n, 5, 4, 3) that a device reported.

    Returns:
        The fitted line; None if the fingers hardly bend in these frames.
    """
    bends = _bends(joints)
    pip, dip = bends[..., 0], bends[..., 1]
    bent = pip > LEAST_BENT
    try:
        return Coupling.fitted(pip[bent], dip[bent])
    except EncoderError:
        return None


def _bends(joints: Array) -> Array:
    """Unsigned PIP and DIP angles (n, 4, 2), degrees, of the fingers in joints (n, 5, 4, 3)."""
    bones = np.diff(joints[:, 1:], axis=2)
    bones /= np.maximum(np.linalg.norm(bones, axis=3, keepdims=True), 1e-9)
    cosines = (bones[:, :, 1:] * bones[:, :, :-1]).sum(axis=3)
    return np.asarray(np.rad2deg(np.arccos(np.clip(cosines, -1.0, 1.0))))


def measure(finger: TrackedFinger) -> float:
    """Length (m) of a finger for PAALM, which decreases as the finger bends: the distance from
    knuckle to tip if joints are reported, else the device's length."""
    if finger.joints is None:
        return finger.length
    a, b = finger.joints[0], finger.joints[3]
    return float(np.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2))


def pointing(finger: TrackedFinger) -> tuple[float, float, float]:
    """The direction of the length that `measure` returns."""
    if finger.joints is None:
        return finger.direction
    a, b = finger.joints[0], finger.joints[3]
    length = max(measure(finger), 1e-9)
    return (b[0] - a[0]) / length, (b[1] - a[1]) / length, (b[2] - a[2]) / length


def _enough(usable: int, wanted: int, left_out: Counter[str], side: str) -> None:
    total = usable + sum(left_out.values())
    if usable >= wanted and usable >= LEAST_USABLE * total:
        return
    why = ", ".join(f"{n} x {what}" for what, n in left_out.most_common()) or "the frames ended"
    raise EncoderError(
        f"too few frames show five fingers of the {side} hand",
        got=f"{usable} of {total} ({why})",
        expected=f"{wanted}, and at least half of all",
        remedy=_HOLD_OPEN,
    )


def _inliers(lengths: Array) -> NDArray[np.bool_]:
    middle = np.median(lengths, axis=0)
    deviation = np.abs(lengths - middle)
    scale = np.maximum(1.4826 * np.median(deviation, axis=0), 0.002)
    return np.asarray((deviation < 2 * _OUTLIER * scale).all(axis=1))


def _check_open(c: HandCalibration) -> None:
    """Checks that a hand was held open and still.

    Raises:
        EncoderError: A length varies too much, or a finger is turned, bent or too near to the next.
    """
    remedy = "Hold the hand open, palm down, fingers spread and still, and calibrate again"
    for finger, name in enumerate(FINGERS):
        share = c.spread[finger] / c.standard[finger]
        if share > MOST_SPREAD:
            raise EncoderError(
                f"the {name}'s length varies too much to be a standard",
                where=f"{c.side} hand",
                got=f"{100 * share:.0f} %",
                expected=f"under {100 * MOST_SPREAD:.0f} %",
                remedy=remedy,
            )
        turned = np.degrees(np.arccos(np.clip(c.directions[finger, 1], -1.0, 1.0)))
        most = 100.0 if finger == 0 else MOST_TURNED
        if turned > most:
            raise EncoderError(
                f"the hand was not open: the {name} points away from the palm's direction",
                where=f"{c.side} hand",
                got=f"{turned:.0f} degrees",
                expected=f"under {most:.0f} degrees",
                remedy=remedy,
            )
    apart = np.linalg.norm(np.diff(c.tips, axis=0), axis=1)
    if apart.min() < LEAST_APART:
        raise EncoderError(
            "the fingers were not spread",
            where=f"{c.side} hand",
            got=f"{1000 * apart.min():.0f} mm between neighbours",
            expected=f"over {1000 * LEAST_APART:.0f} mm",
            remedy=remedy,
        )
    if c.bones is not None:
        share = c.standard / c.bones.sum(axis=1)
        # A finger whose PIP and DIP are each bent by MOST_BENT / 2 still has slightly more than
        # this share of its length.
        least = np.cos(np.deg2rad(MOST_BENT / 2.0))
        if share[1:].min() < least:
            raise EncoderError(
                f"the hand was not open: the {FINGERS[1 + int(share[1:].argmin())]} was bent",
                where=f"{c.side} hand",
                got=f"{100 * share[1:].min():.0f} % of its length",
                expected=f"over {100 * least:.0f} %",
                remedy=remedy,
            )
