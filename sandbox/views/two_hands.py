"""A picture of a person's hand and a robot's hand beside it, in the same poses."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
from PIL import Image

from models.errors import InputError
from models.hand import Hand
from models.pose import JOINTS, POSE_SIZE
from models.robot.mapping import RobotMapping
from models.robot.robot_hand import RobotHand
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.session.messages import HandView, Snapshot
from sandbox.views.renderer import Renderer

SIZE = (480, 320)
"""px of each pose."""
APART = 0.11
"""m, each hand from the middle."""
ABOVE = 0.10
"""m, palms above the table."""
BENT = (0.15, 0.5, 0.8)
"""Shares of the range of flexion."""


def _camera() -> mujoco.MjvCamera:
    """From behind the wrists, and from above."""
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.lookat[:] = (0.0, 0.03, ABOVE)
    camera.azimuth, camera.elevation, camera.distance = 90.0, -35.0, 0.52
    return camera


def draw_beside(mapping: RobotMapping, picture: Path) -> None:
    """Draws both hands, open, half closed and closed.

    Raises:
        GraphicsError: This machine has no OpenGL.
        InputError: The file cannot be written.
    """
    person = ADULT if mapping.side == "right" else ADULT.mirrored()
    hands = Hand("person", person), RobotHand("robot", mapping, person)
    scene = Scene(SceneSpec(hands))
    surface = Surface().centred_at((0.0, 0.0, 0.0))
    pictures = []
    with Renderer(scene, surface, SIZE, camera=_camera()) as renderer:
        for share in BENT:
            qpos, views = np.zeros(scene.model.nq), []
            for i, side in enumerate((-APART, APART)):
                q = np.zeros(POSE_SIZE)
                q[:3] = side, -0.05, ABOVE
                q[JOINTS][::3] = (person.upper + share * (person.lower - person.upper))[::3]
                qpos[scene.qpos_slice(i)] = scene.pose_to_qpos(i, q)
                tips = hands[i].tips_of()(q)
                fingers = frozenset(link.finger for link in hands[i].links)
                views.append(HandView(q, tips, fingers, "down", ()))
            shot = Snapshot(0.0, 0, qpos).with_hands(*views)
            pictures.append(np.asarray(renderer.without_texts(shot)))
    try:
        Image.fromarray(np.hstack(pictures)).save(picture)
    except (OSError, ValueError) as error:
        raise InputError("it cannot be written", where=str(picture), got=str(error)) from None
