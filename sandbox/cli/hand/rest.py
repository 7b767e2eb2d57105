"""`sandbox hand rest`: measures the rest posture of a hand by a Leap or a camera, for --rest."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter
from rich.console import Console
from rich.text import Text

from encoders.person.rest_posture import MOST, SeenRest, check_rest_samples, save_rest
from encoders.reconstruction.hand_motion import Phase, RateLimit
from encoders.reconstruction.reconstructor import AirReconstructor
from models.errors import EncoderError, InputError
from models.person import Person, RestSamples
from models.pose import mirrored
from models.scene import CONTROL_PERIOD
from models.skeleton import ADULT
from sandbox.cli.common.command_line import flat, picked
from sandbox.cli.common.json_out import check_output, refuse_replacing
from sandbox.devices.device import AnyDevice, LatestFrame
from sandbox.devices.leap import LeapCommandOptions
from sandbox.devices.registry import LIVE_HEADSET as HEADSET
from sandbox.devices.registry import built_in, given_device_options
from sandbox.devices.webcam import BeforeCameraOptions
from sandbox.trial.assembly import device_makers, is_live
from sandbox.trial.driver import RealTime
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.registry import find_task


def watch_rest(
    watch: RestWatch, device: AnyDevice, wanted: int, seconds: float, live: bool, console: Console
) -> None:
    """Waits for the samples; ends early when a recording or the time is over.

    Args:
        watch: Takes the samples from the device.
        device: The device.
        wanted: Number of samples.
        seconds: Timeout for a live device, s.
        live: False for a recording, which is played as fast as the machine can.
        console: Console for messages.
    """
    clock, ticks, told = RealTime(), 0, ""
    while (taken := len(watch.samples)) < wanted and not device.finished:
        now = ticks * CONTROL_PERIOD
        if live and now > seconds:
            return
        watch.step(now)
        if len(watch.samples) > taken:
            console.print(f"  {taken + 1} of {wanted} samples")
        if live and watch.notice != told:
            told = watch.notice
            console.print(Text(told or "the hand is seen"))
        ticks += 1
        if live:
            clock.wait(ticks * CONTROL_PERIOD)


def check_rest(watch: RestWatch, size: float, wanted: int, device: str) -> None:
    """Checks that all samples were taken, and that they fit a hand of the given size.

    Args:
        watch: Has the samples.
        size: Length of the hand relative to the hand of the training data.
        wanted: Number of samples.
        device: Name of the device, for the message.

    Raises:
        InputError: Samples are missing, or are not those of a hand at rest.
    """
    samples = watch.samples
    if len(samples) < wanted:
        raise InputError(
            "the hand was not held still, with its fingertips on one level, often enough",
            where=f"--device {device}",
            got=f"{len(samples)} of {wanted} samples" + (watch.trouble and f"; {watch.trouble}"),
            expected="the hand held still for a second for each sample, and moved between samples",
        )
    try:
        check_rest_samples(samples, size)
    except EncoderError as error:
        raise InputError(
            f"the seen hand cannot be used: {error.what}",
            where=error.where,
            got=error.got,
            expected=error.expected,
        ) from None


class RestWatch:
    """Takes samples of one hand, without a task.

    Args:
        device: The device.
        reconstructor: Reconstructor of the hand.
        person: The person, for side and size of the hand.
    """

    def __init__(self, device: AnyDevice, reconstructor: AirReconstructor, person: Person) -> None:
        self._device, self._reconstructor = device, reconstructor
        self._left = person.hand == "left"
        self._newest = LatestFrame(reconstructor.empty)
        self._seen = SeenRest(Person("right", person.hand_size).skeleton(ADULT))

    @property
    def samples(self) -> RestSamples:
        """The samples so far; those of a left hand are mirrored."""
        return tuple(self._seen.samples)

    @property
    def trouble(self) -> str:
        """Why the hand gave no sample when it was last held still; empty if it gave one."""
        return self._seen.trouble

    @property
    def notice(self) -> str:
        """Why no sample can be taken now; empty if the hand only has to be held still."""
        first = next(iter(self._device.notices), "")
        return first or self._reconstructor.notice or self._seen.trouble

    def step(self, now: float) -> None:
        """Processes one control period.

        Args:
            now: Time since the beginning, s.
        """
        self._newest.take(self._device.poll(now), now)
        pose = self._reconstructor.step(self._newest.frame)  # type: ignore[arg-type]
        if pose.phase is Phase.DOWN:
            self._seen.add(now, mirrored(pose.q) if self._left else pose.q)
        else:
            self._seen.lose()


@flat
@dataclass(frozen=True, kw_only=True)
class RestOptions(BeforeCameraOptions, LeapCommandOptions):
    """Options of `sandbox hand rest`."""

    device: Annotated[str, Parameter(metavar="leap|webcam|FILE")]
    """Source of the hand: a Leap (leap), a camera (webcam), or a file: a recording of a Leap, of
    landmarks, or of a session with a Leap, a camera or a headset."""

    out: Annotated[Path, Parameter(metavar="FILE")]
    """File for the rest posture; an existing file is replaced."""

    samples: int = 1
    """Number of samples, 1 to 12. Lift the hand between samples. More samples are more accurate."""

    hand: Literal["right", "left"] | None = None
    """Which hand. Default: that of the recording, else right."""

    hand_size: Annotated[float | None, Parameter(metavar="RATIO")] = None
    """Length of your hand relative to the hand of the training data, as measured by `sandbox hand
    measure`."""

    seconds: float = 60.0
    """Timeout for a live device, in seconds."""


def rest(options: RestOptions) -> int:
    """Measures the rest posture of your hand in a second, for --rest of other commands.

    Touches do not show how high the wrist is and how far the fingers bend at rest; a camera or a
    Leap does (docs/playing.md). Hold the hand still for a second, relaxed, with all fingertips at
    the same height, as it rests on a screen. For a webcam, give its tilt, from which the direction
    of the table is known.

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
    """Checks the options and returns the settings.

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
        raise InputError(
            "the time is not positive",
            where="--seconds",
            got=options.seconds,
            expected="seconds, above 0",
        )
    check_output(options.out, "--out")
    sources = {"--device": Path(options.device), "--calibration": options.calibration}
    refuse_replacing(options.out, sources)
    if options.device == HEADSET:
        raise InputError(
            "a hand in a headset can be measured only from a recording",
            where=f"--device {HEADSET}",
            remedy=f"Run `sandbox play box-to-goal --device {HEADSET} --record FILE`, then use "
            "--device FILE",
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
            "this recording has only touches, no hand in the air",
            where=f"--device {options.device}",
            expected="a recording of a Leap, a camera or a headset",
        )
    return chosen
