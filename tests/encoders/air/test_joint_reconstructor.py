"""A headset's joints as a reconstructor: sides and absence."""

from __future__ import annotations

import numpy as np
import pytest

from encoders.air.joint_fit import TIPS
from encoders.air.reconstructors import JointReconstructor
from encoders.reconstruction.followed_hand import UNSEEN_NOTICE
from encoders.reconstruction.hand_motion import Phase
from encoders.reconstruction.reconstructor import Reconstruction
from models.frames import HandFrame, TrackedHand
from models.kinematics import Kinematics
from models.pose import ROOT_POSITION
from models.skeleton import ADULT
from tests.encoders.air.joint_hands import any_pose, points, seen

STEP = 0.016
MIRROR = np.array([-1.0, 1.0, 1.0])


def high(seed: int) -> np.ndarray:
    """A pose well above the table."""
    q = any_pose(np.random.default_rng(seed))
    q[ROOT_POSITION] = 0.03, -0.1, 0.4
    return q


def play(
    reconstructor: JointReconstructor, hands: tuple[TrackedHand, ...], steps: int, at: float = 0.0
) -> Reconstruction:
    for i in range(steps):
        result = reconstructor.step(HandFrame(at + i * STEP, hands))
    return result


def test_the_hand_goes_where_the_joints_are() -> None:
    q = high(1)
    result = play(JointReconstructor(), (seen(points(q)),), 40)
    tips = Kinematics(ADULT).tips(result.q)
    assert tips == pytest.approx(points(q)[TIPS:], abs=0.0005)
    assert result.phase is Phase.DOWN and len(result.fingers) == 5


def test_a_left_hand_is_the_mirror_image_of_a_right_one() -> None:
    q = high(2)
    right = play(JointReconstructor("right"), (seen(points(q)),), 40)
    left = play(JointReconstructor("left"), (seen(points(q) * MIRROR, "left"),), 40)
    mirror = Kinematics(ADULT.mirrored()).tips(left.q)
    assert mirror == pytest.approx(Kinematics(ADULT).tips(right.q) * MIRROR, abs=1e-9)


def test_each_hand_takes_its_own_side_of_two() -> None:
    both = (seen(points(high(3)) * MIRROR, "left"), seen(points(high(4))))
    alone = play(JointReconstructor("right"), both[1:], 30)
    assert play(JointReconstructor("right"), both, 30).q.tobytes() == alone.q.tobytes()


def test_a_lost_hand_waits_and_then_is_a_ghost_with_a_notice() -> None:
    reconstructor = JointReconstructor()
    play(reconstructor, (seen(points(high(5))),), 40)
    assert play(reconstructor, (), 10, 40 * STEP).phase is Phase.DOWN
    result = play(reconstructor, (), int((UNSEEN_NOTICE + 1.0) / STEP), 50 * STEP)
    assert result.phase is Phase.AWAY and not result.fingers
    assert "not seen" in reconstructor.notice


def test_a_hand_under_the_table_is_raised() -> None:
    q = high(6)
    q[ROOT_POSITION] = 0.0, 0.0, -0.1
    result = play(JointReconstructor(), (seen(points(q)),), 60)
    tips = Kinematics(ADULT).tips(result.q)[:, 2]
    assert (tips - ADULT.tip_radius).min() > -1e-6


def test_a_hand_without_a_palm_is_counted() -> None:
    hand = seen(points(high(7)))
    reconstructor = JointReconstructor()
    bare = TrackedHand(0, hand.palm, hand.normal, hand.direction, (), "right")
    assert play(reconstructor, (bare,), 5).phase is Phase.AWAY
    assert reconstructor.counts == {"hands without a palm": 1}
