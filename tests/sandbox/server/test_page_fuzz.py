"""Mutated messages of the page: refused or understood, nothing else, and frames stay sound."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from typing import Any

import msgspec
import pytest

from models.errors import InputError
from models.surface import Surface
from sandbox.devices.check_device import check_frames
from sandbox.server.protocol import PageScreen, PageTouches, decode
from sandbox.server.web import WebDevice

COUNTS = [5_000, pytest.param(100_000, marks=pytest.mark.full)]

SCREEN = {"px_per_in": 132.0, "width_px": 1024.0, "height_px": 768.0, "calibrated": True}
MESSAGES: list[dict[str, object]] = [
    {"type": "hello", "protocol": 1, "client": "a", "role": "player", "screen": SCREEN},
    {"type": "resized", "screen": SCREEN},
    {"type": "touches", "seq": 1, "t": 16.0, "contacts": [[1, 500.0, 300.0, 20.0, 24.0]]},
    {
        "type": "touches",
        "seq": 2,
        "t": 32.0,
        "lift": 0.5,
        "cancelled": [1, 7],
        "contacts": [[i, 40.0 * i, 700.0 - 30.0 * i, 1.0, 1.0] for i in range(10)],
    },
    {"type": "touches", "seq": 3, "t": 48.0, "contacts": [], "cancelled": []},
    {"type": "got", "frame": 4},
    {"type": "drawn", "frame": 4, "after_ms": 21.0},
    {"type": "beat", "t": 1000.0, "round_trip_ms": 2.0},
    {"type": "ask", "what": "retry", "value": ""},
]
ODD = [
    *(None, True, "", "x" * 70, "\x00", "\ud800", [], {}, [[]], -1, 0, 1, 2**31, 2**53, 2**64),
    *(1e308, 1e999, -1e999, float("nan"), 0.5, -0.0, "touches", [[1, 2, 3]], [[1, 2, 3, 4]] * 21),
    *([[1, 1.0, 1.0, 1.0]] * 2, [["1", 1.0, 1.0, 1.0]], [[1.5, 1.0, 1.0, 1.0]], SCREEN),
]
SPICE = [
    b"{",
    b"}",
    b"[",
    b"]",
    b",",
    b'"',
    b"\\",
    b"\\u",
    b"1e400",
    b"\xff",
    b"\x00",
    b"NaN",
    b" ",
]


def bent(rng: random.Random) -> bytes:
    """A message with values, keys or bytes that were never meant."""
    message: dict[str, object] = dict(rng.choice(MESSAGES))
    for _ in range(rng.choice((0, 0, 1, 1, 2))):
        key = rng.choice([*message, "screen", "contacts", "extra", "type"])
        match rng.randrange(3):
            case 0:
                message[key] = rng.choice(ODD)
            case 1:
                message.pop(key, None)
            case _:
                inner = message.get(key)
                if isinstance(inner, dict):
                    message[key] = inner | {rng.choice([*inner, "more"]): rng.choice(ODD)}
                elif isinstance(inner, list) and inner:
                    message[key] = [*inner, rng.choice(ODD)]
    data = bytearray(json.dumps(message).encode())
    for _ in range(rng.choice((0, 0, 0, 1, 1, 2, 5))):
        at = rng.randrange(len(data) + 1)
        match rng.randrange(5):
            case 0:
                data[at:at] = rng.choice(SPICE)
            case 1:
                del data[at : at + rng.randint(1, 9)]
            case 2 if at < len(data):
                data[at] ^= 1 << rng.randrange(8)
            case 3:
                data[at:at] = data[: rng.randrange(40)]
            case _:
                data[at:at] = b"[" * rng.choice((1, 50, 5000))
    return bytes(data)


def decoded(rng: random.Random, count: int) -> Iterator[object]:
    """What comes of mutants; None where they were refused."""
    for _ in range(count):
        data = bent(rng)
        try:
            yield decode(data if rng.random() < 0.5 else data.decode("utf-8", "surrogateescape"))
        except InputError as error:
            assert len(str(error)) < 600, "it is shown and logged"
            yield None


def fuzz(seed: int, count: int) -> tuple[int, int]:
    """How many were understood, and how many were refused.

    After every 50 of them comes a message that is meant, whose touch must be there.
    """
    rng = random.Random(seed)
    surface = Surface()
    device = WebDevice(surface)
    screen = msgspec.convert(SCREEN, PageScreen)
    understood = refused = 0
    frames: list[Any] = []
    for n, message in enumerate(decoded(rng, count)):
        understood += message is not None
        refused += message is None
        if isinstance(message, PageTouches):
            device.receive(message, screen)
        elif hasattr(message, "screen"):
            screen = message.screen
        if n % 50 == 49:
            good = decode(json.dumps(MESSAGES[2]))
            assert isinstance(good, PageTouches)
            device.receive(good, msgspec.convert(SCREEN, PageScreen))
            frames += device.poll()
            assert [c.id for c in frames[-1].contacts] == [1]
    sizes = [c.size for f in frames for c in f.contacts if c.size is not None]
    assert all(size > 0.0 for size in sizes)
    check_frames(frames, surface)
    return understood, refused


@pytest.mark.parametrize("count", COUNTS)
def test_mutated_messages_do_no_harm(count: int) -> None:
    understood, refused = fuzz(20261121, count)
    assert understood > count / 10
    assert refused > count / 10
