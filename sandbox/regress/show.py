"""The report as tables for a terminal."""

from __future__ import annotations

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from models.message import counted
from sandbox.regress import statistics
from sandbox.regress.execute import CRASHED
from sandbox.regress.report import Comparison, Crashes, Report

MOST_FAILED = 20
"""Lines of failed trials; the JSON has all of them."""


def show(report: Report, console: Console) -> None:
    """Prints everything a person has to know."""
    console.print(_successes(report))
    if report.comparisons:
        console.print(_compared(report))
        _noise_floor(report, console)
    else:
        _noise_floor_to_come(report, console)
    _failed(report, console)
    for note in report.notes:
        console.print(f"[yellow]{escape(note)}[/]", soft_wrap=True)
    for reason in report.reasons:
        console.print(f"[bold red]{escape(reason)}[/]", soft_wrap=True)
    if report.complete and report.comparisons and report.passed:
        console.print("[green]no loss beyond chance[/]")


def _successes(report: Report) -> Table:
    encoder = report.configuration["settings"]["pipeline"]["encoder"]
    table = Table(title=f"simulated user, encoder {escape(encoder)}")
    table.add_column("task")
    for name in ("success", "95 % interval", "progress", "median time", "crashed"):
        table.add_column(name, justify="right")
    for task in report.tasks:
        low, high = statistics.wilson(task.successes, task.n)
        crashed = sum(t["status"] == CRASHED for t in task.trials)
        table.add_row(
            escape(task.name),
            f"{task.successes}/{task.n}" + (f" {task.successes / task.n:.1%}" if task.n else ""),
            f"{low:.1%} to {high:.1%}",
            "" if task.progress is None else f"{task.progress:.3f}",
            "" if task.time_s is None else f"{task.time_s:.2f} s",
            f"[red]{crashed}[/]" if crashed else "0",
        )
    return table


def _compared(report: Report) -> Table:
    table = Table(title="against the baseline, seed by seed")
    table.add_column("task")
    for name in ("pairs", "both", "lost", "won", "neither", "progress", "p", "p, Holm", "states"):
        table.add_column(name, justify="right")
    for name, c in report.comparisons.items():
        colour = "red" if c.significant else "default"
        table.add_row(
            escape(name),
            str(c.pairs),
            str(len(c.both)),
            f"[{colour}]{len(c.lost)}[/]",
            str(len(c.won)),
            str(len(c.neither)),
            f"{c.progress:+.3f}",
            f"{c.p:.3g}",
            f"[{colour}]{c.p_holm:.3g}[/]",
            _states(c),
        )
    return table


def _states(c: Comparison) -> str:
    if not c.same_machine:
        return "another machine" if c.elsewhere else "not compared"
    return f"{len(c.changed)} changed" if c.changed else f"{c.same_machine} equal"


def _noise_floor(report: Report, console: Console) -> None:
    tests = len(report.comparisons)
    losses = statistics.fewest_losses(tests)
    for name, c in report.comparisons.items():
        drop = statistics.noticeable_drop(c.pairs, 0.0, tests)
        text = f"{name}: {losses} lost and none won would be a loss beyond chance; {c.pairs} pairs "
        if drop is None:
            text += f"cannot notice any drop with {statistics.POWER:.0%} power: take more seeds"
        else:
            text += f"notice a drop of {100 * drop:.1f} points with {statistics.POWER:.0%} power"
            if c.won:
                churn = statistics.noticeable_drop(c.pairs, len(c.won) / c.pairs, tests)
                text += " if nothing is won besides; with as many won as here, " + (
                    "none" if churn is None else f"one of {100 * churn:.1f} points"
                )
        console.print(f"[dim]{escape(text)}[/]", soft_wrap=True)


def _noise_floor_to_come(report: Report, console: Console) -> None:
    floor = report.noise_floor()
    seeds, power = counted(floor["pairs"], "seed"), f"{statistics.POWER:.0%}"
    if floor["drop"] is None:
        text = f"as a baseline, {seeds}: too few for a later run to notice any drop"
    else:
        drop = 100 * floor["drop"]
        text = f"as a baseline, {seeds}: a later run would notice a drop of {drop:.1f} points"
    console.print(f"[dim]{text} with {power} power, at best[/]", soft_wrap=True)


def _failed(report: Report, console: Console) -> None:
    show_crashes(report.crashes, console)
    failed = [t for task in report.tasks for t in task.failed]
    lost = {(name, s) for name, c in report.comparisons.items() for s in c.lost}
    # What was lost is what somebody looks for.
    failed.sort(key=lambda t: (t["task"], t["seed"]) not in lost)
    for trial in failed[:MOST_FAILED]:
        mark = "[red]lost[/] " if (trial["task"], trial["seed"]) in lost else ""
        why = "" if trial["status"] == CRASHED else f", {trial['reason']}"
        line = f"{trial['task']} seed {trial['seed']}: {trial['status']}{why}"
        console.print(f"{mark}{escape(line)}", soft_wrap=True)
        console.print(f"  {escape(report.command(trial))}", soft_wrap=True)
    if len(failed) > MOST_FAILED:
        console.print(f"... and {len(failed) - MOST_FAILED} more failed trials, see --json")


def show_crashes(crashes: Crashes, console: Console) -> None:
    """Prints a line for every trial that crashed, with its seed and error."""
    for trial in crashes.trials:
        name = escape(f"{trial['task']} seed {trial['seed']}")
        console.print(f"[red]crashed[/] {name}: {escape(trial['reason'])}", soft_wrap=True)
