"""A camera over a tablet names touches; every person and picture here is simulated."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from encoders.captures.conversion import ConversionReport, ConversionRules, TouchLog
from encoders.captures.overhead.capture_from_camera import (
    NamedTouches,
    capture_from_camera,
    name_touches,
)
from encoders.captures.overhead.naming import Belief, NamingRules, chosen, names_of
from encoders.captures.overhead.simulated_camera import (
    SIZE,
    OverheadPictures,
    simulate_overhead,
)
from encoders.captures.overhead.tablet_plane import (
    TabletPlane,
    field_of_view,
    mirrored_plane,
    place_of_camera,
    plane_of_corners,
)
from encoders.captures.paired.simulated_pair import FROZEN_PAIRED, PairedSession, simulate_paired
from models.errors import CaptureError, InputError
from models.frames import LandmarkFrame
from sandbox.captures.live_naming import ArrivalClock, LiveNames

SHORT = replace(FROZEN_PAIRED, play=9.0, open_seconds=1.5)


@cache
def session(side: str = "right") -> tuple[PairedSession, OverheadPictures]:
    person = simulate_paired(4, 1, side=side, configuration=SHORT)
    return person, simulate_overhead(person, 9)


def log_of(person: PairedSession) -> TouchLog:
    rows = [(f, c) for f, frame in enumerate(person.touches) for c in frame.contacts]
    xy = np.array([(c.x, c.y) for _, c in rows])
    return TouchLog(
        person.touch_arrived[0]
        + np.array([f.time - person.touches[0].time for f in person.touches]),
        np.array([f for f, _ in rows]),
        np.array([c.id for _, c in rows]),
        xy * [-1.0, 1.0] if person.side == "left" else xy,
    )


def taken(pictures: OverheadPictures) -> np.ndarray:
    return np.array([f.taken for f in pictures.frames]) - pictures.configuration.zero


def named_by(side: str, corners: TabletPlane | None = None) -> NamedTouches:
    person, pictures = session(side)
    log, rules, report = log_of(person), ConversionRules(), ConversionReport()
    return name_touches(log, pictures.frames, taken(pictures), side, rules, report, corners=corners)


@cache
def names(side: str = "right") -> NamedTouches:
    return named_by(side)


@pytest.mark.parametrize("side", ["right", "left"])
def test_touches_get_the_finger_whose_tip_is_nearest_in_the_picture(side: str) -> None:
    person, _ = session(side)
    known = [c for c in names(side).contacts if c.track.id in person.labels]
    assert len(known) > 5
    assert all(c.finger == person.labels[c.track.id] for c in known)


def test_clocks_agree_within_some_milliseconds_by_taps_and_motion() -> None:
    person, pictures = session()
    # The log begins at the first arrival, which is late by one frame's own delay.
    first = person.touch_arrived[0] - (person.touches[0].time - 3.0)
    true = pictures.configuration.latency - float(first)
    assert abs(names().clock.offset - true) < 0.01


def test_the_surface_by_its_corners_is_that_by_the_touches() -> None:
    person, pictures = session()
    corners = plane_of_corners(pictures.corners, person.surface.size)
    middle = pictures.corners.mean(axis=0)
    off = corners.on_surface(middle) - names().plane.on_surface(middle)
    assert np.abs(off).max() < 0.015
    by_corners = named_by("right", corners)
    assert [c.finger for c in by_corners.contacts] == [c.finger for c in names().contacts]


def test_a_mirrored_picture_is_told() -> None:
    person, pictures = session()
    mirrored = [
        LandmarkFrame(
            f.time,
            tuple(replace(h, image=tuple((SIZE[0] - x, y) for x, y in h.image)) for h in f.hands),
            f.size,
            f.taken,
        )
        for f in pictures.frames
    ]
    with pytest.raises(CaptureError, match="mirror"):
        name_touches(
            log_of(person),
            mirrored,
            taken(pictures),
            "right",
            ConversionRules(),
            ConversionReport(),
        )


def test_corners_tell_the_camera_and_its_field_of_view() -> None:
    person, pictures = session()
    plane = plane_of_corners(pictures.corners, person.surface.size)
    camera = pictures.configuration.camera
    view = field_of_view(plane.matrix, SIZE)
    assert view is not None and abs(view - camera.view) < 0.5
    place = place_of_camera(plane.matrix, SIZE, camera)
    corner = person.surface.centred_at((0.0, 0.0, 0.0)).corner
    assert np.abs(place.at - (np.array(camera.at) - corner)).max() < 0.002


def test_corners_in_the_wrong_order_are_refused() -> None:
    person, pictures = session()
    for wrong in (pictures.corners[::-1], pictures.corners[[0, 2, 1, 3]]):
        with pytest.raises(InputError, match="corners"):
            plane_of_corners(wrong, person.surface.size)


def test_a_plane_in_the_mirror_is_its_own_mirror_image() -> None:
    person, pictures = session()
    plane = plane_of_corners(pictures.corners, person.surface.size)
    again = mirrored_plane(mirrored_plane(plane, SIZE[0]), SIZE[0])
    assert np.allclose(again.matrix, plane.matrix, atol=1e-12)


def test_a_capture_has_the_fingers_and_roughly_the_poses() -> None:
    person, pictures = session()
    report = ConversionReport()
    capture, _ = capture_from_camera(
        log_of(person),
        pictures.frames,
        taken(pictures),
        "right",
        ConversionRules(),
        report,
        {"simulated": True},
        camera=pictures.configuration.camera,
    )
    true = person.poses_at(
        capture.time - float(person.touch_arrived[0] - person.touches[0].time + 3)
    )
    off = np.linalg.norm(capture.q[:, :3] - true[:, :3], axis=1)
    assert np.median(off) < 0.03
    assert len(capture) > 0.7 * len(person.truth)


def test_live_names_are_those_of_the_whole_recording() -> None:
    person, pictures = session()
    whole = names()
    clock, live = ArrivalClock(), LiveNames(whole.plane, "right", 0.03)
    events = [(t, 0, i) for i, t in enumerate(person.touch_arrived.tolist())]
    events += [(t, 1, i) for i, t in enumerate(pictures.arrived.tolist())]
    given: dict[int, int] = {}
    for arrived, kind, i in sorted(events):
        if kind == 0:
            live.touch(person.touches[i], arrived)
            continue
        frame = pictures.frames[i]
        for name in live.picture(frame, clock.host(frame.taken, frame.time, arrived), arrived):
            given[name.id] = name.finger
    known = {c.track.id: c.finger for c in whole.contacts if c.track.id in person.labels}
    assert given.keys() >= known.keys()
    assert sum(given[i] == f for i, f in known.items()) >= 0.95 * len(known)


def test_a_touch_between_two_fingers_has_no_name() -> None:
    rules = NamingRules()
    between = np.array([0.1, 0.008, 0.008, 0.1, 0.1])
    share = names_of([{7: between}] * 30, [0.033] * 30, rules)[7]
    assert chosen(share, rules) is None and share[1] == pytest.approx(0.5, abs=0.01)


def test_a_neighbour_that_is_surely_named_settles_a_doubtful_touch() -> None:
    rules = NamingRules()
    between, sure = np.array([0.1, 0.008, 0.008, 0.1, 0.1]), np.array([0.1, 0.0, 0.03, 0.1, 0.1])
    both = names_of([{7: between, 8: sure}] * 30, [0.033] * 30, rules)
    assert chosen(both[7], rules) == 2 and chosen(both[8], rules) == 1


def test_what_was_seen_before_and_after_counts_alike_in_the_end() -> None:
    rules = NamingRules()
    rng = np.random.default_rng(0)
    looks = [{1: rng.uniform(0, 0.02, 5), 2: rng.uniform(0, 0.02, 5)} for _ in range(12)]
    end = Belief(rules)
    for off in looks:
        end.update(off, 0.2)
    found = names_of(looks, [0.2] * 12, rules)
    for contact, share in end.names().items():
        assert np.allclose(found[contact], share, atol=1e-9)
        assert share.sum() == pytest.approx(1.0)
    backward = names_of(looks[::-1], [0.2] * 12, rules)
    assert all(np.allclose(found[c], backward[c], atol=1e-9) for c in found)
