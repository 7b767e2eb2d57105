"""A finger's length and direction give back the angles they came from."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.paalm import EQUAL, TWO_THIRDS, Coupling
from encoders.paalm.angles import angles_of_joints, joints_of_angles
from encoders.paalm.chain import FINGER_LIMITS, FingerChain
from models.errors import EncoderError

LENGTHS = (0.045, 0.026, 0.021)
TABLE = st.tuples(*(st.floats(-15, 85), st.floats(-22, 22), st.floats(-5, 105), st.floats(-9, 78)))


def tip_of(
    chain: FingerChain, flexion: float, spread: float, pip: float
) -> tuple[float, float, float]:
    """Where a finger's tip is from where its seen part begins, by the other way: forward."""
    angles = np.tile([flexion, spread, pip, chain.dip(pip)], (5, 1))
    first, *rest = chain.lengths
    joints = joints_of_angles(angles, np.zeros((5, 3)), np.tile([first, *rest], (5, 1)))[1]
    base = joints[0] + chain.hidden * (joints[1] - joints[0])
    x, y, z = joints[3] - base
    return float(x), float(y), float(z)


@given(st.lists(TABLE, min_size=5, max_size=5))
def test_angles_of_joints_are_the_angles_that_placed_them(
    rows: list[tuple[float, float, float, float]],
) -> None:
    joints = joints_of_angles(rows, np.zeros((5, 3)), np.tile(LENGTHS, (5, 1)))
    np.testing.assert_allclose(angles_of_joints(joints), rows, atol=1e-9)


@given(
    st.floats(-19.5, 89.5),
    st.floats(-24.5, 24.5),
    st.floats(0.5, 100.0),
    st.sampled_from((TWO_THIRDS, EQUAL, Coupling(0.6, 3.0))),
    st.sampled_from((0.0, 0.45)),
)
def test_inverse_kinematics_finds_the_angles_of_a_reachable_tip(
    flexion: float, spread: float, pip: float, coup: Coupling, hid: float
) -> None:
    chain = FingerChain(LENGTHS, coup, hidden=hid)
    target = tip_of(chain, flexion, spread, pip)
    if np.linalg.norm(target) < chain.shortest + 1e-4:
        return  # Bent further than to the least length: the same place has two bends.
    found = chain.solve(target)
    assert found.miss < 1e-9
    assert found.pip == pytest.approx(pip, abs=1e-4)
    assert found.flexion == pytest.approx(flexion, abs=1e-4)
    assert found.spread == pytest.approx(spread, abs=1e-4)


@given(st.lists(st.floats(-0.2, 0.2), min_size=3, max_size=3))
def test_any_target_gives_legal_angles_and_the_miss_that_is_reported(target: list[float]) -> None:
    chain = FingerChain(LENGTHS, TWO_THIRDS)
    if np.linalg.norm(target) < 1e-6:
        return
    x, y, z = target
    found = chain.solve((x, y, z))
    limits = FINGER_LIMITS
    for angle, (low, high) in (
        (found.flexion, limits.flexion),
        (found.spread, limits.spread),
        (found.pip, limits.pip),
        (found.dip, limits.dip),
    ):
        assert low - 1e-9 <= angle <= high + 1e-9
    tip = tip_of(chain, found.flexion, found.spread, found.pip)
    assert found.miss == pytest.approx(np.linalg.norm(np.subtract(tip, target)), abs=1e-6)


def test_where_a_limit_refuses_no_other_bend_comes_nearer() -> None:
    chain = FingerChain(LENGTHS, TWO_THIRDS)
    target = (0.0, -0.03, 0.05)
    found = chain.solve(target)
    others = [
        np.linalg.norm(np.subtract(tip_of(chain, found.flexion, found.spread, pip), target))
        for pip in np.linspace(0.0, 110.0, 200)
    ]
    assert found.miss <= min(others) + 1e-4


def test_a_coupling_is_fitted_to_what_it_was_made_from_and_refused_without_motion() -> None:
    pip = np.linspace(0.0, 90.0, 50)
    fitted = Coupling.fitted(pip, 0.6 * pip + 4.0)
    assert (fitted.slope, fitted.offset) == (pytest.approx(0.6), pytest.approx(4.0))
    with pytest.raises(EncoderError, match="too little"):
        Coupling.fitted(np.full(50, 20.0), np.full(50, 10.0))
    with pytest.raises(EncoderError, match="does not follow"):
        Coupling.fitted(pip, -pip)


def test_a_finger_without_bones_is_refused() -> None:
    with pytest.raises(EncoderError):
        FingerChain((0.0, 0.026, 0.021), TWO_THIRDS)
    with pytest.raises(EncoderError):
        FingerChain(LENGTHS, TWO_THIRDS).solve((0.0, 0.0, 0.0))
