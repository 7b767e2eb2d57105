"""The coupling of a hand, learned from the joints that its device reports."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.paalm import Paalm, PaalmOptions
from encoders.paalm.average import average_calibration
from encoders.paalm.coupling import OFFSET_STEP, ORION, SLOPE_STEP, LearnedCoupling
from encoders.paalm.palm import vector_of
from encoders.paalm.simulated.air import FROZEN_AIR, simulate_air
from encoders.paalm.simulated.forward import leap_take
from models.frames import TrackedFinger, TrackedHand


def bent(pip: float, dip: float) -> TrackedHand:
    """A hand whose four fingers have the same PIP and DIP, degrees."""
    fingers = []
    for finger in range(5):
        joints, angle = [np.zeros(3)], 0.0
        for bend in (0.0, pip, dip):
            angle += np.deg2rad(bend)
            joints.append(joints[-1] + 0.03 * np.array([0.0, np.cos(angle), -np.sin(angle)]))
        mcp, middle, distal, end = map(vector_of, joints)
        fingers.append(
            TrackedFinger(finger, end, (0.0, 1.0, 0.0), 0.09, finger, (mcp, middle, distal, end))
        )
    return TrackedHand(1, (0.0, 0.2, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0), tuple(fingers))


@settings(deadline=None, max_examples=30)
@given(slope=st.floats(0.3, 1.0), offset=st.floats(-4.0, 6.0))
def test_it_is_found_within_seconds_wherever_the_hand_moves(slope: float, offset: float) -> None:
    learned = LearnedCoupling(ORION)
    for frame in range(1200):
        pip = 50.0 + 30.0 * np.sin(frame / 20.0)
        learned.add(bent(pip, slope * pip + offset))
    for pip in (25.0, 75.0):
        said = learned.used.slope * pip + learned.used.offset
        assert said == pytest.approx(slope * pip + offset, abs=1.5)


@settings(deadline=None, max_examples=30)
@given(st.lists(st.tuples(st.floats(0.0, 110.0), st.floats(-10.0, 80.0)), min_size=1, max_size=60))
def test_it_never_jumps_whatever_a_device_reports(bends: list[tuple[float, float]]) -> None:
    learned, before = LearnedCoupling(ORION), ORION
    for pip, dip in bends:
        changed = learned.add(bent(pip, dip))
        assert changed == (learned.used != before)
        assert abs(learned.used.slope - before.slope) <= SLOPE_STEP + 1e-12
        assert abs(learned.used.offset - before.offset) <= OFFSET_STEP + 1e-12
        before = learned.used


def test_straight_fingers_and_those_without_joints_teach_nothing() -> None:
    learned = LearnedCoupling(ORION)
    straight = bent(3.0, 9.0)
    blind = bent(60.0, 60.0)
    blind = replace(blind, fingers=tuple(replace(f, joints=None) for f in blind.fingers))
    assert not any(learned.add(hand) for hand in [straight, blind] * 200)
    assert learned.used == ORION


@pytest.mark.parametrize("seed", [41, 42])
def test_a_persons_joints_are_nearer_to_the_truth_than_with_the_dialects_coupling(
    seed: int,
) -> None:
    take = leap_take(simulate_air(seed, "right", replace(FROZEN_AIR, seconds=12.0)), seed, "v3")
    late = np.arange(len(take.frames)) > len(take.frames) // 3
    found = {}
    for learns in (True, False):
        paalm = Paalm(PaalmOptions(learns=learns))
        paalm.use({"right": average_calibration(take.frames[:50], "right")})
        tables = np.array([paalm.step(f).hands["right"].table for f in take.frames])
        off = np.abs(tables - take.angles)[late & ~take.open, 1:, 2:]
        found[learns] = off.mean(axis=(0, 1))
    assert found[True].sum() <= found[False].sum() + 0.2
    assert found[True].max() < 5.0


def test_a_hand_that_is_new_to_the_session_is_learned_anew() -> None:
    take = leap_take(simulate_air(5, "right", replace(FROZEN_AIR, seconds=4.0)), 5, "v3")
    paalm = Paalm()
    paalm.use({"right": average_calibration(take.frames[:50], "right")})
    runs = []
    for _ in range(2):
        paalm.reset()
        runs.append(np.array([paalm.step(f).hands["right"].table for f in take.frames]))
    np.testing.assert_array_equal(runs[0], runs[1])
