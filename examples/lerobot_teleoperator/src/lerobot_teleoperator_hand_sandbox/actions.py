"""Actions: named numbers that describe the pose of a hand."""

from models.arithmetic import Array
from models.pose import JOINTS, ROOT_POSITION, ROOT_ROTATION
from models.robot.mapping import find_robot
from models.robot.robot_hand import RobotHand
from models.rotations import quaternion_exp
from models.skeleton import ADULT

PALM = tuple(f"palm.{axis}" for axis in ("x", "y", "z", "qw", "qx", "qy", "qz"))
"""Names of the palm's position (m) and rotation (unit quaternion) in the world."""


class HandActions:
    """Turns poses of a person's hand into actions.

    Args:
        robot: Name of the robot hand. Empty: a person's hand.

    Attributes:
        names: Names of the numbers of an action, in order.

    Raises:
        InputError: `robot` is not a known robot hand.
    """

    def __init__(self, robot: str) -> None:
        self._follow = None
        if robot:
            hand = RobotHand("lerobot", find_robot(robot))
            self._follow = hand.retargeter().follow
            joints = [f"{name}.pos" for name in hand.robot.joint_names()]
        else:
            joints = [f"{bone.name}.{axis}" for bone in ADULT.bones for axis in "xyz"]
        self.names = (*PALM, *joints)

    def action(self, pose: Array) -> dict[str, float]:
        """Returns the action for a pose (48,) of a person's hand: name -> number."""
        if self._follow is not None:
            numbers = self._follow(pose).tolist()
        else:
            turn = quaternion_exp(pose[ROOT_ROTATION])
            numbers = [*pose[ROOT_POSITION].tolist(), *turn.tolist(), *pose[JOINTS].tolist()]
        return dict(zip(self.names, numbers, strict=True))
