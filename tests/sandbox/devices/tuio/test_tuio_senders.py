"""Packets as programs in use send them: what stands beside the touches costs none.

Each is of a public report or of the source of a sender, as the names of the cases say.
"""

from __future__ import annotations

import struct
from typing import Any

import pytest
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message_builder import OscMessageBuilder

from models.surface import Surface
from tests.support.tuio_packets import alv, blb, bnd, bundle, cur, frame, frm, message, ptr
from tests.support.tuio_table import A, B, Table, metres

ALIVE, SET = cur("alive", 1), cur("set", 1, *A)


def typed(address: str, *arguments: tuple[Any, str]) -> bytes:
    builder = OscMessageBuilder(address)
    for value, tag in arguments:
        builder.add_arg(value, tag)
    return builder.build().dgram


def symbols(packet: bytes) -> bytes:
    """The same with texts as OSC symbols, as Pure Data and liblo may send them."""
    return packet.replace(b",s", b",S")


def in_future(packet: bytes) -> bytes:
    return packet[:8] + struct.pack(">Q", 0xFFFFFFFF << 32) + packet[16:]


def empty_bundle() -> bytes:
    return OscBundleBuilder(IMMEDIATELY).build().dgram


SENT: dict[str, bytes] = {
    "Community Core Vision appends width and height to cursors": bundle(
        ALIVE, cur("set", 1, *A, 0.0, 0.0, 0.0, 0.03, 0.04), cur("fseq", 1)
    ),
    "TouchOSC sends its own addresses in the same bundle": bundle(
        message("/multitouch/1", 0.5, 0.5), ALIVE, SET, message("/ping"), cur("fseq", 1)
    ),
    "Processing sends whole numbers as int32": bundle(
        ALIVE, cur("set", 1, *A, 0, 0, 0), cur("fseq", 1)
    ),
    "Max sends ids and counters as floats": bundle(
        cur("alive", 1.0), cur("set", 1.0, *A), cur("fseq", 1.0)
    ),
    "JavaScript sends doubles": bundle(
        ALIVE,
        typed("/tuio/2Dcur", ("set", "s"), (1, "i"), *((v, "d") for v in (*A, 0.0, 0.0, 0.0))),
        cur("fseq", 1),
    ),
    "Pure Data sends symbols": bundle(*map(symbols, (ALIVE, SET, cur("fseq", 1)))),
    "a bundle is for the year 2036": in_future(frame(1, {1: A})),
    "a bundle holds an empty one": bundle(empty_bundle(), ALIVE, SET, cur("fseq", 1)),
    "a bundle is sent twice in one packet": bundle(frame(1, {1: A}), frame(1, {1: A})),
    "reacTIVision sends all profiles in one bundle": bundle(
        *(message("/tuio/2Dobj", "alive"), message("/tuio/2Dobj", "fseq", 1)),
        *(ALIVE, SET, cur("fseq", 1), blb("alive"), blb("fseq", 1)),
    ),
    "a custom profile has blobs of bytes": bundle(
        message("/tuio/_bP", b"\x00\xff\xfe"), ALIVE, SET, cur("fseq", 1)
    ),
    "a time step of zero makes speeds that are no numbers": bundle(
        ALIVE, cur("set", 1, *A, float("nan"), float("-inf"), float("nan")), cur("fseq", 1)
    ),
    "a type nobody knows stands in a message of another program": bundle(
        message("/app", 1).replace(b",i", b",Q"), ALIVE, SET, cur("fseq", 1)
    ),
    "one of the living is listed twice": bundle(cur("alive", 1, 1), SET, cur("fseq", 1)),
    "a touch is set twice, and the last place counts": bundle(
        ALIVE, cur("set", 1, *B), SET, cur("fseq", 1)
    ),
    "TUIO 2.0 has tokens with the same ids, and values behind": bundle(
        frm(1), message("/tuio2/tok", 1, 0, 1, 0.5, 0.5, 0.0), ptr(1, *A), alv(1)
    ),
}


@pytest.mark.parametrize("packet", SENT.values(), ids=SENT)
def test_what_senders_in_use_send_is_one_touch(packet: bytes) -> None:
    assert Table().feed(packet)[-1:] == [{1: A}]


BLOBS = {
    "a negative width": (-0.04, 0.05, None),
    "pixels": (8.0, 10.0, None),
    "a fingertip": (0.04, 0.05, 7.63),
    "a flat finger": (0.05, 0.4, 24.14),
    "no number": (float("nan"), 0.05, None),
}


@pytest.mark.parametrize(("width", "height", "size"), BLOBS.values(), ids=BLOBS)
@pytest.mark.parametrize("version", ["1.1", "2.0"])
def test_a_size_that_no_finger_has_is_an_unknown_one(
    version: str, width: float, height: float, size: float | None
) -> None:
    blob = [blb("alive", 1), blb("set", 1, *A, 0.0, width, height, 0.0), blb("fseq", 1)]
    packet = (
        bundle(*blob, ALIVE, SET, cur("fseq", 1))
        if version == "1.1"
        else bundle(frm(1), ptr(1, *A), bnd(1, width, height), alv(1))
    )
    (commit,) = Table().tuio.feed(packet, "192.0.2.1:1", 0.0)
    (contact,) = metres(commit, Surface()).contacts
    assert (contact.size and round(1000 * contact.size, 2)) == size
    assert (contact.extent is None) == (size is None)


def test_ids_of_64_bits_are_left_out_and_told() -> None:
    table = Table()
    packet = bundle(cur("alive", 2**40, 1), cur("set", 2**40, *B), SET, cur("fseq", 1))
    assert table.feed(packet) == [{1: A}]
    assert table.tuio.report.left_out == {"ids and counters that are not int32": 2}
