"""Colours of window, film and picture: red, green and blue from 0 to 1, sRGB."""

from __future__ import annotations

from models.frames import FINGERS

Colour = tuple[float, float, float]

FINGER_COLOURS: tuple[Colour, ...] = (
    (0.93, 0.45, 0.70),
    (0.95, 0.60, 0.10),
    (0.96, 0.86, 0.25),
    (0.35, 0.72, 0.95),
    (0.60, 0.50, 0.95),
)
"""One colour per label, thumb first. They differ in hue and lightness from one another, from the
goal's green and from the dark table. They are also distinguishable with the common kinds of colour
blindness."""

UNKNOWN: Colour = (0.62, 0.64, 0.66)
"""Colour of a contact that is ignored or not labelled yet."""

GOAL: Colour = (0.20, 0.80, 0.48)
REACHED: Colour = (0.45, 0.98, 0.55)
HELD: Colour = (1.00, 0.84, 0.30)
"""Colours of the goal: not reached, reached now, and held."""

OUTLINE: Colour = (0.62, 0.74, 0.80)
"""Colour of the touch surface's border."""

TARGET: Colour = (0.62, 0.82, 0.98)
"""Colour of a hand's commanded pose while it is held back."""

PANEL: Colour = (0.09, 0.12, 0.15)
TEXT: Colour = (0.95, 0.96, 0.97)
FAINT: Colour = (0.68, 0.73, 0.77)
WARNING: Colour = (0.98, 0.72, 0.25)


NO_FINGER = ("ignored", "palm")
"""States of contacts that are not fingers of the hand."""


def finger_colour(label: int | None, state: str = "active") -> Colour:
    """Returns the colour of a contact: that of its finger, or grey if it is ignored or has none."""
    if label is None or state in NO_FINGER:
        return UNKNOWN
    return FINGER_COLOURS[label]


def finger_name(label: int | None, state: str = "active", sure: bool = True) -> str:
    """Returns the text next to a contact, with a question mark if the label is uncertain."""
    if state in NO_FINGER:
        return state
    return "?" if label is None else FINGERS[label] + ("" if sure else "?")


def bytes_of(colour: Colour, alpha: float = 1.0) -> tuple[int, int, int, int]:
    """Returns the colour as RGBA bytes, 0 to 255."""
    r, g, b, a = (round(255 * c) for c in (*colour, alpha))
    return r, g, b, a
