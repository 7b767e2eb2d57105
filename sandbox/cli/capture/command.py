"""`sandbox capture`: makes a capture for training from recordings of touches and hands.

`sandbox capture record` makes such recordings with a Leap or a camera, and `sandbox capture
simulate` makes simulated ones. They and `sandbox capture report` are in separate modules.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress
from rich.table import Table

from encoders.capture import Capture, save_capture
from encoders.captures.conversion import (
    ConversionReport,
    ConversionRules,
    JointTrack,
    capture_from_poses,
    capture_from_touches,
)
from encoders.captures.conversion.hand_files import read_hand, read_mapping
from models.errors import InputError, unknown_name
from models.surface import Surface, parse_surface
from sandbox.cli.common.command_line import parse
from sandbox.cli.common.json_out import check_output, refuse_replacing
from sandbox.devices.files.paired_capture import HANDS, UNNAMED
from sandbox.devices.files.touch_log_file import read_touch_log
from sandbox.devices.webcam.landmarks import is_landmark_file


@dataclass(frozen=True, kw_only=True)
class CaptureOptions:
    """Makes a capture, on which an encoder can be trained, from your own recordings.

    Give --touches and --joints, recorded at the same time. Or give --markers or --joints alone:
    a fingertip near the surface then counts as a touch.

    Touches: a recording of this program, a capture of TUIO packets (with --surface), or the output
    of `sandbox touches show --json`. Joints: BVH, AMC (with its ASF) or Vicon V (with its VSK), to
    which the program's skeleton is fitted. Or a CSV file with columns `time`, `root_x` ..
    `root_rz`, `index_mcp_rx` .. in m and rad. Markers: a Qualisys TSV file, plain or packed. Names
    of joints and markers as in Mixamo rigs or Qualisys glove recordings are recognised; other names
    need a --mapping file:

        [points]
        RIDX3 = "index_tip_skin"
        RWRB = { bone = "palm", at = [0.02, 0.0, 0.01] }
        [surface]
        top_left = [0, 0, 0]
        top_right = [197, 0, 0]
        bottom_left = [0, -148, 0]

    The names of points are wrist, FINGER_mcp, FINGER_pip, FINGER_dip, FINGER_tip, thumb_cmc,
    thumb_mcp, thumb_ip, thumb_tip, and back_front, back_left, back_right for the back of the hand.
    Each name except wrist may end in _skin, for a marker on the skin above the point. The corners
    of the surface are positions in the recording's units, or names of markers that lie on them.

    Each touch is labelled with the finger whose tip is nearest. The command drops and counts:
    frames with one finger, frames without a pose, contacts shorter than 50 ms, positions that jump
    faster than 3 m/s, long rests at the ends of touches without a lift, frames whose time runs
    backwards, contacts without a fingertip within 25 mm, and contacts that are nearer to another
    finger for a fifth of their time. docs/captures.md explains how to record.

    With a Leap instead of motion capture, or with a camera over the surface, use --recorded FOLDER
    instead of --joints and --mapping. The folder comes from `sandbox capture record`, which guides
    you, or from `sandbox capture simulate`. The offset between the clocks is estimated from taps,
    the position of the device from touches. `sandbox capture report FOLDER` evaluates the touches
    that a camera labelled.

    Try it with a simulated session, then with recordings of your own:

        sandbox capture simulate --out session
        sandbox capture --recorded session --out c.npz
        sandbox capture --touches t.jsonl --joints hand.bvh --mapping m.toml --sync tap --out c.npz
        sandbox train --capture c.npz --out mine.npz
    """

    out: Annotated[Path, Parameter(metavar="FILE")]
    """File for the capture; an existing file is replaced."""

    touches: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """Recording of the touches."""

    joints: Annotated[Path | None, Parameter(metavar="FILE.bvh|.amc|.v|.csv")] = None
    """Recording of the hand's joints."""

    skeleton: Annotated[Path | None, Parameter(metavar="FILE.asf|.vsk")] = None
    """Skeleton of an .amc or .v file. Default: the file of the same name in its folder."""

    joints_rate: Annotated[float | None, Parameter(metavar="HZ")] = None
    """Frames per second of an .amc file. Default: the rate that the file states, or 120."""

    markers: Annotated[Path | None, Parameter(metavar="FILE.tsv")] = None
    """Recording of markers on the hand, in place of --joints."""

    recorded: Annotated[Path | None, Parameter(metavar="FOLDER")] = None
    """Folder written by `sandbox capture record`: touches, and the hand from a Leap or a camera."""

    hands: Annotated[Path | None, Parameter(metavar="FILE.json|.jsonl")] = None
    """Recording of the hand by a Leap, with --touches recorded at the same time."""

    calibration: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """For --hands and --recorded: calibration written by `sandbox paalm calibrate`. Default:
    measured at the start of the recording, where the hand must be open."""

    correct: Literal["unseen", "all", "none"] = "unseen"
    """For --hands and --recorded: which fingertips are moved to their touches: those that the Leap
    does not see at the moment, all, or none."""

    sync: Literal["clock", "tap"] | None = None
    """Synchronisation. clock: the clocks differ by --offset. tap: the offset is estimated from
    taps, or the command fails. Default: tap for --hands and --recorded, else clock."""

    offset: Annotated[float, Parameter(metavar="S")] = 0.0
    """For --sync clock: clock of the joints minus clock of the touches, in seconds."""

    side: Literal["right", "left"] | None = None
    """Side of the hand. Default: that of --recorded, else right. A left hand is mirrored, because
    encoders are trained on right hands only."""

    surface: Annotated[str | None, Parameter(metavar="SIZE")] = None
    """Size of the touch surface: 7.76x5.82in, 197x148mm, or a preset such as ipad2."""

    mapping: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """File (TOML or JSON) with the points to which the recording's names refer, and the corners of
    the surface."""

    unit: Annotated[str, Parameter(metavar="UNIT,...")] = ""
    """Units of the recording, such as cm or cm,ms. Lengths: m, cm, mm, in, or a number of metres.
    Times: s, ms, us or ns. Default: cm for BVH, mm for Vicon and markers, the skeleton's unit for
    .amc; and seconds. If these make the hand's size or the frames' rate impossible, possible units
    are used and reported."""

    scale: float = 1.0
    """Size of the hand in a CSV file relative to the program's adult hand. In other formats, the
    size is fitted."""

    threshold: Annotated[float, Parameter(metavar="MM")] = 5.0
    """Without --touches: height in mm below which a fingertip counts as touching. Also the largest
    unevenness of the points from which the surface is found. Soft surfaces need a larger value."""

    rate: Annotated[float, Parameter(metavar="HZ")] = 30.0
    """Frames per second of the capture."""

    subject: str | None = None
    """Pseudonym of the person. Default: that in the recording, or "unnamed"."""

    simulated: bool = False
    """Mark the capture as simulated."""


def main(argv: list[str]) -> int:
    """Runs `sandbox capture ...`."""
    if argv[:1] == ["record"]:
        from sandbox.cli.capture.record import main as record

        return record(argv[1:])
    if argv[:1] == ["report"]:
        from sandbox.cli.capture.report import main as report_main

        return report_main(argv[1:])
    if argv[:1] == ["simulate"]:
        from sandbox.cli.capture.simulate import main as simulate

        return simulate(argv[1:])
    if argv and not argv[0].startswith("-"):
        names = ("record", "report", "simulate")
        raise unknown_name("no such command", argv[0], names, where="sandbox capture")
    options = parse(CaptureOptions, "sandbox capture", argv)
    seen = options.hands is not None or options.recorded is not None
    options = replace(options, sync=options.sync or ("tap" if seen else "clock"))
    hand_file = _checked(options)
    if seen:
        return _capture_from_leap(options)
    sync: Literal["clock", "tap"] = "tap" if options.sync == "tap" else "clock"
    options = replace(options, side=options.side or "right")
    mapping = read_mapping(options.mapping)
    surface = parse_surface(options.surface) if options.surface else None
    report, left = ConversionReport(), options.side == "left"
    rules = ConversionRules(rate=options.rate)
    console, errors = Console(), Console(stderr=True)
    with Progress(console=errors, transient=True, disable=not errors.is_terminal) as progress:
        bar = progress.add_task("fitting the skeleton", total=1.0)
        log, damage = read_touch_log(options.touches, surface) if options.touches else (None, "")
        joints = read_hand(
            hand_file,
            mapping,
            report,
            left=left,
            unit=options.unit,
            scale=options.scale,
            find_surface=log is None,
            tolerance=options.threshold / 1000,
            progress=lambda share: progress.update(bar, completed=share),
            skeleton_file=options.skeleton,
            rate=options.joints_rate,
        )
        progress.update(bar, description="touches and fingers", completed=1.0)
        meta = _meta(options, hand_file, joints, surface)
        if log is None:
            threshold = options.threshold / 1000
            capture = capture_from_poses(joints, threshold, rules, report, meta)
        else:
            if left:
                log = replace(log, xy=log.xy * [-1.0, 1.0])
            capture = capture_from_touches(log, joints, sync, options.offset, rules, report, meta)
    _write(options, capture)
    if damage:
        errors.print(f"{options.touches}: {damage}", soft_wrap=True, markup=False)
    _print(console, options, capture, report)
    return 0


def _capture_from_leap(options: CaptureOptions) -> int:
    """Makes a capture from the hands that a Leap or a camera recorded."""
    from sandbox.captures.recorded import capture_of_hands, capture_of_pictures

    camera = options.recorded is not None and is_landmark_file(options.recorded / HANDS)
    convert = capture_of_pictures if camera else capture_of_hands
    report, rules = ConversionReport(), ConversionRules(rate=options.rate)
    surface = parse_surface(options.surface) if options.surface else None
    errors = Console(stderr=True)
    with errors.status("poses, clocks, the device's place"):
        capture, damage = convert(options, surface, rules, report)
    _write(options, capture)
    for text in damage:
        errors.print(text, soft_wrap=True, markup=False)
    _print(Console(), options, capture, report)
    return 0


def _write(options: CaptureOptions, capture: Capture) -> None:
    try:
        save_capture(capture, options.out)
    except OSError as error:
        raise InputError(
            "the capture cannot be written",
            where=f"--out {options.out}",
            got=str(error),
            remedy="Name another file",
        ) from error


def _checked(options: CaptureOptions) -> Path:
    """Checks the options, and returns the file that holds the hand."""
    kinds = (options.joints, options.markers, options.hands, options.recorded)
    hands = [path for path in kinds if path is not None]
    if len(hands) != 1 or (options.recorded is not None and options.touches is not None):
        raise InputError(
            "a capture needs one recording of the hand",
            where="sandbox capture",
            expected="--joints FILE, --markers FILE, --hands FILE or --recorded FOLDER",
            remedy="`sandbox capture --help` shows how",
        )
    if options.sync == "tap" and options.touches is None and options.recorded is None:
        raise InputError(
            "there are no touches in which taps could be found",
            where="--sync tap",
            remedy="Add --touches FILE, or use --sync clock",
        )
    check_output(options.out, "--out")
    sources = {
        "--joints": options.joints,
        "--markers": options.markers,
        "--hands": options.hands,
        "--recorded": options.recorded,
        "--touches": options.touches,
        "--calibration": options.calibration,
        "--skeleton": options.skeleton,
    }
    refuse_replacing(options.out, sources)
    for name, value, greatest in (
        ("--rate", options.rate, 1000.0),
        ("--threshold", options.threshold, 50.0),
        ("--joints-rate", 120.0 if options.joints_rate is None else options.joints_rate, 10_000.0),
        ("--scale", options.scale, 2.0),
    ):
        if not 0 < value < greatest:
            raise InputError(
                "out of range", where=name, got=value, expected=f"above 0, below {greatest:g}"
            )
    if not np.isfinite(options.offset):
        raise InputError(
            "the offset is not finite",
            where="--offset",
            got=options.offset,
            expected="a number of seconds",
        )
    return hands[0]


def _meta(
    options: CaptureOptions, hand_file: Path, joints: JointTrack, surface: Surface | None
) -> dict[str, Any]:
    meta: dict[str, Any] = {
        "simulated": options.simulated,
        "subject": options.subject or UNNAMED,
        # Poses are always stored as of a right hand; a left hand was mirrored.
        "side": "right",
        "recorded_side": options.side,
        "skeleton": joints.skeleton.name,
        "hand_file": hand_file.name,
        "touch_file": options.touches.name if options.touches else "none",
    }
    if surface is not None:
        meta["surface_in"] = [surface.width_in, surface.height_in]
    return meta


def _print(
    console: Console, options: CaptureOptions, capture: Capture, report: ConversionReport
) -> None:
    fingers = capture.down.sum(axis=1)
    split = ", ".join(f"{(fingers == n).sum():,} with {n}" for n in range(2, 6))
    console.print(
        f"{escape(str(options.out))}: {len(capture):,} frames at {options.rate:g} Hz in "
        f"{len(np.unique(capture.trial))} takes ({split} fingers), "
        f"{len(np.unique(capture.down, axis=0))} of 26 sets of fingers",
        soft_wrap=True,
    )
    table = Table("dropped", "what", "why", title_justify="left")
    for kind, counts in (
        ("contacts", report.contacts),
        ("frames", report.frames),
        ("pieces", report.parts),
    ):
        for reason, count in counts.items():
            table.add_row(f"{count:,}", kind, reason)
    if table.row_count:
        console.print(table)
    else:
        console.print("nothing was dropped")
    for name, value in report.notes.items():
        console.print(f"{name.replace('_', ' ')}: {value}", soft_wrap=True, markup=False)
