"""`sandbox regress`: success over many seeds, and against what it was before."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, fields, replace
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.errors import InputError, unknown_name
from models.message import counted
from sandbox.cli.common.command_line import parse, picked
from sandbox.cli.common.json_out import TERMINAL, check_output, printing, refuse_same, write_json
from sandbox.trial.trial_options import (
    KINDS,
    ConditionOptions,
    SecondOptions,
    given_options,
    help_with_names,
)

if TYPE_CHECKING:
    from sandbox.regress.baseline import Baseline
    from sandbox.regress.execute import Executor, Interrupt, Trial
    from sandbox.regress.run_plan import RegressionPlan, TrialJob
    from sandbox.regress.run_report import Report
    from sandbox.regress.sweep import Runner
    from sandbox.regress.trials_file import TrialsFile


@dataclass(frozen=True, kw_only=True)
class RegressOptions(SecondOptions, ConditionOptions):
    """Runs the simulated user over many seeds, says how often it succeeds, and whether that is
    less than a baseline said.

    Options of `sandbox run` are taken as well and hold for all trials, such as --bare or
    `--impulse safe`.

    Exit status 0: all trials were run and the gate holds; trials that fail without a baseline, and
    values of --vary that break a task, are no reason for another. 1: a loss of success or time
    beyond chance (exact tests over paired seeds, alpha 0.02, Holm over tasks), more crashed trials
    than --allow-crashes permits, or with --exact another state with the baseline's fingerprint. 2:
    bad input, and one line says what. 130: stopped by Ctrl-C, 143: by SIGTERM.

    With --json or --junit every trial is written as it ends, to a file beside the report, such as
    report.trials.jsonl. If the run is stopped or killed, the same command with --resume continues.

    Try:

        sandbox regress --seeds 0:20 --json report.json
        sandbox regress --seeds 0:20 --json report.json --resume
        sandbox regress --baseline base.json --update-baseline
        sandbox regress --baseline base.json
        sandbox regress --baseline base.json --arm plain --seeds 0:120
        sandbox regress --tasks box-to-goal --seeds 0:30 --vary size latency=50,100
    """

    tasks: Annotated[
        tuple[str, ...], Parameter(metavar="all|NAME|FILE.py", consume_multiple=True)
    ] = ("all",)
    """Which tasks; `sandbox` lists them, and FILE.py has one of your own."""

    seeds: Annotated[str, Parameter(metavar="A:B")] = "0:40"
    """From A to before B; commas join several."""

    arm: Literal["plain", "hard", "both"] = "both"
    """plain: the tasks as they are. hard: the tasks with smaller objects, less room or less
    friction, so that a part of the trials fails. With --vary the plain one."""

    executor: Literal["serial", "processes", "ray"] = "processes"
    """Where trials run; the results are the same to the bit. ray: the extra `ray`."""

    workers: int = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1
    """How many trials at a time, one core each."""

    address: Annotated[str | None, Parameter(metavar="ADDRESS")] = None
    """Of a running Ray cluster."""

    json: Annotated[Path | None, Parameter(metavar="OUT")] = None
    """Writes the report with every trial; - is the terminal."""

    junit: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """Writes JUnit's XML, a test for every task."""

    markdown: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """Writes a summary in Markdown, which CI servers show beside a run."""

    baseline: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """What to compare with; one of another encoder, task version or settings is refused."""

    margin: Annotated[
        tuple[str, ...] | None, Parameter(metavar="MEASURE=SHARE", consume_multiple=True)
    ] = None
    """Changes of success or time that do not matter, such as time=5% or success=2%: a loss must be
    beyond chance and beyond its margin."""

    update_baseline: bool = False
    """Makes the baseline from this run; nothing is judged. Ten seeds of every task are played a
    second time, for --plan."""

    plan: bool = False
    """Only prints which changes a comparison with the baseline would find, and how long it would
    take."""

    exact: bool = False
    """States must be equal to the bit where MuJoCo, architecture and libm are the baseline's."""

    across_encoders: bool = False
    """The baseline may be another encoder's: whether this one is worse is the question."""

    vary: Annotated[
        tuple[str, ...] | None,
        Parameter(
            metavar="NAME[=V1,V2]",
            consume_multiple=True,
            help=f"Success against {help_with_names(KINDS.values())}, with the values given, or "
            "with ever worse ones until it breaks. Instead of a baseline.",
        ),
    ] = None

    plot: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """Draws what --vary found, .png or .svg; the extra `plots`."""

    film_lost: Annotated[Path | None, Parameter(metavar="DIR")] = None
    """Films the trials that moved most in a loss, in a new or empty folder, with a page that shows
    them beside those of the baseline's program, and the lines that film these."""

    record: Annotated[Path | None, Parameter(metavar="DIR")] = None
    """Keeps a recording of every trial that fails in a new or empty folder."""

    record_all: bool = False
    """Keeps those of successful trials, too, which `sandbox export` makes data sets of."""

    resume: bool = False
    """Continues from the trials of a run that was stopped or killed: only seeds that are missing or
    crashed are run. Give the same command again; other settings, seeds or versions are refused."""

    allow_crashes: Annotated[int, Parameter(metavar="N")] = 0
    """How many trials of the whole run may crash: their code raises an error, or their process or
    machine is lost. Each counts as a failure."""


def main(argv: list[str]) -> int:
    """Runs `sandbox regress ...`."""
    options = _parsed(argv)
    _check(options)
    from sandbox.regress.console_report import show
    from sandbox.regress.execute import Interrupt
    from sandbox.regress.run_plan import ARMS, PLAIN, RegressionPlan, find_tasks, parse_seeds
    from sandbox.regress.run_report import make_report, markdown, save_junit
    from sandbox.system.files import write_whole

    plan = RegressionPlan(
        find_tasks(options.tasks),
        parse_seeds(options.seeds),
        _scene(options),
        options.record,
        options.record_all,
        ARMS[PLAIN if options.vary else options.arm],
    )
    quiet = str(options.json) == "-"
    console = Console(stderr=quiet)
    console = Console(stderr=quiet, width=max(console.width, 100))
    plan.check_drawn()
    if options.vary:
        from sandbox.regress.sweep import check_possible, parse_variations

        check_possible(plan, parse_variations(options.vary))
    executor = _executor(options)
    old = _compared_with(options, plan, console)
    if options.plan:
        assert old is not None
        return _show_power(options, plan, old, console)
    if options.record is not None and not options.resume:
        _empty_folder(options.record, "--record")
    if options.film_lost is not None:
        _empty_folder(options.film_lost, "--film-lost")
    with _trials_file(options, plan, console) as kept, Interrupt() as interrupt:
        began = perf_counter()
        sweeps = bool(options.vary)
        run = partial(_run, executor=executor, interrupt=interrupt, kept=kept, named=sweeps)
        if options.vary:
            passed = run_vary(options, plan, executor, run, console)
        else:
            trials = run(plan)
            wall_s = perf_counter() - began
            report = make_report(
                plan,
                trials,
                old,
                options.exact,
                options.across_encoders,
                options.allow_crashes,
                margins(options.margin or ()),
            )
            with printing():
                show(report, console)
            if options.json is not None:
                ran = {"executor": executor.name, "workers": options.workers}
                values = {**report.as_json(), **ran, "wall_s": round(wall_s, 3)}
                text = json.dumps(values, indent=1, allow_nan=False)
                if quiet:
                    print(text)
                else:
                    write_whole(options.json, text + "\n", "--json")
            if options.junit is not None:
                save_junit(report, options.junit)
            if options.markdown is not None:
                write_whole(options.markdown, markdown(report), "--markdown")
            if options.film_lost is not None and old is not None:
                from sandbox.regress.console_report import film_lost

                film_lost(report, old, options.film_lost)
            passed = report.passed if report.complete else None
            if options.update_baseline:
                again = _repeated(plan, executor, interrupt) if report.passed else []
                passed = _update(options, plan, report, again, console)
        if passed is None:
            return interrupt.status
        if not passed and kept is not None and kept.has_crashes:
            console.print("the same command with --resume runs the crashed trials again")
        if kept is not None:
            kept.finish()
    return 0 if passed else 1


def _parsed(argv: list[str]) -> RegressOptions:
    for word in argv:
        if word.partition("=")[0] in ("--device", "--events", "--port", "--bind", "--seed"):
            raise InputError(
                "this is not for regression runs",
                got=word,
                expected="options of `sandbox run` that hold for every trial",
                remedy="--seeds A:B says which" if word.startswith("--seed") else None,
            )
    return parse(RegressOptions, "sandbox regress", argv)


def margins(texts: Sequence[str]) -> dict[str, float]:
    """Margins by measure, as shares, from texts such as `time=5%`.

    Raises:
        InputError: A measure does not decide or does not exist, or a margin has no unit.
    """
    from sandbox.regress.compared_measures import DECIDING

    found = {}
    for text in texts:
        name, _, amount = text.partition("=")
        if name not in DECIDING:
            raise unknown_name("no such measure with a margin", name, DECIDING, where="--margin")
        try:
            share = float(amount.removesuffix("%")) / 100.0
        except ValueError:
            share = -1.0
        if not amount.endswith("%") or not 0.0 <= share < 1.0:
            raise InputError(
                "not a margin", where="--margin", got=text, expected=f"such as {name}=5%"
            )
        found[name] = share
    return found


def _scene(options: RegressOptions) -> dict[str, Any]:
    from sandbox.trial.trial_options import TrialOptions, check_labels

    # Of the same name, but not those of a trial.
    given = options.given - {"vary", "record"}
    scene = picked(TrialOptions, options, vary="", record=None, given=given)
    check_labels(scene)
    return {name: getattr(scene, name) for name in given_options(scene)}


def _check(options: RegressOptions) -> None:
    """Refuses, before anything is run, what would fail at the end."""
    check_vary(options)
    margins(options.margin or ())
    if not options.tasks:
        raise InputError("no task is named", where="--tasks", remedy="Leave it out, or name one")
    if options.workers < 1:
        raise InputError("too few", where="--workers", got=options.workers, expected="1 or more")
    if options.allow_crashes < 0:
        raise InputError(
            "fewer than none", where="--allow-crashes", got=options.allow_crashes, expected="0 ..."
        )
    if options.record_all and options.record is None:
        raise InputError("no folder is given", where="--record-all", remedy="Add --record DIR")
    if options.baseline is None:
        for name in ("update_baseline", "exact", "across_encoders", "margin", "plan", "film_lost"):
            if getattr(options, name):
                option = "--" + name.replace("_", "-")
                raise InputError("no baseline is given", where=option, remedy="Add --baseline FILE")
    if options.exact and options.across_encoders:
        raise InputError("two encoders never give equal states", where="--exact --across-encoders")
    if options.across_encoders and options.update_baseline:
        raise InputError("a baseline is one encoder's", where="--across-encoders --update-baseline")
    if options.address is not None and options.executor != "ray":
        raise InputError("only Ray has an address", where="--address", remedy="Add --executor ray")
    written = {
        "--json": options.json,
        "--junit": options.junit,
        "--markdown": options.markdown,
    }
    refuse_same({**written, "--baseline": options.baseline, "--plot": options.plot})
    if options.update_baseline:
        written["--baseline"] = options.baseline
    for option, path in written.items():
        check_output(path, option)


def _empty_folder(folder: Path, option: str) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        full = any(folder.iterdir())
    except OSError as error:
        where = f"{option} {folder}"
        raise InputError("no folder can be made", where=where, got=error.strerror) from None
    if full:
        raise InputError(
            "files of an earlier run would be mixed with this one's",
            where=f"{option} {folder}",
            expected="a new or empty folder",
        )


def _executor(options: RegressOptions) -> Executor:
    from sandbox.regress.execute import Processes, Serial

    if options.executor == "ray":
        from sandbox.regress.cluster import Cluster

        return Cluster(options.workers, options.address)
    return Serial() if options.executor == "serial" else Processes(options.workers)


def _compared_with(
    options: RegressOptions, plan: RegressionPlan, console: Console
) -> Baseline | None:
    """The baseline, where there is one that may be compared with.

    Raises:
        InputError: It may not, and nobody asked to replace it: better told now than after the run.
    """
    if options.baseline is None or (options.update_baseline and not options.baseline.exists()):
        return None
    from sandbox.regress.baseline import load_baseline, replaceable

    if options.update_baseline:
        # What is no baseline is told before the run.
        replaceable(options.baseline)
    try:
        loaded = load_baseline(options.baseline)
        loaded.check(plan.origin(), plan.versions(), options.across_encoders, options.exact)
        loaded.check_seeds(plan.names, plan.seeds)
    except InputError as error:
        if not options.update_baseline:
            raise
        console.print(f"[yellow]not compared: {escape(str(error))}[/]", soft_wrap=True)
        return None
    return loaded


@contextmanager
def _trials_file(
    options: RegressOptions, plan: RegressionPlan, console: Console
) -> Iterator[TrialsFile | None]:
    """The file of trials beside the report; None where no report is written."""
    from sandbox.regress.trials_file import TrialsFile, identity, trials_path

    outputs = (p for p in (options.json, options.junit) if p not in (None, TERMINAL))
    output = next((p for p in outputs if p is not None and (p.is_file() or not p.exists())), None)
    if output is None:
        if options.resume:
            raise InputError(
                "there is nothing to go on from",
                where="--resume",
                expected="the --json FILE of the run, beside which its trials are",
                remedy="Give the same command as that run",
            )
        yield None
        return
    path = trials_path(output)
    with TrialsFile(path, identity(plan, options.vary or ()), options.resume) as kept:
        if kept.set_aside is not None:
            console.print(
                f"[yellow]an earlier run did not finish: its trials are in "
                f"{escape(str(kept.set_aside))}; --resume would have gone on from them[/]",
                soft_wrap=True,
            )
        if options.resume:
            crashed = len(kept.crashed_before)
            again = f"; {crashed} more crashed and are run again" if crashed else ""
            console.print(
                f"{counted(len(kept.trials) - crashed, 'trial')} ended before, in "
                f"{escape(str(path))}{again}",
                soft_wrap=True,
            )
        yield kept


def _part_name(plan: RegressionPlan) -> str:
    """The tasks and the variation of a part of a run, for its progress."""
    return f"{', '.join(plan.names)}, {plan.scene.get('vary') or 'nothing varied'}"


def _run(
    plan: RegressionPlan,
    executor: Executor,
    interrupt: Interrupt,
    kept: TrialsFile | None,
    named: bool = False,
    changed: Callable[[TrialJob], TrialJob] = lambda job: job,
) -> list[Trial]:
    """The trials, those of a resumed run among them; fewer where somebody breaks off.

    Args:
        plan: The trials to run.
        executor: Where they run.
        interrupt: Says whether somebody wants to break off.
        kept: The file that they are written to, if there is one.
        named: They are a part of a run, whose progress names its tasks and its variation.
        changed: Changes every trial.
    """
    from sandbox.regress.console_report import progress_lines

    trials = kept.ended(plan) if kept is not None else []
    ended = {(t["task"], t["seed"]) for t in trials}
    jobs = [*map(changed, plan.jobs())]
    missing = [job for job in jobs if (job.name, job.seed) not in ended]
    what = _part_name(plan) if named else ""
    with (
        suppress(KeyboardInterrupt),
        progress_lines(what, len(jobs), len(trials)) as update,
        interrupt.while_running(),
        closing(executor.run(missing, lambda: interrupt.requested)) as running,
    ):
        for trial in running if missing else ():
            if kept is not None:
                kept.append(plan, trial)
            trials.append(trial)
            update(len(trials), sum(t["success"] for t in trials))
    if len(trials) < len(jobs):
        by = f" by {interrupt.name}" if interrupt.name else ""
        rest = "; the same command with --resume runs the rest" if kept is not None else ""
        where = f"{escape(what)}: " if what else ""
        done = f"{len(trials)} of {counted(len(jobs), 'trial')}"
        Console(stderr=True).print(
            f"[yellow]{where}stopped after {done}{by}{rest}[/]", soft_wrap=True
        )
    return trials


def _repeated(plan: RegressionPlan, executor: Executor, interrupt: Interrupt) -> list[Trial]:
    """Some of a plan's trials with a change that makes nothing harder."""
    from sandbox.regress.detectable_changes import REPEATS, repeated

    again = replace(plan, seeds=plan.seeds[:REPEATS], record=None)
    return _run(again, executor=executor, interrupt=interrupt, kept=None, changed=repeated)


def _show_power(
    options: RegressOptions, plan: RegressionPlan, baseline: Baseline, console: Console
) -> int:
    """Prints what a comparison with a baseline would find, and what it would cost."""
    from sandbox.regress.console_report import show_power
    from sandbox.regress.detectable_changes import power_of
    from sandbox.regress.execute import run_job

    rows = power_of(baseline, plan.names, plan.seeds, plan.time_limits())
    jobs = plan.jobs()[: len(plan.names)]
    # The first trial of a process imports and compiles; later ones show how fast trials are.
    run_job(jobs[0])
    seconds = 0.0
    for job in jobs:
        began = perf_counter()
        simulated = run_job(job)["time_s"]
        pace = (simulated + 1.0) / (perf_counter() - began)
        seconds += sum(row.seconds + row.pairs for row in rows if row.task == job.name) / pace
    minutes = seconds / 60.0
    values = {"power": [row.as_json() for row in rows], "minutes_of_one_core": minutes}
    write_json(options.json, values)
    with printing():
        show_power(rows, minutes, options.workers, console)
    return 0


def _update(
    options: RegressOptions,
    plan: RegressionPlan,
    report: Report,
    repeats: Sequence[Trial],
    console: Console,
) -> bool | None:
    """True if the baseline was made; None where the run broke off."""
    from sandbox.regress.baseline import update

    assert options.baseline is not None
    if not report.complete:
        console.print("[yellow]the baseline stays as it is: the run broke off[/]")
        return None
    if report.crashes.trials:
        console.print("[bold red]no baseline is made from a run with trials that crashed[/]")
        return False
    new = update(options.baseline, plan.origin(), plan.versions(), report.trials, repeats)
    kept = [name for name in new.tasks if name not in plan.names]
    also = f", as they were: {', '.join(kept)}" if kept else ""
    told = f"baseline {options.baseline}: {counted(len(report.trials), 'trial')}{also}"
    console.print(told, markup=False)
    return True


WITHOUT = (
    "baseline",
    "junit",
    "markdown",
    "record",
    "record_all",
    "update_baseline",
    "exact",
    "across_encoders",
    "film_lost",
)
"""Options that mean nothing where trials are varied."""


def check_vary(options: RegressOptions) -> None:
    """Refuses what would fail at the end.

    Raises:
        InputError: An option does not go with another.
    """
    if options.vary is None:
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
    from sandbox.regress.sweep import parse_variations

    if not options.vary:
        raise InputError(
            "--vary needs a quantity", where="--vary", remedy="`--vary size`, for instance"
        )
    parse_variations(options.vary)
    if options.plot is not None:
        from sandbox.figures.variation_plot import check_plot

        check_plot(options.plot)


def run_vary(
    options: RegressOptions,
    plan: RegressionPlan,
    executor: Executor,
    run: Runner,
    console: Console,
) -> bool | None:
    """Runs, prints, draws and writes; whether few enough trials crashed, None if it broke off.

    Args:
        options: Checked.
        plan: Plan of the unvaried trials.
        executor: Its name goes into the report.
        run: Runs a plan's trials.
        console: For people.
    """
    from sandbox.regress.console_report import show_crashes, show_sweep
    from sandbox.regress.sweep import parse_variations, sweep
    from sandbox.system.files import write_whole

    began = perf_counter()
    result = sweep(plan, parse_variations(options.vary or ()), run)
    wall_s = perf_counter() - began
    show_sweep(result, console)
    crashes = result.crashes(options.allow_crashes)
    show_crashes(crashes, console)
    if crashes.trials:
        colour = "bold red" if crashes.too_many else "yellow"
        console.print(f"[{colour}]{escape(crashes.verdict())}[/]", soft_wrap=True)
    if options.json is not None:
        ran: dict[str, Any] = {"executor": executor.name, "workers": options.workers}
        report = {**result.as_json(), "crashes": crashes.as_json(), **ran}
        report["wall_s"] = round(wall_s, 3)
        text = json.dumps(report, indent=1, allow_nan=False)
        if options.json == Path("-"):
            print(text)
        else:
            write_whole(options.json, text + "\n", "--json")
    if options.plot is not None:
        from sandbox.figures.variation_plot import draw, save_plot

        save_plot(draw(result), options.plot)
    return not crashes.too_many if result.complete else None
