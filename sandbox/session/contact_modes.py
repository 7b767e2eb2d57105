"""Contact modes: hard, soft and none, changed while a session runs and without a jump of its state.

Soft contacts give way, and the hand that makes them is weak: what a person squeezes by mistake is
not thrown. None lets the hand pass through everything. Hardness changes over a moment, since a
fingertip that lies a few millimetres inside an object would throw it, were it hard at once.
"""

from __future__ import annotations

import struct
from enum import StrEnum

import numpy as np

from models.errors import InputError
from models.hand import IMPULSE_PERIOD
from models.scene import CONTROL_PERIOD, Scene


class ContactMode(StrEnum):
    """Contact modes of hands and objects."""

    HARD = "hard"
    SOFT = "soft"
    NONE = "none"

    @property
    def next(self) -> ContactMode:
        """The mode that follows when a person goes through them."""
        modes = list(ContactMode)
        return modes[(modes.index(self) + 1) % len(modes)]


SOFT_IMPULSE = 0.05
"""N s per 1/60 s, impulse limit of every servo of a soft hand: 3 N."""
SOFT_SOLREF = (0.080, 1.0)
"""s and damping ratio of a soft contact; hard ones have 4 ms. A fingertip that holds a box at 3 N
is 1.3 mm inside it."""
SOFT_SOLIMP = (0.97, 0.995, 0.001, 0.5, 2.0)
"""Impedance of a soft contact, no less than a hard one's: what gives way by its impedance lets a
held box creep by 0.8 mm in 5 s, what gives way by its time constant by 0.1 mm (benchmarks.feel)."""
SOFT_TOLERANCE = 1e-11
"""Of the solver, while contacts are soft. What it leaves undone at MuJoCo's 1e-8 is little beside
hard contacts, and beside soft ones enough to rock what two fingers hold; it costs no time."""
CHANGE = 0.2
"""s from hard to soft and back."""

_OWN = 1e6
"""Weight of a soft hand's contact parameters against an object's own."""


def contact_mode(name: str) -> ContactMode:
    """The mode of a name.

    Raises:
        InputError: There is none.
    """
    try:
        return ContactMode(name)
    except ValueError:
        raise InputError(
            "no such contact mode", where="--contact", got=name, expected=", ".join(ContactMode)
        ) from None


class ContactModes:
    """The contact mode of a scene's hands, written into its model step by step.

    Args:
        scene: Its model belongs to one session.
        mode: At the start, in full at once.

    Attributes:
        mode: What was asked for last.
        softness: 0 (hard) to 1 (soft), where the change has got to.
    """

    def __init__(self, scene: Scene, mode: ContactMode = ContactMode.HARD) -> None:
        self._model = model = scene.model
        hands = scene.spec.hands
        self._geoms = np.array([model.geom(link.geom).id for hand in hands for link in hand.links])
        names = tuple(f"{h.name}_" for h in hands)
        self._actuators = np.array(
            [i for i in range(model.nactuator) if model.actuator(i).name.startswith(names)]
        )
        self._solref = model.geom_solref[self._geoms].copy()
        self._solimp = model.geom_solimp[self._geoms].copy()
        self._solmix = model.geom_solmix[self._geoms].copy()
        self._range = model.actuator_forcerange[self._actuators].copy()
        self._tolerance = float(model.opt.tolerance)
        self.mode = mode
        self.softness = self._goal
        self._apply()

    @property
    def ghost(self) -> bool:
        """True if hands pass through everything."""
        return self.mode is ContactMode.NONE

    @property
    def signature(self) -> bytes:
        """State besides MuJoCo's that affects the next step; empty for hard contacts."""
        if self.mode is ContactMode.HARD and self.softness == 0.0:
            return b""
        return self.mode.encode() + struct.pack("<d", self.softness)

    def step(self) -> None:
        """Goes on with a change for one control period."""
        if self.softness != self._goal:
            share = CONTROL_PERIOD / CHANGE
            self.softness += float(np.clip(self._goal - self.softness, -share, share))
            self._apply()

    @property
    def _goal(self) -> float:
        return 1.0 if self.mode is ContactMode.SOFT else 0.0

    def _apply(self) -> None:
        """Writes the model: times and forces change by a share, impedances by an amount."""
        model, soft = self._model, self.softness
        if soft == 0.0:
            model.geom_solref[self._geoms] = self._solref
            model.geom_solimp[self._geoms] = self._solimp
            model.geom_solmix[self._geoms] = self._solmix
            model.actuator_forcerange[self._actuators] = self._range
            model.opt.tolerance = self._tolerance
            return
        model.geom_solref[self._geoms] = self._solref * (SOFT_SOLREF / self._solref) ** soft
        model.geom_solimp[self._geoms] = self._solimp + soft * (SOFT_SOLIMP - self._solimp)
        model.geom_solmix[self._geoms] = self._solmix * (_OWN / self._solmix) ** soft
        limit = self._range[:, 1:]
        weaker = np.minimum(SOFT_IMPULSE / IMPULSE_PERIOD / limit, 1.0) ** soft
        model.actuator_forcerange[self._actuators] = self._range * weaker
        model.opt.tolerance = self._tolerance * (SOFT_TOLERANCE / self._tolerance) ** soft
