"""`--lsl`: what other instruments get to hear of a session, over Lab Streaming Layer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import tyro
from rich.console import Console


@dataclass(frozen=True)
class LslOptions:
    """Streams for other instruments."""

    lsl: tyro.conf.FlagCreatePairsOff[bool] = False
    """Sends touches, poses and markers over Lab Streaming Layer (extra `lsl`)."""


@contextmanager
def streaming(wanted: bool, console: Console) -> Iterator[dict[str, Any]]:
    """Streams as long as this lasts, where it is wanted; else nothing.

    Yields:
        How LSL's clock stands against ours; empty where nothing is sent.

    Raises:
        DeviceError: pylsl or its library is not there.
    """
    if not wanted:
        yield {}
        return
    from sandbox.lsl.lsl import NAMES, LslOutlets
    from sandbox.lsl.lsl_listening import listened_to

    outlets = LslOutlets()
    console.print(f"[dim]LSL: {', '.join(NAMES)}[/]", highlight=False)
    try:
        with listened_to(outlets):
            yield outlets.clock()
    finally:
        outlets.close()
