"""Skinning weights by heat diffusion from the bones into the skin.

Every vertex is attached to its nearest bone. Diffusion along the surface then blends the weights of
neighbouring bones. Since heat does not flow through air, a finger never pulls its neighbour's skin.
The method is the heat equilibrium of Baran and Popovic, "Automatic Rigging and Animation of 3D
Characters" (2007). In contrast to their method, the nearest bone is searched in the same finger,
and need not be visible from the vertex.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import splu

from models.arithmetic import Array
from models.pose import JOINTS, POSE_SIZE
from models.skeleton import Skeleton
from models.skin.skin import BONES, FULL, frames, motions
from training.skin.field import HandField
from training.skin.shapes import step

COLLAPSED = 0.01
"""A triangle whose area shrinks below this share counts as folded."""
MOST = 4
"""Largest number of bones per vertex."""
STIFFNESS = 0.18
"""Strength of a vertex's attachment to its nearest bone. Stiffer skin keeps more volume in a fist,
but folds at joints (see `folds`)."""
TIP_STIFFNESS, TIP = 4.0, (0.15, 0.55)
"""Stiffness of fingertips, which have rigid nails, and the range along the last bone, in shares of
its length, over which the stiffness grows to this value."""
WEB_EDGE = (0.0100, 0.0135)
"""Range of the distance (m) from the axis of a web's edge over which the skin gradually ceases to
belong to the web."""
WEB_FINGER = 0.042
"""Length (m) of a first bone below which the webs beside it are smaller."""
WEB_SHARES, THUMB_WEB_SHARES = (0.32, 0.34, 0.34), (0.45, 0.55, 0.0)
"""Weights of the palm and of the fingers on both sides, in a web between fingers and in that of the
thumb."""
WEB_LENGTH = 0.3
"""Share of a web's length that belongs to neither finger."""
WEB_HOLD = 0.0045
"""Largest assumed distance (m) of a web's edge from its bones. It is small, so that the edge moves
as one piece."""


def weights_of(
    field: HandField, vertices: Array, triangles: NDArray[np.int64]
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Bones (n, 4) of vertices (n, 3) m in the zero pose, and their weights (n, 4), integers that
    sum to 255.

    Bone 0 is the palm. Unused entries contain bone 0 with weight 0.
    """
    owner, distance, stiffness = _owners(field, vertices)
    flow, area = cotangents(vertices, triangles)
    hold = area * stiffness / np.maximum(distance, 1e-3) ** 2
    shares = splu((flow + diags(hold)).tocsc()).solve(owner * hold[:, None])
    return strongest(np.clip(shares, 0.0, None))


def random_poses(skeleton: Skeleton, count: int, seed: int) -> Array:
    """Random legal poses (count, 48) at the origin, with uniformly distributed angles."""
    rng = np.random.default_rng(seed)
    q = np.zeros((count, POSE_SIZE))
    q[:, JOINTS] = rng.uniform(skeleton.lower, skeleton.upper, (count, len(skeleton.lower)))
    return q


def folds(
    skeleton: Skeleton, rest: Array, triangles: NDArray[np.int64], shares: Array, poses: Array
) -> NDArray[np.bool_]:
    """Booleans (p, m), true for triangles that are folded over in poses (p, 48).

    A folded triangle faces away from the direction that follows from the mean rotation of its
    bones, or its area has shrunk below the share `COLLAPSED`.
    """
    before = _cross(rest, triangles)
    size = np.linalg.norm(before, axis=1)
    blend = shares[triangles].mean(axis=1)
    here, turn = frames(skeleton, np.zeros(POSE_SIZE))
    out = np.zeros((len(poses), len(triangles)), bool)
    for i, q in enumerate(poses):
        moves = motions(here, turn, *frames(skeleton, q))
        placed = (shares @ moves.reshape(BONES, 12)).reshape(-1, 3, 4)
        after = _cross(np.einsum("nij,nj->ni", placed[..., :3], rest) + placed[..., 3], triangles)
        turned = (blend @ moves[..., :3].reshape(BONES, 9)).reshape(-1, 3, 3)
        wanted = np.einsum("nij,nj->ni", turned, before)
        out[i] = np.sum(after * wanted, axis=1) <= 0.0
        out[i] |= np.linalg.norm(after, axis=1) < COLLAPSED * size
    return out


def _cross(vertices: Array, triangles: NDArray[np.int64]) -> Array:
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return np.cross(b - a, c - a)


def strongest(shares: Array) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """The four largest weights of each row of weights (n, 15), the largest first.

    Returns:
        Bones (n, 4), and their weights (n, 4), integers that sum to 255.
    """
    order = np.argsort(-shares, axis=1, kind="stable")[:, :MOST]
    # Subtracting the fifth weight keeps the skin smooth where the fourth bone changes.
    fifth = np.sort(shares, axis=1)[:, -MOST - 1]
    kept = np.clip(np.take_along_axis(shares, order, axis=1) - fifth[:, None], 0.0, None)
    kept /= kept.sum(axis=1, keepdims=True)
    weights = np.round(FULL * kept).astype(int)
    # The largest weight gets the rounding error of all.
    weights[:, 0] += FULL - weights.sum(axis=1)
    return np.where(weights > 0, order, 0).astype(np.uint8), weights.astype(np.uint8)


def _nearest(field: HandField, vertices: Array) -> tuple[NDArray[np.int64], Array]:
    """Nearest bone of each vertex, and the vertex's distance (m) from the bone's axis."""
    _, fingers = field.parts(vertices)
    finger = np.argmin(np.stack(fingers), axis=0)
    distances = np.full((len(vertices), BONES), np.inf)
    distances[:, 0] = np.min([_to_segment(vertices, a, b) for a, b in _palm_bones(field)], axis=0)
    for i, (limb, bone) in enumerate(zip(field.limbs, field.skeleton.bones, strict=True)):
        away = _to_segment(vertices, limb.at(0, 0, 0), limb.at(0, 1, 0))
        distances[:, i + 1] = np.where(finger == bone.finger, away, np.inf)
    # Flesh over a thick bone is far from its axis but still belongs to it.
    thick = np.array([field.skeleton.palm_radius * 1.2, *(b.radius for b in field.skeleton.bones)])
    nearest = np.argmin(distances - thick, axis=1)
    return nearest, distances[np.arange(len(vertices)), nearest]


def _owners(field: HandField, vertices: Array) -> tuple[Array, Array, Array]:
    """Initial weights (n, 15) that sum to one, distances (n,) m and stiffnesses (n,) of vertices.

    The edge of a web belongs to the palm and to the fingers beside it. So relative movements of two
    fingers stretch the skin along their sides, where there is more skin than on the edge.
    """
    nearest, distance = _nearest(field, vertices)
    owner = np.eye(BONES)[nearest]
    first = [1 + int(i) for i in field.skeleton.first_bone]
    web = np.zeros(len(vertices))
    for start, end, (a, b) in field.webs():
        size = min(1.0, field.fingers[b][0].length / WEB_FINGER)
        middle, half = (start + end) / 2, WEB_LENGTH * (end - start) / 2
        share = 1.0 - step(
            _to_segment(vertices, middle - half, middle + half), *(size * np.array(WEB_EDGE))
        )
        mix = np.zeros(BONES)
        mix[[0, first[a], first[b]]] = WEB_SHARES if a > 0 else THUMB_WEB_SHARES
        owner += share[:, None] * (mix - owner)
        web = np.maximum(web, share)
    tip = np.zeros(len(vertices))
    for chain in field.fingers:
        last = chain[-1]
        along = last.local(vertices)[:, 1] / last.length
        bone = 1 + next(i for i, limb in enumerate(field.limbs) if limb is last)
        tip = np.where(nearest == bone, step(along, *TIP), tip)
    stiffness = STIFFNESS * (TIP_STIFFNESS / STIFFNESS) ** tip
    return owner, distance + web * (np.minimum(distance, WEB_HOLD) - distance), stiffness


def _palm_bones(field: HandField) -> list[tuple[Array, Array]]:
    rays = [(np.array([0.6 * k[0], 0.010, -0.004]), k) for k in field.knuckles[1:]]
    wrist = np.array([0.0, 0.0, -0.004])
    across = np.array([0.014, 0.0, 0.0])
    middle = wrist - np.array([0.0, 0.01, 0.0])
    forearm = wrist, wrist - np.array([0.0, 0.08, 0.0])
    return [*rays, forearm, (middle - across, middle + across)]


def _to_segment(p: Array, a: Array, b: Array) -> Array:
    along = b - a
    t = np.clip((p - a) @ along / (along @ along), 0.0, 1.0)
    return np.linalg.norm(p - a - t[:, None] * along, axis=1)


def cotangents(vertices: Array, triangles: NDArray[np.int64]) -> tuple[csr_matrix, Array]:
    """The surface's Laplacian (n, n), positive semidefinite, and each vertex's area (n,) m2."""
    n, p = len(vertices), vertices[triangles]
    rows, columns, values = [], [], []
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        a, b = p[:, j] - p[:, i], p[:, k] - p[:, i]
        cross = np.maximum(np.linalg.norm(np.cross(a, b), axis=1), 1e-12)
        # Very obtuse corners would give negative conductances.
        half = np.clip(0.5 * np.sum(a * b, axis=1) / cross, 1e-3, 1e3)
        rows += [triangles[:, j], triangles[:, k]]
        columns += [triangles[:, k], triangles[:, j]]
        values += [half, half]
    flow = csr_matrix(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(n, n)
    )
    thirds = np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1) / 6.0
    area: Array = np.zeros(n)
    np.add.at(area, triangles.ravel(), np.repeat(thirds, 3))
    return diags(np.asarray(flow.sum(axis=1)).ravel()) - flow, area
