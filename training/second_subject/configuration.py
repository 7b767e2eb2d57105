"""Settings of the second simulated subject, with units.

Frame counts are the paper's (Chung, Kim, Han, Pollard 2015, section 4; its split between two and
five fingers is ours). All else is a guess at how a hand is moved and measured. Amplitudes were set
while looking at seeds 0 to 2, after the bands in docs/encoding.md had been fixed.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

SEED = 0
"""Seed of the subject in examples and tests."""


@dataclass(frozen=True)
class SecondConfiguration:
    """Settings of movement, measurement and tasks of second subjects.

    A spread is the half width of a uniform habit, or the scale of a heavy-tailed variation.

    Attributes:
        training_frames: Frames of day 0 with 2, 3, 4 and 5 fingers.
        test_frames: The same for every later day.
        training_rate: Hz of day 0.
        test_rate: Hz of later days.
        five_finger_repeats: Clips of each gesture with all fingers.
        stay: s, least and greatest time between two changes of the touching fingers.
        take_length: s, after which a take of a later day ends at the next change.
        landing: s, in which a finger comes down before it touches, and rises afterwards.

        pace: s, least and greatest time from one keyframe to the next.
        strength: Least and greatest share of a grip, relative to the relaxed hand.
        bold: Share of keyframes with the full grip.
        whim: Share of keyframes with another grip than the take's.
        calm: Factor on strength, rotations and movements in free play.
        way: m, half width and half height of the area in which the fingers' middle moves.
        turn: rad, least and greatest yaw of turning, 0 straight away from the person.
        bias: rad, half range of the yaw that a take with another gesture keeps to.
        forearm: Share of the direction from elbow to fingers in the yaw.
        elbow: m, from the near edge of the screen to the elbow.

        habit: Spread of a take's manner, in the order of `manners.MANNERS` (rad; the last in m).
        variety: Scale of the manner's change from keyframe to keyframe, likewise.
        drift: Greatest step of a habit from take to take, as a share of its spread.
        tail: Degrees of freedom of the Student distribution of the variety.

        tip_width: m, distance that fingertips keep.
        tip_height: m, middle of a touching fingertip above the screen.
        wrist: m, least height of the wrist, where the heel of the hand rests on the table.
        level: Share of the tilt that would level the touching fingertips that the palm follows.
        clearance: m, least height of a lifted fingertip's middle above a touching one's.
        raise_: rad, least and greatest angle by which a subject lifts one of its fingers.
        lift_variety: Least and greatest factor on that from take to take.
        curl: Share of fingers that are lifted by curling.
        coupling: Least and greatest share of its neighbours' bending that a lifted finger follows.

        pad: m, from fingertip's middle to the touch's with the finger flat on the screen.
        jitter: m, of touches.
        jitter_memory: Correlation of that from frame to frame at 30 Hz.
        grid: m, in which the screen reports touches.
        marker: m, constant error of each marker's place on the skin, drawn anew every day.
        palm_marker: m, the same of the wrist's and the palm's markers.
        tremble: m, fast error of markers.

        day_manner: Shift of all habits on another day, as a share of their spread.
        day_elbow: m, by which the subject sits elsewhere.
        taste: Scale of a subject's preferences among finger sets.
    """

    training_frames: tuple[int, int, int, int] = (2500, 2020, 874, 1689)
    test_frames: tuple[int, int, int, int] = (640, 720, 430, 748)
    training_rate: float = 10.0
    test_rate: float = 30.0
    five_finger_repeats: int = 6
    stay: tuple[float, float] = (0.5, 1.6)
    take_length: float = 5.0
    landing: float = 0.18

    pace: tuple[float, float] = (0.45, 1.0)
    strength: tuple[float, float] = (0.30, 0.75)
    bold: float = 0.05
    whim: float = 0.7
    calm: float = 0.75
    way: tuple[float, float] = (0.055, 0.035)
    turn: tuple[float, float] = (-0.75, 0.9)
    bias: float = 0.15
    forearm: float = 0.5
    elbow: float = 0.28

    habit: tuple[float, ...] = (
        0.05,
        0.08,
        0.02,
        0.024,
        0.055,
        0.03,
        0.04,
        0.04,
        0.04,
        0.05,
        0.17,
        0.06,
        0.006,
    )
    variety: tuple[float, ...] = (
        0.035,
        0.055,
        0.02,
        0.03,
        0.035,
        0.03,
        0.035,
        0.035,
        0.035,
        0.035,
        0.05,
        0.035,
        0.0035,
    )
    drift: float = 0.8
    tail: float = 4.0

    tip_width: float = 0.015
    tip_height: float = 0.0055
    wrist: float = 0.035
    level: float = 0.6
    clearance: float = 0.008
    raise_: tuple[float, float] = (0.10, 0.35)
    lift_variety: tuple[float, float] = (0.9, 1.1)
    curl: float = 0.3
    coupling: tuple[float, float] = (0.3, 0.7)

    pad: float = 0.0045
    jitter: float = 0.00025
    jitter_memory: float = 0.6
    grid: float = 0.00025
    marker: float = 0.0004
    palm_marker: float = 0.0012
    tremble: float = 0.0002

    day_manner: float = 0.3
    day_elbow: float = 0.025
    taste: float = 0.25

    def as_json(self) -> dict[str, Any]:
        """The configuration as JSON values, for a capture's `meta`."""
        return {k: list(v) if isinstance(v, tuple) else v for k, v in asdict(self).items()}


FROZEN = SecondConfiguration()
"""The configuration of all captures in reports."""
