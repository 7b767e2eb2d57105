"""Mutated packets of TUIO 2.0: nothing is raised, nothing grows, and a good packet still works."""

from __future__ import annotations

import math
import random

from sandbox.devices.tuio.tuio_frames import MAX_ALIVE, MAX_IDS
from sandbox.devices.tuio.tuio_senders import MAX_SOURCES, Tuio
from tests.sandbox.devices.tuio.test_tuio_fuzz import COUNTS, check, mutants
from tests.support.tuio_packets import alv, bnd, bundle, frame20, frm, message, ptr

CORPUS = [
    frame20(0, {}),
    frame20(1, {1: (0.5, 0.5)}, source="table"),
    frame20(2, {i: (i / 8, 0.25) for i in range(5)}, source="app:1@192.0.2.1"),
    frame20(3, {2: (0.1, 0.9)}, alive=range(5), source="app:1@192.0.2.1"),
    frame20(4, dict.fromkeys(range(64), (0.5, 0.5))),
    bundle(frm(5), ptr(1, 0.2, 0.3, kind=5), bnd(1, 0.1, 0.1)),
    bundle(frm(5), ptr(2, 0.2, 0.3, kind=1), alv(1, 2)),
    bundle(frm(6), message("/tuio2/tok", 9, 0, 1, 0.5, 0.5, 0.0), alv(1, 2, 9)),
    frm(7),
    ptr(3, 0.5, 0.5),
    alv(1, 2, 3),
]


def invent(rng: random.Random) -> bytes:
    """OSC that is whole, says things of TUIO 2.0, and need not make sense."""

    def some(usual: object, *odd: object) -> object:
        return rng.choice(odd) if odd and rng.random() < 0.01 else usual

    def part() -> bytes:
        touch = some(
            rng.choice((1, 2, 3, rng.randrange(300), -1, 2**31 - 1)), 2**40, "1", 1.0, None
        )
        place = [some(rng.choice((0.0, 0.5, 1.0, rng.random())), 5.0, math.nan, "x", None)] * 2
        match rng.randrange(8):
            case 0 | 1:
                return frm(rng.choice((rng.randrange(400), 0)), rng.choice("abcdef"))
            case 2 | 3 | 4:
                kind = some(rng.randrange(24) + (rng.randrange(4) << 16), "5", 2.0)
                return message("/tuio2/ptr", touch, kind, 0, *place, *[0.0] * rng.randrange(6))
            case 5:
                size = [some(rng.choice((0.1, 1.0, 0.0)), math.nan, math.inf, "w")] * 2
                return message("/tuio2/bnd", touch, *place, 0.0, *size)
            case 6:
                ids = [rng.randrange(9) for _ in range(rng.choice((0, 1, 2, 5, 60, 260)))]
                return message("/tuio2/alv", *ids, some(7, "7", 7.0))
            case _:
                return message(rng.choice(("/tuio2/tok", "/tuio2/sym", "/tuio2/ala")), touch)

    if rng.random() < 0.2:
        return part()
    return bundle(*(part() for _ in range(rng.randrange(9))))


def fuzz(seed: int, count: int, corpus: list[bytes]) -> Tuio:
    tuio = Tuio(stale_after=0.5)
    for n, data in enumerate(mutants(seed, count, corpus, invent)):
        now = n * 0.01
        for commit in tuio.feed(data, f"192.0.2.{n % 7}:1", now) + tuio.expire(now):
            check(commit)
        assert len(tuio.sources) <= MAX_SOURCES
        if n % 50 == 49:
            place = (n % 64 / 64, 0.25)
            good = frame20(n, {n: place}, source="good")
            last = tuio.feed(good, "192.0.2.200:1", now)[-1]
            assert last.source == "good"
            assert place in [(t.x, t.y) for t in last.touches]
            for source in tuio._sources:
                kept = [*source.open.values()]
                assert len(source.places) <= MAX_ALIVE
                assert all(len(f.places) <= MAX_IDS and len(f.sizes) <= MAX_ALIVE for f in kept)
    return tuio


@COUNTS
def test_mutated_packets_do_no_harm(count: int) -> None:
    seen = fuzz(20180619, count, CORPUS).statistics
    # The mutants must reach both sides of every decision, or this test says nothing.
    assert count / 10 < seen.malformed < count * 9 / 10
    assert seen.frames > count / 10
    assert min(seen.late, seen.unfinished, seen.ignored, seen.evicted) > 0
