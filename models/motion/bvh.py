"""BVH files: a hierarchy of joints with offsets and channels, then one line of numbers per frame.

BVH has no standard, only common usage. Rotations are degrees and apply in the order of a joint's
channels, about axes that rotate along. A joint's position channels replace its offset from its
parent. Files do not state their unit, which is mostly centimetres.
"""

from __future__ import annotations

import re
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

CENTIMETRE = 0.01
"""Centimetre (m), the most common unit of length."""

_BRACE = re.compile(r"(?<![^\s{}])[{}]|[{}](?=[{}]*(?!\S))")
"""A brace at the beginning or the end of a word. A brace inside a word is part of a name."""

_LONGEST_NAME = 20
"""Largest number of words in a name; a file with more words before a brace is refused."""

_CHANNELS = {f"{axis}{kind}" for axis in "xyz" for kind in ("position", "rotation")}


@dataclass
class _Joint:
    name: str
    parent: int
    offset: list[float] | None = None
    channels: list[str] | None = None
    end: list[float] | None = None
    first: int = 0
    """Column of the joint's first channel."""


@dataclass
class _Hierarchy:
    joints: list[_Joint] = field(default_factory=list)
    channels: int = 0


def read_bvh(path: Path, unit: float = CENTIMETRE) -> Motion:
    """Reads a BVH file.

    Line breaks have no meaning in the hierarchy, so a brace may follow a name on its line. A frame
    may take several lines. Frames beyond the stated number are read, and reported.

    Args:
        path: The file.
        unit: Unit of length of the file (m).

    Raises:
        MotionError: The file is not a BVH file, is cut short, or contains a number that is not
            finite.
    """
    report = ReaderReport()
    lines = read_lines(path, "a BVH file", report)
    hierarchy, at = _read_hierarchy(path, lines)
    count, frame_time, at = _read_head(path, lines, at)
    values = _read_rows(path, lines[at:], at, count, hierarchy.channels, report)
    return _motion(hierarchy.joints, values, frame_time, unit, report)


def _read_rows(
    path: Path, lines: list[str], before: int, count: int, channels: int, report: ReaderReport
) -> Array:
    """Numbers (T, channels) of all frames.

    Args:
        path: The file, for messages.
        lines: Lines after the motion's head.
        before: Number of lines before them.
        count: Number of frames that the file states.
        channels: Numbers in a frame.
        report: Receives a difference from the stated number of frames.
    """
    rows = [(n, line.split()) for n, line in enumerate(lines, start=before + 1) if line.strip()]
    if rows and all(len(words) != channels for _, words in rows):
        # No line is a complete frame, so frames take several lines.
        every = [word for _, words in rows for word in words]
        if len(every) == count * channels:
            return np.array(numbers(every, len(every), str(path))).reshape(count, channels)
    if len(rows) < count:
        raise MotionError(
            "the file has fewer frames than it states",
            where=str(path),
            got=len(rows),
            expected=str(count),
            remedy="The file was probably cut short",
        )
    values = [numbers(words, channels, f"{path}, line {n}") for n, words in rows[:count]]
    for n, words in rows[count:]:
        try:
            values.append(numbers(words, channels, f"{path}, line {n}"))
        except MotionError:
            report.leave_out("lines after the last frame that are not frames")
    if len(values) > count:
        report.assume(f"the file states {count} frames and has {len(values)}; all were read")
    return np.array(values)


def _read_hierarchy(path: Path, lines: list[str]) -> tuple[_Hierarchy, int]:
    """Reads the joints, and the index of the line after MOTION."""
    words = _Words(path, lines)
    out = _Hierarchy()
    open_: list[_Joint | None] = []  # None: an end site
    if words.next().upper() != "HIERARCHY":
        raise MotionError("this is not a BVH file", where=words.where, expected="HIERARCHY")
    while True:
        word = words.next()
        key = word.upper()
        if key in ("ROOT", "JOINT"):
            # A ROOT must be outside all joints, and a JOINT inside one. An end site has no joints.
            if (key == "ROOT") != (not open_) or None in open_:
                raise MotionError("unexpected joint", where=words.where, got=word)
            where = words.where
            name = words.name() or f"joint {len(out.joints)}"
            if any(joint.name == name for joint in out.joints):
                raise MotionError("two joints share a name", where=where, got=name[:40])
            parent = out.joints.index(open_[-1]) if open_ and open_[-1] else -1
            out.joints.append(_Joint(name, parent))
            open_.append(out.joints[-1])
        elif key == "END":
            if not open_ or open_[-1] is None:
                raise MotionError("unexpected end site", where=words.where)
            words.name()
            open_.append(None)
        elif key == "}":
            if not open_:
                raise MotionError("closing brace without an opening one", where=words.where)
            _check(open_.pop(), words.where)
        elif key == "OFFSET" and open_:
            offset = words.numbers(3)
            if open_[-1] is not None:
                open_[-1].offset = offset
            elif open_[-2] is not None:
                open_[-2].end = offset
        elif key == "CHANNELS" and open_ and open_[-1] is not None:
            _take_channels(open_[-1], words, out)
        elif key == "MOTION" and not open_ and out.joints:
            return out, words.lines_read
        else:
            raise MotionError("this word does not belong here", where=words.where, got=word[:40])


class _Words:
    """The words of a hierarchy, one after the other. Braces are separate words."""

    def __init__(self, path: Path, lines: list[str]) -> None:
        self._path, self._lines = path, lines
        self._waiting: list[str] = []
        self.lines_read = 0

    @property
    def where(self) -> str:
        """File and line of the last word."""
        return f"{self._path}, line {self.lines_read}"

    def next(self) -> str:
        """The next word.

        Raises:
            MotionError: The file has ended.
        """
        while not self._waiting:
            if self.lines_read == len(self._lines):
                raise MotionError(
                    "the file ends before MOTION", where=str(self._path), expected="MOTION"
                )
            line = self._lines[self.lines_read]
            self._waiting = _BRACE.sub(r" \g<0> ", line).split()
            self.lines_read += 1
        return self._waiting.pop(0)

    def name(self) -> str:
        """All words before the next opening brace."""
        name: list[str] = []
        while (word := self.next()) != "{":
            if word == "}" or len(name) == _LONGEST_NAME:
                raise MotionError("a joint needs a brace", where=self.where, got=word, expected="{")
            name.append(word)
        return " ".join(name)

    def numbers(self, count: int) -> list[float]:
        """The next `count` words as numbers."""
        return numbers([self.next() for _ in range(count)], count, self.where)


def _take_channels(joint: _Joint, words: _Words, hierarchy: _Hierarchy) -> None:
    count = words.next()
    known = count.isdecimal() and int(count) <= len(_CHANNELS)
    channels = [words.next() for _ in range(int(count))] if known else [count]
    lower = [channel.lower() for channel in channels]
    if not known or not set(lower) <= _CHANNELS or joint.channels is not None:
        raise MotionError(
            "invalid channels",
            where=words.where,
            got=" ".join(channels)[:60],
            expected="their number, then as many of Xposition .. Zrotation",
        )
    joint.channels, joint.first = lower, hierarchy.channels
    hierarchy.channels += len(lower)


def _check(joint: _Joint | None, where: str) -> None:
    if joint is not None and (joint.offset is None or joint.channels is None):
        raise MotionError(
            "a joint lacks its OFFSET or CHANNELS", where=where, got=joint.name, expected="both"
        )


def _read_head(path: Path, lines: list[str], at: int) -> tuple[int, float, int]:
    """Number of frames, seconds per frame, and the index of the first frame's line.

    The first two may be in one line of the file.
    """
    values: list[float] = []
    rest = ""
    for key in ("frames:", "frame time:"):
        while at < len(lines) and not rest.strip():
            rest = " ".join(lines[at].split())
            at += 1
        if not rest.lower().startswith(key):
            raise MotionError(
                "the motion's head is damaged",
                where=f"{path}, line {at}",
                got=rest[:40],
                expected=key,
            )
        number, _, rest = rest[len(key) :].strip().partition(" ")
        values += numbers([number], 1, f"{path}, line {at}")
    count, frame_time = values
    if rest or count < 1 or count != int(count) or frame_time <= 0:
        raise MotionError(
            "invalid number or duration of frames",
            where=str(path),
            got=f"{count:g} of {frame_time:g} s {rest}".strip()[:60],
            expected="at least one, and a positive time",
        )
    return int(count), frame_time, at


def _motion(
    joints: list[_Joint], values: Array, frame_time: float, unit: float, report: ReaderReport
) -> Motion:
    frames = len(values)
    shifts = np.empty((frames, len(joints), 3))
    rotations = np.empty((frames, len(joints), 3, 3))
    ends = np.full((len(joints), 3), np.nan)
    largest = 0.0
    for j, joint in enumerate(joints):
        shifts[:, j] = np.multiply(joint.offset or 0.0, unit)
        if joint.end is not None:
            ends[j] = np.multiply(joint.end, unit)
        turns = ""
        angles = []
        for i, channel in enumerate(joint.channels or ()):
            column = values[:, joint.first + i]
            if channel.endswith("position"):
                shifts[:, j, "xyz".index(channel[0])] = column * unit
            else:
                turns += channel[0]
                angles.append(np.deg2rad(column))
                largest = max(largest, float(np.abs(column).max()))
        stacked = np.stack(angles, axis=-1) if angles else np.zeros((frames, 0))
        rotations[:, j] = rotations_of_angles(stacked, turns, fixed=False)
    doubt_degrees(largest, report)
    return Motion(
        tuple(j.name for j in joints),
        tuple(j.parent for j in joints),
        shifts,
        rotations,
        ends,
        frame_time,
        report=report,
    )


CENTIMETRES = 100.0
"""Centimetres in a metre."""

_COUNT = 10
"""Characters reserved for the number of frames."""


class BvhWriter(MotionWriter):
    """One hand as BVH.

    Args:
        path: Path of the file.
        armature: The hand.
        rate: Rate (Hz) of the keys.
        order: Euler order of every joint.
    """

    def __init__(self, path: Path, armature: Armature, rate: float, order: str = "ZXY") -> None:
        frame_time = 1.0 / checked_rate(rate)
        self._armature, self._zero = armature, armature.zero(order)
        self.euler = ContinuousEuler(order)
        super().__init__(path)
        out = self._outputs[0]
        out.write(_hierarchy(armature, self._zero, order).encode("ascii"))
        out.write(b"MOTION\nFrames: ")
        self._count_at = out.file.tell()
        # With only six decimals, 60 Hz would be wrong in its fifth digit.
        out.write(f"{'':{_COUNT}}\nFrame Time: {frame_time:.8f}\n".encode("ascii"))
        self._line = " ".join([NUMBER] * (3 + 3 * len(armature.names))) + "\n"

    def write(self, *hands: Keys) -> None:
        """Appends keys of the one hand."""
        (keys,) = hands
        root, turns = self._armature.relative(keys, self._zero, Y_UP)
        angles = np.rad2deg(self.euler.angles(turns))
        values = np.concatenate([CENTIMETRES * root, angles.reshape(len(root), -1)], axis=1)
        self._outputs[0].write(rows(values, self._line))
        self.frames += len(root)

    @property
    def greatest_step(self) -> tuple[float, int, str]:
        """Largest change (degrees) of an angle between two keys, the later key, and the joint."""
        key, joint = self.euler.biggest_at
        return float(np.rad2deg(self.euler.biggest_step)), key, self._armature.names[joint]

    def finish(self) -> None:
        """Writes the number of frames into the header."""
        self._outputs[0].put(self._count_at, f"{self.frames:<{_COUNT}d}".encode("ascii"))


def _hierarchy(armature: Armature, zero: Array, order: str) -> str:
    turns = " ".join(f"{axis}rotation" for axis in order)
    lines = ["HIERARCHY"]

    def offset(at: Array, indent: str) -> str:
        x, y, z = (np.round(CENTIMETRES * at, 6) + 0.0).tolist()
        return f"{indent}OFFSET {x:.6f} {y:.6f} {z:.6f}"

    def joint(j: int, depth: int) -> None:
        tab = "\t" * depth
        lines.append(f"{tab}{'JOINT' if depth else 'ROOT'} {armature.names[j]}")
        lines.append(tab + "{")
        parent = armature.parents[j]
        lines.append(
            offset(zero[parent] @ armature.offsets[j] if depth else np.zeros(3), tab + "\t")
        )
        places = "6 Xposition Yposition Zposition" if not depth else "3"
        lines.append(f"{tab}\tCHANNELS {places} {turns}")
        for child in armature.children[j]:
            joint(child, depth + 1)
        if not armature.children[j]:
            lines.extend([f"{tab}\tEnd Site", tab + "\t{"])
            lines.append(offset(zero[j] @ armature.ends[j], tab + "\t\t"))
            lines.append(tab + "\t}")
        lines.append(tab + "}")

    joint(0, 0)
    return "\n".join(lines) + "\n"
