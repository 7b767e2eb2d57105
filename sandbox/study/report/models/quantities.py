"""Measures of a trial and their scales: one list for tables, models and plots."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
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
"""Units of measures that are compared by ratios, so that logarithms are modelled, if all values are
above 0."""
MAIN = ("time_s", "success")
"""Measures that have their own sections in the report."""


@dataclass(frozen=True)
class Quantity:
    """A measure with its scale for models and plots.

    Attributes:
        name: Column of `trial_results.csv`.
        title: Title for people.
        unit: Unit of its values; empty for counts and indices.
        means: Definition in one line.
        better: high or low, the better direction; empty if neither is better.
        scale: `SHARE`, `LOG` or `PLAIN`; `LOG` for completion time, whatever its values.
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
        """Converts values to the scale on which they are averaged."""
        return np.log(values) if self.scale == LOG else values

    def back(self, value: float) -> float:
        """Converts a value on that scale back to the unit."""
        return float(np.exp(value)) if self.scale == LOG else float(value)


def quantity(data: StudyData, name: str) -> Quantity:
    """Finds a measure by the name of its column.

    Raises:
        StudyError: The column does not exist, or has no numbers.
    """
    known = registry.find_measure(name)
    if name not in data.trials.columns or name not in data.used.columns:
        known_here = ", ".join(q.name for q in quantities(data))
        numbers = [c for c in data.trials.columns if np.isfinite(to_numbers(data.trials[c])).any()]
        near = get_close_matches(name, numbers, 1)
        raise StudyError(
            "no such measure in this study",
            where="--measure",
            got=name,
            expected=f"{known_here or 'none'}, or another column of trial_results.csv with numbers",
            remedy=f"Did you mean {near[0]}?" if near else None,
        )
    values = to_numbers(data.used[name])
    values = values[np.isfinite(values)]
    if not len(values):
        raise StudyError("the measure has no numbers", where="--measure", got=name)
    unit, means = data.codebook.get(name, ("", ""))
    if known is not None:
        unit, means = known.unit, known.means
    scale = PLAIN
    if unit == "0/1" and set(values) <= {0.0, 1.0}:
        scale = SHARE
    elif name == "time_s" or (unit in RATIO_UNITS and (values > 0.0).all()):
        # A completion time is above 0; a trial that failed at once tells nothing of it.
        scale = LOG
    title = known.title if known else name.replace("_", " ")
    if name == "time_s":
        title = "Completion time"
    return Quantity(name, title, unit, means, known.better if known else "", scale)


def quantities(data: StudyData) -> list[Quantity]:
    """All measures that have different numbers in a study."""
    names = [m.name for m in registry.measures() if m.in_report and m.name in data.used.columns]
    measures = []
    for name in names:
        values = to_numbers(data.used[name])
        if values.nunique() > 1 or (name in MAIN and values.notna().any()):
            measures.append(quantity(data, name))
    return measures


def rows_with(data: StudyData, what: Quantity) -> tuple[DataFrame, np.ndarray]:
    """The used trials that have the measure, and its values on the scale of its means.

    Completion times are those of successful trials only.
    """
    values = to_numbers(data.used[what.name])
    keep = np.isfinite(values)
    if what.scale == LOG:
        keep &= values > 0.0
    if what.name == "time_s":
        keep &= ~data.used["censored"]
    return data.used[keep], what.forward(values[keep].to_numpy(float))


def rows_for_model(data: StudyData, what: Quantity) -> tuple[DataFrame, np.ndarray]:
    """Same as `rows_with`, but a measure over several trials has one row by person and condition.

    Such a measure, as effective throughput, is repeated in the rows of all of these trials.
    """
    rows, y = rows_with(data, what)
    if what.scale == SHARE or not len(rows):
        return rows, y
    groups = [rows["ppid"].to_numpy(), rows["cell"].to_numpy()]
    cells = rows.assign(y=y).groupby(groups)["y"]
    if (cells.max() - cells.min() > 1e-12).any():
        return rows, y
    first = ~rows[["ppid", "cell"]].duplicated().to_numpy()
    return rows[first], y[first]


def other_quantities(
    data: StudyData, asked: Sequence[str]
) -> tuple[list[Quantity], list[Quantity]]:
    """The requested measures, and all others; both without those of `MAIN`.

    Raises:
        StudyError: A requested measure does not exist.
    """
    wanted = [quantity(data, name) for name in dict.fromkeys(asked) if name not in MAIN]
    names = {q.name for q in wanted}
    rest = [q for q in quantities(data) if q.name not in names and q.name not in MAIN]
    return wanted, rest
