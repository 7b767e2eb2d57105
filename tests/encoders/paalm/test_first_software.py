"""Real recordings of the first software: sides, names, palms, and hands that no longer claw."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from encoders.evaluation.paalm_errors import plausibility
from encoders.paalm import Paalm, PaalmOptions
from encoders.paalm.average import average_calibration
from encoders.paalm.identity import HandSides
from encoders.paalm.palm import palm_of
from encoders.paalm.rig import average_knuckle
from encoders.paalm.seen_palm import FIRST_SHIFT, LearnedPalm
from sandbox.devices.leap.leap_file import read_leap
from tests.support.leap_hands import MIRROR, changed_hand, real_take, take


@pytest.mark.parametrize("live", [False, True])
def test_a_real_hand_is_plausible(live: bool, shared_data: Path) -> None:
    frames = read_leap(shared_data / "leap" / "v1-hands.json").frames
    found = plausibility(frames, live=live)
    assert live or found.remark == ""
    assert found.fingers > 3000
    assert found.backward < 0.08 and found.claws < 0.05 and found.at_limit < 0.05
    assert found.tips < 0.005


def test_of_two_real_hands_the_thumbs_tell_the_sides(shared_data: Path) -> None:
    frames = read_leap(shared_data / "leap" / "v1-hands.json").frames
    sides = HandSides(("right", "left"))
    said = [(h.id, side) for f in frames for side, h in sides.choose(f).items()]
    late = said[60:]
    assert {(2, "right"), (8, "left")} == set(late)


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_lone_hand_has_the_side_of_its_thumb_wherever_it_is(side: str) -> None:
    one = take(0, drop_outs=False)
    sides = HandSides(("right", "left"))
    for frame in one.frames[:30]:
        (hand,) = frame.hands
        hand = changed_hand(hand, np.eye(3), shift=(-0.15, 0.0, 0.0))
        if side == "left":
            hand = changed_hand(hand, MIRROR)
        chosen = sides.choose(replace(frame, hands=(hand,)))
    assert set(chosen) == {side}


def test_a_palm_whose_fingers_are_behind_it_is_turned_round() -> None:
    (hand,) = take(0, drop_outs=False).frames[5].hands
    x, y, z = hand.direction
    a, b, c = hand.normal
    wrong = replace(hand, direction=(-x, -y, -z), normal=(-a, -b, -c))
    for f in hand.fingers:
        np.testing.assert_allclose(
            palm_of(wrong, "right").place(f.tip), palm_of(hand, "right").place(f.tip), atol=1e-12
        )


def test_an_unmeasured_hand_learns_where_its_palm_is_seen_and_how_long_its_fingers_are() -> None:
    one = real_take(5)
    paalm, fixed = Paalm(), Paalm(PaalmOptions(learns=False))
    for each in (paalm, fixed):
        each.use({"right": average_calibration((), "right", each.options)})
    off: dict[int, list[float]] = {id(paalm): [], id(fixed): []}
    later = [replace(f, time=f.time + 12.0) for f in one.frames]
    for frame in (*one.frames, *later):
        (hand,) = frame.hands
        for each in (paalm, fixed):
            found = each.step(frame).hands["right"]
            place = palm_of(hand, "right").place(found.palm.origin)
            off[id(each)].append(float(np.linalg.norm(np.subtract(place, FIRST_SHIFT))))
    step = np.abs(np.diff(off[id(paalm)]) - np.diff(off[id(fixed)]))
    assert step.max() < 0.02, "what is learned moves the hand slowly"
    learned = paalm._hands["right"]._standard
    longest = np.zeros(5)
    for frame, names in zip(one.frames, one.fingers, strict=True):
        for f in frame.hands[0].fingers:
            longest[names[f.id]] = max(longest[names[f.id]], f.length)
    np.testing.assert_allclose(learned, longest, rtol=0.1)


def test_a_palm_is_learned_slowly_from_fingers_that_point_back_to_their_knuckles() -> None:
    knuckles = [average_knuckle(finger) for finger in range(5)]
    learned = LearnedPalm(FIRST_SHIFT, [0.07] * 5, [0.0] * 5, knuckles)
    truth = (0.002, -0.045, 0.001)
    for _ in range(3000):
        for name, knuckle in enumerate(knuckles):
            x, y, z = np.add(knuckle, truth).tolist()
            learned.add(name, 0.0705, (x, y + 0.0705, z), (0.0, 1.0, 0.0))
            learned.add(name, 0.03, (x, y + 0.0705, z), (0.0, 1.0, 0.0))
            # The palm the wrong way round, for a moment.
            learned.add(name, 0.0705, (x, y - 0.05, z), (0.0, 1.0, 0.0))
        before = learned.shift
        learned.move()
        assert np.abs(np.subtract(before, learned.shift)).max() < 3e-4
    np.testing.assert_allclose(learned.shift, truth, atol=0.001)
    np.testing.assert_allclose(learned.standard, 0.0705, atol=0.001)
