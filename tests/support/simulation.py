"""Helpers for tests of the simulation: poses, steps without a warning, and a pinch."""

from __future__ import annotations

import mujoco
import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from benchmarks.pinch import pinch_poses
from models.arithmetic import Array
from models.hand import Hand
from models.objects import Box
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT

TIMESTEPS = (0.001, 0.002, 0.004)
"""s, all of them whole parts of the control period."""

CUBE = Box("box", (0.025, 0.025, 0.025), 0.15, (0.0, 0.0, 0.025), 0.3)

LOWEST = np.concatenate([[-0.2, -0.2, 0.05, -1.5, -1.5, -1.5], ADULT.lower])
HIGHEST = np.concatenate([[0.2, 0.2, 0.30, 1.5, 1.5, 1.5], ADULT.upper])
"""(48,) bounds of the poses below: all that is legal, at places over a table."""


def pose_at(shares: Array) -> Array:
    """The legal pose (48,) a share 0 to 1 (48,) of the way through every range."""
    return LOWEST + shares * (HIGHEST - LOWEST)


def random_pose(rng: np.random.Generator) -> Array:
    return pose_at(rng.uniform(size=48))


legal_poses: st.SearchStrategy[Array] = hnp.arrays(float, 48, elements=st.floats(0.0, 1.0)).map(
    pose_at
)


def no_warning(data: mujoco.MjData) -> None:
    """Fails if MuJoCo had anything to complain of since the data were made."""
    told = {
        str(kind): data.warning[kind].number
        for kind in mujoco.mjtWarning.__members__.values()
        if kind is not mujoco.mjtWarning.mjNWARNING and data.warning[kind].number
    }
    assert not told


def run(scene: Scene, data: mujoco.MjData, seconds: float) -> None:
    """Steps on; a warning fails the test."""
    mujoco.mj_step(scene.model, data, round(seconds / scene.spec.timestep))
    no_warning(data)


def put(scene: Scene, data: mujoco.MjData, q: Array, hand: int = 0) -> None:
    """A hand at a pose (48,), at rest and with its servos there."""
    data.qpos[scene.qpos_slice(hand)] = scene.pose_to_qpos(hand, q)
    data.ctrl[scene.control_slice(hand)] = q


def pinched(
    box: Box = CUBE, timestep: float = 0.002, servo: str = "orientation"
) -> tuple[Scene, mujoco.MjData, Array]:
    """A box on the table between two solid fingertips, and the closed pose (48,)."""
    scene = Scene(SceneSpec((Hand(servo=servo),), (box,), timestep=timestep))
    data = mujoco.MjData(scene.model)
    opened, closed = pinch_poses(box)
    put(scene, data, opened)
    scene.set_solid(0, frozenset({0, 1}))
    run(scene, data, 0.1)
    for share in np.linspace(0.0, 1.0, 20):
        data.ctrl[scene.control_slice(0)] = opened + share * (closed - opened)
        run(scene, data, scene.spec.timestep * scene.substeps)
    return scene, data, closed
