"""`sandbox touches`: show what a touch device says, send a capture, list what is understood."""

from __future__ import annotations

import dataclasses
import math
import socket
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console
from rich.progress import Progress
from rich.table import Table
from rich.text import Text

from models.errors import DeviceError, InputError
from models.surface import Surface, parse_surface
from sandbox.cli.touch_views import JsonView, Source, TextView, View, what_to_check
from sandbox.devices.touch_capture import CaptureDevice, read_capture
from sandbox.devices.tuio import DEFAULT_PORT, LOOPBACK, TuioDevice

PATIENCE = 5.0
"""Seconds without a single frame after which we say what to check."""


def main(argv: list[str]) -> int:
    """Runs `sandbox touches ...`; returns the exit status."""
    commands: dict[str, Callable[..., int]] = {"show": show, "send": send, "formats": formats}
    try:
        return int(
            tyro.extras.subcommand_cli_from_dict(
                commands,
                prog="sandbox touches",
                description="See what a tablet or touch table says, before anything is simulated.",
                args=argv,
            )
        )
    except SystemExit as stop:  # --help, or options that do not parse: tyro has said so
        return int(stop.code or 0)


def show(
    device: Annotated[str, tyro.conf.arg(metavar="{tuio,FILE}")] = "tuio",
    bind: Annotated[str, tyro.conf.arg(metavar="ADDRESS")] = LOOPBACK,
    port: int = DEFAULT_PORT,
    surface: Annotated[str | None, tyro.conf.arg(metavar="SIZE")] = None,
    as_json: Annotated[tyro.conf.FlagCreatePairsOff[bool], tyro.conf.arg(name="json")] = False,
    seconds: float = math.inf,
    frames: Annotated[int | None, tyro.conf.arg(metavar="INT")] = None,
    stale_after: float = 2.0,
) -> int:
    """Shows every touch as it arrives; Ctrl-C ends.

    x and y are inches from the top left corner of the surface.

    First try it on this machine, with a capture and two terminals:

        sandbox touches show

        sandbox touches send CAPTURE --to 127.0.0.1:3333

    Then with a tablet in the same network, whose app is told the address that this prints:

        sandbox touches show --bind 0.0.0.0

    Args:
        device: tuio listens for TUIO 1.1 on UDP; a file is a capture to play.
        bind: Which of this machine's addresses to listen on. 127.0.0.1 is reached from this machine
            only, 0.0.0.0 from the whole network.
        port: UDP port; 0 takes a free one and tells which.
        surface: Size of the touch area: 7.76x5.82in, 197x148mm, or a preset (ipad2, ipad-11,
            ipad-13, ipad-mini). TUIO carries no sizes, so without this inches are a guess.
        as_json: One JSON line per frame on stdout, {"time", "contacts": [{"id", "x", "y",
            "finger"}]}; events as JSON lines on stderr, first {"event": "listening", "address"}.
        seconds: Stop after this many seconds.
        frames: Stop after this many frames.
        stale_after: Lift the touches of a sender after this many seconds without a packet.
    """
    if seconds <= 0.0 or math.isnan(seconds) or (frames is not None and frames <= 0):
        raise InputError(
            "there is nothing to show", where="--seconds, --frames", expected="more than 0"
        )
    size = parse_surface(surface) if surface else _guessed_surface()
    seen: Source
    if device == "tuio":
        seen = TuioDevice(size, bind=bind, port=port, stale_after=stale_after)
    else:
        seen = CaptureDevice(read_capture(Path(device)), size, stale_after=stale_after)
    view: View = JsonView(seen) if as_json else TextView(seen, size)
    try:
        with view:
            _follow(seen, view, seconds, frames)
            reached_end = isinstance(seen, CaptureDevice) and seen.finished
    except KeyboardInterrupt:
        return 0  # the usual way to end
    finally:
        seen.close()
    if isinstance(seen, CaptureDevice) and seen.damage is not None and reached_end:
        raise seen.damage
    return 0


def send(
    file: tyro.conf.Positional[Path],
    to: Annotated[str, tyro.conf.arg(metavar="HOST:PORT")],
    speed: float = 1.0,
) -> int:
    """Sends a capture's packets over UDP as they were recorded, as if its tablet were here.

    For example, with `sandbox touches show` running in another terminal:

        sandbox touches send touches.jsonl --to 127.0.0.1:3333

    Args:
        file: A capture: JSON lines {"t": seconds, "hex": bytes of the packet}.
        to: Where to.
        speed: 2 is twice as fast as recorded.
    """
    if not 0.0 < speed < math.inf:
        raise InputError("this is no speed", where="--speed", got=speed, expected="more than 0")
    capture = read_capture(file)
    console = Console(stderr=True)
    refused = 0
    with _connected(to) as channel, _progress(console) as bar:
        job = bar.add_task(f"sending to {to}", total=len(capture.packets))
        begin = time.monotonic()
        for packet in capture.packets:
            due = begin + (packet.time - capture.packets[0].time) / speed
            time.sleep(max(0.0, due - time.monotonic()))
            if send_packet(channel, packet.data, to):
                if not refused:
                    bar.print(Text(f"nobody listens at {to} yet: `sandbox touches show` does"))
                refused += 1
            bar.advance(job)
    took = time.monotonic() - begin
    report = f"sent {len(capture.packets)} packets in {took:.1f} s to {to}"
    if refused:
        report += f"; while nobody listened there: {refused}"
    console.print(Text(report))
    if capture.damage is not None:
        raise capture.damage
    return 0


def formats() -> int:
    """Lists the protocols and files that are understood."""
    table = Table("what", "how", "understood")
    table.add_row("TUIO 1.1, 2Dcur", "UDP, --device tuio", "yes: fingers on tablets and tables")
    table.add_row("TUIO 1.1, 2Dobj, 2Dblb, ...", "UDP", "ignored: tagged objects and blobs")
    table.add_row("TUIO 2.0", "UDP", "ignored: set the sender to version 1.1")
    table.add_row(
        "packet capture", "--device FILE, send FILE", 'yes: JSON lines {"t": seconds, "hex": "..."}'
    )
    Console().print(table)
    return 0


def _follow(seen: Source, view: View, seconds: float, wanted: int | None) -> None:
    """Fetches frames and shows them until there are enough, or the file or the time ends."""
    shown, hinted = 0, False
    begin = time.monotonic()
    while True:
        elapsed = time.monotonic() - begin
        if isinstance(seen, TuioDevice):
            seen.wait(min(0.1, max(0.0, seconds - elapsed)))
        else:
            time.sleep(0.002)
        for frame in seen.poll(elapsed):
            view.frame(frame)
            shown += 1
            if shown == wanted:
                return
        over = elapsed >= seconds or seen.finished
        if not shown and not hinted and (elapsed > PATIENCE or over):
            hinted = True
            view.hint(what_to_check(seen))
        if over:
            return


def _progress(console: Console) -> Progress:
    return Progress(console=console, transient=True, disable=not console.is_terminal)


def _connected(to: str) -> socket.socket:
    """A UDP socket that sends to HOST:PORT."""
    host, _, port = to.rpartition(":")
    channel = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        # Connected, so that the system tells us where nobody listens.
        if not host:
            raise ValueError("there is no host in it")
        channel.connect((host, int(port)))
    except (OSError, ValueError, OverflowError) as error:
        channel.close()
        raise InputError(
            f"this address cannot be sent to: {error}",
            where="--to",
            got=to,
            expected="HOST:PORT, for example 127.0.0.1:3333",
        ) from error
    return channel


def send_packet(channel: socket.socket, data: bytes, to: str) -> bool:
    """Sends a packet; True where the system says that nobody listened to an earlier one."""
    try:
        try:
            channel.send(data)
        except ConnectionRefusedError:
            # The answer to an earlier packet; this one has not left yet.
            channel.send(data)
            return True
    except OSError as error:
        raise DeviceError(
            f"a packet cannot be sent: {error}",
            where=f"--to {to}",
            got=f"{len(data)} bytes",
            remedy="Check the address and the network connection",
        ) from error
    return False


def _guessed_surface() -> Surface:
    return dataclasses.replace(parse_surface("ipad2"), calibrated=False)
