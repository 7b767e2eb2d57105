"""Settings of the simulated subject, with units.

Sizes of sets and of the screen are the paper's (Chung, Kim, Han, Pollard 2015, sections 3 and 4).
All other values are guesses about the movement of a hand, of a plausible order of magnitude.
Amplitudes and spreads were tuned until principal components and the paper's own method came near
the paper's numbers (docs/encoding.md names the seeds), and were then frozen.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

SEED = 0
"""Seed of the capture on which the built-in models are trained."""


@dataclass(frozen=True)
class SubjectConfiguration:
    """Settings of movement, measurement and tasks of the subject.

    Attributes:
        training_frames: Frames with 2, 3, 4 and 5 fingers on day 0; 7,083 in total, as in the paper
            (its 2,020 and 874 are printed; the split of the rest between 2 and 5 fingers is ours).
        test_frames: The same for every later day; 2,538 in total, as in the paper.
        training_rate: Frame rate (Hz) of day 0. Successive frames are nearly equal, so the script
            is sampled slowly: 7,083 frames last 8 minutes rather than 4.
        test_rate: Rate (Hz) of later days.
        five_finger_repeats: Clips of each gesture with all fingers; other sets have one.
        take_length: Mean length of a take of a later day (s).
        stay: Least and greatest time (s) between two changes of the touching fingers on later days.
        transition: Time (s) from resting on the surface to fully lifted.

        move: Amplitude (m) of the hand's path over the surface.
        turn: Amplitude (rad) of the hand's turn about the surface's normal.
        grasp: Amplitude of opening and closing, as a share of the natural span.
        grasp_closed: Bias towards closing: 0 opens as much as it closes, 1 only closes.
        widest: Greatest span, as a share of the natural span.
        pinch: Amplitude of the approach of thumb and fingers, as a share of their distance.
        pinch_closed: As `grasp_closed`; at 1 a pinch never opens beyond the natural distance.
        pinch_least: Widest pinch, as a share of the distance that is added, thus negative.
        placing: Standard deviation (m) of the place at which each fingertip is put down, from take
            to take.
        wobble: Standard deviation (m) of each fingertip's own path about the layout within a take.
        tip_width: Least distance (m) between two fingertips' middles, so that fingers do not
            overlap.
        aside: Share of the other gestures in a clip of one gesture.
        swing: Least and greatest duration (s) of one stroke of a gesture.
        variety: Least and greatest factor on a stroke's amplitude.
        greatest_turn: Limit of the forearm's rotation (rad).
        free_amplitude: Amplitude of free-form gestures relative to the script's.

        root_position_spread: Spread (m) of wrist x, y, z about its place over the layout.
        root_rotation_spread: Spread (rad) of pitch, roll and yaw.
        synergy_spread: Spread (rad) of flexing all fingers; knuckles against the middle joints;
            index side against little side; opposing the thumb; spreading; flexing the thumb.
        finger_spread: Spread (rad) of MCP flexion, MCP abduction, PIP and DIP beyond the synergies.
        thumb_spread: Spread (rad) of CMC flexion, abduction, twist, MCP flexion, abduction beyond
            the synergies.
        neighbour: Correlation of that remaining spread between neighbouring fingers.
        hinge_tilt: Spread of the hinges' axes about the bones' own (rad).
        style: Spread of the intended posture, from take to take, as a share of the prior's.
        sway: Spread of the intended posture within a take, as a share of the prior's.
        root_variety: Factor on `style` and `sway` for the root: arm and wrist vary more than their
            stiffness relative to the fingers suggests, and the fingers compensate.
        sway_time: Time (s) over which the sway changes.
        arm_turn: Share of the surface's turn that the hand makes.
        elbow: Weight of the direction from elbow to hand in the hand's yaw.
        elbow_distance: Distance (m) from the elbow to the near edge of the surface.

        contact_precision: Precision (m) with which a touching fingertip meets its target.
        lift_precision: Precision (m) with which a lifted fingertip holds its height.
        lift_height: Least and greatest height of lifted fingertips (m).
        curl_share: Share of takes that lift fingers by curling rather than by stretching them.
        lift_posture: Angle (rad) by which a lifted finger's joints turn towards curling or
            stretching.
        tip_height: Height (m) of the centre of a touching fingertip's end sphere above the surface:
            its radius less the flesh that the surface flattens.

        pad_roll: Distance (m) from the fingertip's centre to that of the touch when the finger lies
            flat.
        touch_noise: Noise of touch positions (m).
        touch_resolution: Resolution (dots per inch) of the reported position; an iPad 2 has 132.
        soft_tissue: Slow error (rad) of joint angles, because markers move with the skin.
        soft_tissue_time: Time (s) over which the slow error changes.
        joint_noise: Fast error (rad) of joint angles.
        root_noise: Fast error (m and rad) of the root.

        tip_marker: Precision (m) with which the capture system's skeleton meets the fingertips'
            markers.

        day_joint: Constant error (rad) of joint angles of another day: markers are placed anew.
        day_root: Constant error (m and rad) of the root of another day.
        day_style: Shift of the intended posture on another day, as a share of the prior's spread.
        day_elbow: Standard deviation (m) of the elbow's place on another day, along each axis.
        day_yaw: Standard deviation (rad) of the change of the hand's yaw on another day.
        free_style: Concentration of the mixture of gestures; below 1, one dominates.
        natural: Exponent on the naturalness of a finger set when the subject chooses freely.
    """

    training_frames: tuple[int, int, int, int] = (2500, 2020, 874, 1689)
    test_frames: tuple[int, int, int, int] = (640, 720, 430, 748)
    training_rate: float = 15.0
    test_rate: float = 30.0
    five_finger_repeats: int = 6
    take_length: float = 5.5
    stay: tuple[float, float] = (0.8, 2.4)
    transition: float = 0.20

    move: float = 0.032
    turn: float = 1.05
    grasp: float = 0.60
    grasp_closed: float = 0.2
    widest: float = 1.4
    pinch: float = 0.70
    pinch_closed: float = 0.5
    pinch_least: float = -0.35
    placing: float = 0.0045
    wobble: float = 0.0025
    tip_width: float = 0.014
    aside: float = 0.15
    swing: tuple[float, float] = (0.5, 1.0)
    variety: tuple[float, float] = (0.6, 1.3)
    greatest_turn: float = 2.5
    free_amplitude: float = 1.6

    root_position_spread: tuple[float, float, float] = (0.030, 0.040, 0.014)
    root_rotation_spread: tuple[float, float, float] = (0.22, 0.20, 0.28)
    synergy_spread: tuple[float, float, float, float, float, float] = (
        0.125,
        0.200,
        0.220,
        0.260,
        0.175,
        0.165,
    )
    finger_spread: tuple[float, float, float, float] = (0.070, 0.060, 0.075, 0.060)
    thumb_spread: tuple[float, float, float, float, float] = (0.087, 0.087, 0.070, 0.087, 0.035)
    neighbour: float = 0.5
    hinge_tilt: float = 0.035
    style: float = 0.26
    sway: float = 0.45
    root_variety: float = 1.9
    sway_time: float = 0.4
    arm_turn: float = 0.95
    elbow: float = 0.05
    elbow_distance: float = 0.25

    contact_precision: float = 0.0005
    lift_precision: float = 0.008
    lift_height: tuple[float, float] = (0.016, 0.040)
    curl_share: float = 0.25
    lift_posture: float = 0.25
    tip_height: float = 0.006

    pad_roll: float = 0.0035
    touch_noise: float = 0.0002
    touch_resolution: float = 132.0
    soft_tissue: float = 0.0175
    soft_tissue_time: float = 0.5
    joint_noise: float = 0.006
    root_noise: tuple[float, float] = (0.0005, 0.004)

    tip_marker: float = 0.003

    day_joint: float = 0.0345
    day_root: tuple[float, float] = (0.007, 0.026)
    day_style: float = 0.35
    day_elbow: float = 0.03
    day_yaw: float = 0.087
    free_style: float = 0.8
    natural: float = 2.0

    def as_json(self) -> dict[str, Any]:
        """The configuration as JSON values, for a capture's `meta`."""
        return asdict(self)


FROZEN = SubjectConfiguration()
"""The configuration of the built-in captures."""
