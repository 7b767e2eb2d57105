"""Who sends: one finger is one touch, whatever ports, versions and connections its packets take."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.surface import Surface
from sandbox.devices.tuio.touch_capture import CaptureDevice, CapturedPacket, TouchCapture
from sandbox.devices.tuio.tuio_senders import MAX_SOURCES
from tests.support.tuio_packets import alv, bundle, cur, frame, frame20, frm, ptr
from tests.support.tuio_table import A, B, C, Table

HOST = "192.0.2.5"
Framed = Callable[..., bytes]


def named(n: int, places: dict[int, tuple[float, float]], **more: Sequence[int]) -> bytes:
    return frame(n, places, source="app", **more)


def uncounted(n: int, places: dict[int, tuple[float, float]], **more: Sequence[int]) -> bytes:
    return frame(-1, places, **more)  # type: ignore[arg-type]


def nameless20(n: int, places: dict[int, tuple[float, float]], **more: Sequence[int]) -> bytes:
    return frame20(n, places, source="", **more)


SENDERS = {
    "1.1": frame,
    "named": named,
    "uncounted": uncounted,
    "2.0": frame20,
    "2.0 nameless": nameless20,
}


def from_ports(
    table: Table, packets: Sequence[bytes], first: int = 50_000, transport: str = ""
) -> list[dict[int, tuple[float, float]]]:
    """What is shown after each packet, each sent from the next port."""
    return [
        shown
        for n, packet in enumerate(packets)
        for shown in table.feed(packet, peer=f"{transport}{HOST}:{first + n}")
    ]


@pytest.mark.parametrize("sender", SENDERS.values(), ids=SENDERS)
@pytest.mark.parametrize("transport", ["", "tcp ", "ws "])
def test_a_finger_whose_packets_come_from_ever_new_ports_is_one_touch(
    sender: Framed, transport: str
) -> None:
    scenes: list[dict[int, tuple[float, float]]] = [
        {7: A},
        {7: B},
        {7: B, 8: C},
        {8: C},
        {},
        {9: A},
        {},
    ]
    table = Table()
    packets = [sender(n, scene) for n, scene in enumerate(scenes, start=1)]
    assert from_ports(table, packets, transport=transport) == scenes
    assert len(table.tuio.sources) == 1


FINGERS = st.dictionaries(st.integers(0, 3), st.sampled_from([A, B, C]), max_size=3)


@given(st.lists(FINGERS, min_size=1, max_size=20), st.lists(st.integers(0, 9), max_size=9))
def test_what_a_sender_says_does_not_depend_on_its_ports(
    scenes: list[dict[int, tuple[float, float]]], lost: list[int]
) -> None:
    packets = [frame(n, scene) for n, scene in enumerate(scenes, start=1)]
    packets = [packet for n, packet in enumerate(packets) if n < 2 or n not in lost]
    assert from_ports(Table(), packets)[-1] == Table().feed(*packets)[-1]


def test_messages_without_a_bundle_may_come_from_a_port_each() -> None:
    table = Table()
    packets = [cur("alive", 7), cur("set", 7, *A), cur("fseq", 1), cur("alive"), cur("fseq", 2)]
    assert from_ports(table, packets) == [{7: A}, {}]
    assert len(table.tuio.sources) == 1


def test_a_frame_in_parts_may_come_from_a_port_each() -> None:
    for packets in (
        [frame(7, {1: A}, alive=[1, 2]), frame(7, {2: B}, alive=[1, 2])],
        [bundle(frm(7), ptr(1, *A)), bundle(frm(7), ptr(2, *B), alv(1, 2))],
    ):
        table = Table()
        assert from_ports(table, packets)[-1] == {1: A, 2: B}
        assert len(table.tuio.sources) == 1


def test_an_overtaken_packet_of_a_sender_with_many_ports_is_late_and_no_sender() -> None:
    table = Table()
    packets = [frame(n, {7: A}) for n in (50, 51, 53)]
    assert from_ports(table, [*packets, frame(52, {7: B}), frame(54, {})])[-1] == {}
    assert (table.tuio.statistics.late, len(table.tuio.sources)) == (1, 1)


def test_a_name_that_was_sent_once_holds_at_every_port_of_its_sender() -> None:
    table = Table()
    from_ports(table, [frame(1, {7: A}, source="app"), frame(2, {7: B}), frame(3, {7: C})])
    assert [(s.name, s.touches) for s in table.tuio.sources] == [("app", 1)]


def test_packets_before_the_name_belong_to_its_sender_at_every_port() -> None:
    table = Table()
    shown = from_ports(table, [frame(-1, {}), frame(1, {4: A}), frame(2, {4: B}, source="app")])
    assert shown[-1] == {4: B}
    assert [source.name for source in table.tuio.sources] == ["app"]


@pytest.mark.parametrize("names", [("left", "right"), (None, None), ("app", "app"), ("app", None)])
@pytest.mark.parametrize("counters", [(1, 1), (500, 1), (1, 500), (40, 60), (-1, -1)])
def test_two_senders_of_one_host_stay_two(
    names: tuple[str | None, str | None], counters: tuple[int, int]
) -> None:
    """Also without names, where only their ports and their frames tell them apart."""
    table = Table()
    peers = [f"{HOST}:1000", f"{HOST}:2000"]
    shown: list[dict[int, tuple[float, float]]] = []
    for step in range(4):
        for name, counter, peer, place in zip(names, counters, peers, (A, B), strict=True):
            number = counter + step if counter > 0 else counter
            shown += table.feed(frame(number, {1: place}, source=name), peer=peer)
    # One packet may be taken for the other's; from the second on each has its own touch.
    for both in shown[2:]:
        assert sorted(both.values()) == [A, B], shown
    (one,) = table.feed(frame(counters[0] + 9, {}, source=names[0]), peer=peers[0])
    assert list(one.values()) == [B]


def test_a_resting_finger_of_the_first_sender_survives_the_second() -> None:
    table = Table()
    table.feed(frame(300, {1: A}), peer=f"{HOST}:1000")
    shown = table.feed(frame(1, {1: B}), frame(2, {1: C}), peer=f"{HOST}:2000")
    assert all(A in both.values() for both in shown)
    (again,) = table.feed(frame(301, {}, alive=[1]), peer=f"{HOST}:1000")
    assert sorted(again.values()) == [A, C]


def test_a_sender_with_many_ports_and_one_with_its_own_stay_two() -> None:
    table = Table()
    shown = {}
    for n in range(1, 12):
        table.feed(frame(n, {1: A}), peer=f"{HOST}:{50_000 + n}")
        (shown,) = table.feed(frame(900 + n, {1: B}), peer=f"{HOST}:2000")
    assert sorted(shown.values()) == [A, B]
    assert len(table.tuio.sources) == 2


def test_ports_tell_hosts_apart_no_more_than_senders() -> None:
    table = Table()
    table.feed(frame(1, {1: A}), peer="192.0.2.5:1000")
    (both,) = table.feed(frame(2, {1: B}), peer="192.0.2.6:1000")
    assert sorted(both.values()) == [A, B]


def test_ids_are_used_again_after_a_minute() -> None:
    table = Table()
    from_ports(table, [frame(1, {1: A}), frame(2, {})])
    table.wait(60.0)
    assert from_ports(table, [frame(3, {1: B}), frame(4, {})], first=60_000) == [{1: B}, {}]
    assert len(table.tuio.sources) == 1


def test_a_sender_with_a_million_ports_costs_no_memory() -> None:
    table = Table()
    from_ports(table, [frame(n, {1: A}) for n in range(1, 3 * MAX_SOURCES)])
    (source,) = table.tuio._sources
    assert source.before is not None and source.before.before is None


def test_a_sender_that_reconnects_before_its_old_connection_ends_keeps_its_touches() -> None:
    table = Table()
    table.feed(frame(1, {1: A}), peer=f"tcp {HOST}:1000")
    table.feed(frame(2, {1: B}), peer=f"tcp {HOST}:1001")
    table.tuio.disconnect(f"tcp {HOST}:1000", table.now)
    assert table.wait(0.5) == []
    table.tuio.disconnect(f"tcp {HOST}:1001", table.now)
    (commit,) = table.tuio.expire(table.now + 0.3)
    assert (commit.touches, commit.cancelled) == ((), frozenset({1}))
    assert not table.tuio.sources


@pytest.mark.parametrize("transport", ["tcp", "ws"])
@pytest.mark.parametrize("sender", SENDERS.values(), ids=SENDERS)
def test_a_finger_with_a_connection_for_every_packet_is_one_touch(
    transport: str, sender: Framed
) -> None:
    table = Table()
    for n, scene in enumerate([{7: A}, {7: B}, {7: B, 8: C}, {8: C}, {}], start=1):
        peer = f"{transport} {HOST}:{n}"
        assert table.feed(sender(n, scene), peer=peer) == [scene]
        table.tuio.disconnect(peer, table.now)
        assert table.wait(0.1) == []
    assert len(table.tuio.sources) <= 1


def test_a_capture_that_ends_with_a_connection_cancels_its_touches() -> None:
    packets = (
        CapturedPacket(0.0, frame(1, {7: A}), "tcp h:1"),
        CapturedPacket(0.1, None, "tcp h:1"),
    )
    device = CaptureDevice(TouchCapture(packets), Surface())
    down, up = device.poll(1.0)
    assert (len(down.contacts), len(up.contacts), up.cancelled) == (1, 0, frozenset({7}))


def both(n: int, places: dict[int, tuple[float, float]], source: str | None) -> list[bytes]:
    return [frame(n, places, source=source), frame20(n, places, source="two")]


@pytest.mark.parametrize("source", [None, "app@192.0.2.5", "two"])
@pytest.mark.parametrize("peers", [(f"{HOST}:1", f"{HOST}:1"), (f"{HOST}:1", f"{HOST}:2")])
@pytest.mark.parametrize("first", [0, 1])
def test_a_sender_of_both_versions_has_every_finger_once(
    source: str | None, peers: tuple[str, str], first: int
) -> None:
    scenes = [{1: A}, {1: B, 2: C}, {2: B}, {2: C}, {}, {3: A}, {}]
    table = Table()
    for n, scene in enumerate(scenes, start=1):
        packets = list(zip(both(n, scene, source), peers, strict=True))
        for packet, peer in packets[::-1] if first else packets:
            for shown in table.feed(packet, peer=peer):
                assert shown in (scene, scenes[n - 2])
        assert shown == scene
    assert table.tuio.report.line().count("twice") == 1


def test_a_sender_over_two_transports_has_every_finger_once() -> None:
    table = Table()
    for n, scene in enumerate([{1: A}, {1: B, 2: C}, {}], start=1):
        for transport in ("", "tcp ", "ws "):
            for shown in table.feed(frame(n, scene, source="app"), peer=f"{transport}{HOST}:{n}"):
                assert shown == scene


def test_when_one_version_falls_silent_the_other_is_shown() -> None:
    table = Table(stale_after=0.5)
    for packet in both(1, {1: A}, None):
        table.feed(packet)
    shown = []
    for n in range(2, 9):
        table.now += 0.1
        shown += table.wait(0.0) + table.feed(frame(n, {1: B}))
    assert shown[-1] == {1: B}


def test_two_programs_of_one_host_with_a_version_each_stay_two() -> None:
    table = Table()
    table.feed(frame(1, {1: A}, source="old"), peer=f"{HOST}:1")
    (both_,) = table.feed(frame20(1, {1: B}, source="new"), peer=f"{HOST}:2")
    assert sorted(both_.values()) == [A, B]


def test_a_recorded_sender_with_a_port_per_packet_plays_as_one_finger() -> None:
    packets = [
        CapturedPacket(
            0.05 * n, frame(n, {7: (n / 16, 0.5)} if n < 12 else {}), f"{HOST}:{50_000 + n}"
        )
        for n in range(1, 13)
    ]
    device = CaptureDevice(TouchCapture(tuple(packets)), Surface())
    frames = device.poll(10.0)
    assert [[c.id for c in frame.contacts] for frame in frames] == [[7]] * 11 + [[]]
