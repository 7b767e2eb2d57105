"""Reader and writer of Vicon skeletons (.vsk): nested segments with their joints and markers.

A file is XML, in millimetres and radians. A segment's `POSITION` and `ORIENTATION` (a rotation
vector) are those of its joint in the parent segment. The name of a parameter, with or without a
minus sign, may replace a number. The format is not published: this reader follows a genuine file
and the reader of the DART library.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import numpy as np

from models.arithmetic import Array
from models.errors import MotionError
from models.frames import FINGERS
from models.motion.armature import Armature, Keys
from models.motion.output import MotionWriter
from models.motion.text import numbers, read_lines
from models.reader_report import ReaderReport
from models.rotations import exp

MILLIMETRE = 0.001

JOINTS = {
    "JointFree": 6,
    "JointBall": 3,
    "JointHardySpicer": 2,
    "JointHinge": 1,
    "JointDummy": 0,
}
"""Kinds of joints, and their degrees of freedom."""

DEEPEST = 100
"""Deepest nesting of segments. A file with deeper nesting is treated as damaged."""


@dataclass
class ViconSkeleton:
    """A skeleton at rest, parents before children.

    Attributes:
        names: Unique names of the segments.
        parents: Index of each segment's parent, -1 for a root.
        positions: (3,) m of each segment in its parent.
        frames: (3, 3) of each segment, parent from segment at rest.
        joints: Kind of each segment's joint, a key of `JOINTS`.
        markers: Name -> segment and position (3,) m in it.
        report: Parts of the file that the reader left out or assumed.
    """

    names: list[str] = field(default_factory=list)
    parents: list[int] = field(default_factory=list)
    positions: list[Array] = field(default_factory=list)
    frames: list[Array] = field(default_factory=list)
    joints: list[str] = field(default_factory=list)
    markers: dict[str, tuple[int, Array]] = field(default_factory=dict)
    report: ReaderReport = field(default_factory=ReaderReport)

    @property
    def freedoms(self) -> int:
        """Number of degrees of freedom of all joints together."""
        return sum(JOINTS[kind] for kind in self.joints)


def read_vsk(path: Path, unit: float = MILLIMETRE) -> ViconSkeleton:
    """Reads a skeleton.

    Args:
        path: The file.
        unit: Unit of length of the file (m).

    Raises:
        MotionError: The file is not a VSK file, is damaged, or two of its segments share a name.
    """
    report = ReaderReport()
    text = "\n".join(read_lines(path, "a VSK file", report))
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise MotionError("XML entities are not allowed in a skeleton", where=str(path))
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise MotionError(
            "this is not a whole VSK file", where=str(path), got=str(error), expected="XML"
        ) from None
    skeleton = root.find("Skeleton")
    if root.tag != "KinematicModel" or skeleton is None:
        raise MotionError(
            "this is not a VSK file",
            where=str(path),
            got=f"<{root.tag}>"[:40],
            expected="<KinematicModel> with a <Skeleton>",
        )
    reader = _Reader(path, unit, _parameters(path, root), report)
    for segment in skeleton.findall("Segment"):
        reader.segment(segment, -1, 1)
    if not reader.skeleton.names:
        raise MotionError("the skeleton contains no segment", where=str(path))
    for marker in root.iter("Marker"):
        reader.marker(marker)
    return reader.skeleton


def _parameters(path: Path, root: ElementTree.Element) -> dict[str, float]:
    out = {}
    for one in root.iterfind("Parameters/Parameter"):
        name = one.get("NAME", "")
        out[name] = numbers([one.get("VALUE", "")], 1, f"{path}, parameter {name}"[:120])[0]
    return out


class _Reader:
    def __init__(
        self, path: Path, unit: float, parameters: dict[str, float], report: ReaderReport
    ) -> None:
        self._path, self._unit, self._parameters = path, unit, parameters
        self.skeleton = ViconSkeleton(report=report)

    def segment(self, element: ElementTree.Element, parent: int, depth: int) -> None:
        """Reads a segment and the segments inside it."""
        name = element.get("NAME", "")
        where = f"{self._path}, segment {name}"[:120]
        if not name or name in self.skeleton.names:
            raise MotionError(
                "a segment has no name, or the name of another segment",
                where=str(self._path),
                got=name,
                expected="a different name for each segment",
            )
        if depth > DEEPEST:
            raise MotionError(
                "segments are nested too deeply",
                where=where,
                expected=f"at most {DEEPEST} levels",
            )
        kinds = [child.tag for child in element if child.tag.startswith("Joint")]
        if len(kinds) != 1 or kinds[0] not in JOINTS:
            raise MotionError(
                "a segment needs one joint",
                where=where,
                got=", ".join(kinds)[:60],
                expected=", ".join(JOINTS),
            )
        index = len(self.skeleton.names)
        self.skeleton.names.append(name)
        self.skeleton.parents.append(parent)
        self.skeleton.positions.append(self._unit * self._vector(element, "POSITION", where))
        self.skeleton.frames.append(exp(self._vector(element, "ORIENTATION", where)))
        self.skeleton.joints.append(kinds[0])
        for child in element.findall("Segment"):
            self.segment(child, index, depth + 1)

    def marker(self, element: ElementTree.Element) -> None:
        """Reads a marker."""
        name, segment = element.get("NAME", ""), element.get("SEGMENT", "")
        where = f"{self._path}, marker {name}"[:120]
        if segment not in self.skeleton.names:
            raise MotionError(
                "a marker is not on any segment",
                where=where,
                got=segment[:40],
                expected="one of " + ", ".join(self.skeleton.names)[:80],
            )
        place = self._unit * self._vector(element, "POSITION", where)
        self.skeleton.markers[name] = (self.skeleton.names.index(segment), place)

    def _vector(self, element: ElementTree.Element, key: str, where: str) -> Array:
        """Three numbers (3,) of an attribute; each is a number or the name of a parameter."""
        words = element.get(key, "0 0 0").split()
        return np.array(numbers([self._number(word) for word in words], 3, f"{where}, {key}"))

    def _number(self, word: str) -> str:
        sign, name = ("-", word[1:]) if word.startswith("-") else ("", word)
        if name in self._parameters:
            value = self._parameters[name]
            return repr(-value if sign else value)
        return word


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
