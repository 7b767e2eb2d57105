"""PAALM measures a hand, names its fingers, holds what vanishes, and says what it refuses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from encoders import Paalm
from encoders.evaluation.paalm_errors import (
    judge_recording,
    moved,
    side_by_side,
)
from encoders.paalm import Coupling, PaalmOptions
from encoders.paalm.average import average_calibration
from encoders.paalm.calibration_file import read_calibration, write_calibration
from encoders.paalm.simulated import air
from encoders.paalm.simulated.air import simulate_air
from encoders.paalm.simulated.forward import PRINTED_LEAP, LeapTake, leap_take
from models.errors import EncoderError
from models.frames import FINGERS, HandFrame
from models.rotations import exp
from tests.support.leap_hands import MIRROR, SHORT, calibrated, changed_hand, take

LENGTHS = PaalmOptions(solve="lengths")
"""Fingers are solved as printed, by their lengths."""


def tables(paalm: Paalm, frames: list[HandFrame], side: str = "right") -> np.ndarray:
    """(T, 5, 4) degrees of frame after frame."""
    return np.array([paalm.step(f).hands[side].table for f in frames])


def without(frame: HandFrame, *ids: int) -> HandFrame:
    """The frame with some of its fingers not seen."""
    (hand,) = frame.hands
    kept = tuple(f for f in hand.fingers if f.id not in ids)
    return replace(frame, hands=(replace(hand, fingers=kept),))


@pytest.mark.parametrize("seed", range(3))
def test_fingers_keep_their_names_where_the_order_by_x_loses_them(seed: int) -> None:
    figures = judge_recording("", take(seed)).figures
    assert figures["identity_tracked"] >= 99.5
    assert figures["identity_paper"] < 97.0


def test_joints_that_a_device_separates_are_met_within_the_goals() -> None:
    figures = [judge_recording("", take(seed, "v3")).figures for seed in range(3)]
    for name, most in (("pip_deg", 8.0), ("dip_deg", 12.0), ("pip_dip_deg", 5.0)):
        assert np.mean([f[name] for f in figures]) < most


def test_the_order_in_the_message_says_nothing() -> None:
    one = take(0)
    again = [
        replace(f, hands=(replace(f.hands[0], fingers=f.hands[0].fingers[::-1]),))
        for f in one.frames
    ]
    np.testing.assert_array_equal(
        tables(calibrated(one), list(one.frames)), tables(calibrated(one), again)
    )


def test_a_hand_of_another_size_has_the_same_angles() -> None:
    hand = simulate_air(3, configuration=SHORT)
    large = replace(hand, joints=1.2 * hand.joints)
    found = []
    for one in (hand, large):
        made = leap_take(one, 3, drop_outs=False, configuration=PRINTED_LEAP)
        found.append(tables(calibrated(made, LENGTHS), list(made.frames)))
    # Noise has the same size for both, so it is relatively smaller for the larger hand.
    assert np.abs(found[0] - found[1])[:, 1:, [0, 2]].mean() < 1.5


def test_a_left_hand_in_a_mirror_is_a_right_hand() -> None:
    right = take(2)
    frames = tuple(
        replace(f, hands=tuple(changed_hand(h, MIRROR) for h in f.hands)) for f in right.frames
    )
    left = replace(right, frames=frames, side="left")
    a = tables(calibrated(right), list(right.frames))
    b = tables(calibrated(left), list(left.frames), "left")
    np.testing.assert_allclose(a, b, atol=1e-6)


def test_both_hands_at_once_are_what_each_is_alone() -> None:
    right, left = take(4), take(5, side="left")
    both = Paalm()
    frames = side_by_side(right, left)
    both.calibrate(frames, "both", 100)
    both.reset()
    alone = {"right": Paalm(), "left": Paalm()}
    for side, one in (("right", right), ("left", left)):
        alone[side].use({side: both.calibration[side]})
        steps = tables(alone[side], list(one.frames), side)
        both.reset()
        np.testing.assert_allclose(tables(both, frames, side), steps, atol=1e-6)


def test_hands_on_top_of_each_other_are_refused_and_held() -> None:
    right, left = take(4), take(5, side="left")
    paalm = Paalm()
    frames = side_by_side(right, left)
    paalm.calibrate(frames, "both", 100)
    paalm.reset()
    before = paalm.step(frames[200])
    upper, lower = frames[201].hands
    over = replace(frames[201], hands=(moved(upper, (0.28, 0.0, 0.1)), lower))
    after = paalm.step(over)
    assert after.refused is not None and paalm.counts[after.refused] == 1
    for side in ("right", "left"):
        np.testing.assert_array_equal(after.hands[side].table, before.hands[side].table)
        assert not after.hands[side].seen
    assert paalm.step(frames[202]).refused is None


def test_a_finger_that_vanished_stays_as_it_was_while_the_palm_turns_and_moves() -> None:
    one = take(1, drop_outs=False)
    # Without smoothing: what vanishes stays where the device saw it last, not where smoothing was.
    paalm = calibrated(one, PaalmOptions(smoothing=0.0))
    for frame in one.frames[:200]:
        paalm.step(frame)
    index = next(i for i, f in one.fingers[199].items() if f == 1)
    before = paalm.step(one.frames[200]).hands["right"]
    hand = one.frames[201].hands[0]
    hand = changed_hand(hand, exp(np.array([0.1, 0.4, 0])), hand.palm, (0.05, 0.02, 0.0))
    after = paalm.step(without(replace(one.frames[201], hands=(hand,)), index)).hands["right"]
    assert after.held == {"index"} and after.ids["index"] is None
    np.testing.assert_array_equal(after.table[1], before.table[1])
    assert after.ratios["index"] == before.ratios["index"]


def test_a_hand_that_is_not_seen_is_held_and_comes_back() -> None:
    one = take(0, drop_outs=False)
    paalm = calibrated(one)
    before = paalm.step(one.frames[0]).hands["right"]
    gone = paalm.step(HandFrame(one.frames[1].time)).hands["right"]
    assert not gone.seen and gone.held == set(FINGERS)
    np.testing.assert_array_equal(gone.table, before.table)
    assert paalm.step(one.frames[2]).hands["right"].seen


def test_fingers_that_swap_ids_from_one_frame_to_the_next_keep_their_names() -> None:
    one = take(3, drop_outs=False)
    paalm = calibrated(one)
    for number, frame in enumerate(one.frames[:300]):
        names = one.fingers[number]
        if number > 150:  # The device has swapped index and ring finger for good.
            ids = {f: i for i, f in names.items()}
            swap = {ids[1]: ids[3], ids[3]: ids[1]}
            (hand,) = frame.hands
            fingers = tuple(replace(f, id=swap.get(f.id, f.id)) for f in hand.fingers)
            frame = replace(frame, hands=(replace(hand, fingers=fingers),))
            names = {swap.get(i, i): f for i, f in names.items()}
        said = paalm.step(frame).hands["right"].ids
        assert all(names[i] == f for f, i in enumerate(said.values()) if i is not None)


def test_time_that_runs_backwards_changes_nothing_and_is_counted() -> None:
    one = take(0)
    paalm = calibrated(one)
    now = paalm.step(one.frames[300]).hands["right"]
    late = paalm.step(one.frames[100])
    assert late.refused is not None and sum(paalm.counts[k] for k in (late.refused,)) == 1
    np.testing.assert_array_equal(late.hands["right"].table, now.table)


def test_a_frame_with_too_many_fingers_is_counted_and_holds_the_hand() -> None:
    one = take(0, drop_outs=False)
    paalm = calibrated(one)
    before = paalm.step(one.frames[0]).hands["right"]
    (hand,) = one.frames[1].hands
    many = hand.fingers + tuple(replace(f, id=f.id + 50) for f in hand.fingers)
    after = paalm.step(replace(one.frames[1], hands=(replace(hand, fingers=many),)))
    np.testing.assert_array_equal(after.hands["right"].table, before.table)
    assert paalm.counts["hands with more than five fingers"] == 1


def test_an_unmeasured_hand_is_refused() -> None:
    with pytest.raises(EncoderError, match="calibration"):
        Paalm().step(take(0).frames[0])


def folded(one: LeapTake) -> list[HandFrame]:
    return [f for f, held in zip(one.frames, one.open, strict=True) if not held]


@pytest.mark.parametrize(
    ("frames", "options"),
    (
        (lambda: [], PaalmOptions()),
        (lambda: [HandFrame(0.01 * t) for t in range(50)], PaalmOptions()),
        (lambda: [without(f, 1) for f in take(0, drop_outs=False).frames[:60]], PaalmOptions()),
        # Only lengths have to be even; tips need some frames that show all of each finger.
        (lambda: folded(take(0, drop_outs=False)), LENGTHS),
        (lambda: folded(take(0, drop_outs=False))[::25], PaalmOptions()),
        (lambda: folded(take(1, "v3")), LENGTHS),
    ),
)
def test_a_hand_that_is_not_open_is_not_measured(
    frames: Callable[[], list[HandFrame]], options: PaalmOptions
) -> None:
    with pytest.raises(EncoderError):
        Paalm(options).calibrate(frames(), "right", 50)


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    "turn", [(0, 0, 80), (0, 0, 180), (0, 90, 0), (0, 170, 0), (40, -60, -120)]
)
def test_a_turned_hand_is_measured_under_the_names_of_its_fingers(
    side: str, turn: tuple[int, int, int]
) -> None:
    hand = simulate_air(6, side, replace(SHORT, seconds=1.0))
    upright = leap_take(hand, 6, drop_outs=False)
    one = leap_take(air.turned(hand, exp(np.deg2rad(turn))), 6, drop_outs=False)
    known, found = calibrated(upright), calibrated(one)
    np.testing.assert_allclose(
        found.calibration[side].standard, known.calibration[side].standard, rtol=0.01
    )
    for frame, names in zip(one.frames, one.fingers, strict=True):
        said = found.step(frame).hands[side].ids
        assert {i: FINGERS.index(f) for f, i in said.items()} == names


@pytest.mark.parametrize(
    ("dialect", "slope"),
    # A packed recording of v3 has the fields of v2, and bones that no v2 reports.
    [("v3", 0.52), ("bridge", 0.52), ("v2", 0.52), (None, 2.0 / 3.0)],
)
def test_joints_bend_together_as_they_do_in_the_devices_dialect(
    dialect: str | None, slope: float
) -> None:
    frames = [replace(f, dialect=dialect) for f in take(1, "v3").frames[150:300]]
    calibration = {"right": average_calibration(frames, "right")}
    for coupling, expected in ((None, slope), (Coupling(0.8), 0.8)):
        paalm = Paalm(PaalmOptions(learns=False, coupling=coupling))
        paalm.use(calibration)
        bends = tables(paalm, frames)[:, 1:, 2:]
        free = (bends[..., 1] < 79.9) & (bends[..., 0] > 1.0)
        assert free.mean() > 0.5
        np.testing.assert_allclose(bends[free][:, 1], expected * bends[free][:, 0], rtol=1e-9)


@pytest.mark.parametrize("dialect", ("v1", "v3"))
def test_a_calibration_written_and_read_reconstructs_the_same(dialect: str, tmp_path: Path) -> None:
    one, path = take(1, dialect), tmp_path / "hand.json"
    first = calibrated(one)
    write_calibration(first.calibration, path)
    second = Paalm()
    second.use(read_calibration(path))
    frames = list(one.frames[100:200])
    np.testing.assert_array_equal(tables(first, frames), tables(second, frames))


@pytest.mark.parametrize(
    "content", ("", "[]", '{"schema": 1}', '{"schema": 1, "paalm_calibration": {"right": {}}}')
)
def test_a_file_without_a_calibration_is_refused(content: str, tmp_path: Path) -> None:
    path = tmp_path / "c.json"
    path.write_text(content)
    with pytest.raises(EncoderError, match=r"c\.json"):
        read_calibration(path)
