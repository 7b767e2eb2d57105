"""How many touches a camera over a tablet names, and how many of the names are right.

Films of a rendered hand over a tablet, whose fingers are known, are shown to the camera's page in
Chromium, picture by picture; the real engine finds the hand. Prints a table: all names of a
recording, and the first names that came while it was touched. Nothing of it is of a person. Needs
Debian's chromium, OpenGL and `sandbox webcam install`.

    python -m benchmarks.camera_touches [--seeds 103 104] [--cameras above leaning turned]
                                        [--keep FOLDER]

`--keep` writes what the page said of each film to a folder, or reads it from there: a film takes
minutes, names take seconds.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.picture_stream import PictureStream
from benchmarks.tablet_films import CAMERAS, drawer
from encoders.captures.conversion import ConversionReport, ConversionRules, TouchLog
from encoders.captures.overhead.capture_from_camera import NamedTouches, name_touches
from encoders.captures.overhead.live_names import LiveName, LiveNames
from encoders.captures.paired.simulated import FROZEN_PAIRED, PairedSession, simulate_paired
from encoders.webcam.camera import Camera
from models.arithmetic.arrays import Array
from models.errors import CaptureError
from models.frames import LandmarkFrame
from sandbox.devices.webcam.installed import installed_engine
from sandbox.devices.webcam.landmark_file import header_record, read_landmarks
from sandbox.devices.webcam.landmarks_json import message_of

RATE = 12.5
"""Hz of the pictures, in the hand's own time."""
SCRIPT = replace(FROZEN_PAIRED, every=5, pause=(0.4, 0.8), open_seconds=1.5)
"""Every fifth take of the training script: about 80 touches of 20 sets of fingers in 50 s."""
LATENCY = 0.04
"""s from a moment to the browser's picture of it, assumed."""
SOON = 0.3
"""s within which a name is to come."""


@dataclass(frozen=True)
class Film:
    """A session before the camera.

    Attributes:
        session: The simulated person's.
        frames: What the page said of each picture, at the moment that it shows.
        took: s that the page took for each picture.
    """

    session: PairedSession
    frames: tuple[LandmarkFrame, ...]
    took: tuple[float, ...]

    @property
    def taken(self) -> Array:
        """(F,) s at which the browser has the pictures."""
        return np.array([f.taken for f in self.frames]) + LATENCY

    @property
    def log(self) -> TouchLog:
        """The session's touches, as they happened."""
        touches = self.session.touches
        rows = [(f, c) for f, frame in enumerate(touches) for c in frame.contacts]
        first = self.session.touch_arrived[0] - self.session.touch_delay
        return TouchLog(
            np.array([f.time - touches[0].time for f in touches]) + first,
            np.array([f for f, _ in rows]),
            np.array([c.id for _, c in rows]),
            np.array([(c.x, c.y) for _, c in rows]),
        )


@dataclass(frozen=True)
class Counts:
    """Touches, and their names: `named` and `right` of the whole recording, the others live."""

    touches: int = 0
    named: int = 0
    right: int = 0
    live: int = 0
    live_right: int = 0
    soon: int = 0

    def __add__(self, other: Counts) -> Counts:
        return Counts(*(a + b for a, b in zip(self.cells(), other.cells(), strict=True)))

    def cells(self) -> tuple[int, ...]:
        """The numbers in the table's order."""
        return self.touches, self.named, self.right, self.live, self.live_right, self.soon


def filmed(seed: int, camera: Camera, kept: Path | None) -> Film:
    """One person's session before one camera; what the page says is read from a file, or written
    there."""
    session = simulate_paired(seed, configuration=SCRIPT)
    if kept is None or not kept.is_file():
        frames, took = _shown(session, camera)
        if kept is None:
            return Film(session, frames, took)
        kept.parent.mkdir(parents=True, exist_ok=True)
        said = [
            header_record(camera),
            *(message_of(replace(f, time=f.time + s)) for f, s in zip(frames, took, strict=True)),
        ]
        kept.write_text("".join(json.dumps(line) + "\n" for line in said), encoding="utf-8")
    recorded = read_landmarks(kept).frames
    frames = tuple(replace(f, time=f.taken) for f in recorded)
    return Film(session, frames, tuple(f.time - f.taken for f in recorded))


def _shown(
    session: PairedSession, camera: Camera
) -> tuple[tuple[LandmarkFrame, ...], tuple[float, ...]]:
    assert session.skeleton is not None
    times = np.arange(0.3, float(session.motion[0][-1]) - 0.3, 1.0 / RATE)
    with (
        drawer(session.skeleton, session.surface, camera) as draw,
        PictureStream(installed_engine()) as stream,
    ):
        frames = tuple(
            stream.look(draw.picture(q), t)
            for t, q in zip(times.tolist(), session.poses_at(times), strict=True)
        )
    return frames, tuple(ms / 1000.0 for ms in stream.milliseconds)


def live_names(film: Film, named: NamedTouches) -> dict[int, LiveName]:
    """The first name of each touch, where pictures wait for the one before them as in the page."""
    session, log = film.session, film.log
    events = [(t + session.touch_delay, 0, i) for i, t in enumerate(log.time.tolist())]
    free = 0.0
    for i, (taken, seconds) in enumerate(zip(film.taken.tolist(), film.took, strict=True)):
        if taken >= free:
            free = taken + seconds
            events.append((free, 1, i))
    names = LiveNames(named.plane, session.side, LATENCY - session.touch_delay)
    first: dict[int, LiveName] = {}
    for arrived, kind, i in sorted(events):
        if kind == 0:
            names.touch(session.touches[i], arrived)
            continue
        for name in names.picture(film.frames[i], film.taken[i], arrived):
            first.setdefault(name.id, name)
    return {i: name for i, name in first.items() if i in session.labels}


def counted(film: Film) -> tuple[Counts, list[float], str]:
    """Counts of one film, s from each landing to its first name live, and how the clocks agree.

    Raises:
        CaptureError: The recording was refused.
    """
    session, rules, report = film.session, ConversionRules(), ConversionReport()
    named = name_touches(film.log, film.frames, film.taken, session.side, rules, report)
    known = [c for c in named.contacts if c.track.id in session.labels]
    first = live_names(film, named)
    counts = Counts(
        len(known),
        sum(c.finger is not None for c in known),
        sum(c.finger == session.labels[c.track.id] for c in known),
        len(first),
        sum(n.finger == session.labels[i] for i, n in first.items()),
        sum(n.since <= SOON for n in first.values()),
    )
    clocks = f"{1000 * (named.clock.offset - LATENCY):+.0f} ms"
    return counts, [n.since for n in first.values()], clocks


def _line(cells: Sequence[object]) -> str:
    return "| " + " | ".join(map(str, cells)) + " |"


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, nargs="+", default=[103, 104])
    parser.add_argument("--cameras", nargs="+", choices=list(CAMERAS), default=list(CAMERAS))
    parser.add_argument("--keep", type=Path)
    options = parser.parse_args()
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors; time is stretched\n")
    head = ["camera", "seed", "touches", "named", "right", "first name live", "right"]
    head += [f"in {SOON:g} s", "median, s", "page, ms", "clocks off by"]
    print(_line(head) + "\n" + _line(["---"] * len(head)), flush=True)
    total, refused = Counts(), 0
    for place in options.cameras:
        for seed in options.seeds:
            kept = options.keep and options.keep / f"{place}-{seed}.jsonl"
            film = filmed(seed, CAMERAS[place], kept)
            page = f"{1000 * np.median(film.took):.0f}"
            try:
                counts, waits, clocks = counted(film)
            except CaptureError as error:
                refused += 1
                print(_line([place, seed, f"refused: {error}", *[""] * 6, page, ""]), flush=True)
                continue
            total += counts
            wait = f"{np.median(waits):.2f}" if waits else ""
            print(_line([place, seed, *counts.cells(), wait, page, clocks]), flush=True)
    print(_line(["all", "", *total.cells(), "", "", ""]))
    if not total.named or not total.live:
        return
    print(
        f"\n{100 * total.right / total.named:.1f} % of the names are right, "
        f"{100 * (1 - total.named / total.touches):.1f} % of touches have none; live, "
        f"{100 * total.soon / total.touches:.1f} % have one within {SOON:g} s, and "
        f"{100 * total.live_right / total.live:.1f} % of first names are right; "
        f"{refused} recordings were refused"
    )


if __name__ == "__main__":
    main()
