"""Units are found by what a hand can be: exactly one is taken and reported, or the file is
refused."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import InputError, MotionError
from models.plausible import (
    BEYOND,
    DISTANCE,
    FINGER,
    IN_PICTURE,
    PALM,
    REACH,
    STEP,
    UNITS,
    ContactSizes,
    HandJumps,
    LiveUnits,
    SideDoubt,
    bent_side,
    find_units,
    in_order,
    lie_on,
    on_surface,
    parse_units,
    steps_of,
    touch_steps,
)
from models.reader_report import ReaderReport

LEAP = {"length": "mm", "time": "us"}


@pytest.mark.parametrize("length", UNITS["length"])
@pytest.mark.parametrize("time", UNITS["time"])
def test_every_unit_is_found_by_a_finger_and_a_rate(length: str, time: str) -> None:
    report = ReaderReport()
    finger, step = 0.098 / UNITS["length"][length], 0.01 / UNITS["time"][time]
    seen = {FINGER: [finger] * 3, STEP: [step] * 3}
    assert find_units(seen, LEAP, where="x", report=report) == {"length": length, "time": time}
    for name, declared in ((length, "mm"), (time, "us")):
        assert (f"read in {name}:" in report.line()) == (name != declared)
    assert bool(report) == ((length, time) != ("mm", "us"))


def test_the_declared_unit_is_taken_where_it_fits_although_another_does_too() -> None:
    # 5 in cm or in are both within the bounds of a reach.
    assert find_units({REACH: [5.0]}, {"length": "cm"}, where="x") == {"length": "cm"}
    with pytest.raises(InputError, match="cm or in"):
        find_units({REACH: [5.0]}, {"length": "mm"}, where="x")


@pytest.mark.parametrize("factor", [10.0, 25.4, 1000.0])
def test_a_size_that_no_unit_explains_is_refused(factor: float) -> None:
    with pytest.raises(MotionError, match="longest finger is impossible in any unit"):
        find_units({FINGER: [98.0 * factor]}, LEAP, where="x", error=MotionError)


@given(st.lists(st.integers(0, 10**9), min_size=3, unique=True).map(sorted))
def test_steps_are_those_of_times_that_go_on_and_a_clock_that_runs_backwards_is_seen(
    times: list[int],
) -> None:
    steps = [b - a for a, b in pairwise(times)]
    assert steps_of(times) == steps_of([*times, times[-1]]) == steps
    assert max(steps_of(times[::-1])) < 0.0
    assert steps_of(times[:1]) == []


def test_a_given_unit_is_not_doubted_and_is_reported() -> None:
    report = ReaderReport()
    given = parse_units("cm")
    units = find_units({FINGER: [98.0], STEP: [10.0]}, LEAP, given, where="x", report=report)
    assert units == {"length": "cm", "time": "ms"}
    assert "lengths are read in cm, as --unit says" in report.line()


@pytest.mark.parametrize("text", ["ft", "mm,cm", "mm,ft"])
def test_unknown_units_and_two_of_a_kind_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="unit"):
        parse_units(text)


def test_a_live_device_goes_on_with_the_likely_unit_and_a_notice_once_a_hand_is_seen() -> None:
    live = LiveUnits(LEAP, wanted=3)
    for _ in range(9):
        live.look({STEP: 10_000.0, DISTANCE: 0.2})
    for _ in range(3):
        assert not live.decided and not live.notice
        live.look({FINGER: 0.098, STEP: 10_000.0})
    assert live.units == {"length": "m", "time": "us"}
    assert "lengths are read in m" in live.notice


def test_a_live_device_with_impossible_values_keeps_its_units_and_has_a_notice() -> None:
    live = LiveUnits(LEAP, wanted=1)
    live.look({FINGER: 98_000.0})
    assert live.units == LEAP
    assert "impossible in any unit" in live.notice


CONTACTS = {
    "a fingertip": (0.008, (0.007, 0.009), True),
    "a fingertip without width and height": (0.008, None, True),
    "a palm": (0.080, (0.06, 0.11), True),
    "a flat finger": (0.025, (0.010, 0.070), True),
    "a light touch": (0.001, (0.001, 0.0011), True),
    "2000 px": (0.048, (0.006, 0.385), False),
    "a strip": (0.030, (0.008, 0.115), False),
    "as large as a table": (0.4, (0.4, 0.4), False),
    "a diameter in mm": (8.0, None, False),
    "a tenth of a millimetre": (0.0001, (0.0001, 0.0001), False),
    "no number": (math.nan, (math.nan, 0.008), False),
    "no diameter": (math.inf, None, False),
}


@pytest.mark.parametrize(("size", "extent", "known"), CONTACTS.values(), ids=CONTACTS)
@pytest.mark.parametrize("after", [0, 100])
def test_a_size_that_no_finger_or_hand_has_is_unknown_and_counted(
    size: float, extent: tuple[float, float] | None, known: bool, after: int
) -> None:
    report = ReaderReport()
    sizes = ContactSizes(report)
    for _ in range(after):
        sizes.known(0.008, (0.008, 0.008))
    assert sizes.known(size, extent) == ((size, extent) if known else (None, None))
    assert report.left_out.total() == (not known)


@pytest.mark.parametrize(
    ("position", "shown"),
    [
        *((0.0, 0.0), (1.0, 1.0), (0.5, 0.5), (-0.25, 0.0), (1.25, 1.0)),
        *((-0.26, None), (1.26, None), (1e9, None), (math.nan, None), (-math.inf, None)),
    ],
)
def test_a_position_a_little_beyond_the_edge_is_on_it(position: float, shown: float | None) -> None:
    assert on_surface(position) == shown


class Row(NamedTuple):
    time: float


TIMES = st.lists(st.floats(0.0, 1e6), max_size=30).map(sorted)


@given(TIMES, st.integers(0, 29), st.floats(-1e9, 1e9))
def test_one_wrong_time_costs_its_row_alone(times: list[float], at: int, wrong: float) -> None:
    report = ReaderReport()
    rows = [Row(time) for time in times]
    assert in_order(rows, report) == rows
    assert not report
    mixed = [*rows[:at], Row(wrong), *rows[at:]]
    kept = in_order(mixed, report)
    assert [row.time for row in kept] == sorted(row.time for row in kept)
    assert len(kept) >= len(mixed) - 1


def test_the_mean_step_of_touches_does_not_count_pauses_and_bursts() -> None:
    times = [n / 60 for n in range(30)] + [900.0 + n / 60 for n in range(30)]
    touched = [True] * 29 + [False] + [True] * 30
    assert touch_steps(times, touched) == pytest.approx([1 / 60])
    assert touch_steps(times[:10], touched[:10]) == []


PATH = [(0.002 * n, 0.0, 0.2) for n in range(30)]
"""m, a hand that moves by 2 mm in each frame."""


def jumping(path: list[tuple[float, float, float] | None], step: float = 0.01) -> list[int]:
    """Numbers of the frames in which a hand jumps; None is a frame without it."""
    jumps = HandJumps()
    frames = [{} if place is None else {7: place} for place in path]
    return [n for n, places in enumerate(frames) if jumps.find(step * n, places)]


THROW = [(min(0.2 * n, 1.0), 0.0, 0.2) for n in range(10)]
AWAY = [(x + 1.0, y, z) for x, y, z in PATH]
ASIDE = [(x + 0.05, y, z) for x, y, z in PATH]


@pytest.mark.parametrize(
    ("path", "jumps"),
    [
        pytest.param([*PATH[:10], *AWAY[10:]], [10], id="and stays there"),
        *(([*PATH[:at], AWAY[at], *PATH[at + 1 :]], [at]) for at in (1, 10, 29)),
        pytest.param(
            [(x + (n % 3 == 2), y, z) for n, (x, y, z) in enumerate(PATH)],
            list(range(2, 30, 3)),
            id="again and again",
        ),
        pytest.param([*PATH[:10], None, *AWAY[10:]], [], id="comes in again elsewhere"),
        pytest.param(THROW, [], id="a throw"),
        pytest.param([*PATH[:10], *ASIDE[10:]], [], id="a correction of 5 cm"),
    ],
)
def test_a_jump_costs_its_frame_alone(
    path: list[tuple[float, float, float] | None], jumps: list[int]
) -> None:
    assert jumping(path) == jumps


def test_one_hand_s_jump_does_not_cost_the_other() -> None:
    jumps = HandJumps()
    other = (-0.1, 0.0, 0.2)
    assert not jumps.find(0.0, {1: (0.0, 0.0, 0.2), 2: other})
    assert jumps.find(0.01, {1: (1.0, 0.0, 0.2), 2: other}) == {1}


def test_a_live_hand_beyond_the_edge_of_a_picture_in_pixels_is_no_doubt_of_its_unit() -> None:
    live = LiveUnits({"length": "m", "image coordinate": "px"}, wanted=3)
    for _ in range(3):
        live.look({PALM: 0.09, IN_PICTURE: 300.0, BEYOND: 200.0})
    assert live.decided and not live.notice


FINGERS = [
    [(x, 0.0, 0.0), (x, 0.04, 0.0), (x, 0.05, -0.02), (x, 0.04, -0.04)]
    for x in (-0.03, -0.01, 0.01, 0.03)
]
"""m, bent fingers of a right hand that lies flat, from the index finger on."""
LEFT = [[(-x, y, z) for x, y, z in finger] for finger in FINGERS]
STRAIGHT = [[(x, 0.02 * i, 0.0) for i in range(4)] for x in (-0.03, -0.01, 0.01, 0.03)]


def test_bent_fingers_show_the_side_of_a_hand_and_straight_ones_do_not() -> None:
    assert bent_side(FINGERS) == "right" and bent_side(LEFT) == "left"
    assert bent_side(FINGERS[1:3]) == "right"
    assert bent_side(STRAIGHT) == ""
    assert bent_side([[(0.0, 0.0, 0.0)] * 4] * 4) == ""


def test_hands_at_one_place_are_one_and_clasped_hands_are_two() -> None:
    hand = [point for finger in FINGERS for point in finger]
    assert lie_on(hand, [(x + 0.01, y, z) for x, y, z in hand], 0.1)
    assert not lie_on(hand, [(x, y, z - 0.04) for x, y, z in hand], 0.1)
    assert not lie_on(hand, hand[:3], 0.1)


@given(st.lists(st.booleans(), max_size=80))
def test_a_side_is_settled_only_where_more_frames_change_nothing(agrees: list[bool]) -> None:
    doubt = SideDoubt()
    for agree in agrees:
        doubt.look("right", FINGERS if agree else LEFT)
    some = agrees[:48]
    against = some.count(False)
    assert bool(doubt.sentence) == (against >= 8 and against > 4 * some.count(True))


def test_a_hand_that_comes_late_is_looked_at_too() -> None:
    doubt = SideDoubt()
    for n in range(2000):
        if doubt.due():
            doubt.look("right", FINGERS)
            if n > 1000:
                doubt.look("left", FINGERS)
    assert "the left hand is a right hand" in doubt.sentence
