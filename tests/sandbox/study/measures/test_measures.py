"""Measures of made-up movements are what geometry and the definitions say."""

from __future__ import annotations

from itertools import pairwise
from math import log2

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from models.arithmetic import Array
from models.rotations import exp
from sandbox.study.measures.grasping import (
    FALL,
    drops,
    grasps,
    label_errors,
    label_switches,
    push_intervals,
)
from sandbox.study.measures.movement import (
    WIDTH,
    efficiency,
    end_distance,
    movement_along,
    path_length,
    sparc,
    speeds,
    throughput,
)

PERIOD = 0.016


def minimum_jerk(duration: float, period: float = 0.001) -> Array:
    """Speed of a movement of length 1 that is as smooth as any (Flash and Hogan 1985)."""
    t = np.arange(0.0, duration + period / 2, period) / duration
    return 30.0 * t**2 * (1.0 - t) ** 2 / duration


def spectral_arc_length(duration: float) -> float:
    """The same as SPARC for a minimum-jerk movement, by its Fourier integral in closed form.

    The integral of 30 x^2 (1 - x)^2 exp(-i w x) over 0 .. 1 has the magnitude
    60 |(12 - w^2) sin(w/2) - 6 w cos(w/2)| * 2 / w^5.
    """
    f = np.linspace(1e-3, 10.0, 400_000)
    w = 2.0 * np.pi * f * duration
    amplitude = 120.0 * np.abs((12.0 - w**2) * np.sin(w / 2) - 6.0 * w * np.cos(w / 2)) / w**5
    # Near 0 the difference of large numbers is no number; it is 1 there.
    amplitude[w < 0.5] = 1.0 - w[w < 0.5] ** 2 / 56.0
    last = np.flatnonzero(amplitude >= 0.05)[-1] + 1
    f, amplitude = f[:last], amplitude[:last]
    return -float(np.hypot(np.diff(f) / (f[-1] - f[0]), np.diff(amplitude)).sum())


def test_the_path_of_a_straight_line_is_efficient_and_that_of_half_a_circle_two_over_pi() -> None:
    line = np.linspace([0.1, 0.2, 0.3], [0.4, 0.2, -0.1], 50)
    assert efficiency(end_distance(line), path_length(line)) == pytest.approx(1.0)
    angle = np.linspace(0.0, np.pi, 2000)
    half = 0.05 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    assert path_length(half) == pytest.approx(0.05 * np.pi, rel=1e-6)
    assert efficiency(end_distance(half), path_length(half)) == pytest.approx(2 / np.pi, rel=1e-6)
    there_and_back = np.concatenate([line, line[::-1]])
    assert efficiency(end_distance(there_and_back), path_length(there_and_back)) == 0.0
    assert efficiency(0.0, path_length(line[:1])) is None


@given(st.integers(0, 2**31))
def test_lengths_and_speeds_do_not_depend_on_where_or_how_one_stands(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(0.0, 0.1, (20, 3))
    moved = points @ exp(rng.normal(0.0, 1.0, 3)).T + rng.normal(0.0, 1.0, 3)
    assert path_length(moved) == pytest.approx(path_length(points))
    assert end_distance(moved) == pytest.approx(end_distance(points))
    assert speeds(moved, PERIOD) == pytest.approx(speeds(points, PERIOD))
    assert end_distance(points) <= path_length(points)


@pytest.mark.parametrize("duration", [0.6, 1.0, 2.5])
def test_the_smoothness_of_a_minimum_jerk_movement_is_the_arc_length_of_its_fourier_integral(
    duration: float,
) -> None:
    found = sparc(minimum_jerk(duration), 0.001)
    assert found == pytest.approx(spectral_arc_length(duration), abs=0.01)
    assert found == pytest.approx(-1.41, abs=0.02)


@given(st.floats(0.01, 100.0), st.floats(0.5, 3.0))
def test_smoothness_does_not_depend_on_how_far_or_how_long_a_movement_is(
    scale: float, duration: float
) -> None:
    one = sparc(minimum_jerk(1.0), 0.001)
    other = sparc(scale * minimum_jerk(duration), 0.001)
    # The end of a spectrum is found on a grid of frequencies, which costs some of the second place.
    assert one is not None and other == pytest.approx(one, abs=0.03)
    assert sparc(scale * minimum_jerk(1.0), 0.001) == pytest.approx(one, abs=1e-6)


def test_every_halt_and_every_tremor_makes_a_movement_less_smooth() -> None:
    bell, rest = minimum_jerk(0.6, PERIOD), np.zeros(20)
    found = [sparc(np.concatenate([bell, *[rest, bell] * n]), PERIOD) for n in range(4)]
    assert all(a is not None and b is not None and b < a for a, b in pairwise(found))
    t = np.arange(len(bell)) * PERIOD
    shaken = bell * (1.0 + 0.5 * np.sin(2 * np.pi * 7.0 * t))
    assert sparc(shaken, PERIOD) < sparc(bell, PERIOD)


def test_what_does_not_move_or_hardly_lasts_has_no_smoothness() -> None:
    assert sparc(np.zeros(100), PERIOD) is None
    assert sparc(np.ones(7), PERIOD) is None
    assert sparc([], PERIOD) is None


def test_a_release_is_a_tenth_of_a_second_without_a_push_and_a_grasp_takes_two_digits() -> None:
    # Seven moments are 0.112 s without a push, five are 0.08 s.
    digits = ["", "t", "ti", "ti", *[""] * 5, "ti", *[""] * 7, "i", "tim", "", "", "i"]
    grip = [1.0 if d else 0.0 for d in digits]
    runs = push_intervals(digits, grip, PERIOD)
    assert runs == [(1, 9), (17, 21)]
    assert grasps(digits, runs) == 2
    assert grasps(["t", "i", "p", "tp"], [(0, 3)]) == 0
    weak = push_intervals(["ti", "ti"], [0.01, 0.01], PERIOD)
    assert weak == []
    # A strong beginning, and then as light as a feather, is one stretch.
    assert push_intervals(["t"] * 4, [0.0, 0.2, 0.001, 0.2], PERIOD) == [(1, 3)]
    # A tenth of a second to the dot is long enough.
    assert push_intervals(["t", *[""] * 4, "t"], [1.0, *[0.0] * 4, 1.0], 0.02) == [(0, 0), (5, 5)]


PUSH = st.tuples(st.sampled_from(["", "t", "ti"]), st.sampled_from([0.0, 0.02, 1.0]))


@example([("t", 1.0), ("", 0.0), ("t", 0.02)])
@given(st.lists(PUSH, max_size=60))
def test_pushes_of_any_force_keep_a_stretch_going(pushes: list[tuple[str, float]]) -> None:
    digits, grip = [d for d, _ in pushes], [f if d else 0.0 for d, f in pushes]
    runs = push_intervals(digits, grip, PERIOD)
    ends = {last for _, last in runs}
    pushed = [i for i, d in enumerate(digits) if d]
    for i, next_one in pairwise(pushed):
        assert i not in ends or (next_one - i) * PERIOD >= 0.1
    assert all(grip[first] >= 0.05 for first, _ in runs)
    assert all((b[0] - a[1]) * PERIOD >= 0.1 for a, b in pairwise(runs))


@pytest.mark.parametrize(
    ("height", "number"), [(0.05, 1), (FALL * 1.2, 1), (FALL * 0.8, 0), (0, 0)]
)
def test_a_thing_that_falls_is_dropped_and_one_that_is_put_down_is_not(
    height: float, number: int
) -> None:
    t = np.arange(0.0, np.sqrt(2 * height / 9.81) + 1e-9, PERIOD)
    fall = np.concatenate([np.full(10, height), height - 4.905 * t**2, np.zeros(10)])
    free = [False] * 10 + [True] * len(t) + [False] * 10
    assert drops(free, fall) == number
    assert drops(free * 3, np.tile(fall, 3)) == 3 * number


def test_a_fall_begins_where_the_thing_was_touched_last() -> None:
    assert drops([False, True, True], [0.02, 0.009, 0.009]) == 1
    assert drops([True, True], [0.02, 0.009]) == 1
    assert drops([False, True, False], [0.02, 0.015, 0.009]) == 1


def test_switches_count_other_fingers_and_neither_first_names_nor_returns_of_the_same() -> None:
    assert label_switches([{}, {1: 0}, {1: 0, 2: 1}, {2: 1}, {1: 0}]) == 0
    assert label_switches([{1: 0, 2: 1}, {1: 1, 2: 0}]) == 2
    assert label_switches([{1: 0}, {}, {1: 2}, {1: 0}]) == 2


def test_the_time_from_a_wrong_finger_to_the_right_one() -> None:
    true = [{1: 0, 2: 1}] * 12
    named = [{}, {1: 0}, *[{1: 0, 2: 2}] * 4, {1: 0}, *[{1: 0, 2: 1}] * 2, *[{1: 3, 2: 1}] * 3]
    found = label_errors(named, true, PERIOD)
    assert found["label_errors"] == 2
    assert found["label_recovery_s"] == pytest.approx(5 * PERIOD)
    told = sum(len(now) for now in named)
    assert found["label_accuracy"] == pytest.approx((told - 4 - 3) / told)


def test_where_nobody_knows_the_fingers_nothing_is_said_about_them() -> None:
    assert label_errors([{1: 0}] * 3, [{}] * 3, PERIOD) == {}
    strange = label_errors([{7: 0}], [{1: 0}], PERIOD)
    assert strange["label_accuracy"] is None and strange["label_errors"] == 0


def test_the_throughput_of_a_made_up_set() -> None:
    # Errors with a standard deviation of exactly 1 mm: We is 4.133 mm.
    errors = [-0.001, 0.0, 0.001]
    amplitudes = [3 * WIDTH * 0.001] * 3
    found = throughput(amplitudes, errors, [1.5, 2.0, 2.5])
    assert found == pytest.approx(log2(4.0) / 2.0)
    shifted = [e + 0.02 for e in errors]
    found = throughput(amplitudes, shifted, [2.0] * 3)
    assert found == pytest.approx(1.0)
    assert throughput(amplitudes[:2], errors[:2], [2.0] * 2) is None
    assert throughput(amplitudes, [0.001] * 3, [2.0] * 3) is None


def test_a_movement_is_seen_along_the_way_to_its_goal() -> None:
    assert movement_along([0, 0, 0], [0.1, 0, 0], [0.09, 0.05, 0.0]) == pytest.approx((0.09, -0.01))
    assert movement_along([0, 0, 0], [0, 0.2, 0], [0.0, 0.21, 0.3]) == pytest.approx((0.21, 0.01))
    assert movement_along([0, 0, 0], [0, 0.001, 0], [0, 0.1, 0]) is None
