"""A peg that lies on the table, and the socket for it: two walls and a bottom, open above."""

from __future__ import annotations

from models.mechanisms.mechanism import Mechanism
from models.objects import Box

PEG, SOCKET = "peg", "socket"
LENGTH, WIDTH, HEIGHT = 0.075, 0.025, 0.015
"""m, a block of the game Jenga: 7.5 x 2.5 x 1.5 cm."""
MASS = 0.018
"""kg, of such a block: 28 cm3 of wood of 0.64 g/cm3, as of alder."""
FRICTION = 0.4
"""Coefficient of smooth wood on wood, dry: tables say 0.25 to 0.5."""
DEPTH = 0.025
"""m by which the peg goes into the socket: a third of its length."""

_WALL = 0.010
"""m, thickness of walls and bottom."""
_ROUND = 0.003
"""m, radius of the rounded edges at the mouth."""
_SKIN = 0.0005
"""m, thickness of the skin (MuJoCo's margin) around walls and posts, whose cores are set back by as
much: faces are where they are said to be. Two cores whose faces meet in a corner penetrate each
other, and MuJoCo may take the direction of the push for that of a face; skins do not."""
_POST = _ROUND - _SKIN
"""m, radius of the cores of the posts that round them."""
_SOLID = f'friction="{FRICTION:g}" margin="{_SKIN:g}"'
_WOOD, _DARK = ".80 .62 .40 1", ".36 .30 .26 1"


def peg(position: tuple[float, float], yaw: float) -> Box:
    """The peg, lying flat.

    Args:
        position: (2,) m, its middle.
        yaw: rad about the vertical, of its length.
    """
    half = (LENGTH / 2, WIDTH / 2, HEIGHT / 2)
    return Box(PEG, half, MASS, (*position, half[2]), yaw, (0.86, 0.30, 0.24), FRICTION)


def socket(position: tuple[float, float], yaw: float, clearance: float) -> Mechanism:
    """The socket, fixed on the table. Its frame is where the middle of the peg is once it is in,
    x into the socket.

    Args:
        position: (2,) m, of its frame.
        yaw: rad about the vertical.
        clearance: m, width of the socket less that of the peg.
    """
    bottom, mouth = LENGTH / 2 + _SKIN, LENGTH / 2 - DEPTH + _SKIN
    inner, middle = (WIDTH + clearance) / 2 + _SKIN, HEIGHT / 2
    # The corner between mouth and wall is a round post, so that the peg slides into it.
    begin, outer, radius = mouth + _POST, inner + _WALL, _POST
    geoms = _box((bottom, bottom + _WALL), (-outer, outer), _DARK)
    for side in (1.0, -1.0):
        geoms += _box((begin, bottom), (side * inner, side * outer))
        geoms += _box((mouth, begin), (side * (inner + radius), side * outer))
        geoms += (
            f'<geom type="cylinder" size="{radius:.9g} {middle:g}" {_SOLID} rgba="{_WOOD}"'
            f' pos="{begin:.9g} {side * (inner + radius):.9g} {middle:g}"/>'
        )
    mjcf = f"<mujoco><worldbody><body>{geoms}</body></worldbody></mujoco>"
    return Mechanism(SOCKET, mjcf, (*position, 0.0), yaw)


def _box(x: tuple[float, float], y: tuple[float, float], rgba: str = _WOOD) -> str:
    """MJCF of a block as high as the peg, from one x to another and from one y to another."""
    half = HEIGHT / 2
    size = f"{abs(x[1] - x[0]) / 2:.9g} {abs(y[1] - y[0]) / 2:.9g} {half:g}"
    pos = f"{(x[0] + x[1]) / 2:.9g} {(y[0] + y[1]) / 2:.9g} {half:g}"
    return f'<geom type="box" size="{size}" pos="{pos}" {_SOLID} rgba="{rgba}"/>'
