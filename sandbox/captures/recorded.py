"""Captures from recorded sessions of touches together with a Leap or a camera."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from encoders.air.camera import Camera
from encoders.capture import Capture
from encoders.captures.conversion import ConversionReport, ConversionRules, TouchLog
from encoders.captures.overhead.capture_from_camera import (
    NamedTouches,
    capture_from_camera,
    name_touches,
)
from encoders.captures.overhead.tablet_plane import TabletPlane, mirrored_plane, plane_of_corners
from encoders.captures.paired.capture_from_hands import capture_from_hands
from encoders.captures.paired.hand_track import OPEN_FRAMES, open_hand
from encoders.paalm.calibration import HandCalibration
from encoders.paalm.calibration_file import read_hand
from models.arithmetic import Array
from models.errors import CaptureError, EncoderError, InputError, RecordingError
from models.frames import LandmarkFrame
from models.surface import Surface
from sandbox.devices.files.frame_file import touch_surface
from sandbox.devices.files.paired_capture import (
    HANDS,
    TOUCHES,
    About,
    HandsFile,
    arrivals,
    picture_arrivals,
    read_about,
    read_hands,
)
from sandbox.devices.files.touch_log_file import read_touch_log
from sandbox.devices.leap.leap_file import check_side
from sandbox.devices.webcam.landmarks import read_landmarks

MOST_DRIFT = 0.002
"""Largest relative difference between the rates of two clocks. The rates of quartz clocks differ by
less than a tenth of it."""

_ROUNDS = 5
_OUTLIER = 3.0
"""Largest deviation of an arrival from the line, in robust standard deviations. An arrival that
deviates more is ignored, because the machine was probably busy."""


@dataclass(frozen=True)
class HostClock:
    """Host time = `offset` + (1 + `drift`) * device time.

    Attributes:
        offset: s, host time at device time 0.
        drift: Relative difference by which a device's second is longer than the host's second.
        jitter: s, robust standard deviation of the arrivals from this line.
    """

    offset: float
    drift: float
    jitter: float

    def host(self, device: Array) -> Array:
        """Converts device times to host times, s."""
        return np.asarray(self.offset + (1.0 + self.drift) * device)


def host_clock(device: Array, arrived: Array, where: str) -> HostClock:
    """Fits the line that converts a device's times to times of the host's clock.

    Args:
        device: (n,) s, the frames' times on the device's clock.
        arrived: (n,) s, arrival times on the host's clock.
        where: Name of the stream, for messages.

    Raises:
        CaptureError: The two clocks do not match.
    """
    if len(device) < 2 or np.ptp(device) <= 0.0:
        raise CaptureError(
            "too few frames to relate the device's clock to the host's clock",
            where=where,
            got=len(device),
        )
    middle = float(device.mean())
    keep = np.ones(len(device), bool)
    line = np.array([1.0, 0.0])
    spread = 0.0
    for _ in range(_ROUNDS):
        line = np.polyfit(device[keep] - middle, arrived[keep], 1)
        off = arrived - np.polyval(line, device - middle)
        spread = 1.4826 * float(np.median(np.abs(off - np.median(off))))
        keep = np.abs(off - np.median(off)) <= max(_OUTLIER * spread, 1e-4)
    drift = float(line[0]) - 1.0
    # In a short recording, jitter of the arrivals looks like drift, so a larger drift is allowed.
    if abs(drift) > MOST_DRIFT + 4.0 * spread / max(float(np.ptp(device)), 1e-9):
        raise CaptureError(
            "the device's times do not match their arrivals",
            where=where,
            got=f"one second of the device takes {1.0 + drift:.4f} s of the host's clock",
            expected=f"a difference of at most {100 * MOST_DRIFT:g} %",
            remedy="A clock was changed during the recording; record again",
        )
    return HostClock(float(line[1]) - (1.0 + drift) * middle, drift, spread)


def capture_of_hands(
    options: Any, surface: Surface | None, rules: ConversionRules, report: ConversionReport
) -> tuple[Capture, list[str]]:
    """Makes a capture from touches and a Leap's hands.

    Returns:
        The capture, and descriptions of damage at the end of the files.

    Args:
        options: `CaptureOptions`.
        surface: Touch surface of --surface, or None.
        rules: Rules for dropping frames and contacts.
        report: Collects counts of dropped data.

    Raises:
        InputError: The recordings are unusable, or are not of the same session.
    """
    touches, hands_file, about = _files(options)
    side = about.side
    log, damage = read_touch_log(touches, surface)
    hands = read_hands(hands_file, options.unit)
    report.add_reading(hands.report)
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
            expected=f"{OPEN_FRAMES} frames of an open hand, or --calibration FILE",
            remedy="Check --side; hold the hand open, palm down, fingers spread",
        ) from None


@dataclass(frozen=True)
class CameraSession:
    """A recorded session under a camera, with times on the host's clock.

    Touches and surface of a left hand are mirrored, so that they are those of a right hand.

    Attributes:
        about: Description of the session.
        log: The touches.
        frames: The camera's pictures.
        taken: (F,) s, times at which the pictures were taken.
        corners: The surface, from its marked corners; None if the corners were not marked.
        camera: The camera with its field of view; None if the field of view is unknown.
        clocks: Clocks of touches and pictures.
        damage: Descriptions of damage at the end of the files.
    """

    about: About
    log: TouchLog
    frames: tuple[LandmarkFrame, ...]
    taken: Array
    corners: TabletPlane | None
    camera: Camera | None
    clocks: tuple[HostClock, HostClock]
    damage: tuple[str, ...]

    def names(self, rules: ConversionRules, report: ConversionReport) -> NamedTouches:
        """The touches, each labelled with its finger from the camera's pictures."""
        return name_touches(
            self.log,
            self.frames,
            self.taken,
            self.about.side,
            rules,
            report,
            corners=self.corners,
        )


def read_session(folder: Path, surface: Surface | None = None) -> CameraSession:
    """Reads a session that `sandbox capture record --hands webcam` recorded.

    Raises:
        InputError: The recordings are unusable, or are not of the same session.
    """
    about, touches, hands = read_about(folder), folder / TOUCHES, folder / HANDS
    log, damage = read_touch_log(touches, surface)
    recording = read_landmarks(hands)
    touched = arrivals(touches, len(log.time))
    seen = picture_arrivals(hands, recording.lines)
    if touched is None or seen is None:
        raise RecordingError(
            "the arrival times of the touches or of the pictures are missing",
            where=str(folder),
            remedy="Record both with `sandbox capture record`",
        )
    tablet = host_clock(log.time, touched, str(touches))
    camera = host_clock(np.array([f.time for f in recording.frames]), seen, str(hands))
    log = replace(log, time=tablet.host(log.time))
    taken = camera.host(np.array([f.taken for f in recording.frames]))
    plane = _plane(about, touches, surface, recording.frames[0].size[0])
    if about.side == "left":
        log = replace(log, xy=log.xy * [-1.0, 1.0])
    tails = (
        (touches, damage),
        (hands, str(recording.damage) if recording.damage else ""),
        (hands, recording.report.line()),
    )
    return CameraSession(
        about,
        log,
        recording.frames,
        taken,
        plane,
        None if about.fov is None else Camera(view=about.fov),
        (tablet, camera),
        tuple(f"{path}: {text}" for path, text in tails if text),
    )


def capture_of_pictures(
    options: Any, surface: Surface | None, rules: ConversionRules, report: ConversionReport
) -> tuple[Capture, list[str]]:
    """Makes a capture from touches and a camera's pictures.

    Returns:
        The capture, and descriptions of damage at the end of the files.

    Args:
        options: `CaptureOptions` with `recorded`.
        surface: Touch surface of --surface, or None.
        rules: Rules for dropping frames and contacts.
        report: Collects counts of dropped data.

    Raises:
        InputError: The recordings are unusable, or are not of the same session.
    """
    folder: Path = options.recorded
    session = read_session(folder, surface)
    about = session.about
    if options.side not in (None, about.side):
        raise InputError(
            "the recording is of the other hand",
            where=f"--side {options.side}",
            got=about.side,
            remedy="Leave out --side",
        )
    report.notes["clock_drift_ppm"] = [round(1e6 * c.drift, 1) for c in session.clocks]
    report.notes["arrival_jitter_ms"] = [round(1e3 * c.jitter, 2) for c in session.clocks]
    meta: dict[str, Any] = {
        "simulated": options.simulated or about.simulated,
        "subject": about.person(options.subject),
        "side": "right",
        "recorded_side": about.side,
        "skeleton": "average, scaled",
        "hand_file": HANDS,
        "touch_file": TOUCHES,
        "named_by": "camera",
    }
    if surface is not None:
        meta["surface_in"] = [surface.width_in, surface.height_in]
    capture, _ = capture_from_camera(
        session.log,
        session.frames,
        session.taken,
        about.side,
        rules,
        report,
        meta,
        camera=session.camera,
        corners=session.corners,
        offset=options.offset if options.sync == "clock" else None,
    )
    return capture, list(session.damage)


def _plane(about: About, touches: Path, surface: Surface | None, width: int) -> TabletPlane | None:
    """The surface from its marked corners, mirrored for a left hand; None without corners."""
    if about.corners is None:
        return None
    corners = np.array(about.corners, float)
    if corners.shape != (4, 2) or not all(math.isfinite(c) for c in corners.ravel()):
        raise RecordingError("the corners are damaged", where=str(touches.parent))
    known = surface or touch_surface(touches)
    if known is None:
        raise InputError(
            "the recording has no size of the surface",
            where=str(touches),
            remedy="Add --surface",
        )
    plane = plane_of_corners(corners, known.size)
    return mirrored_plane(plane, width) if about.side == "left" else plane
