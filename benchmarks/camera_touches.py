"""How many touches a camera over a tablet names, and how many of the names are right.

Films of a rendered hand over a tablet, whose fingers are known, are shown to the camera's page in
Chromium, picture by picture; the real engine finds the hand. Prints a table: all names of a
recording, and the first names that came while it was touched. Nothing of it is of a person. Needs
Debian's chromium, OpenGL and `sandbox webcam install`.

    python -m benchmarks.camera_touches [--seeds 101 102 103]
"""

from __future__ import annotations

import argparse
import os
from dataclasses import replace

import numpy as np

from benchmarks.picture_stream import PictureStream
from benchmarks.tablet_films import CAMERAS, drawer
from encoders.captures.conversion import ConversionReport, ConversionRules, TouchLog
from encoders.captures.overhead.capture_from_camera import NamedTouches, name_touches
from encoders.captures.overhead.live_names import LiveName, LiveNames
from encoders.captures.paired.simulated import FROZEN_PAIRED, PairedSession, simulate_paired
from models.frames import LandmarkFrame
from sandbox.devices.webcam.installed import installed_engine

RATE = 12.5
"""Hz of the pictures, in the hand's own time."""
SCRIPT = replace(FROZEN_PAIRED, every=5, pause=(0.4, 0.8), open_seconds=1.5)
"""Every fifth take of the training script: about 80 touches of 20 sets of fingers in 50 s."""
LATENCY = 0.04
"""s from a moment to the browser's picture of it, assumed."""
SOON = 0.3
"""s within which a name is to come."""


def touch_log(session: PairedSession) -> TouchLog:
    """The session's touches, as they happened."""
    rows = [(f, c) for f, frame in enumerate(session.touches) for c in frame.contacts]
    first = session.touches[0].time
    arrived = session.touch_arrived[0] - session.touch_delay
    return TouchLog(
        np.array([f.time - first + arrived for f in session.touches]),
        np.array([f for f, _ in rows]),
        np.array([c.id for _, c in rows]),
        np.array([(c.x, c.y) for _, c in rows]),
    )


def live(
    session: PairedSession,
    log: TouchLog,
    frames: list[LandmarkFrame],
    took: list[float],
    named: NamedTouches,
) -> dict[int, LiveName]:
    """The first name of each touch, where pictures wait for the one before them as in the page."""
    events = [(t + session.touch_delay, 0, i) for i, t in enumerate(log.time.tolist())]
    free = 0.0
    for i, (frame, ms) in enumerate(zip(frames, took, strict=True)):
        if frame.taken + LATENCY >= free:
            free = frame.taken + LATENCY + ms / 1000.0
            events.append((free, 1, i))
    names = LiveNames(named.plane, session.side, LATENCY - session.touch_delay)
    first: dict[int, LiveName] = {}
    for arrived, kind, i in sorted(events):
        if kind == 0:
            names.touch(session.touches[i], arrived)
            continue
        for name in names.picture(frames[i], frames[i].taken + LATENCY, arrived):
            first.setdefault(name.id, name)
    return {i: name for i, name in first.items() if i in session.labels}


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[101, 102, 103])
    options = parser.parse_args()
    engine = installed_engine()
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors; time is stretched\n")
    head = ("camera", "touches", "named", "right", "first name live", "right", f"in {SOON:g} s")
    head += ("median, s", "page, ms")
    print("| " + " | ".join(head) + " |\n" + "| --- " * len(head) + "|", flush=True)
    total = np.zeros(6, int)
    for place, camera in CAMERAS.items():
        counts, waits, milliseconds = np.zeros(6, int), list[float](), list[float]()
        for seed in options.seeds:
            session = simulate_paired(seed, configuration=SCRIPT)
            assert session.skeleton is not None
            log, end = touch_log(session), float(session.motion[0][-1])
            times = np.arange(0.3, end - 0.3, 1.0 / RATE)
            with (
                drawer(session.skeleton, session.surface, camera) as draw,
                PictureStream(engine) as stream,
            ):
                poses = session.poses_at(times)
                frames = [
                    stream.look(draw.picture(q), t)
                    for t, q in zip(times.tolist(), poses, strict=True)
                ]
            named = name_touches(
                log, frames, times + LATENCY, session.side, ConversionRules(), ConversionReport()
            )
            known = [c for c in named.contacts if c.track.id in session.labels]
            first = live(session, log, frames, stream.milliseconds, named)
            counts += [
                len(known),
                sum(c.finger is not None for c in known),
                sum(c.finger == session.labels[c.track.id] for c in known),
                len(first),
                sum(n.finger == session.labels[i] for i, n in first.items()),
                sum(n.since <= SOON for n in first.values()),
            ]
            waits += [n.since for n in first.values()]
            milliseconds += stream.milliseconds
        total += counts
        row = [
            place,
            *map(str, counts),
            f"{np.median(waits):.2f}",
            f"{np.median(milliseconds):.0f}",
        ]
        print("| " + " | ".join(row) + " |", flush=True)
    print("| all | " + " | ".join(map(str, total)) + " | | |")
    print(
        f"\n{100 * total[2] / total[1]:.1f} % of the names are right, "
        f"{100 * (1 - total[1] / total[0]):.1f} % of touches have none; live, "
        f"{100 * total[5] / total[0]:.1f} % have one within {SOON:g} s, and "
        f"{100 * total[4] / max(total[3], 1):.1f} % of first names are right"
    )


if __name__ == "__main__":
    main()
