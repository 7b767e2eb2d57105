"""Measures the share of a reader's time that the checks of plausibility take.

    python -m benchmarks.plausibility            # needs the extra `test`

Each file is read in turns with `models.plausible` and with functions that check nothing in its
place. The shortest time of each kind counts. Packets of a capture are decoded while it plays. Files
have a minute of one hand, or of two fingers with sizes.
"""

from __future__ import annotations

import argparse
import gc
import json
import math
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import process_time
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.machine import describe_machine
from encoders.captures.conversion.hand_files import Mapping, read_points, read_poses
from models.errors import FrameError
from models.frames import FINGERS, Contact, TouchFrame
from models.reader_report import ReaderReport
from models.surface import Surface
from sandbox.devices.files.frame_file import TouchLine, frame_record, header_record, read_frame_file
from sandbox.devices.leap.leap_file import read_leap
from sandbox.devices.leap.leap_write import leap_message
from sandbox.devices.tuio.touch_capture import CaptureDevice, read_capture
from sandbox.devices.webcam.landmarks import header_record as camera_record
from sandbox.devices.webcam.landmarks import message_of, read_landmarks
from tests.encoders.air.seen_hands import film, held_up
from tests.sandbox.devices.test_mutations_of_touches import capture, packets11
from tests.sandbox.devices.test_strange_hands import CAMERA
from tests.support.hand_recording import (
    QUALISYS,
    markers,
    played,
    write_bvh,
    write_pose_table,
    write_tsv,
)
from tests.support.leap_hands import take

SECONDS = 60


def _any_contact(reader: Any, touch: TouchLine) -> Contact:
    """Returns the contact of a touch on the surface, without a check of its size."""
    metre = reader._metre
    x, y = metre * touch.x, metre * touch.y
    if not (0.0 <= x <= reader._size[0] and 0.0 <= y <= reader._size[1]):
        raise FrameError("positions beyond the surface")
    size = extent = None
    if touch.size is not None:
        size = metre * touch.size
    if touch.width is not None and touch.height is not None:
        extent = metre * touch.width, metre * touch.height
    label = None
    if touch.finger is not None:
        label = FINGERS.index(touch.finger)
    return Contact(touch.id, x, y, size, label, extent)


def _declared(_seen: Any, declared: Any, *_: Any, **__: Any) -> dict[str, str]:
    return dict(declared)


def _as_they_are(rows: Any, *_: Any) -> Any:
    return rows


def _nothing(*_: Any, **__: Any) -> dict[Any, Any]:
    return {}


def _no_jumps(_time: Any, places: Any) -> Any:
    return np.zeros(places.shape[:2], bool)


UNCHECKED: dict[str, Any] = {
    "sandbox.devices.files.frame_file._Reader._contact": _any_contact,
    "sandbox.devices.files.frame_file.in_order": _as_they_are,
    "sandbox.devices.files.frame_file._units": lambda *_: {"time": "s", "length": "in"},
    "sandbox.devices.tuio.touch_capture.in_order": _as_they_are,
    "sandbox.devices.tuio.touch_capture._second": lambda *_: 1.0,
    "sandbox.devices.leap.leap_file.find_leap_units": lambda *_: (
        {"length": "mm", "time": "us"},
        0,
    ),
    "sandbox.devices.webcam.landmarks.find_units": _declared,
    "sandbox.devices.webcam.landmarks.quantities": _nothing,
    "sandbox.devices.webcam.landmarks._doubt_pictures": _nothing,
    "sandbox.devices.webcam.landmarks.PossibleHands.only": lambda _, frame, *__: frame,
    "models.plausible.HandJumps.find": lambda *_: set(),
    "models.plausible.SideDoubt.due": lambda _: False,
    "encoders.captures.conversion.hand_files.find_units": _declared,
    "encoders.captures.conversion.hand_files.find_jumps": _no_jumps,
    "encoders.captures.conversion.hand_files._side_doubt": lambda *_: "",
}
"""Name of a function that uses `models.plausible` -> a function without checks."""


@contextmanager
def unchecked() -> Iterator[None]:
    """Replaces the checks of all readers by functions that check nothing."""
    with ExitStack() as stack:
        for name, other in UNCHECKED.items():
            stack.enter_context(patch(name, other))
        yield


def touches(count: int) -> list[dict[str, Any]]:
    """Returns the lines of a recording of two fingers with sizes, with `count` frames."""
    frames = [
        TouchFrame(
            n / 60,
            tuple(
                Contact(i, 0.05 + 0.03 * i + 0.02 * math.sin(n / 40), 0.07, None, None, extent)
                for i, extent in enumerate(((0.008, 0.010), (0.009, 0.011)))
            ),
        )
        for n in range(count)
    ]
    return [header_record(Surface(), "page"), *map(frame_record, frames)]


def files(folder: Path, seconds: int) -> dict[str, Callable[[], object]]:
    """Writes files of all formats with `seconds` s. Returns name of the format -> function that
    reads it."""
    leap = take(3, "v3").frames
    pictures = film([held_up(2.0 * (i % 60)) for i in range(20 * seconds)], CAMERA)
    lines: dict[str, list[Any]] = {
        "touches.jsonl": touches(60 * seconds),
        "capture.jsonl": [
            {**row, "t": row["t"] + turn} for turn in range(seconds) for row in capture(packets11)
        ],
        "leap.jsonl": [
            leap_message(leap[i % len(leap)], i + 1) | {"timestamp": 10_000 * i}
            for i in range(100 * seconds)
        ],
        "landmarks.jsonl": [
            camera_record(CAMERA),
            *(
                message_of(frame) | {"time": i / 20, "taken": i / 20}
                for i, frame in enumerate(pictures)
            ),
        ],
    }
    for name, rows in lines.items():
        (folder / name).write_text("\n".join(map(json.dumps, rows)) + "\n")
    truth = played(float(max(seconds, 2)), seed=3)
    write_bvh(folder / "hand.bvh", truth)
    write_tsv(folder / "hand.tsv", markers(truth))
    write_pose_table(folder / "hand.csv", truth.time, truth.q)
    return {
        "recorded touches": lambda: read_frame_file(folder / "touches.jsonl"),
        "TUIO capture": lambda: CaptureDevice(
            read_capture(folder / "capture.jsonl"), Surface()
        ).poll(math.inf),
        "Leap": lambda: read_leap(folder / "leap.jsonl"),
        "landmarks": lambda: read_landmarks(folder / "landmarks.jsonl"),
        "BVH": lambda: read_points(folder / "hand.bvh", Mapping({})),
        "TSV": lambda: read_points(folder / "hand.tsv", Mapping(dict(QUALISYS))),
        "CSV": lambda: read_poses(folder / "hand.csv", "", ReaderReport()),
    }


def spent(read: Callable[[], object]) -> float:
    """Returns the processor time (s) of a function."""
    gc.collect()
    begun = process_time()
    read()
    return process_time() - begun


def cost(read: Callable[[], object], pairs: int) -> tuple[float, float]:
    """Returns the shortest time (s) of reading with the checks, and its difference (s) from the
    shortest time without.

    Args:
        read: Reads the file.
        pairs: Number of readings of each kind.
    """
    whole, without = [], []
    for pair in range(pairs):
        if pair % 2:
            checked = spent(read)
        with unchecked():
            bare = spent(read)
        if pair % 2 == 0:
            checked = spent(read)
        whole.append(checked)
        without.append(bare)
    return min(whole), min(whole) - min(without)


def main() -> None:
    """Prints a line for each format."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--seconds", type=int, default=SECONDS, help="length of the files (s)")
    parser.add_argument("--pairs", type=int, default=30, help="number of readings of each kind")
    parser.add_argument("--only", default="", help="formats whose name contains this text")
    options = parser.parse_args()
    print(describe_machine())
    print("| file | reading, ms | of it checks, ms | share, % |\n| --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for name, read in files(Path(folder), options.seconds).items():
            if options.only not in name:
                continue
            read()
            whole, more = cost(read, options.pairs)
            print(
                f"| {name} | {1e3 * whole:.2f} | {1e3 * more:.3f} | {100 * more / whole:.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
