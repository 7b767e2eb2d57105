"""`sandbox regress`: success over many seeds, and its comparison with a baseline."""

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
    """Runs the simulated user over many seeds and reports how often it succeeds. With a baseline,
    tests whether success or time got worse.

    Options of `sandbox run`, such as --bare or `--impulse safe`, are accepted and apply to all
    trials.

    Exit status 0: all trials were run and the gate holds. Trials that fail without a baseline, and
    values of --vary that break a task, do not change this status. 1: a loss of success or time
    beyond chance (exact tests over paired seeds, alpha 0.02, Holm over tasks), more crashed trials
    than --allow-crashes permits, or, with --exact, a state that differs although the fingerprint is
    the baseline's. 2: bad input, reported in one line. 130: stopped by Ctrl-C. 143: stopped by
    SIGTERM.

    With --json or --junit, every trial is written as it ends to a file beside the report, such as
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
    """Tasks to play; `sandbox` lists them. FILE.py: a task of your own."""

    seeds: Annotated[str, Parameter(metavar="A:B")] = "0:40"
    """Seeds from A to B - 1. Commas separate several ranges."""

    arm: Literal["plain", "hard", "both"] = "both"
    """plain: the tasks as they are. hard: the tasks with smaller objects, less room or less
    friction, so that some trials fail. With --vary, always plain."""

    executor: Literal["serial", "processes", "ray"] = "processes"
    """Where trials run: one after another, in processes, or on a Ray cluster (extra `ray`). The
    results are equal to the bit."""

    workers: int = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1
    """Number of trials that run at the same time, one core each."""

    address: Annotated[str | None, Parameter(metavar="ADDRESS")] = None
    """Address of a running Ray cluster."""

    json: Annotated[Path | None, Parameter(metavar="OUT")] = None
    """File for the report with every trial, as JSON; - is the terminal."""

    junit: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """File for the report as JUnit XML, with a test for every task."""

    markdown: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """File for a summary in Markdown, which CI servers can show with a run."""

    baseline: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """Baseline to compare with. A baseline with a different encoder, task version or settings is
    refused."""

    margin: Annotated[
        tuple[str, ...] | None, Parameter(metavar="MEASURE=SHARE", consume_multiple=True)
    ] = None
    """Largest changes of success or time that are accepted, such as time=5% or success=2%. The gate
    fails only if a loss is beyond chance and larger than its margin."""

    update_baseline: bool = False
    """Make the baseline from this run, without a comparison. The first ten seeds of every task are
    played a second time, slightly changed, for --plan."""

    plan: bool = False
    """Only print which changes a comparison with the baseline would detect, and how long the run
    would take."""

    exact: bool = False
    """States must also be equal to the bit, if MuJoCo, architecture and libm are the baseline's."""

    across_encoders: bool = False
    """Accept a baseline of another encoder, to test whether this encoder is worse."""

    vary: Annotated[
        tuple[str, ...] | None,
        Parameter(
            metavar="NAME[=V1,V2]",
            consume_multiple=True,
            help=f"Measure success against {help_with_names(KINDS.values())}: for the given "
            "values, or for harder and harder values until the task breaks. Not with a baseline.",
        ),
    ] = None

    plot: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """File for a plot of the results of --vary, .png or .svg (extra `plots`)."""

    film_lost: Annotated[Path | None, Parameter(metavar="DIR")] = None
    """New or empty folder for films of the trials with the largest changes in each loss. A page in
    the folder shows the film of each trial beside a film by the baseline's program, and has the
    command that makes this second film."""

    record: Annotated[Path | None, Parameter(metavar="DIR")] = None
    """New or empty folder for a recording of every trial that fails."""

    record_all: bool = False
    """With --record: record successful trials, too. `sandbox export` makes data sets of them."""

    resume: bool = False
    """Continue a run that was stopped or killed: only seeds that are missing or crashed are run.
    Repeat the command of that run; different settings, seeds or versions are refused."""

    allow_crashes: Annotated[int, Parameter(metavar="N")] = 0
    """Number of trials of the whole run that may crash: their code raises an error, or their
    process or machine is lost. Each crashed trial counts as a failure."""


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
                "this option does not apply to regression runs",
                got=word,
                expected="options of `sandbox run` that can apply to every trial",
                remedy="--seeds A:B chooses the seeds" if word.startswith("--seed") else None,
            )
    return parse(RegressOptions, "sandbox regress", argv)


def margins(texts: Sequence[str]) -> dict[str, float]:
    """Returns margins (shares) by measure, from texts such as `time=5%`.

    Raises:
        InputError: A measure does not exist or is not part of the gate, or a margin is not a
            percentage from 0 to below 100.
    """
    from sandbox.regress.compared_measures import DECIDING

    found = {}
    for text in texts:
        name, _, amount = text.partition("=")
        if name not in DECIDING:
            raise unknown_name("this measure has no margin", name, DECIDING, where="--margin")
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

    # Here, --vary and --record differ from the options of `sandbox run` with these names.
    given = options.given - {"vary", "record"}
    scene = picked(TrialOptions, options, vary="", record=None, given=given)
    check_labels(scene)
    return {name: getattr(scene, name) for name in given_options(scene)}


def _check(options: RegressOptions) -> None:
    """Checks, before any trial is run, everything that would fail at the end."""
    check_vary(options)
    margins(options.margin or ())
    if not options.tasks:
        raise InputError("no task is named", where="--tasks", remedy="Leave it out, or name one")
    if options.workers < 1:
        raise InputError(
            "too few workers", where="--workers", got=options.workers, expected="1 or more"
        )
    if options.allow_crashes < 0:
        raise InputError(
            "the number of crashes is negative",
            where="--allow-crashes",
            got=options.allow_crashes,
            expected="0 or more",
        )
    if options.record_all and options.record is None:
        raise InputError("no folder is given", where="--record-all", remedy="Add --record DIR")
    if options.baseline is None:
        for name in ("update_baseline", "exact", "across_encoders", "margin", "plan", "film_lost"):
            if getattr(options, name):
                option = "--" + name.replace("_", "-")
                raise InputError("no baseline is given", where=option, remedy="Add --baseline FILE")
    if options.exact and options.across_encoders:
        raise InputError(
            "different encoders never give equal states",
            where="--exact --across-encoders",
            remedy="Leave one of them out",
        )
    if options.across_encoders and options.update_baseline:
        raise InputError(
            "a baseline has the trials of one encoder only",
            where="--across-encoders --update-baseline",
            remedy="Leave one of them out",
        )
    if options.address is not None and options.executor != "ray":
        raise InputError(
            "only --executor ray uses an address",
            where="--address",
            got=f"--executor {options.executor}",
            remedy="Add --executor ray",
        )
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
        raise InputError(
            "the folder cannot be created",
            where=where,
            got=error.strerror,
            remedy="Name another folder",
        ) from None
    if full:
        raise InputError(
            "files in this folder would be mixed with those of this run",
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
    """Loads the baseline; None without one, or if it is replaced and cannot be compared.

    It is checked before the run, so that an error does not cost a whole run.

    Raises:
        InputError: The baseline cannot be compared with this run, and is not to be replaced; or the
            file to be replaced is not a baseline.
    """
    if options.baseline is None or (options.update_baseline and not options.baseline.exists()):
        return None
    from sandbox.regress.baseline import load_baseline, replaceable

    if options.update_baseline:
        # Refuse before the run to overwrite a file that is not a baseline.
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
    """Context with the file of trials beside the report; None if no report is written."""
    from sandbox.regress.trials_file import TrialsFile, identity, trials_path

    outputs = (p for p in (options.json, options.junit) if p not in (None, TERMINAL))
    output = next((p for p in outputs if p is not None and (p.is_file() or not p.exists())), None)
    if output is None:
        if options.resume:
            raise InputError(
                "the run to be resumed is not named",
                where="--resume",
                expected="--json FILE or --junit FILE of that run, whose trials are in a file "
                "beside it",
                remedy="Repeat the command of that run and add --resume",
            )
        yield None
        return
    path = trials_path(output)
    with TrialsFile(path, identity(plan, options.vary or ()), options.resume) as kept:
        if kept.set_aside is not None:
            console.print(
                f"[yellow]an earlier run did not finish. Its trials are now in "
                f"{escape(str(kept.set_aside))}; with --resume, this run would have continued "
                "it[/]",
                soft_wrap=True,
            )
        if options.resume:
            crashed = len(kept.crashed_before)
            again = f"; {counted(crashed, 'crashed trial')} will be repeated" if crashed else ""
            console.print(
                f"{counted(len(kept.trials) - crashed, 'trial')} of the earlier run in "
                f"{escape(str(path))}{again}",
                soft_wrap=True,
            )
        yield kept


def _part_name(plan: RegressionPlan) -> str:
    """Returns the tasks and the variation of a part of a run, as text for the progress."""
    return f"{', '.join(plan.names)}, {plan.scene.get('vary') or 'nothing varied'}"


def _run(
    plan: RegressionPlan,
    executor: Executor,
    interrupt: Interrupt,
    kept: TrialsFile | None,
    named: bool = False,
    changed: Callable[[TrialJob], TrialJob] = lambda job: job,
) -> list[Trial]:
    """Runs the trials of a plan that a resumed run has not played yet.

    Args:
        plan: The trials.
        executor: Executor of the trials.
        interrupt: Requests to stop, by Ctrl-C or SIGTERM.
        kept: File with the trials of a resumed run, to which each new trial is added; None without
            a file.
        named: True if the progress names the tasks and the variation of this part of a run.
        changed: Function that changes a trial before it runs.

    Returns:
        All trials of the plan; fewer if the run was stopped.
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
    """Repeats the first trials of a plan with a change that does not make the task harder."""
    from sandbox.regress.detectable_changes import REPEATS, repeated

    again = replace(plan, seeds=plan.seeds[:REPEATS], record=None)
    return _run(again, executor=executor, interrupt=interrupt, kept=None, changed=repeated)


def _show_power(
    options: RegressOptions, plan: RegressionPlan, baseline: Baseline, console: Console
) -> int:
    """Prints which changes a comparison with a baseline would detect, and its time on one core."""
    from sandbox.regress.console_report import show_power
    from sandbox.regress.detectable_changes import power_of
    from sandbox.regress.execute import run_job

    rows = power_of(baseline, plan.names, plan.seeds, plan.time_limits())
    jobs = plan.jobs()[: len(plan.names)]
    # The first trial in a process is slow, as it imports and compiles: do not measure its time.
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
    """Makes the baseline; returns False if a trial crashed, None if the run is incomplete."""
    from sandbox.regress.baseline import update

    assert options.baseline is not None
    if not report.complete:
        console.print("[yellow]the baseline is not changed: the run was stopped[/]")
        return None
    if report.crashes.trials:
        console.print("[bold red]no baseline is made, since trials of this run crashed[/]")
        return False
    new = update(options.baseline, plan.origin(), plan.versions(), report.trials, repeats)
    kept = [name for name in new.tasks if name not in plan.names]
    also = f"; unchanged tasks: {', '.join(kept)}" if kept else ""
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
"""Options that have no effect with --vary, and are refused."""


def check_vary(options: RegressOptions) -> None:
    """Checks the options that depend on --vary.

    Raises:
        InputError: An option cannot be combined with --vary, or needs it.
    """
    if options.vary is None:
        if options.plot is not None:
            raise InputError(
                "only results of --vary can be plotted", where="--plot", remedy="Add --vary NAME"
            )
        return
    plain = {f.name: f.default for f in fields(options)}
    for name in WITHOUT:
        if getattr(options, name) != plain[name]:
            option = f"--{name.replace('_', '-')}"
            raise InputError(
                "this option cannot be combined with --vary, which compares trials of one run only",
                where=option,
                remedy=f"Leave out {option} or --vary",
            )
    from sandbox.regress.sweep import parse_variations

    if not options.vary:
        raise InputError(
            "--vary needs a quantity", where="--vary", remedy="Name one, such as `--vary size`"
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
    """Runs varied trials, and prints, plots and writes the results.

    Args:
        options: Checked options.
        plan: Plan of the unvaried trials.
        executor: Executor of the trials; the report has its name.
        run: Runs a plan's trials.
        console: Console for messages.

    Returns:
        True if no more trials crashed than are allowed; None if the run was stopped.
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
