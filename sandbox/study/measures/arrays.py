"""A finished trial as arrays, read from the file of its frames. Measures are functions of it.

Numbers are rounded to 0.01 mm and 0.00001 rad, as in the file, so that everyone who has the file
can compute the same measures.
"""

from __future__ import annotations

import csv
import gzip
from collections.abc import Callable, Mapping, Sequence
from difflib import get_close_matches
from functools import cached_property
from io import StringIO
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from models.arithmetic import Array
from models.frames import FINGERS
from models.skeleton import ADULT

T = TypeVar("T")

SECOND = "hand2_"
"""Prefix of the columns of a second hand, before the name of the first hand's column."""
NO_CONTACT = -1
"""Value in the arrays of labels if no contact has the label."""
DOWN = "down"
"""Phase of a hand that follows the person's touches."""
POSE_COLUMNS = tuple(
    f"q_{name}_{axis}"
    for name in ("position", "rotation", *(b.name for b in ADULT.bones))
    for axis in "xyz"
)
"""Columns of the 48 numbers of a pose, in the order of the pose."""


class Cells:
    """Cells of a table, by column. Each cell is a text, which is empty for a missing value.

    Args:
        texts: Cells by column; all columns have the same length.
    """

    def __init__(self, texts: Mapping[str, Sequence[str]]) -> None:
        self.texts = dict(texts)

    def __contains__(self, name: str) -> bool:
        return name in self.texts

    def __len__(self) -> int:
        return len(next(iter(self.texts.values()), ()))

    def words(self, name: str) -> Sequence[str]:
        """Cells of a column.

        Raises:
            KeyError: There is no such column. The error names the column with the nearest name.
        """
        if name not in self.texts:
            near = get_close_matches(name, self.texts, 1)
            raise KeyError(
                f"there is no column {name}" + (f"; did you mean {near[0]}?" if near else "")
            )
        return self.texts[name]

    def numbers(self, *names: str) -> Array:
        """Numbers in some columns, (rows, columns); NaN in empty cells."""
        columns = [[float(text) if text else np.nan for text in self.words(n)] for n in names]
        return np.array(columns, float).reshape(len(names), -1).T

    def ids(self, *names: str) -> NDArray[np.int64]:
        """Ids in some columns, (rows, columns); `NO_CONTACT` in empty cells."""
        columns = [[int(text) if text else NO_CONTACT for text in self.words(n)] for n in names]
        return np.array(columns, np.int64).reshape(len(names), -1).T


def texts_of(values: Any) -> list[str]:
    """Cells of a column: numbers with five decimals (0.01 mm, 0.00001 rad); empty for None."""
    if isinstance(values, np.ndarray):
        return list(np.char.mod("%.5f", values).tolist())
    return ["" if v is None else f"{v:.5f}" if isinstance(v, float) else str(v) for v in values]


class HandArrays:
    """One hand of a trial."""

    def __init__(self, cells: Cells, prefix: str) -> None:
        self._cells, self._prefix = cells, prefix

    @cached_property
    def down(self) -> NDArray[np.bool_]:
        """(n,) true while the hand is down, and so follows the person's touches."""
        return np.array([phase == DOWN for phase in self._cells.words(f"{self._prefix}phase")])

    @cached_property
    def palm(self) -> Array:
        """(n, 3) position of the commanded palm in the world, m."""
        return self._cells.numbers(*(f"{self._prefix}{name}" for name in POSE_COLUMNS[:3]))

    @cached_property
    def pose(self) -> Array:
        """(n, 48) commanded pose in the world, m and rad."""
        return self._cells.numbers(*(f"{self._prefix}{name}" for name in POSE_COLUMNS))

    @cached_property
    def labels(self) -> NDArray[np.int64]:
        """(n, 5) id of the contact with each finger label; `NO_CONTACT` if there is none."""
        return self._cells.ids(*(f"{self._prefix}touch_{name}" for name in FINGERS))

    @cached_property
    def true(self) -> NDArray[np.int64]:
        """(n, 5) id of the contact that each finger really makes; `NO_CONTACT` if there is none or
        it is unknown."""
        return self._cells.ids(*(f"{self._prefix}true_{name}" for name in FINGERS))


class ObjectArrays:
    """One object of a trial: where it is, what pushes it, and its goal if it has one."""

    def __init__(self, cells: Cells, name: str) -> None:
        self._cells, self._name = cells, name

    def _numbers(self, column: str) -> Array | None:
        name = f"{self._name}_{column}"
        return self._cells.numbers(name)[:, 0] if name in self._cells else None

    def _words(self, column: str) -> Sequence[str]:
        return self._cells.words(f"{self._name}_{column}")

    @cached_property
    def place(self) -> Array:
        """(n, 3) position of the object's centre in the world, m."""
        return self._cells.numbers(*(f"{self._name}_{axis}" for axis in "xyz"))

    @cached_property
    def rotation(self) -> Array:
        """(n, 4) rotation of the object in the world, as a quaternion w, x, y, z."""
        return self._cells.numbers(*(f"{self._name}_q{axis}" for axis in "wxyz"))

    @cached_property
    def goal(self) -> Array | None:
        """(n, 3) position of the goal of the object's centre, m; None without a goal."""
        if f"{self._name}_goal_x" not in self._cells:
            return None
        return self._cells.numbers(*(f"{self._name}_goal_{axis}" for axis in "xyz"))

    @cached_property
    def off(self) -> Array | None:
        """(n,) angle about the vertical from the goal to the object, rad; None without a goal."""
        return self._numbers("off_rad")

    @cached_property
    def hinge(self) -> Array | None:
        """(n,) angle of the object's hinge, rad; None without a hinge."""
        return self._numbers("hinge_rad")

    @cached_property
    def slide(self) -> Array | None:
        """(n,) position of the object's slide, m; None without a slide."""
        return self._numbers("slide_m")

    @cached_property
    def pushes_are_known(self) -> bool:
        """True if the pushes on the object are known at all moments."""
        return all(self._words("grip_N"))

    @property
    def digits(self) -> Sequence[str]:
        """(n,) letters of the digits that push the object; capital letters for a second hand."""
        return self._words("digits")

    @cached_property
    def grip(self) -> Array:
        """(n,) sum of the normal forces of all hands on the object, N."""
        return self._cells.numbers(f"{self._name}_grip_N")[:, 0]

    @property
    def pushed_by(self) -> Sequence[str]:
        """(n,) other bodies that push the object: the table, names of objects, separated by
        spaces."""
        return self._words("by")

    @property
    def borne_by(self) -> Sequence[str]:
        """(n,) the bodies of `pushed_by` that bear the object, separated by spaces."""
        return self._words("on")


class TrialArrays:
    """A finished trial, every 16 ms.

    Args:
        cells: Cells of the file of the trial's frames.

    Attributes:
        t: (n,) simulated time since the trial's start, s.
        hands: The first hand, and the second one in trials with two hands.
        objects: All objects by name.
    """

    def __init__(self, cells: Cells) -> None:
        self._cells = cells
        self._groups: dict[Callable[[TrialArrays], object], object] = {}
        self.t = cells.numbers("time_s")[:, 0] if len(cells) else np.zeros(0)
        prefixes = ("", SECOND) if f"{SECOND}phase" in cells else ("",)
        self.hands = tuple(HandArrays(cells, prefix) for prefix in prefixes)
        names = [name.removesuffix("_qw") for name in cells.texts if name.endswith("_qw")]
        self.objects = {name: ObjectArrays(cells, name) for name in names}

    @classmethod
    def of(cls, table: Mapping[str, Any]) -> TrialArrays:
        """The trial for a table of values, by column. Values are rounded as in the file."""
        return cls(Cells({name: texts_of(values) for name, values in table.items()}))

    @classmethod
    def read(cls, data: bytes) -> TrialArrays:
        """Reads the file of a trial's frames, compressed CSV."""
        head, *rows = csv.reader(StringIO(gzip.decompress(data).decode(), newline=""))
        columns = list(zip(*rows, strict=True)) or [()] * len(head)
        return cls(Cells(dict(zip(head, columns, strict=True))))

    def __len__(self) -> int:
        return len(self.t)

    def until(self, moment: float) -> TrialArrays:
        """The trial up to a time, s."""
        last = int(np.sum(self.t <= moment + 1e-6))
        return TrialArrays(Cells({name: x[:last] for name, x in self._cells.texts.items()}))

    def once(self, function: Callable[[TrialArrays], T]) -> T:
        """Value of a function of this trial; it is computed at the first call and then stored."""
        if function not in self._groups:
            self._groups[function] = function(self)
        return self._groups[function]  # type: ignore[return-value]
