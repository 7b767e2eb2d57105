"""The hand's encoder on a whole body: it predicts all joints from hands and feet alone.

The paper of 2015 ends with this suggestion. Here the same quadratic encoder predicts the pose of
the whole body from the positions of hands and feet and from which of them touch the floor.

    python examples/body.py --out body.png                # a simulated humanoid
    python examples/body.py --data DIR --out body.png     # a captured backflip

The humanoid is MuJoCo's, from the package gymnasium (pip install 'hand-sandbox[gym]'). It crouches,
steps, leans, twists and reaches. Each of these movements has a smooth random course and turns
several joints together, and the lowest point of the body is on the floor. The movements are
simulated, not a person's. Whole takes are held out.

The backflip is from the CMU motion capture database, which is not part of this repository: DIR
contains formats/backflip.amc and .asf. Short blocks of the flip are held out. They lie between
blocks of the training data. The result therefore shows that the encoder works for another body, but
not that it predicts other flips.
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
"""Bones of the captured body. The positions of their ends are the input."""

HUMANOID_ENDS = {
    "left_lower_arm": "left_hand",
    "right_lower_arm": "right_hand",
    "left_foot": "left_foot",
    "right_foot": "right_foot",
}
"""Body of the humanoid whose end is an input -> the sphere at that end."""

TAKES, SECONDS, RATE = 16, 6.0, 30.0
"""Number of takes of the humanoid, duration (s) of a take, and frames a second."""

FRAMES_OF_A_TAKE = round(SECONDS * RATE)

HZ = (0.1, 0.4)
"""Lowest and highest frequency (Hz) of the three sine waves whose mean is a course."""

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
"""Movement -> angle (degrees) of each of its joints at a course of 1."""

UP = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""Rotation from MuJoCo's world (z up, x forward) to that of recordings (y up, z forward)."""

ON_FLOOR = 0.08
"""Height (m) of an end below which it counts as touching the floor."""

BLOCK = 10
"""Number of frames of a block, a twelfth of a second. Every fourth block is held out."""


@dataclass(frozen=True)
class Body:
    """A motion as inputs and outputs of an encoder.

    Attributes:
        motion: The motion.
        U: (T, 16) positions (m) of the four ends relative to their mean, then their contact flags.
        Q: (T, N) position (m) of the root relative to that mean, the first two columns of its
            rotation matrix (a rotation vector would be discontinuous in a flip), and the rotation
            vectors (rad) of `joints`.
        middle: (T, 3) mean position (m) of the four ends.
        joints: Indices of the bones that turn.
    """

    motion: Motion
    U: Array
    Q: Array
    middle: Array
    joints: list[int]


def humanoid(seed: int = 0) -> Motion:
    """Makes takes of MuJoCo's humanoid, one after the other, with smooth random movements.

    Raises:
        InputError: The package that contains the humanoid is not installed.
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
    """Computes the inputs and outputs of a motion.

    Args:
        motion: The motion.
        names: Names of the four bones whose ends are the input.
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
    """Returns the motion with the outputs `Q` (T, N), on the skeleton of `body`."""
    shifts, rotations = body.motion.shifts.copy(), body.motion.rotations.copy()
    shifts[:, 0] = Q[:, :3] + body.middle
    a, b = Q[:, 3:9].reshape(-1, 3, 2)[..., 0], Q[:, 3:9].reshape(-1, 3, 2)[..., 1]
    # The predicted columns are made orthonormal, so that they are a rotation.
    x = a / np.linalg.norm(a, axis=1, keepdims=True)
    y = b - np.sum(x * b, axis=1, keepdims=True) * x
    y /= np.linalg.norm(y, axis=1, keepdims=True)
    rotations[:, 0] = np.stack([x, y, np.cross(x, y)], axis=2)
    rotations[:, body.joints] = exp(Q[:, 9:].reshape(len(Q), -1, 3))
    return replace(body.motion, shifts=shifts, rotations=rotations)


def errors(body: Body, Q: Array, frames: NDArray[np.bool_]) -> tuple[float, float, float]:
    """Returns the mean errors of the root's position (cm), of the rotations of joints (degrees) and
    of the positions of all joints (cm)."""
    true, predicted = body.Q[frames], Q[frames]
    root = 100 * np.linalg.norm(true[:, :3] - predicted[:, :3], axis=1).mean()
    angle = geodesic_angle(true[:, 9:].reshape(-1, 3), predicted[:, 9:].reshape(-1, 3))
    places = body.motion.place().positions - motion_of(body, Q).place().positions
    joints = 100 * np.linalg.norm(places[frames], axis=2).mean()
    return float(root), float(np.rad2deg(angle).mean()), float(joints)


def chosen_ridge(
    kind: type[LinearEncoder] | type[QuadraticEncoder], U: Array, Q: Array, block_size: int
) -> float:
    """Chooses a penalty of `RIDGES` by cross-validation over blocks of frames.

    The error of each column is divided by its standard deviation.
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
    """Draws truth (grey) beside prediction (blue) for a few frames, projected on the x-y plane."""
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
    """Runs the example. Returns 2 after an error of one line if the data is missing."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--data", type=Path, metavar="DIR", help="contains formats/backflip.amc and .asf"
    )
    parser.add_argument("--out", type=Path, help="file for a picture of a few frames")
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
        # Before and after the flip the captured person only stands.
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
