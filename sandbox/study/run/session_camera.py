"""The camera of a session: one page in a browser, open from the first trial that needs the camera
to the end of the session."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable, Sequence
from pathlib import Path

from models.frames import LandmarkFrame
from sandbox.devices.device import Closeable, LandmarkDevice
from sandbox.devices.webcam.webcam import WebcamDevice
from sandbox.study.run.forms import Poll

TICK = 0.05
"""Time (s) between two checks of inputs of the participant and the experimenter."""


class SessionCamera(Closeable):
    """Opens the camera's page when a trial first needs it, and uses it for all further trials.

    So the participant allows the camera only once. The camera stays on until the session ends, and
    its page states this. Pictures between trials are discarded.

    Args:
        engine: Folder of the engine (`sandbox.devices.webcam.engine`).
        sides: Sides of the hands that trials follow.
        browse: True opens the page in this machine's browser; False only prints its link.
        say: Prints a line for the experimenter.

    Attributes:
        mirrored: True if the camera's picture is mirrored; read when the page is opened.
    """

    def __init__(
        self, engine: Path, sides: Sequence[str], browse: bool, say: Callable[[str], object]
    ) -> None:
        self.mirrored = False
        self._engine, self._sides, self._browse, self._say = engine, sides, browse, say
        self._device: WebcamDevice | None = None

    def wait_until_on(self, poll: Poll) -> None:
        """Waits until the page sends pictures, and prints the reason for a delay.

        Args:
            poll: See `Poll`; an exception from it ends the wait.

        Raises:
            DeviceError: The page cannot be served.
        """
        device = self._opened()
        # Earlier pictures do not show that the camera is still on.
        device.poll(0.0)
        told: Sequence[str] = ()
        while not device.wait(TICK):
            poll()
            if device.notices not in ((), told):
                told = device.notices
                self._say(", ".join(told))

    def of_trial(self) -> LandmarkDevice:
        """Returns the camera as the device of one trial; it stays on when the trial ends."""
        device = self._opened()
        device.poll(0.0)
        return _StaysOn(device)

    def close(self) -> None:
        """Switches the camera off."""
        if self._device is not None:
            self._device.close()

    def _opened(self) -> WebcamDevice:
        if self._device is None:
            self._device = WebcamDevice(self._engine, self._sides, self.mirrored)
            self._say(f"the camera's page, on this machine only: {self._device.address}")
            if self._browse:
                webbrowser.open(self._device.address)
        return self._device


class _StaysOn(LandmarkDevice):
    """A camera that stays on when a trial ends."""

    lift = True

    def __init__(self, camera: WebcamDevice) -> None:
        self._camera = camera

    @property
    def name(self) -> str:
        """Name of the camera."""
        return self._camera.name

    @property
    def address(self) -> str:
        """Address of the camera's page."""
        return self._camera.address

    @property
    def notices(self) -> Sequence[str]:
        """Notices of the camera."""
        return self._camera.notices

    def poll(self, now: float) -> Sequence[LandmarkFrame]:
        """Landmarks of the pictures since the last call."""
        return () if self.finished else self._camera.poll(now)
