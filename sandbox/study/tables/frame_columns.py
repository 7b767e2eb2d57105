"""Columns of the 60 Hz tables, declared once: unit, meaning, and type in Parquet files."""

from __future__ import annotations

import re
from dataclasses import dataclass

from sandbox.study.tables.column import Column

OBJECT, ANY = "OBJECT", "*"
"""Stand for the name of an object, and for the end of a name, in the name of a column."""
WHOLE, NUMBER, POSE_NUMBER, WORDS = "int64", "float64", "float32", "string"
"""Types in Parquet files."""


@dataclass(frozen=True)
class FrameColumn(Column):
    """A column of a 60 Hz table, or all columns of one kind.

    Attributes:
        type: Type in Parquet files.
    """

    type: str


FRAMES = (
    FrameColumn("time_s", "s", "simulated time since the trial's start", NUMBER),
    FrameColumn("step", "", "physics steps since the trial's start", WHOLE),
    FrameColumn("phase", "", "phase of the hand between hovering and being down", WORDS),
    FrameColumn("solid", "", "fingers that can touch objects, as letters t i m r l", WORDS),
    FrameColumn(
        "q_*",
        "m, rad",
        "commanded pose in the world: root position, root rotation "
        "vector, then a rotation vector for each of 14 joints",
        POSE_NUMBER,
    ),
    FrameColumn(
        "touch_*", "", "id of the contact with this label; empty: the finger does not touch", WHOLE
    ),
    FrameColumn(
        "true_*",
        "",
        "id of the contact that truly is this finger, where a simulated user or a device tells it",
        WHOLE,
    ),
    FrameColumn("hand2_phase", "", "phase of the second hand, in trials with two", WORDS),
    FrameColumn("hand2_solid", "", "as solid, of the second hand", WORDS),
    FrameColumn("hand2_q_*", "m, rad", "as q_*, of the second hand", POSE_NUMBER),
    FrameColumn("hand2_touch_*", "", "as touch_*, of the second hand", WHOLE),
    FrameColumn("hand2_true_*", "", "as true_*, of the second hand", WHOLE),
    FrameColumn(
        "OBJECT_*",
        "m, 1",
        "position of an object, and its rotation as a quaternion w x y z",
        POSE_NUMBER,
    ),
    FrameColumn(
        "OBJECT_digits",
        "",
        "digits that push the object, as letters t i m r l, and p "
        "for the palm, capitals for a second hand; unknown where grip_N is empty",
        WORDS,
    ),
    FrameColumn("OBJECT_grip_N", "N", "sum of all hands' normal forces on the object", NUMBER),
    FrameColumn("OBJECT_by", "", "what else pushes the object: table, names of objects", WORDS),
    FrameColumn(
        "OBJECT_on",
        "",
        "which of those bear the object: push up 60 percent of its weight or more",
        WORDS,
    ),
    FrameColumn("OBJECT_goal_*", "m", "position of the goal of the object's centre", POSE_NUMBER),
    FrameColumn(
        "OBJECT_off_rad",
        "rad",
        "angle about the vertical from the goal to the object, "
        "by the nearest turn that looks the same",
        NUMBER,
    ),
)
TOUCHES = (
    Column("time_s", "s", "simulated time since the trial's start"),
    Column("contact", "", "id of the contact, from touch-down to touch-up"),
    Column(
        "x, y, z",
        "m",
        "position on the surface, in the world: x right, y away from the person, z up",
    ),
    Column("finger", "", "thumb, index, middle, ring, little; empty while it has no label"),
    Column("state", "", "active; lost: kept for a moment after it ended; ignored"),
    Column("hand", "", "1, or 2 for the second hand; only in trials with two"),
)


def frame_column(name: str) -> FrameColumn:
    """The declaration of a column of `frames_*`.

    Raises:
        KeyError: None is declared.
    """
    fitting = [c for c in FRAMES if re.fullmatch(_pattern(c.name), name)]
    if not fitting:
        raise KeyError(name)
    # Of `box_goal_x`, both OBJECT_* and OBJECT_goal_* are true; the more literal name is meant.
    return max(fitting, key=lambda c: len(c.name.replace(OBJECT, "").replace(ANY, "")))


def _pattern(name: str) -> str:
    return re.escape(name).replace(OBJECT, ".+").replace(re.escape(ANY), ".+")
