"""Layouts of five fingers, found in a session for the settings of later sessions and for profiles.

A layout holds the places of five fingers that touch together, thumb first. Places are in metres at
the size of the person's hand, in the frame of a right hand at the screen's lower edge: x right, y
down.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from encoders.labels.belief import MOST, BeliefLabels, OwnLayouts
from encoders.reconstruction.reconstructor import PersonalReconstructor
from encoders.reconstruction.touch_reconstructor import TouchReconstructor
from models.errors import EncoderError
from models.frames import FINGERS
from sandbox.session.session import Session

Layouts = tuple[tuple[tuple[float, float], ...], ...]
"""Places (x, y) of five fingers in each layout, m; the newest layout is last."""

DIGITS = 5
"""Decimal places of stored coordinates in metres: a hundredth of a millimetre."""


def stored_layouts(own: OwnLayouts, size: float) -> Layouts:
    """Converts layouts of a hand of a given size to the form of settings and profiles."""
    xy = (own.metres * size).round(DIGITS)
    return tuple(tuple((x, y) for x, y in places) for places in xy.tolist())


def known_layouts(layouts: Sequence[Sequence[tuple[float, float]]], size: float) -> OwnLayouts:
    """Converts stored layouts of a hand of a given size to layouts of the trained hand.

    Raises:
        EncoderError: There are too many layouts, or a layout does not have five places.
    """
    if len(layouts) > MOST:
        raise EncoderError("too many layouts", got=len(layouts), expected=f"at most {MOST}")
    if any(len(places) != len(FINGERS) for places in layouts):
        raise EncoderError("not layouts of five fingers", expected="five places each")
    return OwnLayouts(np.array(layouts, float).reshape(-1, len(FINGERS), 2) / size)


def learned_layouts(session: Session) -> dict[str, Layouts]:
    """The layouts of each hand that has learned a new layout, by the hand's name.

    Layouts known at the session's start are included, as far as there is room.
    """
    learned = {}
    for rig in session.rigs:
        reconstructor: Any = rig.reconstructor
        size = 1.0
        if isinstance(reconstructor, PersonalReconstructor):
            size = reconstructor.frame.person.hand_size
            reconstructor = reconstructor.trained
        own = _new(reconstructor)
        if own is not None:
            learned[rig.hand.name] = stored_layouts(own, size)
    return learned


def _new(reconstructor: Any) -> OwnLayouts | None:
    """Layouts that a hand's labeller has learned; None if it has learned nothing new."""
    if not isinstance(reconstructor, TouchReconstructor):
        return None
    labeller = reconstructor.labeller
    if not isinstance(labeller, BeliefLabels) or labeller.own is labeller.known:
        return None
    return labeller.own
