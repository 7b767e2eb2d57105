"""What has to be known of a 3-D device to make a hand of its frames: its place, and calibration."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Any

from encoders.paalm.calibration import HandCalibration
from encoders.paalm.calibration_file import calibration_from_json, calibration_to_json
from encoders.paalm.hand_reconstructor import HandReconstructor, HandReconstructorSettings
from encoders.paalm.paalm import Paalm
from models.errors import InputError
from models.limits import RateLimit
from models.person import Person
from models.surface import Surface

UNDER = (0.0, 0.0, -0.10)
"""m, where the device is in the world unless said otherwise: 10 cm under the middle of the table's
top. Fingertips at a box on the table are then 12 cm over it, and the palm 20 cm, where devices see
best."""
FARTHEST = 2.0
"""m from the world's middle, beyond which a device's place is a typing error."""


@dataclass(frozen=True)
class HandInput:
    """A hand that is driven by hand frames; JSON values only.

    Attributes:
        at: m, where the device is in the world; its axes are the world's.
        calibration: Of this hand, as `sandbox paalm calibrate` writes it; None takes an average
            hand, or the bones that the device itself knows.
    """

    at: tuple[float, float, float] = UNDER
    calibration: dict[str, Any] | None = None

    def __post_init__(self) -> None:
        if not all(isfinite(c) and abs(c) <= FARTHEST for c in self.at):
            raise InputError(
                "the device cannot be there",
                where="--leap-at",
                got=str(self.at),
                expected=f"three numbers of at most {FARTHEST:g} m",
            )

    @classmethod
    def of(cls, at: tuple[float, float, float], calibration: HandCalibration | None) -> HandInput:
        """With a calibration, or none."""
        return cls(at, None if calibration is None else calibration_to_json(calibration))

    def reconstructor(self, person: Person, surface: Surface, rate: RateLimit) -> HandReconstructor:
        """Makes poses of hand frames.

        Args:
            person: Whose hand it is.
            surface: The task's workspace.
            rate: Bounds on the commanded pose's speed.

        Raises:
            InputError: The person sits elsewhere, or the workspace stands upright.
            EncoderError: The calibration is damaged.
        """
        if person.turn or surface.upright:
            raise InputError(
                "a hand in the air works over a flat table, from its lower edge",
                where="--turn" if person.turn else "--device",
                got=person.turn or "a task before an upright surface",
                remedy="stack is the same task on the table" if surface.upright else None,
            )
        paalm = Paalm()
        if self.calibration is not None:
            paalm.use({person.hand: calibration_from_json(person.hand, self.calibration)})
        settings = HandReconstructorSettings(device=self.at, rate=rate, size=person.hand_size)
        return HandReconstructor(paalm, person.hand, settings, surface, assume=True)
