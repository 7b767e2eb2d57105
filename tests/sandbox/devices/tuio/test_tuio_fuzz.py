"""Mutated packets: nothing hangs, nothing is raised, and a good packet afterwards still works.

The seeds are fixed, so that a packet that breaks something breaks it again. The long runs
(`-m full`) also mutate the recorded sessions, where they are at hand.
"""

from __future__ import annotations

import json
import math
import random
import struct
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import pytest

from models.surface import Surface
from sandbox.devices.tuio.osc import MAX_PACKET_BYTES
from sandbox.devices.tuio.tuio_frames import MAX_ALIVE, MAX_IDS
from sandbox.devices.tuio.tuio_senders import MAX_SOURCES, MAX_TOUCHES, Commit, Statistics, Tuio
from tests.support.tuio_packets import (
    MALFORMED,
    alv,
    bnd,
    bundle,
    cur,
    frame,
    frame20,
    frm,
    message,
    ptr,
)
from tests.support.tuio_table import metres

QUICK, FULL = 3_000, 100_000
COUNTS = pytest.mark.parametrize("count", [QUICK, pytest.param(FULL, marks=pytest.mark.full)])
"""Packets of the run that is always made, and of the long one."""

MEANT = [
    frame(-1, {}),
    frame(1, {1: (0.5, 0.5)}, source="table"),
    frame(2, {i: (i / 8, 0.25) for i in range(5)}, source="app@192.0.2.1"),
    frame(3, {2: (0.1, 0.9)}, alive=range(5), source="app@192.0.2.1"),
    frame(4, dict.fromkeys(range(64), (0.5, 0.5))),
    bundle(frame(5, {1: (0.2, 0.3)}), frame(6, {}), cur("alive", 3)),
    bundle(message("/tuio/2Dblb", "alive", 4), message("/tuio/2Dblb", "fseq", 1)),
    bundle(message("/tuio2/frm", 7, 1, 0, "two"), message("/tuio2/alv", 1)),
    cur("alive", 1, 2),
    cur("set", 1, 0.5, 0.5),
    cur("fseq", 9),
]
CORPUS = MEANT * 4 + list(MALFORMED.values())
WORDS = (
    *[struct.pack(">i", value) for value in (0, 1, -1, -4, -8, 4, 8, 64, 2**31 - 1, -(2**31))],
    *[struct.pack(">f", value) for value in (math.nan, math.inf, -math.inf, 1.1, -0.1, 5.0)],
    *(b"#bundle\x00", b"/tuio/2Dcur\x00", b",si\x00", b"alive\x00\x00\x00", b"set\x00"),
    *(b"fseq\x00\x00\x00\x00", b"source\x00\x00", b"\xff\xff\xff\xff", b"[[]]", b"////"),
)
"""Words (32 bits and multiples) that mean something somewhere in a packet."""


def flip(rng: random.Random, data: bytearray) -> None:
    for _ in range(rng.randint(1, 4)):
        if data:
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)


def set_word(rng: random.Random, data: bytearray) -> None:
    at = rng.randrange(len(data) // 4 + 1) * 4
    word = rng.choice(WORDS)
    data[at : at + len(word)] = word


def insert_word(rng: random.Random, data: bytearray) -> None:
    at = rng.randrange(len(data) // 4 + 1) * 4
    data[at:at] = rng.choice(WORDS)


def cut(rng: random.Random, data: bytearray) -> None:
    del data[rng.randrange(len(data) + 1) :]


def splice(rng: random.Random, data: bytearray) -> None:
    other = rng.choice(CORPUS)
    data[rng.randrange(len(data) // 4 + 1) * 4 :] = other[rng.randrange(len(other) // 4 + 1) * 4 :]


def repeat(rng: random.Random, data: bytearray) -> None:
    data += bytes(data[rng.randrange(len(data) // 4 + 1) * 4 :]) * rng.randint(1, 9)


def wrap(rng: random.Random, data: bytearray) -> None:
    for _ in range(rng.randint(1, 12)):
        data[:] = bundle(bytes(data))


MUTATIONS = (flip, set_word, insert_word, cut, splice, repeat, wrap)


def odd(rng: random.Random, usual: object, *others: object) -> object:
    """The usual value, or one time in a hundred another one."""
    return rng.choice(others) if rng.random() < 0.01 else usual


def any_id(rng: random.Random) -> object:
    usual = rng.choice((1, 2, 3, rng.randrange(300), -1, 2**31 - 1))
    return odd(rng, usual, 2**40, "1", 1.0, True, None)


def any_place(rng: random.Random) -> object:
    usual = rng.choice((0.0, 0.5, 1.0, rng.random(), -0.1, 1.1))
    return odd(rng, usual, 5.0, -3.0, math.nan, math.inf, "x", None)


def message11(rng: random.Random) -> bytes:
    """A message of TUIO 1.1 that need not make sense."""
    values: list[object]
    match rng.randrange(8):
        case 0:
            values = ["source", rng.choice(("a", "b", "", str(rng.randrange(200))))]
        case 1 | 2:
            values = ["alive", *(any_id(rng) for _ in range(rng.randrange(7)))]
        case 3 | 4 | 5:
            values = ["set", any_id(rng), any_place(rng), any_place(rng), 0.0, 0.0, 0.0]
            del values[rng.choice((99,) * 20 + (4, 3)) :]
        case _:
            values = ["fseq", rng.choice((rng.randrange(400), rng.randrange(400), -1, 0))]
    return message(rng.choice(("/tuio/2Dcur",) * 9 + ("/tuio/2Dblb",)), *values)


def message20(rng: random.Random) -> bytes:
    """A message of TUIO 2.0 that need not make sense."""
    place = any_place(rng), any_place(rng)
    match rng.randrange(8):
        case 0 | 1:
            return frm(rng.choice((rng.randrange(400), 0)), rng.choice("abcdef"))
        case 2 | 3 | 4:
            kind = odd(rng, rng.randrange(24) + (rng.randrange(4) << 16), "5", 2.0)
            more = [0.0] * rng.randrange(6)
            return message("/tuio2/ptr", any_id(rng), kind, 0, *place, *more)
        case 5:
            return message("/tuio2/bnd", any_id(rng), *place, 0.0, *place)
        case 6:
            ids = [rng.randrange(9) for _ in range(rng.choice((0, 1, 2, 5, 60, 260)))]
            return message("/tuio2/alv", *ids, odd(rng, 7, "7", 7.0))
        case _:
            return message(rng.choice(("/tuio2/tok", "/tuio2/sym", "/tuio2/ala")), any_id(rng))


CORPUS20 = [
    frame20(0, {}),
    frame20(1, {1: (0.5, 0.5)}, source="table"),
    frame20(3, {2: (0.1, 0.9)}, alive=range(5), source="app:1@192.0.2.1"),
    frame20(4, dict.fromkeys(range(64), (0.5, 0.5))),
    bundle(frm(5), ptr(1, 0.2, 0.3, kind=5), bnd(1, 0.1, 0.1)),
    bundle(frm(5), ptr(2, 0.2, 0.3, kind=1), alv(1, 2)),
    bundle(frm(6), message("/tuio2/tok", 9, 0, 1, 0.5, 0.5, 0.0), alv(1, 2, 9)),
]


def mutants(
    seed: int, count: int, corpus: list[bytes], made_up: Callable[[random.Random], bytes]
) -> Iterator[bytes]:
    """Mutated packets of a corpus, and as many of messages that are made up."""
    rng = random.Random(seed)
    for _ in range(count):
        invented = bundle(*(made_up(rng) for _ in range(rng.randrange(9))))
        data = bytearray(
            rng.choice((invented, made_up(rng), rng.choice(corpus), rng.choice(corpus)))
        )
        for _ in range(rng.choice((0, 0, 1, 1, 2, 3, 6))):
            rng.choice(MUTATIONS)(rng, data)
        yield bytes(data[:MAX_PACKET_BYTES])


def check(commit: Commit) -> None:
    """What a frame promises whatever was received."""
    assert len(commit.touches) <= MAX_TOUCHES
    assert all(0.0 <= t.x <= 1.0 and 0.0 <= t.y <= 1.0 for t in commit.touches)
    assert commit.source.isprintable()
    metres(commit, Surface(), 0.0)  # refuses ids that are not unique


def fuzzed(packets: Iterable[bytes], framed: Callable[..., bytes] = frame) -> Statistics:
    """Feeds packets of several senders, and a good packet of another one after every 50."""
    tuio = Tuio(stale_after=0.5)
    for n, data in enumerate(packets):
        now = n * 0.01
        for commit in tuio.feed(data, f"192.0.2.{n % 7}:1", now) + tuio.expire(now):
            check(commit)
        assert tuio.statistics.packets == n + 1 + n // 50
        assert len(tuio.sources) <= MAX_SOURCES
        if n % 50 == 49:
            place = (n % 64 / 64, 0.25)
            last = tuio.feed(framed(n, {n: place}, source="good"), "192.0.2.200:1", now)[-1]
            assert last.source == "good"
            assert place in [(t.x, t.y) for t in last.touches]
            for source in tuio._sources:
                assert len(source.places) <= MAX_ALIVE
                for part in source.open.values():
                    assert len(part.places) <= MAX_IDS and len(part.sizes) <= MAX_ALIVE
    return tuio.statistics


@COUNTS
@pytest.mark.parametrize(
    ("seed", "corpus", "made_up", "framed"),
    [(20150713, CORPUS, message11, frame), (20180619, CORPUS20, message20, frame20)],
    ids=["1.1", "2.0"],
)
def test_mutated_packets_do_no_harm(
    count: int,
    seed: int,
    corpus: list[bytes],
    made_up: Callable[[random.Random], bytes],
    framed: Callable[..., bytes],
) -> None:
    counted = fuzzed(mutants(seed, count, corpus, made_up), framed)
    # The mutants must reach both sides of every decision, or this test says nothing.
    assert count / 10 < counted.malformed < count * 9 / 10
    assert counted.frames > count / 10
    assert min(counted.late, counted.unfinished, counted.ignored, counted.evicted) > 0


@pytest.mark.full
def test_mutated_recordings_of_reference_senders_do_no_harm(shared_data: Path) -> None:
    recorded = [
        bytes.fromhex(json.loads(line)["hex"])
        for file in sorted((shared_data / "tuio").glob("*.jsonl"))
        for line in file.open()
    ]
    assert recorded
    counted = fuzzed(mutants(2, FULL, recorded, message11))
    assert min(counted.malformed, counted.frames) > FULL / 10
