"""Settings of the second simulated subject, with units.

Numbers of frames are those of the paper (Chung, Kim, Han, Pollard 2015, section 4); their division
among 2, 3, 4 and 5 fingers is an assumption. All other values are assumptions about how people
move a hand and how it is measured. Amplitudes were set by looking at seeds 0 to 2, after the bands
in docs/encoding.md had been fixed.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

SEED = 0
"""Seed of the subject in examples and tests."""


@dataclass(frozen=True)
class SecondConfiguration:
    """Settings of movement, measurement and tasks of second subjects.

    Habits are drawn uniformly, and their spread is the half width. Variations are heavy-tailed, and
    their spread is the scale.

    Attributes:
        training_frames: Number of frames of day 0 with 2, 3, 4 and 5 fingers.
        test_frames: Number of frames of every later day with 2, 3, 4 and 5 fingers.
        training_rate: Rate (Hz) of day 0.
        test_rate: Rate (Hz) of later days.
        five_finger_repeats: Number of clips of each gesture with all fingers.
        stay: Least and greatest time (s) between two changes of the touching fingers.
        take_length: Time (s) after which a take of a later day ends at the next change.
        landing: Time (s) in which a finger comes down before it touches, and in which it rises
            afterwards.

        pace: Least and greatest time (s) from one keyframe to the next.
        strength: Least and greatest strength of a grip: 0 is the relaxed hand, 1 the full grip.
        bold: Share of keyframes with a strength of 1.15.
        whim: Share of keyframes in which a random grip replaces the take's grip.
        calm: Factor on strength, rotations and movements in free play.
        way: Half width and half height (m) of the area in which the middle of the fingertips moves.
        turn: Least and greatest yaw (rad) of the gesture `rotate`; 0 is straight away from the
            person.
        bias: Half range of the mean yaw (rad) of a take without the gesture `rotate`.
        forearm: The yaw follows the direction from elbow to fingers by this share.
        elbow: Distance (m) from the near edge of the screen to the elbow.

        habit: Spread of a take's manner, in the order of `grips.MANNERS` (rad; the last in m).
        variety: Scale of the manner's change from keyframe to keyframe, in the same order and
            units.
        drift: Largest step of a habit from take to take, as a share of its spread.
        tail: Degrees of freedom of the Student distribution of the variety.

        tip_width: Least distance (m) between fingertips.
        tip_height: Height (m) of the middle of a touching fingertip above the screen.
        wrist: Least height (m) of the wrist, at which the heel of the hand rests on the table.
        level: The palm is rotated by this share of the rotation that would bring the touching
            fingertips to the same height.
        clearance: Least height (m) of the middle of a lifted fingertip above that of a touching
            fingertip.
        raise_: Least and greatest angle (rad) by which a subject lifts a finger.
        lift_variety: Least and greatest factor on this angle in a take.
        curl: Share of fingers that are lifted by curling.
        coupling: A lifted finger takes over a share of its neighbours' bend: least and greatest
            share.

        pad: Distance (m) from the middle of a fingertip to the middle of its touch, for a finger
            that is flat on the screen.
        jitter: Noise (m) of touches.
        jitter_memory: Correlation of this noise between successive frames at 30 Hz.
        grid: Spacing (m) of the grid on which the screen reports touches.
        marker: Constant error (m) of each marker's place on the skin, drawn again every day.
        palm_marker: The same error (m) for the markers of wrist and palm.
        tremble: Fast error (m) of markers.

        day_manner: Shift of all habits on another day, as a share of their spread.
        day_elbow: Scale (m) of the shift of the subject's elbow on another day.
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
