"""Measures a participant's hand over a Leap before their first trial, as in PAALM (2013)."""

from __future__ import annotations

from collections.abc import Callable
from itertools import islice
from typing import Any, Literal, cast

from encoders.paalm import Paalm
from encoders.paalm.calibration import PAPER_FRAMES
from encoders.paalm.calibration_file import calibration_to_json
from models.errors import EncoderError
from sandbox.options.leap_devices import open_leap
from sandbox.study.record.folder import Participant
from sandbox.study.run.forms import Forms, Ready

TRIES = 2
"""Frames that are looked at for every one that is wanted: half of them may show no open hand."""
AGAIN = "Start it again; the study resumes at this step"

WORDS = {
    "en": "Hold your hand about 20 cm above the sensor, palm down, fingers spread, and keep it "
    "still for ten seconds. Go on with the other hand when you are ready.",
    "de": "Halten Sie die Hand etwa 20 cm über den Sensor, Handfläche nach unten, Finger "
    "gespreizt, und zehn Sekunden lang still. Gehen Sie mit der anderen Hand weiter, wenn Sie "
    "bereit sind.",
    "fr": "Tenez la main à environ 20 cm au-dessus du capteur, paume vers le bas, doigts écartés, "
    "immobile pendant dix secondes. Continuez avec l’autre main quand vous êtes prêt.",
    "es": "Mantenga la mano a unos 20 cm sobre el sensor, con la palma hacia abajo y los dedos "
    "separados, quieta durante diez segundos. Siga con la otra mano cuando quiera.",
}


def hand_measurer(
    forms: Forms,
    person: Participant,
    address: str,
    say: Callable[[str], object],
    wanted: int = PAPER_FRAMES,
) -> Callable[[Ready], dict[str, Any]]:
    """How the participant's hand is measured.

    Args:
        forms: Tells the participant what to do.
        person: Whose hand.
        address: Of the Leap service.
        say: Tells the experimenter what came out.
        wanted: Frames with five fingers; 1000 in the paper, about ten seconds.

    Returns:
        Asks until the hand was held as it has to be; the experimenter may leave it, and the hand is
        then taken for an average one. Raises a DeviceError where the service says nothing.
    """
    text = WORDS.get(person.language, WORDS["en"])
    side = cast(Literal["right", "left"], person.hand)

    def measure(ready: Ready) -> dict[str, Any]:
        while True:
            forms.instruct(text, ready)
            device = open_leap(address)
            try:
                frames = islice(device.follow(ready, AGAIN), TRIES * wanted)
                found = Paalm().calibrate(frames, side, wanted)[side]
            except EncoderError as error:
                say(f"once more: {error}")
                continue
            finally:
                device.close()
            lengths = ", ".join(f"{1000 * length:.0f}" for length in found.standard)
            say(f"the {side} hand is measured: fingers of {lengths} mm in {found.frames} frames")
            return calibration_to_json(found)

    return measure
