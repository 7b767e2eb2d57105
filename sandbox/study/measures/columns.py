"""The 60 Hz table of a trial as columns of text, which are written to files and used by measures.

Measures are computed from the same rounded numbers as in the file, so that everyone who has the
file can compute the same measures.
"""

from __future__ import annotations

import csv
import gzip
from collections.abc import Mapping
from difflib import get_close_matches
from io import StringIO
from typing import Any

import numpy as np

from models.arithmetic.arrays import Array

SECOND = "hand2_"
"""Prefix of the columns of a second hand; the rest of the name is that of the first hand."""


class Columns:
    """Columns by name; each cell is a text, empty for missing values.

    Args:
        texts: Cells by column; all columns have the same length.
    """

    def __init__(self, texts: Mapping[str, list[str]]) -> None:
        self.texts = dict(texts)

    @classmethod
    def of(cls, table: Mapping[str, Any]) -> Columns:
        """Converts arrays and lists of values, rounded as in the files."""
        return cls({name: _texts(values) for name, values in table.items()})

    @classmethod
    def read(cls, data: bytes) -> Columns:
        """Reads a compressed CSV file."""
        head, *rows = csv.reader(StringIO(gzip.decompress(data).decode(), newline=""))
        return cls({name: [row[i] for row in rows] for i, name in enumerate(head)})

    def csv(self) -> bytes:
        """Returns a compressed CSV file, which R and pandas can read directly."""
        out = StringIO(newline="")
        # Names of objects are in names of columns, and may have commas.
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(self.texts)
        writer.writerows(zip(*self.texts.values(), strict=True))
        return gzip.compress(out.getvalue().encode(), compresslevel=5, mtime=0)

    def __contains__(self, name: str) -> bool:
        return name in self.texts

    def __len__(self) -> int:
        return len(next(iter(self.texts.values()), []))

    def words(self, name: str) -> list[str]:
        """Cells of a column.

        Raises:
            KeyError: There is no such column; the error names one that is nearly called so.
        """
        if name not in self.texts:
            near = get_close_matches(name, self.texts, 1)
            raise KeyError(
                f"there is no column {name}" + (f"; did you mean {near[0]}?" if near else ""),
            )
        return self.texts[name]

    def numbers(self, *names: str) -> Array:
        """Numbers in some columns, (rows, columns); NaN in empty cells."""
        cells = np.array([self.words(name) for name in names]).reshape(len(names), -1)
        return np.where(cells == "", "nan", cells).astype(float).T

    def whole(self, name: str) -> list[int | None]:
        """Integers in a column; None in empty cells."""
        return [int(text) if text else None for text in self.words(name)]

    @property
    def hands(self) -> tuple[str, ...]:
        """Prefix of the columns of each hand."""
        return ("", SECOND) if f"{SECOND}phase" in self else ("",)

    def objects(self) -> list[str]:
        """Names of the objects in the table."""
        return [name.removesuffix("_qw") for name in self.texts if name.endswith("_qw")]

    def until(self, moment: float) -> Columns:
        """The rows up to a time, s."""
        last = int(np.sum(self.numbers("time_s")[:, 0] <= moment + 1e-6))
        return Columns({name: values[:last] for name, values in self.texts.items()})


def _texts(values: Any) -> list[str]:
    """Cells of a column, rounded to 0.01 mm and 0.00001 rad."""
    if isinstance(values, np.ndarray):
        return list(np.char.mod("%.5f", values).tolist())
    return ["" if v is None else f"{v:.5f}" if isinstance(v, float) else str(v) for v in values]
