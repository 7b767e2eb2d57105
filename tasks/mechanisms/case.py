"""A case of two halves, as for a toothbrush, one pushed over the neck of the other."""

from __future__ import annotations

from models.mechanisms.mechanism import Mechanism

CASE = "case"
CAP = f"{CASE}/cap"
HALF_LENGTH, WIDTH, HEIGHT = 0.100, 0.028, 0.022
"""m, each half of a travel case for a toothbrush, which is about 20 cm long in all."""
MASS = 0.020
"""kg, of each half: thin plastic."""
FRICTION = 0.4
"""Coefficient of smooth plastic on a table, and under a finger; assumed."""
TRAVEL = 0.020
"""m by which the neck of one half goes into the other."""

_ARMATURE = 0.02
"""kg, on the slide; friction alone would make so light a part stiff to simulate."""
_NECK = 0.002
"""m by which the neck is narrower, on each side."""
_BODY, _CAP, _INSIDE = ".90 .92 .94 1", ".20 .55 .78 1", ".70 .73 .77 1"


def case(position: tuple[float, float], yaw: float, grip: float) -> Mechanism:
    """The case, open and free on the table. Its frame is at the rim of the half with the neck, x
    towards the other half, whose frame is at its own rim.

    Args:
        position: (2,) m, of its frame.
        yaw: rad about the vertical.
        grip: N, friction with which the cap slides on the neck.
    """
    half = f"{HALF_LENGTH / 2:g} {WIDTH / 2:g} {HEIGHT / 2:g}"
    neck = f"{TRAVEL / 2:g} {WIDTH / 2 - _NECK:g} {HEIGHT / 2 - _NECK:g}"
    solid = f'type="box" mass="{MASS:g}" friction="{FRICTION:g}"'
    mjcf = f"""<mujoco><worldbody><body pos="0 0 {HEIGHT / 2:g}"><freejoint/>
      <geom {solid} size="{half}" pos="{-HALF_LENGTH / 2:g} 0 0" rgba="{_BODY}"/>
      <geom type="box" mass="0" size="{neck}" pos="{TRAVEL / 2:g} 0 0" contype="0" conaffinity="0"
        rgba="{_INSIDE}"/>
      <body name="cap">
        <joint type="slide" axis="1 0 0" range="0 {TRAVEL:g}" frictionloss="{grip:.9g}"
          damping="1" armature="{_ARMATURE:g}"/>
        <geom {solid} size="{half}" pos="{HALF_LENGTH / 2:g} 0 0" rgba="{_CAP}"/>
      </body></body></worldbody></mujoco>"""
    return Mechanism(CASE, mjcf, (*position, HEIGHT / 2), yaw, {"cap": TRAVEL})
