"""A round knob on a plate with a scale, as of a cooker, that turns between two end stops."""

from __future__ import annotations

from math import cos, radians, sin

from models.mechanisms.mechanism import Mechanism

NAME = "dial"
KNOB = f"{NAME}/knob"
RADIUS = 0.020
"""m, of the knob: one of a cooker is about 40 mm wide."""
SWEEP = radians(300.0)
"""rad from end stop to end stop, as of a rotary potentiometer."""
ARMATURE = 1e-4
"""kg m2, of the shaft; friction alone would make a joint of so little inertia stiff to simulate."""
MASS = 0.030
"""kg."""

_LOW, _HIGH = 0.005, 0.025
"""m above the table, lower and upper end of the knob."""
_PLATE = (0.036, 0.004)
"""m, radius and thickness of the plate."""
_TICKS = 11
"""Marks from end stop to end stop, 30 degrees apart."""
_STEEL, _DARK, _WHITE, _BLUE = ".62 .65 .70 1", ".14 .15 .17 1", ".93 .94 .95 1", ".20 .55 .78 1"


def dial(
    position: tuple[float, float], yaw: float, start: float, mark: float, torque: float
) -> Mechanism:
    """A knob on its plate, fixed on the table. Its angle is 0 where it points along the plate's y
    axis, and the gap of its scale is on the other side.

    Args:
        position: (2,) m, middle of the knob.
        yaw: rad about the vertical, of the plate.
        start: rad, angle of the knob.
        mark: rad, angle of the blue mark on the plate.
        torque: N m, dry friction of the knob.
    """
    ticks = [SWEEP * (i / (_TICKS - 1) - 0.5) for i in range(_TICKS)]
    scale = "".join(_tick(angle, 0.0270, 0.0015, 0.0006, _WHITE) for angle in ticks)
    scale += _tick(mark, 0.0295, 0.0045, 0.0016, _BLUE)
    middle, half = (_LOW + _HIGH) / 2, (_HIGH - _LOW) / 2
    half_sweep = SWEEP / 2
    mjcf = f"""<mujoco><compiler angle="radian"/><worldbody><body>
      <geom type="cylinder" size="{_PLATE[0]} {_PLATE[1] / 2}" pos="0 0 {_PLATE[1] / 2}"
        rgba="{_STEEL}"/>{scale}
      <body name="knob" pos="0 0 {middle:g}">
        <joint type="hinge" axis="0 0 1" range="{-half_sweep:.9g} {half_sweep:.9g}"
          frictionloss="{torque:.9g}" damping="1e-3" armature="{ARMATURE}"/>
        <geom type="cylinder" size="{RADIUS} {half:g}" mass="{MASS}" rgba="{_DARK}"/>
        <geom type="box" size=".0013 {RADIUS / 2} .0006" pos="0 {RADIUS / 2} {half + 0.0003:g}"
          mass="0" contype="0" conaffinity="0" rgba="{_WHITE}"/>
      </body></body></worldbody></mujoco>"""
    return Mechanism(NAME, mjcf, (*position, 0.0), yaw, {"knob": start})


def _tick(angle: float, out: float, half_length: float, half_width: float, rgba: str) -> str:
    """MJCF of a mark on the plate, at an angle from its y axis and so far out, m."""
    x, y = -out * sin(angle), out * cos(angle)
    size = f"{half_width} {half_length} .0003"
    return (
        f'<geom type="box" size="{size}" pos="{x:.6f} {y:.6f} {_PLATE[1] + 0.0002:g}"'
        f' euler="0 0 {angle:.6f}" contype="0" conaffinity="0" rgba="{rgba}"/>'
    )
