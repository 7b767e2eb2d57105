"""Films of the rendered hand over a tablet, seen by a camera that stands over it, with the truth.

A simulated person (`encoders.captures.paired.simulated`) touches a tablet; the hand is drawn with
its skin and the person's own bones, and the camera's page finds it in Chromium. Nothing of this is
of a person.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from math import radians, tan
from typing import Any

import mujoco
import numpy as np
from PIL import Image

from benchmarks.picture_stream import SIZE
from encoders.webcam.camera import Camera
from models.arithmetic.arrays import Array
from models.hand import Hand
from models.pose import ROOT_POSITION
from models.scene import Scene, SceneSpec
from models.skeleton import Skeleton
from models.surface import Surface
from sandbox.views.graphics import offscreen_context, render_context
from sandbox.views.hand_look import HIDDEN_GROUP, skinned_model

MIDDLE = (0.0, -0.04, 0.0)
"""m, what the camera looks at: the tablet is in the middle of the table, the wrist before it."""
_RIM = 0.012
_BODY, _SCREEN = (0.06, 0.06, 0.07, 1.0), (0.30, 0.38, 0.46, 1.0)


def overhead(tilt: float, distance: float, view: float, pan: float = 0.0) -> Camera:
    """A camera over the tablet that looks at the middle of what happens there."""
    away = distance * Camera(view, tilt=tilt, roll=180.0, pan=pan).axes[2]
    x, y, z = (np.array(MIDDLE) - away).tolist()
    return Camera(view, (x, y, z), tilt, 180.0, pan)


CAMERAS = {
    "above": overhead(90.0, 0.50, 60.0),
    "leaning": overhead(65.0, 0.55, 60.0),
    "turned": overhead(72.0, 0.45, 70.0, 25.0),
}
"""Straight above; leaning by 25 degrees; leaning by 18 degrees, and turned by 25."""


class Drawer:
    """Draws poses of one person's hand over a tablet."""

    def __init__(
        self,
        scene: Scene,
        model: mujoco.MjModel,
        gl: Any,
        context: Any,
        surface: Surface,
        camera: Camera,
    ) -> None:
        self._scene, self._model, self._gl, self._context = scene, model, gl, context
        self._surface, self._camera = surface, camera
        self._data, self._view = mujoco.MjData(model), mujoco.MjvCamera()
        self._option = mujoco.MjvOption()
        self._option.geomgroup[HIDDEN_GROUP:] = 0
        self._drawn = mujoco.MjvScene(model, 2000)

    def picture(self, q: Array) -> bytes:
        """JPEG of a pose (48,) in the surface frame."""
        pose = q.copy()
        pose[ROOT_POSITION] += self._surface.corner
        drawn, (width, height) = self._drawn, SIZE
        self._data.qpos[self._scene.qpos_slice(0)] = self._scene.pose_to_qpos(0, pose)
        mujoco.mj_forward(self._model, self._data)
        every = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(
            self._model, self._data, self._option, None, self._view, every, drawn
        )
        self._tablet()
        for eye in drawn.camera:
            point(eye, self._camera)
        pixels = np.empty((height, width, 3), np.uint8)
        whole = mujoco.MjrRect(0, 0, width, height)
        with self._gl.as_current():
            mujoco.mjr_render(whole, drawn, self._context)
            mujoco.mjr_readPixels(pixels, None, whole, self._context)
        data = io.BytesIO()
        Image.fromarray(pixels[::-1]).save(data, "JPEG", quality=92)
        return data.getvalue()

    def _tablet(self) -> None:
        w, h = self._surface.size / 2.0
        boxes = (((w + _RIM, h + _RIM, 0.001), -0.0005, _BODY), ((w, h, 0.001), 0.0, _SCREEN))
        for size, z, colour in boxes:
            geom = self._drawn.geoms[self._drawn.ngeom]
            box = mujoco.mjtGeom.mjGEOM_BOX
            turn = np.eye(3).ravel()
            mujoco.mjv_initGeom(
                geom, box, np.array(size), np.array([0.0, 0.0, z]), turn, np.array(colour, "f")
            )
            self._drawn.ngeom += 1


def point(eye: Any, camera: Camera) -> None:
    """Puts one of MuJoCo's OpenGL cameras where a camera is."""
    width, height = SIZE
    _, down, away = camera.axes
    eye.pos[:], eye.forward[:], eye.up[:] = camera.at, away, -down
    half = tan(radians(camera.view / 2.0)) * eye.frustum_near
    eye.frustum_center, eye.frustum_width = 0.0, half
    eye.frustum_top, eye.frustum_bottom = half * height / width, -half * height / width


@contextmanager
def drawer(skeleton: Skeleton, surface: Surface, camera: Camera) -> Iterator[Drawer]:
    """What draws one person's right hand over a tablet in the middle of the table."""
    scene = Scene(SceneSpec((Hand("right", skeleton),)))
    model, _ = skinned_model(scene)
    model.vis.global_.offwidth, model.vis.global_.offheight = SIZE
    gl = offscreen_context(*SIZE)
    try:
        with render_context(model, gl) as context:
            yield Drawer(scene, model, gl, context, surface.centred_at((0.0, 0.0, 0.0)), camera)
    finally:
        gl.free()
