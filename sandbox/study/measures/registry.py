"""Registry of measures: built-in ones, those of installed packages, and registered ones.

A package offers a measure under the measure's name:

    [project.entry-points."hand_sandbox.measures"]
    palm_height_m = "my_lab.measures:PALM_HEIGHT"
"""

from __future__ import annotations

from functools import cache

from models.errors import InputError
from models.plugins import PluginKind
from sandbox.study.measures.measure import TrialMeasure
from sandbox.study.measures.measures import BUILT_IN
from sandbox.trial.result import KeptIn, kept_fields

MEASURE_PLUGINS: PluginKind[TrialMeasure] = PluginKind(
    "measure", "hand_sandbox.measures", InputError
)

_registered: list[TrialMeasure] = []


def measures() -> tuple[TrialMeasure, ...]:
    """Returns all measures, in the order of their columns.

    Raises:
        InputError: A measure of an installed package is invalid.
    """
    return (*BUILT_IN, *external_measures())


def external_measures() -> tuple[TrialMeasure, ...]:
    """Returns the measures of installed packages, then registered ones.

    Raises:
        InputError: A measure of an installed package is invalid.
    """
    return (*_of_packages(), *_registered)


def register(measure: TrialMeasure | str) -> None:
    """Adds a measure until this program ends.

    Args:
        measure: The measure, or its place: `FILE.py:NAME` or `MODULE:NAME`.

    Raises:
        InputError: Another measure has this name, or the measure is invalid or not there.
    """
    where = "register"
    if isinstance(measure, str):
        plugin = MEASURE_PLUGINS.find(measure)
        if plugin is None:
            raise InputError(
                "no such measure", where=where, got=measure, expected="FILE.py:NAME or MODULE:NAME"
            )
        measure, where = plugin.value, plugin.where
    measure = _checked(measure, where)
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
def _of_packages() -> tuple[TrialMeasure, ...]:
    """Measures of installed packages, sorted by name."""
    loaded = []
    for name in sorted(MEASURE_PLUGINS.offered()):
        plugin = MEASURE_PLUGINS.from_package(name)
        assert plugin is not None
        measure = _checked(plugin.value, plugin.where)
        if measure.name != name:
            raise InputError(
                "the entry point and its measure have different names",
                where=plugin.where,
                got=measure.name,
                expected=name,
            )
        if name in {built_in.name for built_in in BUILT_IN}:
            raise InputError(
                "a built-in measure has this name",
                where=plugin.where,
                got=name,
                remedy="Uninstall the package, or name its measure otherwise",
            )
        loaded.append(measure)
    return tuple(loaded)


def _checked(measure: object, where: str) -> TrialMeasure:
    """The measure that was loaded.

    Raises:
        InputError: It is no measure, or not a valid one.
    """
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
    return measure
