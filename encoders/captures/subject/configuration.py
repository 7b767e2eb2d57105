"""Settings of the simulated subject, with units.

Numbers of frames and the screen are the paper's (Chung, Kim, Han, Pollard 2015, sections 3 and 4).
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
        training_frames: Frames with 2, 3, 4 and 5 fingers on day 0; 7,083 in total, as in the
            paper. The paper prints 2,020 for 3 fingers and 874 for 4; the numbers for 2 and 5
            fingers are ours.
        test_frames: Frames with 2, 3, 4 and 5 fingers on every later day; 2,538 in total, as in the
            paper.
        training_rate: Frame rate (Hz) of day 0. Successive frames are nearly equal, so the script
            is sampled slowly: 7,083 frames last 8 minutes. At 30 Hz they would last 4.
        test_rate: Rate (Hz) of later days.
        five_finger_repeats: Number of clips of each gesture with all five fingers. Other finger
            sets have one clip of each gesture.
        take_length: Mean duration (s) of a take on a later day.
        stay: Least and greatest time (s) between two changes of the touching fingers on later days.
        transition: Time (s) from resting on the surface to fully lifted.

        move: Amplitude (m) of the hand's path over the surface.
        turn: Amplitude (rad) of the hand's turn about the surface's normal.
        grasp: Amplitude of opening and closing, as a share of the natural span.
        grasp_closed: Bias of grasps: at 0 the hand opens as much as it closes, at 1 it only closes.
        widest: Greatest span, as a share of the natural span.
        pinch: Amplitude of the approach of thumb and fingers, as a share of their distance.
        pinch_closed: Bias of pinches, as `grasp_closed`.
        pinch_least: Least closing of a pinch, as a share of the natural distance. A negative value
            is an opening.
        placing: Standard deviation (m) of the place at which each fingertip is put down, from take
            to take.
        wobble: Standard deviation (m) of each fingertip's own path about the layout within a take.
        tip_width: Least distance (m) between the middles of two fingertips, so that fingers do not
            overlap.
        aside: Largest amplitude of the other three gestures in a clip of one gesture, as a share of
            their full amplitudes.
        swing: Least and greatest duration (s) of one stroke of a gesture.
        variety: Least and greatest factor on a stroke's amplitude.
        greatest_turn: Limit of the forearm's rotation (rad).
        free_amplitude: Amplitude of free-form gestures relative to the script's.

        root_position_spread: Spread (m) of the wrist's x, y, z about its place over the layout.
        root_rotation_spread: Spread (rad) of pitch, roll and yaw.
        synergy_spread: Spreads (rad) of the six synergies: flexing all fingers; knuckles against
            middle joints; index side against little side; opposing the thumb; spreading; flexing
            the thumb.
        finger_spread: Spreads (rad) of MCP flexion, MCP abduction, PIP and DIP, in addition to the
            synergies.
        thumb_spread: Spreads (rad) of CMC flexion, abduction and twist, MCP flexion and abduction,
            in addition to the synergies.
        neighbour: Correlation of `finger_spread` between neighbouring fingers.
        hinge_tilt: Spread (rad) of the hinges' axes about the axes of their bones.
        style: Spread of the intended posture from take to take, as a share of the spread of all
            postures (the preceding settings).
        sway: Spread of the intended posture within a take, as a share of the same spread.
        root_variety: Factor on the changes of the root in the intended posture. Arm and wrist vary
            more than the preceding spreads suggest, and the fingers compensate.
        sway_time: Time (s) over which the sway changes.
        arm_turn: Share of the touches' turn that the hand makes.
        elbow: Weight of the direction from elbow to hand in the hand's yaw.
        elbow_distance: Distance (m) from the elbow to the near edge of the surface.

        contact_precision: Precision (m) with which a touching fingertip meets its target.
        lift_precision: Precision (m) with which a lifted fingertip holds its height.
        lift_height: Least and greatest height of lifted fingertips (m).
        curl_share: Share of takes that lift fingers by curling rather than by stretching them.
        lift_posture: Angle (rad) by which a lifted finger's joints turn towards curling or
            stretching.
        tip_height: Height (m) of the centre of a touching fingertip's end sphere above the surface:
            its radius minus the compression of the flesh.

        pad_roll: Distance (m) along the surface from the fingertip's centre to the middle of the
            touch when the finger lies flat.
        touch_noise: Noise of touch positions (m).
        touch_resolution: Resolution (dots per inch) of the reported position; an iPad 2 has 132.
        soft_tissue: Slow error (rad) of joint angles. Its cause is that markers move with the skin.
        soft_tissue_time: Time (s) over which the slow error changes.
        joint_noise: Fast error (rad) of joint angles.
        root_noise: Fast error (m and rad) of the root.

        tip_marker: Precision (m) with which the capture system's skeleton meets the fingertips'
            markers.

        day_joint: Error (rad) of joint angles that is constant on a later day, since markers are
            placed anew every day.
        day_root: Errors (m and rad) of the root that are constant on a later day.
        day_style: Shift of the intended posture on a later day, as a share of the spread of all
            postures.
        day_elbow: Standard deviation (m) of the elbow's place on a later day, along each axis.
        day_yaw: Standard deviation (rad) of the change of the hand's yaw on a later day.
        free_style: Concentration of the Dirichlet mixture of gestures; below 1, one gesture
            dominates.
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
