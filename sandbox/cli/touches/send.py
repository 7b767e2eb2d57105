"""`sandbox touches send`: sends the packets of a capture, or touches of any device as TUIO."""

from __future__ import annotations

import contextlib
import math
import socket
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.progress import Progress
from rich.text import Text

from models.errors import InputError
from sandbox.cli.common.command_line import flat
from sandbox.cli.common.touch_options import TouchOptions, open_touches_or_page
from sandbox.devices.tuio.touch_capture import read_capture
from sandbox.devices.tuio.tuio_output import TuioOutput, connected, send_packet
from sandbox.system.ending import ending_as_by_ctrl_c

MOST_SENDERS = 64
"""Number of senders of a capture that keep their sockets; a sender needs one."""

_LONGEST_SLEEP = 1.0
"""Longest single sleep, s. Times in a damaged capture may be too large for `time.sleep`."""


@dataclass(frozen=True)
class _File:
    """Positional argument of the command. The class is the last base of the options, so that its
    field comes first, as a positional argument must."""

    file: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """File to send. With --tuio, --device may be given instead."""


@flat
@dataclass(frozen=True, kw_only=True)
class Send(TouchOptions, _File):
    """Options of `sandbox touches send`."""

    to: Annotated[str, Parameter(metavar="HOST:PORT")] = ""
    """Address to which the packets of a capture are sent."""

    tuio: Annotated[str, Parameter(metavar="HOST:PORT")] = ""
    """Address to which touches are sent as TUIO."""

    speed: float = 1.0
    """Playback speed of a file: 2 is twice as fast as recorded."""

    seconds: float = math.inf
    """Stop after this many seconds."""


def send(options: Send = Send()) -> int:
    """Sends touches to other programs.

    --to sends the packets of a TUIO capture over UDP, as the recorded tablet did. With `sandbox
    touches show` running in another terminal:

        sandbox touches send touches.jsonl --to 127.0.0.1:3333

    --tuio sends the touches of any device or file as TUIO 1.1 (2Dcur), for other programs:

        sandbox touches send --device web --tablet --tuio 127.0.0.1:3333
    """
    if bool(options.to) == bool(options.tuio):
        raise InputError(
            "the destination is missing or not unique",
            where="--to, --tuio",
            expected="--to HOST:PORT or --tuio HOST:PORT",
        )
    if not 0.0 < options.speed < math.inf:
        raise InputError(
            "the speed is not a positive number",
            where="--speed",
            got=options.speed,
            expected="a factor above 0; 1 is the recorded speed",
        )
    if options.tuio:
        return _send_tuio(options)
    if options.file is None:
        raise InputError("no file to send", where="--to", expected="a capture of packets")
    return _send_packets(options.file, options.to, options.speed, options.seconds)


def _send_tuio(options: Send) -> int:
    """Sends the frames of a device or file."""
    chosen = options if options.file is None else replace(options, device=str(options.file))
    opened = open_touches_or_page(chosen, options.seconds)
    if opened is None:
        return 0
    console = Console(stderr=True)
    frames = 0
    device = opened.device
    try:
        with contextlib.closing(TuioOutput(options.tuio, opened.surface)) as output:
            console.print(Text(f"sending TUIO 1.1 to {options.tuio}; Ctrl-C ends"))
            begin = time.monotonic()
            # On every kind of end, closing the output lifts all fingers at the receiver.
            with contextlib.suppress(KeyboardInterrupt), ending_as_by_ctrl_c():
                while True:
                    elapsed = time.monotonic() - begin
                    device.wait(min(0.1, max(0.0, options.seconds - elapsed)))
                    came = device.poll(elapsed * options.speed)
                    output.send(came, elapsed)
                    frames += len(came)
                    if device.finished or elapsed >= options.seconds:
                        break
        reached_end = device.finished
    finally:
        device.close()
    report = f"sent {frames} frames in {output.packets} packets to {options.tuio}"
    if output.refused:
        report += f"; no program received {output.refused} of them"
    console.print(Text(report), soft_wrap=True)
    damage = device.damage
    if damage is not None and reached_end:
        raise damage
    return 0


def _send_packets(file: Path, to: str, speed: float, seconds: float) -> int:
    """Sends the packets of a capture at their times; every recorded sender has its own socket.

    A socket is closed when the sender's connection ends in the capture, or when `MOST_SENDERS`
    newer senders have sockets.
    """
    capture = read_capture(file)
    console = Console(stderr=True)
    refused = sent = 0
    channels: dict[str, socket.socket] = {}
    with contextlib.ExitStack() as closing, _progress(console) as bar:
        with connected(to):
            pass  # Refuses an invalid address before the first packet.
        closing.callback(_close_all, channels)
        job = bar.add_task(f"sending to {to}", total=len(capture.packets))
        begin = time.monotonic()
        for packet in capture.packets:
            due = begin + (packet.time - capture.packets[0].time) / speed
            while (left := min(due, begin + seconds) - time.monotonic()) > 0.0:
                time.sleep(min(left, _LONGEST_SLEEP))
            if due > begin + seconds:
                break
            bar.advance(job)
            if packet.data is None:
                if packet.peer in channels:
                    channels.pop(packet.peer).close()
                continue
            if packet.peer not in channels:
                if len(channels) == MOST_SENDERS:
                    channels.pop(next(iter(channels))).close()
                channels[packet.peer] = connected(to)
            if send_packet(channels[packet.peer], packet.data, to):
                if not refused:
                    bar.print(Text(f"no program listens at {to} yet; start `sandbox touches show`"))
                refused += 1
            sent += 1
    took = time.monotonic() - begin
    report = f"sent {sent} packets in {took:.1f} s to {to}"
    if refused:
        report += f"; no program received {refused} of them"
    console.print(Text(report))
    if capture.damage is not None:
        raise capture.damage
    return 0


def _close_all(channels: Mapping[str, socket.socket]) -> None:
    for channel in channels.values():
        channel.close()


def _progress(console: Console) -> Progress:
    return Progress(console=console, transient=True, disable=not console.is_terminal)
