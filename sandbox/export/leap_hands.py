"""Hands over a Leap, reconstructed by PAALM in the device's frame, without a task or table.

`HandReconstructor` also drives a hand in a task. In a task the hand must not sink into the table,
outrun its servos or hide objects while it is lost. These limits do not apply here.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from math import inf

from encoders.paalm.calibration import HandCalibration
from encoders.paalm.hand_reconstructor import HandReconstructor, HandReconstructorSettings
from encoders.paalm.joint_angles import Paalm
from encoders.reconstruction.hand_motion import RateLimit
from models.frames import SIDES, HandFrame
from models.motion.armature import Armature
from models.person import Person
from models.skeleton import ADULT
from sandbox.devices.device import AnyDevice
from sandbox.devices.leap.two_hands import SplitBySide
from sandbox.devices.wrappers.shared import SharedDevice

STRAIGHT = HandReconstructorSettings(
    device=(0.0, 0.0, 0.0), rate=RateLimit(inf, inf), rise=0.0, rise_speed=0.0, floor=-inf
)
"""Settings without limits, in the device's frame. A lost hand keeps its last pose."""


def straight_reconstructor(side: str, calibration: HandCalibration | None) -> HandReconstructor:
    """The reconstructor of one hand.

    Args:
        side: `right` or `left`.
        calibration: Calibration of the hand. None uses the bones that the device reports when it
            first sees the hand, or an average hand.
    """
    paalm = Paalm()
    if calibration is not None:
        paalm.use({side: calibration})
    return HandReconstructor(paalm, side, STRAIGHT, assume=calibration is None)


def straight_reconstructors(
    sides: Sequence[str], calibrations: Mapping[str, HandCalibration]
) -> list[HandReconstructor]:
    """The reconstructors of several hands; hands may lack a calibration."""
    return [straight_reconstructor(side, calibrations.get(side)) for side in sides]


def leap_armatures(sides: Sequence[str]) -> tuple[Armature, ...]:
    """Armatures of the average hand. PAALM computes poses for this hand."""
    return tuple(Armature(Person(side).skeleton(ADULT)) for side in sides)


def described(sides: Sequence[str]) -> str:
    """Description of the hands for people."""
    hands = "hand" if len(sides) == 1 else "hands"
    return f"the {' and '.join(sides)} {hands} over a Leap, by PAALM, in the frame of the device"


def devices_by_side(device: AnyDevice, sides: Sequence[str]) -> tuple[AnyDevice, ...]:
    """One device for each hand, all from one live device."""
    if len(sides) == 1:
        return (device,)
    return SharedDevice(device, SplitBySide(sides)).parts


class HandSplitter:
    """Splits frames by side, as for two hands of a task over one Leap.

    Args:
        sides: Sides of the wanted hands.
        pairs: True if frames show two hands. For a single wanted hand and False, frames are not
            split, and PAALM finds the hand in them.

    Attributes:
        counts: Numbers of hands that were left out or corrected, by reason.
    """

    def __init__(self, sides: Sequence[str], pairs: bool) -> None:
        self._split = SplitBySide(SIDES) if pairs or len(sides) == 2 else None
        self._wanted = [SIDES.index(side) for side in sides]
        self.counts: Counter[str] = Counter() if self._split is None else self._split.counts

    def __call__(self, frame: HandFrame) -> tuple[HandFrame, ...]:
        """A frame for each side."""
        if self._split is None:
            return (frame,)
        both = self._split.divide(frame, frame.time)
        return tuple(both[i] for i in self._wanted)
