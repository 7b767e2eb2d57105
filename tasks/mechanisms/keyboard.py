"""A row of five sprung keys like those of a piano, one for each finger of a hand."""

from __future__ import annotations

from collections.abc import Collection

from models.frames import FINGERS
from models.mechanisms.mechanism import Mechanism

NAME = "keys"
KEYS = len(FINGERS)
PITCH = 0.0235
"""m from key to key, the width of a piano's white keys (165 mm an octave of seven)."""
GAP = 0.001
"""m between two keys."""
LENGTH = 0.150
"""m, visible length of a piano's white key."""
DIP = 0.010
"""m by which a key can be pressed down, as a piano's."""
LIGHTEST, HEAVIEST = 0.5, 0.8
"""N, force that presses a key down from its rest, and that holds it at the bottom: a piano key
sinks under a weight of about 50 g."""
MASS = 0.050
"""kg, what a finger moves; its weight is balanced."""
DAMPING = 0.5
"""N s/m."""
TOP = 0.028
"""m, height of the keys' tops above the table."""

_HEIGHT = 0.018
"""m from the top of a key to its lower side, which touches the table when it is pressed down."""
_IVORY, _ASKED, _WOOD = ".93 .92 .88 1", ".20 .55 .78 1", ".16 .15 .15 1"


def keyboard(
    position: tuple[float, float], yaw: float, asked: Collection[int], size: float
) -> Mechanism:
    """A row of five keys that is fixed on the table; `key_name` gives their names.

    Args:
        position: (2,) m, middle of the row.
        yaw: rad about the vertical; at 0 the first key is the leftmost.
        asked: Indices of the keys in another colour.
        size: Factor on the distance from key to key.
    """
    pitch = PITCH * size
    stiffness = (HEAVIEST - LIGHTEST) / DIP
    keys = []
    for key in range(KEYS):
        x, half = (key - (KEYS - 1) / 2) * pitch, (pitch - GAP) / 2
        keys.append(
            f'<body name="{key}" pos="{x:.6f} 0 0" gravcomp="1">'
            f'<joint type="slide" axis="0 0 -1" range="0 {DIP}" stiffness="{stiffness:g}"'
            f' springref="{-LIGHTEST / stiffness:.6f}" damping="{DAMPING}"/>'
            f'<geom type="box" size="{half:.6f} {LENGTH / 2} {_HEIGHT / 2}"'
            f' pos="0 0 {-_HEIGHT / 2}" mass="{MASS}" rgba="{_ASKED if key in asked else _IVORY}"/>'
            "</body>"
        )
    # A rail behind the keys, which nothing touches.
    width = KEYS * pitch / 2 + 0.006
    rail = (
        f'<geom type="box" size="{width:.6f} .006 {TOP / 2 + 0.002}" contype="0" conaffinity="0"'
        f' pos="0 {LENGTH / 2 + 0.008} {-TOP / 2 + 0.002}" rgba="{_WOOD}"/>'
    )
    mjcf = f"<mujoco><worldbody><body>{rail}{''.join(keys)}</body></worldbody></mujoco>"
    # Its origin is at the tops, which stay where they are in a row of another size.
    return Mechanism(NAME, mjcf, (*position, TOP), yaw)


def key_name(key: int) -> str:
    """Name of a key among the objects, 0 for the leftmost."""
    return f"{NAME}/{key}"
