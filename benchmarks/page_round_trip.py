"""How long a touch takes to come back as a frame, over a real socket with physics running.

    python -m benchmarks.page_round_trip [--seconds 20] [--rate 60]

A plain client in a process of its own sends touch messages at a steady rate, two fingers that move,
and waits for the first frame that says the message took effect. No browser, no display; what a page
adds is its own drawing. Beside it, in the same run, an echo of the same socket: what the transport
and the machine cost while a session runs, without a control step in between.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import platform
import threading
import time
from contextlib import ExitStack
from dataclasses import replace
from typing import Any
from urllib.parse import urlsplit

import numpy as np
from websockets.sync.client import connect

from sandbox.assembly import build
from sandbox.devices.web import WebDevice
from sandbox.live import LiveSession
from sandbox.server.describe import describe_scene
from sandbox.server.frames import unpack
from sandbox.server.page_server import PageServer
from sandbox.settings import RunSettings

PX_PER_IN = 132.0
SCREEN = {"px_per_in": PX_PER_IN, "width_px": 1024, "height_px": 768, "calibrated": True}


def client(url: str, seconds: float, rate: float, out: Any) -> None:
    """Sends touches and beats, and puts the milliseconds of both round trips into `out`."""
    parts = urlsplit(url)
    stack = ExitStack()
    socket = stack.enter_context(
        connect(
            f"ws://{parts.netloc}/?{parts.query}", origin=f"http://{parts.netloc}", compression=None
        )
    )
    hello = {"type": "hello", "protocol": 1, "client": "bench", "role": "player", "screen": SCREEN}
    socket.send(json.dumps(hello))
    sent: dict[int, float] = {}
    touches, echoes = [], []
    lock = threading.Lock()
    done = threading.Event()

    def receive() -> None:
        for message in socket:
            now = time.perf_counter()
            if isinstance(message, bytes):
                frame = unpack(message)
                with lock:
                    socket.send(json.dumps({"type": "got", "frame": frame.number}))
                    for seq in [s for s in sent if s <= frame.touch]:
                        touches.append((now - sent.pop(seq)) * 1e3)
            else:
                answer = json.loads(message)
                if answer["type"] == "echo":
                    echoes.append((now - answer["t"] / 1e3) * 1e3)
            if done.is_set():
                return

    reader = threading.Thread(target=receive, daemon=True)
    reader.start()
    start = time.perf_counter()
    seq = 0
    while (now := time.perf_counter() - start) < seconds:
        seq += 1
        x, y = 500 + 60 * np.cos(2 * now), 380 + 60 * np.sin(2 * now)
        contacts = [[1, x - 80, y + 60, 20.0], [2, x + 60, y - 60, 20.0]]
        message = {"type": "touches", "seq": seq, "t": now * 1e3, "contacts": contacts}
        with lock:
            sent[seq] = time.perf_counter()
            socket.send(json.dumps(message))
            if seq % 2 == 0:
                socket.send(json.dumps({"type": "beat", "t": time.perf_counter() * 1e3}))
        time.sleep(max(0.0, start + seq / rate - time.perf_counter()))
    done.set()
    time.sleep(0.1)
    stack.close()
    out.put((touches, echoes))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rate", type=float, default=60.0)
    given = parser.parse_args()

    server = PageServer()
    settings = replace(RunSettings(), surface_in=(1024 / PX_PER_IN, 768 / PX_PER_IN))
    session = build(settings, lambda task, surface: WebDevice(surface, server.latency))
    # The trial must outlast the measurement, whatever the time limit of its task.
    session.scorer.update = lambda *_: session.scorer.score  # type: ignore[method-assign]
    device = session.rigs[0].device
    assert isinstance(device, WebDevice)
    surface = session.rigs[0].reconstructor.surface
    server.show_scene(
        describe_scene(1, session.scene, session.task, surface, "right", ""), session.scene, device
    )
    live = LiveSession(session, server.publish, news=device.news)
    live.start()
    context = multiprocessing.get_context("spawn")
    out = context.Queue()
    process = context.Process(target=client, args=(server.url, given.seconds, given.rate, out))
    process.start()
    touches, echoes = out.get()
    process.join()
    live.stop()
    server.close()
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores, "
          f"load {os.getloadavg()[0]:.1f}; {given.rate:g} touch messages a second")  # fmt: skip
    for name, values in (("touch to frame", touches), ("echo alone", echoes)):
        p50, p95, p99 = np.percentile(values, [50, 95, 99])
        print(f"{name:<15} n {len(values):<6} p50 {p50:6.2f} ms  p95 {p95:6.2f}  p99 {p99:6.2f}")
    print(f"simulated {session.time:.1f} s, given up {live.lost:.2f} s")


if __name__ == "__main__":
    main()
