"""What Lab Streaming Layer costs the session's loop: processor time of its calls, at real time.

Usage: python -m benchmarks.lsl [SECONDS]
"""

from __future__ import annotations

import sys
import time

import numpy as np

from benchmarks.machine import describe_machine
from models.frames import Contact, TouchFrame
from models.scene import CONTROL_PERIOD
from sandbox.lsl.lsl import LslOutlets


def main(seconds: float) -> None:
    """Prints the cost of a period with a touch frame and a pose."""
    outlets = LslOutlets()
    frame = TouchFrame(0.0, tuple(Contact(i, 0.01 * i, 0.02) for i in range(5)))
    pose = np.linspace(0.0, 1.0, 48)
    cost = []
    began = time.monotonic()
    for step in range(round(seconds / CONTROL_PERIOD)):
        before = time.thread_time()
        outlets.input(step, step * CONTROL_PERIOD, 0, frame)
        outlets.pose(step, step * CONTROL_PERIOD, 0, pose)
        cost.append(time.thread_time() - before)
        time.sleep(max(0.0, began + (step + 1) * CONTROL_PERIOD - time.monotonic()))
    outlets.close()
    found = 1e6 * np.array(cost)
    print(describe_machine())
    print(
        f"{len(found)} periods: mean {found.mean():.0f} us, p99 {np.percentile(found, 99):.0f} us"
    )


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 30.0)
