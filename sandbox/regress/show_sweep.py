"""A run with variations as tables for a terminal."""

from __future__ import annotations

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from models.message import counted
from sandbox.regress import statistics
from sandbox.regress.sweep import Curve, Point, Sweep


def show_sweep(found: Sweep, console: Console) -> None:
    """Prints everything a person has to know."""
    for curve in found.curves:
        console.print(_table(found, curve))
        for line in said(curve):
            console.print(escape(line), soft_wrap=True)
        broken = next((p for p in curve.points if p.breaks and p.lost), None)
        if broken:
            again = found.command(curve, broken, broken.lost[0])
            console.print(f"  [dim]{escape(again)}[/]", soft_wrap=True)
        console.print()
    seeds = len(found.plan.seeds)
    floor = statistics.noticeable_drop(seeds)
    least = statistics.fewest_losses()
    text = (
        f"{least} seeds lost and none won would be a loss beyond chance; {counted(seeds, 'seed')}: "
    )
    text += (
        "too few to notice any drop"
        if floor is None
        else f"enough to notice a drop of {100 * floor:.1f} points"
    )
    power = f"{statistics.POWER:.0%}"
    console.print(f"[dim]{text} with {power} power, every value on its own[/]", soft_wrap=True)
    if not found.complete:
        missing = "; ".join(each.text(seeds) for each in found.unfinished)
        console.print(f"[yellow]not finished: {escape(missing)}[/]", soft_wrap=True)


def said(curve: Curve) -> list[str]:
    """Text of the values at which a task breaks."""
    kind = curve.kind
    lines = [f"{kind.text(p.value)}: {p.refused}" for p in curve.points if p.refused]
    below, above = curve.breaks_below, curve.breaks_above
    if below is not None:
        lines.append(f"{curve.task} breaks at {kind.name} {kind.text(below)}")
    if above is not None:
        lines.append(f"{curve.task} breaks at {kind.name} {kind.text(above)}")
    judged = [point for point in curve.run if not point.partial]
    if below is None and above is None and len(judged) > 1:
        lowest, highest = kind.text(judged[0].value), kind.text(judged[-1].value)
        lines.append(f"{curve.task}: no break found from {kind.name} {lowest} to {highest}")
    return lines


def _table(found: Sweep, curve: Curve) -> Table:
    kind = curve.kind
    encoder = found.plan.settings[0].pipeline.encoder
    table = Table(title=f"{escape(curve.task)}: {kind.about} (simulated user, {escape(encoder)})")
    table.add_column(f"{kind.name}, {kind.unit or 'factor'}", justify="right")
    for name in ("success", "95 % interval", "lost", "won", "p", "median time", ""):
        table.add_column(name, justify="right")
    for point in curve.run:
        table.add_row(*_row(curve, point, len(found.plan.seeds)))
    return table


def _row(curve: Curve, point: Point, seeds: int) -> tuple[str, ...]:
    result = point.result
    low, high = statistics.wilson(result.successes, result.n)
    neutral = point.value == curve.kind.neutral
    notes = [text for text, holds in _notes(point, neutral, seeds) if holds]
    return (
        f"{point.value:g}",
        f"{result.successes}/{result.n}",
        f"{low:.1%} to {high:.1%}",
        "" if neutral else str(len(point.lost)),
        "" if neutral else str(len(point.won)),
        "" if neutral or point.partial else f"{point.p:.3g}",
        "" if result.time_s is None else f"{result.time_s:.2f} s",
        ", ".join(notes),
    )


def _notes(point: Point, neutral: bool, seeds: int) -> tuple[tuple[str, bool], ...]:
    """Texts beside a value, each with whether it holds."""
    return (
        ("nothing varied", neutral),
        ("[red]breaks[/]", not neutral and point.breaks),
        (f"[yellow]{point.result.n} of {seeds} trials[/]", point.partial),
    )
