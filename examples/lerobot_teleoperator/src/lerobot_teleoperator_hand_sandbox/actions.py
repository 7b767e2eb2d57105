"""Actions: the numbers of a hand by their names."""

from models.arithmetic import Array
from models.pose import JOINTS, ROOT_POSITION, ROOT_ROTATION
from models.robot.mapping import find_robot
from models.robot.robot_hand import RobotHand
from models.rotations import quaternion_exp
from models.skeleton import ADULT

PALM = tuple(f"palm.{axis}" for axis in ("x", "y", "z", "qw", "qx", "qy", "qz"))
"""Place of the palm in the world: m, and a unit quaternion."""


class HandActions:
    """Turns poses of a person's hand into actions.

    Args:
        robot: The robot whose hand it is; empty: the person's own.

    Attributes:
        names: Names of an action's numbers, in order.

    Raises:
        InputError: There is no such hand.
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
        """The action for a pose (48,) of the person's hand."""
        if self._follow is not None:
            numbers = self._follow(pose).tolist()
        else:
            turn = quaternion_exp(pose[ROOT_ROTATION])
            numbers = [*pose[ROOT_POSITION].tolist(), *turn.tolist(), *pose[JOINTS].tolist()]
        return dict(zip(self.names, numbers, strict=True))
