"""Samples of a hand at rest, by a device that sees it."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from encoders.person.rest_posture import SeenRest, check_rest_samples
from encoders.reconstruction.hand_motion import Phase
from encoders.reconstruction.reconstructor import AirReconstructor
from models.errors import EncoderError, InputError
from models.person import Person, RestSamples
from models.pose import mirrored
from models.scene import CONTROL_PERIOD
from models.skeleton import ADULT
from sandbox.devices.device import AnyDevice, LatestFrame
from sandbox.trial.driver import RealTime


def watch_rest(
    watch: RestWatch, device: AnyDevice, wanted: int, seconds: float, live: bool, console: Console
) -> None:
    """Waits for the samples; ends early when a recording or the time is over.

    Args:
        watch: Takes the samples.
        device: Its device.
        wanted: Number of samples.
        seconds: s after which a live device is given up.
        live: False for a recording, which is played as fast as it goes.
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
    """Checks that all samples were taken, and fit a hand of the size.

    Args:
        watch: Took the samples.
        size: Length of the hand relative to the trained one.
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
            expected="a second each, and the hand moved in between",
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
        person: The person, whose side and size are those of the hand.
    """

    def __init__(self, device: AnyDevice, reconstructor: AirReconstructor, person: Person) -> None:
        self._device, self._reconstructor = device, reconstructor
        self._left = person.hand == "left"
        self._newest = LatestFrame(reconstructor.empty)
        self._seen = SeenRest(Person("right", person.hand_size).skeleton(ADULT))

    @property
    def samples(self) -> RestSamples:
        """The samples so far, as of a right hand."""
        return tuple(self._seen.samples)

    @property
    def trouble(self) -> str:
        """Why the last hand that was held still is not a sample; empty if it is one."""
        return self._seen.trouble

    @property
    def notice(self) -> str:
        """Why no sample is taken; empty if the hand only has to be held still."""
        first = next(iter(self._device.notices), "")
        return first or self._reconstructor.notice or self._seen.trouble

    def step(self, now: float) -> None:
        """A control period.

        Args:
            now: s since the beginning.
        """
        self._newest.take(self._device.poll(now), now)
        pose = self._reconstructor.step(self._newest.frame)  # type: ignore[arg-type]
        if pose.phase is Phase.DOWN:
            self._seen.add(now, mirrored(pose.q) if self._left else pose.q)
        else:
            self._seen.lose()
