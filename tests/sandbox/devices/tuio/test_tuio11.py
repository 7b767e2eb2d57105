"""TUIO 1.1: what fingers do comes out of the packets, whatever senders and networks do to them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.tuio.tuio_frames import MAX_IDS
from tests.support.tuio_packets import (
    NO_OSC,
    NO_TUIO,
    blb,
    blobs,
    bundle,
    cur,
    frame,
    frame20,
    message,
)
from tests.support.tuio_table import PEER, A, B, C, Table, metres

Framed = Callable[..., bytes]
Places = dict[int, tuple[float, float]]
SHOWN: dict[str, tuple[list[bytes], list[Places]]] = {
    # A listener that begins while a finger rests does not know where the finger is.
    "an id without a position": ([frame(1, {2: B}, alive=[1, 2])], [{2: B}]),
    "a position of an id that is not alive": (
        [frame(1, {1: A, 2: B}, alive=[1]), frame(2, {}, alive=[1, 2])],
        [{1: A}, {1: A}],
    ),
    "an id that died and lives again without a position": (
        [frame(1, {1: A}), frame(2, {}), frame(3, {}, alive=[1])],
        [{1: A}, {}, {}],
    ),
    "a counter that falls by more than 100": (
        [frame(200, {1: A}), frame(99, {1: B}), frame(100, {1: C})],
        [{1: A}, {1: B}, {1: C}],
    ),
    "a counter that runs over": (
        [frame(2**31 - 1, {1: A}), frame(-(2**31), {1: B})],
        [{1: A}, {1: B}],
    ),
    "a counter that runs over in TUIO 2.0": (
        [frame20(2**31 - 1, {1: A}), frame20(-(2**31), {1: B})],
        [{1: A}, {1: B}],
    ),
    "a counter that is a text": (
        [frame(3, {1: B}), bundle(cur("alive", 1), cur("set", 1, *A), cur("fseq", "seven"))],
        [{1: B}, {1: A}],
    ),
    "two frames in one bundle": (
        [
            bundle(
                *(cur("alive", 1), cur("set", 1, *A), cur("fseq", 5)),
                *(cur("alive", 2), cur("set", 2, *B), cur("fseq", 6)),
            )
        ],
        [{1: A}, {2: B}],
    ),
    "two bundles in one": ([bundle(frame(5, {1: A}), frame(6, {2: B}))], [{1: A}, {2: B}]),
}


@pytest.mark.parametrize(("packets", "shown"), SHOWN.values(), ids=SHOWN)
def test_touches_are_those_that_live_and_have_a_position(
    packets: list[bytes], shown: list[Places]
) -> None:
    assert Table().feed(*packets) == shown


BOTH_VERSIONS = pytest.mark.parametrize("framed", [frame, frame20])


@BOTH_VERSIONS
@pytest.mark.parametrize("fall", [1, 50, 100])
def test_a_frame_that_was_overtaken_is_dropped_and_leaves_nothing_behind(
    framed: Framed, fall: int
) -> None:
    table = Table()
    frames = table.feed(
        framed(200, {1: A}), framed(200 - fall, {1: B, 2: C}), framed(201, {}, alive=[1, 2])
    )
    assert frames == [{1: A}, {1: A}]
    assert table.tuio.statistics.late == 1
    assert str(200 - fall) in table.tuio.statistics.late_reason


@pytest.mark.parametrize(
    ("framed", "number"), [(frame, -1), (frame, 0), (frame, -(2**31)), (frame20, 0)]
)
def test_frames_that_are_not_counted_always_apply_and_do_not_count(
    framed: Framed, number: int
) -> None:
    table = Table()
    assert table.feed(framed(50, {1: A}), framed(number, {1: B})) == [{1: A}, {1: B}]
    assert table.feed(framed(49, {1: C})) == []  # 50 is still the last that counted


@pytest.mark.parametrize("modulus", [60, 64, 100, 256, 1000])
def test_a_counter_that_begins_anew_after_few_frames_loses_three_at_most(modulus: int) -> None:
    table = Table()
    shown = table.feed(*(frame(n % modulus, {1: (n / 4096, 0.5)}) for n in range(1, 3000)))
    lost = 2999 - len(shown)
    assert lost == table.tuio.statistics.late <= 3 * (3000 // modulus)
    assert shown[-1] == {1: (2999 / 4096, 0.5)}


def test_packets_that_are_overtaken_one_by_one_stay_late() -> None:
    table = Table()
    numbers = [10, 5, 11, 6, 12, 7, 13, 8, 14, 9, 15]
    table.feed(*(frame(n, {1: A}) for n in numbers))
    assert table.tuio.statistics.late == 5


PARTS = [cur("alive", 1, 2), cur("set", 1, *A), cur("set", 2, *B), cur("fseq", 5)]


@given(st.permutations([*PARTS, cur("source", "s")]))
def test_the_order_within_a_bundle_does_not_matter(parts: list[bytes]) -> None:
    table = Table()
    assert table.feed(bundle(*parts)) == [{1: A, 2: B}]
    assert [source.name for source in table.tuio.sources] == ["s"]


def test_a_bundle_without_fseq_changes_nothing_and_is_counted() -> None:
    table = Table()
    table.feed(frame(1, {1: A}))
    assert table.feed(bundle(cur("alive", 1, 2), cur("set", 2, *B))) == []
    assert table.feed(frame(2, {}, alive=[1, 2])) == [{1: A}]
    assert table.tuio.statistics.unfinished == 1


def test_bare_messages_count_once_their_fseq_comes() -> None:
    table = Table()
    assert table.feed(cur("set", 1, *A), cur("alive", 1), cur("set", 2, *B)) == []
    assert table.feed(cur("fseq", 4)) == [{1: A}]
    late = [cur("alive", 1, 2), cur("set", 2, *C), cur("fseq", 3)]
    assert table.feed(*late) == []
    assert table.tuio.statistics.late == 1
    assert table.feed(cur("alive", 1, 2), cur("fseq", 5)) == [{1: A}]


def test_a_sender_of_bare_messages_that_never_closes_a_frame_costs_no_memory() -> None:
    table = Table()
    table.feed(*[cur("set", i, *A) for i in range(1000)])
    assert table.feed(cur("alive", 0), cur("fseq", 1)) == [{}], "the first was forgotten"
    table.feed(*[cur("set", i, *A) for i in range(1000)])
    last = list(range(1000 - MAX_IDS, 1000))
    assert table.feed(cur("alive", *last), cur("fseq", 2)) == [dict.fromkeys(last, A)]


@pytest.mark.parametrize("place", [-0.26, 1.26, 1e9, math.nan, math.inf])
@pytest.mark.parametrize("bad", [(1, 2), (2, 1)])
def test_a_position_beyond_the_margin_costs_itself_alone(
    place: float, bad: tuple[int, int]
) -> None:
    table = Table()
    table.feed(frame(1, {1: A, 2: A, 3: B}))
    wrong, right = bad
    packet = bundle(
        cur("alive", 1, 2),
        *(cur("set", i, place if i == wrong else 0.5, 0.75) for i in (1, 2)),
        cur("fseq", 2),
    )
    # The wrong one stays where it was, the other moves, the third is lifted at once.
    assert table.feed(packet) == [{wrong: A, right: B}]
    assert table.tuio.report.left_out == {"positions beyond the surface": 1}


@pytest.mark.parametrize("data", NO_OSC.values(), ids=NO_OSC.keys())
def test_a_malformed_packet_is_counted_with_its_reason_and_changes_nothing(data: bytes) -> None:
    table = Table()
    table.feed(frame(5, {1: A}, source="table"))
    assert table.feed(data) == []
    assert table.tuio.statistics.malformed == 1
    assert table.tuio.statistics.malformed_reason
    assert table.tuio.report.left_out.total() == 1
    assert len(table.tuio.sources) == 1
    assert table.feed(frame(6, {}, alive=[1])) == [{1: A}]


@pytest.mark.parametrize("data", NO_TUIO.values(), ids=NO_TUIO.keys())
def test_what_breaks_the_protocol_costs_itself_alone(data: bytes) -> None:
    table = Table()
    table.feed(frame(5, {1: A}, source="table"))
    for shown in table.feed(data):
        assert set(shown) == {1}
    assert table.tuio.statistics.malformed == 1
    assert table.tuio.statistics.malformed_reason
    assert table.feed(frame(20, {1: B})) == [{1: B}]


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        *(((), ""), ((4,), "4"), (("n" * 300,), "n" * 200), (("table\x07",), "table\ufffd")),
        *((("Tür",), "Tür"), (("ta\x00ble",), "ta"), ((None,), "None")),
    ],
)
def test_a_name_is_shown_as_well_as_it_can_be(name: tuple[object, ...], shown: str) -> None:
    table = Table()
    packet = bundle(cur("source", *name), cur("alive", 1), cur("set", 1, *A), cur("fseq", 1))
    assert table.feed(packet) == [{1: A}]
    assert [source.name for source in table.tuio.sources] == [shown]
    assert table.tuio.statistics.malformed == 0


def test_a_sender_that_lists_no_living_touches_has_those_of_each_frame() -> None:
    table = Table()
    packets = [
        bundle(*(cur("set", i, *A) for i in ids), cur("fseq", n))
        for n, ids in enumerate([(1,), (1, 2), (2,)], start=1)
    ]
    assert table.feed(*packets) == [{1: A}, {1: A, 2: A}, {2: A}]
    assert "living" in table.tuio.report.line()


def test_other_profiles_are_passed_over_without_complaint() -> None:
    table = Table()
    thing = [message("/tuio/2Dobj", "alive", 4), message("/tuio/2Dobj", "fseq", 12)]
    thing.append(message("/tuio/2Dobj", "set", 4, *[0.5] * 12))
    mixed = bundle(*thing, cur("alive", 1), cur("set", 1, *A), cur("fseq", 3), *thing)
    assert table.feed(bundle(*thing)) == []
    assert table.feed(mixed, frame(4, {1: B})) == [{1: A}, {1: B}]
    counts = table.tuio.statistics
    assert (counts.malformed, counts.late, counts.unfinished) == (0, 0, 0)
    assert (counts.ignored, counts.ignored_address) == (9, "/tuio/2Dobj")


FINGERS = st.dictionaries(
    st.integers(-(2**31), 2**31 - 1), st.tuples(*[st.floats(0, 1, width=32)] * 2), max_size=10
)


@BOTH_VERSIONS
@given(st.lists(FINGERS, min_size=1, max_size=15), st.data())
def test_whatever_fingers_do_is_what_comes_out(
    framed: Framed, scenes: list[dict[int, tuple[float, float]]], data: st.DataObject
) -> None:
    """A sender that sends only what changed, in random order and at random splits."""
    table = Table()
    packets: list[bytes] = []
    before: dict[int, Any] = {}
    for fseq, scene in enumerate(scenes, start=1):
        changed = [i for i in scene if scene[i] != before.get(i)]
        cut = data.draw(st.integers(0, len(changed)))
        alive = data.draw(st.permutations(list(scene)))
        for part in (changed[:cut], changed[cut:]):
            packets.append(framed(fseq, {i: scene[i] for i in part}, alive=alive, source="s"))
        before = scene
    assert table.feed(*packets)[1::2] == scenes


SURFACE = Surface(10.0, 5.0)


def sizes(table: Table, *packets: bytes) -> list[list[float | None]]:
    """Sizes in inches of the touches of every frame."""
    frames = [commit for packet in packets for commit in table.tuio.feed(packet, PEER, 0.0)]
    return [
        [c.size and round(c.size / METRES_PER_INCH, 6) for c in metres(f, SURFACE, 0.0).contacts]
        for f in frames
    ]


@pytest.mark.parametrize("same_ids", [True, False])
def test_a_touch_has_the_size_of_the_blob_it_lies_in(same_ids: bool) -> None:
    # A size is the diameter of the circle of the same area.
    a, b = (0.25, 0.5, 0.04, 0.08), (0.75, 0.5, 0.1, 0.05)
    ids = (1, 2) if same_ids else (2, 1)  # some senders number blobs for themselves
    found = sizes(
        Table(),
        blobs(1, dict(zip(ids, (a, b), strict=True))),
        frame(1, {1: (0.26, 0.5), 2: (0.74, 0.51)}),
    )
    assert found == [[0.4, 0.5]]


def test_a_touch_in_no_blob_has_no_size_and_a_blob_alone_is_no_touch() -> None:
    assert sizes(Table(), blobs(1, {1: (0.1, 0.1, 0.05, 0.05)})) == []
    found = sizes(Table(), blobs(1, {1: (0.1, 0.1, 0.05, 0.05)}), frame(1, {1: (0.9, 0.9)}))
    assert found == [[None]]


def test_a_blob_that_is_gone_gives_no_size_any_more() -> None:
    places = {1: (0.5, 0.5)}
    found = sizes(
        Table(),
        *(blobs(1, {1: (0.5, 0.5, 0.04, 0.08)}), frame(1, places), blobs(2, {}), frame(2, places)),
    )
    assert found == [[0.4], [None]]


def test_blobs_and_cursors_count_their_frames_apart() -> None:
    table = Table()
    found = sizes(
        table,
        *(frame(500, {1: (0.5, 0.5)}), blobs(450, {1: (0.5, 0.5, 0.04, 0.08)})),
        *(blobs(440, {}), frame(501, {1: (0.5, 0.5)})),
    )
    assert found == [[None], [0.4]]
    assert table.tuio.statistics.late == 1, "the older blobs, not the cursors"


@pytest.mark.parametrize(
    "odd",
    [
        blb("set", "one", 0.5, 0.5, 0.0, 0.1, 0.1, 0.01),
        blb("set", 1, 0.5, 0.5, 0.0, math.nan, -1.0, 0.01),
        *(blb("set", 1, 0.5, 0.5), blb("grow", 1), blb(), blb("alive", *range(200))),
    ],
)
def test_a_blob_that_makes_no_sense_costs_no_touch(odd: bytes) -> None:
    table = Table()
    packet = bundle(odd, blb("fseq", 1), cur("alive", 1), cur("set", 1, 0.5, 0.5), cur("fseq", 1))
    assert sizes(table, packet) == [[None]]
