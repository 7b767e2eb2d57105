"""Calibration of the hands in a recording, whom nobody can ask to open."""

from __future__ import annotations

from collections.abc import Sequence

from encoders.paalm.average import average_calibration, knows_bones, with_reported_coupling
from encoders.paalm.calibration import (
    ENOUGH,
    HandCalibration,
    calibrated,
    longest_calibration,
)
from encoders.paalm.options import Hands, PaalmOptions
from encoders.paalm.paalm import Paalm, stacked_hands
from encoders.paalm.rig import with_palm_shift
from encoders.paalm.sides import HandSides
from models.errors import EncoderError
from models.frames import SIDES, HandFrame, TrackedHand

OPEN_FRAMES = 100
"""Number of frames of a hand that is held open that are used."""


def calibrate_on_recording(paalm: Paalm, frames: Sequence[HandFrame], hands: Hands) -> str:
    """Calibrates PAALM on a recording: by the device's bones, an open hand, or an average hand.

    Args:
        paalm: Receives the calibration.
        frames: All frames of the recording.
        hands: Sides of the hands.

    Returns:
        Why an average hand stands in for the recorded one; empty if it does not.
    """
    sides = SIDES if hands == "both" else (hands,)
    if all(knows_bones(frames, side) for side in sides):
        average = (average_calibration(frames, side, paalm.options) for side in sides)
        paalm.use({c.side: with_reported_coupling(c, frames) for c in average})
        return ""
    try:
        chooser = HandSides(sides)
        chosen = [(f.time, {} if stacked_hands(f) else chooser.choose(f)) for f in frames]
        measured = [
            measured_in([(t, c.get(side)) for t, c in chosen], side, paalm.options)
            for side in sides
        ]
        paalm.use({c.side: c for c in measured})
    except EncoderError as error:
        paalm.use({side: average_calibration(frames, side, paalm.options) for side in sides})
        got = "" if error.got is None else f" ({error.got})"
        return f"an average hand stands in for the recorded one: {error.what}{got}"
    return ""


def measured_in(
    samples: Sequence[tuple[float, TrackedHand | None]], side: str, options: PaalmOptions
) -> HandCalibration:
    """Measures a hand in a recording, wherever it shows its fingers; by lengths, at its beginning.

    Args:
        samples: (time in s, the hand or None where it is not seen), one a frame.
        side: `right` or `left`.
        options: Options of PAALM.

    Raises:
        EncoderError: The hand is hardly ever open.
    """
    if options.solve == "lengths":
        return calibrated(samples, side, OPEN_FRAMES, ENOUGH)
    return with_palm_shift(longest_calibration(samples, side, ENOUGH), options)
