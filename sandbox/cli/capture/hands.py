"""Captures from the hand of a Leap, by PAALM: `sandbox capture --recorded` and `--hands`."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from encoders.capture import Capture
from encoders.captures.conversion import ConversionReport, ConversionRules
from encoders.captures.paired.capture_from_hands import capture_from_hands
from encoders.captures.paired.clocks import host_clock
from encoders.captures.paired.open_hand import OPEN_FRAMES, open_hand
from encoders.paalm.calibration import HandCalibration
from encoders.paalm.calibration_file import read_hand
from models.errors import EncoderError, InputError
from models.surface import Surface
from sandbox.devices.files.paired_capture import (
    HANDS,
    TOUCHES,
    About,
    HandsFile,
    arrivals,
    read_about,
    read_hands,
)
from sandbox.devices.files.touch_log_file import read_touch_log
from sandbox.devices.leap.leap_file import check_side


def capture_of_hands(
    options: Any, surface: Surface | None, rules: ConversionRules, report: ConversionReport
) -> tuple[Capture, list[str]]:
    """Makes a capture; also returns descriptions of damage at the end of the files.

    Args:
        options: `CaptureOptions`.
        surface: Touch surface of --surface, or None.
        rules: Rules for dropping frames and contacts.
        report: Collects counts of what was dropped.

    Raises:
        InputError: The recordings are unusable, or are not of the same session.
    """
    touches, hands_file, about = _files(options)
    side = about.side
    log, damage = read_touch_log(touches, surface)
    hands = read_hands(hands_file)
    check_side(hands.frames, side, str(hands_file), "--side")
    calibration = _calibration(options.calibration, hands, side)
    host_times = arrivals(touches, len(log.time)) if hands.host is not None else None
    time = hands.time
    if host_times is not None and hands.host is not None:
        tablet = host_clock(log.time, host_times, str(touches))
        device = host_clock(hands.time, hands.host, str(hands_file))
        log = replace(log, time=tablet.host(log.time))
        time = device.host(hands.time)
        report.notes["clock_drift_ppm"] = [round(1e6 * c.drift, 1) for c in (tablet, device)]
        report.notes["arrival_jitter_ms"] = [round(1e3 * c.jitter, 2) for c in (tablet, device)]
    if side == "left":
        log = replace(log, xy=log.xy * [-1.0, 1.0])
    meta: dict[str, Any] = {
        "simulated": options.simulated or about.simulated,
        "subject": about.person(options.subject),
        "side": "right",
        "recorded_side": side,
        "skeleton": "PAALM's",
        "hand_file": hands_file.name,
        "touch_file": touches.name,
    }
    if surface is not None:
        meta["surface_in"] = [surface.width_in, surface.height_in]
    capture = capture_from_hands(
        log,
        hands.frames,
        time,
        calibration,
        rules,
        report,
        meta,
        one_clock=host_times is not None,
        offset=options.offset if options.sync == "clock" else None,
        correct=options.correct,
    )
    tails = [f"{p}: {d}" for p, d in ((touches, damage), (hands_file, hands.damage)) if d]
    return capture, tails


def _files(options: Any) -> tuple[Path, Path, About]:
    """Returns the files of touches and hands, and the description of the session."""
    if options.recorded is None:
        if options.touches is None:
            raise InputError(
                "the touches are missing", where="--hands", expected="--touches FILE too"
            )
        return options.touches, options.hands, About(options.side or "right")
    folder: Path = options.recorded
    about = read_about(folder)
    if options.side not in (None, about.side):
        raise InputError(
            "the recording is of the other hand",
            where=f"--side {options.side}",
            got=about.side,
            remedy="Leave out --side",
        )
    return folder / TOUCHES, folder / HANDS, about


def _calibration(path: Path | None, hands: HandsFile, side: str) -> HandCalibration:
    if path is not None:
        return read_hand(path, side)
    try:
        return open_hand(hands.frames, side)
    except EncoderError as error:
        raise EncoderError(
            f"the recording does not begin with an open {side} hand: {error.what}",
            got=error.got,
            expected=f"{OPEN_FRAMES} frames of it, or --calibration FILE",
            remedy="Check --side; hold the hand open, palm down, fingers spread",
        ) from None
