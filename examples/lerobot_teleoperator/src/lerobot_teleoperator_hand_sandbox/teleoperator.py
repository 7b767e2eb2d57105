"""The teleoperator: turns the live pose of a person's hand into actions of a robot hand."""

from typing import Any

from lerobot.teleoperators.teleoperator import Teleoperator
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError
from rich.console import Console

from models.errors import InputError
from sandbox.cli.common.touch_options import TouchOptions
from sandbox.play.page_touches import open_page_touches
from sandbox.stream.hand_sources import LiveHand
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings

from .actions import HandActions
from .config_hand_sandbox import HandSandboxConfig

PAGES = {"tablet": True, "page": False}
"""Name of each device that is a page in a browser -> whether other machines can open the page."""


class HandSandbox(Teleoperator):
    """A hand on a tablet, in front of a webcam or in a recording.

    Args:
        config: Options of the teleoperator.

    Raises:
        InputError: `robot` is not a known robot hand.
    """

    config_class = HandSandboxConfig
    name = "hand_sandbox"

    def __init__(self, config: HandSandboxConfig) -> None:
        super().__init__(config)
        self.config = config
        self._actions = HandActions(config.robot)
        self._hand: LiveHand | None = None

    @property
    def action_features(self) -> dict[str, type]:
        """Name of each number of an action -> its type."""
        return dict.fromkeys(self._actions.names, float)

    @property
    def feedback_features(self) -> dict[str, type]:
        """Empty: a screen has no force feedback."""
        return {}

    @property
    def is_connected(self) -> bool:
        """True between `connect` and `disconnect`."""
        return self._hand is not None

    @property
    def is_calibrated(self) -> bool:
        """True: touches need no calibration."""
        return True

    @property
    def over(self) -> bool:
        """True when the device has ended, such as at the end of a recording."""
        return self._hand is not None and self._hand.over

    def connect(self, calibrate: bool = True) -> None:
        """Opens the device. With a page it waits until a browser has opened it.

        Raises:
            DeviceAlreadyConnectedError: It is connected already.
            InputError: The device or the task cannot be used, or no browser opened the page within
                `patience`.
        """
        if self._hand is not None:
            raise DeviceAlreadyConnectedError(f"{self} is connected already")
        page = self.config.device in PAGES
        device = "web" if page else self.config.device
        chosen = trial_settings(TrialOptions(task=self.config.task, device=device))
        settings, makers = chosen, device_makers(chosen)
        if page:
            asked = TouchOptions(device="web", tablet=PAGES[self.config.device])
            touches = open_page_touches(asked, Console(), self.config.patience)
            if touches is None:
                raise InputError(
                    f"no browser has opened the page within {self.config.patience:g} s",
                    where="teleop.device",
                    remedy="Open the printed address in a browser, or raise --teleop.patience",
                )
            size = touches.surface.width_in, touches.surface.height_in
            settings, makers = settings.changed(size_in=size), (lambda *_: touches,)
        self._hand = LiveHand(build(settings, makers))

    def calibrate(self) -> None:
        """Does nothing."""

    def configure(self) -> None:
        """Does nothing."""

    def get_action(self) -> dict[str, float]:
        """Returns the newest pose as an action.

        Raises:
            DeviceNotConnectedError: It is not connected.
            DeviceError: The device failed.
        """
        if self._hand is None:
            raise DeviceNotConnectedError(f"{self} is not connected")
        return self._actions.action(self._hand.pose())

    def send_feedback(self, feedback: dict[str, Any]) -> None:
        """Does nothing."""

    def disconnect(self) -> None:
        """Closes the device.

        Raises:
            DeviceNotConnectedError: It is not connected.
        """
        if self._hand is None:
            raise DeviceNotConnectedError(f"{self} is not connected")
        self._hand.close()
        self._hand = None
