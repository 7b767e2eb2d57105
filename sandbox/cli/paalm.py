"""`sandbox paalm`: joint angles of hands over a Leap, and calibration."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from cyclopts import Parameter
from rich.console import Console
from rich.progress import Progress
from rich.text import Text

from encoders.paalm import PAPER, Paalm, PaalmFrame, PaalmOptions
from encoders.paalm.average import average_calibration, calibrate_on_recording, knows_bones
from encoders.paalm.calibration import PAPER_FRAMES, HandCalibration
from encoders.paalm.calibration_file import read_calibration, write_calibration
from models.errors import InputError
from models.frames import SIDES, HandFrame
from models.reader_report import ReaderReport
from sandbox.cli.common.command_line import application, run
from sandbox.cli.common.json_out import refuse_replacing
from sandbox.devices.files import show_report
from sandbox.devices.leap import DEFAULT_ADDRESS
from sandbox.devices.leap.guided_calibration import save_calibrations
from sandbox.devices.leap.leap import LeapDevice, LeapFileDevice
from sandbox.devices.leap.leap_file import doubt_of_side, read_leap
from sandbox.devices.leap.leap_write import GENERATOR
from sandbox.trial.profiles import DEFAULT, own_calibration_path
from sandbox.views.paalm.paalm_pictures import check_picture, show_pictures

SCHEMA = 1
HEADER = (
    "columns: time (s), hand, then for each finger, in degrees: flexion and spread of the first "
    "joint, flexion of the middle joint, flexion of the last joint. - marks a finger that is not "
    "visible"
)
"""Text before the lines of angles."""


def main(argv: list[str]) -> int:
    """Runs `sandbox paalm ...`; returns the exit status."""
    about = "PAALM (paper of 2013): joint angles from directions and lengths of fingers."
    return int(run(application("sandbox paalm", about, show, calibrate), argv) or 0)


Hands = Literal["right", "left", "both"]


def show(
    file: Annotated[Path | None, Parameter(metavar="FILE")] = None,
    *,
    device: Literal["leap"] | None = None,
    address: Annotated[str, Parameter(metavar="URL")] = DEFAULT_ADDRESS,
    hands: Hands = "right",
    frames: int | None = None,
    calibration: Annotated[Path | None, Parameter(metavar="FILE")] = None,
    method: Literal["default", "paper"] = "default",
    as_json: Annotated[bool, Parameter(name="json")] = False,
    seconds: float = math.inf,
    view: Literal["text", "window", "web"] = "text",
    picture: Annotated[Path | None, Parameter(metavar="FILE.png|.jpg|.webp")] = None,
    port: int = 0,
    unit: Annotated[str, Parameter(metavar="UNIT,...")] = "",
) -> int:
    """Shows the joint angles of every frame, as text or as pictures.

    --view window and --view web (a page for browsers on this machine) draw two pictures side by
    side: the device's data (finger vectors, the palm's normal and sphere, vanished fingers dimmed)
    and the hand that PAALM computes, with its angles. A recording is played at its own speed.

    Without --calibration, the bone lengths that the device reports are used. If it reports none,
    the hand is measured in the first frames with five fingers, in which it must be open. If a
    recorded hand is not open, an average hand is used, with a message. --json prints a line per
    frame, with angles in degrees:
    {"time", "hands": {side: {"angles", "ratios", "ids", "held", "seen"}}}.

    Try:

        sandbox devices leap simulate --out hand.json
        sandbox paalm show hand.json
        sandbox paalm show hand.json --view window

    Args:
        file: A Leap recording. Or use --device.
        device: leap: a running service.
        address: WebSocket address of the service.
        hands: Sides of the hands that are visible.
        frames: Number of frames in which the hand is measured. Default: 1000 frames of a device, as
            in the paper, or 20 to 100 frames of a file.
        calibration: Calibration by `sandbox paalm calibrate --out`.
        method: paper: the method as printed in the paper. default: with changes that gave smaller
            errors.
        as_json: Print JSON lines.
        seconds: Stop after this many seconds, by the times of the frames.
        view: text: lines of angles. window, web: pictures.
        picture: File for a picture of the last frame; --seconds chooses an earlier one.
        port: TCP port of the page; 0 takes a free one.
        unit: Units of FILE, such as cm,ms. Default: units for which the hand's size and the frames'
            rate are possible.
    """
    _check(file, device, frames, seconds)
    check_picture(picture)
    if as_json and (view != "text" or picture is not None):
        raise InputError(
            "pictures cannot be written as JSON",
            where="--json",
            got="--picture" if view == "text" else f"--view {view}",
            expected="--view text without --picture",
        )
    source = _Source(file, address, unit)
    paalm = Paalm(PAPER if method == "paper" else PaalmOptions())
    try:
        stream = source.frames()
        if calibration is not None:
            paalm.use(read_calibration(calibration))
        else:
            if file is not None and frames is None:
                recorded = list(stream)
                why = calibrate_on_recording(paalm, recorded, hands)
                doubt = "" if hands == "both" else doubt_of_side(recorded, hands, "--hands")
                for told in filter(None, (doubt, why)):
                    Console(stderr=True).print(Text(told))
            elif frames is not None or not _has_bones(paalm, source, hands):
                _measure(paalm, stream, hands, frames or PAPER_FRAMES)
            if file is not None:
                stream = source.frames()
        if view != "text" or picture is not None:
            show_pictures(
                paalm,
                stream,
                view,
                recorded=file is not None,
                caption=source.caption,
                seconds=seconds,
                picture=picture,
                port=port,
            )
            return 0
        if not as_json:
            print(HEADER)
        begin: float | None = None
        for frame in stream:
            begin = frame.time if begin is None else begin
            if frame.time - begin > seconds:
                break
            _print(paalm.step(frame), as_json)
    except KeyboardInterrupt:
        return 0  # the usual way to end
    finally:
        source.close()
        source.report(paalm)
    return 0


def calibrate(
    file: Annotated[Path | None, Parameter(metavar="FILE")] = None,
    *,
    hands: Hands,
    device: Literal["leap"] | None = None,
    address: Annotated[str, Parameter(metavar="URL")] = DEFAULT_ADDRESS,
    frames: int = PAPER_FRAMES,
    out: Annotated[Path | None, Parameter(metavar="FILE")] = None,
    unit: Annotated[str, Parameter(metavar="UNIT,...")] = "",
) -> int:
    """Measures your hands: hold them open, palm down, fingers spread, 20 cm above the device.

    Args:
        file: A Leap recording. Default: the running service.
        hands: Sides of the hands.
        device: leap: a running service; the default without a FILE.
        address: WebSocket address of the service.
        frames: Number of frames with five fingers; 1000 in the paper, about 10 seconds.
        out: File for the calibration, as JSON. `default` is this user's own file, which
            `sandbox play --device leap` uses automatically.
        unit: Units of FILE, such as cm,ms. Default: units for which the hand's size and the frames'
            rate are possible.
    """
    _check(file, device or (None if file else "leap"), frames, math.inf)
    own = out == Path(DEFAULT)
    if out is not None and not own and not out.absolute().parent.is_dir():
        raise InputError(
            "no such folder", where=f"--out {out}", remedy="Create it, or name another"
        )
    if not own:
        refuse_replacing(out, {"FILE": file})
    source = _Source(file, address, unit)
    paalm = Paalm()
    try:
        calibrations = _measure(paalm, source.frames(), hands, frames)
    finally:
        source.close()
        source.report(paalm)
    if own:
        known = read_calibration(own_calibration_path()) if own_calibration_path().exists() else {}
        save_calibrations({**known, **calibrations}, own_calibration_path())
    elif out is not None:
        write_calibration(calibrations, out)
    summary = {
        side: {
            "standard_mm": [round(1000 * v, 2) for v in c.standard.tolist()],
            "spread_mm": [round(1000 * v, 2) for v in c.spread.tolist()],
            "frames": c.frames,
            "seconds": round(c.seconds, 3),
            "left_out": c.left_out,
        }
        for side, c in calibrations.items()
    }
    print(json.dumps({"schema": SCHEMA, "hands": summary}))
    return 0


class _Source:
    """Frames of a recording or of the live device."""

    def __init__(self, file: Path | None, address: str, unit: str) -> None:
        self._file = None if file is None else read_leap(file, unit)
        self._live = LeapDevice(address) if file is None else None
        self._address = address

    @property
    def caption(self) -> str:
        """Caption of a picture: the source of its frames."""
        if self._file is None:
            return f"live: {self._address}"
        made = str(self._file.metadata.get("generatedBy", ""))
        return "SIMULATED: not a real hand" if made == GENERATOR else "a recording"

    def frames(self) -> Iterator[HandFrame]:
        if self._file is not None:
            yield from LeapFileDevice(self._file).poll(math.inf)
            return
        assert self._live is not None
        yield from self._live.follow()

    def close(self) -> None:
        if self._live is not None:
            self._live.close()

    def report(self, paalm: Paalm) -> None:
        """Prints a report of unusable data on stderr, then raises the damage of a file, if any."""
        report = ReaderReport()
        if source := self._live or self._file:
            report.add(source.report)
        report.add_counts({k: n for k, n in paalm.counts.items() if k != "frames"})
        show_report(report)
        if self._file is not None and self._file.damage is not None:
            raise self._file.damage


def _measure(
    paalm: Paalm, stream: Iterator[HandFrame], hands: Hands, wanted: int
) -> dict[str, HandCalibration]:
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        job = bar.add_task("hold your hand open and still", total=1.0)
        return paalm.calibrate(
            stream, hands, wanted, lambda share: bar.update(job, completed=share)
        )


def _has_bones(paalm: Paalm, source: _Source, hands: Hands) -> bool:
    """Waits for the hands; True if the device reports their bones, which PAALM then uses."""
    sides = SIDES if hands == "both" else (hands,)
    # For every side, the first frame with bones.
    seen: list[HandFrame] = []
    for frame in source.frames():
        if not any(hand.fingers for hand in frame.hands):
            continue
        new = [s for s in sides if knows_bones([frame], s) and not knows_bones(seen, s)]
        seen += [frame] * bool(new)
        if any(f.joints is None for hand in frame.hands for f in hand.fingers):
            return False
        if all(knows_bones(seen, side) for side in sides):
            paalm.use({side: average_calibration(seen, side, paalm.options) for side in sides})
            return True
    return False


def _check(file: Path | None, device: str | None, frames: int | None, seconds: float) -> None:
    if (file is None) == (device is None):
        raise InputError(
            "the source of frames is missing or not unique",
            got="both" if file else "neither",
            expected="a FILE or --device leap",
        )
    if frames is not None and frames < 1:
        raise InputError(
            "too few frames to measure a hand", where="--frames", got=frames, expected="1 or more"
        )
    if seconds <= 0.0 or math.isnan(seconds):
        raise InputError(
            "no time to show frames", where="--seconds", got=seconds, expected="above 0"
        )


def _print(frame: PaalmFrame, as_json: bool) -> None:
    if as_json:
        hands = {
            side: {
                "angles": {k: round(v, 3) for k, v in hand.angles.items()},
                "ratios": {k: round(v, 4) for k, v in hand.ratios.items()},
                "ids": hand.ids,
                "held": sorted(hand.held),
                "seen": hand.seen,
            }
            for side, hand in frame.hands.items()
        }
        record: dict[str, object] = {"time": frame.time, "hands": hands}
        if frame.refused:
            record["refused"] = frame.refused
        print(json.dumps(record))
        return
    for side, hand in frame.hands.items():
        cells = []
        for finger, row in zip(hand.ratios, hand.table.tolist(), strict=True):
            mark = "-" if finger in hand.held else " "
            whole = np.round(row) + 0.0  # no -0
            cells.append(f"{finger[:2]}{mark}" + "".join(f"{v:5.0f}" for v in whole))
        print(f"{frame.time:9.3f} {side[0]}  " + "  ".join(cells))
