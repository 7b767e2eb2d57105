"""Flaws of exclusion rules: those that leave out everything, nothing, or what is measured."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import Design, Exclusion
from sandbox.study.design.meaning.flaw import Flaw
from sandbox.study.design.toml_lines import Path
from sandbox.study.measures.registry import find_measure

OUTCOMES = (
    "success",
    "held",
    "instant",
    "final",
    "progress",
    "first_attempt_success",
    "completion_s",
)
"""Measures of the outcome; a rule that looks at one of them selects on it."""

TIMES = ("time_s", "completion_s")
"""Outcomes that may have a bound below, for touches by accident."""
QUICK = 0.5
"""Share of the expected duration, below which many good trials are."""


def exclusion_flaws(design: Design, path: Path, rule: Exclusion) -> Iterator[Flaw]:
    """Flaws of one rule."""
    low, high = _range(design, rule.measure)
    below, above = rule.below, rule.above
    if below is not None and above is not None and above < below:
        yield Flaw(
            path,
            f"{rule.name} excludes everything: every number is below {below:g} or above {above:g}",
            "Exchange the bounds: below is the smaller one",
            error=True,
        )
    elif (below is not None and below > high) or (above is not None and above < low):
        yield Flaw(
            path,
            f"{rule.name} excludes everything: {rule.measure} is from {low:g} to {high:g}",
            "Change the bound",
            error=True,
        )
    elif (below is None or below <= low) and (above is None or above >= high):
        yield Flaw(
            path,
            f"{rule.name} excludes nothing: {rule.measure} is from {low:g} to {high:g}",
            "Remove the rule; trials end at time_limit_s, and the report counts them",
        )
    elif rule.measure in OUTCOMES:
        who = "trials" if rule.of == "trial" else "people"
        yield Flaw(
            path,
            f"{rule.name} selects on the outcome: it leaves out {who} because of {rule.measure}",
            "Remove the rule; the report takes trials without success into account. Choose a "
            "measure that says nothing of how well people did, such as away_s",
        )
    elif rule.measure in design.primary and rule.measure not in TIMES:
        yield Flaw(
            path,
            f"{rule.name} selects on the outcome: {rule.measure} is confirmatory",
            "Remove the rule, or choose a measure that is no outcome, such as away_s",
        )
    elif rule.measure == "time_s" and below is not None and below > QUICK * design.expected:
        yield Flaw(
            path,
            f"{rule.name} leaves out good trials: a trial is expected to take {design.expected:g} "
            f"s, "
            f"and those below {below:g} s are left out",
            "Write a bound that nobody can reach, such as 0.5; the unit is seconds",
        )
    elif rule.measure == "time_s" and above is not None:
        yield Flaw(
            path,
            f"{rule.name} selects on the outcome: it leaves out what takes long",
            "Remove the bound above; time_limit_s ends long trials, and the report counts them",
        )


def _range(design: Design, measure: str) -> tuple[float, float]:
    """Smallest and largest value that a measure can have."""
    known = find_measure(measure)
    if measure == "progress" or (known is not None and known.unit in ("0/1", "0 to 1")):
        return 0.0, 1.0
    if measure in ("time_s", "completion_s"):
        return 0.0, design.time_limit
    return float("-inf"), float("inf")
