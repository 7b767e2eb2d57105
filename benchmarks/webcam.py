"""How well a hand before a camera is reconstructed: `python -m benchmarks.webcam`.

Prints a table for films of the rendered hand, whose true pose is known, seen from three sides: the
error of the middle joints' angles and of the fingertips in the palm's frame, with the engine alone
beside it, and how far the wrist is from its place. Then what can be said of the real film of a hand
in the shared data, which has no truth: in how many pictures a hand was followed, and how plausible
the poses are. Needs Debian's chromium, OpenGL and `sandbox webcam install`; the real film needs the
extra `film`.

    python -m benchmarks.webcam [--seeds 11 12 13] [--pictures 60] [--real 200]
"""

from __future__ import annotations

import argparse
import os
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image

from benchmarks.one_line import run
from benchmarks.webcam_films import RATE, SIZE, VIEWS, film, numbered, poses_of, seen
from encoders.webcam.camera import Camera
from encoders.webcam.first_guess import turn_between
from encoders.webcam.landmark_fit import LandmarkFit
from encoders.webcam.landmarks import KNUCKLES, OF_POINTS, PALM
from models.arithmetic.arrays import Array
from models.frames import LandmarkFrame
from models.kinematics import Kinematics
from models.pose import JOINTS
from models.rotations import exp
from models.skeleton import ADULT
from sandbox.devices.webcam.installed import installed_engine

TIPS = [4, 8, 12, 16, 20]
AT_END = np.radians(0.5)
"""rad from the end of its range within which a joint counts as being there."""
DATA = Path(os.environ.get("HAND_SANDBOX_DATA", "../shared/data"))
_KINEMATICS = Kinematics(ADULT)


@dataclass
class Errors:
    """Errors of one film, or of several.

    Attributes:
        bend: degrees, of middle joints.
        tips: m, of fingertips in the palm's frame.
        wrist: m, of the wrist in the camera's frame.
        pictures, followed: Numbers of pictures, and of those in which the hand was found.
        milliseconds: Of the fit, a picture.
    """

    bend: list[float] = field(default_factory=list)
    tips: list[float] = field(default_factory=list)
    wrist: list[float] = field(default_factory=list)
    pictures: int = 0
    followed: int = 0
    milliseconds: list[float] = field(default_factory=list)

    @property
    def bend_rms(self) -> float:
        """degrees, root mean square."""
        return float(np.sqrt(np.mean(np.square(self.bend))))


def points_of(q: Array) -> Array:
    """(21, 3) m of a pose (48,): joints and the centres of fingertips at the landmarks' numbers."""
    placed = _KINEMATICS.place(q)
    points = np.zeros((21, 3))
    points[list(OF_POINTS)] = np.concatenate([q[None, :3], placed.joints, placed.tips])
    return points


def bends(points: Array) -> Array:
    """(4,) degrees between a finger's first and second bone, of landmarks (21, 3)."""
    found = []
    for knuckle in KNUCKLES:
        a, b = points[knuckle + 1] - points[knuckle], points[knuckle + 2] - points[knuckle + 1]
        cosine = a @ b / (np.linalg.norm(a) * np.linalg.norm(b))
        found.append(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
    return np.array(found)


def tips_off(points: Array, true: Array) -> Array:
    """(5,) m between fingertips once the palms (21, 3) are laid on each other."""
    palm = list(PALM)
    turn = exp(turn_between(points[palm], true[palm]))
    laid = (points - points[palm].mean(axis=0)) @ turn.T + true[palm].mean(axis=0)
    return np.asarray(np.linalg.norm(laid[TIPS] - true[TIPS], axis=1))


def judge(
    camera: Camera,
    poses: Array,
    frames: Sequence[LandmarkFrame | None],
    ours: Errors,
    engine: Errors,
) -> None:
    """Adds the errors of a film."""
    fit, before = LandmarkFit(ADULT), 0.0
    for q, frame in zip(poses, frames, strict=True):
        ours.pictures += 1
        hands = [h for h in frame.hands if h.side == "right"] if frame else []
        if frame is None or not hands:
            continue
        ours.followed += 1
        hand = hands[0]
        rays, world = camera.rays(np.array(hand.image), frame.size), np.array(hand.world)
        began = time.perf_counter()
        found = fit.fit(rays, world, frame.taken - before).pose
        ours.milliseconds.append(1000.0 * (time.perf_counter() - began))
        before = frame.taken
        true = camera.seen(points_of(q))
        points = points_of(found)
        ours.bend += (bends(points) - bends(true)).tolist()
        ours.tips += tips_off(points, true).tolist()
        ours.wrist.append(float(np.linalg.norm(points[0] - true[0])))
        engine.bend += (bends(world) - bends(true)).tolist()
        engine.tips += tips_off(world, true).tolist()


def rendered(engine: Path, seeds: Sequence[int], pictures: int) -> None:
    """Prints the table of the rendered hand."""
    head = "view", "followed", "PIP, deg", "engine", "fingertips, mm", "engine", "wrist, mm"
    print("| " + " | ".join((*head, "page, ms", "fit, ms")) + " |")
    print("| --- " * (len(head) + 2) + "|")
    rows = []
    for name, camera in VIEWS.items():
        ours, alone = Errors(), Errors()
        took: list[float] = []
        hosts: set[str] = set()
        for seed in seeds:
            poses = poses_of(seed, pictures)
            shown = seen(film(camera, poses).pictures, engine)
            judge(camera, poses, shown.frames, ours, alone)
            took.append(shown.milliseconds)
            hosts |= shown.hosts
        assert all(host.startswith("127.0.0.1:") for host in hosts), hosts
        tips, tips_alone = 1000 * np.median(ours.tips), 1000 * np.median(alone.tips)
        rows.append((ours.bend_rms, alone.bend_rms, tips, tips_alone))
        print(
            f"| {name} | {ours.followed} of {ours.pictures} | {ours.bend_rms:.1f} | "
            f"{alone.bend_rms:.1f} | {tips:.1f} | {tips_alone:.1f} | "
            f"{1000 * np.median(ours.wrist):.0f} | {np.median(took):.0f} | "
            f"{np.median(ours.milliseconds):.2f} |",
            flush=True,
        )
    bend, bend_alone, tip, tip_alone = np.median(np.array(rows), axis=0)
    print(f"| median | | {bend:.1f} | {bend_alone:.1f} | {tip:.1f} | {tip_alone:.1f} | | | |")


def real_pictures(path: Path, count: int) -> tuple[bytes, ...]:
    """JPEGs of a film, cut to 4:3, evenly over its length, each with its number."""
    from imageio_ffmpeg import get_ffmpeg_exe

    width, height = SIZE
    ways = f"scale=-2:{height},crop={width}:{height}"
    command = [get_ffmpeg_exe(), "-loglevel", "error", "-i", str(path), "-vf", ways]
    command += ["-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    data = subprocess.run(command, capture_output=True, check=True).stdout
    frames = np.frombuffer(data, np.uint8).reshape(-1, height, width, 3)
    chosen = np.linspace(0, len(frames) - 1, min(count, len(frames))).round().astype(int)
    return tuple(numbered(Image.fromarray(frames[i]), n) for n, i in enumerate(chosen))


def real(engine: Path, count: int) -> None:
    """Prints what can be said of the real film."""
    path = DATA / "webcam" / "human-hand.mp4"
    if not path.is_file():
        print(f"\nno real film: there is no {path}")
        return
    length = 20.7
    pictures = real_pictures(path, count)
    shown = seen(pictures, engine, rate=len(pictures) / length)
    fit, camera, before = LandmarkFit(ADULT), Camera(), 0.0
    poses, errors = [], []
    for frame in shown.frames:
        if frame is None or not frame.hands:
            continue
        hand = frame.hands[0]
        rays = camera.rays(np.array(hand.image), frame.size)
        if hand.side == "left":
            rays = rays * [-1.0, 1.0]
        found = fit.fit(rays, np.array(hand.world), frame.taken - before)
        before = frame.taken
        poses.append(found.pose)
        errors.append(found.error)
    q = np.array(poses)[:, JOINTS].reshape(len(poses), -1, 3)
    bend = q[:, :, 0]
    lower, upper = ADULT.lower.reshape(-1, 3)[:, 0], ADULT.upper.reshape(-1, 3)[:, 0]
    ends = (bend <= lower + AT_END) | (bend >= upper - AT_END)
    sides = [h.side for f in shown.frames if f for h in f.hands]
    print(
        f"\nreal film of a hand, {len(pictures)} of its pictures: a hand followed in {len(poses)}, "
        f"called right in {sides.count('right')}; flexion at an end of its range in "
        f"{100 * ends.mean():.1f} % of joints ({100 * ends[:, 2:].mean():.1f} % without the "
        f"thumb); a point is {1000 * np.median(errors):.1f} mm beside its landmark (median of "
        f"pictures); the hand is {np.median(np.array(poses)[:, 2]):.2f} m away by a field of view "
        f"of {camera.view:g} degrees"
    )


def main() -> None:
    """Prints everything."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[11, 12, 13])
    parser.add_argument("--pictures", type=int, default=60)
    parser.add_argument("--real", type=int, default=200)
    options = parser.parse_args()
    engine = installed_engine()
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors; {RATE:g} Hz, stretched\n")
    rendered(engine, options.seeds, options.pictures)
    real(engine, options.real)


if __name__ == "__main__":
    run(main)
