"""What one control step costs, part by part, and a whole run against real time.

    python -m benchmarks.whole_run

Every time is a median; the ratio beside it is against the physics of the same run, which is the
peer: the rest of the program is to cost less than the simulation it feeds.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from statistics import median
from typing import Any

import mujoco

os.environ.setdefault("OMP_NUM_THREADS", "1")


def timed(owner: Any, name: str, into: dict[str, list[float]]) -> None:
    """Replaces a method by itself with a stopwatch."""
    method: Callable[..., Any] = getattr(owner, name)

    def measured(*args: Any, **kwargs: Any) -> Any:
        begin = time.perf_counter()
        try:
            return method(*args, **kwargs)
        finally:
            into.setdefault(name, []).append(time.perf_counter() - begin)

    setattr(owner, name, measured)


def main() -> None:
    """Prints the table."""
    from benchmarks.machine import describe_machine
    from sandbox.assembly import build
    from sandbox.cli.scene_options import SceneOptions, plan

    print(describe_machine())
    print("| fingers | control step | reconstruction | physics | labels, an event | real time |")
    print("| --- | --- | --- | --- | --- | --- |")
    for fingers in (2, 3, 5):
        steps: dict[str, list[float]] = {}
        physics: list[float] = []
        simulated = wall = 0.0
        for seed in range(4):
            chosen = plan(SceneOptions(seed=seed, fingers=fingers))
            session = build(chosen.settings, chosen.make_device)
            rig: Any = session.rigs[0]
            timed(rig.reconstructor, "step", steps)
            timed(rig.reconstructor.labeller, "assign", steps)
            begin = time.perf_counter()
            while not session.over:
                snapshot = session.advance()
                rig.device.show(snapshot)
            wall += time.perf_counter() - begin
            simulated += session.time
            # The peer: the same model stepped alone, from where the run ended.
            for _ in range(50):
                start = time.perf_counter()
                mujoco.mj_step(session.scene.model, session.data, session.scene.substeps)
                physics.append(time.perf_counter() - start)
        control = wall / (simulated / 0.016)
        peer = median(physics)
        cells = [control, median(steps["step"]), peer, median(steps["assign"])]
        text = " | ".join(f"{1e3 * c:.2f} ms ({c / peer:.1f})" for c in cells)
        print(f"| {fingers} | {text} | {simulated / wall:.1f} x |")


if __name__ == "__main__":
    main()
