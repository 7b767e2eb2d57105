"""Notices reach the person, and a terminal that stands still holds no session up."""

from __future__ import annotations

import contextlib
import os

from rich.console import Console

from sandbox.play.player_requests import NoticePrinter
from tests.support.processes import until


def test_a_terminal_that_takes_nothing_holds_up_nobody_and_gets_all_notices_later() -> None:
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writing, b" " * 4096)
    os.set_blocking(writing, True)
    with os.fdopen(writing, "w") as terminal, os.fdopen(reading, "rb", buffering=0) as person:
        printer = NoticePrinter(Console(file=terminal, width=60))
        for number in range(100):
            printer.say(f"notice {number} of [the hand]")
        printer.wait(0.05)
        assert printer.waiting > 90
        seen = b""

        def all_seen() -> bool:
            nonlocal seen
            seen += person.read(1 << 16)
            return seen.count(b"of [the hand]") == 100

        until(all_seen)
        until(lambda: not printer.waiting)
        assert seen.index(b"notice 3 ") < seen.index(b"notice 40 ")
