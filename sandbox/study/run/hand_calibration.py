"""Measures a participant's hand over a Leap before the first trial, as in PAALM (2013)."""

from __future__ import annotations

from collections.abc import Callable
from itertools import islice
from typing import Any, Literal, cast

from encoders.paalm import Paalm
from encoders.paalm.calibration import PAPER_FRAMES
from encoders.paalm.calibration_file import calibration_to_json
from models.errors import EncoderError
from sandbox.devices.leap.leap import open_leap
from sandbox.study.record.folder import Participant
from sandbox.study.run.forms import Forms, Poll
from sandbox.words.words import words_in

TRIES = 2
"""At most so many frames are read for each required frame, since up to half of them may not show an
open hand."""
AGAIN = "`{}` resumes the session at this step"


def hand_measurer(
    forms: Forms,
    person: Participant,
    address: str,
    say: Callable[[str], object],
    wanted: int = PAPER_FRAMES,
    own: dict[str, str] | None = None,
    again: str = "the same command",
) -> Callable[[Poll], dict[str, Any]]:
    """Returns a function that measures the participant's hand.

    The function repeats the measurement until the hand was held correctly. If the experimenter
    skips it, an average hand is used. It raises a DeviceError if the service sends no data.

    Args:
        forms: Shows the instruction to the participant.
        person: The participant.
        address: Address of the Leap service.
        say: Prints the result for the experimenter.
        wanted: Number of required frames with five fingers; 1000 in the paper, about ten seconds.
        own: The design's own words in the participant's language, by key.
        again: Command that resumes the session; the error names it if the service sends no data.
    """
    text = words_in(person.language, own)["measure_hand"]
    side = cast(Literal["right", "left"], person.hand)

    def measure(poll: Poll) -> dict[str, Any]:
        while True:
            forms.instruct(text, poll)
            device = open_leap(address)
            try:
                frames = islice(device.follow(poll, AGAIN.format(again)), TRIES * wanted)
                calibration = Paalm().calibrate(frames, side, wanted)[side]
            except EncoderError as error:
                say(f"measuring again: {error}")
                continue
            finally:
                device.close()
            lengths = ", ".join(f"{1000 * length:.0f}" for length in calibration.standard)
            say(
                f"measured the {side} hand: fingers of {lengths} mm, from {calibration.frames} "
                "frames"
            )
            return calibration_to_json(calibration)

    return measure
