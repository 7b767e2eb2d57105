"""Three layouts of five fingers at rest: collected by touches, named, with the hand's size."""

from __future__ import annotations

import math
import time

from rich.console import Console

from encoders.labels.belief import builtin_population_belief
from encoders.person.hand_size import SPREADS, HandSize, SpreadCollector
from models.arithmetic import Array
from models.errors import InputError
from models.person import Person
from models.scene import CONTROL_PERIOD
from sandbox.devices.device import Device
from sandbox.session.own_layouts import Layouts, stored_layouts

_ASKED = {
    "natural": "put down all five fingertips, relaxed, and hold still",
    "closed": "lift, then put them down as close together as is comfortable",
    "wide": "lift, then put them down as wide apart as is comfortable",
}


def collect_layouts(device: Device, live: bool, seconds: float, console: Console) -> list[Array]:
    """Returns the layouts of the first three rests of five fingers, m on the screen.

    Args:
        device: Device of the touches.
        live: False for a file, which is played as fast as it goes.
        seconds: s after which a live device is given up.
        console: Console for messages.

    Raises:
        InputError: Five fingers did not rest three times.
    """
    collector = SpreadCollector()
    if device.address:
        console.print(f"listening for TUIO on [bold]{device.address}[/]")
    if live:
        _ask(console, 0)
    begin, now, most = time.monotonic(), 0.0, 0
    while len(collector.layouts) < len(SPREADS):
        for frame in device.poll(now):
            most = max(most, len(frame.contacts))
            if collector.step(frame):
                done = len(collector.layouts)
                console.print(f"  {done} of {len(SPREADS)} spreads seen")
                if live and done < len(SPREADS):
                    _ask(console, done)
                if done == len(SPREADS):
                    break
        if device.finished or now > (seconds if live else math.inf):
            break
        if live:
            time.sleep(0.004)
            now = time.monotonic() - begin
        else:
            now += CONTROL_PERIOD
    if len(collector.layouts) < len(SPREADS):
        raise InputError(
            "five fingers did not rest three times",
            where=f"--device {device.name}",
            got=f"{len(collector.layouts)} times, and at most {most} fingers at once",
            expected="three spreads of five fingers, each held still for half a second",
            remedy="Lift the hand between two spreads",
        )
    return list(collector.layouts)


def _ask(console: Console, number: int) -> None:
    name = SPREADS[number]
    console.print(f"[bold]{number + 1} of {len(SPREADS)}, {name}[/]: {_ASKED[name]}")


def named_layouts(layouts: list[Array], person: Person) -> Layouts:
    """The layouts of five fingers, thumb first, that are named with certainty."""
    belief = builtin_population_belief()
    for xy in layouts:
        belief.reset()
        belief.assign(dict(enumerate(map(tuple, (xy / person.hand_size).tolist()))), {})
    return stored_layouts(belief.own, person.hand_size)


def rounded_interval(size: HandSize, person: Person) -> tuple[float, float]:
    """Returns the interval, rounded like the size and still containing it."""
    low, high = round(size.low, 4), round(size.high, 4)
    return min(low, person.hand_size), max(high, person.hand_size)
