"""Output of a regression run for people: its progress, and its report as tables for a terminal.

Progress is shown as a bar on a terminal. Elsewhere, such as in the log of a CI server, a plain line
is printed from time to time.
"""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from math import ceil
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from models.message import counted
from sandbox.regress import statistics
from sandbox.regress.baseline import Baseline
from sandbox.regress.compared_measures import DECIDING, SUCCESS, TIME
from sandbox.regress.comparison import Change, Comparison, groups, level_of
from sandbox.regress.execute import CRASHED
from sandbox.regress.run_plan import file_name, registered
from sandbox.regress.run_report import Crashes, Report
from sandbox.session.session import Session
from sandbox.system.files import write_whole
from sandbox.trial.driver import View, play_trial
from sandbox.views.film import FilmView

if TYPE_CHECKING:
    from sandbox.regress.detectable_changes import Power
    from sandbox.regress.sweep import Curve, Point, Sweep


PAGE = "films.md"
"""Name of the page that shows the films."""


def film_lost(report: Report, baseline: Baseline, folder: Path) -> None:
    """Films the trials with the largest changes, and writes a page with the films.

    Args:
        report: The report; without a loss, no trial is filmed.
        baseline: The baseline.
        folder: Folder of the films.

    Raises:
        GraphicsError: This machine has no OpenGL.
        InputError: A film or the page cannot be written.
    """
    moved = report.moved_most()
    jobs = {(job.name, job.seed): job for job in report.plan.jobs()}
    lines = [
        "# Trials that moved most",
        "",
        f"The baseline was made by {baseline.origin}. To film its trials, run the commands below "
        "with that version of the program, in this folder.",
    ]
    for trial in moved:
        job = jobs[trial.name, trial.seed]
        now = file_name(trial.name, trial.seed).replace(".jsonl", ".webp")
        before = f"before-{now}"
        with ExitStack() as closing, registered(job.own_task):

            def views(session: Session, path: Path = folder / now) -> list[View]:
                film = FilmView(
                    path, session.scene, session.whole_surface, caption="simulated user"
                )
                return [closing.enter_context(film).show]

            play_trial(job.settings, make_views=views)
        run = report.plan.run_words(trial.name, trial.seed)
        lines += ["", f"## {trial.name}, seed {trial.seed}", "", trial.what, ""]
        lines += ["| before | now |", "| --- | --- |", f"| ![]({before}) | ![]({now}) |"]
        if run:
            lines += ["", f"    {shlex.join([*run, '--film', before])}"]
    write_whole(folder / PAGE, "\n".join(lines) + "\n", "--film-lost")


FIRST, EVERY = 10.0, 30.0
"""Time (s) after which the first plain line is due, and each further line."""

UpdateProgress = Callable[[int, int], None]
"""Receives the number of ended trials, and the number of successful ones."""


class PlainLines:
    """Progress as lines of plain text: one from time to time, and one when all trials have ended.

    Args:
        what: Name of the part of the run, at the beginning of every line; empty for a whole run.
        total: Number of trials.
        ended: Number of trials that had ended in an earlier run.
        write: Writes a line.
        clock: Returns the time, s.
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

    def update(self, ended: int, succeeded: int) -> None:
        """Writes a line if one is due.

        Args:
            ended: Number of ended trials.
            succeeded: Number of successful trials.
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
def progress_lines(what: str, total: int, ended: int) -> Iterator[UpdateProgress]:
    """Shows the progress on standard error while trials run.

    Args:
        what: Name of the part of the run; empty for a whole run.
        total: Number of trials.
        ended: Number of trials that had ended in an earlier run.
    """
    screen = Console(stderr=True)
    if not (sys.stderr.isatty() and screen.is_terminal) or screen.is_dumb_terminal:
        yield PlainLines(what, total, ended).update
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

        def update(ended: int, succeeded: int) -> None:
            text = f"{succeeded} of {ended} succeeded"
            progress.update(bar, completed=ended, description=f"{what}: {text}" if what else text)

        yield update


MOST_FAILED = 20
"""Largest number of failed trials that are listed; the JSON has all of them."""


def show(report: Report, console: Console) -> None:
    """Prints the whole report."""
    console.print(_successes(report))
    if report.comparisons:
        console.print(_compared(report))
        _moved(report, console)
        _noise_floor(report, console)
    else:
        _noise_floor_to_come(report, console)
    _failed(report, console)
    for note in report.notes:
        console.print(f"[yellow]{escape(note)}[/]", soft_wrap=True)
    for gain in report.gains:
        console.print(f"[bold green]gain, {escape(gain)}[/]", soft_wrap=True)
    for reason in report.reasons:
        console.print(f"[bold red]loss, {escape(reason)}[/]", soft_wrap=True)
    for trial in report.moved_most():
        console.print(escape(str(trial)), soft_wrap=True)
        console.print(f"  {escape(trial.command)}", soft_wrap=True)
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
    table.add_column("task", no_wrap=True)
    names = ("pairs", "lost", "won", "time", "95 % interval", "p, success", "p, time", "states")
    for name in names:
        table.add_column(name, justify="right")
    for name, c in report.comparisons.items():
        counts = (str(c.pairs), str(len(c.lost)), str(len(c.won)))
        table.add_row(escape(name), *counts, *_changed(c.changes), _states(c))
    for name, own in groups(report.comparisons).items():
        changes = report.together[name]
        lost = sum(len(report.comparisons[row].lost) for row in own)
        won = sum(len(report.comparisons[row].won) for row in own)
        counts = (str(changes[SUCCESS].pairs), str(lost), str(won))
        table.add_row(name, *counts, *_changed(changes), "")
    return table


def _changed(changes: Mapping[str, Change]) -> tuple[str, ...]:
    """Table cells: change of time, its interval, and the p values of success and time."""
    time, success = changes[TIME], changes[SUCCESS]

    def coloured(text: str, change: Change) -> str:
        colour = "red" if change.is_loss else "green" if change.is_gain else ""
        return f"[{colour}]{text}[/]" if colour else text

    def p(change: Change) -> str:
        return coloured(f"{min(change.p_loss, change.p_gain):.2g}", change)

    interval = f"{100 * time.low:+.1f} to {100 * time.high:+.1f}" if time.pairs > 1 else ""
    return coloured(f"{100 * time.change:+.1f} %", time), interval, p(success), p(time)


def _moved(report: Report, console: Console) -> None:
    """Prints the significant changes of measures that do not decide whether the run passes."""
    for name, c in report.comparisons.items():
        others = [change for m, change in c.changes.items() if m not in DECIDING and change.moved]
        if others:
            text = f"{name} moved: {'; '.join(change.text() for change in others)}"
            console.print(escape(text), soft_wrap=True)


def _states(c: Comparison) -> str:
    if not c.same_machine:
        return "another machine" if c.elsewhere else "not compared"
    return f"{len(c.changed)} changed" if c.changed else f"{c.same_machine} equal"


def _noise_floor(report: Report, console: Console) -> None:
    level = level_of(report.comparisons)
    losses = statistics.fewest_losses(level)
    for name, c in report.comparisons.items():
        drop = statistics.noticeable_drop(c.pairs, 0.0, level)
        text = (
            f"{name}: {counted(losses, 'seed')} lost and none won would be a loss beyond chance; "
            f"{c.pairs} pairs "
        )
        if drop is None:
            text += f"cannot detect any drop with {statistics.POWER:.0%} power: use more seeds"
        else:
            text += f"detect a drop of {100 * drop:.1f} points with {statistics.POWER:.0%} power"
            if c.won:
                churn = statistics.noticeable_drop(c.pairs, len(c.won) / c.pairs, level)
                text += " if no seed is won; with as many won seeds as here, " + (
                    "no drop" if churn is None else f"a drop of {100 * churn:.1f} points"
                )
        console.print(f"[dim]{escape(text)}[/]", soft_wrap=True)


def _noise_floor_to_come(report: Report, console: Console) -> None:
    floor = report.noise_floor()
    seeds, power = counted(floor["pairs"], "seed"), f"{statistics.POWER:.0%}"
    if floor["drop"] is None:
        text = f"{seeds} are too few for a baseline: no drop could be detected with {power} power"
    else:
        text = (
            f"with this baseline of {seeds}, a later run detects a drop of "
            f"{100 * floor['drop']:.1f} points with {power} power if no seed is won"
        )
    console.print(f"[dim]{text}[/]", soft_wrap=True)


def _failed(report: Report, console: Console) -> None:
    show_crashes(report.crashes, console)
    failed = [t for task in report.tasks for t in task.failed]
    lost = {(name, s) for name, c in report.comparisons.items() for s in c.lost}
    # Losses come first, since readers search for them.
    failed.sort(key=lambda t: (t["task"], t["seed"]) not in lost)
    for trial in failed[:MOST_FAILED]:
        mark = "[red]lost[/] " if (trial["task"], trial["seed"]) in lost else ""
        why = "" if trial["status"] == CRASHED else f", {trial['reason']}"
        line = f"{trial['task']} seed {trial['seed']}: {trial['status']}{why}"
        console.print(f"{mark}{escape(line)}", soft_wrap=True)
        console.print(f"  {escape(report.command(trial))}", soft_wrap=True)
    if len(failed) > MOST_FAILED:
        console.print(f"... and {len(failed) - MOST_FAILED} more failed trials, see --json")


def show_power(rows: Sequence[Power], minutes: float, workers: int, console: Console) -> None:
    """Prints the changes that a comparison can detect.

    Args:
        rows: Power by task.
        minutes: Time of one core for all trials, min.
        workers: Number of trials that run at the same time.
        console: Console for the output.
    """
    chance = f"{statistics.POWER:.0%}"
    table = Table(title=f"changes that are detected with a probability of {chance}")
    table.add_column("task", no_wrap=True)
    for name in ("seeds", "drop of success", "change of time"):
        table.add_column(name, justify="right")
    for row in rows:
        table.add_row(
            escape(row.task),
            str(row.pairs),
            "none" if row.success is None else f"{100 * row.success:.1f} points",
            "unknown" if row.time is None else f"{100 * row.time:.1f} %",
        )
    console.print(table)
    if any(row.time is None for row in rows):
        console.print("--update-baseline measures the scatter of times", soft_wrap=True)
    each = f"{counted(workers, 'worker')}: about {max(minutes / workers, 0.1):.1f} min"
    console.print(f"{each} on this machine; one worker: {max(minutes, 0.1):.1f} min")


def show_crashes(crashes: Crashes, console: Console) -> None:
    """Prints a line for every trial that crashed, with its seed and error."""
    for trial in crashes.trials:
        name = escape(f"{trial['task']} seed {trial['seed']}")
        console.print(f"[red]crashed[/] {name}: {escape(trial['reason'])}", soft_wrap=True)


def show_sweep(found: Sweep, console: Console) -> None:
    """Prints the whole report of a run with variations."""
    for curve in found.curves:
        console.print(_curve_table(found, curve))
        for line in limit_lines(curve):
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
        f"{counted(least, 'seed')} lost and none won would be a loss beyond chance; "
        f"{counted(seeds, 'seed')}: "
    )
    text += (
        "too few to detect any drop"
        if floor is None
        else f"enough to detect a drop of {100 * floor:.1f} points"
    )
    text += f" with {statistics.POWER:.0%} power. Each value is tested separately, and p values "
    text += "are not adjusted"
    console.print(f"[dim]{text}[/]", soft_wrap=True)
    if not found.complete:
        missing = "; ".join(each.text(seeds) for each in found.unfinished)
        console.print(f"[yellow]not finished: {escape(missing)}[/]", soft_wrap=True)


def limit_lines(curve: Curve) -> list[str]:
    """Lines of text: the values at which a task breaks, and refused values."""
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


def _curve_table(found: Sweep, curve: Curve) -> Table:
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
    """Texts next to a value, each with True if it holds."""
    return (
        ("nothing varied", neutral),
        ("[red]breaks[/]", not neutral and point.breaks),
        (f"[yellow]{point.result.n} of {seeds} trials[/]", point.partial),
    )
