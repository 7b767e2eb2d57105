"""The commands that are traced."""

from __future__ import annotations

import _thread
import json
import threading
import time
from contextlib import suppress
from pathlib import Path

from tests.support.page_client import Page
from tests.support.processes import PATIENCE
from tools.trace.tracer import Tracer

MESSAGES = 60
"""Number of messages with touches, one per control step: about a second."""
HAND = ((1.6, 4.1), (2.2, 2.0), (3.1, 1.5), (4.0, 1.7), (4.8, 2.5))
"""Positions (x, y) in inches of five fingertips of a right hand, the thumb first."""
SPEED = 0.01
"""Distance (inches per message) by which the fingers move to the right."""

DESIGN = """
name = "traced"
title = "Two trials"
participants = 1

[settings]
task = "box-to-goal"

[[factors]]
name = "encoder"
order = "latin"
levels = ["quadratic", "population"]

[consent]
version = "1"
text = "Your touches are recorded. You may stop at any time. Do you agree?"

[[instructions]]
at = "start"
text = "Bring each object to its goal."

[[demographics]]
name = "age"
kind = "number"
low = 18
high = 100
ask = "How old are you?"

[[questionnaires]]
use = "nasa-tlx-raw"
at = "encoder"
"""


def regress(tracer: Tracer, folder: Path) -> int:
    """One trial of box-to-goal by the simulated user; returns the exit status of the command."""
    options = "--tasks box-to-goal --arm plain --seeds 0:1 --executor serial --workers 1"
    return _traced(tracer, ["regress", *options.split()])


def study(tracer: Tracer, folder: Path) -> int:
    """One simulated participant with two trials; returns the exit status of the command."""
    design = folder / "design.toml"
    design.write_text(DESIGN, encoding="utf-8")
    options = ["--out", str(folder), "--participants", "1"]
    return _traced(tracer, ["study", "simulate", str(design), *options])


def touch(tracer: Tracer, folder: Path) -> int:
    """Five fingers on the page for a second; returns the exit status of the command.

    Raises:
        TimeoutError: The page's server did not answer.
    """
    events, failures = folder / "events.jsonl", list[Exception]()

    def play() -> None:
        try:
            _fingers(tracer, events)
        except Exception as error:
            failures.append(error)
        finally:
            tracer.counting = False
            _thread.interrupt_main()

    tracer.counting = False
    # The thread starts before the tracer, and so is not traced.
    threading.Thread(target=play, daemon=True).start()
    options = "play box-to-goal --device web --view web --profile none --events"
    status = 0
    with suppress(KeyboardInterrupt):
        status = _traced(tracer, [*options.split(), str(events)])
    if failures:
        raise failures[0]
    return status


PATHS = {"touch": touch, "regress": regress, "study": study}


def _traced(tracer: Tracer, arguments: list[str]) -> int:
    with tracer:
        from sandbox.cli.main import main

        return main(arguments)


def _fingers(tracer: Tracer, events: Path) -> None:
    """Plays a client of the page. Calls are counted from the client's first touch to the frame
    after its last message."""
    with Page(_address(events)) as page:
        page.until("frame")
        tracer.counting = True
        for number in range(MESSAGES):
            places = [(i, x + SPEED * number, y) for i, (x, y) in enumerate(HAND)]
            sent = page.touch(*places)
            while page.until("frame")["touch"] < sent:
                pass
        tracer.counting = False


def _address(events: Path) -> str:
    """The page's address, from the command's log of events."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        for line in events.read_text(encoding="utf-8").splitlines() if events.exists() else ():
            event = json.loads(line)
            if event["event"] == "listening":
                return str(event["address"])
        time.sleep(0.05)
    raise TimeoutError("the page's server has no address")
