"""Measures the cost of learning an encoder: seconds, and the peak memory of the process.

Every fit runs in a process of its own, so that its peak is its own. Many frames come in blocks from
a stream, as they would from files. Contact vectors are those of random layouts of all 26 sets of
fingers; the other inputs are 15 numbers that are not contact vectors. Outputs are waves of inputs
with noise: a fit's time does not depend on values.

    python -m benchmarks.fitting contacts 2 1000000      # or `others`; degree, frames
"""

from __future__ import annotations

import json
import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter

import numpy as np

from encoders.captures.subject.script import SETS
from encoders.input_vector import contact_vectors
from encoders.regression.polynomial import PolynomialEncoder
from models.arithmetic.arrays import Array
from models.pose import POSE_SIZE

BLOCK = 50_000
"""Frames."""


KINDS = ("contacts", "others")


def frames(kind: str, count: int, seed: int) -> tuple[Array, Array]:
    """Inputs (count, 15) and outputs (count, 48)."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, 0.15, (count, 5, 2))
    lifted = np.ones((len(SETS), 5), bool)
    for i, fingers in enumerate(SETS):
        lifted[i, list(fingers)] = False
    xy[lifted[rng.integers(0, len(SETS), count)]] = np.nan
    U = contact_vectors(xy)[0]
    if kind == "others":
        U += rng.normal(0, 0.1, U.shape)
    law = np.random.default_rng(0).normal(size=(len(U[0]), POSE_SIZE))
    return U, np.sin(0.3 * U @ law) + 0.1 * rng.normal(size=(count, POSE_SIZE))


def measure(kind: str, degree: int, count: int) -> dict[str, float]:
    """Fits once, in this process."""
    spent = 0.0

    def blocks() -> Iterator[tuple[Array, Array]]:
        nonlocal spent
        for start in range(0, count, BLOCK):
            before = perf_counter()
            block = frames(kind, min(BLOCK, count - start), start)
            spent += perf_counter() - before
            yield block

    start = perf_counter()
    encoder = PolynomialEncoder(degree).fit_blocks(blocks())
    # Making the frames up is not part of the fit.
    seconds = perf_counter() - start - spent
    # ru_maxrss would also count what the parent held when this process was forked.
    status = Path("/proc/self/status").read_text()
    peak = int(status.split("VmHWM:")[1].split()[0]) / 1024
    return {"seconds": seconds, "peak_mib": peak, "rank": encoder.rank_}


def measured_apart(kind: str, degree: int, count: int) -> dict[str, float]:
    """Fits once, in a new process."""
    command = [sys.executable, "-m", "benchmarks.fitting", kind, str(degree), str(count)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found: dict[str, float] = json.loads(done.stdout)
    return found


if __name__ == "__main__":
    print(json.dumps(measure(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))))
