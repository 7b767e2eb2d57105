"""Recordings of a hand whose every pose is known become a capture that says the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.captures.conversion import ConversionReport, JointTrack, TouchLog
from encoders.captures.conversion.touch_log import valid_contacts
from models.arithmetic import Array
from models.errors import CaptureError
from tests.support.hand_recording import (
    AHEAD,
    RATE,
    RULES,
    Truth,
    converted,
    played,
    rows_of,
    touch_log,
)


@pytest.fixture(scope="module")
def truth() -> Truth:
    return played()


@pytest.fixture(scope="module")
def joints(truth: Truth) -> JointTrack:
    return JointTrack(truth.time, truth.q, truth.skeleton)


@pytest.fixture(scope="module")
def log(truth: Truth) -> TouchLog:
    return touch_log(truth, AHEAD)


@pytest.fixture(scope="module")
def clean(log: TouchLog, joints: JointTrack) -> Capture:
    """What becomes of the log as it is."""
    return converted(log, joints)[0]


# --- touches and poses side by side


def test_labels_and_poses_come_back_and_single_fingers_do_not(
    truth: Truth, joints: JointTrack
) -> None:
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


@pytest.mark.parametrize("ahead", (-7.5, 0.0, 0.013, AHEAD, 41.0))
def test_taps_tell_any_offset_of_the_clocks_within_half_a_frame(
    truth: Truth, joints: JointTrack, ahead: float
) -> None:
    capture, report = converted(touch_log(truth, ahead), joints, "tap", 0.0)
    off = abs(report.notes["offset_s"] - ahead)
    assert off < 0.5 / RATE and off < 5 * report.notes["offset_precision_s"]
    np.testing.assert_array_equal(capture.down, truth.down[rows_of(truth, capture, ahead)])


def test_taps_in_one_rhythm_are_refused_for_they_fit_many_offsets(joints: JointTrack) -> None:
    q = np.tile(joints.q[0], (1200, 1))
    time = np.arange(1200) / RATE
    q[:, 2] += 0.02 * np.abs(np.sin(np.pi * time))  # down once a second
    steady = JointTrack(time, q, joints.skeleton)
    frames = np.concatenate([np.arange(i, i + 6) for i in range(180, 720, 60)])
    place = joints.tips[0, 1, :2] * [1, -1]
    log = TouchLog(time, frames, frames // 60, np.tile(place, (len(frames), 1)))
    with pytest.raises(CaptureError, match="do not determine the offset"):
        converted(log, steady, "tap")


def test_touches_of_another_session_are_refused_by_their_taps(joints: JointTrack) -> None:
    other = touch_log(played(8.0, seed=5), 0.0)
    with pytest.raises(CaptureError, match="offset"):
        converted(other, joints, "tap")


def test_the_order_of_contacts_and_their_ids_do_not_matter(
    log: TouchLog, joints: JointTrack
) -> None:
    rng = np.random.default_rng(3)
    order = np.lexsort((rng.random(len(log.frame)), log.frame))
    other = TouchLog(log.time, log.frame, 1000 - log.ids[order], log.xy[order])
    first, _ = converted(log, joints)
    second, _ = converted(other, joints)
    np.testing.assert_array_equal(second.down, first.down)
    np.testing.assert_array_equal(second.xy, first.xy)


def test_takes_end_at_pauses_and_before_they_grow_too_long(
    truth: Truth, joints: JointTrack
) -> None:
    rules = replace(RULES, longest_take=1.0, pause=0.5)
    capture, _ = converted(touch_log(truth, AHEAD), joints, rules=rules)
    assert (np.diff(capture.trial) >= 0).all() and (np.diff(capture.trial) <= 1).all()
    same = np.diff(capture.trial) == 0
    assert np.diff(capture.time)[same].max() <= 0.5 + 1e-6
    for trial in np.unique(capture.trial):
        times = capture.time[capture.trial == trial]
        assert times[-1] - times[0] <= 1.0 + 1e-6


# --- glitches


def with_rows(
    log: TouchLog,
    frames: NDArray[np.int64] | list[int],
    ids: NDArray[np.int64] | list[int],
    xy: Array | list[list[float]],
) -> TouchLog:
    """The log with contacts put into frames."""
    frame = np.concatenate([log.frame, frames])
    order = np.argsort(frame, kind="stable")
    return TouchLog(
        log.time,
        frame[order].astype(np.int64),
        np.concatenate([log.ids, ids])[order].astype(np.int64),
        np.concatenate([log.xy, xy])[order],
    )


def test_a_very_short_contact_is_dropped_and_counted(
    log: TouchLog, joints: JointTrack, clean: Capture
) -> None:
    flash = with_rows(log, [200, 500, 501], [900, 901, 901], [[0.1, 0.1]] * 3)
    capture, report = converted(flash, joints)
    assert report.contacts == {"shorter than 50 ms": 2}
    np.testing.assert_array_equal(capture.q, clean.q)
    np.testing.assert_array_equal(capture.down, clean.down)


def test_a_touch_far_from_every_fingertip_is_dropped_and_counted(
    log: TouchLog, joints: JointTrack, clean: Capture
) -> None:
    frames = np.arange(300, 420)
    palm = with_rows(log, frames, np.full(120, 900), np.tile([0.3, 0.4], (120, 1)))
    capture, report = converted(palm, joints)
    assert report.contacts == {"no fingertip within 25 mm": 1}
    np.testing.assert_array_equal(capture.down, clean.down)


def test_a_place_that_jumps_out_and_back_is_replaced_by_a_straight_line(
    log: TouchLog, joints: JointTrack, clean: Capture
) -> None:
    id_ = np.bincount(log.ids).argmax()
    rows = np.flatnonzero(log.ids == id_)
    xy = log.xy.copy()
    xy[rows[10]] += [0.1, 0.0]
    capture, report = converted(replace(log, xy=xy), joints)
    assert report.parts == {"places that jumped faster than 3 m/s": 1}
    np.testing.assert_array_equal(capture.down, clean.down)
    np.testing.assert_allclose(capture.xy, clean.xy, atol=2e-3)


def test_an_id_that_jumps_to_another_finger_is_cut_in_two(
    truth: Truth, log: TouchLog, joints: JointTrack
) -> None:
    five = np.flatnonzero(truth.down[:, [1, 4]].all(axis=1))
    # The index finger's id goes on as the little finger's, whose own contact is never seen.
    runs = np.split(five, np.flatnonzero(np.diff(five) > 1) + 1)
    run = max(runs, key=len)
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


def test_frames_that_arrive_in_bunches_cut_no_contact_and_hide_no_jump() -> None:
    """Packets without times of their own, of a network that sleeps: five at once, 80 ms apart."""
    count = 200
    even = np.arange(count) / 60.0
    arrived = even[np.minimum(np.arange(count) // 5 * 5 + 4, count - 1)] + 1e-4 * (
        np.arange(count) % 5
    )
    frame, ids = np.arange(count), np.zeros(count, int)
    xy = np.stack([0.5 * even, np.zeros(count)], axis=1)  # m at half a metre a second
    report = ConversionReport()
    (whole,) = valid_contacts(TouchLog(arrived, frame, ids, xy), RULES, report)
    assert len(whole.time) == count and not report.parts and not report.contacts
    # Another finger, 10 cm away, in the middle of a bunch.
    jumped = np.where(frame[:, None] >= 102, xy + np.array([0.0, 0.1]), xy)
    parts = valid_contacts(TouchLog(arrived, frame, ids, jumped), RULES, report)
    assert [len(part.time) for part in parts] == [102, count - 102]


def test_a_touch_that_never_ends_is_cut_where_it_came_to_rest(
    truth: Truth, log: TouchLog, joints: JointTrack, clean: Capture
) -> None:
    five = np.flatnonzero(truth.down.all(axis=1))
    id_ = log.ids[log.frame == five[-1]][0]
    own = log.ids == id_
    last, place = log.frame[own][-1], log.xy[own][-1]
    after = np.arange(last + 1, len(log.time))
    stuck = with_rows(log, after, np.full(len(after), id_), np.tile(place, (len(after), 1)))
    capture, report = converted(stuck, joints)
    assert report.parts == {"long rests at the ends of touches without a lift": 1}
    # Its last sight, at which it rested already, is the end.
    assert abs(len(capture) - len(clean)) <= 1


def test_frames_whose_time_runs_backwards_are_dropped_and_counted(
    truth: Truth, log: TouchLog, joints: JointTrack
) -> None:
    time = log.time.copy()
    time[[400, 401, 700]] -= 1.0
    capture, report = converted(replace(log, time=time), joints)
    assert report.parts == {"touch frames whose time ran backwards or stood still": 3}
    rows = rows_of(truth, capture)
    np.testing.assert_array_equal(capture.down, truth.down[rows])


@pytest.mark.parametrize("row", (0, 400))
def test_a_single_time_that_leaps_ahead_costs_no_other_frame(
    truth: Truth, log: TouchLog, joints: JointTrack, row: int, clean: Capture
) -> None:
    time = log.time.copy()
    time[row] += 3600.0
    capture, report = converted(replace(log, time=time), joints)
    assert report.parts == {"touch frames whose time leapt ahead": 1}
    assert abs(len(capture) - len(clean)) <= 1
    np.testing.assert_array_equal(capture.down, truth.down[rows_of(truth, capture)])


def test_a_contact_between_two_fingers_is_refused(
    truth: Truth, log: TouchLog, joints: JointTrack
) -> None:
    """A third of its life at another finger is more than the fifth that is allowed."""
    index = truth.xy[:, 1]
    frames = np.flatnonzero(truth.down[:, 1] & truth.down[:, 2])
    frames = max(np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1), key=len)
    keep = ~np.isin(log.frame, frames)
    share = np.linspace(0, 1, len(frames))[:, None]
    xy = index[frames] + share * 0.75 * (truth.xy[frames, 2] - index[frames])
    bare = TouchLog(log.time, log.frame[keep], log.ids[keep], log.xy[keep])
    capture, report = converted(with_rows(bare, frames, np.full(len(frames), 900), xy), joints)
    assert report.contacts["nearer to another finger for more than 20 % of their time"] == 1
    # No frame says that fewer fingers touched; its ends lie between frames.
    assert not np.isin(rows_of(truth, capture), frames[3:-3]).any()


def test_two_contacts_of_one_finger_leave_the_nearer(
    truth: Truth, log: TouchLog, joints: JointTrack, clean: Capture
) -> None:
    frames = np.flatnonzero(truth.down[:, 1])
    frames = max(np.split(frames, np.flatnonzero(np.diff(frames) > 1) + 1), key=len)
    xy = truth.xy[frames, 1] + [-0.006, 0.0]
    capture, report = converted(with_rows(log, frames, np.full(len(frames), 900), xy), joints)
    assert report.contacts == {"their finger had a nearer contact": 1}
    np.testing.assert_array_equal(capture.xy, clean.xy)
