"""Flaws of exclusion rules: those that leave out everything, nothing, or what is measured."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import Design, Exclusion
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.toml_lines import Path
from sandbox.study.measures.measures import BUILT_IN
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

TROUBLE = ("away_s", "away", "lost_s", "latency_p50_ms", "latency_p95_ms", "latency_p99_ms")
"""Measures of what went wrong, which are small in good trials."""
TIMES = ("time_s", "completion_s")
"""Outcomes that may have a bound below, for touches by accident."""
QUICK = 0.5
"""Share of the expected duration, below which many good trials are."""

WITHIN = ("time_s", "completion_s", "first_contact_s", "first_push_s")
"""Times within a trial, which its time limit ends."""
SIGNED = ("palm_sparc", "object_sparc", "move_error_m")
"""Measures that may be below 0."""
LONGEST = {"s": 900.0, "ms": 60_000.0, "m": 10.0, "m/s": 20.0, "deg": 180.0, "bit/s": 100.0}
"""Largest number that people can reach, by unit."""
PLACED, TABLE = ("placement_error_m", "move_amplitude_m", "move_error_m"), 1.0
"""Distances on the surface, and its size in metres."""
LEAST_DELAY = 1.0
"""Milliseconds; a bound above that is smaller than that was meant in seconds."""


def joint_flaws(design: Design) -> Iterator[Flaw]:
    """Rules that exclude everything together, though none of them does alone."""
    for i, one in enumerate(design.exclusions):
        for other in design.exclusions[:i]:
            low, high = (one, other) if one.below is not None else (other, one)
            alike = (one.measure, one.of) == (other.measure, other.of)
            if not alike or low.below is None or high.above is None or high.above >= low.below:
                continue
            if low.above is None and high.below is None:
                yield Flaw(
                    ("exclusions", i),
                    f"{other.name} and {one.name} exclude everything together: every number is "
                    f"below {low.below:g} or above {high.above:g}",
                    "Change one of the bounds",
                    error=True,
                )


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
            f"{rule.name} excludes nothing: {rule.measure} is from {low:g} to {high:g}"
            + _unit(rule.measure),
            "Change the bound or its unit, or remove the rule; trials end at time_limit_s, and the "
            "report counts them",
        )
    elif rule.measure in TROUBLE and below is not None and below > 0:
        yield Flaw(
            path,
            f"{rule.name} leaves out good trials: {rule.measure} is small in them, and "
            f"trials below {below:g} are left out",
            f"Write above = {below:g}",
        )
    elif above is not None and above < LEAST_DELAY and _unit(rule.measure) == " ms":
        yield Flaw(
            path,
            f"{rule.name} excludes nearly everything: {rule.measure} is in milliseconds, and every "
            f"trial is above {above:g}",
            f"Write above = {1000 * above:g}, if {above:g} s is meant",
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
    if measure == "waited_s" and design.page.starts == "shown":
        return 0.0, 0.0
    if measure in WITHIN:
        return 0.0, design.time_limit
    if known is None or known not in BUILT_IN:
        return float("-inf"), float("inf")
    most = TABLE if measure in PLACED else LONGEST.get(known.unit, float("inf"))
    return -most if measure in SIGNED else 0.0, most


def _unit(measure: str) -> str:
    """Unit of a measure after a number; empty if it has none."""
    known = find_measure(measure)
    return f" {known.unit}" if known is not None and known.unit in LONGEST else ""
