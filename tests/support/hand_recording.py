"""A hand that plays on a surface, made from kinematics alone, written as recorders would write it.

Everything about it is known: which finger touches when, and every pose. It moves, turns, and taps
with sets of fingers that change unevenly; fingertips land at half a metre a second.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from encoders.capture import Capture
from encoders.captures.conversion import (
    ConversionReport,
    ConversionRules,
    JointTrack,
    TouchLog,
    capture_from_touches,
)
from encoders.captures.conversion.assemble import Sync
from encoders.captures.conversion.sites import PALM, sites_of
from encoders.correction import CorrectionSettings, FingertipCorrection
from models.kinematics import Kinematics
from models.motion.pose_table import COLUMNS
from models.pose import joint_vectors
from models.rotations import exp
from models.skeleton import ADULT, Skeleton
from models.surface import METRES_PER_INCH

RATE = 60.0
AHEAD = 3.217
"""s that the hand's clock is ahead of the tablet's, where nothing else is said."""

RULES = ConversionRules(rate=RATE)
ON_SURFACE = 0.006
SCALE = 0.95

QUALISYS = {
    "hand_top": "back_front",
    "hand_left": "back_left",
    "hand_right": "back_right",
    **{f"{f}_tip": f"{f}_tip_skin" for f in ("thumb", "index", "middle", "ring", "little")},
    **{f"{f}_middle": f"{f}_pip_skin" for f in ("index", "middle", "ring", "little")},
    "thumb_middle": "thumb_ip_skin",
}


@dataclass(frozen=True)
class Truth:
    """Motion of the hand: time (T,), down (T, 5), xy (T, 5, 2) m, q (T, 48)."""

    time: np.ndarray
    down: np.ndarray
    xy: np.ndarray
    q: np.ndarray
    skeleton: Skeleton


def _schedule(rng: np.random.Generator, time: np.ndarray) -> np.ndarray:
    """(T, 5) who touches: sets of one to five fingers, with moments of none between them."""
    down = np.zeros((len(time), 5), bool)
    t = 0.3
    while t < time[-1] - 1.0:
        stay, pause = rng.uniform(0.35, 1.1), rng.uniform(0.25, 0.6)
        fingers = rng.choice(5, rng.choice([1, 2, 3, 4, 5], p=[0.1, 0.25, 0.25, 0.2, 0.2]), False)
        for finger in fingers:
            # Fingers of one set land and leave unevenly.
            a, b = t + rng.uniform(0, 0.1), t + stay - rng.uniform(0, 0.1)
            down[(time >= a) & (time < b), finger] = True
        t += stay + pause
    return down


@cache
def played(seconds: float = 20.0, seed: int = 0) -> Truth:
    """The hand's play at 60 Hz."""
    rng = np.random.default_rng(seed)
    time = np.arange(int(seconds * RATE)) / RATE
    down = _schedule(rng, time)
    height = np.empty(down.shape)
    for finger in range(5):
        touching = time[down[:, finger]]
        away = np.abs(time[:, None] - touching).min(axis=1)
        height[:, finger] = np.minimum(0.03, 0.5 * away)
    skeleton = ADULT.scaled(SCALE)
    kinematics = Kinematics(skeleton)
    spread = np.concatenate([np.full(3, 0.02), np.full(3, 0.15), np.full(42, 0.2)])
    correction = FingertipCorrection(
        skeleton, np.diag(spread**2), CorrectionSettings(tip_sigma=0.0002, iterations=30)
    )
    rest = np.zeros(48)
    rest[3] = -0.35
    tips = kinematics.tips(rest)
    rest[:3] -= tips.mean(axis=0) - [0, 0, ON_SURFACE]
    layout = kinematics.tips(rest)[:, :2]
    phase = rng.uniform(0, 2 * np.pi, 6)
    place = np.stack(
        [
            0.1 + 0.03 * np.sin(1.1 * time + phase[0]) + 0.01 * np.sin(4.3 * time + phase[1]),
            -0.08 + 0.02 * np.sin(0.9 * time + phase[2]) + 0.01 * np.sin(3.7 * time + phase[3]),
        ],
        axis=1,
    )
    turn = 0.3 * np.sin(0.7 * time + phase[4])
    size = 1 + 0.12 * np.sin(1.9 * time + phase[5])
    q = np.empty((len(time), 48))
    last = None
    for t in range(len(time)):
        around = Rotation.from_euler("z", turn[t])
        guess = rest.copy()
        guess[:3] = around.apply(rest[:3])
        guess[:2] += place[t]
        guess[3:6] = (around * Rotation.from_rotvec(rest[3:6])).as_rotvec()
        targets = np.zeros((5, 3))
        targets[:, :2] = size[t] * layout @ around.as_matrix()[:2, :2].T + place[t]
        targets[:, 2] = ON_SURFACE + height[t]
        last = correction.correct(guess, np.arange(5), targets, last).q
        q[t] = last
    tips = kinematics.tips(q)
    xy = np.where(down[..., None], tips[..., :2] * [1.0, -1.0], np.nan)
    return Truth(time, down, xy, q, skeleton)


def touch_log(truth: Truth, ahead: float = 0.0, seed: int = 1) -> TouchLog:
    """Touches as a tablet records them, with a clock `ahead` s behind the hand's recorder."""
    rng = np.random.default_rng(seed)
    ids = np.full(truth.down.shape, -1)
    following = 100
    for t in range(len(ids)):
        for finger in rng.permutation(5):
            if truth.down[t, finger]:
                if t and truth.down[t - 1, finger]:
                    ids[t, finger] = ids[t - 1, finger]
                else:
                    ids[t, finger], following = following, following + 1
    frames, fingers = np.nonzero(truth.down)
    xy = truth.xy[frames, fingers] + rng.normal(0, 0.0002, (len(frames), 2)) + [0.0, -0.002]
    return TouchLog(truth.time - ahead, frames.astype(np.int64), ids[frames, fingers], xy)


def write_shown(path: Path, log: TouchLog) -> None:
    """The touches in the form of `sandbox touches show --json`."""
    lines = []
    for f, time in enumerate(log.time):
        contacts = [
            {"id": int(log.ids[r]), "x": x, "y": y, "finger": None}
            for r in np.flatnonzero(log.frame == f)
            for x, y in [(log.xy[r] / METRES_PER_INCH).tolist()]
        ]
        lines.append(json.dumps({"time": float(time), "contacts": contacts}))
    path.write_text("\n".join(lines) + "\n")


def write_bvh(path: Path, truth: Truth) -> None:
    """Bones under our own names, in centimetres; the rest turns are part of the rotations."""
    bones = truth.skeleton.bones
    lines = ["HIERARCHY", "ROOT wrist", "{", "OFFSET 0 0 0"]
    lines += ["CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"]
    for i, bone in enumerate(bones):
        lines += [f"JOINT {bone.name}", "{"]
        lines += ["OFFSET " + " ".join(f"{100 * v:.8f}" for v in bone.anchor)]
        lines += ["CHANNELS 3 Zrotation Xrotation Yrotation"]
        if i + 1 == len(bones) or bones[i + 1].finger != bone.finger:
            lines += ["End Site", "{", f"OFFSET 0 {100 * bone.length:.8f} 0", "}"]
            depth = sum(other.finger == bone.finger for other in bones)
            lines += ["}"] * depth
    lines += ["}", "MOTION", f"Frames: {len(truth.q)}", f"Frame Time: {1 / RATE:.8f}"]
    turns = [exp(truth.q[:, 3:6])]
    vectors = joint_vectors(truth.q)
    turns += [bone.rest @ exp(vectors[:, i]) for i, bone in enumerate(bones)]
    angles = [Rotation.from_matrix(R).as_euler("ZXY", degrees=True) for R in turns]
    table = np.concatenate([100 * truth.q[:, :3], *angles], axis=1)
    lines += [" ".join(f"{v:.7f}" for v in row) for row in table]
    path.write_text("\n".join(lines) + "\n")


def markers(truth: Truth, seed: int = 2) -> dict[str, np.ndarray]:
    """Name -> (T, 3) m, markers of a glove in the surface frame, a few mm from where they ought."""
    rng = np.random.default_rng(seed)
    placed = Kinematics(truth.skeleton).place(truth.q)
    known = sites_of(truth.skeleton)
    out = {}
    for name, site_name in QUALISYS.items():
        site = known[site_name]
        at = site.at + rng.normal(0, 0.003, 3)
        if site.bone == PALM:
            origin, turn = truth.q[:, :3], exp(truth.q[:, 3:6])
        else:
            origin, turn = placed.joints[:, site.bone], placed.rotations[:, site.bone]
        out[name] = origin + turn @ at + rng.normal(0, 0.0002, (len(truth.q), 3))
    return out


def write_tsv(path: Path, points: dict[str, np.ndarray]) -> None:
    """The markers in the form of Qualisys Track Manager, in mm; gaps are empty."""
    frames = len(next(iter(points.values())))
    lines = [f"NO_OF_FRAMES\t{frames}", f"NO_OF_MARKERS\t{len(points)}", f"FREQUENCY\t{RATE:g}"]
    lines += ["DATA_INCLUDED\t3D", "\t".join(["MARKER_NAMES", *points])]
    for t in range(frames):
        cells = [f"{1000 * v:.4f}" if np.isfinite(v) else "" for p in points.values() for v in p[t]]
        lines.append("\t".join(cells))
    path.write_text("\n".join(lines) + "\n")


def converted(
    log: TouchLog,
    joints: JointTrack,
    sync: Sync = "clock",
    offset: float = AHEAD,
    rules: ConversionRules = RULES,
) -> tuple[Capture, ConversionReport]:
    """The capture of touches and poses, and what was dropped."""
    report = ConversionReport()
    return capture_from_touches(log, joints, sync, offset, rules, report, {}), report


def rows_of(truth: Truth, capture: Capture, ahead: float = AHEAD) -> np.ndarray:
    """Frames of the truth at which the frames of a capture were taken."""
    return np.round((capture.time + ahead) * RATE).astype(int)


def write_pose_table(path: Path, time: np.ndarray, q: np.ndarray) -> None:
    """Times (T,) s and poses (T, 48) as `sandbox capture --joints` reads them."""
    rows = [("time", *COLUMNS)]
    rows += [(repr(t), *map(repr, pose)) for t, pose in zip(time.tolist(), q.tolist(), strict=True)]
    path.write_text("".join(",".join(row) + "\n" for row in rows))
