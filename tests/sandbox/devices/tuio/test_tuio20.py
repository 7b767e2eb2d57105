"""TUIO 2.0: what pointers do comes out of the packets, whatever senders and networks do to them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pythonosc.osc_message_builder import OscMessageBuilder
from pythonosc.osc_packet import OscPacket

from models.surface import Surface
from sandbox.devices.tuio.touch_capture import CaptureDevice, read_capture
from tests.support.tuio_packets import alv, bnd, bundle, frame20, frm, message, ptr
from tests.support.tuio_table import PEER, A, B, C, Table, metres

FIRST, LAST = bundle(frm(7), ptr(1, *A)), bundle(frm(7), ptr(2, *B), alv(1, 2))


@pytest.mark.parametrize(
    ("packets", "shown"),
    [
        ([FIRST, LAST], [{1: A, 2: B}]),
        ([LAST, FIRST], [{2: B}, {1: A, 2: B}]),
        ([bundle(frm(5), ptr(1, *A), alv(1), frm(6), ptr(2, *B), alv(2))], [{1: A}, {2: B}]),
    ],
    ids=["in two bundles", "in two bundles, overtaken", "two frames in one bundle"],
)
def test_a_frame_counts_when_its_last_part_comes(
    packets: list[bytes], shown: list[dict[int, tuple[float, float]]]
) -> None:
    table = Table()
    assert table.feed(*packets) == shown
    assert table.tuio.statistics.unfinished == 0


def test_a_frame_that_is_never_closed_changes_nothing_and_is_counted() -> None:
    table = Table()
    table.feed(frame20(1, {1: A}))
    assert table.feed(bundle(frm(2), ptr(1, *B))) == []
    assert table.feed(frame20(3, {}, alive=[1])) == [{1: A}]
    assert table.tuio.statistics.unfinished == 1


def test_messages_without_a_bundle_count_once_the_living_are_named() -> None:
    table = Table()
    assert table.feed(ptr(1, *A)) == [], "nobody has said whose it is"
    assert table.feed(frm(4), ptr(1, *A), ptr(2, *B)) == []
    assert table.feed(alv(1, 2)) == [{1: A, 2: B}]
    assert table.feed(alv(1)) == [], "no frame is open"
    assert table.tuio.statistics.unfinished == 2


def test_a_counter_that_falls_a_second_later_is_a_sender_that_began_anew() -> None:
    table = Table()
    table.feed(frame20(200, {1: A}))
    table.wait(1.1)
    assert table.feed(frame20(1, {1: B})) == [{1: B}]


@pytest.mark.parametrize(("kind", "finger"), [*zip(range(1, 6), (1, 2, 3, 4, 0), strict=True)])
@pytest.mark.parametrize(("hand", "user"), [(0, 0), (5, 0), (0, 2), (5, 700)])
def test_a_device_that_knows_fingers_names_them(
    kind: int, finger: int, hand: int, user: int
) -> None:
    table = Table()
    (commit,) = table.tuio.feed(
        bundle(frm(1), ptr(537, *A, kind=user << 16 | kind + hand), alv(537)), PEER, 0.0
    )
    (contact,) = metres(commit, Surface(), 0.0).contacts
    assert contact.label == finger


@pytest.mark.parametrize("kind", [0, 11, 13, 0x16, 0xFFFF])
def test_pens_mice_and_hands_are_touches_without_a_finger(kind: int) -> None:
    (commit,) = Table().tuio.feed(bundle(frm(1), ptr(1, *A, kind=kind), alv(1)), PEER, 0.0)
    assert commit.touches[0].label is None


def test_a_device_that_calls_all_of_them_the_same_finger_knows_none() -> None:
    packet = bundle(
        frm(1), ptr(1, *A, kind=1), ptr(2, *B, kind=1), ptr(3, *C, kind=5), alv(1, 2, 3)
    )
    (commit,) = Table().tuio.feed(packet, PEER, 0.0)
    assert [touch.label for touch in commit.touches] == [None, None, 0]


def test_bounds_tell_the_size_and_need_not_be_sent_again() -> None:
    table, surface = Table(), Surface(10.0, 5.0)
    packets = [
        bundle(frm(1), ptr(1, *A), bnd(1, 0.0625, 0.125), ptr(2, *B), alv(1, 2)),
        frame20(2, {1: C}, alive=[1, 2]),
        bundle(frm(3), bnd(1, 0.25, 0.5), alv(1, 2)),
    ]
    (first,), (second,), (third,) = (table.tuio.feed(p, PEER, 0.0) for p in packets)
    assert metres(first, surface, 0.0).contacts[0].size == pytest.approx(0.625 * 0.0254)
    assert metres(second, surface, 0.0).contacts[0].size == pytest.approx(0.625 * 0.0254)
    assert metres(third, surface, 0.0).contacts[0].size == pytest.approx(2.5 * 0.0254)
    assert all(metres(c, surface, 0.0).contacts[1].size is None for c in (first, third))


@pytest.mark.parametrize(
    "odd",
    [
        message("/tuio2/ptr", 1, 0, 0, 0.5),
        message("/tuio2/ptr", "1", 0, 0, 0.5, 0.5),
        ptr(1, 0.5, 7.0),
        ptr(1, float("nan"), 0.5),
        message("/tuio2/bnd"),
        message("/tuio2/bnd", 1, 0.5),
        bnd(1, -1.0, 0.5),
        bnd(1, 9.0, 9.0),
        bundle(*[ptr(i, *A) for i in range(10, 76)]),
    ],
)
def test_what_breaks_the_protocol_costs_itself_alone(odd: bytes) -> None:
    table = Table()
    table.feed(frame20(1, {1: A, 3: A}))
    packet = bundle(frm(2), ptr(2, *B), odd, alv(1, 2))
    assert table.feed(packet) == [{1: A, 2: B}]
    assert table.tuio.statistics.malformed == 1
    assert table.tuio.report.left_out


@pytest.mark.parametrize(
    "opening",
    [
        message("/tuio2/frm", 2, 0, 0, "two"),
        message("/tuio2/frm", 2.0, 0, 0, "two"),
        message("/tuio2/frm", "number", 0, 0, "two"),
        message("/tuio2/frm"),
        message("/tuio2/frm", 2, 0),
        message("/tuio2/frm", 2, 0, 0, "bell\x07"),
    ],
)
@pytest.mark.parametrize("kind", [0, 1.0, "thumb", None])
def test_neither_number_nor_name_nor_type_cost_a_touch(opening: bytes, kind: object) -> None:
    pointer = message("/tuio2/ptr", 7, kind, 0, *B)
    assert Table().feed(bundle(opening, pointer, message("/tuio2/alv", 7.0, "x"))) == [{7: B}]


def test_too_many_ids_cost_those_beyond() -> None:
    table = Table()
    packets = [bundle(frm(n), ptr(1, *A), alv(*range(256))) for n in range(1, 20)]
    assert table.feed(packets[0], bundle(*packets)) == [{1: A}] * 17


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.sampled_from(["f", "d"]))
@example(5e-324, 0.1, "d")
def test_whatever_size_bounds_tell_a_frame_is_made_of_it(
    width: float, height: float, tag: str
) -> None:
    builder = OscMessageBuilder("/tuio2/bnd")
    for value, kind in zip((1, 0.5, 0.5, 0.0, width, height), f"ifff{tag}{tag}", strict=True):
        builder.add_arg(value, kind)
    packet = bundle(frm(1), ptr(1, *A), builder.build().dgram, alv(1))
    (commit,) = Table().tuio.feed(packet, PEER, 0.0)
    (contact,) = metres(commit, Surface(), 0.0).contacts
    assert contact.extent is None or min(contact.extent) > 0.0


def independent(file: Path) -> list[dict[int, tuple[float, float]]]:
    """The touches after every frame of the recorded simulators, by python-osc's own reader."""
    frames: list[dict[int, tuple[float, float]]] = []
    known: dict[int, tuple[float, float]] = {}
    alive: tuple[int, ...] = ()
    for line in file.open():
        packet = OscPacket(bytes.fromhex(json.loads(line)["hex"]))
        for timed in packet.messages:
            address, params = timed.message.address, timed.message.params
            if address == "/tuio2/ptr":
                known[params[0]] = (params[3], params[4])
            elif address == "/tuio/2Dcur" and params[0] == "set":
                known[params[1]] = (params[2], params[3])
            elif address == "/tuio/2Dcur" and params[0] == "alive":
                alive = tuple(params[1:])
            elif address == "/tuio2/alv":
                alive = tuple(params)
            closing = address == "/tuio/2Dcur" and params[0] == "fseq"
            if address == "/tuio2/alv" or closing:
                known = {i: known[i] for i in alive if i in known}
                frames.append(dict(known))
    return frames


@pytest.mark.parametrize(("name", "least"), [("tuio11_capture", 150), ("tuio20_capture", 60)])
def test_the_recorded_session_replays_as_an_independent_decoder_reads_it(
    shared_data: Path, name: str, least: int
) -> None:
    file = shared_data / "tuio" / f"{name}.jsonl"
    surface = Surface(10.0, 5.0)
    device = CaptureDevice(read_capture(file), surface, stale_after=1e6)
    width, height = (float(s) for s in surface.size)
    played = [{c.id: (c.x / width, c.y / height) for c in f.contacts} for f in device.poll(1e6)]
    expected = independent(file)
    assert len(expected) >= least
    assert [set(f) for f in played] == [set(f) for f in expected]
    for got, wanted in zip(played, expected, strict=True):
        for touch, place in wanted.items():
            assert got[touch] == pytest.approx(place, abs=1e-12)
    counts = device.statistics
    assert (counts.malformed, counts.late, counts.unfinished) == (0, 0, 0)
    assert any(expected)
    assert not expected[-1]
