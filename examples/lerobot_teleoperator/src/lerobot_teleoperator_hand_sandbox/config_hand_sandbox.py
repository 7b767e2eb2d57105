"""Options, as LeRobot's commands take them: --teleop.device=tablet and so on."""

from dataclasses import dataclass

from lerobot.robots.config import RobotConfig
from lerobot.teleoperators.config import TeleoperatorConfig


@TeleoperatorConfig.register_subclass("hand_sandbox")
@dataclass(kw_only=True)
class HandSandboxConfig(TeleoperatorConfig):
    """Options of the teleoperator.

    Attributes:
        device: `tablet`, `page`, `webcam`, or a device or file of `sandbox run --device`.
        robot: The robot's hand that follows, as for `sandbox run --robot`; empty: a person's.
        task: The task whose table is touched.
        patience: s within which somebody has to open the page.
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
        hand: As `robot` of the teleoperator that moves it.
    """

    hand: str = ""
