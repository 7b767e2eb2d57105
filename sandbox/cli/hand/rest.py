"""`sandbox hand rest`: sees a hand for a second, and keeps its rest posture for --rest."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter
from rich.console import Console
from rich.text import Text

from encoders.person.rest_posture import MOST, save_rest
from encoders.reconstruction.hand_motion import RateLimit
from models.errors import InputError
from sandbox.cli.common.command_line import flat, picked
from sandbox.cli.common.json_out import check_output, refuse_replacing
from sandbox.devices.leap import LeapCommandOptions
from sandbox.devices.registry import LIVE_HEADSET as HEADSET
from sandbox.devices.registry import built_in, given_device_options
from sandbox.devices.webcam import BeforeCameraOptions
from sandbox.hand.rest import RestWatch, check_rest, watch_rest
from sandbox.trial.assembly import device_makers, is_live
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.registry import find_task


@flat
@dataclass(frozen=True, kw_only=True)
class RestOptions(BeforeCameraOptions, LeapCommandOptions):
    """Options of `sandbox hand rest`."""

    device: Annotated[str, Parameter(metavar="leap|webcam|FILE")]
    """What sees the hand: a Leap, a camera, or a file: a recording of a Leap, of landmarks, or of a
    session with a Leap, a camera or a headset."""

    out: Annotated[Path, Parameter(metavar="FILE")]
    """File for the rest posture; an existing one is replaced."""

    samples: int = 1
    """Number of samples, 1 to 12. Lift the hand between two of them. More are more accurate."""

    hand: Literal["right", "left"] | None = None
    """Which hand. Default: that of the recording, else right."""

    hand_size: Annotated[float | None, Parameter(metavar="RATIO")] = None
    """Length of your hand relative to the trained one; `sandbox hand measure` measures it."""

    seconds: float = 60.0
    """Timeout for a live device, in seconds."""


def rest(options: RestOptions) -> int:
    """Sees your hand for a second, and writes its rest posture, for --rest of other commands.

    Touches do not show how high a wrist is held, and how far fingers bend at rest; a camera or a
    Leap does (docs/playing.md). Hold the hand still for a second, relaxed, with all fingertips on
    one level, as it rests on a screen. For a webcam, give its tilt: it decides what is level.

    Try:

        sandbox hand rest --device webcam --out me.json
        sandbox play box-to-goal --tablet --rest me.json
    """
    console = Console(stderr=True)
    chosen = _plan(options)
    hand = chosen.hands[0]
    assert hand.in_air is not None
    surface = chosen.surface.rectangle
    task = find_task(chosen.task).draw(chosen.seed, surface)
    reconstructor = hand.in_air.any_reconstructor(hand.person, surface, RateLimit())
    device: Any = device_makers(chosen)[0](task, surface)
    watch = RestWatch(device, reconstructor, hand.person)
    with closing(device):
        if device.address:
            console.print(Text(f"{device.name}: {device.address}"))
        if is_live(chosen):
            console.print(f"hold your {hand.side} hand as it rests on a screen, for a second")
        live = built_in(options.device) is not None
        watch_rest(watch, device, options.samples, options.seconds, live, console)
    samples = watch.samples
    check_rest(watch, hand.person.hand_size, options.samples, options.device)
    save_rest(samples, options.out, hand.side, chosen.device.user is not None)
    console.print(
        Text(
            f"{len(samples)} sample{'s' if len(samples) > 1 else ''} of a {hand.side} hand of size "
            f"{hand.person.hand_size:.2f}: {options.out}; use it with --rest {options.out}"
        ),
        soft_wrap=True,
    )
    return 0


def _plan(options: RestOptions) -> Settings:
    """Settings and maker of the device.

    Raises:
        InputError: An option has an invalid value, or the device sees no hands.
    """
    if not 1 <= options.samples <= MOST:
        raise InputError(
            "the number of samples is out of range",
            where="--samples",
            got=options.samples,
            expected=f"1 to {MOST}",
        )
    if not options.seconds > 0.0:
        raise InputError("expected a positive time", where="--seconds", got=options.seconds)
    check_output(options.out, "--out")
    sources = {"--device": Path(options.device), "--calibration": options.calibration}
    refuse_replacing(options.out, sources)
    if options.device == HEADSET:
        raise InputError(
            "a headset's hand is seen in a recording",
            where=f"--device {HEADSET}",
            remedy=f"sandbox play box-to-goal --device {HEADSET} --record FILE, then --device FILE",
        )
    entry = built_in(options.device)
    if entry is not None and (entry.kind.simulated or not entry.kind.in_air):
        raise InputError(
            "this device does not see a person's hand",
            where=f"--device {options.device}",
            expected="leap, webcam, or a recording of hands",
        )
    chosen = trial_settings(
        picked(TrialOptions, options, device_options=given_device_options(options))
    )
    if chosen.hands[0].in_air is None:
        raise InputError(
            "this recording has touches, and no hand that was seen",
            where=f"--device {options.device}",
            expected="a recording of a Leap, a camera or a headset",
        )
    return chosen
