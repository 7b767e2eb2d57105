"""A trial from Python: score, trajectories as arrays and CSV, the film as an array, a recording.

python examples/run_a_trial.py OUT_FOLDER [--film]
"""

import sys
from pathlib import Path

from sandbox import run_trial

# isort: split
# NumPy comes after `sandbox`, which makes its results the same on all processors.
import numpy as np

out = Path(sys.argv[1] if len(sys.argv) > 1 else "trial")
out.mkdir(parents=True, exist_ok=True)

# The simulated user plays. The same seed gives the same trial, to the bit. Pictures need OpenGL;
# everything else works without it. `film="run.webp"` writes a film to a file instead.
run = run_trial(
    "box-to-goal",
    seed=3,
    fingers=3,
    record=out / "run.jsonl",
    pictures=(320, 180) if "--film" in sys.argv else None,
)
print(f"success {run.success} after {run.score.time:.1f} s, state {run.state_hash}")

moved = run.trajectories
box, hand = moved.objects["box"], moved.hands[0]
way = np.linalg.norm(np.diff(box.position, axis=0), axis=1).sum()
print(f"{len(moved.time)} control periods; the box moved {100 * way:.1f} cm")
print(f"hand poses {hand.q.shape}, fingertips {hand.tips.shape}, touches {moved.touches.xy.shape}")
if run.pictures is not None:
    print(f"film {run.pictures.shape}, {run.pictures.dtype}")
for file in moved.write_csv(out):
    print(file)
