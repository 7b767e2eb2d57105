"""Recordings of a hand whose every pose is known become a capture that says the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.conversion import (
    ConversionReport,
    ConversionRules,
    JointTrack,
    TouchLog,
    capture_from_poses,
    capture_from_touches,
    frame_from_corners,
    joints_from_points,
)
from encoders.conversion.sites import mapped, recognised, sites_of
from encoders.conversion.surface_frame import frame_from_fingertips
from encoders.store import load_capture, save_capture
from models.errors import CaptureError
from models.pose import joint_vectors, mirrored
from models.rotations import exp, geodesic_angle
from models.skeleton import ADULT
from tests.hand_recording import QUALISYS, RATE, SCALE, markers, played, touch_log

AHEAD = 3.217
"""s that the hand's clock is ahead of the tablet's."""

RULES = ConversionRules(rate=RATE)
UPRIGHT = frame_from_corners([0, 0, 0], [1, 0, 0], [0, -1, 0])


@pytest.fixture(scope="module")
def truth():
    return played()


@pytest.fixture(scope="module")
def joints(truth):
    return JointTrack(truth.time, truth.q, truth.skeleton)


@pytest.fixture(scope="module")
def fitted(truth):
    """The hand as found from markers, and what was noted."""
    report = ConversionReport()
    return joints_from_points(truth.time, markers(truth), sites(), UPRIGHT, ADULT, report), report


def sites():
    known = sites_of(ADULT)
    return {name: known[site] for name, site in QUALISYS.items()}


def converted(log, joints, sync="clock", offset=AHEAD, rules=RULES):
    report = ConversionReport()
    return capture_from_touches(log, joints, sync, offset, rules, report, {}), report


def rows_of(truth, capture, ahead=AHEAD):
    """Frames of the truth at which a capture's frames were taken."""
    return np.round((capture.time + ahead) * RATE).astype(int)


def joint_error(a, b):
    """Degrees, mean angle between the joints of poses."""
    return float(np.rad2deg(geodesic_angle(joint_vectors(a), joint_vectors(b))).mean())


# --- touches and poses side by side


def test_labels_and_poses_come_back_and_single_fingers_do_not(truth, joints):
    capture, report = converted(touch_log(truth, AHEAD), joints)
    rows = rows_of(truth, capture)
    np.testing.assert_array_equal(capture.down, truth.down[rows])
    np.testing.assert_allclose(capture.q, truth.q[rows], atol=1e-9)
    off = np.linalg.norm(capture.xy - truth.xy[rows], axis=2)[capture.down]
    assert off.max() < 0.004
    fingers = truth.down.sum(axis=1)
    np.testing.assert_array_equal(np.sort(rows), np.flatnonzero(fingers > 1))
    assert report.frames == {"with one finger": (fingers == 1).sum()}
    assert not report.contacts and not report.parts


def test_taps_tell_the_offset_of_the_clocks_within_a_frame(truth, joints):
    capture, report = converted(touch_log(truth, AHEAD), joints, "tap", 0.0)
    assert abs(report.notes["offset_s"] - AHEAD) < 1 / RATE
    assert abs(report.notes["offset_s"] - AHEAD) < 5 * report.notes["offset_precision_s"]
    np.testing.assert_array_equal(capture.down, truth.down[rows_of(truth, capture)])


@pytest.mark.parametrize("ahead", (-7.5, 0.0, 0.013, 41.0))
def test_any_offset_is_found(truth, joints, ahead):
    _, report = converted(touch_log(truth, ahead), joints, "tap", 0.0)
    assert abs(report.notes["offset_s"] - ahead) < 0.5 / RATE


def test_a_part_of_the_touches_is_enough_to_find_it(truth, joints):
    log = touch_log(truth, AHEAD)
    rows = (log.frame > 300) & (log.frame < 800)
    part = TouchLog(log.time, log.frame[rows], log.ids[rows], log.xy[rows])
    _, report = converted(part, joints, "tap", 0.0)
    assert abs(report.notes["offset_s"] - AHEAD) < 1 / RATE


def test_taps_in_one_rhythm_are_refused_for_they_fit_many_offsets(joints):
    q = np.tile(joints.q[0], (1200, 1))
    time = np.arange(1200) / RATE
    q[:, 2] += 0.02 * np.abs(np.sin(np.pi * time))  # down once a second
    steady = JointTrack(time, q, joints.skeleton)
    frames = np.concatenate([np.arange(i, i + 6) for i in range(180, 720, 60)])
    place = joints.tips[0, 1, :2] * [1, -1]
    log = TouchLog(time, frames, frames // 60, np.tile(place, (len(frames), 1)))
    with pytest.raises(CaptureError, match="do not tell one offset"):
        converted(log, steady, "tap")


def test_touches_of_another_session_are_refused_by_their_taps(joints):
    other = touch_log(played(8.0, seed=5), 0.0)
    with pytest.raises(CaptureError, match="offset"):
        converted(other, joints, "tap")


def test_a_hand_that_never_taps_cannot_be_synchronised_by_taps(truth, joints):
    still = JointTrack(truth.time, np.tile(truth.q[0], (len(truth.q), 1)), truth.skeleton)
    with pytest.raises(CaptureError, match="no tap"):
        converted(touch_log(truth), still, "tap")


def test_a_wrong_offset_is_noticed(truth, joints):
    with pytest.raises(CaptureError, match=r"no touch is where|no contact|no frame"):
        converted(touch_log(truth), joints, "clock", 100.0)


def test_the_order_of_contacts_and_their_ids_do_not_matter(truth, joints):
    log = touch_log(truth, AHEAD)
    rng = np.random.default_rng(3)
    order = np.lexsort((rng.random(len(log.frame)), log.frame))
    other = TouchLog(log.time, log.frame, 1000 - log.ids[order], log.xy[order])
    first, _ = converted(log, joints)
    second, _ = converted(other, joints)
    np.testing.assert_array_equal(second.down, first.down)
    np.testing.assert_array_equal(second.xy, first.xy)


def test_a_left_hand_gives_the_capture_of_the_right_one_in_the_mirror(truth, joints):
    log = touch_log(truth, AHEAD)
    left_q, left_log = mirrored(truth.q), replace(log, xy=log.xy * [-1.0, 1.0])
    back = JointTrack(truth.time, mirrored(left_q), truth.skeleton)
    capture, _ = converted(replace(left_log, xy=left_log.xy * [-1.0, 1.0]), back)
    right, _ = converted(log, joints)
    np.testing.assert_array_equal(capture.q, right.q)
    left_points = {name: p * [-1.0, 1.0, 1.0] for name, p in markers(truth).items()}
    seen = {}
    for side, points in (("right", markers(truth)), ("left", left_points)):
        seen[side] = joints_from_points(
            truth.time[:60],
            {name: p[:60] for name, p in points.items()},
            sites(),
            UPRIGHT,
            ADULT,
            ConversionReport(),
            left=side == "left",
        ).q
    np.testing.assert_allclose(seen["left"], seen["right"], atol=1e-9)


def test_a_capture_keeps_its_report_when_it_is_saved(truth, joints, tmp_path):
    capture, report = converted(touch_log(truth, AHEAD), joints)
    save_capture(capture, tmp_path / "c.npz")
    read = load_capture(tmp_path / "c.npz")
    np.testing.assert_array_equal(read.q, capture.q)
    np.testing.assert_array_equal(read.ids, capture.ids)
    assert read.meta["conversion"] == report.as_json()
    assert read.meta["rate_hz"] == RATE


def test_takes_end_at_pauses_and_before_they_grow_too_long(truth, joints):
    rules = replace(RULES, longest_take=1.0, pause=0.5)
    capture, _ = converted(touch_log(truth, AHEAD), joints, rules=rules)
    assert (np.diff(capture.trial) >= 0).all() and (np.diff(capture.trial) <= 1).all()
    same = np.diff(capture.trial) == 0
    assert np.diff(capture.time)[same].max() <= 0.5 + 1e-6
    for trial in np.unique(capture.trial):
        times = capture.time[capture.trial == trial]
        assert times[-1] - times[0] <= 1.0 + 1e-6


# --- glitches


def with_rows(log, frames, ids, xy):
    """The log with contacts put into frames."""
    frame = np.concatenate([log.frame, frames])
    order = np.argsort(frame, kind="stable")
    return TouchLog(
        log.time,
        frame[order].astype(np.int64),
        np.concatenate([log.ids, ids])[order].astype(np.int64),
        np.concatenate([log.xy, xy])[order],
    )


def test_a_contact_that_only_flashes_is_dropped_and_counted(truth, joints):
    log = touch_log(truth, AHEAD)
    clean, _ = converted(log, joints)
    flash = with_rows(log, [200, 500, 501], [900, 901, 901], [[0.1, 0.1]] * 3)
    capture, report = converted(flash, joints)
    assert report.contacts == {"shorter than 50 ms": 2}
    np.testing.assert_array_equal(capture.q, clean.q)
    np.testing.assert_array_equal(capture.down, clean.down)


def test_a_touch_far_from_every_fingertip_is_dropped_and_counted(truth, joints):
    log = touch_log(truth, AHEAD)
    clean, _ = converted(log, joints)
    frames = np.arange(300, 420)
    palm = with_rows(log, frames, np.full(120, 900), np.tile([0.3, 0.4], (120, 1)))
    capture, report = converted(palm, joints)
    assert report.contacts == {"no fingertip within 25 mm": 1}
    np.testing.assert_array_equal(capture.down, clean.down)


def test_a_place_that_jumps_out_and_back_is_replaced_by_a_straight_line(truth, joints):
    log = touch_log(truth, AHEAD)
    id_ = np.bincount(log.ids).argmax()
    rows = np.flatnonzero(log.ids == id_)
    xy = log.xy.copy()
    xy[rows[10]] += [0.1, 0.0]
    clean, _ = converted(log, joints)
    capture, report = converted(replace(log, xy=xy), joints)
    assert report.parts == {"places that jumped faster than 3 m/s": 1}
    np.testing.assert_array_equal(capture.down, clean.down)
    np.testing.assert_allclose(capture.xy, clean.xy, atol=2e-3)


def test_an_id_that_jumps_to_another_finger_is_cut_in_two(truth, joints):
    log = touch_log(truth, AHEAD)
    five = np.flatnonzero(truth.down[:, [1, 4]].all(axis=1))
    # The index finger's id goes on as the little finger's, whose own contact is never seen.
    run = np.split(five, np.flatnonzero(np.diff(five) > 1) + 1)
    run = max(run, key=len)
    half = run[len(run) // 2]
    tip = {f: truth.xy[:, f] for f in (1, 4)}
    keep = ~np.isin(log.frame, run)
    xy = np.where((run < half)[:, None], tip[1][run], tip[4][run])
    bare = TouchLog(log.time, log.frame[keep], log.ids[keep], log.xy[keep])
    capture, report = converted(with_rows(bare, run, np.full(len(run), 900), xy), joints)
    assert report.parts["contacts cut in two at a jump"] == 1
    rows = rows_of(truth, capture)
    assert not capture.down[np.isin(rows, run)].any()  # one finger at a time: dropped
    assert report.frames["with one finger"] >= len(run)


def test_a_touch_that_never_ends_is_cut_where_it_came_to_rest(truth, joints):
    log = touch_log(truth, AHEAD)
    five = np.flatnonzero(truth.down.all(axis=1))
    id_ = log.ids[log.frame == five[-1]][0]
    own = log.ids == id_
    last, place = log.frame[own][-1], log.xy[own][-1]
    after = np.arange(last + 1, len(log.time))
    stuck = with_rows(log, after, np.full(len(after), id_), np.tile(place, (len(after), 1)))
    capture, report = converted(stuck, joints)
    clean, _ = converted(log, joints)
    assert report.parts == {"ends of touches that never ended": 1}
    # Its last sight, at which it rested already, is the end.
    assert abs(len(capture) - len(clean)) <= 1


def test_frames_whose_time_runs_backwards_are_dropped_and_counted(truth, joints):
    log = touch_log(truth, AHEAD)
    time = log.time.copy()
    time[[400, 401, 700]] -= 1.0
    capture, report = converted(replace(log, time=time), joints)
    assert report.parts == {"touch frames whose time ran backwards or stood still": 3}
    rows = rows_of(truth, capture)
    np.testing.assert_array_equal(capture.down, truth.down[rows])


def test_a_contact_between_two_fingers_is_refused(truth, joints):
    """A third of its life at another finger is more than the fifth that is allowed."""
    index = truth.xy[:, 1]
    frames = np.flatnonzero(truth.down[:, 1] & truth.down[:, 2])
    frames = max(np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1), key=len)
    log = touch_log(truth, AHEAD)
    keep = ~np.isin(log.frame, frames)
    share = np.linspace(0, 1, len(frames))[:, None]
    xy = index[frames] + share * 0.75 * (truth.xy[frames, 2] - index[frames])
    bare = TouchLog(log.time, log.frame[keep], log.ids[keep], log.xy[keep])
    _, report = converted(with_rows(bare, frames, np.full(len(frames), 900), xy), joints)
    assert report.contacts["nearer to another finger for more than 20 % of their time"] == 1


def test_two_contacts_of_one_finger_leave_the_nearer(truth, joints):
    frames = np.flatnonzero(truth.down[:, 1])
    frames = max(np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1), key=len)
    log = touch_log(truth, AHEAD)
    xy = truth.xy[frames, 1] + [-0.006, 0.0]
    capture, report = converted(with_rows(log, frames, np.full(len(frames), 900), xy), joints)
    clean, _ = converted(log, joints)
    assert report.contacts == {"their finger had a nearer contact": 1}
    np.testing.assert_array_equal(capture.xy, clean.xy)


def test_frames_in_a_gap_of_the_poses_are_dropped_and_counted(truth, joints):
    keep = np.ones(len(truth.time), bool)
    keep[400:460] = False
    gap = JointTrack(truth.time[keep], truth.q[keep], truth.skeleton)
    capture, report = converted(touch_log(truth, AHEAD), gap)
    missing = (truth.down[400:460].sum(axis=1) > 1).sum()
    assert report.frames.get("without a pose", 0) == missing
    assert not np.isin(rows_of(truth, capture), np.arange(400, 460)).any()


# --- points on the hand


def test_markers_give_back_size_and_poses(truth, fitted):
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


def test_markers_and_touches_give_the_same_labels(truth, fitted):
    capture, report = converted(touch_log(truth, AHEAD), fitted[0], "tap", 0.0)
    assert abs(report.notes["offset_s"] - AHEAD) < 1 / RATE
    rows = rows_of(truth, capture)
    assert (capture.down == truth.down[rows]).all()


def test_markers_near_the_surface_are_touches(truth, fitted):
    capture = capture_from_poses(fitted[0], 0.005, RULES, ConversionReport(), {})
    rows = rows_of(truth, capture, 0.0)
    assert (capture.down == truth.down[rows]).all(axis=1).mean() > 0.95
    assert abs(len(capture) - (truth.down.sum(axis=1) > 1).sum()) < 0.05 * len(capture)
    both = capture.down & truth.down[rows]
    assert np.linalg.norm(capture.xy - truth.xy[rows], axis=2)[both].mean() < 0.006


def test_the_surface_is_found_from_fingertips_wherever_the_recorder_stands(truth, fitted):
    turn, shift = exp(np.array([0.7, -1.1, 0.4])), np.array([1.0, -2.0, 0.5])
    moved = {name: p @ turn.T + shift for name, p in markers(truth).items()}
    report = ConversionReport()
    found = joints_from_points(truth.time, moved, sites(), None, ADULT, report)
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


def test_short_gaps_of_markers_are_bridged_and_long_ones_are_no_poses(truth):
    points = {name: p[:300].copy() for name, p in markers(truth).items()}
    points["index_tip"][50:54] = np.nan
    points["index_middle"][50:54] = np.nan  # the finger is not seen for 67 ms
    points["hand_top"][100:140] = np.nan  # two points are no palm
    report = ConversionReport()
    found = joints_from_points(truth.time[:300], points, sites(), UPRIGHT, ADULT, report)
    assert report.parts == {"poses without enough points": 44}
    _, known = found.at(truth.time[:300], RULES.gap)
    np.testing.assert_array_equal(np.flatnonzero(~known), np.arange(100, 140))


@pytest.mark.parametrize("pair", (("index_tip", "little_tip"), ("thumb_tip", "hand_top")))
def test_swapped_markers_are_noticed(truth, pair):
    points = {name: p[::4] for name, p in markers(truth).items()}
    a, b = pair
    points[a], points[b] = points[b], points[a]
    with pytest.raises(CaptureError, match=f"{a}|{b}"):
        joints_from_points(truth.time[::4], points, sites(), UPRIGHT, ADULT, ConversionReport())


def test_a_hand_of_the_wrong_side_is_noticed(truth):
    points = {name: p[::4] for name, p in markers(truth).items()}
    with pytest.raises(CaptureError, match="side"):
        joints_from_points(
            truth.time[::4], points, sites(), UPRIGHT, ADULT, ConversionReport(), left=True
        )


def test_a_wrong_unit_is_noticed(truth):
    points = {name: 10 * p for name, p in markers(truth).items()}
    with pytest.raises(CaptureError, match="size"):
        joints_from_points(truth.time, points, sites(), UPRIGHT, ADULT, ConversionReport())


# --- frames, names and arrays


def test_a_surface_told_by_its_corners_is_the_frame_they_span():
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
def test_corners_that_span_no_plane_are_refused(corners):
    with pytest.raises(CaptureError, match="corners"):
        frame_from_corners(*corners)


@settings(max_examples=15)
@given(seed=st.integers(0, 1000))
def test_fingertips_all_over_the_air_rest_on_no_plane(seed):
    rng = np.random.default_rng(seed)
    tips = rng.uniform(-0.1, 0.1, (60, 5, 3))
    with pytest.raises(CaptureError, match="no plane"):
        frame_from_fingertips(tips, np.tile([0, 0, 0.2], (60, 1)))


@pytest.mark.parametrize("height", (0.0, -0.01, 0.05, np.nan))
def test_an_impossible_height_of_touch_is_refused(joints, height):
    with pytest.raises(CaptureError, match="height"):
        capture_from_poses(joints, height, RULES, ConversionReport(), {})


def test_a_hand_in_the_air_touches_nothing(truth):
    q = truth.q.copy()
    q[:, 2] += 0.2
    high = JointTrack(truth.time, q, truth.skeleton)
    with pytest.raises(CaptureError, match="no contact"):
        capture_from_poses(high, 0.005, RULES, ConversionReport(), {})


@pytest.mark.parametrize(
    ("names", "expected"),
    (
        (list(QUALISYS), QUALISYS),
        ([f"glove:{n}" for n in QUALISYS], {f"glove:{n}": s for n, s in QUALISYS.items()}),
    ),
)
def test_names_of_glove_markers_are_recognised(names, expected):
    assert recognised(names, "right", ADULT) == expected


def test_names_nobody_told_are_refused_and_listed():
    with pytest.raises(CaptureError, match="m1, m2"):
        recognised(["m1", "m2"], "right", ADULT)


def test_the_fingers_of_the_other_hand_are_not_taken():
    names = [
        f"LeftHand{f}{i}" for f in ("Thumb", "Index", "Middle", "Ring", "Pinky") for i in "123"
    ]
    assert len(recognised(["LeftHand", *names], "left", ADULT)) == 16
    with pytest.raises(CaptureError, match="not recognised"):
        recognised(["LeftHand", *names], "right", ADULT)


@pytest.mark.parametrize(
    ("change", "message"),
    (
        ({"m0": "no_such_site"}, "no such place"),
        ({"unheard": "wrist"}, "no such point"),
        ({"m0": {"bone": "palm"}}, "no place"),
        ({"m0": {"bone": "tail", "at": [0, 0, 0]}}, "no place"),
        ({"m0": {"bone": "palm", "at": [0, 0]}}, "no place"),
        ({"m0": {"bone": "palm", "at": [0, 0, float("nan")]}}, "no place"),
        ({"m0": {"bone": "palm", "at": ["a", 0, 0]}}, "no place"),
        ({"m0": 7}, "no such place"),
        ({"m0": [1]}, "no such place"),
        ({"m1": "index_tip_skin"}, "point on the thumb"),
    ),
)
def test_a_mapping_that_makes_no_sense_is_refused(change, message):
    names = [f"m{i}" for i in range(len(QUALISYS) + 1)]
    sound = dict(zip(names, QUALISYS.values(), strict=False))
    thumb = [name for name, site in sound.items() if site.startswith("thumb")]
    if "m1" in change:
        sound = {name: site for name, site in sound.items() if name not in thumb}
    else:
        assert len(mapped(sound, names, ADULT)) == len(QUALISYS)
    with pytest.raises(CaptureError, match=message):
        mapped({**sound, **change}, names, ADULT)


@pytest.mark.parametrize(
    "change",
    (
        {"time": np.zeros((5, 2))},
        {"time": np.array([0.0, np.nan])},
        {"frame": np.array([1, 0])},
        {"frame": np.array([0, 2])},
        {"frame": np.array([-1, 0])},
        {"frame": np.array([0])},
        {"ids": np.array([0])},
        {"xy": np.zeros((2, 3))},
        {"xy": np.full((2, 2), np.inf)},
    ),
)
def test_a_touch_log_that_breaks_its_contract_is_refused(change):
    sound = TouchLog(np.array([0.0, 0.1]), np.array([0, 1]), np.array([4, 4]), np.zeros((2, 2)))
    with pytest.raises(CaptureError, match="touches"):
        replace(sound, **change)


@pytest.mark.parametrize(
    "change",
    (
        {"time": np.array([0.0])},
        {"time": np.array([0.0, 0.0])},
        {"time": np.array([1.0, 0.0])},
        {"time": np.array([0.0, np.inf])},
        {"q": np.zeros((2, 47))},
        {"q": np.full((2, 48), np.nan)},
    ),
)
def test_poses_that_break_their_contract_are_refused(change):
    sound = JointTrack(np.array([0.0, 0.1]), np.zeros((2, 48)), ADULT)
    with pytest.raises(CaptureError, match="joints"):
        replace(sound, **change)
