"""Measures the time from a touch to its frame, over a real socket with running physics.

    python -m benchmarks.page_round_trip [--seconds 20] [--rate 60] [--pin] [--solid hand]

A plain client in a separate process sends touch messages of two moving fingers at a steady rate.
The rows:

    touch to its frame    from sending a touch to receiving the first frame with its effect: the way
                          there, reconstruction, eight steps of physics, the frame, and the way back
    there and back        a beat and its echo on the same socket, between two touches, while the
                          session runs: the whole way, without the control step
    received to step      part of the first row: the touch waits in the program for its control step
    control step          part of the first row: that step with reconstruction and physics

There is no browser and no display. A page adds the time of its drawing. `--pin` binds the server to
the first core and the client to the last one.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import platform
from pathlib import Path

import numpy as np

from benchmarks.page_client import PX_PER_IN, measure
from models.surface import Surface
from sandbox.server.page_frames import describe_scene
from sandbox.server.page_server import PageServer
from sandbox.server.web import WebDevice
from sandbox.session.messages import Snapshot
from sandbox.trial.assembly import build
from sandbox.trial.driver import LiveRun, Trial
from sandbox.trial.logs import TimedDevice, Timing
from sandbox.trial.settings import SOLID, Settings
from tasks.task import Task


def served(server: PageServer, solid: str) -> tuple[Trial, LiveRun]:
    """Returns a session with the touches of the server's page. It has not started yet."""
    size = 1024 / PX_PER_IN, 768 / PX_PER_IN
    settings = Settings().changed(solid=solid, size_in=size)
    timing = Timing(server.latency)
    device: list[WebDevice] = []

    def opened(_: Task, surface: Surface) -> TimedDevice:
        device.append(WebDevice(surface))
        return TimedDevice(device[0], timing)

    session = build(settings, (opened,))
    # The trial must outlast the measurement, whatever the time limit of its task.
    session.scorer.update = lambda *_: session.scorer.score  # type: ignore[method-assign]
    surface = session.rigs[0].reconstructor.surface
    scene = describe_scene(1, session.scene, session.task, surface, "right", "")
    server.show_scene(scene, session.scene, device[0])

    def on_step(snapshot: Snapshot) -> None:
        timing.stepped(snapshot)
        server.publish(snapshot)

    trial = Trial(session, [on_step])
    return trial, LiveRun(trial)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rate", type=float, default=60.0)
    parser.add_argument("--pin", action="store_true")
    parser.add_argument("--solid", choices=SOLID, default=SOLID[0], help="parts of the hand")
    given = parser.parse_args()

    cores = sorted(os.sched_getaffinity(0))
    server = PageServer()
    trial, live = served(server, given.solid)
    live.start()
    context = multiprocessing.get_context("spawn")
    out = context.Queue()
    core = cores[-1] if given.pin else None
    process = context.Process(
        target=measure, args=(server.url, given.seconds, given.rate, core, out)
    )
    process.start()
    if given.pin:
        for thread in Path("/proc/self/task").iterdir():
            os.sched_setaffinity(int(thread.name), {cores[0]})
    touches, echoes = out.get()
    process.join()
    live.stop()
    server.close()
    print(
        f"{platform.processor() or platform.machine()}, {len(cores)} cores"
        f"{', pinned' if given.pin else ''}, load {os.getloadavg()[0]:.1f}; "
        f"{given.rate:g} touch messages a second; solid {given.solid}"
    )
    _row("touch to its frame", np.percentile(touches, [50, 95, 99]), len(touches))
    _row("there and back", np.percentile(echoes, [50, 95, 99]), len(echoes))
    step = server.latency.percentiles()
    for name, kind in (("received to step", "waited"), ("control step", "stepped")):
        p = step[kind]
        _row(name, np.array([p.p50, p.p95, p.p99]), p.n)
    print(f"simulated {trial.session.time:.1f} s, given up {live.lost:.2f} s")


def _row(name: str, found: np.ndarray, n: int) -> None:
    p50, p95, p99 = found
    print(f"{name:<18} n {n:<6} p50 {p50:6.2f} ms  p95 {p95:6.2f}  p99 {p99:6.2f}")


if __name__ == "__main__":
    main()
