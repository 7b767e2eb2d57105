"""Latency of touches: a table at the end of a session, and a limit for scripts."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from models.errors import InputError
from sandbox.trial.latency import LatencyLog, Percentiles

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
