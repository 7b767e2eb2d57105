"""Poses as a CSV table: `time`, then 48 columns, one line per pose.

Columns are named `root_x`, `root_y`, `root_z` (m), `root_rx`, `root_ry`, `root_rz`, and `JOINT_rx`,
`JOINT_ry`, `JOINT_rz` (rotation vectors, rad), where JOINT is a joint of the skeleton, such as
`index_mcp`. Alternatively, they are named `q0` to `q47` in the order of the pose. Columns may be in
any order. Poses are in the 3-D surface frame: origin at the top left corner, x right, y up the
surface, z out of it. Cells are separated by commas, semicolons or tabs.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from models.arithmetic import Array
from models.errors import MotionError
from models.motion.text import numbers, read_lines
from models.pose import POSE_SIZE
from models.reader_report import ReaderReport
from models.skeleton import ADULT

COLUMNS: tuple[str, ...] = (
    *(f"root_{axis}" for axis in ("x", "y", "z", "rx", "ry", "rz")),
    *(f"{bone.name}_{axis}" for bone in ADULT.bones for axis in ("rx", "ry", "rz")),
)
"""Names of the pose's 48 columns, in its order."""


def read_pose_table(path: Path, report: ReaderReport) -> tuple[Array, Array]:
    """Reads times (T,) s, increasing, and poses (T, 48) of a table.

    Args:
        path: The file.
        report: Receives the number of columns with other names.

    Raises:
        MotionError: A column is missing, a value is not a finite number, or the time runs
            backwards.
    """
    lines = [
        (n, line)
        for n, line in enumerate(read_lines(path, "a table of poses", report), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    # Depending on the language, spreadsheets write other separators, quotes, and decimal commas.
    separator = max(",;\t", key=lines[0][1].count) if lines else ","
    rows = [(n, [cell.strip().strip('"') for cell in line.split(separator)]) for n, line in lines]
    if separator != ",":
        rows = [(n, [cell.replace(",", ".") for cell in cells]) for n, cells in rows]
    head = [cell.lower() for cell in rows[0][1]] if rows else []
    numbered = tuple(f"q{i}" for i in range(POSE_SIZE))
    wanted = ("time", *(numbered if "q0" in head else COLUMNS))
    if missing := [name for name in wanted if head.count(name) != 1]:
        raise MotionError(
            "this is not a complete table of poses",
            where=str(path),
            got="without " + ", ".join(missing)[:80],
            expected="a first line with time and q0 .. q47, or " + ", ".join(COLUMNS[:9]) + ", ..",
        )
    if len(rows) < 2:
        raise MotionError("the table contains no pose", where=str(path))
    report.leave_out("columns with other names", len(head) - len(wanted))
    order = [head.index(name) for name in wanted]
    values = np.array([numbers(cells, len(head), f"{path}, line {n}") for n, cells in rows[1:]])
    values = values[:, order]
    back = np.flatnonzero(np.diff(values[:, 0]) <= 0)
    if len(back):
        n = rows[int(back[0]) + 2][0]
        raise MotionError("the time does not increase", where=f"{path}, line {n}")
    return values[:, 0], values[:, 1:]
