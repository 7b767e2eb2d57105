"""TUIO 1.1: what fingers do comes out of the packets, whatever senders and networks do to them."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.devices.tuio.tuio_frames import MAX_IDS
from tests.support.tuio_packets import MALFORMED, bundle, cur, frame, message, reference_frames
from tests.support.tuio_table import A, B, C, Table


def test_a_finger_comes_moves_rests_and_goes() -> None:
    frames = Table().feed(
        frame(96, {3: A}), frame(97, {3: B}), frame(98, {}, alive=[3]), frame(99, {})
    )
    assert frames == [{3: A}, {3: B}, {3: B}, {}]


def test_only_the_fingers_that_moved_are_sent_and_the_others_stay() -> None:
    frames = Table().feed(frame(1, {1: A, 2: B}), frame(2, {2: C}, alive=[1, 2]))
    assert frames == [{1: A, 2: B}, {1: A, 2: C}]


def test_a_living_id_that_was_never_placed_is_not_shown() -> None:
    # Whoever starts listening while a finger rests does not know where it is.
    assert Table().feed(frame(1, {2: B}, alive=[1, 2])) == [{2: B}]


def test_a_set_for_an_id_that_is_not_alive_is_no_touch() -> None:
    assert Table().feed(frame(1, {1: A, 2: B}, alive=[1]), frame(2, {}, alive=[1, 2])) == [
        {1: A},
        {1: A},
    ]


def test_an_id_that_died_and_lives_again_must_be_placed_anew() -> None:
    table = Table()
    assert table.feed(frame(1, {1: A}), frame(2, {}), frame(3, {}, alive=[1])) == [{1: A}, {}, {}]


def test_gaps_in_the_counter_are_no_loss() -> None:
    assert Table().feed(frame(96, {1: A}), frame(5000, {1: B})) == [{1: A}, {1: B}]


@pytest.mark.parametrize("fall", [1, 50, 100])
def test_a_frame_that_was_overtaken_is_dropped_and_leaves_nothing_behind(fall: int) -> None:
    table = Table()
    frames = table.feed(
        frame(200, {1: A}), frame(200 - fall, {1: B, 2: C}), frame(201, {}, alive=[1, 2])
    )
    assert frames == [{1: A}, {1: A}]
    assert table.tuio.statistics.late == 1
    assert str(200 - fall) in table.tuio.statistics.late_reason


def test_a_counter_that_falls_by_more_than_100_is_a_sender_that_began_anew() -> None:
    frames = Table().feed(frame(200, {1: A}), frame(99, {1: B}), frame(100, {1: C}))
    assert frames == [{1: A}, {1: B}, {1: C}]


@pytest.mark.parametrize("fseq", [-1, 0, -(2**31)])
def test_frames_that_are_not_counted_always_apply_and_do_not_count(fseq: int) -> None:
    table = Table()
    assert table.feed(frame(50, {1: A}), frame(fseq, {1: B})) == [{1: A}, {1: B}]
    assert table.feed(frame(49, {1: C})) == []  # 50 is still the last that counted


def test_the_counter_may_run_over() -> None:
    frames = Table().feed(frame(2**31 - 1, {1: A}), frame(-(2**31), {1: B}), frame(1, {1: C}))
    assert frames == [{1: A}, {1: B}, {1: C}]


def test_a_frame_split_over_packets_is_whole_after_the_last() -> None:
    whole = dict.fromkeys(range(7), A) | {7: B, 8: C}
    parts = [range(3), range(3, 6), range(6, 7), range(7, 9)]
    packets = [frame(7, {i: whole[i] for i in ids}, alive=range(9)) for ids in parts]
    frames = Table().feed(*packets)
    assert [len(f) for f in frames] == [3, 6, 7, 9]
    assert frames[-1] == whole


@given(st.permutations([cur("alive", 1, 2), cur("set", 1, *A), cur("set", 2, *B), cur("fseq", 5)]))
def test_the_order_within_a_bundle_does_not_matter(parts: list[bytes]) -> None:
    assert Table().feed(bundle(*parts)) == [{1: A, 2: B}]


@given(st.permutations([cur("alive", 1), cur("set", 1, *A), cur("fseq", 5), cur("source", "s")]))
def test_nor_does_the_place_of_the_source(parts: list[bytes]) -> None:
    table = Table()
    assert table.feed(bundle(*parts)) == [{1: A}]
    assert [source.name for source in table.tuio.sources] == ["s"]


def test_two_frames_in_one_packet_are_two_frames() -> None:
    both = bundle(
        *[cur("alive", 1), cur("set", 1, *A), cur("fseq", 5)],
        *[cur("alive", 2), cur("set", 2, *B), cur("fseq", 6)],
    )
    assert Table().feed(both) == [{1: A}, {2: B}]
    assert Table().feed(bundle(frame(5, {1: A}), frame(6, {2: B}))) == [{1: A}, {2: B}]


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


def test_set_without_speed_doubles_and_whole_numbers_are_understood() -> None:
    double = cur("set", 1, *A, 0.0).replace(b",sifff\x00\x00", b",sidd\x00\x00\x00")[:-12]
    double += bytes.fromhex("3fc0000000000000 3fd0000000000000")
    for set_ in (cur("set", 1, *A), double):
        assert Table().feed(bundle(cur("alive", 1), set_, cur("fseq", 1))) == [{1: A}]
    corner = bundle(cur("alive", 1), cur("set", 1, 1, 0), cur("fseq", 1))
    assert Table().feed(corner) == [{1: (1.0, 0.0)}]


def test_a_speed_that_is_no_number_costs_no_touch() -> None:
    # A sender that divides by a time step of zero sends such speeds.
    packet = bundle(
        cur("alive", 1), cur("set", 1, *A, math.nan, math.inf, math.nan), cur("fseq", 1)
    )
    assert Table().feed(packet) == [{1: A}]


NEAR = st.integers(-100, 1100).map(lambda n: n / 1024)


@given(NEAR, NEAR)
def test_positions_a_little_beyond_the_edge_are_moved_onto_it(x: float, y: float) -> None:
    (shown,) = Table().feed(frame(1, {1: (x, y)}))
    assert shown == {1: (min(max(x, 0.0), 1.0), min(max(y, 0.0), 1.0))}


@pytest.mark.parametrize("edge", [-0.1, 1.1])
def test_the_end_of_the_margin_is_still_inside_it_as_a_32_bit_float(edge: float) -> None:
    assert Table().feed(frame(1, {1: (edge, 0.5)})) == [{1: (float(edge > 0), 0.5)}]
    table = Table()
    assert table.feed(frame(1, {1: (edge * 1.01, 0.5)})) == []
    assert table.tuio.statistics.malformed == 1


@pytest.mark.parametrize("data", MALFORMED.values(), ids=MALFORMED.keys())
def test_a_malformed_packet_is_counted_with_its_reason_and_changes_nothing(data: bytes) -> None:
    table = Table()
    table.feed(frame(5, {1: A}, source="table"))
    assert table.feed(data) == []
    assert table.tuio.statistics.malformed == 1
    assert table.tuio.statistics.malformed_reason
    assert len(table.tuio.sources) == 1
    assert table.feed(frame(6, {}, alive=[1])) == [{1: A}]


def test_one_wrong_message_refuses_its_whole_packet() -> None:
    table = Table()
    good = [cur("alive", 1), cur("set", 1, *A), cur("fseq", 9)]
    assert table.feed(bundle(*good, cur("set", "x", 0.5, 0.5))) == []
    assert table.feed(bundle(*good)) == [{1: A}]


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


@given(st.lists(FINGERS, min_size=1, max_size=15), st.data())
def test_whatever_fingers_do_is_what_comes_out(
    scenes: list[dict[int, tuple[float, float]]], data: st.DataObject
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
            packets.append(frame(fseq, {i: scene[i] for i in part}, alive=alive, source="s"))
        before = scene
    assert table.feed(*packets)[1::2] == scenes


def test_the_recorded_session_of_a_reference_sender(shared_data: Path) -> None:
    lines = (shared_data / "tuio" / "tuio11_capture.jsonl").read_text().splitlines()
    packets = [bytes.fromhex(json.loads(line)["hex"]) for line in lines]
    table = Table()
    frames = table.feed(*packets)
    assert frames == reference_frames(packets)
    assert len(frames) == 153, "155 packets, of which one is for objects and one for blobs"
    assert max(map(len, frames)) == 5
    counts = table.tuio.statistics
    assert (counts.malformed, counts.late, counts.unfinished, counts.evicted) == (0, 0, 0, 0)
