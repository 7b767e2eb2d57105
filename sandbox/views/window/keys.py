"""Help texts for the window's keys: a key, two spaces, and its effect."""

from __future__ import annotations

HINT = ("h or ?  keys",)
MOUSE_HELP = (
    "drag  one finger",
    "shift + click  pin a finger, or lift it",
    "drag a pin  moves it",
    "1 to 5  a hand of so many fingers",
    "drag beside it  moves the hand",
    "ctrl + drag  moves all pins",
    "wheel  open and close",
    "shift + wheel  turn",
    "space  lift all fingers",
)
HELP = (
    "right drag  look from elsewhere",
    "v  from above, and back",
    "c  contact: hard, soft, none",
    "p  pause",
    "s  slow motion: half, a quarter, a tenth",
    "r  start again",
    "q  close",
    "h or ?  hide this",
)

LEAP = 62
"""Number of control periods by which the arrow keys move: a second."""

REPLAY_HELP = (
    "p  pause, and on",
    "left, right  back and on by a second",
    "comma, period  back and on by a step",
    "s  slow motion: half, a quarter, a tenth",
    "r  from the beginning",
    "right drag  look from elsewhere",
    "v  from above, and back",
    "q  close",
    "h  hide this",
)

LIFT_HELP = ("up, down  lift and lower the hand",)


def keys(mouse: bool, lift: bool) -> tuple[str, ...]:
    """Help texts of all keys that have an effect, one line each.

    Args:
        mouse: The mouse acts as fingers.
        lift: Keys control the lift.
    """
    return (*(LIFT_HELP if lift else ()), *(MOUSE_HELP if mouse else ()), *HELP)
