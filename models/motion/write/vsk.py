"""Writes a hand as a Vicon skeleton (.vsk), with a marker at every fingertip.

Millimetres. Segments have the hand's own axes in its zero pose (fingers along y, palm down, z up),
so that no segment is rotated against its parent, and the only rotations are those of the motion.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from models.frames import FINGERS
from models.motion.armature import Armature, Keys
from models.motion.output import MotionWriter

MILLIMETRES = 1000.0
ORDER = "XYZ"
"""Euler order whose zero pose has the hand's own axes."""

_COLOURS = ("255 160 60", "60 140 255", "60 200 120", "230 80 80", "170 110 230")


def vsk(armature: Armature) -> bytes:
    """Text of the VSK file of a hand."""
    zero = armature.zero(ORDER)
    model = Element("KinematicModel")
    SubElement(model, "Parameters")
    segments: list[Element] = []
    above = SubElement(model, "Skeleton")
    for j, name in enumerate(armature.names):
        parent = armature.parents[j]
        at = MILLIMETRES * (zero[parent] @ armature.offsets[j])
        segment = SubElement(
            segments[parent] if j else above,
            "Segment",
            {
                "NAME": name,
                "POSITION": _text(at),
                "ORIENTATION": "0 0 0",
                "BOUNDS": "0 0 0 0 0 0",
                "RGB": "255 255 255",
            },
        )
        segments.append(segment)
        freedoms = 3 if j else 6
        SubElement(
            segment,
            "JointBall" if j else "JointFree",
            {
                "MEAN": " ".join(["0"] * freedoms),
                "COVARIANCE": " ".join(f"{v:g}" for v in np.eye(freedoms).ravel()),
            },
        )
    markers = SubElement(SubElement(model, "MarkerSet", {"NAME": "fingertips"}), "Markers")
    for j, end in enumerate(armature.ends):
        if np.isfinite(end).all():
            finger = armature.skeleton.bones[j - 1].finger
            SubElement(
                markers,
                "Marker",
                {
                    "NAME": f"{FINGERS[finger]}_tip",
                    "SEGMENT": armature.names[j],
                    "RGB": _COLOURS[finger],
                    "POSITION": _text(MILLIMETRES * (zero[j] @ end)),
                    "COVARIANCE": " ".join(f"{v:g}" for v in np.eye(3).ravel()),
                    "RADIUS": f"{MILLIMETRES * armature.skeleton.tip_radius[finger]:.3f}",
                },
            )
    indent(model)
    head = '<?xml version="1.0" standalone="yes"?>\n'
    return (head + tostring(model, encoding="unicode") + "\n").encode("ascii")


class VskWriter(MotionWriter):
    """Writes the skeleton alone and ignores the motion.

    Args:
        path: Path of the file.
        armature: The hand.
    """

    def __init__(self, path: Path, armature: Armature) -> None:
        super().__init__(path)
        self._outputs[0].write(vsk(armature))

    def write(self, *hands: Keys) -> None:
        """Counts the keys."""
        self.frames += len(hands[0].root)


def _text(vector: np.ndarray) -> str:
    return " ".join(f"{v + 0.0:.9g}" for v in np.round(vector, 9).tolist())
