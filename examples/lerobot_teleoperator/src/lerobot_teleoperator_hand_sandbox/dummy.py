"""A robot without hardware, with which to try the teleoperator."""

from lerobot.robots.robot import Robot
from lerobot.utils.errors import DeviceAlreadyConnectedError, DeviceNotConnectedError

from .actions import HandActions
from .config_hand_sandbox import HandSandboxDummyConfig


class HandSandboxDummy(Robot):
    """A hand without hardware. Its state is the last action.

    Args:
        config: Options of the dummy.

    Raises:
        InputError: `hand` is not a known robot hand.
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
        """Name of each number of an action -> its type."""
        return dict.fromkeys(self._names, float)

    @property
    def observation_features(self) -> dict[str, type]:
        """Same as `action_features`."""
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
        """Sets all numbers to 0.

        Raises:
            DeviceAlreadyConnectedError: It is connected already.
        """
        if self._state is not None:
            raise DeviceAlreadyConnectedError(f"{self} is connected already")
        self._state = dict.fromkeys(self._names, 0.0)

    def calibrate(self) -> None:
        """Does nothing."""

    def configure(self) -> None:
        """Does nothing."""

    def get_observation(self) -> dict[str, float]:
        """Returns the last action.

        Raises:
            DeviceNotConnectedError: It is not connected.
        """
        if self._state is None:
            raise DeviceNotConnectedError(f"{self} is not connected")
        return dict(self._state)

    def send_action(self, action: dict[str, float]) -> dict[str, float]:
        """Carries out an action, and returns it.

        Raises:
            DeviceNotConnectedError: It is not connected.
            ValueError: The action has other names than `action_features`.
        """
        if self._state is None:
            raise DeviceNotConnectedError(f"{self} is not connected")
        if action.keys() != self._state.keys():
            odd = sorted(action.keys() ^ self._state.keys())
            raise ValueError(f"this action is for another hand: {', '.join(odd[:3])}, ...")
        self._state = dict(action)
        return dict(self._state)

    def disconnect(self) -> None:
        """Ends the connection.

        Raises:
            DeviceNotConnectedError: It is not connected.
        """
        if self._state is None:
            raise DeviceNotConnectedError(f"{self} is not connected")
        self._state = None
