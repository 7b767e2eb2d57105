"""Lines in the terminal about trials: notices, how a trial ended, and the latency of touches.

Notices come from the session's thread while a trial runs. The latency of touches is a table at the
end, with a limit for scripts.
"""

from __future__ import annotations

import shlex
import threading
import time
from queue import SimpleQueue

from rich.console import Console
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from models.errors import InputError
from sandbox.trial.latency import LatencyLog, Percentiles
from sandbox.trial.result import TrialResult
from tasks.score import ending

KINDS = {
    "waited": "touch received to step",
    "stepped": "step to frame ready",
    "acknowledged": "frame sent to page received",
    "round_trip": "page to server and back",
    "drawn": "touch event to picture on the page",
    "window": "touch received to picture in the window",
    "picture": "drawing a picture in the window",
}
"""Kind in a `LatencyLog` -> description, in the order from touch to picture."""

END_TO_END = ("window", "drawn")
"""Kinds from a touch to a picture, to which a limit applies."""


def print_latency(log: LatencyLog, console: Console) -> None:
    """Prints the latencies as a table, if there are any."""
    percentiles = log.percentiles()
    shown = [kind for kind in KINDS if kind in percentiles]
    if not shown:
        return
    table = Table("latency (ms)", "n", "p50", "p95", "p99")
    for kind in shown:
        p = percentiles[kind]
        table.add_row(KINDS[kind], str(p.n), *(f"{v:.1f}" for v in (p.p50, p.p95, p.p99)))
    console.print(table)
    console.print("[dim]What the display adds after a picture is drawn is not measured.[/]")


def checked_limit(limit: float | None) -> float | None:
    """Checks a limit in ms and returns it.

    Raises:
        InputError: The limit is not positive and finite.
    """
    if limit is not None and not 0.0 < limit < float("inf"):
        raise InputError("not a latency", where="--max-latency", got=limit, expected="ms above 0")
    return limit


def judge_latency(log: LatencyLog, limit: float | None, console: Console) -> int:
    """Returns 0 if the 95th percentile from touch to picture is within the limit, else 1.

    Without a measurement the limit counts as exceeded.

    Args:
        log: Log of the session.
        limit: ms; None sets no limit.
        console: Console for the result.
    """
    if limit is None:
        return 0
    percentiles = log.percentiles()
    ways: dict[str, Percentiles] = {
        kind: percentiles[kind] for kind in END_TO_END if kind in percentiles
    }
    if not ways:
        console.print("[red]latency: no picture followed a touch, so nothing was measured[/]")
        return 1
    late = {kind: p for kind, p in ways.items() if p.p95 > limit}
    for kind, p in ways.items():
        colour, word = ("red", "above") if kind in late else ("green", "within")
        console.print(
            f"[{colour}]{KINDS[kind]}: p95 {p.p95:.1f} ms, {word} the limit of {limit:g} ms[/]"
        )
    return int(bool(late))


class NoticePrinter:
    """Prints notices; a terminal that stands still, as by Ctrl-S, does not hold up their session.

    Args:
        console: Console of the program.
        wrap: False leaves it to the terminal to break long lines.
    """

    def __init__(self, console: Console, wrap: bool = True) -> None:
        self._console, self._wrap = console, wrap
        self._waiting: SimpleQueue[str] = SimpleQueue()
        self._thread: threading.Thread | None = None
        self._said = self._printed = 0

    def say(self, notice: str) -> None:
        """Prints a notice soon; called from the session's thread."""
        self._said += 1
        self._waiting.put(notice)
        if self._thread is None:
            self._thread = threading.Thread(target=self._print, name="notices", daemon=True)
            self._thread.start()

    @property
    def waiting(self) -> int:
        """Number of notices that are not printed yet."""
        return self._said - self._printed

    def wait(self, seconds: float = 1.0) -> None:
        """Waits until all notices are printed, but no longer than a terminal may take."""
        end = time.monotonic() + seconds
        while self.waiting and time.monotonic() < end:
            time.sleep(0.01)

    def _print(self) -> None:
        while True:
            text = Text(self._waiting.get(), style="yellow")
            self._console.print(text, soft_wrap=not self._wrap)
            self._printed += 1


def address_line(address: str) -> str:
    """Returns the line about where a device listens: a link to open, or an address to send to."""
    told = "open" if "://" in address else "listening for TUIO on"
    return f"{told} [bold]{address}[/]"


def report_end(result: TrialResult, console: Console) -> None:
    """Prints how a trial ended, and the recording of the last states of a diverged simulation."""
    if result.diverged:
        console.print(f"[red]the simulation diverged: {result.diverged}[/]")
    if result.dump:
        line = shlex.join(["sandbox", "replay", result.dump])
        console.print(f"its last states: {escape(line)}", soft_wrap=True)
    elif result.dump_error:
        console.print(f"[yellow]{escape(result.dump_error)}[/]", soft_wrap=True)
    colour = "green" if result.success else "red"
    what = ending(result.status, result.success)
    line = f"[bold {colour}]{result.task}: {what}[/] after {result.time_s:.1f} s"
    if result.scored is False:
        line += ", not scored: the table was scaled"
    if result.reason:
        # After success a trial goes on, and what was done may be undone.
        line += f"{'; afterwards, ' if result.success else ', '}{escape(result.reason)}"
    console.print(line)
