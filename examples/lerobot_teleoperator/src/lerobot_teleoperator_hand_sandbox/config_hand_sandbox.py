"""Options of LeRobot's commands, such as --teleop.device=tablet."""

from dataclasses import dataclass

from lerobot.robots.config import RobotConfig
from lerobot.teleoperators.config import TeleoperatorConfig


@TeleoperatorConfig.register_subclass("hand_sandbox")
@dataclass(kw_only=True)
class HandSandboxConfig(TeleoperatorConfig):
    """Options of the teleoperator.

    Attributes:
        device: `tablet`, `page`, `webcam`, or a device or file of `sandbox run --device`.
        robot: The robot hand that follows, as for `sandbox run --robot`. Empty: a person's hand.
        task: The task that is shown.
        patience: Longest time (s) until a browser has opened the page.
    """

    device: str = "tablet"
    robot: str = ""
    task: str = "box-to-goal"
    patience: float = 600.0


@RobotConfig.register_subclass("hand_sandbox_dummy")
@dataclass(kw_only=True)
class HandSandboxDummyConfig(RobotConfig):
    """Options of the dummy.

    Attributes:
        hand: Same value as `robot` of the teleoperator that moves it.
    """

    hand: str = ""
