"""PAALM's angles become a pose of the sandbox's hand that shows those very angles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.paalm import Paalm
from encoders.paalm.angles import angles_of_joints
from encoders.paalm.hand_pose import PALM_CENTRE, hand_pose
from encoders.paalm.hand_reconstructor import HandReconstructor
from encoders.paalm.palm import palm_of
from encoders.reconstruction.hand_motion import Phase
from models.errors import EncoderError
from models.frames import HandFrame, TrackedHand
from models.kinematics import Kinematics
from models.pose import mirrored, violations
from models.rotations import exp
from models.skeleton import ADULT
from tests.support.leap_hands import MIRROR, calibrated, changed_hand, take

FINGER = st.tuples(st.floats(-15, 85), st.floats(-10, 10), st.floats(0, 105), st.floats(-8, 68))
THUMB = st.tuples(st.floats(-35, 35), st.floats(-35, 35), st.floats(0, 70), st.just(0.0))
TURN = st.lists(st.floats(-0.8, 0.8), min_size=3, max_size=3)


def seen_hand(turn: list[float], side: str = "right") -> TrackedHand:
    """A hand turned away from lying flat over the device."""
    R = exp(turn)
    return TrackedHand(
        1, (0.03, -0.02, 0.2), tuple((-R[:, 2]).tolist()), tuple(R[:, 1].tolist()), side=side
    )


def joints_in_palm(q: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """(5, 4, 3) knuckle, PIP, DIP, tip in palm coordinates; the thumb's last bone has no length."""
    placed = Kinematics(ADULT).place(q)
    world = np.empty((5, 4, 3))
    for finger in range(5):
        own = [i for i, b in enumerate(ADULT.bones) if b.finger == finger]
        world[finger, : len(own)] = placed.joints[own]
        world[finger, len(own) :] = placed.tips[finger]
    return (world - q[:3]) @ rotation


@given(st.tuples(THUMB, FINGER, FINGER, FINGER, FINGER), TURN)
def test_the_hands_joints_show_the_angles_it_was_given(
    rows: tuple[tuple[float, float, float, float], ...], turn: list[float]
) -> None:
    palm = palm_of(seen_hand(turn), "right")
    q = hand_pose(rows, palm)
    assert violations(q, ADULT) == 0
    shown = angles_of_joints(joints_in_palm(q, palm.rotation))
    # Ranges of single components of rotation vectors cut a corner where flexion and spread are
    # both large, and spread is measured from each knuckle's own splay.
    np.testing.assert_allclose(shown[:, 2:], np.array(rows)[:, 2:], atol=1e-6)
    np.testing.assert_allclose(shown[1:, 0], np.array(rows)[1:, 0], atol=6.0)


def test_within_the_joints_ranges_every_angle_is_exact() -> None:
    rows = np.array(
        [[5, -5, 20, 0], [30, 4, 40, 30], [35, 0, 50, 20], [20, -4, 30, 10], [25, -9, 60, 40]],
        float,
    )
    palm = palm_of(seen_hand([0.2, -0.1, 0.4]), "right")
    shown = angles_of_joints(joints_in_palm(hand_pose(rows, palm), palm.rotation))
    np.testing.assert_allclose(shown, rows, atol=1e-6)


def test_the_palm_is_the_root_and_the_devices_place_is_added() -> None:
    palm = palm_of(seen_hand([0.0, 0.0, 0.0]), "right")
    q = hand_pose(np.zeros((5, 4)), palm, device=(0.0, 0.5, 1.0))
    np.testing.assert_allclose(q[:3] + PALM_CENTRE, np.add(palm.origin, (0.0, 0.5, 1.0)))
    np.testing.assert_allclose(q[3:6], 0.0, atol=1e-12)


@given(TURN)
def test_a_left_pose_is_the_mirror_image_of_a_right_one(turn: list[float]) -> None:
    rows = np.tile([20.0, 3.0, 30.0, 20.0], (5, 1))
    right = seen_hand(turn)
    left = changed_hand(right, MIRROR)
    np.testing.assert_allclose(
        hand_pose(rows, palm_of(left, "left"), "left"),
        mirrored(hand_pose(rows, palm_of(right, "right"))),
        atol=1e-9,
    )


def test_a_recorded_hand_is_followed_within_the_limits_and_without_jumps() -> None:
    one = take(1)
    followed = HandReconstructor(calibrated(one))
    poses = []
    for frame in one.frames:
        found = followed.step(frame)
        poses.append(found.q)
        assert found.phase is Phase.DOWN
    assert violations(np.array(poses), ADULT).max() == 0
    steps = np.diff(np.array(poses), axis=0).reshape(-1, 16, 3)
    rate = followed.settings.rate
    assert np.linalg.norm(steps[:, 0], axis=1).max() <= rate.linear * 0.0101
    assert np.linalg.norm(steps[:, 2:], axis=2).max() <= rate.angular * 0.0101


def test_a_hand_that_is_gone_holds_its_pose_as_a_ghost_and_reset_forgets_it() -> None:
    one = take(1)
    followed = HandReconstructor(calibrated(one))
    fresh = followed.commanded.copy()
    first = [followed.step(f).q for f in one.frames[:50]]
    gone = followed.step(HandFrame(one.frames[49].time + 1.0))
    assert gone.phase is Phase.AWAY and not gone.fingers
    np.testing.assert_allclose(gone.q, first[-1], atol=0.2)
    followed.reset()
    np.testing.assert_array_equal(followed.commanded, fresh)
    np.testing.assert_array_equal([followed.step(f).q for f in one.frames[:50]], first)


def test_a_side_that_was_not_measured_is_refused() -> None:
    with pytest.raises(EncoderError, match="not calibrated"):
        HandReconstructor(calibrated(take(1)), "left")
    with pytest.raises(EncoderError, match="not calibrated"):
        HandReconstructor(Paalm())
