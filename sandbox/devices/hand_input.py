"""Settings of a hand tracked in the air: position of the device and calibration of the hand."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import isfinite
from typing import TYPE_CHECKING, Any

from encoders.air.camera import Camera
from encoders.reconstruction.hand_motion import RateLimit
from models.errors import InputError
from models.person import Person
from models.surface import Surface

if TYPE_CHECKING:
    from encoders.paalm.calibration import HandCalibration
    from encoders.paalm.hand_reconstructor import HandReconstructor
    from encoders.reconstruction.reconstructor import AirReconstructor

UNDER = (0.0, 0.0, -0.10)
"""Default position (m) of the device in the world: 10 cm below the centre of the table top.
Fingertips at a box on the table are then 12 cm above the device, and the palm is 20 cm above it,
where such devices are most exact."""
FARTHEST = 2.0
"""Largest coordinate (m) of a device's position. A larger value was probably mistyped."""


@dataclass(frozen=True)
class HandInput:
    """Settings of a hand that is driven by hand frames or by landmarks; JSON values only.

    Attributes:
        at: (3,) m, position of the device in the world; the device's axes are the world's.
        calibration: Calibration of this hand, as `sandbox paalm calibrate` writes it. With None,
            the bone lengths that the device reports are used, or else an average hand.
        camera: The camera whose landmarks drive the hand; None for a device that sends hand frames.
            With a camera, the other attributes have no effect.
        joints: True if the device reports all joints in world coordinates, as a headset does. They
            are fitted without a calibration.
    """

    at: tuple[float, float, float] = UNDER
    calibration: dict[str, Any] | None = None
    camera: Camera | None = field(default=None, metadata={"before": None})
    joints: bool = field(default=False, metadata={"before": False})

    def __post_init__(self) -> None:
        if not all(isfinite(c) and abs(c) <= FARTHEST for c in self.at):
            raise InputError(
                "the position of the device is too far away",
                where="--leap-at",
                got=str(self.at),
                expected=f"three numbers of at most {FARTHEST:g} m",
            )

    @classmethod
    def of(cls, at: tuple[float, float, float], calibration: HandCalibration | None) -> HandInput:
        """Makes the settings from a position (3,) m and a calibration, or None."""
        from encoders.paalm.calibration_file import calibration_to_json

        return cls(at, None if calibration is None else calibration_to_json(calibration))

    def any_reconstructor(
        self, person: Person, surface: Surface, rate: RateLimit
    ) -> AirReconstructor:
        """Makes the reconstructor for the device; arguments and errors as for `reconstructor`."""
        if self.joints:
            from encoders.air.reconstructors import JointReconstructor, following

            _check_seat(person, surface)
            return JointReconstructor(
                person.hand, person.hand_size, following(rate), surface=surface
            )
        if self.camera is None:
            return self.reconstructor(person, surface, rate)
        from encoders.air.reconstructors import LandmarkReconstructor
        from encoders.reconstruction.followed_hand import FollowingSettings

        _check_seat(person, surface)
        return LandmarkReconstructor(
            self.camera,
            person.hand,
            person.hand_size,
            FollowingSettings(rate=rate),
            surface=surface,
        )

    def reconstructor(self, person: Person, surface: Surface, rate: RateLimit) -> HandReconstructor:
        """Makes the reconstructor that turns a Leap's hand frames into poses.

        Args:
            person: The person whose hand it is.
            surface: The task's workspace.
            rate: Bounds on the commanded pose's speed.

        Raises:
            InputError: The person does not sit at the lower edge, or the workspace is upright.
            EncoderError: The calibration is damaged.
        """
        from encoders.paalm.calibration_file import calibration_from_json
        from encoders.paalm.hand_reconstructor import HandReconstructor, HandReconstructorSettings
        from encoders.paalm.joint_angles import Paalm

        _check_seat(person, surface)
        paalm = Paalm()
        if self.calibration is not None:
            paalm.use({person.hand: calibration_from_json(person.hand, self.calibration)})
        settings = HandReconstructorSettings(device=self.at, rate=rate, size=person.hand_size)
        return HandReconstructor(paalm, person.hand, settings, surface, assume=True)


def _check_seat(person: Person, surface: Surface) -> None:
    """Checks that the surface is flat and that the person sits at its lower edge.

    Raises:
        InputError: The surface is upright, or the person sits at another edge.
    """
    if person.turn or surface.upright:
        raise InputError(
            "with a hand in the air, the person must sit at the lower edge of a flat table",
            where="--turn" if person.turn else "--device",
            got=person.turn or "a task with an upright surface",
            remedy="Play `stack`, the same task on a table" if surface.upright else None,
        )
