"""Several TUIO senders on one table: who is who, who has gone silent, and how many is too many."""

from __future__ import annotations

from sandbox.devices.tuio.tuio_frames import MAX_IDS
from sandbox.devices.tuio.tuio_senders import MAX_SOURCES, MAX_TOUCHES
from tests.support.tuio_packets import bundle, cur, frame, message
from tests.support.tuio_table import A, B, C, Table


def test_the_counters_of_two_sources_at_one_address_do_not_meet() -> None:
    table = Table()
    table.feed(frame(500, {1: A}, source="left"))
    assert len(table.feed(frame(450, {1: B}, source="right"))) == 1
    assert table.tuio.statistics.late == 0


def test_nor_do_those_of_two_senders_with_one_name() -> None:
    table = Table()
    table.feed(frame(500, {1: A}, source="app"), peer="192.0.2.1:1")
    (both,) = table.feed(frame(450, {1: B}, source="app"), peer="192.0.2.2:1")
    assert sorted(both.values()) == [A, B]


def test_equal_ids_of_different_sources_are_different_touches_for_as_long_as_they_live() -> None:
    table = Table()
    table.feed(frame(1, {1: A, -5: C}, source="left"))
    (both,) = table.feed(frame(1, {1: B, -5: C}, source="right"))
    assert len(both) == 4
    (other,) = {touch for touch, place in both.items() if place == B}
    (one_left,) = table.feed(frame(2, {}, source="left"))
    assert one_left[other] == B
    (moved,) = table.feed(frame(2, {1: A}, source="right"))
    assert moved == {other: A}


def test_a_single_sender_keeps_its_own_ids() -> None:
    for extreme in (0, 7, -1, 2**31 - 1, -(2**31)):
        assert Table().feed(frame(1, {extreme: A}, source="s")) == [{extreme: A}]


def test_the_source_holds_until_the_next_one_is_named() -> None:
    table = Table()
    table.feed(frame(1, {1: A}, source="left"), frame(1, {2: B}, source="right"))
    table.feed(frame(2, {2: C}))  # without a name: the last one
    assert {s.name: s.touches for s in table.tuio.sources} == {"left": 1, "right": 1}
    table.feed(bundle(cur("source", "left")))
    (last,) = table.feed(frame(3, {}))
    assert list(last.values()) == [C]


def test_the_last_name_in_a_packet_is_the_one_that_holds() -> None:
    table = Table()
    table.feed(bundle(cur("source", "a"), cur("source", "b"), cur("source", "a")))
    table.feed(frame(1, {1: A}))
    assert {s.name: s.touches for s in table.tuio.sources} == {"a": 1, "b": 0}


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


def test_silence_forgets_the_counter() -> None:
    table = Table(stale_after=2.0)
    table.feed(frame(60, {1: A}))
    table.wait(3.0)
    assert table.feed(frame(1, {1: B})) == [{1: B}]


def test_a_sender_that_starts_again_after_silence_has_its_own_ids_again() -> None:
    table = Table(stale_after=2.0)
    table.feed(frame(60, {0: A}, source="app"), peer="192.0.2.1:1000")
    table.wait(3.0)
    assert table.feed(frame(1, {0: B}, source="app"), peer="192.0.2.1:1001") == [{0: B}]


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
