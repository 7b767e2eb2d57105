"""Hands that press and lift at random: no finger gets stuck and no lift is lost, on any way in.

A hand's fingertips lie as they do when it is about to grip, somewhere on the surface and turned.
Its fingers come down, move and leave in any order, several at once now and then. The same story
goes through TUIO 1.1 and 2.0 over a bad network, and through the page: what each of them told is
laid beside what was the case.
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
from sandbox.devices.check_device import check_frames
from sandbox.devices.mouse.mouse import default_hand
from sandbox.devices.tuio.tuio_senders import Commit, Tuio
from sandbox.server.protocol import PageScreen, PageTouches, decode
from sandbox.server.web import WebDevice
from tests.support.tuio_packets import alv, bundle, frame, frm, ptr
from tests.support.tuio_table import metres

EVENTS = pytest.mark.parametrize("events", [1_000, pytest.param(10_000, marks=pytest.mark.full)])
"""Presses and lifts."""

SURFACE = Surface()
WIDTH, HEIGHT = (float(length) for length in SURFACE.size)
SCREEN = PageScreen(px_per_in=132.0, width_px=1024.0, height_px=768.0, calibrated=True)
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


Told = list[tuple[TouchFrame, Scene]]
"""What came through, beside what was the case."""
Points = list[tuple[float, float]]


def apart(told: Points, meant: Points) -> float:
    """How far the farthest is from where it was meant; infinite: one lacks or is too many."""
    return max(map(math.dist, told, meant), default=0.0) if len(told) == len(meant) else math.inf


def astray(told: TouchFrame, scene: Scene) -> float:
    """The same by the fingers' ids, in sides of the surface."""
    places = {c.id: (c.x / WIDTH, c.y / HEIGHT) for c in told.contacts}
    if places.keys() != scene.keys():
        return math.inf
    return apart([places[i] for i in scene], [(x, y) for _, x, y in scene.values()])


def through_a_bad_network(encode: Encoder, events: int) -> tuple[Told, list[Commit]]:
    """A tenth of the packets is lost, some are doubled, some overtake each other.

    What is told after a packet that comes in time, and the last of all, where silence ends it.
    """
    rng = random.Random(8)
    tuio, held, told = Tuio(), None, []
    everything: list[Commit] = []
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
        everything += shown
        if fate >= 0.15:
            assert shown, "a packet that comes in time counts"
            told.append((metres(shown[-1], SURFACE, now), scene))
        if n % 60 == 59:  # once a second senders repeat all that is the case
            (commit,) = tuio.feed(encode(n, scene, True), "a", now)
            told.append((metres(commit, SURFACE, now), scene))
            everything.append(commit)
    return told, everything + tuio.expire(1e6)


def through_the_page(events: int) -> tuple[Told, list[tuple[frozenset[int], set[int]]]]:
    """Also which touches it told to be cancelled, beside those that were."""
    device, told, cancelled = WebDevice(SURFACE), [], []
    sizes = 1024.0 / SCREEN.px_per_in * METRES_PER_INCH, 768.0 / SCREEN.px_per_in * METRES_PER_INCH
    before: Scene = {}
    rng = random.Random(10)
    for n, scene in enumerate(story(11, events)):
        contacts = [
            [i, 1024.0 * x * WIDTH / sizes[0], 768.0 * y * HEIGHT / sizes[1], 20.0, 20.0]
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
        assert isinstance(touches, PageTouches)
        device.receive(touches, SCREEN)
        (got,) = device.poll()
        told.append((got, scene))
        cancelled.append((got.cancelled, set(gone)))
        before = scene
    assert not device.touched
    return told, cancelled


@BOTH
@EVENTS
def test_lost_doubled_and_overtaken_packets_leave_no_finger_stuck(
    encode: Encoder, events: int
) -> None:
    told, everything = through_a_bad_network(encode, events)
    assert max(astray(frame, scene) for frame, scene in told) < 1e-6
    assert everything[-1].touches == ()


@EVENTS
def test_every_press_and_lift_comes_through_the_page(events: int) -> None:
    told, cancelled = through_the_page(events)
    assert max(astray(frame, scene) for frame, scene in told) < 1e-6
    assert all(said == meant for said, meant in cancelled)
    check_frames([frame for frame, _ in told], SURFACE)
