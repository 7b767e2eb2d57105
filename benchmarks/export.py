"""Measures how long it takes to export a ten-minute session to each format, and in how much memory.

    python -m benchmarks.export                 # ten minutes, one hand
    python -m benchmarks.export --hands 2
    python -m benchmarks.export --minutes 60 --only .bvh .glb    # memory is no more
    python -m benchmarks.export --leap --only .bvh   # PAALM's hand of a simulated Leap's recording

The session's recording holds no touches: a lively hand at 62.5 poses a second, as a session writes
them, with two boxes beside it and the states of every second. The Leap's recording is a simulated
take of half a minute, over and over. Each export is a process of its own, the command as a person
would type it: seconds of the wall clock and of the processor, start included, and the process's
peak memory.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.machine import describe_machine
from encoders.paalm.simulated.air import simulate_air
from encoders.paalm.simulated.forward import leap_take
from models.rotations import quaternion_exp
from models.skeleton import ADULT
from sandbox.devices.leap.leap_write import leap_message
from sandbox.export.targets import FORMATS
from sandbox.recording.recording import RecordingWriter
from sandbox.trial.settings import RunSettings

CHILD = """
import json, resource, sys, time
began = time.perf_counter()
from sandbox.cli.main import main
status = main(sys.argv[1:])
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
times = time.perf_counter() - began, time.process_time()
print("MEASURED", json.dumps([status, *times, peak]))
"""


def write_recording(path: Path, minutes: float, hands: int) -> None:
    """A recording without touches."""
    settings = RunSettings("box-to-goal").as_json()
    if hands == 2:
        settings["hands"].append({"side": "left", "size": 1.0, "turn": 0})
    rng = np.random.default_rng(0)
    pace, phase = rng.uniform(0.2, 1.5, (hands, 48)), rng.uniform(0, 6, (hands, 48))
    middle, half = (ADULT.upper + ADULT.lower) / 2, (ADULT.upper - ADULT.lower) / 2
    count = round(minutes * 60 * 62.5)
    boxes = np.r_[np.zeros(6), 1.0, np.zeros(3), 1.0, np.zeros(3)]
    writer = RecordingWriter(path, {"settings": settings})
    state = np.zeros(400)
    for i in range(count):
        wave = np.sin(2 * np.pi * pace * i / 62.5 + phase)
        q = 0.2 * wave
        q[:, 6:] = middle + half * wave[:, 6:]
        turns = quaternion_exp(q[:, 3:].reshape(hands, 15, 3)).reshape(hands, 60)
        row = np.concatenate([np.c_[q[:, :3], turns].ravel(), boxes])
        writer.state(8 * i, state, "", row, [frozenset()] * hands)
    writer.end(8 * count, {"state_hash": ""})
    writer.close()


def write_leap(path: Path, minutes: float) -> None:
    """A simulated Leap's recording, 100 frames a second."""
    frames = leap_take(simulate_air(0), 0).frames
    length = len(frames)
    with path.open("w", encoding="utf-8") as file:
        file.write('{"metadata":{"side":"right"},"frames":[')
        for i in range(round(minutes * 60 * 100)):
            frame = replace(frames[i % length], time=0.01 * i)
            text = json.dumps(leap_message(frame, i), separators=(",", ":"))
            file.write(f"{',' if i else ''}{text}")
        file.write("]}")


def exported(recording: Path, out: Path) -> tuple[float, float, float]:
    """Seconds, seconds of the processor, and MiB of one export."""
    line = [sys.executable, "-c", CHILD, "export", str(recording), "--to", str(out)]
    done = subprocess.run(line, capture_output=True, text=True, check=True, timeout=600)
    said = next(t for t in done.stdout.splitlines() if t.startswith("MEASURED"))
    status, seconds, work, peak = json.loads(said.removeprefix("MEASURED "))
    assert status == 0, done.stderr
    return seconds, work, peak


def main() -> None:
    """Prints a line for each format."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--hands", type=int, choices=(1, 2), default=1)
    parser.add_argument("--leap", action="store_true")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--only", choices=tuple(FORMATS), nargs="*", default=tuple(FORMATS))
    options = parser.parse_args()
    print(describe_machine())
    with tempfile.TemporaryDirectory() as folder:
        recording = Path(folder) / ("leap.json" if options.leap else "session.jsonl")
        if options.leap:
            write_leap(recording, options.minutes)
        else:
            write_recording(recording, options.minutes, options.hands)
        size = recording.stat().st_size / 2**20
        hands = 1 if options.leap else options.hands
        print(f"{options.minutes:g} minutes, {hands} hand(s), recording {size:.1f} MiB")
        print(f"{'format':8}{'seconds':>9}{'cpu s':>9}{'MiB peak':>10}{'MiB file':>10}")
        for kind in options.only:
            if kind == ".asf":
                continue  # the same files as .amc
            runs = []
            for _ in range(options.repeats):
                out = Path(folder) / "out"
                out.mkdir()
                runs.append(exported(recording, out / f"hand{kind}"))
                written = sum(p.stat().st_size for p in out.iterdir()) / 2**20
                for file in out.iterdir():
                    file.unlink()
                out.rmdir()
            seconds, work, _ = np.median(runs, axis=0)
            peak = max(run[2] for run in runs)
            print(f"{kind:8}{seconds:9.1f}{work:9.1f}{peak:10.0f}{written:10.1f}", flush=True)


if __name__ == "__main__":
    main()
