"""How far a run is: a bar on a terminal, and now and then a plain line where there is none, as in
the log of a CI server."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import ceil
from time import perf_counter

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from models.message import counted

FIRST, EVERY = 10.0, 30.0
"""s after which the first plain line is due, and each further one."""

Tell = Callable[[int, int], None]
"""Takes how many trials have ended, and how many of them succeeded."""


class PlainLines:
    """Lines of plain text: one where so much time has passed, and one when all trials have ended.

    Args:
        what: What is run, before every line; empty for a whole run.
        total: Number of trials.
        ended: How many of them had ended before.
        write: Takes each line.
        clock: Time in s.
    """

    def __init__(
        self,
        what: str,
        total: int,
        ended: int = 0,
        write: Callable[[str], None] = lambda line: print(line, file=sys.stderr, flush=True),
        clock: Callable[[], float] = perf_counter,
    ) -> None:
        self._what = f"{what}: " if what else ""
        self._total, self._before = total, ended
        self._write, self._clock = write, clock
        self._began = clock()
        self._due = self._began + FIRST

    def tell(self, ended: int, succeeded: int) -> None:
        """Writes a line if one is due.

        Args:
            ended: How many trials have ended.
            succeeded: How many of them succeeded.
        """
        now = self._clock()
        if now < self._due and ended < self._total:
            return
        self._due = now + EVERY
        line = f"{self._what}{ended} of {counted(self._total, 'trial')}, {succeeded} succeeded"
        here = ended - self._before
        if here and ended < self._total:
            left = (now - self._began) / here * (self._total - ended)
            line += f", about {ceil(left / 60.0)} min left"
        self._write(line)


@contextmanager
def progress_shown(what: str, total: int, ended: int) -> Iterator[Tell]:
    """Shows the progress on standard error while trials run.

    Args:
        what: What is run, in words; empty for a whole run.
        total: Number of trials.
        ended: How many of them had ended before.
    """
    screen = Console(stderr=True)
    if not (sys.stderr.isatty() and screen.is_terminal) or screen.is_dumb_terminal:
        yield PlainLines(what, total, ended).tell
        return
    progress = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=screen,
        transient=True,
    )
    with progress:
        bar = progress.add_task(what or "running", total=total, completed=ended)

        def tell(ended: int, succeeded: int) -> None:
            text = f"{succeeded} of {ended} succeeded"
            progress.update(bar, completed=ended, description=f"{what}: {text}" if what else text)

        yield tell
