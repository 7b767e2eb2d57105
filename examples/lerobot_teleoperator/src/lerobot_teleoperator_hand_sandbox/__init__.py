"""A hand on a tablet, before a webcam or in a recording, as a teleoperator of LeRobot."""

from .config_hand_sandbox import HandSandboxConfig, HandSandboxDummyConfig
from .dummy import HandSandboxDummy
from .teleoperator import HandSandbox

__all__ = ["HandSandbox", "HandSandboxConfig", "HandSandboxDummy", "HandSandboxDummyConfig"]
