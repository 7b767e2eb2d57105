"""Reconstructs poses of the whole hand from successive hand frames, by PAALM.

The reconstructor has the interface of `encoders.reconstruction.reconstructor`. Code that drives a
hand by touches can therefore drive a hand by a Leap.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from encoders.paalm.average import average_calibration
from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.joint_angles import Paalm, PaalmHand
from encoders.paalm.palm import Palm
from encoders.reconstruction.followed_hand import FollowedHand, FollowingSettings
from encoders.reconstruction.hand_motion import RateLimit
from encoders.reconstruction.reconstructor import Reconstruction
from models.arithmetic import Array
from models.errors import EncoderError
from models.frames import FINGERS, HandFrame, Vector
from models.message import Message
from models.person import Person
from models.skeleton import ADULT
from models.surface import Surface

NOTICE_LASTS = 1.0
"""Time (s) for which a notice to the person stays after its cause has ended."""


@dataclass(frozen=True)
class HandReconstructorSettings:
    """Settings of the reconstruction from hand frames.

    Attributes:
        device: Position (m) of the device in the world. Its axes are the world's.
        rate: Speed limits of the commanded pose.
        size: Length of the simulated hand relative to the average hand.
        root_smoothing: Time constant (s) of the smoothing of the palm's position and rotation; 0
            switches it off. PAALM smooths fingers itself.
        patience, rise, rise_speed, near, floor: See `FollowingSettings`.
    """

    device: Vector = (0.0, 0.0, -0.10)
    rate: RateLimit = field(default_factory=RateLimit)
    size: float = 1.0
    root_smoothing: float = 0.04
    patience: float = 0.3
    rise: float = 0.08
    rise_speed: float = 0.15
    near: float = 0.02
    floor: float = 0.0

    @property
    def following(self) -> FollowingSettings:
        """How the commanded pose follows the poses of PAALM."""
        return FollowingSettings(
            self.rate,
            self.root_smoothing,
            0.0,
            self.patience,
            self.rise,
            self.rise_speed,
            self.near,
            self.floor,
        )


class HandReconstructor:
    """Reconstructs one hand of a `Paalm` as poses of the sandbox's hand.

    Args:
        paalm: The PAALM object; from now on, only this reconstructor may use it.
        side: `right` or `left`.
        settings: See `HandReconstructorSettings`.
        surface: Workspace of a task; None is the default tablet.
        assume: True calibrates an uncalibrated hand when it is first seen, by the device's own
            bones or as an average hand.

    Attributes:
        empty: Frame that is used until the device has sent its first frame.

    Raises:
        EncoderError: PAALM has not measured that hand, and `assume` is false.
    """

    empty = HandFrame(0.0)

    def __init__(
        self,
        paalm: Paalm,
        side: str = "right",
        settings: HandReconstructorSettings | None = None,
        surface: Surface | None = None,
        assume: bool = False,
    ) -> None:
        self._assume = assume and side not in paalm.calibration
        if side not in paalm.calibration and not assume:
            raise EncoderError(
                "this hand was not calibrated",
                got=side,
                expected=", ".join(paalm.calibration) or "a calibrated PAALM",
            )
        self.paalm, self.side = paalm, side
        self.settings = settings or HandReconstructorSettings()
        self.surface = surface or Surface()
        self._skeleton = Person(side, self.settings.size).skeleton(ADULT)
        self.reset()

    @property
    def counts(self) -> dict[str, int]:
        """Number of frames and hands that could not be used, by reason; `frames` counts the frames
        that were used."""
        return self.paalm.counts

    @property
    def commanded(self) -> Array:
        """The last commanded pose (48,), in the world."""
        return self._hand.commanded

    @property
    def notice(self) -> str:
        """Notice to the person whose hand is not tracked; empty while the hand is tracked."""
        if self._refused and (self._time or 0.0) - self._refused_at < NOTICE_LASTS:
            return Message("hands_apart", "{why}: hold them apart", why=self._refused)
        return self._hand.notice(self.side)

    def reset(self) -> None:
        """Resets to the initial state, an open hand 20 cm above the device."""
        if self._assume:
            self.paalm.use({})
        self.paalm.reset()
        self._time: float | None = None
        across = (1.0, 0.0, 0.0) if self.side == "right" else (-1.0, 0.0, 0.0)
        palm = Palm((0.0, 0.0, 0.20), across, (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        start = self._pose(np.zeros((len(FINGERS), 4)), palm)
        self._hand = FollowedHand(self._skeleton, self.settings.following, start)
        self._refused, self._refused_at = "", 0.0

    def step(self, frame: HandFrame) -> Reconstruction:
        """Processes a hand frame; called once per control step, even if nothing has changed.

        A hand that the device has lost holds its pose for the time `patience`, then rises as a
        ghost, since its position is unknown.
        """
        dt = 0.0 if self._time is None else max(frame.time - self._time, 0.0)
        self._time = frame.time if self._time is None else max(frame.time, self._time)
        hand = self._reconstruct(frame)
        if hand is not None and hand.seen:
            self._hand.follow(self._pose(hand.table, hand.palm), dt)
        else:
            self._hand.lose(dt)
        return self._hand.reconstruction(
            float(hand.miss.max()) if hand is not None else float("nan")
        )

    def _reconstruct(self, frame: HandFrame) -> PaalmHand | None:
        if self._assume and self.side not in self.paalm.calibration:
            if not any(h.side in (None, self.side) for h in frame.hands):
                return None
            self.paalm.use({self.side: average_calibration([frame], self.side, self.paalm.options)})
        hands = self.paalm.step(frame)
        if hands.refused:
            self._refused, self._refused_at = hands.refused, frame.time
        return hands.hands.get(self.side)

    def _pose(self, table: Array, palm: Palm) -> Array:
        return hand_pose(table, palm, self.side, self.settings.device, size=self.settings.size)
