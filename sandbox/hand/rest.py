"""Looks at a hand at rest, by a device that sees it."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from encoders.person.rest_posture import check_looks
from encoders.person.seen_rest import SeenRest
from encoders.reconstruction.arrival import Phase
from encoders.reconstruction.reconstructor import AirReconstructor
from models.errors import EncoderError, InputError
from models.person import Looks, Person
from models.pose import mirrored
from models.scene import CONTROL_PERIOD
from models.skeleton import ADULT
from sandbox.devices.device import AnyDevice, LatestFrame
from sandbox.trial.live_run import RealTime


def watch_rest(
    watch: RestWatch, device: AnyDevice, wanted: int, seconds: float, live: bool, console: Console
) -> None:
    """Waits for the looks; ends early when a recording or the time is over.

    Args:
        watch: Takes the looks.
        device: Its device.
        wanted: Number of looks.
        seconds: s after which a live device is given up.
        live: False for a recording, which is played as fast as it goes.
        console: Console for messages.
    """
    clock, ticks, told = RealTime(), 0, ""
    while (taken := len(watch.looks)) < wanted and not device.finished:
        now = ticks * CONTROL_PERIOD
        if live and now > seconds:
            return
        watch.step(now)
        if len(watch.looks) > taken:
            console.print(f"  {taken + 1} of {wanted} looks")
        if live and watch.notice != told:
            told = watch.notice
            console.print(Text(told or "the hand is seen"))
        ticks += 1
        if live:
            clock.wait(ticks * CONTROL_PERIOD)


def check_rest(watch: RestWatch, size: float, wanted: int, device: str) -> None:
    """Checks that all looks were taken, and fit a hand of the size.

    Args:
        watch: Took the looks.
        size: Length of the hand relative to the trained one.
        wanted: Number of looks.
        device: Name of the device, for the message.

    Raises:
        InputError: Looks are missing, or are not those of a hand at rest.
    """
    looks = watch.looks
    if len(looks) < wanted:
        raise InputError(
            "the hand was not held still, with its fingertips on one level, often enough",
            where=f"--device {device}",
            got=f"{len(looks)} of {wanted} looks" + (watch.trouble and f"; {watch.trouble}"),
            expected="a second each, and the hand moved in between",
        )
    try:
        check_looks(looks, size)
    except EncoderError as error:
        raise InputError(
            f"the seen hand cannot be used: {error.what}",
            where=error.where,
            got=error.got,
            expected=error.expected,
        ) from None


class RestWatch:
    """Takes looks at one hand, without a task.

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
    def looks(self) -> Looks:
        """The looks so far, as of a right hand."""
        return tuple(self._seen.looks)

    @property
    def trouble(self) -> str:
        """Why the last hand that was held still is not a look; empty if it is one."""
        return self._seen.trouble

    @property
    def notice(self) -> str:
        """Why no look is taken; empty if the hand only has to be held still."""
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
