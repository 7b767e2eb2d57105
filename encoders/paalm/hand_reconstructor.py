"""From one hand frame after another to the pose of the whole hand: PAALM as a reconstructor.

It has the interface of `encoders.touch_reconstructor`, so that whatever drives a hand by touches
can drive one by a Leap: `step(frame)`, `reset()`, `commanded`, and a `Reconstruction`.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from encoders.arrival import Phase
from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.paalm import Paalm
from encoders.paalm.palm import Palm
from encoders.touch_reconstructor import Reconstruction
from models.errors import EncoderError
from models.frames import FINGERS, HandFrame, Vector
from models.limits import RateLimit

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HandReconstructorSettings:
    """What takes part between hand frames and pose.

    Attributes:
        device: m, where the device is in the world. Its axes are the world's.
        rate: Bounds on the commanded pose's speed.
    """

    device: Vector = (0.0, 0.0, -0.10)
    rate: RateLimit = field(default_factory=RateLimit)


class HandReconstructor:
    """One hand of a calibrated `Paalm`, as poses of the sandbox's hand.

    Args:
        paalm: Calibrated for the side; it belongs to this reconstructor from now on.
        side: `right` or `left`.
        settings: What takes part.

    Raises:
        EncoderError: PAALM has not measured that hand.
    """

    def __init__(
        self, paalm: Paalm, side: str = "right", settings: HandReconstructorSettings | None = None
    ) -> None:
        if side not in paalm.calibration:
            raise EncoderError(
                "this hand was not calibrated",
                got=side,
                expected=", ".join(paalm.calibration) or "a calibrated PAALM",
            )
        self.paalm, self.side = paalm, side
        self.settings = settings or HandReconstructorSettings()
        self.reset()

    @property
    def counts(self) -> Counter[str]:
        """How often frames or hands could not be used, by reason."""
        return self.paalm.counts

    @property
    def commanded(self) -> Array:
        """(48,) the pose last commanded, in the world."""
        return self._commanded

    def reset(self) -> None:
        """Back to an open hand 20 cm over the device."""
        self.paalm.reset()
        self._time: float | None = None
        across = (1.0, 0.0, 0.0) if self.side == "right" else (-1.0, 0.0, 0.0)
        palm = Palm((0.0, 0.0, 0.20), across, (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        open_hand = np.zeros((len(FINGERS), 4))
        self._commanded = hand_pose(open_hand, palm, self.side, self.settings.device)
        self._seen = False

    def step(self, frame: HandFrame) -> Reconstruction:
        """Takes in a hand frame; called once per control step, also when nothing has changed.

        A hand that is not seen holds its pose and is a ghost: nobody can say where it is.
        """
        dt = 0.0 if self._time is None else max(frame.time - self._time, 0.0)
        self._time = frame.time if self._time is None else max(frame.time, self._time)
        hand = self.paalm.step(frame).hands.get(self.side)
        seen = hand is not None and hand.seen
        if hand is not None:
            goal = hand_pose(hand.table, hand.palm, self.side, self.settings.device)
            first = not self._seen
            self._commanded = goal if first else self.settings.rate(self._commanded, goal, dt)
            self._seen = True
        return Reconstruction(
            self._commanded,
            Phase.DOWN if seen else Phase.AWAY,
            frozenset(range(len(FINGERS))) if seen else frozenset(),
            None,
            1.0,
            float(hand.miss.max()) if hand is not None else float("nan"),
            (),
        )
