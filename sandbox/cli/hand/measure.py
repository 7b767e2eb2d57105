"""`sandbox hand measure`: measures the size of a person's hand relative to the trained hand."""

from __future__ import annotations

import math
import time
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from encoders.labels.belief import builtin_population_belief
from encoders.person.hand_size import SPREADS, HandSize, SpreadCollector, builtin_sizes
from encoders.person.rest_posture import load_rest, read_rest
from models.arithmetic import Array
from models.errors import InputError
from models.person import Person, PersonFrame
from models.scene import CONTROL_PERIOD
from models.surface import Surface
from sandbox.cli.common.command_line import flat, picked
from sandbox.cli.common.json_out import check_output, refuse_replacing
from sandbox.cli.common.touch_options import LiveTouchOptions
from sandbox.devices.device import Device
from sandbox.devices.files.touch_files import first_line
from sandbox.devices.registry import given_device_options, is_in_air
from sandbox.devices.simulated.spreads import SimulatedSpreads
from sandbox.recording.recording import is_recording
from sandbox.session.own_layouts import Layouts, stored_layouts
from sandbox.trial.assembly import device_makers, is_live
from sandbox.trial.profiles import Profile, default_path, save_profile
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.registry import find_task

_ASKED = {
    "natural": "put down all five fingertips, relaxed, and hold still",
    "closed": "lift, then put them down as close together as is comfortable",
    "wide": "lift, then put them down as wide apart as is comfortable",
}


def collect_layouts(device: Device, live: bool, seconds: float, console: Console) -> list[Array]:
    """Returns three layouts (5, 2), one for each time that five fingers rest, m on the screen.

    Args:
        device: Device of the touches.
        live: False for a file, which is played as fast as the machine can.
        seconds: Timeout for a live device, s.
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
    """Returns the layouts whose five fingers are labelled with certainty, thumb first."""
    belief = builtin_population_belief()
    for xy in layouts:
        belief.reset()
        belief.assign(dict(enumerate(map(tuple, (xy / person.hand_size).tolist()))), {})
    return stored_layouts(belief.own, person.hand_size)


def rounded_interval(size: HandSize, person: Person) -> tuple[float, float]:
    """Returns the interval of the size, rounded, and widened if needed to contain the size."""
    low, high = round(size.low, 4), round(size.high, 4)
    return min(low, person.hand_size), max(high, person.hand_size)


@flat
@dataclass(frozen=True, kw_only=True)
class MeasureOptions(LiveTouchOptions):
    """Options of `sandbox hand measure`."""

    device: Annotated[str, Parameter(metavar="DEVICE")] = "tuio"
    """Source of touches: a TUIO sender (tuio), a touch screen (evdev), a simulated person
    (simulated, to try the command), or a file: a recording of this program or a capture of TUIO
    packets."""

    hand: Literal["right", "left"] | None = None
    """Which hand. Default: that of the recording, else right."""

    turn: Literal[0, 90, 180, 270] | None = None
    """Edge of the screen at which the person sits: 0 lower, 90 right, 180 upper, 270 left."""

    surface: Annotated[str | None, Parameter(metavar="SIZE")] = None
    """Size of the touch surface: 7.76x5.82in, 197x148mm, or a preset such as ipad2. Required if the
    device does not report it: an error of this size becomes an error of the hand's size."""

    out: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """File for the profile. Default: this user's own profile."""

    rest: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """Rest posture of the hand, which is copied into the profile: a file written by `sandbox hand
    rest`, or a capture of the hand (docs/playing.md)."""

    hand_size: Annotated[float, Parameter(metavar="RATIO")] = 1.0
    """True size of the simulated person's hand."""

    seed: int = 0
    """Seed of the simulated person."""

    seconds: float = 120.0
    """Timeout for a live device, in seconds."""


def measure(options: MeasureOptions = MeasureOptions()) -> int:
    """Measures a hand: put down five fingers three times, relaxed, close together and wide apart.

    The profile stores the length of the hand relative to the hand of the training data; touches are
    scaled by it. It also stores the three layouts, which help to label fewer than five fingers.
    `sandbox play` with a touch device uses the profile automatically; other commands need
    --profile. An existing profile is replaced. `sandbox hand show` shows it.

    Try: sandbox hand measure --device simulated --hand-size 0.9 --out profile.json
    """
    if options.device == "mouse":
        raise InputError(
            "a mouse has no hand to measure", where="--device mouse", expected="a touch device"
        )
    if is_in_air(options.device) or options.device == "web":
        raise InputError(
            "a hand cannot be measured with this device",
            where=f"--device {options.device}",
            expected="tuio, evdev:PATH, simulated, or a file of touches",
        )
    if not options.seconds > 0.0:
        raise InputError(
            "the time is not positive",
            where="--seconds",
            got=options.seconds,
            expected="seconds, above 0",
        )
    path = options.out or default_path()
    if options.out is None:
        with suppress(OSError):
            # `check_output` reports a folder that could not be created.
            path.parent.mkdir(parents=True, exist_ok=True)
    check_output(path, "--out")
    refuse_replacing(path, {"--device": Path(options.device), "--rest": options.rest})
    console = Console()
    simulated = options.device == "simulated"
    # Hand size and seed are those of the simulated person; the rest posture is read below.
    chosen = trial_settings(
        picked(
            TrialOptions,
            options,
            hand_size=None,
            seed=None,
            rest=None,
            device_options=given_device_options(options),
        )
    )
    settings = chosen
    if settings.in_air or len(device_makers(chosen)) != 1:
        raise InputError(
            "this is not a recording of touches of one hand",
            where=f"--device {options.device}",
            remedy="Record five fingers at rest with `sandbox touches record`",
        )
    _check_surface(options, settings)
    surface = settings.surface.rectangle
    asked = replace(settings.hands[0].person, hand_size=1.0)
    if options.rest is not None:
        # Check the file before the person is asked to put down fingers.
        read_rest(options.rest, asked.hand)
    if simulated:
        person = replace(asked, hand_size=options.hand_size)
        device: Device = SimulatedSpreads(person, surface, options.seed)
    else:
        device = _opened(chosen, surface)
    try:
        layouts = collect_layouts(device, is_live(chosen), options.seconds, console)
    finally:
        device.close()
    frame = PersonFrame(asked, surface)
    inward = [frame.inwards(xy) for xy in layouts]
    size = builtin_sizes().estimate(inward)
    _report(size, console)
    measured = replace(asked, hand_size=round(size.ratio, 4))
    played = simulated or chosen.device.user is not None
    interval = rounded_interval(size, measured)
    profile = Profile(
        measured, interval, options.device, played, named_layouts(inward, measured), ()
    )
    save_profile(profile, path)
    if options.rest is not None:
        try:
            looks = load_rest(options.rest, measured.hand, measured.hand_size)
        except InputError:
            console.print(
                f"{profile.line}; written to {escape(str(path))}, without --rest", soft_wrap=True
            )
            raise
        profile = replace(profile, rest=looks)
        save_profile(profile, path)
    console.print(f"{profile.line}; written to {escape(str(path))}", soft_wrap=True)
    return 0


def _opened(chosen: Settings, surface: Surface) -> Device:
    # `device_makers` opens devices for a task; this device only uses the surface.
    task = find_task(chosen.task).draw(chosen.seed, surface)
    (make_device,) = device_makers(chosen)
    return make_device(task, surface)


def _check_surface(options: MeasureOptions, settings: Settings) -> None:
    """Checks that the size of the surface is known, since a guess cannot measure a hand."""
    file = Path(options.device)
    told: object = None
    if file.is_file():
        told = (
            settings.surface.calibrated
            if is_recording(file)
            else first_line(file).get("surface_calibrated")
        )
    # Files that state `calibrated` have lengths already, so --surface has no effect on them.
    asked = options.surface is not None or (settings.surface.calibrated and not file.is_file())
    if not (asked if told is None else told):
        raise InputError(
            "the size of the touch surface is not known",
            where=f"--device {options.device}",
            remedy="Measure the touch area with a ruler, for example --surface 197x148mm"
            if told is None
            else "The recording's lengths come from a guessed size, and --surface cannot change "
            "them. Record again with a known size: hold a bank card to the page when it asks for "
            "one, or add --surface to the command that records",
        )


def _report(size: HandSize, console: Console) -> None:
    alone = ", ".join(f"{n} {r:.2f}" for n, r in zip(SPREADS, size.alone, strict=True))
    console.print(
        f"size [bold]{size.ratio:.3f}[/] (95 %: {size.low:.2f} to {size.high:.2f}); each spread "
        f"alone: {alone}",
        soft_wrap=True,
    )
