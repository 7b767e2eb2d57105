"""Friction as felt: the force along the surface over the force into it.

A flat thing slides down the table, which is tilted until it does; and a heavy slab is drawn over
one link of the hand after the other.
"""

from __future__ import annotations

from math import atan, sqrt

import mujoco
import numpy as np

from models.hand import Hand
from models.objects import Box
from models.scene import TABLE, Scene, SceneSpec
from tasks.sensing import Sensing

STEEPER = 0.5
"""How much more than the written friction and the table's the table is tilted, as a tangent."""

TABLE_FRICTION = 0.5
"""That of the table, as in most tasks."""

PRESSED, SPEED = 0.0005, 0.02
"""m by which the slab is pressed against a link, and m/s at which it is drawn over it."""

SLIDES = 0.2
"""s that a thing slides, of which the second half is measured."""


def on_table(written: float, own: bool) -> float:
    """Friction felt by a thing that slides on the table.

    Args:
        written: Coefficient that the thing is made with.
        own: The thing's friction counts.
    """
    box = Box("thing", (0.03, 0.03, 0.01), 0.1, (0.0, 0.0, 0.01), friction=written)
    scene = Scene(SceneSpec((), (box,), TABLE_FRICTION, own_friction=own))
    model, data = scene.model, mujoco.MjData(scene.model)
    weight = float(np.linalg.norm(model.opt.gravity))
    angle = atan(max(written, TABLE_FRICTION) + STEEPER)
    model.opt.gravity[:] = weight * np.sin(angle), 0.0, -weight * np.cos(angle)
    return _felt(scene, data, box.name, TABLE)


def on_link(written: float, own: bool, part: int) -> float:
    """Friction felt by a slab that is drawn over a part of the hand.

    Args:
        written: Coefficient that the slab is made with.
        own: The slab's friction counts.
        part: Index into the hand's parts that can be solid.
    """
    hand = Hand(solid_palm=True)
    slab = Box("slab", (0.2, 0.2, 0.01), 1.0, (0.0, 0.0, 1.0), friction=written)
    scene = Scene(SceneSpec((hand,), (slab,), TABLE_FRICTION, own_friction=own))
    model, data = scene.model, mujoco.MjData(scene.model)
    pose = np.concatenate([[0.0, 0.0, 0.3], np.zeros(45)])
    data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, pose)
    data.ctrl[:] = hand.controls(pose)
    geom = scene.parts(0)[part]
    scene.set_solid_geoms(0, {geom})
    model.opt.gravity[:] = 0.0
    mujoco.mj_forward(model, data)
    top = _top(model, data, geom)
    x, y = data.geom_xpos[geom][:2].tolist()
    at, dof = (int(adr[0]) for adr in (model.joint("slab").qposadr, model.joint("slab").dofadr))
    # Whatever pushes back, the slab keeps its height and its speed.
    sensing, forces = Sensing(scene, data), []
    steps = round(SLIDES / scene.spec.timestep)
    for step in range(steps):
        way = SPEED * step * scene.spec.timestep
        data.qpos[at : at + 7] = x + way, y, top - PRESSED + 0.01, 1.0, 0.0, 0.0, 0.0
        data.qvel[dof : dof + 6] = SPEED, 0.0, 0.0, 0.0, 0.0, 0.0
        mujoco.mj_step(model, data)
        if step >= steps // 2:
            forces.append(sensing.force("slab", hand.name).copy())
    return _ratio(np.mean(forces, axis=0))


def parts() -> tuple[str, ...]:
    """Names of the hand's parts that can be solid, in the order of `on_link`."""
    scene = Scene(SceneSpec((Hand(solid_palm=True),)))
    return tuple(scene.model.geom(part).name or f"palm {part}" for part in scene.parts(0))


def _felt(scene: Scene, data: mujoco.MjData, name: str, other: str) -> float:
    """Mean force along the table over that into it, of a thing that slides."""
    sensing, forces = Sensing(scene, data), []
    steps = round(SLIDES / scene.spec.timestep)
    for step in range(steps):
        mujoco.mj_step(scene.model, data)
        if step >= steps // 2:
            forces.append(sensing.force(name, other).copy())
    return _ratio(np.mean(forces, axis=0))


def _ratio(force: np.ndarray) -> float:
    """Horizontal over vertical part of a force (3,)."""
    x, y, z = force.tolist()
    return sqrt(x * x + y * y) / abs(z)


def _top(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> float:
    """Height in m of the highest point of a capsule or a box."""
    up = data.geom_xmat[geom].reshape(3, 3)[2]
    size = model.geom_size[geom]
    if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_CAPSULE:
        above = size[0] + abs(up[2]) * size[1]
    elif model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_SPHERE:
        above = size[0]
    else:
        above = float(np.abs(up) @ size)
    return float(data.geom_xpos[geom][2] + above)
