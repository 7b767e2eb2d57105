"""`sandbox stream`: sends the motion of hands live to Maya or Blender."""

from __future__ import annotations

import ast
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter
from rich.console import Console

from encoders.paalm.calibration import HandCalibration
from encoders.paalm.calibration_file import read_hand
from encoders.regression.model_registry import DEFAULT_MODEL, check_model_name
from models.errors import InputError
from models.frames import SIDES
from sandbox.cli.common.command_line import parse, picked
from sandbox.cli.common.json_out import check_output, write_json
from sandbox.cli.common.touch_options import LiveTouchOptions
from sandbox.devices.device import Sees
from sandbox.devices.files import show_report
from sandbox.devices.leap import LeapCommandOptions, OverLeapOptions
from sandbox.devices.leap.leap import open_leap
from sandbox.devices.registry import (
    DEVICES,
    check_device_options,
    given_device_options,
    kind_of,
)
from sandbox.devices.registry import LIVE_LEAP as LEAP
from sandbox.export.leap_source import Hand
from sandbox.export.motion_source import MotionSource
from sandbox.export.sources import open_source
from sandbox.recording.recording import is_recording
from sandbox.server.page_options import PageOptions
from sandbox.stream.hand_sources import StreamPace, StreamPlayer
from sandbox.stream.lines import BLENDER, MAYA, MAYA_MEL, StreamTarget
from sandbox.stream.sender import Moment, Sender, parse_address
from sandbox.study.record.trial_files import find_recordings
from sandbox.system.ending import heeding
from sandbox.trial.assembly import device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.registry import find_task

if TYPE_CHECKING:
    from sandbox.trial.assembly import DeviceMakers
    from sandbox.trial.settings import Settings


SCRIPTS = Path(__file__).parents[1] / "stream"
PARTS = {
    "maya": ("guest", "maya_side"),
    "blender": ("guest", "blender_rigs", "blender_side"),
}
"""Modules of each script. The script has the docstring of the last module."""


def script(program: str) -> str:
    """Returns the script for `maya` or `blender`, which needs no other files.

    Raises:
        InputError: The program is unknown.
    """
    if program not in PARTS:
        raise InputError(
            "no script for this program",
            where="--script",
            got=program,
            expected=", ".join(PARTS),
        )
    parts = [(SCRIPTS / f"{part}.py").read_text(encoding="utf-8") for part in PARTS[program]]
    docstring = ast.get_docstring(ast.parse(parts[-1]), clean=False) or ""
    head = f'"""{docstring}"""\n\nfrom __future__ import annotations\n'
    return head + "\n\n".join(_body(part) for part in parts)


def _body(source: str) -> str:
    """Returns a module without its docstring and its imports of this package."""
    lines: list[str | None] = list(source.splitlines())
    for node in ast.parse(source).body:
        ours = isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] in (
            "sandbox",
            "__future__",
        )
        docstring = node.lineno == 1 and isinstance(node, ast.Expr)
        if ours or docstring:
            lines[node.lineno - 1 : node.end_lineno] = [None] * (
                (node.end_lineno or node.lineno) - node.lineno + 1
            )
    kept = [line.replace("  # noqa: N818", "") for line in lines if line is not None]
    return "\n".join(kept).strip("\n") + "\n"


TASK = "box-to-goal"
"""Default task. Only its workspace is used, except by a simulated person, who plays the task."""
LIVE = tuple(name for name in DEVICES if name != "mouse")
PAGE_PATIENCE = 600.0
"""Time within which somebody must open the page, s."""
STOP_TIMEOUT = 5.0
"""Time within which the other program must accept the command to stop, s."""
KEY_PATIENCE = 10.0
"""Longest time for which a pose of a recording waits until the previous one is sent, s."""


@dataclass(frozen=True)
class _File:
    """Positional argument of the command. The class is the last base of the options, so that its
    field comes first, as a positional argument must."""

    file: Annotated[Path | None, Parameter(metavar="RECORDING|TRIAL|CAPTURE")] = None
    """A recording (--record), a trial of a study, a capture (.npz), or a recording of a Leap. Or
    use --device."""


@dataclass(frozen=True, kw_only=True)
class StreamOptions(LeapCommandOptions, PageOptions, LiveTouchOptions, _File):
    """Sends the motion of hands live to Maya or Blender, where the fingers of any rig follow it.

    In Maya, paste the script into the script editor (Python) and run it. Select the first joint
    of each finger, one to five, thumb first. Then run open_port() and start():

        sandbox stream --script maya > hand_sandbox_maya.py
        sandbox stream --device leap --maya :7002

    The script was NEVER RUN IN A REAL MAYA; docs/stream.md says how it was tested. In Blender:

        sandbox stream --script blender > hand_sandbox_blender.py
        blender -P hand_sandbox_blender.py
        sandbox stream --device leap --blender :7004

    Hands over a Leap need no task: PAALM computes their poses in the frame of the device.
    --hand both streams both hands. A recording of a Leap is streamed in the same way:

        sandbox devices leap simulate --out leap.json
        sandbox stream leap.json --blender :7004

    Try it without a device, with a recorded hand or a simulated person:

        sandbox run box-to-goal --device simulated --seed 3 --record run.jsonl
        sandbox stream run.jsonl --blender :7004
        sandbox stream --device leap-simulated --maya :7002

    The other program may start later, stall, or be restarted. Ctrl-C ends the stream, and the
    other program then bakes the motion into keyframes. --print shows the commands instead of
    sending them.
    """

    maya: Annotated[str | None, Parameter(metavar="HOST:PORT")] = None
    """Address of Maya's command port."""

    blender: Annotated[str | None, Parameter(metavar="HOST:PORT")] = None
    """Address on which the script in Blender listens."""

    script: Literal["maya", "blender"] | None = None
    """Print the script for this program and exit; the script needs no other files."""

    print: bool = False
    """Print the commands instead of sending them, in Maya's form unless --blender is given."""

    device: Annotated[str | None, Parameter(metavar="DEVICE")] = None
    """Source of live hands: a page in a browser (web), a TUIO sender (tuio), a touch screen
    (evdev), a Leap (leap), a simulated person (simulated, leap-simulated), or a file that plays as
    a device."""

    of: Literal["simulated", "commanded"] | None = None
    """simulated: the pose of the hand in the physics simulation, the default for a recording.
    commanded: the pose computed from the input, the default for a device."""

    rate: Annotated[float, Parameter(metavar="HZ")] = 60.0
    """Poses per second."""

    speed: float = 1.0
    """Playback speed of a recording: 2 is twice as fast."""

    language: Literal["python", "mel"] = "python"
    """Language of Maya's command port (sourceType)."""

    task: str | None = None
    """Task whose workspace is used, box-to-goal by default; a simulated person plays the task.
    Hands over a Leap need no task; with a task, they stay above its table."""

    hand: Hand | None = None
    """Hand over a Leap: right, left or both. Default: right for a live Leap, all hands for a
    recording. Other recordings always stream all their hands."""

    encoder: str = DEFAULT_MODEL
    """Encoder, as for `sandbox run`."""

    surface: Annotated[str | None, Parameter(metavar="SIZE")] = None
    """Size of the touch surface, such as 197x148mm or ipad2."""

    seed: int | None = None
    """Seed of the simulated person and of the task."""

    take: Annotated[int, Parameter(metavar="N")] = 1
    """Number of the take in a capture, from 1."""

    out: Annotated[Path, Parameter(metavar="DIR")] = Path("studies")
    """Folder of studies."""

    unit: Annotated[str, Parameter(metavar="UNIT,...")] = ""
    """Units of a recording of a Leap, such as cm,ms. Default: units for which the hand's size and
    the frames' rate are possible."""

    json: Annotated[Path | None, Parameter(metavar="OUT")] = None
    """File for the numbers of sent and dropped poses and of answers, as JSON; - is the terminal."""


def main(argv: list[str]) -> int:
    """Runs `sandbox stream ...`."""
    options = parse(StreamOptions, "sandbox stream", argv)
    if options.script:
        print(script(options.script), end="")
        return 0
    if (options.tablet or options.lan is not None) and not (options.file or options.device):
        options = replace(options, device="web")
    target, address = _target(options)
    _check(options)
    console, stop = Console(stderr=True), threading.Event()
    with _open(options, stop, console) as (source, live):
        pace = StreamPace(
            options.rate, 0.0 if live else options.speed, 0.0 if live else KEY_PATIENCE
        )
        player = StreamPlayer(source, target, pace)
        for remark in source.remarks:
            console.print(remark, style="yellow", soft_wrap=True, markup=False)
        if address is None:
            status = _print(player, console)
            show_report(source.report)
            return status
        host, port = address
        sender = Sender(host, port, player.greeting)
        try:
            console.print(
                f"streaming {source.what} to {target.name} at {host}:{port}, "
                f"{options.rate:g} times a second; Ctrl-C ends it",
                soft_wrap=True,
                highlight=False,
            )
            with _interruptible(stop), _reporting_connection(sender, console):
                damage = player.play(sender, stop)
            # After Ctrl-C without any connection, do not wait for a receiver.
            answered = sender.counts.get("connections", 0) > 0
            reached = sender.flush(STOP_TIMEOUT if answered or not stop.is_set() else 0.0)
        finally:
            sender.close()
    _report(options, player, sender, reached, damage, console)
    show_report(source.report)
    return 0


def _target(options: StreamOptions) -> tuple[StreamTarget, tuple[str, int] | None]:
    if options.print and not (options.maya and options.blender):
        maya = MAYA_MEL if options.language == "mel" else MAYA
        return BLENDER if options.blender is not None else maya, None
    if (options.maya is None) == (options.blender is None):
        raise InputError(
            "the receiver is missing or not unique",
            got="both" if options.maya else "neither",
            expected="--maya HOST:PORT, --blender HOST:PORT, --print or --script",
        )
    if options.blender is not None:
        return BLENDER, parse_address(options.blender)
    return MAYA_MEL if options.language == "mel" else MAYA, parse_address(str(options.maya))


def _check(options: StreamOptions) -> None:
    if options.task is not None:
        find_task(options.task)
    check_model_name(options.encoder)
    if options.device is not None:
        check_device_options(given_device_options(options), [options.device])
    check_output(options.json)
    if (options.file is None) == (options.device is None):
        raise InputError(
            "the source of the hand is missing or not unique",
            got="both" if options.file else "neither",
            expected="a recording, or --device",
        )
    for name, value, least, most in (
        ("--rate", options.rate, 1.0, 240.0),
        ("--speed", options.speed, 0.01, 100.0),
    ):
        if not least <= value <= most:
            raise InputError(
                "out of range", where=name, got=value, expected=f"{least:g} to {most:g}"
            )


@contextmanager
def _open(
    options: StreamOptions, stop: threading.Event, console: Console
) -> Iterator[tuple[MotionSource, bool]]:
    """Opens the source of poses; the flag is True for a live source."""
    path = options.file
    straight = options.task is None and options.of != "simulated"
    if options.device and Path(options.device).is_file():
        given = Path(options.device)
        whole = (
            straight
            if kind_of(options.device).sees is Sees.LEAP
            else is_recording(given) or _is_capture(given)
        )
        path = given if whole else None
    if path is not None:
        yield _recorded(options, path), False
        return
    # This import loads the simulation, which recordings do not need.
    from sandbox.stream.hand_sources import source_of_leap, source_of_session

    if straight and options.device == LEAP:
        device = open_leap(options.leap, tell=True)
        try:
            yield source_of_leap(device, *_leap_hands(options), stop), True
        finally:
            device.close()
        return
    if options.hand == "both":
        raise InputError(
            "both hands can be streamed from a Leap without a task",
            where="--hand both",
            got=f"--device {options.device}" + (f" --task {options.task}" if options.task else ""),
            expected="--device leap, or a recording of a Leap",
        )
    from sandbox.trial.assembly import build

    session = build(*_session(options, console))
    try:
        yield source_of_session(session, stop, options.of or "commanded"), True
    finally:
        session.close()


def _recorded(options: StreamOptions, path: Path) -> MotionSource:
    """Opens a recording."""
    if options.task is not None:
        raise InputError(
            "--task does not apply to a recording, which has its own task or none",
            where="--task",
            got=options.task,
            remedy="Leave it out",
        )
    _no_table(options)
    files = find_recordings(str(path), options.out)
    if len(files) > 1:
        raise InputError(
            "only one recording can be streamed at a time",
            where=str(path),
            got=f"{len(files)} recordings",
            remedy=f"Name one of them, such as {files[0].stem}",
        )
    return open_source(
        files[0], options.of, options.take, options.hand, options.calibration, options.unit
    )


def _leap_hands(options: StreamOptions) -> tuple[tuple[str, ...], dict[str, HandCalibration]]:
    """Sides and calibrations of the hands over a live Leap."""
    _no_table(options)
    sides = SIDES if options.hand == "both" else (options.hand or "right",)
    file = options.calibration
    return sides, {side: read_hand(file, side) for side in sides} if file is not None else {}


def _no_table(options: StreamOptions) -> None:
    """Refuses a position of the Leap (--leap-at), since there is no scene without a task."""
    if options.leap_at != OverLeapOptions.leap_at:
        raise InputError(
            "without a task, the hand is in the frame of the Leap, so the Leap has no position",
            where="--leap-at",
            got=options.leap_at,
            remedy="Leave it out, or name a --task",
        )


def _is_capture(path: Path) -> bool:
    return path.suffix == ".npz"


def _session(options: StreamOptions, console: Console) -> tuple[Settings, DeviceMakers]:
    hand = None if options.hand == "both" else options.hand
    given = given_device_options(options) | ({"unit": options.unit} if options.unit else {})
    scene = picked(
        TrialOptions, options, task=options.task or TASK, hand=hand, device_options=given
    )
    if options.device == "mouse":
        raise InputError(
            "the mouse needs a window", where="--device mouse", expected=", ".join(LIVE)
        )
    chosen = trial_settings(scene)
    if options.device != "web":
        return chosen, device_makers(chosen)
    from sandbox.cli.common.touch_options import TouchOptions
    from sandbox.play.page_touches import open_page_touches

    page = open_page_touches(picked(TouchOptions, options), console, PAGE_PATIENCE)
    if page is None:
        raise InputError(
            f"no browser has opened the page within {PAGE_PATIENCE:g} s",
            where="--device web",
            remedy="Run the command again, and open the printed link in a browser",
        )
    size = (page.surface.width_in, page.surface.height_in)
    return chosen.changed(size_in=size), (lambda task, surface: page,)


def _print(player: StreamPlayer, console: Console) -> int:
    class Printer:
        """Prints commands in place of a `Sender`."""

        def show(
            self, hand: str, moment: Moment, wait: float = 0.0, stop: threading.Event | None = None
        ) -> bool:
            print("\n".join(moment()))
            return True

        def order(self, command: str) -> None:
            print(command, flush=True)

    print("\n".join(player.greeting))
    stop = threading.Event()
    with _interruptible(stop):
        damage = player.play(Printer(), stop)
    if damage:
        console.print(damage, style="yellow", soft_wrap=True, markup=False)
    return 0


@contextmanager
def _interruptible(stop: threading.Event) -> Iterator[None]:
    """Context in which Ctrl-C, SIGTERM and SIGHUP set `stop` instead of ending the program.

    The caller can then still send the receiver the command to stop.
    """
    with heeding(lambda *_: stop.set()):
        yield


@contextmanager
def _reporting_connection(sender: Sender, console: Console) -> Iterator[None]:
    """Context that prints when the other program connects and disconnects."""
    done = threading.Event()

    def watch() -> None:
        last: bool | None = None
        silent = 0.0
        while not done.wait(0.25):
            now = sender.connected.is_set()
            # A port that closes after every command counts as connected.
            silent = 0.0 if now else silent + 0.25
            state = True if now else False if silent >= 1.0 else last
            if state != last:
                state_text = (
                    "connected" if state else f"waiting for the receiver ({sender.trouble})"
                )
                console.print(f"[dim]{state_text}[/]", soft_wrap=True, highlight=False)
                last = state

    thread = threading.Thread(target=watch, name="stream words", daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def _sent(times: int, hands: int, counts: Mapping[str, int]) -> str:
    """Returns a sentence with the numbers of moments (one pose of one hand) sent and dropped."""
    moments = times * hands
    sent, dropped = counts.get("moments sent", 0), counts.get("moments dropped", 0)
    if not sent:
        return f"{moments} poses: none was sent"
    if not dropped:
        return f"{moments} poses: all were sent"
    return f"{moments} poses: {sent} were sent, {dropped} were replaced by newer ones"


def _report(
    options: StreamOptions,
    player: StreamPlayer,
    sender: Sender,
    reached: bool,
    damage: str,
    console: Console,
) -> None:
    counts = sender.counts
    per = 1e3 * player.work / max(player.moments, 1)
    result = {
        "schema": 1,
        "moments": player.moments,
        "counts": counts,
        "ms_per_moment": round(per, 4),
        "stopped": reached,
        "damage": damage,
    }
    for warning in (
        damage,
        ""
        if reached
        else f"the command to stop was not sent: {sender.trouble or 'no data accepted'}; "
        "run stop() in the receiving program",
    ):
        if warning:
            console.print(warning, style="yellow", soft_wrap=True, markup=False)
    console.print(_sent(player.moments, len(player.hands), counts), soft_wrap=True)
    write_json(options.json, result)
