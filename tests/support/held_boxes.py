"""How still a held box is: how far it creeps in five seconds, and how fast it trembles.

A box is closed on by thumb and index, or thumb, index and middle finger, lifted by 5 cm and held by
a pose that does not change. Creep is how far its middle has moved at the end of the hold; jitter is
the root mean square of its speed meanwhile, at every physics step.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from benchmarks.pinch import COMFORTABLE_AXIS, GUESS_COVARIANCE
from encoders.correction import FingertipCorrection
from models.arithmetic import Array
from models.hand import Hand, finger_armature
from models.kinematics import Kinematics
from models.objects import Box
from models.scene import CONTROL_PERIOD, Scene, SceneSpec
from models.skeleton import ADULT
from sandbox.session.collision_gating import ContactMode, ContactModes

CREEP, JITTER = 0.2e-3, 0.1e-3
"""m in 5 s and m/s, below which a grasp feels still."""

LIFT, HOLD, SETTLE = 0.05, 5.0, 1.0
"""m, s and s."""

APART = 0.011
"""m from the middle of a face to each of two fingertips on it."""

OPENING, SQUEEZE = 0.006, 0.0035
"""m outside and inside a face; the simulated user squeezes as much."""


@dataclass(frozen=True)
class Stillness:
    """Stillness of a held box.

    Attributes:
        creep: m from where it was when the hold began.
        jitter: m/s, root mean square of its speed.
        held: It was still up at the end.
    """

    creep: float
    jitter: float
    held: bool


def grasp(box: Box, fingers: int, opening: float) -> Array:
    """Pose (48,) of a right hand whose fingertips are beside a box's faces.

    Args:
        box: Where it is at the start.
        fingers: 2: thumb and index; 3: the middle finger beside the index.
        opening: m from fingertips to faces; negative squeezes.
    """
    correction = FingertipCorrection(ADULT, GUESS_COVARIANCE)
    labels = list(range(fingers))
    along = np.array([np.cos(box.yaw), np.sin(box.yaw), 0.0])
    across = np.array([-along[1], along[0], 0.0])
    reach = box.half_size[0] + opening + ADULT.tip_radius[labels]
    sides = np.where(np.array(labels) == 0, -1.0, 1.0)
    spread = np.zeros(fingers) if fingers == 2 else APART * np.array([0.0, 1.0, -1.0])
    targets = np.asarray(box.position) + np.outer(sides * reach, along) + np.outer(spread, across)
    guess = np.zeros(48)
    guess[5] = box.yaw - COMFORTABLE_AXIS
    tips = Kinematics(ADULT).tips(guess)[labels]
    guess[:3] = (
        targets[0] / 2 + targets[1:].mean(axis=0) / 2 - (tips[0] + tips[1:].mean(axis=0)) / 2
    )
    return correction.correct(guess, labels, targets).q


def hold(
    box: Box,
    fingers: int,
    servo: str,
    impulse: float,
    mode: ContactMode = ContactMode.HARD,
) -> Stillness:
    """Grasps, lifts and holds a box."""
    hand = Hand(servo=servo, impulse=impulse, finger_armature=finger_armature(impulse))
    scene = Scene(SceneSpec((hand,), (box,)))
    ContactModes(scene, mode)
    model, data = scene.model, mujoco.MjData(scene.model)
    opened, closed = (grasp(box, fingers, gap) for gap in (OPENING, -SQUEEZE))
    up = LIFT * np.eye(48)[2]
    data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, opened)
    scene.set_solid(0, frozenset(range(fingers)))
    ways = (
        (opened, opened, 0.1),
        (opened, closed, 0.4),
        (closed, closed + up, 0.5),
        (closed + up, closed + up, SETTLE),
    )
    for start, end, seconds in ways:
        for share in np.linspace(0.0, 1.0, round(seconds / CONTROL_PERIOD)):
            data.ctrl[:] = start + share * (end - start)
            mujoco.mj_step(model, data, scene.substeps)
    mujoco.mj_forward(model, data)
    position, _ = scene.object_pose(data, box.name)
    speed = int(model.joint(box.name).dofadr[0])
    squares = 0.0
    steps = round(HOLD / scene.spec.timestep)
    for _ in range(steps):
        mujoco.mj_step(model, data)
        squares += float(np.sum(data.qvel[speed : speed + 3] ** 2))
    mujoco.mj_forward(model, data)
    end, _ = scene.object_pose(data, box.name)
    return Stillness(
        float(np.linalg.norm(end - position)),
        float(np.sqrt(squares / steps)),
        bool(end[2] > box.half_size[2] + 0.5 * LIFT),
    )


def boxes(count: int) -> list[Box]:
    """Boxes of 40 to 60 mm and 50 to 250 g, turned by up to 17 degrees; the same every time."""
    rng = np.random.default_rng(4_002)
    found = []
    for _ in range(count):
        half = float(rng.uniform(0.020, 0.030))
        mass, yaw = float(rng.uniform(0.05, 0.25)), float(rng.uniform(-0.3, 0.3))
        found.append(Box("box", (half, half, half), mass, (0.0, 0.0, half), yaw))
    return found
