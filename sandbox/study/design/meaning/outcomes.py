"""Flaws of confirmatory outcomes: not measured, measured twice, or by a clock that goes on."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.conditions import combinations, values_of
from sandbox.study.design.design import Design
from sandbox.study.design.meaning.flaw import Flaw
from sandbox.study.measures.measure import LABELS
from sandbox.study.measures.registry import find_measure

SAME = (
    ("success", "held", "instant", "final", "progress", "first_attempt_success"),
    ("time_s", "completion_s"),
    ("nasa-tlx", "nasa-tlx-raw"),
    ("drops", "regrasps", "grasps"),
)
"""Outcomes that say nearly the same."""
MOVES = 3
"""Successful trials of one combination of levels in one session, from which throughput comes."""


def outcome_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of outcomes."""
    path = ("analysis", "primary")
    for group in SAME:
        both = [name for name in design.primary if name in group]
        if len(both) > 1:
            yield Flaw(
                path,
                f"{' and '.join(both)} say nearly the same, and each makes the others' tests "
                f"stricter",
                f"Choose one of them, such as {both[0]}",
            )
    every = [values_of(design, levels) for levels in combinations(design)]
    touched = all(values.get("device", "touch") == "touch" for values in every)
    for name in design.primary:
        measure = find_measure(name)
        if measure is not None and measure.tasks == LABELS and touched:
            yield Flaw(
                path,
                f"{name} is empty for people on a touch screen, which does not tell which finger "
                "touches",
                "Choose another outcome; it is known for simulated users",
            )
        if name.startswith("throughput") and design.repetitions < MOVES:
            yield Flaw(
                path,
                f"{name} is empty: it takes {MOVES} successful trials of a combination of levels "
                f"in "
                f"a session, and there are {design.repetitions}",
                f"Write repetitions = {2 * MOVES} or more",
            )
    yield from _clock(design)


def _clock(design: Design) -> Iterator[Flaw]:
    """Time goes on while the page is away, and counts."""
    timed = [name for name in design.primary if _is_time(name)] or (
        [] if design.primary else ["time_s"]
    )
    removed = any(rule.measure in ("away_s", "away") for rule in design.exclusions)
    if design.page.when_gone == "mark" and timed and not removed:
        yield Flaw(
            ("trials", "when_gone"),
            f"time goes on while the page is gone, and counts in {' and '.join(timed)}",
            'Write when_gone = "pause" or "repeat", or exclude trials by away_s',
        )


def _is_time(name: str) -> bool:
    measure = find_measure(name)
    return name == "time_s" or (
        measure is not None and (measure.unit == "s" or name.startswith("throughput"))
    )
