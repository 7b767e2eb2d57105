"""Declaration of the columns of the 60 Hz tables: unit, meaning, and type in Parquet files."""

from __future__ import annotations

import re
from dataclasses import dataclass

from sandbox.study.tables.column import Column

OBJECT, ANY = "OBJECT", "*"
"""Placeholders in names of columns: the name of an object, and the rest of a name."""
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
    FrameColumn("phase", "", "phase of the hand, such as hovering or down", WORDS),
    FrameColumn("solid", "", "fingers that collide with objects, as letters t i m r l", WORDS),
    FrameColumn(
        "q_*",
        "m, rad",
        "commanded pose in the world: root position, root rotation "
        "vector, then a rotation vector for each of 14 joints",
        POSE_NUMBER,
    ),
    FrameColumn(
        "touch_*", "", "id of the contact with this finger label; empty if there is none", WHOLE
    ),
    FrameColumn(
        "true_*",
        "",
        "id of the contact that this finger really makes; empty if neither simulated user nor "
        "device tells",
        WHOLE,
    ),
    FrameColumn(
        "hand2_phase", "", "phase of the second hand; only in trials with two hands", WORDS
    ),
    FrameColumn("hand2_solid", "", "same as solid, for the second hand", WORDS),
    FrameColumn("hand2_q_*", "m, rad", "same as q_*, for the second hand", POSE_NUMBER),
    FrameColumn("hand2_touch_*", "", "same as touch_*, for the second hand", WHOLE),
    FrameColumn("hand2_true_*", "", "same as true_*, for the second hand", WHOLE),
    FrameColumn(
        "OBJECT_*",
        "m, 1",
        "position of the object in the world, and its rotation as a quaternion w x y z",
        POSE_NUMBER,
    ),
    FrameColumn(
        "OBJECT_hinge_rad",
        "rad",
        "position of the hinge of a mechanism's part; turns are counted on beyond a whole one",
        NUMBER,
    ),
    FrameColumn("OBJECT_slide_m", "m", "position of the slide of a mechanism's part", NUMBER),
    FrameColumn(
        "OBJECT_digits",
        "",
        "digits that push the object: letters t i m r l, and p for the palm; capital letters for a "
        "second hand; unknown if grip_N is empty",
        WORDS,
    ),
    FrameColumn(
        "OBJECT_grip_N", "N", "sum of the normal forces of all hands on the object", NUMBER
    ),
    FrameColumn(
        "OBJECT_by", "", "other things that push the object: the table, names of objects", WORDS
    ),
    FrameColumn(
        "OBJECT_on",
        "",
        "those of OBJECT_by that bear the object: each pushes up 60 percent of its weight or more",
        WORDS,
    ),
    FrameColumn("OBJECT_goal_*", "m", "position of the goal of the object's centre", POSE_NUMBER),
    FrameColumn(
        "OBJECT_off_rad",
        "rad",
        "angle about the vertical from the goal to the object; for a symmetric object, the "
        "smallest of the equivalent angles",
        NUMBER,
    ),
)
TOUCHES = (
    Column("time_s", "s", "simulated time since the trial's start"),
    Column("contact", "", "id of the contact, from touch-down to touch-up"),
    Column("x", "m", "position of the touch in the world, to the right"),
    Column("y", "m", "position of the touch in the world, away from the person"),
    Column("z", "m", "position of the touch in the world, upwards"),
    Column(
        "finger",
        "",
        "finger label: thumb, index, middle, ring or little; empty while there is none",
    ),
    Column("state", "", "active; lost (kept for a moment after it ended); palm; or ignored"),
    Column("hand", "", "1, or 2 for the second hand; only in trials with two hands"),
)


def frame_column(name: str) -> FrameColumn:
    """Returns the declaration of a column of `frames_*`.

    Raises:
        KeyError: No column of this name is declared.
    """
    matches = [c for c in FRAMES if re.fullmatch(_pattern(c.name), name)]
    if not matches:
        raise KeyError(name)
    # `box_goal_x` matches both OBJECT_* and OBJECT_goal_*: the name with more literal letters wins.
    return max(matches, key=lambda c: len(c.name.replace(OBJECT, "").replace(ANY, "")))


def _pattern(name: str) -> str:
    return re.escape(name).replace(OBJECT, ".+").replace(re.escape(ANY), ".+")
