"""The Leap device reads a running service, loses nothing at its fastest, and comes back."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from itertools import pairwise
from typing import Any

import pytest

from sandbox.devices.leap.leap import KEPT, LeapDevice
from sandbox.devices.leap.leap_fake import FakeLeapd
from sandbox.devices.leap.leap_write import leap_message
from sandbox.devices.leap.two_hands import SplitBySide
from sandbox.devices.wrappers.shared import SharedDevice
from tests.support.leap_hands import take
from tests.support.processes import until


@cache
def messages() -> list[dict[str, Any]]:
    return [leap_message(f, n) for n, f in enumerate(take(0).frames[:300])]


def free_port() -> int:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        return taken.getsockname()[1]


@contextmanager
def served(sent: list[Any], **pace: Any) -> Iterator[tuple[FakeLeapd, LeapDevice]]:
    """A service that sends messages, and a device that reads it."""
    server = FakeLeapd(sent, port=0, **pace)
    device = LeapDevice(server.address)
    try:
        yield server, device
    finally:
        device.close()
        server.close()


def test_at_290_frames_a_second_every_frame_arrives_once_and_in_order() -> None:
    frames: list[Any] = []
    with served(messages(), rate=290.0) as (_, device):
        until(lambda: frames.extend(device.poll(0.0)) or len(frames) >= 300)
    # The fake plays to every client from the start, so what follows is a second connection.
    assert [f.time for f in frames[:300]] == pytest.approx([f.time for f in take(0).frames[:300]])
    assert device.counts["handshakes"] >= 1
    assert device.counts["frames nobody fetched"] == 0


def test_frames_that_nobody_fetches_are_dropped_oldest_first_and_counted() -> None:
    with served(messages(), rate=5000.0, loop=True) as (_, device):
        until(lambda: device.counts["frames nobody fetched"] > 50)
        latest = device.poll(0.0)
    assert len(latest) == KEPT
    assert all(a.time < b.time for a, b in pairwise(latest))


def test_a_service_that_is_started_anew_is_found_again_and_time_goes_on() -> None:
    port = free_port()
    device = LeapDevice(f"ws://127.0.0.1:{port}/v6.json")
    frames: list[Any] = []
    try:
        for n in (1, 2):
            server = FakeLeapd(messages(), port=port, rate=400.0, loop=True)
            until(lambda n=n: device.counts["connections"] == n)  # type: ignore[misc]
            more = len(frames) + 50
            until(lambda n=more: frames.extend(device.poll(0.0)) or len(frames) > n)  # type: ignore[misc]
            server.close()
            until(lambda: not device.connected.is_set())
    finally:
        device.close()
    assert all(a.time < b.time for a, b in pairwise(frames))


def test_a_person_is_told_while_the_service_is_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sandbox.devices.leap.leap.GONE", 0.3)
    with served(messages(), rate=400.0, loop=True) as (server, device):
        hands = SharedDevice(device, SplitBySide(("right", "left"))).parts
        until(lambda: device.counts["frames"] > 0)
        assert device.notices == ()
        server.close()
        until(lambda: "the Leap service is silent" in "".join(device.notices))
        # Two hands over one device say it once.
        assert [part.notices for part in hands] == [device.notices, ()]
        until(lambda: device.counts["connections lost"] == 1)


def test_damaged_messages_are_counted_and_the_connection_stays() -> None:
    junk = [{"hands": 3, "pointables": 4}, {"weather": 1}, {"event": {}}, {"hands": [{"id": 1}]}]
    with served([*junk, *messages()[:50]], rate=500.0, loop=True) as (_, device):
        until(lambda: device.counts["frames"] >= 60)
        assert device.counts["connections"] == 1
        assert device.counts["messages of another program"] >= 1
