"""What we send as TUIO is what touches did, as our own decoder and python-osc's read it."""

from __future__ import annotations

import socket

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pythonosc.osc_packet import OscPacket

from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.devices.tuio.tuio_output import PERIOD, TuioEncoder, TuioOutput
from sandbox.devices.tuio.tuio_senders import Tuio
from tests.support.processes import until
from tests.support.tuio_table import metres

SURFACE = Surface(10.0, 5.0)
WIDTH, HEIGHT = (float(length) for length in SURFACE.size)
PLACES = st.tuples(*[st.integers(0, 256).map(lambda n: n / 256)] * 2)
SCENES = st.lists(
    st.dictionaries(st.integers(-(2**60), 2**60), PLACES, max_size=30), min_size=1, max_size=12
)


def as_frames(scenes: list[dict[int, tuple[float, float]]]) -> list[TouchFrame]:
    return [
        TouchFrame(n / 60, tuple(Contact(i, WIDTH * x, HEIGHT * y) for i, (x, y) in scene.items()))
        for n, scene in enumerate(scenes)
    ]


@given(SCENES)
def test_our_own_decoder_reads_what_fingers_did(
    scenes: list[dict[int, tuple[float, float]]],
) -> None:
    encoder, tuio = TuioEncoder(SURFACE), Tuio()
    for frame in as_frames(scenes):
        commits = [c for p in encoder.bundles(frame) for c in tuio.feed(p, "a", frame.time)]
        read = metres(commits[-1], SURFACE, frame.time)
        got = sorted((c.x, c.y) for c in read.contacts)
        expected = sorted((c.x, c.y) for c in frame.contacts)
        assert [x for place in got for x in place] == pytest.approx(
            [x for place in expected for x in place], abs=1e-7
        )
    counts = tuio.statistics
    assert (counts.malformed, counts.late, counts.unfinished, counts.ignored) == (0, 0, 0, 0)


@given(SCENES)
def test_python_osc_reads_whole_bundles_in_the_order_of_the_protocol(
    scenes: list[dict[int, tuple[float, float]]],
) -> None:
    encoder = TuioEncoder(SURFACE, "table")
    alive_before: set[int] = set()
    for n, frame in enumerate(as_frames(scenes)):
        alive: set[int] = set()
        for packet in encoder.bundles(frame):
            assert len(packet) <= 1500
            messages = [m.message for m in OscPacket(packet).messages]
            assert all(m.address == "/tuio/2Dcur" for m in messages)
            commands = [m.params[0] for m in messages]
            assert commands[:2] == ["source", "alive"]
            assert commands[-1] == "fseq"
            assert set(commands[2:-1]) <= {"set"}
            assert messages[0].params[1] == "table"
            assert messages[-1].params[1] == n + 1
            alive = set(messages[1].params[1:])
            sets = [m.params[1:] for m in messages[2:-1]]
            assert {s[0] for s in sets} <= alive
            assert all(len(s) == 6 and 0.0 <= s[1] <= 1.0 and 0.0 <= s[2] <= 1.0 for s in sets)
        assert len(alive) == len(frame.contacts)
        fresh = alive - alive_before
        assert not fresh or min(fresh) > max(alive_before, default=-1), "no id is used twice"
        alive_before |= alive


def test_speed_is_in_surface_lengths_a_second() -> None:
    encoder = TuioEncoder(SURFACE)
    encoder.bundles(TouchFrame(1.0, (Contact(7, 0.25 * WIDTH, 0.5 * HEIGHT),)))
    (packet,) = encoder.bundles(TouchFrame(1.5, (Contact(7, 0.5 * WIDTH, 0.25 * HEIGHT),)))
    sets = [m.message.params for m in OscPacket(packet).messages if m.message.params[0] == "set"]
    assert sets == [["set", 0, 0.5, 0.25, 0.5, -0.5, pytest.approx(2**0.5)]]


def test_a_finger_that_rests_is_not_sent_again_but_for_the_packets_that_repeat_all() -> None:
    encoder = TuioEncoder(SURFACE)
    resting = (Contact(7, 0.25 * WIDTH, 0.5 * HEIGHT),)
    first, second, third = (encoder.bundles(TouchFrame(t, resting)) for t in (0.0, 0.1, 0.2))
    assert [b"set" in p for p in (*first, *second, *third)] == [True, False, False]
    (again,) = encoder.redundant()
    messages = [m.message.params for m in OscPacket(again).messages]
    assert messages[1:3] == [["alive", 0], ["set", 0, 0.25, 0.5, 0.0, 0.0, 0.0]]
    assert messages[-1] == ["fseq", -1]
    # A receiver that missed all packets but this one knows the touches.
    (commit,) = Tuio().feed(again, "a", 0.0)
    assert [(t.x, t.y) for t in commit.touches] == [(0.25, 0.5)]


def test_over_a_socket_touches_arrive_and_leave_when_it_is_closed() -> None:
    with TuioDevice(SURFACE, port=0) as device:
        output = TuioOutput(device.address, SURFACE)
        frame = TouchFrame(0.0, (Contact(7, 0.1, 0.05),))
        output.send([frame], 0.0)
        output.send([], 0.5 * PERIOD)
        assert output.packets == 2
        output.send([], 1.5 * PERIOD)
        assert output.packets == 3
        output.close()
        until(lambda: device.statistics.frames == 5)
        frames = device.poll()
        assert [len(f.contacts) for f in frames] == [1, 1, 1, 0, 0]
        assert (frames[0].contacts[0].x, frames[0].contacts[0].y) == pytest.approx((0.1, 0.05))


def test_packets_to_nobody_are_counted() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
    output = TuioOutput(f"127.0.0.1:{port}", SURFACE)
    frames = [TouchFrame(float(n)) for n in range(20)]
    for frame in frames:
        output.send([frame], frame.time)
    output.close()
    assert output.refused > 0
