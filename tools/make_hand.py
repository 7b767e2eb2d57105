"""The hand alone as plain MJCF, `hand.xml`, which any MuJoCo viewer opens.

    python -m tools.make_hand     # writes the file again

The hand is taken from a scene, so that it is the simulated hand. The table and the sensors are left
out.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Comment, Element, fromstring, indent, tostring

from models.hand import Hand
from models.scene import SceneSpec, scene_xml

HAND_FILE = Path(__file__).resolve().parents[1] / "models" / "hand.xml"

_ABOUT = """
  A right hand of 48 degrees of freedom. Metres, kilograms, seconds; angles of this file in degrees.

  The 48 controls are the pose: place of the wrist (3, m), its rotation vector (3, rad), then a
  rotation vector (3, rad) for each of 14 ball joints: thumb CMC, MCP; index, middle, ring and
  little finger MCP, PIP, DIP. Zero is the middle of each joint's range of flexion. Every servo
  gives at most {impulse:g} N s (N m s) in 1/60 s, which is {force:g} N (N m).

  Written by `python -m tools.make_hand`; changes belong into models/hand.py.
"""


def hand_xml(hand: Hand) -> str:
    """MJCF of one hand with its servos, and lights.

    Args:
        hand: The hand.
    """
    root = fromstring(scene_xml(SceneSpec(hands=(hand,))))
    root.set("model", "hand")
    root.insert(0, Comment(_ABOUT.format(impulse=hand.impulse, force=hand.force_limit)))
    for part in root.findall("sensor"):
        root.remove(part)
    _remove(root, "worldbody", "geom")
    # These are the colours of the table, which has been removed.
    _remove(root, "asset", "material")
    _remove(root, "asset", "texture[@type='2d']")
    indent(root)
    return tostring(root, encoding="unicode") + "\n"


def _remove(root: Element, section: str, what: str) -> None:
    parent = root.find(section)
    if parent is not None:
        for child in parent.findall(what):
            parent.remove(child)


if __name__ == "__main__":
    HAND_FILE.write_text(hand_xml(Hand()), encoding="utf-8")
    print(HAND_FILE)
