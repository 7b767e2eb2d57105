"""Hands that press and lift at random: no finger gets stuck and no lift is lost, on any way in.

A hand's fingertips lie as they do when it is about to grip, somewhere on the surface and turned.
Its fingers come down, move and leave in any order, several at once now and then. The same story
goes through TUIO 1.1, TUIO 2.0, the page, and as pins through the mouse. The quick run is a tenth
of the long one.
"""

from __future__ import annotations

import json
import math
import random
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from models.frames import TouchFrame
from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.conformance import check_frames
from sandbox.devices.mouse import GRAB_RADIUS, MouseDevice, default_hand
from sandbox.devices.tuio import touch_frame
from sandbox.devices.tuio_senders import Tuio
from sandbox.devices.web import WebDevice
from sandbox.server.protocol import Screen, Touches, decode
from tests.tuio_packets import alv, bundle, frame, frm, ptr

QUICK, FULL = 1_000, 10_000
"""Presses and lifts."""

SURFACE = Surface()
WIDTH, HEIGHT = (float(length) for length in SURFACE.size)
SCREEN = Screen(px_per_in=132.0, width_px=1024.0, height_px=768.0, calibrated=True)
PERIOD = 1.0 / 60.0

Scene = dict[int, tuple[int, float, float]]
"""Finger (0 to 4) and place in 0..1, by an id that is never used twice."""


def hand(rng: random.Random) -> list[tuple[float, float]]:
    """Places in 0..1 of five fingertips of a hand somewhere on the surface."""
    tips = default_hand(5)
    turn, size = rng.uniform(-1.2, 1.2), rng.uniform(0.7, 1.1)
    rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    middle = np.array([rng.uniform(0.3, 0.7) * WIDTH, rng.uniform(0.3, 0.7) * HEIGHT])
    places = [middle + size * rotation @ tips[finger] for finger in range(5)]
    return [
        (min(max(float(x) / WIDTH, 0.0), 1.0), min(max(float(y) / HEIGHT, 0.0), 1.0))
        for x, y in places
    ]


def story(seed: int, events: int) -> Iterator[Scene]:
    """What is on the surface, frame by frame, until so many presses and lifts have happened."""
    rng = random.Random(seed)
    places, down, next_id, done = hand(rng), dict[int, int](), 0, 0
    while done < events:
        if not down and rng.random() < 0.3:
            places = hand(rng)
        for finger in rng.sample(range(5), rng.choice((0, 1, 1, 1, 2, 5))):
            done += 1
            if finger in down:
                del down[finger]
            else:
                down[finger], next_id = next_id, next_id + 1
        places = [
            tuple(min(max(v + rng.uniform(-0.01, 0.01), 0.0), 1.0) for v in p)  # type: ignore[misc]
            for p in places
        ]
        yield {i: (finger, *places[finger]) for finger, i in down.items()}
    yield {}


def as_tuio11(n: int, scene: Scene, repeat: bool) -> bytes:
    sets = {i: (x, y) for i, (_, x, y) in scene.items()}
    return frame(-1 if repeat else n + 1, sets, alive=list(scene), source="hand")


def as_tuio20(n: int, scene: Scene, repeat: bool) -> bytes:
    types = (5, 1, 2, 3, 4)
    pointers = [ptr(i, x, y, kind=types[finger]) for i, (finger, x, y) in scene.items()]
    return bundle(frm(0 if repeat else n + 1), *pointers, alv(*scene))


Encoder = Callable[[int, Scene, bool], bytes]
BOTH = pytest.mark.parametrize("encode", [as_tuio11, as_tuio20])


def assert_is(got: TouchFrame, scene: Scene) -> None:
    """Every finger is where it is, under its id, and nothing else is there."""
    places = {c.id: (c.x / WIDTH, c.y / HEIGHT) for c in got.contacts}
    assert places.keys() == scene.keys()
    for i, (_, x, y) in scene.items():
        assert math.dist(places[i], (x, y)) < 1e-6


def tuio_tells_all(encode: Encoder, events: int) -> None:
    tuio, frames = Tuio(), []
    for n, scene in enumerate(story(7, events)):
        now = n * PERIOD
        (commit,) = tuio.feed(encode(n, scene, False), "a", now)
        frames.append(touch_frame(commit, SURFACE, now))
        assert_is(frames[-1], scene)
        if encode is as_tuio20:
            assert {c.id: c.label for c in frames[-1].contacts} == {
                i: finger for i, (finger, _, _) in scene.items()
            }
    check_frames(frames, SURFACE)


def a_bad_network_leaves_none_stuck(encode: Encoder, events: int) -> None:
    """A tenth of the packets is lost, some are doubled, some overtake each other."""
    rng = random.Random(8)
    tuio, held = Tuio(), None
    for n, scene in enumerate(story(9, events)):
        now = n * PERIOD
        packet = encode(n, scene, False)
        fate = rng.random()
        if fate < 0.05 and held is None:
            held = packet  # comes after the next one
            continue
        sent = [] if fate < 0.15 else [packet, packet] if fate < 0.2 else [packet]
        if held is not None:
            sent, held = [*sent, held], None
        shown = [c for data in sent for c in tuio.feed(data, "a", now)]
        if fate >= 0.15:
            assert shown, "a packet that comes in time counts"
            assert_is(touch_frame(shown[-1], SURFACE, now), scene)
        if n % 60 == 59:  # once a second senders repeat all that is the case
            (commit,) = tuio.feed(encode(n, scene, True), "a", now)
            assert_is(touch_frame(commit, SURFACE, now), scene)
    last = tuio.expire(1e6)
    assert not last or not last[-1].touches


def the_page_tells_all(events: int) -> None:
    device, frames = WebDevice(SURFACE), []
    sizes = 1024.0 / SCREEN.px_per_in * METRES_PER_INCH, 768.0 / SCREEN.px_per_in * METRES_PER_INCH
    before: Scene = {}
    rng = random.Random(10)
    for n, scene in enumerate(story(11, events)):
        contacts = [
            [i, 1024.0 * x * WIDTH / sizes[0], 768.0 * y * HEIGHT / sizes[1], 20.0]
            for i, (_, x, y) in scene.items()
        ]
        gone = [i for i in before if i not in scene and rng.random() < 0.1]
        message = {
            "type": "touches",
            "seq": n + 1,
            "t": n * 16.0,
            "contacts": contacts,
            "cancelled": gone,
        }
        touches = decode(json.dumps(message))
        assert isinstance(touches, Touches)
        device.push(touches, SCREEN)
        (got,) = device.poll()
        assert_is(got, scene)
        assert got.cancelled == set(gone)
        frames.append(got)
        before = scene
    check_frames(frames, SURFACE)
    assert not device.touched


def the_mouse_tells_all(events: int) -> None:
    """Every finger is a pin: shift and a click put it down, shift and a click on it lift it."""
    device, frames = MouseDevice(SURFACE), []
    down: dict[int, tuple[float, float]] = {}
    rng, done = random.Random(13), 0
    places = [(x * WIDTH, y * HEIGHT) for x, y in hand(rng)]
    while done < events:
        if not down and rng.random() < 0.3:
            places = [(x * WIDTH, y * HEIGHT) for x, y in hand(rng)]
        for finger in rng.sample(range(5), rng.choice((1, 1, 2, 5))):
            near = [other for other in down if math.dist(down[other], places[finger]) < GRAB_RADIUS]
            if finger not in down and near:
                continue  # a click there would take hold of another finger
            if finger in down and near != [finger]:
                continue
            done += 1
            device.press(places[finger], pin=True)
            if finger in down:
                del down[finger]
            else:
                down[finger] = places[finger]
            device.release()
            frames += device.poll(0.0)
            there = sorted((c.x, c.y) for c in frames[-1].contacts)
            assert len(there) == len(down)
            for got, wanted in zip(there, sorted(down.values()), strict=True):
                assert math.dist(got, wanted) < 1e-9
        fate = rng.random()
        if fate < 0.05:
            # A finger that is the pointer itself comes and goes beside those that stay.
            corner = (0.0, 0.0) if all(math.dist(p, (0, 0)) > 0.02 for p in places) else None
            if corner:
                device.press(corner)
                assert len(device.poll(0.0)[-1].contacts) == len(down) + 1
                device.release()
                assert len(device.poll(0.0)[-1].contacts) == len(down)
        elif fate < 0.08 and down:
            done += len(down)
            device.lift()
            down.clear()
            frames += device.poll(0.0)
            assert frames[-1].contacts == ()
    device.close()
    frames += device.poll(0.0)
    assert frames[-1].contacts == ()
    check_frames(frames, SURFACE)


@BOTH
def test_every_press_and_lift_comes_through_tuio(encode: Encoder) -> None:
    tuio_tells_all(encode, QUICK)


@BOTH
def test_lost_doubled_and_overtaken_packets_leave_no_finger_stuck(encode: Encoder) -> None:
    a_bad_network_leaves_none_stuck(encode, QUICK)


def test_every_press_and_lift_comes_through_the_page() -> None:
    the_page_tells_all(QUICK)


def test_every_press_and_lift_comes_through_the_mouse() -> None:
    the_mouse_tells_all(QUICK)


@pytest.mark.full
@BOTH
def test_ten_thousand_presses_and_lifts_come_through_tuio(encode: Encoder) -> None:
    tuio_tells_all(encode, FULL)
    a_bad_network_leaves_none_stuck(encode, FULL)


@pytest.mark.full
def test_ten_thousand_presses_and_lifts_come_through_the_page() -> None:
    the_page_tells_all(FULL)


@pytest.mark.full
def test_ten_thousand_presses_and_lifts_come_through_the_mouse() -> None:
    the_mouse_tells_all(FULL)
