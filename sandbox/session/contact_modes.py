"""Contact modes (hard, soft, none), which can change during a session without a jump of its state.

Soft contacts give way, and a soft hand is weak, so that an object squeezed by mistake is not
thrown. With `none` the hand passes through everything. Hardness changes gradually: a fingertip a
few millimetres inside an object would throw it if it became hard in one step.
"""

from __future__ import annotations

import struct
from enum import StrEnum

import numpy as np

from models.arithmetic.functions import power
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
        """The next mode when a person cycles through them."""
        modes = list(ContactMode)
        return modes[(modes.index(self) + 1) % len(modes)]


SOFT_IMPULSE = 0.05
"""N s per 1/60 s, impulse limit of every servo of a soft hand: 3 N."""
SOFT_SOLREF = (0.080, 1.0)
"""s and damping ratio of a soft contact; hard ones have 4 ms. A fingertip that holds a box at 3 N
is 1.3 mm inside it."""
SOFT_SOLIMP = (0.97, 0.995, 0.001, 0.5, 2.0)
"""Impedance of a soft contact, at least that of a hard one. A held box creeps by 0.8 mm in 5 s if
softness comes from a lower impedance, by 0.1 mm if it comes from the time constant
(measured at db485e42)."""
SOFT_TOLERANCE = 1e-11
"""Solver tolerance while contacts are soft. The residual at MuJoCo's default of 1e-8 is negligible
with hard contacts, but with soft ones it rocks an object held by two fingers. The lower tolerance
takes no measurable time."""
CHANGE = 0.2
"""s, duration of a change from hard to soft and back."""

_OWN = 1e6
"""Weight of a soft hand's contact parameters against an object's own."""


def contact_mode(name: str) -> ContactMode:
    """The contact mode of this name.

    Raises:
        InputError: No mode has this name.
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
        scene: The scene; its model must not be shared with another session.
        mode: Initial mode, in full effect from the start.

    Attributes:
        mode: The mode that was requested last.
        softness: Current softness, 0 (hard) to 1 (soft), during a change.
    """

    def __init__(self, scene: Scene, mode: ContactMode = ContactMode.HARD) -> None:
        self._model = model = scene.model
        hands = scene.spec.hands
        self._geoms = np.array(sorted(g for i in range(len(hands)) for g in scene.parts(i)))
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
        """State outside MuJoCo's that affects the next step; empty for hard contacts."""
        if self.mode is ContactMode.HARD and self.softness == 0.0:
            return b""
        return self.mode.encode() + struct.pack("<d", self.softness)

    def step(self) -> None:
        """Advances a change of softness by one control period."""
        if self.softness != self._goal:
            share = CONTROL_PERIOD / CHANGE
            self.softness += float(np.clip(self._goal - self.softness, -share, share))
            self._apply()

    @property
    def _goal(self) -> float:
        return 1.0 if self.mode is ContactMode.SOFT else 0.0

    def _apply(self) -> None:
        """Writes the model: times and forces change geometrically, impedances linearly."""
        model, soft = self._model, self.softness
        if soft == 0.0:
            model.geom_solref[self._geoms] = self._solref
            model.geom_solimp[self._geoms] = self._solimp
            model.geom_solmix[self._geoms] = self._solmix
            model.actuator_forcerange[self._actuators] = self._range
            model.opt.tolerance = self._tolerance
            return
        model.geom_solref[self._geoms] = self._solref * power(SOFT_SOLREF / self._solref, soft)
        model.geom_solimp[self._geoms] = self._solimp + soft * (SOFT_SOLIMP - self._solimp)
        model.geom_solmix[self._geoms] = self._solmix * power(_OWN / self._solmix, soft)
        limit = self._range[:, 1:]
        weaker = power(np.minimum(SOFT_IMPULSE / IMPULSE_PERIOD / limit, 1.0), soft)
        model.actuator_forcerange[self._actuators] = self._range * weaker
        model.opt.tolerance = self._tolerance * (SOFT_TOLERANCE / self._tolerance) ** soft
