"""The hand's encoder on a whole body: all joints of a body from hands and feet alone.

The paper of 2015 ends with this suggestion. Here the same quadratic encoder learns from where hands
and feet are, and from which of them touch the floor, how the whole body is posed.

    python examples/body.py --out body.png                # a simulated humanoid
    python examples/body.py --data DIR --out body.png     # a captured backflip

The humanoid is MuJoCo's, from the package gymnasium (pip install 'hand-sandbox[gym]'). It crouches,
steps, leans, twists and reaches, each by a smooth random course that moves several joints together,
and its lowest point is on the floor: movements of a program, not of a person. Whole takes are held
out.

The backflip is one of the CMU motion capture database, which is not part of this repository: DIR
holds formats/backflip.amc and .asf. Short blocks of the flip are held out. They lie between blocks
that were learned, so this shows that the encoder carries over to another body, and not that it
knows any other flip.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path

import mujoco
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from encoders import LinearEncoder, QuadraticEncoder
from encoders.regression.training import RIDGES
from models.errors import InputError
from models.motion.asf import read_amc, read_asf
from models.motion.motion import Motion
from models.rotations import exp, geodesic_angle, log

Array = NDArray[np.float64]

ENDS = ("lhand", "rhand", "lfoot", "rfoot")
"""Bones of the captured body whose ends are the input."""

HUMANOID_ENDS = {
    "left_lower_arm": "left_hand",
    "right_lower_arm": "right_hand",
    "left_foot": "left_foot",
    "right_foot": "right_foot",
}
"""Bodies of the humanoid whose ends are the input, and the spheres at those ends."""

TAKES, SECONDS, RATE = 16, 6.0, 30.0
"""Number of takes of the humanoid, s of each, and pictures a second."""

FRAMES_OF_A_TAKE = round(SECONDS * RATE)

HZ = (0.1, 0.4)
"""Slowest and fastest of the three waves that a course is made of."""

MOVEMENTS: dict[str, dict[str, float]] = {
    "crouch": {
        "right_hip_y": -95,
        "left_hip_y": -95,
        "right_knee": -125,
        "left_knee": -125,
        "abdomen_y": -40,
    },
    "step": {"right_hip_y": -40, "left_hip_y": 15, "right_knee": -50, "right_hip_z": -15},
    "straddle": {"right_hip_x": -24, "left_hip_x": -24, "right_hip_z": -20, "left_hip_z": -20},
    "lean": {"abdomen_x": 32, "abdomen_y": -25},
    "twist": {"abdomen_z": 42, "right_shoulder1": 15, "left_shoulder1": 15},
    "reach right": {"right_shoulder1": -80, "right_shoulder2": 45, "right_elbow": -70},
    "reach left": {"left_shoulder1": 80, "left_shoulder2": -45, "left_elbow": -70},
}
"""Movement -> degrees by which it turns each joint at most."""

UP = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""Rotation from MuJoCo's world (z up, x forward) to that of recordings (y up, z forward)."""

ON_FLOOR = 0.08
"""m, height of an end below which it counts as touching."""

BLOCK = 10
"""Frames of a block, a twelfth of a second; every fourth block is held out."""


@dataclass(frozen=True)
class Body:
    """A motion as an encoder sees it.

    Attributes:
        motion: The recording.
        U: (T, 16) places of the four ends about their middle (m), then their contact flags.
        Q: (T, N) root's place about that middle (m), two columns of its rotation (a rotation vector
            would break off in a flip), and every joint's rotation vector (rad).
        middle: (T, 3) m, of the four ends.
        joints: Indices of the bones that turn.
    """

    motion: Motion
    U: Array
    Q: Array
    middle: Array
    joints: list[int]


def humanoid(seed: int = 0) -> Motion:
    """Takes of MuJoCo's humanoid whose joints follow smooth random courses, one after the other.

    Raises:
        InputError: The package that has the humanoid is not installed.
    """
    found = find_spec("gymnasium")
    if found is None or not found.submodule_search_locations:
        raise InputError(
            "the humanoid's model is missing", remedy="Install it: pip install 'hand-sandbox[gym]'"
        )
    place = Path(found.submodule_search_locations[0]) / "envs" / "mujoco" / "assets"
    model = mujoco.MjModel.from_xml_path(str(place / "humanoid.xml"))
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    hinges = [j for j in range(model.njnt) if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_HINGE]
    low, high = model.jnt_range[hinges].T
    joints = [model.joint(j).name for j in hinges]
    most = np.deg2rad([[m.get(joint, 0.0) for joint in joints] for m in MOVEMENTS.values()])
    places, turns = [], []
    time = np.arange(FRAMES_OF_A_TAKE) / RATE
    for _ in range(TAKES):
        size = (len(MOVEMENTS), 3, 1)
        hertz, phase = rng.uniform(*HZ, size), rng.uniform(0.0, 1.0, size)
        courses = 0.5 + 0.6 * np.sin(2 * np.pi * (hertz * time + phase)).mean(axis=1)
        for course in courses.T:
            data.qpos[:7] = 0.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0
            data.qpos[model.jnt_qposadr[hinges]] = np.clip(most.T @ course, low, high)
            mujoco.mj_kinematics(model, data)
            solid = data.geom_xpos[1:, 2] - model.geom_rbound[1:]
            data.xpos[1:, 2] -= solid.min()
            places.append(data.xpos[1:].copy())
            turns.append(data.xmat[1:].reshape(-1, 3, 3).copy())
    world = np.array(places) @ UP.T
    rotations = UP @ np.array(turns) @ UP.T
    names = tuple(model.body(b).name for b in range(1, model.nbody))
    parents = tuple(int(p) - 1 for p in model.body_parentid[1:])
    ends = np.full((len(names), 3), np.nan)
    for name in names:
        child = next((c for c, p in enumerate(parents) if p == names.index(name)), None)
        if name in HUMANOID_ENDS:
            ends[names.index(name)] = UP @ model.geom(HUMANOID_ENDS[name]).pos
        elif child is not None:
            ends[names.index(name)] = UP @ model.body_pos[child + 1]
    shifts, own = world.copy(), rotations.copy()
    for j, parent in enumerate(parents):
        if parent >= 0:
            above = rotations[:, parent].transpose(0, 2, 1)
            shifts[:, j] = (above @ (world[:, j] - world[:, parent])[..., None])[..., 0]
            own[:, j] = above @ rotations[:, j]
    return Motion(names, parents, shifts, own, ends, 1.0 / RATE)


def body_of(motion: Motion, names: Sequence[str] = ENDS) -> Body:
    """Inputs and outputs of a motion.

    Args:
        motion: The motion.
        names: Bones whose ends are the input.
    """
    placed = motion.place()
    ends = placed.ends[:, [motion.index(name) for name in names]]
    middle = ends.mean(axis=1)
    flags = (ends[..., 1] < ON_FLOOR).astype(float)
    U = np.concatenate([(ends - middle[:, None]).reshape(len(motion), -1), flags], axis=1)
    still = np.all(motion.rotations == motion.rotations[:1], axis=(0, 2, 3))
    joints = [j for j in range(1, len(motion.names)) if not still[j]]
    vectors = log(motion.rotations[:, joints]).reshape(len(motion), -1)
    columns = motion.rotations[:, 0, :, :2].reshape(len(motion), 6)
    Q = np.concatenate([motion.shifts[:, 0] - middle, columns, vectors], axis=1)
    return Body(motion, U, Q, middle, joints)


def motion_of(body: Body, Q: Array) -> Motion:
    """The motion that outputs (T, N) describe, of the same skeleton."""
    shifts, rotations = body.motion.shifts.copy(), body.motion.rotations.copy()
    shifts[:, 0] = Q[:, :3] + body.middle
    a, b = Q[:, 3:9].reshape(-1, 3, 2)[..., 0], Q[:, 3:9].reshape(-1, 3, 2)[..., 1]
    # What was learned column by column is made a rotation again.
    x = a / np.linalg.norm(a, axis=1, keepdims=True)
    y = b - np.sum(x * b, axis=1, keepdims=True) * x
    y /= np.linalg.norm(y, axis=1, keepdims=True)
    rotations[:, 0] = np.stack([x, y, np.cross(x, y)], axis=2)
    rotations[:, body.joints] = exp(Q[:, 9:].reshape(len(Q), -1, 3))
    return replace(body.motion, shifts=shifts, rotations=rotations)


def errors(body: Body, Q: Array, frames: NDArray[np.bool_]) -> tuple[float, float, float]:
    """Mean error of the root (cm), of joint angles (degrees) and of all joints' places (cm)."""
    true, predicted = body.Q[frames], Q[frames]
    root = 100 * np.linalg.norm(true[:, :3] - predicted[:, :3], axis=1).mean()
    angle = geodesic_angle(true[:, 9:].reshape(-1, 3), predicted[:, 9:].reshape(-1, 3))
    places = body.motion.place().positions - motion_of(body, Q).place().positions
    joints = 100 * np.linalg.norm(places[frames], axis=2).mean()
    return float(root), float(np.rad2deg(angle).mean()), float(joints)


def chosen_ridge(
    kind: type[LinearEncoder] | type[QuadraticEncoder], U: Array, Q: Array, block_size: int
) -> float:
    """The penalty, of those tried for the hand, that does best on blocks left out in turn.

    Columns count by their spread.
    """
    block = np.arange(len(U)) // block_size % 5
    spread = Q.std(axis=0) + 1e-3
    losses = []
    for ridge in RIDGES:
        loss = 0.0
        for k in range(5):
            encoder = kind(ridge).fit(U[block != k], Q[block != k])
            off = (encoder.predict(U[block == k]) - Q[block == k]) / spread
            loss += float((off**2).sum())
        losses.append(loss)
    return RIDGES[int(np.argmin(losses))]


def draw(body: Body, Q: Array, frames: Sequence[int], path: Path) -> None:
    """Truth (grey) beside reconstruction (blue) for a few frames, seen from the side."""
    size, feet, scale = 190, 300, 120.0
    image = Image.new("RGB", (size * 2 * len(frames), 340), "white")
    pen = ImageDraw.Draw(image)
    for column, (motion, colour) in enumerate(
        ((body.motion, (120, 120, 120)), (motion_of(body, Q), (30, 90, 200)))
    ):
        placed = motion.place()
        for i, frame in enumerate(frames):
            left = size * (2 * i + column)
            centre = body.middle[frame]
            joints, ends = placed.positions[frame], placed.ends[frame]
            bones = [(joints[p], joints[j]) for j, p in enumerate(motion.parents) if p >= 0]
            bones += [(joints[j], ends[j]) for j in range(1, len(joints))]
            for bone in bones:
                line = [
                    (
                        left + size / 2 + scale * float(point[0] - centre[0]),
                        feet - scale * float(point[1]),
                    )
                    for point in bone
                    if np.isfinite(point).all()
                ]
                pen.line(line, fill=colour, width=3)
            pen.line([(left, feet), (left + size, feet)], fill=(200, 200, 200))
            title = f"{'learned from hands and feet' if column else 'truth'}"
            pen.text((left + 8, 8), f"{body.motion.time[frame]:.2f} s, {title}", fill=colour)
    image.save(path)


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the example; 2 and one clear line where the data is absent."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--data", type=Path, metavar="DIR", help="holds formats/backflip.amc, .asf")
    parser.add_argument("--out", type=Path, help="a picture of a few frames")
    options = parser.parse_args(argv)
    try:
        if options.data is None:
            body, what = body_of(humanoid(), tuple(HUMANOID_ENDS)), "a simulated humanoid"
            block, of = FRAMES_OF_A_TAKE, 4
        else:
            folder = options.data / "formats"
            motion = read_amc(folder / "backflip.amc", read_asf(folder / "backflip.asf"))
            body, what, block, of = body_of(motion), "a captured backflip", BLOCK, 4
    except InputError as error:
        hint = "" if options.data is None else ". --data DIR has formats/backflip.amc and .asf"
        print(f"body: {error}{hint}", file=sys.stderr)
        return 2
    held = np.arange(len(body.motion)) // block % of == 2
    print(
        f"{len(body.motion)} frames of {what}; {body.U.shape[1]} numbers of hands and feet, "
        f"{body.Q.shape[1]} of the body; {(~held).sum()} frames learned, {held.sum()} held out"
    )
    print(f"{'':<12}{'root cm':>9}{'joints deg':>12}{'joints cm':>11}")
    mean = np.tile(body.Q[~held].mean(axis=0), (len(body.Q), 1))
    results = {"mean pose": mean}
    for name, kind in (("linear", LinearEncoder), ("quadratic", QuadraticEncoder)):
        ridge = chosen_ridge(kind, body.U[~held], body.Q[~held], block)
        results[name] = kind(ridge).fit(body.U[~held], body.Q[~held]).predict(body.U)
    for name, Q in results.items():
        root, angle, joints = errors(body, Q, held)
        print(f"{name:<12}{root:>9.1f}{angle:>12.1f}{joints:>11.1f}")
    if options.out is not None:
        frames = np.flatnonzero(held)
        # Before and after the flip the captured body only stands.
        shown = frames[(np.linspace(0.35, 0.9, 4) * len(frames)).astype(int)].tolist()
        try:
            draw(body, results["quadratic"], shown, options.out)
        except (OSError, ValueError) as error:
            print(f"body: the picture cannot be written: {error}", file=sys.stderr)
            return 2
        print(f"{options.out}: truth beside learned, held-out frames only")
    return 0


if __name__ == "__main__":
    sys.exit(main())
