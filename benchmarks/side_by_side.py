"""Times of calls that answer the same questions, taken in turns in one thread.

A block asks a call all its questions, one after another in a plain loop, and is timed as a whole:
that is what a call costs from Python. Blocks of all calls of a row take turns, so that a busy
moment meets all of them; the median block counts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from rich.box import MARKDOWN
from rich.console import Console
from rich.table import Table

BUDGET = 1.0
"""s, for every call."""
LEAST_BLOCKS = 5


class Call(NamedTuple):
    """A timed call.

    Attributes:
        name: In the table.
        function: Called with one question.
        questions: Asked in turn.
        share: What a call's time is divided by, when one call answers many at once.
    """

    name: str
    function: Callable[[Any], object]
    questions: Sequence[Any]
    share: int = 1


def microseconds(calls: Sequence[Call]) -> list[float]:
    """Median time of every call."""
    spent: list[list[float]] = [[] for _ in calls]
    for call in calls:
        _block(call)
    start = perf_counter()
    while len(spent[0]) < LEAST_BLOCKS or perf_counter() - start < BUDGET * len(calls):
        for call, found in zip(calls, spent, strict=True):
            found.append(_block(call) / len(call.questions) / call.share)
    return [1e6 * float(np.median(found)) for found in spent]


def _block(call: Call) -> float:
    function, questions = call.function, call.questions
    start = perf_counter()
    for question in questions:
        function(question)
    return perf_counter() - start


class Comparison:
    """A table of ours against peers, printed as Markdown."""

    def __init__(self, console: Console, title: str) -> None:
        self._console, self._title = console, title
        self._table = Table("", "us", "peer", "us", "ratio", box=MARKDOWN)

    def row(self, *calls: Call) -> None:
        """Ours first, then its peers."""
        ours, *peers = microseconds(calls)
        if not peers:
            self._table.add_row(calls[0].name, _text(ours), "", "", "")
        for i, (call, theirs) in enumerate(zip(calls[1:], peers, strict=True)):
            name = ("" if i else calls[0].name, "" if i else _text(ours))
            self._table.add_row(*name, call.name, _text(theirs), _text(theirs / ours))

    def show(self) -> None:
        self._console.print(f"\n## {self._title}\n")
        self._console.print(self._table)


def _text(number: float) -> str:
    return f"{number:.3g}" if number < 1000 else f"{number:.0f}"


def agree(name: str, ours: Sequence[object], theirs: Sequence[object]) -> None:
    """A ratio of times is worth something only between equal answers."""
    same = sum(a == b for a, b in zip(ours, theirs, strict=True))
    if same < len(ours):
        raise SystemExit(f"{name}: only {same} of {len(ours)} answers agree with the peer's")
