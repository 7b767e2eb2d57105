"""Who sends: which packets are of one sender, whatever ports and connections they take."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.surface import Surface
from sandbox.devices.tuio.touch_capture import CaptureDevice, CapturedPacket, TouchCapture
from sandbox.devices.tuio.tuio_frames import MAX_IDS
from sandbox.devices.tuio.tuio_senders import MAX_SOURCES, MAX_TOUCHES
from tests.support.tuio_packets import alv, bundle, cur, frame, frame20, frm, message, ptr
from tests.support.tuio_table import A, B, C, Table

HOST = "192.0.2.5"
Framed = Callable[..., bytes]
Places = dict[int, tuple[float, float]]


def named(n: int, places: Places, **more: Sequence[int]) -> bytes:
    return frame(n, places, source="app", **more)


def uncounted(n: int, places: Places, **more: Sequence[int]) -> bytes:
    return frame(-1, places, **more)  # type: ignore[arg-type]


def nameless20(n: int, places: Places, **more: Sequence[int]) -> bytes:
    return frame20(n, places, source="", **more)


SENDERS = {
    "1.1": frame,
    "named": named,
    "uncounted": uncounted,
    "2.0": frame20,
    "2.0 nameless": nameless20,
}


def from_ports(table: Table, packets: Sequence[bytes], transport: str = "") -> list[Places]:
    """What is shown after each packet, each from the next port; connections end with a packet."""
    frames = []
    for n, packet in enumerate(packets, start=50_000):
        peer = f"{transport}{HOST}:{n}"
        frames += table.feed(packet, peer=peer)
        if transport:
            table.tuio.disconnect(peer, table.now)
            assert table.wait(0.1) == []
    return frames


@pytest.mark.parametrize("sender", SENDERS.values(), ids=SENDERS)
@pytest.mark.parametrize("transport", ["", "tcp ", "ws "])
def test_a_finger_whose_packets_come_from_ever_new_ports_is_one_touch(
    sender: Framed, transport: str
) -> None:
    scenes: list[Places] = [{7: A}, {7: B}, {7: B, 8: C}, {8: C}, {}, {9: A}, {}]
    table = Table()
    packets = [sender(n, scene) for n, scene in enumerate(scenes, start=1)]
    assert from_ports(table, packets, transport) == scenes
    assert len(table.tuio.sources) == 1


FINGERS = st.dictionaries(st.integers(0, 3), st.sampled_from([A, B, C]), max_size=3)


@given(st.lists(FINGERS, min_size=1, max_size=20), st.lists(st.integers(0, 9), max_size=9))
def test_what_a_sender_says_does_not_depend_on_its_ports(
    scenes: list[Places], lost: list[int]
) -> None:
    packets = [frame(n, scene) for n, scene in enumerate(scenes, start=1)]
    packets = [packet for n, packet in enumerate(packets) if n < 2 or n not in lost]
    assert from_ports(Table(), packets)[-1] == Table().feed(*packets)[-1]


IN_PARTS = {
    "messages without a bundle": [cur("alive", 7), cur("set", 7, *A), cur("fseq", 1)],
    "a frame in two bundles": [frame(7, {1: A}, alive=[1, 2]), frame(7, {2: B}, alive=[1, 2])],
    "a frame of TUIO 2.0 in two bundles": [
        bundle(frm(7), ptr(1, *A)),
        bundle(frm(7), ptr(2, *B), alv(1, 2)),
    ],
    "a packet that is overtaken": [frame(n, {7: (n / 64, 0.5)}) for n in (50, 51, 53, 52, 54)],
    "a name that is sent once": [frame(1, {7: A}, source="app"), frame(2, {7: B}), frame(3, {})],
}


@pytest.mark.parametrize("packets", IN_PARTS.values(), ids=IN_PARTS)
def test_parts_may_come_from_a_port_each(packets: list[bytes]) -> None:
    table, alone = Table(), Table()
    assert from_ports(table, packets)[-1] == alone.feed(*packets)[-1]
    assert [s.name for s in table.tuio.sources] == [s.name for s in alone.tuio.sources]
    assert table.tuio.statistics.late == alone.tuio.statistics.late


@pytest.mark.parametrize("names", [("left", "right"), (None, None), ("app", "app"), ("app", None)])
@pytest.mark.parametrize("counters", [(1, 1), (500, 1), (1, 500), (40, 60), (-1, -1)])
def test_two_senders_of_one_host_stay_two(
    names: tuple[str | None, str | None], counters: tuple[int, int]
) -> None:
    """Also without names, where only their ports and their frames tell them apart."""
    table = Table()
    peers = [f"{HOST}:1000", f"{HOST}:2000"]
    shown: list[Places] = []
    for step in range(4):
        for name, counter, peer, place in zip(names, counters, peers, (A, B), strict=True):
            number = counter + step if counter > 0 else counter
            shown += table.feed(frame(number, {1: place}, source=name), peer=peer)
    # One packet may be taken for the other's; from the second on each has its own touch.
    for both in shown[2:]:
        assert sorted(both.values()) == [A, B], shown
    (one,) = table.feed(frame(counters[0] + 9, {}, source=names[0]), peer=peers[0])
    assert list(one.values()) == [B]


def test_two_hosts_with_the_same_port_are_two_senders() -> None:
    table = Table()
    table.feed(frame(1, {1: A}), peer="192.0.2.5:1000")
    (both,) = table.feed(frame(2, {1: B}), peer="192.0.2.6:1000")
    assert sorted(both.values()) == [A, B]


def test_a_sender_with_many_ports_and_one_with_its_own_stay_two() -> None:
    table = Table()
    shown = {}
    for n in range(1, 12):
        table.feed(frame(n, {1: A}), peer=f"{HOST}:{50_000 + n}")
        (shown,) = table.feed(frame(900 + n, {1: B}), peer=f"{HOST}:2000")
    assert sorted(shown.values()) == [A, B]
    assert len(table.tuio.sources) == 2


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


def test_a_capture_that_ends_with_a_connection_cancels_its_touches() -> None:
    packets = (
        CapturedPacket(0.0, frame(1, {7: A}), "tcp h:1"),
        CapturedPacket(0.1, None, "tcp h:1"),
    )
    device = CaptureDevice(TouchCapture(packets), Surface())
    down, up = device.poll(1.0)
    assert (len(down.contacts), len(up.contacts), up.cancelled) == (1, 0, frozenset({7}))


def both(n: int, places: Places, source: str | None) -> list[bytes]:
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


def test_equal_ids_of_different_sources_are_different_touches_for_as_long_as_they_live() -> None:
    table = Table()
    # The counters of the sources are independent, too.
    table.feed(frame(500, {1: A, -5: C}, source="left"))
    (both,) = table.feed(frame(450, {1: B, -5: C}, source="right"))
    assert len(both) == 4
    (other,) = {touch for touch, place in both.items() if place == B}
    (one_left,) = table.feed(frame(501, {}, source="left"))
    assert one_left[other] == B
    (moved,) = table.feed(frame(451, {1: A}, source="right"))
    assert moved == {other: A}


def test_the_source_holds_until_the_next_one_is_named() -> None:
    table = Table()
    table.feed(frame(1, {1: A}, source="left"), frame(1, {2: B}, source="right"))
    table.feed(frame(2, {2: C}))  # without a name: the last one
    assert {s.name: s.touches for s in table.tuio.sources} == {"left": 1, "right": 1}
    table.feed(bundle(cur("source", "left")))
    (last,) = table.feed(frame(3, {}))
    assert list(last.values()) == [C]


def test_packets_before_the_first_name_belong_to_the_sender_that_is_named_later() -> None:
    table = Table()
    table.feed(frame(-1, {}), frame(1, {4: A}))
    assert table.feed(frame(2, {4: B}, source="app")) == [{4: B}]
    assert [source.name for source in table.tuio.sources] == ["app"]


def test_the_name_may_come_with_another_profile() -> None:
    table = Table()
    table.feed(bundle(message("/tuio/2Dobj", "source", "app"), message("/tuio/2Dobj", "fseq", 1)))
    table.feed(frame(1, {1: A}))
    assert [(s.name, s.touches) for s in table.tuio.sources] == [("app", 1)]


def test_a_silent_source_goes_stale_and_its_touches_lift() -> None:
    table = Table(stale_after=2.0)
    table.feed(frame(1, {1: A}, source="quiet"), frame(1, {1: B}, source="busy"))
    for fseq in range(2, 5):
        assert table.wait(0.9) == [] if fseq < 4 else table.wait(0.9)
        table.feed(frame(fseq, {}, alive=[1], source="busy"))
    assert [(s.name, s.stale, s.touches) for s in table.tuio.sources] == [
        ("quiet", True, 0),
        ("busy", False, 1),
    ]
    assert table.wait(1.0) == []
    assert table.wait(1.5) == [{}]
    assert table.wait(10.0) == [], "it is said once"


def test_any_packet_of_a_source_is_a_sign_of_life() -> None:
    table = Table(stale_after=2.0)
    table.feed(frame(10, {1: A}, source="app"))
    signs = [
        bundle(),  # nothing at all
        bundle(message("/tuio/2Dobj", "alive"), message("/tuio/2Dobj", "fseq", 3)),
        frame(9, {1: B}),  # late
        bundle(cur("alive", 1)),  # without fseq
        bundle(cur("source", "app")),
    ]
    for sign in signs:
        assert table.wait(1.5) == []
        assert table.feed(sign) == []
    assert table.wait(2.5) == [{}]


def test_a_resting_finger_comes_back_when_its_silent_sender_speaks_again() -> None:
    table = Table(stale_after=2.0)
    table.feed(frame(10, {1: A, 2: B}))
    assert table.wait(3.0) == [{}]
    assert table.feed(frame(11, {2: C}, alive=[1, 2])) == [{1: A, 2: C}]


def test_too_many_sources_push_out_the_one_unheard_for_longest() -> None:
    table = Table(stale_after=1e9)
    for n in range(MAX_SOURCES):
        table.feed(frame(1, {0: A}, source=f"s{n}"))
    table.feed(frame(2, {0: B}, source="s0"))
    assert table.tuio.statistics.evicted == 0
    lifted, shown = table.feed(frame(1, {0: C}, source="new"))
    names = [source.name for source in table.tuio.sources]
    assert (len(names), "s0" in names, "s1" in names) == (MAX_SOURCES, True, False)
    assert (len(lifted), len(shown)) == (MAX_SOURCES - 1, MAX_SOURCES)
    assert table.tuio.statistics.evicted == 1


def test_a_flood_of_sources_and_touches_stays_bounded_and_whoever_speaks_is_seen() -> None:
    table = Table(stale_after=1e9)
    crowd = dict.fromkeys(range(MAX_IDS), A)
    for n in range(3 * MAX_SOURCES):
        for shown in table.feed(frame(1, crowd, source=f"s{n}"), peer=f"192.0.2.1:{n}"):
            assert len(shown) <= MAX_TOUCHES
    assert len(table.tuio.sources) == MAX_SOURCES
    shown = table.feed(frame(1, {3: B}, source="finger"), peer="192.0.2.9:1")[-1]
    assert B in shown.values()
    assert table.tuio.statistics.surplus > 0
