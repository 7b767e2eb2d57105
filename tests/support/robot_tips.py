"""How far a robot's hand in a scene is from its own model."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from models.frames import FINGERS
from models.robot.mapping import coefficients
from models.robot.robot_hand import RobotHand


def greatest_distance(hand: RobotHand, count: int) -> float:
    """m, between fingertips in the robot's own model and in the scene's, at equal random angles."""
    robot, ours = hand.robot, hand.kinematic
    own, here = mujoco.MjData(robot.model), mujoco.MjData(ours)
    low, high = robot.limits().T
    rng = np.random.default_rng(0)
    apart = 0.0
    for _ in range(count):
        angles = rng.uniform(low, high)
        own.qpos[robot.model.jnt_qposadr[robot.joints]] = angles
        here.qpos[7:] = angles
        mujoco.mj_kinematics(robot.model, own)
        mujoco.mj_kinematics(ours, here)
        palm, turn = own.xpos[robot.palm], own.xmat[robot.palm].reshape(3, 3)
        our_palm = here.body(hand.palm)
        for finger, (body, place) in enumerate(robot.tips):
            tip = own.xpos[body] + own.xmat[body].reshape(3, 3) @ np.array(place)
            ours_tip = here.site(FINGERS[finger]).xpos - our_palm.xpos
            difference = turn.T @ (tip - palm) - our_palm.xmat.reshape(3, 3).T @ ours_tip
            apart = max(apart, float(np.abs(difference).max()))
    return apart


def greatest_break(hand: RobotHand, count: int) -> float:
    """rad, of the equalities of joints in the robot's own model, at random angles that are coupled
    as in the scene."""
    robot = hand.robot
    names = robot.joint_names()
    joints = {name: robot.joints[names.index(name)] for name in names}
    data = mujoco.MjData(robot.model)
    low, high = robot.limits().T
    rng = np.random.default_rng(0)
    apart = 0.0
    for _ in range(count):
        angles = dict(zip(names, rng.uniform(low, high), strict=True))
        for name, (other, law) in hand.mapping.coupled.items():
            angles[name] = float(np.polynomial.Polynomial(coefficients(law))(angles[other]))
        for name, angle in angles.items():
            data.qpos[robot.model.jnt_qposadr[joints[name]]] = angle
        apart = max(
            apart, *(abs(e) for e in _residuals(robot.model, data, set(joints.values()))), 0.0
        )
    return apart


def _residuals(model: Any, data: Any, joints: set[int]) -> list[float]:
    """rad, of the equalities of two of these joints, as MuJoCo states them."""
    found = []
    for e in np.flatnonzero(model.eq_type == int(mujoco.mjtEq.mjEQ_JOINT)):
        one, two = int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
        if not {one, two} <= joints or not model.eq_active0[e]:
            continue
        at = [int(model.jnt_qposadr[j]) for j in (one, two)]
        y, x = (float(data.qpos[i] - model.qpos0[i]) for i in at)
        found.append(y - float(np.polynomial.Polynomial(model.eq_data[e, :5])(x)))
    return found
