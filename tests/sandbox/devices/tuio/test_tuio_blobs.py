"""Blobs of TUIO 1.1 tell how large the touches are that lie in them."""

from __future__ import annotations

import math

import pytest

from models.surface import METRES_PER_INCH, Surface
from tests.support.tuio_packets import blb, blobs, bundle, cur, frame
from tests.support.tuio_table import PEER, Table, metres

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
    a, b = (0.25, 0.5, 0.04, 0.08), (0.75, 0.5, 0.08, 0.16)
    ids = (1, 2) if same_ids else (2, 1)  # some senders number blobs for themselves
    found = sizes(
        Table(),
        blobs(1, dict(zip(ids, (a, b), strict=True))),
        frame(1, {1: (0.26, 0.5), 2: (0.74, 0.51)}),
    )
    assert found == [[0.4, 0.8]]


def test_a_size_is_that_of_the_circle_of_the_same_area() -> None:
    found = sizes(Table(), blobs(1, {1: (0.5, 0.5, 0.1, 0.05)}), frame(1, {1: (0.5, 0.5)}))
    assert found == [[round(math.sqrt(1.0 * 0.25), 6)]]


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
        blb("set", 1, 0.5),
        blb("set", "one", 0.5, 0.5, 0.0, 0.1, 0.1, 0.01),
        blb("set", 1, 7.0, 0.5, 0.0, 0.1, 0.1, 0.01),
        blb("set", 1, 0.5, 0.5, 0.0, math.nan, -1.0, 0.01),
        blb("set", 1, 0.5, 0.5),
        blb("grow", 1),
        blb(),
        blb("alive", *range(200)),
    ],
)
def test_a_blob_that_makes_no_sense_costs_no_touch(odd: bytes) -> None:
    table = Table()
    packet = bundle(odd, blb("fseq", 1), cur("alive", 1), cur("set", 1, 0.5, 0.5), cur("fseq", 1))
    assert sizes(table, packet) == [[None]]
