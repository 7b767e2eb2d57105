"""Points on a hand become poses of our skeleton, or are refused with one clear error."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.captures.conversion import (
    ConversionReport,
    JointTrack,
    TouchLog,
    capture_from_poses,
    frame_from_corners,
    joints_from_points,
)
from encoders.captures.conversion.sites import mapped, recognised, sites_of
from encoders.captures.conversion.surface_frame import frame_from_fingertips
from models.arithmetic import Array
from models.errors import CaptureError
from models.pose import joint_vectors
from models.rotations import exp, geodesic_angle
from models.skeleton import ADULT
from tests.support.hand_recording import (
    QUALISYS,
    RULES,
    SCALE,
    Truth,
    markers,
    played,
    rows_of,
)

SITES = {name: sites_of(ADULT)[site] for name, site in QUALISYS.items()}
UPRIGHT = frame_from_corners([0, 0, 0], [1, 0, 0], [0, -1, 0])


@pytest.fixture(scope="module")
def truth() -> Truth:
    return played()


@pytest.fixture(scope="module")
def joints(truth: Truth) -> JointTrack:
    return JointTrack(truth.time, truth.q, truth.skeleton)


@pytest.fixture(scope="module")
def fitted(truth: Truth) -> tuple[JointTrack, ConversionReport]:
    """The hand as found from markers, and what was noted."""
    report = ConversionReport()
    return joints_from_points(truth.time, markers(truth), SITES, UPRIGHT, ADULT, report), report


def joint_error(a: Array, b: Array) -> float:
    """Degrees, mean angle between the joints of poses."""
    return float(np.rad2deg(geodesic_angle(joint_vectors(a), joint_vectors(b))).mean())


def test_markers_give_back_size_and_poses(
    truth: Truth, fitted: tuple[JointTrack, ConversionReport]
) -> None:
    """Within 1.5 % of the size, 8 mm of the wrist, 5 mm of the fingertips and 7 degrees a joint:
    a marker's place on its bone, and a bone's twist, are only known to that."""
    found, report = fitted
    assert abs(report.notes["hand_scale"] - SCALE) < 0.015 * SCALE
    assert report.notes["residual_mm"] < 1.0
    off = np.linalg.norm(found.q[:, :3] - truth.q[:, :3], axis=1)
    assert off.mean() < 0.008
    assert joint_error(found.q, truth.q) < 7.0
    tips = JointTrack(truth.time, truth.q, truth.skeleton).tips
    assert np.linalg.norm(found.tips - tips, axis=2).mean() < 0.005


def test_the_surface_is_found_from_fingertips_wherever_the_recorder_stands(
    truth: Truth, fitted: tuple[JointTrack, ConversionReport]
) -> None:
    turn, shift = exp(np.array([0.7, -1.1, 0.4])), np.array([1.0, -2.0, 0.5])
    moved = {name: p @ turn.T + shift for name, p in markers(truth).items()}
    report = ConversionReport()
    found = joints_from_points(truth.time, moved, SITES, None, ADULT, report)
    capture = capture_from_poses(found, 0.005, RULES, report, {})
    rows = rows_of(truth, capture, 0.0)
    assert (capture.down == truth.down[rows]).all(axis=1).mean() > 0.9
    # Places and turns within the surface are free; heights, spans and joints are not.
    height = found.q[:, 2] - truth.q[:, 2]
    assert np.abs(height).mean() < 0.006
    assert joint_error(found.q, truth.q) < 7.0
    capture_span = np.linalg.norm(capture.xy[:, 0] - capture.xy[:, 1], axis=1)
    true_span = np.linalg.norm(truth.xy[rows, 0] - truth.xy[rows, 1], axis=1)
    seen = np.isfinite(capture_span) & np.isfinite(true_span)
    assert seen.sum() > 50
    assert np.abs(capture_span - true_span)[seen].mean() < 0.006


def test_short_gaps_of_markers_are_bridged_and_long_ones_give_no_poses(truth: Truth) -> None:
    points = {name: p[:300].copy() for name, p in markers(truth).items()}
    points["index_tip"][50:54] = np.nan
    points["index_middle"][50:54] = np.nan  # the finger is not seen for 67 ms
    points["hand_top"][100:140] = np.nan  # two points are no palm
    report = ConversionReport()
    found = joints_from_points(truth.time[:300], points, SITES, UPRIGHT, ADULT, report)
    assert report.parts == {"poses without enough points": 44}
    _, known = found.at(truth.time[:300], RULES.gap)
    np.testing.assert_array_equal(np.flatnonzero(~known), np.arange(100, 140))


@pytest.mark.parametrize("pair", (("index_tip", "little_tip"), ("thumb_tip", "hand_top")))
def test_swapped_markers_are_noticed(truth: Truth, pair: tuple[str, str]) -> None:
    points = {name: p[::4] for name, p in markers(truth).items()}
    a, b = pair
    points[a], points[b] = points[b], points[a]
    with pytest.raises(CaptureError, match=f"{a}|{b}"):
        joints_from_points(truth.time[::4], points, SITES, UPRIGHT, ADULT, ConversionReport())


@pytest.mark.parametrize(("unit", "left", "noticed"), [(1.0, True, "side"), (10.0, False, "size")])
def test_a_hand_of_the_wrong_side_or_unit_is_noticed(
    truth: Truth, unit: float, left: bool, noticed: str
) -> None:
    points = {name: unit * p[::4] for name, p in markers(truth).items()}
    with pytest.raises(CaptureError, match=noticed):
        joints_from_points(
            truth.time[::4], points, SITES, UPRIGHT, ADULT, ConversionReport(), left=left
        )


def test_a_left_hand_is_found_as_the_right_one_in_the_mirror(truth: Truth) -> None:
    seen = {}
    for side, sign in (("right", 1.0), ("left", -1.0)):
        points = {name: p[:60] * [sign, 1.0, 1.0] for name, p in markers(truth).items()}
        seen[side] = joints_from_points(
            truth.time[:60], points, SITES, UPRIGHT, ADULT, ConversionReport(), left=side == "left"
        ).q
    np.testing.assert_allclose(seen["left"], seen["right"], atol=1e-9)


# --- frames, names and arrays


def test_a_surface_given_by_its_corners_has_the_frame_that_they_span() -> None:
    turn = exp(np.array([0.3, 0.8, -0.5]))
    corners = np.array([[0, 0, 0], [0.2, 0, 0], [0, -0.15, 0]]) @ turn.T + [1, 2, 3]
    frame = frame_from_corners(*corners)
    points = np.array([[0.05, -0.04, 0.01], [0, 0, 1.0]])
    np.testing.assert_allclose(frame.points(points @ turn.T + [1, 2, 3]), points, atol=1e-12)


@pytest.mark.parametrize(
    "corners",
    (
        ([0, 0, 0], [1, 0, 0], [2, 0, 0]),
        ([0, 0, 0], [0, 0, 0], [0, 1, 0]),
        ([0, 0, np.nan], [1, 0, 0], [0, 1, 0]),
        ([0, 0], [1, 0], [0, 1]),
    ),
)
def test_corners_that_span_no_plane_are_refused(
    corners: tuple[list[float], list[int], list[int]],
) -> None:
    with pytest.raises(CaptureError, match="corners"):
        frame_from_corners(*corners)


@settings(max_examples=15)
@given(seed=st.integers(0, 1000))
def test_fingertips_scattered_in_the_air_do_not_rest_on_a_plane(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tips = rng.uniform(-0.1, 0.1, (60, 5, 3))
    with pytest.raises(CaptureError, match="no plane"):
        frame_from_fingertips(tips, np.tile([0, 0, 0.2], (60, 1)))


@pytest.mark.parametrize("prefix", ("", "glove:"))
def test_names_of_glove_markers_are_recognised(prefix: str) -> None:
    expected = {f"{prefix}{name}": site for name, site in QUALISYS.items()}
    assert recognised(list(expected), "right", ADULT) == expected
    with pytest.raises(CaptureError):
        recognised(["m1", "m2"], "right", ADULT)


def test_the_fingers_of_the_other_hand_are_not_taken() -> None:
    names = [
        f"LeftHand{f}{i}" for f in ("Thumb", "Index", "Middle", "Ring", "Pinky") for i in "123"
    ]
    assert len(recognised(["LeftHand", *names], "left", ADULT)) == 16
    with pytest.raises(CaptureError, match="not recognised"):
        recognised(["LeftHand", *names], "right", ADULT)


@pytest.mark.parametrize("tip", ("3 end", "4"))
def test_the_tips_of_a_mixamo_rig_are_recognised(tip: str) -> None:
    fingers = {f"RightHand{f}": f.lower() for f in ("Thumb", "Index", "Middle", "Ring", "Pinky")}
    names = [f"mixamorig:{stem}{i}" for stem in fingers for i in ("1", "2", "3", tip)]
    known = recognised(["mixamorig:RightHand", *names], "right", ADULT)
    assert len(known) == 21
    for stem, finger in fingers.items():
        assert known[f"mixamorig:{stem}{tip}"] == f"{finger.replace('pinky', 'little')}_tip"


@pytest.mark.parametrize(
    "change",
    (
        {"hand_top": "no_such_site"},
        {"unheard": "wrist"},
        {"hand_top": {"bone": "palm"}},
        {"hand_top": {"bone": "tail", "at": [0, 0, 0]}},
        {"hand_top": {"bone": "palm", "at": [0, 0]}},
        {"hand_top": {"bone": "palm", "at": [0, 0, float("nan")]}},
        {"hand_top": 7},
        # A thumb without markers.
        {"thumb_tip": "index_tip_skin", "thumb_middle": "index_tip_skin"},
    ),
)
def test_a_mapping_that_makes_no_sense_is_refused(change: dict[str, Any]) -> None:
    assert len(mapped(QUALISYS, list(QUALISYS), ADULT)) == len(QUALISYS)
    with pytest.raises(CaptureError):
        mapped({**QUALISYS, **change}, list(QUALISYS), ADULT)


LOG = TouchLog(np.array([0.0, 0.1]), np.array([0, 1]), np.array([4, 4]), np.zeros((2, 2)))
TRACK = JointTrack(np.array([0.0, 0.1]), np.zeros((2, 48)), ADULT)


@pytest.mark.parametrize(
    ("sound", "change"),
    (
        (LOG, {"time": np.zeros((5, 2))}),
        (LOG, {"time": np.array([0.0, np.nan])}),
        (LOG, {"frame": np.array([1, 0])}),
        (LOG, {"frame": np.array([-1, 0])}),
        (LOG, {"ids": np.array([0])}),
        (LOG, {"xy": np.full((2, 2), np.inf)}),
        (TRACK, {"time": np.array([0.0])}),
        (TRACK, {"time": np.array([1.0, 0.0])}),
        (TRACK, {"time": np.array([0.0, np.inf])}),
        (TRACK, {"q": np.zeros((2, 47))}),
        (TRACK, {"q": np.full((2, 48), np.nan)}),
    ),
)
def test_touches_and_poses_that_break_their_contract_are_refused(
    sound: Any, change: dict[str, Any]
) -> None:
    with pytest.raises(CaptureError, match="touches" if sound is LOG else "joints"):
        replace(sound, **change)


def test_a_point_of_the_palm_that_is_never_seen_is_done_without(truth: Truth) -> None:
    some = slice(None, None, 6)
    seen = {name: points[some] for name, points in markers(truth).items()}
    never = {**seen, "fourth": np.full_like(seen["hand_top"], np.nan)}
    sites = {**SITES, "fourth": sites_of(ADULT)["index_mcp_skin"]}
    without = joints_from_points(truth.time[some], seen, SITES, None, ADULT, ConversionReport())
    found = joints_from_points(truth.time[some], never, sites, None, ADULT, ConversionReport())
    assert len(found.time) == len(without.time)
    assert joint_error(found.q, without.q) < 1.0
