"""Registry of measures: built-in ones, those of installed packages, and registered ones.

A package offers a measure under the measure's name:

    [project.entry-points."hand_sandbox.measures"]
    palm_height_m = "my_lab.measures:PALM_HEIGHT"
"""

from __future__ import annotations

from functools import cache

from models.errors import InputError
from models.outside import failure, offered, package
from sandbox.study.measures.measure import TrialMeasure
from sandbox.study.measures.measures import BUILT_IN
from sandbox.trial.result import KeptIn, kept_fields

GROUP = "hand_sandbox.measures"
"""Group of the entry points; each entry point has the name of its measure."""

_registered: list[TrialMeasure] = []


def measures() -> tuple[TrialMeasure, ...]:
    """Returns all measures, in the order of their columns.

    Raises:
        InputError: A measure of an installed package is invalid.
    """
    return (*BUILT_IN, *outside_measures())


def outside_measures() -> tuple[TrialMeasure, ...]:
    """Returns the measures of installed packages, then registered ones.

    Raises:
        InputError: A measure of an installed package is invalid.
    """
    return (*_offered(), *_registered)


def register(measure: TrialMeasure) -> None:
    """Adds a measure until this program ends.

    Raises:
        InputError: Another measure has this name, or the measure is invalid.
    """
    _check(measure, "register")
    if find_measure(measure.name) is not None:
        raise InputError(
            "another measure already has this name",
            where="register",
            got=measure.name,
            remedy="Choose another name",
        )
    _registered.append(measure)


def unregister(name: str) -> None:
    """Removes a measure that `register` added."""
    _registered[:] = [measure for measure in _registered if measure.name != name]


def find_measure(name: str) -> TrialMeasure | None:
    """Returns the measure of a name; None if it does not exist."""
    return next((measure for measure in measures() if measure.name == name), None)


def is_time(name: str) -> bool:
    """True if an outcome is a duration or a speed: `time_s`, a measure in s, or a throughput."""
    measure = find_measure(name)
    return name == "time_s" or (
        measure is not None and (measure.unit == "s" or name.startswith("throughput"))
    )


def measure_columns() -> tuple[str, ...]:
    """Names of the measures that are not fields of the trial's result."""
    of_result = kept_fields(KeptIn.TABLE)
    return tuple(m.name for m in measures() if m.name not in of_result)


def rule_measures() -> tuple[str, ...]:
    """Names of the measures that exclusion rules may use (numbers of one trial), default first."""
    names = [m.name for m in measures() if not m.words and m.of_trials is None]
    return ("time_s", *(name for name in names if name != "time_s"))


@cache
def _offered() -> tuple[TrialMeasure, ...]:
    """Measures of installed packages, sorted by name."""
    loaded = []
    for name, entries in sorted(offered(GROUP).items()):
        where = f"entry point {name} = {entries[0].value} of {package(entries[0])}"
        if len(entries) > 1 or name in {measure.name for measure in BUILT_IN}:
            raise InputError(
                "several measures have this name",
                where=where,
                got=name,
                remedy="Uninstall all but one of the packages",
            )
        try:
            measure = entries[0].load()
        except Exception as error:
            raise InputError(
                "a measure of an installed package cannot be loaded",
                where=where,
                got=failure(error),
                remedy="Repair or uninstall the package",
            ) from error
        _check(measure, where)
        if measure.name != name:
            raise InputError(
                "the entry point and its measure have different names",
                where=where,
                got=measure.name,
                expected=name,
            )
        loaded.append(measure)
    return tuple(loaded)


def _check(measure: object, where: str) -> None:
    """Raises an error unless this is a valid measure."""
    if not isinstance(measure, TrialMeasure):
        raise InputError(
            "expected a measure",
            where=where,
            got=type(measure).__name__,
            expected="sandbox.study.measures.measure.TrialMeasure",
        )
    ways = [w for w in (measure.of_trial, measure.of_result, measure.of_trials) if w is not None]
    if len(ways) != 1:
        raise InputError(
            "a measure needs exactly one function that computes it",
            where=f"{where}, {measure.name}",
            got=len(ways),
            expected="one of of_trial, of_result, of_trials",
        )
    if not measure.name.isidentifier():
        raise InputError(
            "this name cannot be the name of a column",
            where=where,
            got=measure.name,
            expected="letters, digits and underscores, such as palm_height_m",
        )
