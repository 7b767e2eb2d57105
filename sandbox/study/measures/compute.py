"""Computes measures; a failed measure gives an empty cell and a reason, and the trial is kept."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import isfinite
from typing import Any, TypeVar

import numpy as np

from models.plugins import failure
from sandbox.study.measures.columns import Columns
from sandbox.study.measures.measure import ALL, Row, TrialMeasure, Value
from sandbox.study.measures.played_trial import PlayedTrial
from sandbox.study.measures.registry import measures
from sandbox.trial.result import TrialResult

VERSION = 2
"""Version of the definitions; stored measures of another version are computed again."""

T = TypeVar("T")


@dataclass(frozen=True)
class Measured:
    """Computed measures of one or several trials.

    Attributes:
        values: `Value` by name; None for an empty cell.
        reasons: Reason why a cell is empty, by name.
        failed: Names of empty measures that failed; the other empty ones do not apply.
    """

    values: dict[str, Any] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)
    failed: tuple[str, ...] = ()

    @property
    def notices(self) -> list[str]:
        """A line for every failed measure."""
        return [f"measure {name} is empty: {self.reasons[name]}" for name in self.failed]


def measure_trial(table: Columns, result: TrialResult, truth: str = "") -> Measured:
    """Computes the measures of a trial that need its 60 Hz table.

    Args:
        table: The 60 Hz table.
        result: The trial's result.
        truth: Source of the `true_*` columns.
    """
    trial = PlayedTrial(table, result, truth)
    return _compute([(m, m.of_trial, trial) for m in measures() if m.of_trial is not None])


def measure_result(result: TrialResult) -> Measured:
    """Computes the measures of a trial that need its result only."""
    return _compute([(m, m.of_result, result) for m in measures() if m.of_result is not None])


def measure_trials(rows: Sequence[Row]) -> Measured:
    """Computes the measures of several trials together.

    Args:
        rows: Rows of `trial_results.csv`; see `TrialMeasure.of_trials`.
    """
    return _compute([(m, m.of_trials, rows) for m in measures() if m.of_trials is not None])


def _compute(calls: Sequence[tuple[TrialMeasure, Callable[[T], Value], T]]) -> Measured:
    values: dict[str, Value] = {}
    reasons: dict[str, str] = {}
    failed = []
    for measure, compute, argument in calls:
        name = measure.name
        values[name] = None
        try:
            value = _plain(compute(argument))
        except Exception as error:
            # A measure from another package may raise anything; the reason is stored and shown.
            reasons[name] = failure(error)
            failed.append(name)
            continue
        if value is None:
            reasons[name] = "it does not apply here" + (
                f"; it applies to: {measure.tasks}" if measure.tasks != ALL else ""
            )
        elif (wrong := _wrong(value)) is not None:
            reasons[name] = wrong
            failed.append(name)
        else:
            values[name] = value
    return Measured(values, reasons, tuple(failed))


def _plain(value: Any) -> Any:
    """Converts a NumPy number to a Python number."""
    return value.item() if isinstance(value, np.generic) else value


def _wrong(value: Any) -> str | None:
    """Reason why a value cannot be stored in a table; None if it can."""
    if not isinstance(value, bool | int | float | str):
        return f"it returned a {type(value).__name__}, not a number, yes or no, or a word"
    if isinstance(value, float) and not isfinite(value):
        return f"it returned {value}"
    return None
