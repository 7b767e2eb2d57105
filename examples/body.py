"""The hand's encoder on a whole body: all joints of a backflip from hands and feet alone.

The paper of 2015 ends with this suggestion. Here the same quadratic encoder learns from where hands
and feet are, and from which of them touch the floor, how the whole body is posed. The motion is one
backflip of the CMU motion capture database, which is not part of this repository: backflip.amc and
.asf in formats/ of ../shared/data, of the folder that HAND_SANDBOX_DATA names, or of --data.

    python examples/body.py --out body.png

Short blocks of the flip are held out. They lie between blocks that were learned, so this shows that
the encoder carries over to another body, and not that it knows any other flip.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from encoders import LinearEncoder, QuadraticEncoder
from encoders.regression.trained import RIDGES
from models.errors import InputError
from models.motion.motion import Motion
from models.motion.read.asf import read_amc, read_asf
from models.rotations import exp, geodesic_angle, log

Array = NDArray[np.float64]

ENDS = ("lhand", "rhand", "lfoot", "rfoot")
"""Bones whose ends are the input."""

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


def body_of(motion: Motion) -> Body:
    """Inputs and outputs of a motion."""
    placed = motion.place()
    ends = placed.ends[:, [motion.index(name) for name in ENDS]]
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


def chosen_ridge(kind: type[LinearEncoder] | type[QuadraticEncoder], U: Array, Q: Array) -> float:
    """The penalty, of those tried for the hand, that does best on blocks left out in turn.

    Columns count by their spread.
    """
    block = np.arange(len(U)) // BLOCK % 5
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
            for j in range(1, len(motion.names)):
                line = [
                    (
                        left + size / 2 + scale * float(point[0] - centre[0]),
                        feet - scale * float(point[1]),
                    )
                    for point in (placed.positions[frame, j], placed.ends[frame, j])
                ]
                pen.line(line, fill=colour, width=3)
            pen.line([(left, feet), (left + size, feet)], fill=(200, 200, 200))
            title = f"{'learned from hands and feet' if column else 'captured'}"
            pen.text((left + 8, 8), f"{frame / 120:.2f} s, {title}", fill=colour)
    image.save(path)


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the example; 2 and one clear line where the data is absent."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    data = os.environ.get("HAND_SANDBOX_DATA", beside)
    parser.add_argument(
        "--data", type=Path, default=data, metavar="DIR", help="holds formats/ (now: %(default)s)"
    )
    parser.add_argument("--out", type=Path, help="a picture of a few frames")
    options = parser.parse_args(argv)
    folder = Path(options.data) / "formats"
    try:
        motion = read_amc(folder / "backflip.amc", read_asf(folder / "backflip.asf"))
    except InputError as error:
        print(
            f"body: {error}. --data DIR says where formats/backflip.amc and .asf are",
            file=sys.stderr,
        )
        return 2
    body = body_of(motion)
    held = np.arange(len(motion)) // BLOCK % 4 == 2
    print(
        f"{len(motion)} frames of a backflip; {body.U.shape[1]} numbers of hands and feet, "
        f"{body.Q.shape[1]} of the body; {(~held).sum()} frames learned, {held.sum()} held out"
    )
    print(f"{'':<12}{'root cm':>9}{'joints deg':>12}{'joints cm':>11}")
    mean = np.tile(body.Q[~held].mean(axis=0), (len(motion), 1))
    results = {"mean pose": mean}
    for name, kind in (("linear", LinearEncoder), ("quadratic", QuadraticEncoder)):
        ridge = chosen_ridge(kind, body.U[~held], body.Q[~held])
        results[name] = kind(ridge).fit(body.U[~held], body.Q[~held]).predict(body.U)
    for name, Q in results.items():
        root, angle, joints = errors(body, Q, held)
        print(f"{name:<12}{root:>9.1f}{angle:>12.1f}{joints:>11.1f}")
    if options.out is not None:
        frames = np.flatnonzero(held)
        # Before and after the flip the body only stands.
        shown = frames[(np.linspace(0.35, 0.9, 4) * len(frames)).astype(int)].tolist()
        try:
            draw(body, results["quadratic"], shown, options.out)
        except (OSError, ValueError) as error:
            print(f"body: the picture cannot be written: {error}", file=sys.stderr)
            return 2
        print(f"{options.out}: captured beside learned, held-out frames only")
    return 0


if __name__ == "__main__":
    sys.exit(main())
