"""`sandbox regress --vary`: success while one thing after the other gets worse."""

from __future__ import annotations

import json
from dataclasses import fields
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from rich.console import Console

from models.errors import InputError

if TYPE_CHECKING:
    from sandbox.cli.regress import RegressOptions
    from sandbox.regress.execute import Executor
    from sandbox.regress.plan import RegressionPlan
    from sandbox.regress.sweep import Runner

WITHOUT = ("baseline", "junit", "record", "update_baseline", "exact", "across_encoders")
"""Options that mean nothing where trials are varied."""


def check_vary(options: RegressOptions) -> None:
    """Refuses what would fail at the end.

    Raises:
        InputError: An option does not go with another.
    """
    if not options.vary:
        if options.plot is not None:
            raise InputError("there is nothing to plot", where="--plot", remedy="Add --vary NAME")
        return
    plain = {f.name: f.default for f in fields(options)}
    for name in WITHOUT:
        if getattr(options, name) != plain[name]:
            raise InputError(
                "varied trials are compared with those of the same run, and with nothing else",
                where=f"--vary --{name.replace('_', '-')}",
            )
    from sandbox.regress.sweep import parse_wanted

    parse_wanted(options.vary)
    if options.plot is not None:
        from sandbox.figures.variation import check_plot

        check_plot(options.plot)


def run_vary(
    options: RegressOptions,
    plan: RegressionPlan,
    executor: Executor,
    run: Runner,
    console: Console,
) -> bool:
    """Runs, prints, draws and writes; whether nobody broke off.

    Args:
        options: Checked.
        plan: Of the trials with nothing varied.
        executor: Its name goes into the report.
        run: Runs a plan's trials.
        console: For people.
    """
    from sandbox.regress.baseline import write_whole
    from sandbox.regress.show_sweep import show_sweep
    from sandbox.regress.sweep import parse_wanted, sweep

    began = perf_counter()
    found = sweep(plan, parse_wanted(options.vary), run)
    wall_s = perf_counter() - began
    show_sweep(found, console)
    if options.json is not None:
        ran: dict[str, Any] = {"executor": executor.name, "workers": options.workers}
        report = {**found.as_json(), **ran, "wall_s": round(wall_s, 3)}
        text = json.dumps(report, indent=1, allow_nan=False)
        if options.json == Path("-"):
            print(text)
        else:
            write_whole(options.json, text + "\n", "--json")
    if options.plot is not None:
        from sandbox.figures.variation import draw, save_plot

        save_plot(draw(found), options.plot)
    return found.complete
