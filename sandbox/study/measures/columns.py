"""The 60 Hz table of a trial as columns of text: what is written, and what measures are made of.

Measures are made of the very numbers that the file holds, rounded as they are there; whoever has
the file gets the same measures.
"""

from __future__ import annotations

import gzip
from collections.abc import Mapping
from typing import Any

import numpy as np

from models.arithmetic.arrays import Array

SECOND = "hand2_"
"""Begins the names of columns of a second hand, which are as those of the first."""


class Columns:
    """Columns by name, every cell a text; empty where there is nothing.

    Args:
        texts: Cells by column, all columns of one length.
    """

    def __init__(self, texts: Mapping[str, list[str]]) -> None:
        self.texts = dict(texts)

    @classmethod
    def of(cls, table: Mapping[str, Any]) -> Columns:
        """From arrays and lists of values, rounded for the table."""
        return cls({name: _texts(values) for name, values in table.items()})

    @classmethod
    def read(cls, data: bytes) -> Columns:
        """From a compressed CSV file."""
        head, *rows = gzip.decompress(data).decode().splitlines()
        cells = [row.split(",") for row in rows]
        return cls({name: [row[i] for row in cells] for i, name in enumerate(head.split(","))})

    def csv(self) -> bytes:
        """As a compressed CSV file, which R and pandas read as it is."""
        rows = zip(*self.texts.values(), strict=True)
        lines = [",".join(self.texts), *map(",".join, rows), ""]
        return gzip.compress("\n".join(lines).encode(), compresslevel=5, mtime=0)

    def __contains__(self, name: str) -> bool:
        return name in self.texts

    def __len__(self) -> int:
        return len(next(iter(self.texts.values()), []))

    def words(self, name: str) -> list[str]:
        """Cells of a column."""
        return self.texts[name]

    def numbers(self, *names: str) -> Array:
        """(n, columns) numbers; NaN where there is nothing."""
        found = np.array([self.texts[name] for name in names]).reshape(len(names), -1)
        return np.where(found == "", "nan", found).astype(float).T

    def whole(self, name: str) -> list[int | None]:
        """Cells of a column of whole numbers."""
        return [int(text) if text else None for text in self.texts[name]]

    @property
    def hands(self) -> tuple[str, ...]:
        """What the names of each hand's columns begin with."""
        return ("", SECOND) if f"{SECOND}phase" in self else ("",)

    def things(self) -> list[str]:
        """Names of the things in the table."""
        return [name.removesuffix("_qw") for name in self.texts if name.endswith("_qw")]

    def until(self, moment: float) -> Columns:
        """The rows up to a moment, s."""
        last = int(np.sum(self.numbers("time_s")[:, 0] <= moment + 1e-6))
        return Columns({name: values[:last] for name, values in self.texts.items()})


def _texts(values: Any) -> list[str]:
    """Cells of a column: 0.01 mm and 0.00001 rad are enough for tables."""
    if isinstance(values, np.ndarray):
        return list(np.char.mod("%.5f", values).tolist())
    return ["" if v is None else f"{v:.5f}" if isinstance(v, float) else str(v) for v in values]
