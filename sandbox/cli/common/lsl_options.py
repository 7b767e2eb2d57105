"""Option `--lsl`: streams a session to other instruments over Lab Streaming Layer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Annotated, Any

from cyclopts import Parameter
from rich.console import Console

from sandbox.trial.trial_options import OUTPUT


@dataclass(frozen=True, kw_only=True)
class LslOptions:
    """Options of Lab Streaming Layer."""

    lsl: Annotated[bool, Parameter(group=OUTPUT)] = False
    """Send touches, poses and markers over Lab Streaming Layer (extra `lsl`)."""


@contextmanager
def streaming(wanted: bool, console: Console) -> Iterator[dict[str, Any]]:
    """Context in which a session is streamed, if `wanted` is true.

    Yields:
        Offset between LSL's clock and that of this program (`LslOutlets.clock`); empty if nothing
        is streamed.

    Raises:
        DeviceError: pylsl or its library is missing.
    """
    if not wanted:
        yield {}
        return
    from sandbox.lsl import NAMES, LslOutlets, forwarding_to

    outlets = LslOutlets()
    console.print(f"[dim]LSL: {', '.join(NAMES)}[/]", highlight=False)
    try:
        with forwarding_to(outlets):
            yield outlets.clock()
    finally:
        outlets.close()
