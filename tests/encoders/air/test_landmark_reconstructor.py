"""Landmarks as a source of poses in the world: sides, losses, and the table."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from encoders.air.camera import Camera
from encoders.air.reconstructors import LandmarkReconstructor
from encoders.reconstruction.hand_motion import Phase
from encoders.reconstruction.reconstructor import Reconstruction
from models.frames import LandmarkFrame, SeenHand
from models.kinematics import Kinematics
from models.pose import mirrored
from models.skeleton import ADULT
from tests.encoders.air.seen_hands import SIZE, held_up, landmarks, mirror, seen

CAMERA = Camera(at=(0.0, 0.45, 0.15))
PERIOD = 0.016


def watched(
    reconstructor: LandmarkReconstructor, frames: list[LandmarkFrame], seconds: float
) -> Reconstruction:
    """The reconstruction after frames that come one after another, 30 a second."""
    last = None
    for step in range(round(seconds / PERIOD)):
        time = step * PERIOD
        frame = frames[min(int(time * 30), len(frames) - 1)]
        last = reconstructor.step(replace(frame, time=time))
    return last


def still(hands: list[SeenHand], count: int = 60) -> list[LandmarkFrame]:
    return [LandmarkFrame(0.0, tuple(hands), SIZE, i / 30) for i in range(count)]


def test_the_hand_is_in_the_world_where_the_camera_sees_it() -> None:
    q = held_up(25.0)
    found = watched(LandmarkReconstructor(CAMERA), still([seen(q, CAMERA)]), 1.5)
    tips = CAMERA.seen(Kinematics(ADULT).tips(found.q))
    true = landmarks(q)[[4, 8, 12, 16, 20]]
    assert np.median(np.linalg.norm(tips - true, axis=1)) < 0.02
    assert found.phase is Phase.DOWN and len(found.fingers) == 5


def test_a_left_hand_is_the_mirror_image_of_a_right_one() -> None:
    hand = seen(held_up(40.0, (0.2, 0.1, 0.3)), CAMERA)
    right = watched(LandmarkReconstructor(CAMERA), still([hand]), 1.0)
    left = watched(LandmarkReconstructor(CAMERA, "left"), still([mirror(hand)]), 1.0)
    assert left.q == pytest.approx(mirrored(right.q), abs=1e-9)


def test_a_hand_whose_side_flickers_is_followed_on() -> None:
    hand = seen(held_up(40.0), CAMERA)
    steady = watched(LandmarkReconstructor(CAMERA), still([hand]), 1.0)
    frames = still([hand])
    for i in range(10, 60, 3):
        frames[i] = replace(frames[i], hands=(replace(hand, side="left"),))
    flickering = watched(LandmarkReconstructor(CAMERA), frames, 1.0)
    assert flickering.q.tobytes() == steady.q.tobytes()


def test_the_other_hand_alone_is_not_taken_for_this_one() -> None:
    hand = replace(seen(held_up(40.0), CAMERA), side="left")
    reconstructor = LandmarkReconstructor(CAMERA)
    found = watched(reconstructor, still([hand]), 2.0)
    assert found.phase is Phase.AWAY
    assert "right hand is not seen" in reconstructor.notice


def test_of_two_hands_of_one_side_the_one_that_was_followed_goes_on_beside_the_other_side() -> None:
    mine = seen(held_up(40.0), CAMERA)
    other = replace(mine, image=tuple((x + 200.0, y) for x, y in mine.image), score=1.0)
    frames = still([mirror(mine), mine], 15) + [
        LandmarkFrame(0.0, (other, mine), SIZE, i / 30) for i in range(15, 60)
    ]
    reconstructor = LandmarkReconstructor(CAMERA)
    alone = watched(LandmarkReconstructor(CAMERA), still([mine]), 1.0)
    assert watched(reconstructor, frames, 1.0).q.tobytes() == alone.q.tobytes()
    assert reconstructor.counts["further hands of the same side"] > 0


def test_a_lost_hand_stays_for_a_moment_and_then_rises_as_a_ghost() -> None:
    hand = seen(held_up(40.0), CAMERA)
    frames = still([hand], 30) + [LandmarkFrame(0.0, (), SIZE, i / 30) for i in range(30, 90)]
    early = watched(LandmarkReconstructor(CAMERA), frames, 1.2)
    late = watched(LandmarkReconstructor(CAMERA), frames, 2.5)
    assert early.phase is Phase.DOWN
    assert late.phase is Phase.AWAY
    assert late.q[2] - early.q[2] == pytest.approx(0.08, abs=0.005)


def test_a_reset_forgets_everything() -> None:
    hand = seen(held_up(40.0, (0.1, 0.2, 0.0)), CAMERA)
    reconstructor = LandmarkReconstructor(CAMERA)
    first = watched(reconstructor, still([hand]), 1.0)
    reconstructor.reset()
    assert watched(reconstructor, still([hand]), 1.0).q.tobytes() == first.q.tobytes()


def test_pictures_without_the_hand_are_counted_and_not_the_steps_that_see_them() -> None:
    reconstructor = LandmarkReconstructor(CAMERA)
    for step in range(20):
        reconstructor.step(replace(reconstructor.empty, time=step * PERIOD))
    assert not reconstructor.counts
    for step in range(20, 40):
        reconstructor.step(LandmarkFrame(step * PERIOD, (), SIZE, 1.0 + step // 10))
    assert dict(reconstructor.counts) == {"pictures without the hand": 2}


def test_fingertips_are_never_commanded_below_the_table() -> None:
    low = Camera(at=(0.0, 0.45, -0.30))
    found = watched(LandmarkReconstructor(low), still([seen(held_up(25.0), low)]), 1.5)
    tips = Kinematics(ADULT).tips(found.q)
    assert (tips[:, 2] - ADULT.tip_radius).min() > -1e-9
