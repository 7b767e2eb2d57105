"""Measures of a trial and their scales: one list for tables, models and plots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from models.errors import StudyError
from sandbox.study.measures import registry
from sandbox.study.report.models.data import StudyData, to_numbers

if TYPE_CHECKING:
    from pandas import DataFrame

SHARE, LOG, PLAIN = "share", "log", "plain"
"""Scales: shares of 0 and 1; logarithms, so that effects are factors; plain values."""
RATIO_UNITS = ("s", "m", "mm", "m/s", "bit/s", "ms")
"""Units of what cannot be negative and is thought of in per cent; their logarithms are modelled."""
MAIN = ("time_s", "success")
"""Measures with a part of the report of their own."""


@dataclass(frozen=True)
class Quantity:
    """A measure.

    Attributes:
        name: Column of `trial_results.csv`.
        title: Title for people.
        unit: Unit of its values; empty for counts and indices.
        means: Its definition in a line.
        better: high, low, or empty.
        scale: `SHARE`, `LOG` or `PLAIN`.
    """

    name: str
    title: str
    unit: str
    means: str
    better: str
    scale: str

    @property
    def label(self) -> str:
        """Title with unit."""
        return f"{self.title} ({self.unit})" if self.unit and self.scale != SHARE else self.title

    def forward(self, values: np.ndarray) -> np.ndarray:
        """Values on the scale on which they are put together."""
        return np.log(values) if self.scale == LOG else values

    def back(self, value: float) -> float:
        """A value as people read it."""
        return float(np.exp(value)) if self.scale == LOG else float(value)


def quantity(data: StudyData, name: str) -> Quantity:
    """A measure by the name of its column.

    Raises:
        StudyError: There is none, or it has no numbers.
    """
    known = registry.find_measure(name)
    if name not in data.used.columns or name in ("cell", "position", "condition", "censored"):
        known_here = ", ".join(q.name for q in quantities(data))
        raise StudyError(
            "no such measure in this study",
            where="--measure",
            got=name,
            expected=known_here or "none",
        )
    values = to_numbers(data.used[name])
    values = values[np.isfinite(values)]
    if not len(values):
        raise StudyError("it has no numbers", where="--measure", got=name)
    unit, means = data.codebook.get(name, ("", ""))
    if known is not None:
        unit, means = known.unit, known.means
    scale = PLAIN
    if unit == "0/1" and set(values) <= {0.0, 1.0}:
        scale = SHARE
    elif unit in RATIO_UNITS and (values > 0.0).all():
        scale = LOG
    title = known.title if known else name.replace("_", " ")
    if name == "time_s":
        title = "Completion time"
    return Quantity(name, title, unit, means, known.better if known else "", scale)


def quantities(data: StudyData) -> list[Quantity]:
    """All measures of which a study has numbers that differ."""
    names = [m.name for m in registry.measures() if m.in_report and m.name in data.used.columns]
    measures = []
    for name in names:
        values = to_numbers(data.used[name])
        if values.nunique() > 1 or (name in MAIN and values.notna().any()):
            measures.append(quantity(data, name))
    return measures


def rows_with(data: StudyData, what: Quantity) -> tuple[DataFrame, np.ndarray]:
    """The used trials that have the measure, and its values on the scale of its means.

    A completion time is that of a trial that succeeded.
    """
    values = to_numbers(data.used[what.name])
    keep = np.isfinite(values)
    if what.scale == LOG:
        keep &= values > 0.0
    if what.name == "time_s":
        keep &= ~data.used["censored"]
    return data.used[keep], what.forward(values[keep].to_numpy(float))


def rows_for_model(data: StudyData, what: Quantity) -> tuple[DataFrame, np.ndarray]:
    """The same; one row for each person and condition where all of theirs are equal.

    A measure of several trials together, as effective throughput, stands in all of their rows.
    """
    rows, y = rows_with(data, what)
    if what.scale == SHARE or not len(rows):
        return rows, y
    groups = [rows["ppid"].to_numpy(), rows["cell"].to_numpy()]
    spread = rows.assign(y=y).groupby(groups)["y"].agg(lambda v: v.max() - v.min())
    if (spread > 1e-12).any():
        return rows, y
    first = ~rows[["ppid", "cell"]].duplicated().to_numpy()
    return rows[first], y[first]


def other_quantities(
    data: StudyData, asked: Sequence[str]
) -> tuple[list[Quantity], list[Quantity]]:
    """Measures that were asked for by name, and all the rest, without the main ones.

    Raises:
        StudyError: One that was asked for is none.
    """
    wanted = [quantity(data, name) for name in dict.fromkeys(asked) if name not in MAIN]
    names = {q.name for q in wanted}
    rest = [q for q in quantities(data) if q.name not in names and q.name not in MAIN]
    return wanted, rest
