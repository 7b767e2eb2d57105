"""Acclaim skeletons (.asf) and their motion (.amc), as in the CMU motion capture database.

A bone lies along `direction` for `length` and begins at its parent's end. All directions are given
in the frame of the whole skeleton at rest. `axis` rotates a bone's own frame into that frame. The
bone's degrees of freedom rotate it about the fixed axes of its own frame, in the order of the list.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from models.arithmetic import Array
from models.errors import MotionError
from models.motion.armature import Y_UP, Armature, Keys
from models.motion.euler import ContinuousEuler
from models.motion.motion import Motion, rotations_of_angles
from models.motion.output import NUMBER, MotionWriter, checked_rate, rows
from models.motion.text import numbers, read_lines
from models.plausible import doubt_degrees
from models.reader_report import ReaderReport

INCH = 0.0254
"""Inch (m). Lengths in a file, divided by its `length` unit, are read as inches. This is usual for
CMU's files, although no publication confirms it."""

CMU_RATE = 120.0
"""Rate (Hz) of CMU's files."""

RATE_REMARK = "#!keys a second:"
"""Prefix of the rate in the comment that this program writes into its files."""

RATE_KEY = ":SAMPLES-PER-SECOND"
"""Key of the rate in files of some exporters."""

_TURNS = {"rx": "x", "ry": "y", "rz": "z"}
_SHIFTS = {"tx": 0, "ty": 1, "tz": 2}


@dataclass(frozen=True)
class _Bone:
    name: str
    end: Array
    frame: Array
    freedoms: tuple[str, ...]


@dataclass(frozen=True)
class AcclaimSkeleton:
    """A skeleton at rest, parents before children. The first bone is the root, which has no length.

    Attributes:
        bones: Name, end (3,) m in the rest frame, own frame (3, 3), degrees of freedom in order.
        parents: Index of each bone's parent, -1 for the root.
        origin: (3,) m, position of the root at rest.
        degrees: True if the file's angles are degrees, False for radians.
        unit: Unit of length of the file (m).
        report: Parts of the file that the reader left out or assumed.
    """

    bones: tuple[_Bone, ...]
    parents: tuple[int, ...]
    origin: Array
    degrees: bool
    unit: float
    report: ReaderReport = field(default_factory=ReaderReport)


def read_asf(path: Path, unit: float | None = None) -> AcclaimSkeleton:
    """Reads a skeleton.

    Args:
        path: The file.
        unit: Unit of length of the file (m); None uses the unit in the file, taken as inches.

    Raises:
        MotionError: The file is not an ASF file, is cut short, or a bone is incomplete.
    """
    report = ReaderReport()
    sections = _sections(path, report)
    for name in ("units", "root", "bonedata", "hierarchy"):
        if name not in sections:
            raise MotionError(
                "this is not a complete ASF file",
                where=str(path),
                got="the sections " + ", ".join(f":{found}" for found in sections),
                expected=f"a section :{name}",
            )
    units = {words[0]: words[1:] for _, words in sections["units"]}
    length = numbers(units.get("length", ["1"]), 1, f"{path}, :units length")[0]
    if length <= 0:
        raise MotionError(
            "the unit of length is out of range",
            where=f"{path}, :units length",
            got=length,
            expected="a number above 0",
        )
    degrees = (units.get("angle") or ["deg"])[0].lower().startswith("deg")
    unit = INCH / length if unit is None else unit
    root, origin = _root(path, sections["root"], degrees, unit)
    bones = {root.name: root}
    for bone in _bones(path, sections["bonedata"], degrees, unit):
        if bone.name in bones:
            raise MotionError(
                "two bones share a name",
                where=str(path),
                got=bone.name,
                expected="a different name for each bone",
            )
        bones[bone.name] = bone
    order = _ordered(path, sections["hierarchy"], bones)
    place = {name: i for i, (name, _) in enumerate(order)}
    return AcclaimSkeleton(
        tuple(bones[name] for name, _ in order),
        tuple(place[above] if above else -1 for _, above in order),
        origin,
        degrees,
        unit,
        report,
    )


def read_amc(path: Path, skeleton: AcclaimSkeleton, rate: float | None = None) -> Motion:
    """Reads a motion of a skeleton.

    Args:
        path: The file.
        skeleton: From `read_asf`.
        rate: Rate (Hz); None uses the rate in the file, or CMU's 120 if it contains none.

    Raises:
        MotionError: The file is not an AMC file, a frame is incomplete or out of order, or a bone
            is unknown.
    """
    report = ReaderReport()
    report.add(skeleton.report)
    lines = read_lines(path, "an AMC file", report)
    if rate is None:
        rate = _stated_rate(lines, str(path))
    if not 0 < rate < np.inf:
        raise MotionError(
            "not a frame rate", where=str(path), got=rate, expected="a positive number of Hz"
        )
    degrees = skeleton.degrees
    wanted = {bone.name: len(bone.freedoms) for bone in skeleton.bones if bone.freedoms}
    frames: list[dict[str, list[float]]] = []
    first = 1
    for n, line in enumerate(lines, start=1):
        words = line.split()
        where = f"{path}, line {n}"
        if not words or words[0].startswith("#"):
            continue
        if words[0].startswith(":"):
            key = words[0].upper()
            if key in (":DEGREES", ":RADIANS"):
                degrees = key == ":DEGREES"
            elif key not in (":FULLY-SPECIFIED", RATE_KEY):
                report.leave_out(f"line {words[0][:40]}, an unknown key")
        elif len(words) == 1 and words[0].isdecimal():
            _check_whole(frames, wanted, where)
            if not frames:
                # The first frame of a clip cut out of a longer take may have any number.
                first = int(words[0])
            elif int(words[0]) != first + len(frames):
                raise MotionError(
                    "frames are out of order",
                    where=where,
                    got=words[0],
                    expected=str(first + len(frames)),
                )
            frames.append({})
        elif words[0] not in wanted or not frames:
            raise MotionError(
                "this line is neither a frame's number nor a bone of the skeleton",
                where=where,
                got=line.strip()[:40],
                expected="one of " + ", ".join(wanted)[:60],
                remedy="Use the .asf file that belongs to this motion",
            )
        elif words[0] in frames[-1]:
            raise MotionError(
                "a bone occurs twice in a frame",
                where=where,
                got=words[0],
                expected="each bone once, or the number of the next frame",
            )
        else:
            frames[-1][words[0]] = numbers(words[1:], wanted[words[0]], where)
    if not frames:
        raise MotionError("the file contains no frame", where=str(path), expected="an AMC file")
    _check_whole(frames, wanted, str(path))
    columns = {name: np.array([frame[name] for frame in frames]) for name in wanted}
    return _motion(skeleton, columns, len(frames), degrees, 1.0 / rate, report)


def _stated_rate(lines: list[str], where: str) -> float:
    """Rate (Hz) stated in the lines before the first frame; CMU's rate if there is none."""
    for n, line in enumerate(lines, start=1):
        words = line.split()
        if line.startswith(RATE_REMARK):
            return numbers(line.removeprefix(RATE_REMARK).split(), 1, f"{where}, line {n}")[0]
        if words and words[0].upper() == RATE_KEY:
            return numbers(words[1:], 1, f"{where}, line {n}")[0]
        if words and words[0].isdecimal():
            break
    return CMU_RATE


def _motion(
    skeleton: AcclaimSkeleton,
    columns: dict[str, Array],
    frames: int,
    degrees: bool,
    frame_time: float,
    report: ReaderReport,
) -> Motion:
    bones = skeleton.bones
    shifts = np.zeros((frames, len(bones), 3))
    rotations = np.empty((frames, len(bones), 3, 3))
    largest = 0.0
    for j, (bone, parent) in enumerate(zip(bones, skeleton.parents, strict=True)):
        shifts[:, j] = skeleton.origin if parent < 0 else bones[parent].end
        axes, angles = "", []
        for i, freedom in enumerate(bone.freedoms):
            column = columns[bone.name][:, i]
            if freedom in _SHIFTS:
                shifts[:, j, _SHIFTS[freedom]] += column * skeleton.unit
            else:
                axes += _TURNS[freedom]
                angles.append(np.deg2rad(column) if degrees else column)
                largest = max(largest, float(np.abs(column).max()))
        stacked = np.stack(angles, axis=-1) if angles else np.zeros((frames, 0))
        turn = rotations_of_angles(stacked, axes, fixed=True)
        # At rest, all bones have the same frame, so there is no rotation from parent to child.
        rotations[:, j] = bone.frame @ turn @ bone.frame.T
    if degrees:
        doubt_degrees(largest, report)
    ends = np.array([bone.end for bone in bones])
    ends[0] = np.nan
    names = tuple(bone.name for bone in bones)
    return Motion(names, skeleton.parents, shifts, rotations, ends, frame_time, report=report)


def _sections(path: Path, report: ReaderReport) -> dict[str, list[tuple[str, list[str]]]]:
    """Lines of every section by the section's name. A line is its place in the file, for messages,
    and its words."""
    sections: dict[str, list[tuple[str, list[str]]]] = {}
    current: list[tuple[str, list[str]]] = []
    for n, line in enumerate(read_lines(path, "an ASF file", report), start=1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if words[0].startswith(":"):
            current = sections.setdefault(words[0][1:].lower(), [])
        else:
            current.append((f"{path}, line {n}", words))
    return sections


def _root(
    path: Path, lines: list[tuple[str, list[str]]], degrees: bool, unit: float
) -> tuple[_Bone, Array]:
    entries = {words[0].lower(): (where, words[1:]) for where, words in lines}
    for key in ("order", "axis", "position", "orientation"):
        if key not in entries:
            raise MotionError(
                "the section :root is incomplete",
                where=str(path),
                got=", ".join(entries)[:60],
                expected=f"a line {key}",
            )
    angles = numbers(entries["orientation"][1], 3, entries["orientation"][0])
    frame = _frame(angles, entries["axis"][1], degrees, entries["axis"][0])
    origin = unit * np.array(numbers(entries["position"][1], 3, entries["position"][0]))
    freedoms = _freedoms(entries["order"][1], entries["order"][0])
    return _Bone("root", np.zeros(3), frame, freedoms), origin


def _bones(
    path: Path, lines: list[tuple[str, list[str]]], degrees: bool, unit: float
) -> list[_Bone]:
    bones = []
    entries: dict[str, tuple[str, list[str]]] | None = None
    for where, words in lines:
        key = words[0].lower()
        if key == "begin" and entries is None:
            entries = {}
        elif key == "end" and entries is not None:
            bones.append(_bone(entries, degrees, unit, where))
            entries = None
        elif entries is None:
            raise MotionError(
                "this line does not belong to a bone",
                where=where,
                got=" ".join(words)[:40],
                expected="a line begin before it",
            )
        else:
            entries.setdefault(key, (where, words[1:]))
    if entries is not None or not bones:
        raise MotionError(
            "the section :bonedata has no bone, or ends inside a bone",
            where=str(path),
            expected="begin .. end for each bone",
        )
    return bones


def _bone(
    entries: dict[str, tuple[str, list[str]]], degrees: bool, unit: float, where: str
) -> _Bone:
    for key in ("name", "direction", "length", "axis"):
        if key not in entries or not entries[key][1]:
            name = " ".join(entries["name"][1])[:40] if "name" in entries else "a bone"
            raise MotionError(
                "a bone is incomplete",
                where=where,
                got=f"{name} with {', '.join(entries)}"[:80],
                expected=f"also a line {key}",
            )
    direction = np.array(numbers(entries["direction"][1], 3, entries["direction"][0]))
    size = float(np.linalg.norm(direction))
    if size < 1e-6:
        raise MotionError(
            "a bone has no direction",
            where=entries["direction"][0],
            got=" ".join(entries["direction"][1])[:40],
            expected="three numbers that are not all 0",
        )
    length = numbers(entries["length"][1], 1, entries["length"][0])[0]
    place, words = entries["axis"]
    frame = _frame(numbers(words[:3], 3, place), words[3:], degrees, place)
    freedoms = _freedoms(entries["dof"][1], entries["dof"][0]) if "dof" in entries else ()
    return _Bone(entries["name"][1][0], direction / size * length * unit, frame, freedoms)


def _frame(angles: list[float], order: list[str], degrees: bool, where: str) -> Array:
    axes = "".join(order).lower()
    if sorted(axes) != ["x", "y", "z"]:
        raise MotionError("not an order of axes", where=where, got=axes, expected="XYZ")
    turned = np.deg2rad(angles) if degrees else np.array(angles)
    return rotations_of_angles(turned, axes, fixed=True)


def _freedoms(words: list[str], where: str) -> tuple[str, ...]:
    freedoms = tuple(word.lower() for word in words)
    known = {*_TURNS, *_SHIFTS}
    if not set(freedoms) <= known or len(set(freedoms)) != len(freedoms):
        raise MotionError(
            "not degrees of freedom",
            where=where,
            got=" ".join(words),
            expected="tx .. tz, rx .. rz",
        )
    return freedoms


def _ordered(
    path: Path, lines: list[tuple[str, list[str]]], bones: dict[str, _Bone]
) -> list[tuple[str, str]]:
    """Pairs (bone, parent) from the root outwards; the root's parent is empty."""
    order = [("root", "")]
    placed = {"root"}
    for where, words in lines:
        if words[0].lower() in ("begin", "end"):
            continue
        for child in words[1:]:
            if words[0] not in placed or child in placed or child not in bones:
                raise MotionError(
                    "the hierarchy is broken",
                    where=where,
                    got=f"{child} under {words[0]}"[:60],
                    expected="each bone once, under the root or a bone of an earlier line",
                )
            order.append((child, words[0]))
            placed.add(child)
    if missing := sorted(set(bones) - placed):
        raise MotionError(
            "some bones have no parent",
            where=f"{path}, :hierarchy",
            got=", ".join(missing)[:60],
            expected="every bone under the root or another bone",
        )
    return order


def _check_whole(frames: list[dict[str, list[float]]], wanted: dict[str, int], where: str) -> None:
    """Raises if the last frame so far lacks a bone."""
    if frames and (missing := sorted(set(wanted) - set(frames[-1]))):
        raise MotionError(
            "a frame is incomplete",
            where=f"{where}, frame {len(frames)}",
            got="without " + ", ".join(missing)[:60],
            expected="every bone of the skeleton",
        )


ORDER = "ZYX"
CENTIMETRES = 100.0
LENGTH = 2.54
"""Value of `length` in written files: lengths in cm divided by this value are inches."""


class AmcWriter(MotionWriter):
    """One hand as ASF and AMC.

    Args:
        path: Path of either file; the other file has the same name with the other ending.
        armature: The hand.
        rate: Rate (Hz) of the keys.
    """

    def __init__(self, path: Path, armature: Armature, rate: float) -> None:
        checked_rate(rate)
        self._armature, self._zero = armature, armature.zero(ORDER)
        self.euler = ContinuousEuler(ORDER)
        super().__init__(path.with_suffix(".asf"), path.with_suffix(".amc"))
        asf, self._amc = self._outputs
        asf.write(_skeleton(armature, self._zero).encode("ascii"))
        self._amc.write(f"{RATE_REMARK} {rate:.9g}\n:FULLY-SPECIFIED\n:DEGREES\n".encode("ascii"))
        lines = ["%d", " ".join(["root", *[NUMBER] * 6])]
        lines += [" ".join([name, *[NUMBER] * 3]) for name in armature.names[1:]]
        self._line = "\n".join(lines) + "\n"

    def write(self, *hands: Keys) -> None:
        """Appends keys of the one hand."""
        (keys,) = hands
        root, turns = self._armature.relative(keys, self._zero, Y_UP)
        count = len(root)
        # For fixed axes, the order is reversed: the last axis comes first.
        angles = np.rad2deg(self.euler.angles(turns))[..., ::-1].reshape(count, -1)
        numbers = np.arange(self.frames + 1, self.frames + count + 1)[:, None]
        values = np.concatenate([numbers, CENTIMETRES * root, angles], axis=1)
        self._amc.write(rows(values, self._line))
        self.frames += count


def _skeleton(armature: Armature, zero: Array) -> str:
    bones: list[tuple[str, Array, bool]] = []
    hierarchy: list[str] = []
    for j, name in enumerate(armature.names):
        below = [armature.names[child] for child in armature.children[j]]
        if not j:
            for child in armature.children[0]:
                base = f"{armature.names[child].partition('_')[0]}_base"
                bones.append((base, zero[0] @ armature.offsets[child], False))
                hierarchy.append(f"{base} {armature.names[child]}")
            hierarchy.insert(0, " ".join(["root", *(b[0] for b in bones)]))
            continue
        end = armature.offsets[armature.children[j][0]] if below else armature.ends[j]
        bones.append((name, zero[j] @ end, True))
        if below:
            hierarchy.append(" ".join([name, *below]))
    lines = [
        ":version 1.10",
        ":name hand",
        ":units",
        "  mass 1.0",
        f"  length {LENGTH}",
        "  angle deg",
        ":documentation",
        f"  A {armature.skeleton.side} hand of the Hand Sandbox, y up, cm",
        ":root",
        "  order TX TY TZ RX RY RZ",
        "  axis XYZ",
        "  position 0 0 0",
        "  orientation 0 0 0",
        ":bonedata",
    ]
    for number, (name, along, moves) in enumerate(bones, start=1):
        length = float(np.linalg.norm(along))
        x, y, z = (np.round(along / length, 12) + 0.0).tolist()
        lines += [
            "  begin",
            f"    id {number}",
            f"    name {name}",
            f"    direction {x:.12f} {y:.12f} {z:.12f}",
            f"    length {CENTIMETRES * length:.9f}",
            "    axis 0 0 0 XYZ",
        ]
        if moves:
            lines += ["    dof rx ry rz", "    limits (-180.0 180.0)"]
            lines += ["           (-180.0 180.0)"] * 2
        lines.append("  end")
    lines += [":hierarchy", "  begin", *(f"    {line}" for line in hierarchy), "  end"]
    return "\n".join(lines) + "\n"
