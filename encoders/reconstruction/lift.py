"""Height of the hand by the lift control, smoothed so that a held object does not shake.

The lift control, moved by the other hand, raises the hand along the surface's normal. A slider is
never quite still: 3 % of 18 cm would shake a held box by millimetres, sixty times a second.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import expm1


@dataclass(frozen=True)
class LiftSettings:
    """Settings of the lift control.

    Attributes:
        reach: m by which the hand rises at control 1; 0 for hands that are not lifted.
        tau: s, time constant of the low pass.
        speed: m/s, maximum speed.
    """

    reach: float = 0.0
    tau: float = 0.12
    speed: float = 0.30


class Lift:
    """Computes the height of a hand from the lift control, step by step.

    Attributes:
        height: m along the surface's normal.
    """

    def __init__(self, settings: LiftSettings) -> None:
        self.settings = settings
        self.reset()

    def reset(self) -> None:
        """Returns to the initial state, down."""
        self.height = 0.0
        self._smooth = 0.0

    def step(self, control: float | None, dt: float) -> None:
        """Advances by one time step.

        Args:
            control: 0 to 1; None counts as 0, so that devices without a lift control keep the hand
                down.
            dt: s, length of the step.
        """
        s = self.settings
        wanted = s.reach * (control or 0.0)
        self._smooth += (wanted - self._smooth) * -expm1(-dt / s.tau)
        most = s.speed * dt
        self.height += min(max(self._smooth - self.height, -most), most)
