"""A small robot's hand of our own, written as MJCF: five fingers of four hinges each."""

from __future__ import annotations

from pathlib import Path

from models.frames import FINGERS

TIPS = tuple(f"{finger}_tip" for finger in FINGERS)
"""Names of the sites at its fingertips."""

_BASES = (
    (-0.030, 0.030, -0.008),
    (-0.028, 0.09, 0),
    (-0.005, 0.093, 0),
    (0.018, 0.09, 0),
    (0.038, 0.08, 0),
)


def hinge_hand(folder: Path, side: str = "right", extra: str = "", tips: int = 5) -> Path:
    """Writes the hand's file and returns its path.

    Args:
        folder: Folder for the file.
        side: `right`, or `left` for the mirror image.
        extra: MJCF that is added below `<mujoco>`.
        tips: Number of fingers, thumb first.
    """
    sign = 1.0 if side == "right" else -1.0
    fingers = []
    for label, (x, y, z) in list(zip(FINGERS, _BASES, strict=True))[:tips]:
        # The thumb points forward, down and to its side, and bends towards the fingers.
        euler = f"-25 0 {40 * sign}" if label == "thumb" else "0 0 0"
        fingers.append(
            f"""
      <body name="{label}_base" pos="{sign * x} {y} {z}" euler="{euler}">
        <joint name="{label}_spread" axis="0 0 {sign}" range="-25 25"/>
        <geom type="sphere" size=".008" mass=".01"/>
        <body name="{label}_near">
          <joint name="{label}_mcp" axis="-1 0 0" range="0 90"/>
          <geom type="capsule" fromto="0 0 0 0 .045 0" size=".009" mass=".02"/>
          <body name="{label}_middle" pos="0 .045 0">
            <joint name="{label}_pip" axis="-1 0 0" range="0 95"/>
            <geom type="capsule" fromto="0 0 0 0 .028 0" size=".008" mass=".01"/>
            <body name="{label}_far" pos="0 .028 0">
              <joint name="{label}_dip" axis="-1 0 0" range="0 80"/>
              <geom type="capsule" fromto="0 0 0 0 .022 0" size=".007" mass=".01"/>
              <site name="{label}_tip" pos="0 .022 0"/>
            </body>
          </body>
        </body>
      </body>"""
        )
    path = folder / f"{side}_hinges.xml"
    path.write_text(
        f"""<mujoco>
  <compiler angle="degree"/>
  <worldbody>
    <body name="arm">
      <joint name="elbow" axis="1 0 0"/>
      <geom type="box" size=".03 .1 .02" pos="0 -.1 0"/>
      <body name="palm">
        <geom type="box" size=".04 .045 .012" pos="0 .045 0"/>{"".join(fingers)}
      </body>
    </body>
  </worldbody>
  <actuator>
    <position name="pull" joint="index_pip" kp="1" forcerange="-.7 .7"/>
  </actuator>
  {extra}
</mujoco>
""",
        encoding="utf-8",
    )
    return path


def edited(path: Path, *changes: tuple[str, str]) -> Path:
    """The file with some of its text replaced wherever it stands."""
    text = path.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")
    return path
