"""Watches the hand that a device sees in the air, until it has been held still as it rests."""

from __future__ import annotations

from encoders.person.rest_posture import Looks
from encoders.person.seen_rest import SeenRest
from encoders.reconstruction.arrival import Phase
from encoders.reconstruction.reconstructor import AirReconstructor
from models.person import Person
from models.pose import mirrored
from models.skeleton import ADULT
from sandbox.devices.device import AnyDevice
from sandbox.session.latest_frame import LatestFrame


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
        return self._device.notice or self._reconstructor.notice or self._seen.trouble

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
