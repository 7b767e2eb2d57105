"""What the session's loop computes for one moment, against the functions for many moments.

    python -m benchmarks.one_moment

Both take turns in the same run, every time is a median of processor time, and what they return
agrees to rounding (`tests/models/test_one_pose.py`). Contacts and poses are simulated.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from statistics import median
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from benchmarks.machine import describe_machine
from encoders.regression.trained import builtin
from encoders.smoothing import common_motion, rigid_motion
from models.kinematics import Kinematics
from models.one_pose import OnePose
from models.rotations import exp, log, turned_about_normal
from models.skeleton import ADULT

ROUNDS, CALLS = 40, 100

Pair = tuple[str, Callable[[], Any], Callable[[], Any]]


def pairs() -> Sequence[Pair]:
    """What is compared: a name, the way for one moment and the way for many."""
    rng = np.random.default_rng(0)
    many, one, encoder = Kinematics(ADULT), OnePose(ADULT), builtin("best").encoder
    q = 0.3 * rng.normal(size=48)
    u = builtin("best").training_u[100]
    before = rng.uniform(0.0, 0.2, (3, 2))
    after = before + 0.001
    first, second = before.tolist(), after.tolist()
    turn = [0.0, 0.0, 0.2]
    return (
        ("fingertips and Jacobian", lambda: one.tips_and_jacobian(q),
         lambda: many.tips_and_jacobian(q)),
        ("fingertips", lambda: one.tips(q), lambda: many.tips(q)),
        ("pose by `best`", lambda: encoder.predict(u), lambda: encoder.predict(u[None])),
        ("common motion of three touches", lambda: common_motion(first, second),
         lambda: rigid_motion(before, after)),
        ("a rotation vector turned", lambda: turned_about_normal(q[3:6], 0.2),
         lambda: log(exp(turn) @ exp(q[3:6]))),
    )  # fmt: skip


def timed(call: Callable[[], Any]) -> float:
    """Processor s of a call, on average over some."""
    begin = time.process_time()
    for _ in range(CALLS):
        call()
    return (time.process_time() - begin) / CALLS


def main() -> None:
    """Prints the table."""
    print(describe_machine())
    print("\n| for one moment | us | as one of many, us | ratio |")
    print("| --- | --- | --- | --- |")
    for name, one, many in pairs():
        times = [(timed(one), timed(many)) for _ in range(ROUNDS)]
        quick, slow = (1e6 * median(t[i] for t in times) for i in range(2))
        print(f"| {name} | {quick:.1f} | {slow:.1f} | {slow / quick:.1f} |")


if __name__ == "__main__":
    main()
