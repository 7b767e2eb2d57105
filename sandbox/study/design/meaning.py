"""What a design that is right in form may get wrong: errors and warnings, one line a cause."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from sandbox.study.design.balance import confounded, nearest_cycles
from sandbox.study.design.conditions import combinations, run_settings, values_of
from sandbox.study.design.design import Design, Exclusion
from sandbox.study.design.plan import BreakStep, session_plan
from sandbox.study.design.reading import Mistake
from sandbox.study.design.toml_lines import Path, TomlLines
from sandbox.study.measures.registry import find_measure

OUTCOMES = ("success", "held", "instant", "final", "progress", "completion_s")
"""Measures of the outcome; a rule for trials that looks at one of them selects on it."""
IDENTIFIES = re.compile(
    r"\b(e-?mails?|phone|telephone|address|surname|date of birth|birth ?(date|day)|"
    r"(your|full|first|last|family) name|ihr name|vorname|nachname|geburts(tag|datum)|adresse|"
    r"telefon)\b"
)
"""Words of a question that asks who somebody is."""


@dataclass(frozen=True)
class Finding:
    """A finding of the check.

    Attributes:
        mistake: Line, place, what is wrong, and the remedy.
        error: True if the study cannot give results as it is; False for a warning.
    """

    mistake: Mistake
    error: bool = False

    def __str__(self) -> str:
        return f"{'error' if self.error else 'warning'}, {self.mistake}"


def findings(design: Design) -> list[Finding]:
    """All findings of a design without mistakes of form, by line."""
    lines = TomlLines(design.text)
    found = []
    for path, what, remedy, error in _all(design):
        where = ""
        for part in path:
            where += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if where else part
        found.append(Finding(Mistake(lines.of(path), where, what, remedy), error))
    return sorted(found, key=lambda finding: finding.mistake.line)


_Found = tuple[Path, str, str, bool]


def _all(design: Design) -> Iterator[_Found]:
    yield from _times(design)
    yield from _orders(design)
    yield from _people(design)
    for i, rule in enumerate(design.exclusions):
        yield from _exclusion(design, ("exclusions", i), rule)


def _times(design: Design) -> Iterator[_Found]:
    from tasks.registry import find_task

    holds: dict[str, float] = {}
    for levels in combinations(design):
        task = run_settings(values_of(design, levels), design.seed % 1000).task
        holds[task] = find_task(task).hold_time
    too_long = {task: hold for task, hold in holds.items() if hold >= design.time_limit}
    if too_long:
        names = ", ".join(f"{task} {hold:g} s" for task, hold in too_long.items())
        yield (
            ("trials", "time_limit_s"),
            f"no trial can succeed: the limit is {design.time_limit:g} s, and the goal must be "
            f"held for ({names})",
            f"Write more than {max(too_long.values()):g}",
            True,
        )
    if design.expected > design.time_limit:
        yield (
            ("trials", "expected_s"),
            f"{design.expected:g} s is more than the time limit, {design.time_limit:g} s",
            "Write the expected duration of a trial, below time_limit_s",
            False,
        )
    plans = [session_plan(design, 0, n + 1) for n in range(design.sessions)]
    if design.break_every and not any(isinstance(s, BreakStep) for plan in plans for s in plan):
        yield (
            ("breaks", "every"),
            f"no break ever comes: no session has more than {design.break_every} trials without "
            "practice",
            "Write a smaller number, or remove [breaks]",
            False,
        )


def _orders(design: Design) -> Iterator[_Found]:
    for i, factor in enumerate(design.factors):
        if len(factor.levels) == 1:
            yield (
                ("factors", i, "levels"),
                f"{factor.name} has one level, {factor.levels[0].name}, so nothing is compared",
                "Add a level, or move the setting to [settings]",
                False,
            )
        elif factor.order == "blocked":
            yield (
                ("factors", i, "order"),
                f"everybody has the levels of {factor.name} in the same order, so its effect "
                "cannot be told from practice",
                "Write latin or random, unless you do not compare these levels",
                False,
            )
    missing = confounded(design, design.participants)
    if missing:
        yield (
            ("participants",),
            f"{design.participants} people are no full cycle, so this is confounded: "
            + "; ".join(missing),
            f"Write {nearest_cycles(design, design.participants)}",
            False,
        )


def _people(design: Design) -> Iterator[_Found]:
    if not design.consent:
        yield (
            ("consent",),
            "participants are not asked for their consent",
            'Add [consent] with text = "..."',
            False,
        )
    for i, item in enumerate(design.demographics):
        words = " ".join([item.name.replace("_", " ").replace("-", " "), *item.ask.values()])
        match = IDENTIFIES.search(words.lower())
        asked = item.name if item.name.lower() == "name" else match[0] if match else ""
        if asked:
            yield (
                ("demographics", i),
                f"{item.name} identifies people: it asks for {asked!r}",
                "Remove it; keep names and addresses apart, beside the pseudonym; ask for an age",
                False,
            )


def _exclusion(design: Design, path: Path, rule: Exclusion) -> Iterator[_Found]:
    low, high = _range(design, rule.measure)
    below, above = rule.below, rule.above
    if below is not None and above is not None and above < below:
        yield (
            path,
            f"{rule.name} excludes everything: every number is below {below:g} or above {above:g}",
            "Exchange the bounds: below is the smaller one",
            True,
        )
    elif (below is not None and below > high) or (above is not None and above < low):
        yield (
            path,
            f"{rule.name} excludes everything: {rule.measure} is from {low:g} to {high:g}",
            "Change the bound",
            True,
        )
    elif rule.of == "trial" and rule.measure in OUTCOMES:
        yield (
            path,
            f"{rule.name} selects on the outcome: it leaves out trials because of {rule.measure}",
            "Remove the rule; the report takes trials without success into account",
            False,
        )
    elif rule.measure in ("time_s", "completion_s") and above is not None:
        yield (
            path,
            f"{rule.name} selects on the outcome: it leaves out what takes long",
            "Remove the bound above; time_limit_s ends long trials, and the report counts them",
            False,
        )


def _range(design: Design, measure: str) -> tuple[float, float]:
    """Smallest and largest value that a measure can have."""
    found = find_measure(measure)
    if measure == "progress" or (found is not None and found.unit in ("0/1", "0 to 1")):
        return 0.0, 1.0
    if measure in ("time_s", "completion_s"):
        return 0.0, design.time_limit
    return float("-inf"), float("inf")
