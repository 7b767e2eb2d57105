"""A robot that does at once what it is told, to try the teleoperator without hardware."""

from lerobot.robots.robot import Robot
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError

from .actions import HandActions
from .config_hand_sandbox import HandSandboxDummyConfig


class HandSandboxDummy(Robot):
    """A hand without hardware: its state is the last action.

    Args:
        config: Its options.

    Raises:
        InputError: There is no such robot's hand.
    """

    config_class = HandSandboxDummyConfig
    name = "hand_sandbox_dummy"

    def __init__(self, config: HandSandboxDummyConfig) -> None:
        super().__init__(config)
        self.config = config
        self._names = HandActions(config.hand).names
        self._state: dict[str, float] | None = None

    @property
    def action_features(self) -> dict[str, type]:
        """Name -> type of an action's numbers."""
        return dict.fromkeys(self._names, float)

    @property
    def observation_features(self) -> dict[str, type]:
        """As `action_features`."""
        return self.action_features

    @property
    def is_connected(self) -> bool:
        """True between `connect` and `disconnect`."""
        return self._state is not None

    @property
    def is_calibrated(self) -> bool:
        """True."""
        return True

    def connect(self, calibrate: bool = True) -> None:
        """Begins with all numbers at 0."""
        if self._state is not None:
            raise DeviceAlreadyConnectedError(f"{self} is connected already")
        self._state = dict.fromkeys(self._names, 0.0)

    def calibrate(self) -> None:
        """Does nothing."""

    def configure(self) -> None:
        """Does nothing."""

    def get_observation(self) -> dict[str, float]:
        """The last action."""
        if self._state is None:
            raise DeviceNotConnectedError(f"{self} is not connected")
        return dict(self._state)

    def send_action(self, action: dict[str, float]) -> dict[str, float]:
        """Takes an action; returns what was done.

        Raises:
            ValueError: It has other names.
        """
        if self._state is None:
            raise DeviceNotConnectedError(f"{self} is not connected")
        if action.keys() != self._state.keys():
            odd = sorted(action.keys() ^ self._state.keys())
            raise ValueError(f"this action is of another hand: {', '.join(odd[:3])}, ...")
        self._state = dict(action)
        return dict(self._state)

    def disconnect(self) -> None:
        """Ends the connection."""
        if self._state is None:
            raise DeviceNotConnectedError(f"{self} is not connected")
        self._state = None
