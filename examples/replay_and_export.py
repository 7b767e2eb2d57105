"""A recording from Python: replay it, compare every state, and export the hand's motion.

python examples/replay_and_export.py RECORDING OUT_FOLDER

`sandbox run box-to-goal --record run.jsonl` makes a recording. Without arguments, the recording
of `sandbox demo` is taken.
"""

import sys
from importlib.resources import files
from pathlib import Path

from sandbox import export_motion, load_recording, replay_recording

demo = files("sandbox") / "data" / "demo.jsonl"
source = Path(sys.argv[1] if len(sys.argv) > 1 else str(demo))
out = Path(sys.argv[2] if len(sys.argv) > 2 else "exported")
out.mkdir(parents=True, exist_ok=True)

# What is in the file: settings, and the touches with the step at which each took effect.
recording = load_recording(source)
settings = recording.header["settings"]
print(f"{settings['task']}, seed {settings['seed']}: {len(recording.touches())} touch frames")

# The same trial again. `exact` means that every state was equal to the recorded one.
run = replay_recording(source)
print(f"exact {run.verification.exact}, {run.verification.compared} states compared")
print(f"success {run.success} after {run.score.time:.1f} s")
run.trajectories.write_csv(out)

# Motion for other programs; the ending chooses the format.
for name in ("hand.bvh", "hand.glb", "tips.csv"):
    print(*export_motion(source, out / name))
