"""BVH files: a hierarchy of joints with offsets and channels, then one line of numbers a frame.

BVH has only usage, and no standard: rotations are degrees and apply in the order in which a joint
lists its channels, about axes that turn along; a joint's position channels replace its offset from
its parent. Files do not state their unit, which is mostly centimetres.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from models.arithmetic.arrays import Array
from models.errors import MotionError
from models.motion.motion import Motion, rotations_of_angles
from models.motion.read.text import numbers, read_lines

CENTIMETRE = 0.01
"""m, the most common unit of length."""

_CHANNELS = {f"{axis}{kind}" for axis in "xyz" for kind in ("position", "rotation")}


@dataclass
class _Joint:
    name: str
    parent: int
    offset: list[float] | None = None
    channels: list[str] | None = None
    end: list[float] | None = None
    first: int = 0
    """Column of its first channel."""


@dataclass
class _Hierarchy:
    joints: list[_Joint] = field(default_factory=list)
    channels: int = 0


def read_bvh(path: Path, unit: float = CENTIMETRE) -> Motion:
    """Reads a BVH file.

    Args:
        path: The file.
        unit: m, the file's unit of length.

    Raises:
        MotionError: It is not a BVH file, is cut short, or contains a number that is not finite.
    """
    lines = read_lines(path, "a BVH file")
    hierarchy, at = _read_hierarchy(path, lines)
    count, frame_time, at = _read_head(path, lines, at)
    rows = [(n, line) for n, line in enumerate(lines[at:], start=at + 1) if line.strip()]
    if len(rows) != count:
        raise MotionError(
            "the number of frames differs from the one that the file states",
            where=str(path),
            got=len(rows),
            expected=str(count),
            remedy="The file was probably cut short",
        )
    values = np.array(
        [numbers(line.split(), hierarchy.channels, f"{path}, line {n}") for n, line in rows]
    )
    return _motion(hierarchy.joints, values, frame_time, unit)


def _read_hierarchy(path: Path, lines: list[str]) -> tuple[_Hierarchy, int]:
    """Reads the joints, and the index of the line after MOTION."""
    out = _Hierarchy()
    open_: list[_Joint | None] = []  # None: an end site
    declared: _Joint | None = None
    waiting = False
    begun = False
    for n, line in enumerate(lines, start=1):
        words = line.split()
        if not words:
            continue
        where, word = f"{path}, line {n}", words[0].upper()
        if not begun:
            if word != "HIERARCHY":
                raise MotionError("this is not a BVH file", where=where, expected="HIERARCHY")
            begun = True
        elif waiting and word != "{":
            raise MotionError("a joint needs a brace", where=where, got=line[:40], expected="{")
        elif word in ("ROOT", "JOINT"):
            # The enclosing joint of a JOINT, none for a ROOT.
            if (word == "ROOT") != (not open_) or None in open_:
                raise MotionError("unexpected joint", where=where, got=line.strip()[:40])
            name = " ".join(words[1:]) or f"joint {len(out.joints)}"
            if any(joint.name == name for joint in out.joints):
                raise MotionError("two joints share a name", where=where, got=name)
            parent = out.joints.index(open_[-1]) if open_ and open_[-1] else -1
            declared, waiting = _Joint(name, parent), True
            out.joints.append(declared)
        elif word == "END":
            if not open_ or open_[-1] is None:
                raise MotionError("unexpected end site", where=where)
            declared, waiting = None, True
        elif word == "{":
            if not waiting:
                raise MotionError("unexpected brace", where=where)
            open_.append(declared)
            waiting = False
        elif word == "}":
            if not open_:
                raise MotionError("closing brace without an opening one", where=where)
            _check(open_.pop(), where)
        elif word == "OFFSET" and open_:
            offset = numbers(words[1:], 3, where)
            if open_[-1] is not None:
                open_[-1].offset = offset
            elif open_[-2] is not None:
                open_[-2].end = offset
        elif word == "CHANNELS" and open_ and open_[-1] is not None:
            _take_channels(open_[-1], words[1:], out, where)
        elif word == "MOTION" and not open_ and out.joints:
            return out, n
        else:
            raise MotionError("this line does not belong here", where=where, got=line.strip()[:40])
    raise MotionError("the file ends before MOTION", where=str(path), expected="MOTION")


def _take_channels(joint: _Joint, words: list[str], hierarchy: _Hierarchy, where: str) -> None:
    channels = [word.lower() for word in words[1:]]
    count = words[0] if words else ""
    if count != str(len(channels)) or not set(channels) <= _CHANNELS or joint.channels is not None:
        raise MotionError(
            "invalid channels",
            where=where,
            got=" ".join(words)[:60],
            expected="their number, then as many of Xposition .. Zrotation",
        )
    joint.channels, joint.first = channels, hierarchy.channels
    hierarchy.channels += len(channels)


def _check(joint: _Joint | None, where: str) -> None:
    if joint is not None and (joint.offset is None or joint.channels is None):
        raise MotionError(
            "a joint lacks its OFFSET or CHANNELS", where=where, got=joint.name, expected="both"
        )


def _read_head(path: Path, lines: list[str], at: int) -> tuple[int, float, int]:
    """Number of frames, seconds per frame, and the index of the first frame's line."""
    values: list[float] = []
    for key in ("frames:", "frame time:"):
        while at < len(lines) and not lines[at].strip():
            at += 1
        line = " ".join(lines[at].split()) if at < len(lines) else ""
        if not line.lower().startswith(key):
            raise MotionError(
                "the motion's head is damaged",
                where=f"{path}, line {at + 1}",
                got=line[:40],
                expected=key,
            )
        values += numbers(line[len(key) :].split(), 1, f"{path}, line {at + 1}")
        at += 1
    count, frame_time = values
    if count < 1 or count != int(count) or frame_time <= 0:
        raise MotionError(
            "invalid number or duration of frames",
            where=str(path),
            got=f"{count:g} of {frame_time:g} s",
            expected="at least one, and a positive time",
        )
    return int(count), frame_time, at


def _motion(joints: list[_Joint], values: Array, frame_time: float, unit: float) -> Motion:
    frames = len(values)
    shifts = np.empty((frames, len(joints), 3))
    rotations = np.empty((frames, len(joints), 3, 3))
    ends = np.full((len(joints), 3), np.nan)
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
        stacked = np.stack(angles, axis=-1) if angles else np.zeros((frames, 0))
        rotations[:, j] = rotations_of_angles(stacked, turns, fixed=False)
    return Motion(
        tuple(j.name for j in joints),
        tuple(j.parent for j in joints),
        shifts,
        rotations,
        ends,
        frame_time,
    )
