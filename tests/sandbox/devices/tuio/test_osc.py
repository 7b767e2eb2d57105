"""OSC from the network: what is good is read as sent, everything else is one kind of refusal."""

from __future__ import annotations

import contextlib
import random
import sys
from collections.abc import Callable
from types import FrameType
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message_builder import OscMessageBuilder

from models.errors import DeviceError, InputError
from models.reader_report import ReaderReport
from sandbox.devices.tuio.osc import MAX_DEPTH, MAX_PACKET_BYTES, MalformedPacket, Packet
from sandbox.devices.tuio.osc import decode as decode_reporting
from tests.support.tuio_packets import NO_OSC, bundle, cur, frame, message, nested

TEXT = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\x00"), max_size=12)
ARGUMENT = (
    st.integers(-(2**31), 2**31 - 1)
    | st.integers(-(2**63), 2**63 - 1)
    | st.floats(width=32, allow_nan=False)
    | TEXT
    | st.booleans()
    | st.none()
    | st.binary(min_size=1, max_size=12)
)
MESSAGE = st.tuples(TEXT.map("/".__add__), st.lists(ARGUMENT, max_size=8).map(tuple))
TREE = st.recursive(MESSAGE, lambda inner: st.lists(inner, max_size=4), max_leaves=12)


def build(tree: Any) -> Any:
    """python-osc's own builders: a tuple is a message, a list is a bundle."""
    if isinstance(tree, list):
        outer = OscBundleBuilder(IMMEDIATELY)
        for inner in tree:
            outer.add_content(build(inner))
        return outer.build()
    builder = OscMessageBuilder(tree[0])
    for argument in tree[1]:
        builder.add_arg(argument)
    return builder.build()


def leaves(tree: Any) -> list[Any]:
    return [leaf for inner in tree for leaf in leaves(inner)] if isinstance(tree, list) else [tree]


def depth(tree: Any) -> int:
    return 1 + max(map(depth, tree), default=0) if isinstance(tree, list) else 0


def decode(data: bytes) -> Packet:
    """Decodes a packet; one of which messages are left out is refused like a malformed one."""
    report = ReaderReport()
    packet = decode_reporting(data, report)
    if report.left_out:
        raise MalformedPacket(report.line())
    return packet


class Enough(BaseException):
    """Not an Exception: the code under test turns those into refusals."""


def lines_run(call: Callable[[], object], most: int) -> int:
    """How many lines of Python a call runs; ends it where it has run so many, so hangs end too."""
    count = 0

    def tracer(_frame: FrameType, _event: str, _argument: object) -> Any:
        nonlocal count
        count += 1
        if count >= most:
            raise Enough
        return tracer

    before = sys.gettrace()
    sys.settrace(tracer)
    try:
        with contextlib.suppress(Enough):
            call()
    finally:
        sys.settrace(before)
    return count


@given(TREE.filter(lambda tree: depth(tree) <= MAX_DEPTH))
def test_what_was_built_is_read_back_in_order_however_it_is_nested(tree: Any) -> None:
    packet = decode(build(tree).dgram)
    assert [(m.address, m.arguments) for m in packet.messages] == leaves(tree)
    assert packet.bundled == isinstance(tree, list)


@pytest.mark.parametrize("data", NO_OSC.values(), ids=NO_OSC.keys())
def test_a_malformed_packet_is_refused_in_one_way(data: bytes) -> None:
    with pytest.raises(MalformedPacket) as refusal:
        decode(data)
    assert isinstance(refusal.value, DeviceError | InputError)
    assert len(str(refusal.value)) < 300, "the reason is short whatever the packet holds"
    assert str(refusal.value).isprintable()


def test_bundles_may_be_nested_to_a_limit() -> None:
    assert decode(nested(MAX_DEPTH, cur("fseq", 1))).messages[0].arguments == ("fseq", 1)
    with pytest.raises(MalformedPacket, match="too deep"):
        decode(nested(MAX_DEPTH + 1, cur("fseq", 1)))


def hostile(rng: random.Random) -> dict[str, bytes]:
    """Packets made to cost much: as large as UDP allows, or as twisted."""
    widest = MAX_PACKET_BYTES // 4 * 4
    return {
        "smallest elements": bundle(*[b"/a\x00\x00"] * 8000),
        "1024 elements": bundle(*[message("/" + "a" * 50)] * 1000),
        "deepest": nested(3000, cur("fseq", 1)),
        "as deep as allowed, wide": nested(MAX_DEPTH - 1, bundle(*[cur("fseq", 1)] * 1000)),
        "one long address": b"/" * (widest - 4) + b"\x00" * 4,
        "unterminated": b"/" * widest,
        "long type tags": b"/a\x00\x00," + b"i" * (widest - 8) + b"\x00" * 3,
        "brackets": b"/a\x00\x00," + b"[" * 120 + b"]" * 120 + b"\x00" * 3,
        "256 arguments, much behind": b"/a\x00\x00," + b"i" * 255 + b"\x00" * 64_000,
        "zero sizes": b"#bundle\x00" + b"\x00" * (widest - 8),
        "noise in a bundle": b"#bundle\x00" + rng.randbytes(widest - 8),
        **NO_OSC,
    }


@pytest.mark.parametrize("kind", hostile(random.Random(1)))
def test_the_work_on_a_packet_is_bounded_by_its_size(kind: str) -> None:
    data = hostile(random.Random(1))[kind]
    budget = 2_000 + 30 * len(data)

    def attempt() -> None:
        with contextlib.suppress(MalformedPacket):
            decode(data)

    # What would not end is ended where the bound is passed.
    assert lines_run(attempt, most=budget + 1) <= budget


@given(st.binary(max_size=200))
@example(b"#bundle\x00")
def test_any_bytes_are_messages_or_malformed(noise: bytes) -> None:
    for data in (noise, noise[: len(noise) // 4 * 4], b"#bundle\x00" + noise, bundle(noise)):
        try:
            packet = decode(data)
        except MalformedPacket:
            continue
        assert all(m.address.startswith("/") for m in packet.messages)


@given(st.integers(0, 10_000))
def test_a_bundle_cut_short_gives_a_part_of_its_messages_or_nothing(cut: int) -> None:
    whole = frame(9, {1: (0.1, 0.2), 2: (0.3, 0.4)}, source="table")
    try:
        part = decode(whole[: cut % len(whole)]).messages
    except MalformedPacket:
        return
    assert part == decode(whole).messages[: len(part)]


def test_a_message_cut_short_is_never_filled_up_with_zeros() -> None:
    whole = cur("set", 1, 0.5, 0.25)
    address_alone = 12
    for cut in range(len(whole)):
        if cut != address_alone:
            with pytest.raises(MalformedPacket):
                decode(whole[:cut])
    assert decode(whole).messages[0].arguments == ("set", 1, 0.5, 0.25)


def test_a_packet_larger_than_udp_can_carry_is_refused() -> None:
    largest = b"/" + b"a" * (MAX_PACKET_BYTES // 4 * 4 - 5) + b"\x00" * 4
    assert decode(largest).messages[0].address == largest.rstrip(b"\x00").decode()
    with pytest.raises(MalformedPacket, match="too large"):
        decode(b"/" + b"a" * 65_531 + b"\x00" * 4)


NAMES = {
    "UTF-8": ("Tür 机".encode(), "Tür 机"),
    "Latin-1": ("Tür".encode("latin-1"), "Tür"),
    "Shift-JIS": ("机の上".encode("cp932"), "机の上"),
    "no text": (b"\xff\xfe\xe9", "ÿþé"),
}


@pytest.mark.parametrize(("data", "text"), NAMES.values(), ids=NAMES.keys())
def test_text_in_any_bytes_is_read_as_well_as_it_can_be(data: bytes, text: str) -> None:
    padded = data + b"\x00" * (4 - len(data) % 4)
    assert decode(b"/a\x00\x00,sS\x00" + padded * 2).messages[0].arguments == (text, text)


def test_a_message_that_cannot_be_read_costs_itself_alone() -> None:
    odd = [data for data in NO_OSC.values() if data.startswith(b"/") and len(data) % 4 == 0]
    assert len(odd) > 5
    report = ReaderReport()
    for data in odd:
        packet = decode_reporting(bundle(cur("fseq", 1), data, cur("fseq", 2)), report)
        assert [m.arguments for m in packet.messages] == [("fseq", 1), ("fseq", 2)]
    assert report.left_out.total() == len(odd)
