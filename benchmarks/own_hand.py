"""A person's own encoder from a Leap instead of a studio: SIMULATED person, tablet and Leap.

    python -m benchmarks.own_hand --subject first --dialect v3 --seed 7

Day 0 is recorded with both devices and converted as `sandbox capture --recorded` does; an encoder
is trained on it as `sandbox train` does. It is judged on another day, whose poses and names are the
true ones, beside the same training from day 0's truth, and beside the program's own `best`, which
never saw this person. Prints a line of JSON.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from encoders.capture import Capture
from encoders.captures.conversion import ConversionReport, ConversionRules
from encoders.captures.paired.capture_from_hands import Correct
from encoders.captures.paired.simulated import PairedSession, simulate_paired
from encoders.store import save_capture
from models.pose import joint_vectors
from models.rotations import geodesic_angle
from sandbox.cli.capture.command import CaptureOptions
from sandbox.cli.capture.hands import capture_of_hands
from sandbox.cli.capture.simulate import write_simulated
from sandbox.cli.main import main as sandbox

SAME = 0.02
"""s between a frame of the capture and one of the truth that are compared."""


def converted(
    session: PairedSession, folder: Path, correct: Correct
) -> tuple[Capture, dict[str, Any]]:
    """The capture of a session, and how far everything is from the truth."""
    report = ConversionReport()
    options = CaptureOptions(out=folder / "x.npz", recorded=folder, sync="tap", correct=correct)
    capture, _ = capture_of_hands(options, None, ConversionRules(), report)
    notes = report.notes
    axes, at = np.array(notes["device_axes"]), np.array(notes["device_at_m"])
    turn = float(np.degrees(_angle(axes @ session.rotation.T)))
    found = {
        "sync_ms": round(1000 * (notes["offset_s"] - session.offset), 2),
        "sync_precision_ms": round(1000 * notes["offset_precision_s"], 2),
        "taps": notes["taps_agreeing"],
        "place_mm": round(1000 * _middle_miss(session, axes, at), 2),
        "turn_deg": round(turn, 2),
        "frames": len(capture),
    }
    return capture, found | _against(capture, session)


def _angle(rotation: np.ndarray) -> float:
    """rad, angle of a rotation (3, 3)."""
    return float(np.arccos(np.clip((np.trace(rotation) - 1.0) / 2.0, -1.0, 1.0)))


def _middle_miss(session: PairedSession, axes: np.ndarray, at: np.ndarray) -> float:
    """m, by which a point in the middle of the touches is put elsewhere."""
    xy = np.nanmean(session.truth.xy.reshape(-1, 2), axis=0)
    middle = np.array([xy[0], -xy[1], 0.006])
    seen = (middle - session.shift) @ session.rotation
    return float(np.linalg.norm(axes @ seen + at - middle))


def _against(capture: Capture, session: PairedSession) -> dict[str, Any]:
    truth, time = session.truth, capture.time - session.touch_delay
    after = np.clip(np.searchsorted(truth.time, time), 1, len(truth.time) - 1)
    near = np.abs(truth.time[after - 1] - time) < np.abs(truth.time[after] - time)
    row = np.where(near, after - 1, after)
    known = np.abs(truth.time[row] - time) < SAME
    q, true = capture.q[known], truth.q[row[known]]
    angle = geodesic_angle(joint_vectors(q), joint_vectors(true))
    # Each captured contact beside the true one at the same place.
    xy, down = capture.xy[known], capture.down[known]
    off = np.linalg.norm(
        xy[:, :, None] - np.nan_to_num(truth.xy[row[known]], nan=9.0)[:, None], axis=3
    )
    named = np.where(down, np.where(down[..., None], off, 9.0).argmin(axis=2), -1)
    right = (named == np.arange(5))[down]
    return {
        "wrist_mm": round(1000 * float(np.linalg.norm((q - true)[:, :3], axis=1).mean()), 2),
        "joints_deg": round(float(np.rad2deg(angle).mean()), 2),
        "names_percent": round(100 * float(right.mean()), 2),
        "touches_kept_percent": round(100 * float(down.sum() / truth.down[row[known]].sum()), 2),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--subject", choices=("first", "second"), default="first")
    parser.add_argument("--dialect", choices=("v3", "v1"), default="v3")
    parser.add_argument("--seed", type=int, default=7)
    parser.add_argument("--correct", choices=("unseen", "all", "none"), default="unseen")
    parser.add_argument("--convert-only", action="store_true")
    options = parser.parse_args()
    out: dict[str, Any] = {"simulated": True, **vars(options)}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for day in (0, 1):
            at = folder / f"day{day}"
            session = simulate_paired(options.seed, day, options.subject, options.dialect)
            write_simulated(session, at, f"simulated {options.subject} {options.seed}")
            capture, out[f"day{day}"] = converted(session, at, options.correct)
            save_capture(capture, folder / f"own{day}.npz")
            print(json.dumps(out), flush=True)
            if options.convert_only:
                return
        own, true = folder / "own.npz", folder / "true.npz"
        for model, source in ((own, folder / "own0.npz"), (true, folder / "day0" / "truth.npz")):
            assert sandbox(["train", "--capture", str(source), "--out", str(model)]) == 0
        judged = folder / "judged.json"
        status = sandbox(
            [
                "evaluate",
                "--capture",
                str(folder / "day1" / "truth.npz"),
                "--no-copas",
                "--subject",
                options.subject,
                "--json",
                str(judged),
                "--encoders",
                str(own),
                str(true),
                "best",
            ]
        )
        assert status == 0
        found = json.loads(judged.read_text())["encoders"]
        out["judged"] = {
            Path(name).stem: {
                "wrist_cm": method["wrist_cm"]["true_labels"],
                "angle_deg": method["angle_deg"]["true_labels"],
                "wrist_own_labels_cm": method["wrist_cm"]["own_labels"],
                "angle_own_labels_deg": method["angle_deg"]["own_labels"],
                "labels_percent": method["labels_percent"]["all"],
            }
            for name, method in found.items()
        }
    print(json.dumps(out), flush=True)


if __name__ == "__main__":
    main()
