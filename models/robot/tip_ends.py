"""Ends of fingers whose models do not name them, from the meshes of their last links.

Many models have no site at a fingertip: a finger ends with a body that begins at its last joint.
Where its mesh is farthest from that joint, it is taken as round; the fingertip is the middle of
this round end.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import mujoco
import numpy as np

from models.arithmetic import Array
from models.errors import InputError
from models.rotations import quaternion_to_matrix

SLICE = 0.006
"""m, length of the part of a link that counts as its end."""


class TipEnd(NamedTuple):
    """The round end of a link.

    Attributes:
        place: (3,) m, its middle in the frame of the link's body.
        radius: m, half of its least width.
    """

    place: tuple[float, float, float]
    radius: float


def tip_ends(model: Any, bodies: Iterable[str]) -> list[TipEnd]:
    """Ends of links, as far from the origins of their bodies as their meshes go.

    Args:
        model: MuJoCo's model of the robot.
        bodies: Names of the bodies of the last links.

    Raises:
        InputError: There is no such body, or it has no mesh.
    """
    return [_end(model, name) for name in bodies]


def _end(model: Any, name: str) -> TipEnd:
    body = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name))
    points = _points(model, body) if body >= 0 else np.zeros((0, 3))
    if not len(points):
        raise InputError(
            "this robot has no body of this name with a mesh, whose end would be a fingertip",
            where="--tips",
            got=name,
            remedy="Name sites at the fingertips, and leave --ends out",
        )
    far = points[np.argmax(np.sum(points * points, axis=1))]
    # The end may be cut off askew: its direction is that of all points near it.
    along = np.mean(_last(points, far), axis=0)
    along /= np.sqrt(np.sum(along * along))
    last = _last(points, along)
    height = last @ along
    across = last - height[:, None] * along
    middle = 0.5 * (across.min(axis=0) + across.max(axis=0))
    ways = np.linalg.svd(across - middle, full_matrices=False)[2][:2]
    radius = 0.5 * min(float(np.ptp(across @ way)) for way in ways)
    x, y, z = (round(float(v), 5) for v in middle + (height.max() - radius) * along)
    return TipEnd((x, y, z), round(radius, 5))


def _last(points: Array, along: Array) -> Array:
    """Points within the last part of a link in a direction."""
    height = points @ (along / np.sqrt(np.sum(along * along)))
    return points[height > height.max() - SLICE]


def _points(model: Any, body: int) -> Array:
    """(n, 3) m, points of a body's meshes in its frame."""
    out = [np.zeros((0, 3))]
    for geom in np.flatnonzero(model.geom_bodyid == body):
        mesh = int(model.geom_dataid[geom])
        if int(model.geom_type[geom]) == int(mujoco.mjtGeom.mjGEOM_MESH):
            start = int(model.mesh_vertadr[mesh])
            points = model.mesh_vert[start : start + int(model.mesh_vertnum[mesh])]
            turn = quaternion_to_matrix(model.geom_quat[geom])
            out.append(points @ turn.T + model.geom_pos[geom])
    return np.concatenate(out)
