"""`sandbox evaluate`: measures encoders as the paper of 2015 does, as text, JSON and pictures.

With --paalm, it measures how well PAALM, the method of the paper of 2013, reconstructs hands.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.progress import Progress, TaskID

from models.errors import HandSandboxError, InputError
from sandbox.cli.common.command_line import parse
from sandbox.cli.common.json_out import check_output, refuse_replacing, write_json

if TYPE_CHECKING:
    from encoders.captures.subject.subject import Subject

BUILTIN = "builtin"
PAALM_SIMULATED = "simulated"
PAALM_SCHEMA = 1


@dataclass(frozen=True, kw_only=True)
class EvaluateOptions:
    """Measures how well encoders reconstruct the hand and label its fingers: Tables 1 and 2 of the
    paper of 2015, its Copas test, smoothness, fingertip errors, joint limits and time.

    Encoders: linear, quadratic, cubic (least squares, as in the paper), paper (the same as
    quadratic), pca-ik (inverse kinematics), mean (the mean pose), trained (the encoder that
    `sandbox train` makes from the training data, with the built-in labeller), FILE.npz (a model by
    `sandbox train`), or FILE.py:CLASS (an encoder of your own, docs/write-an-encoder.md).

    Without --capture, encoders are trained on day 0 of a SIMULATED person and tested on other days
    of the same person. --days is their number, and --day-seed chooses them. This gives smaller
    errors than in use, where the hand is that of another person: docs/encoding.md has the errors
    for other people. docs/evaluation.md defines all measures.

    Try:

        sandbox evaluate --encoders linear quadratic trained --days 1
        sandbox evaluate --days 5 --json out.json --plots pictures

    PAALM, the method of the paper of 2013, is measured by another form of the command:
    sandbox evaluate --paalm simulated|FOLDER [--json OUT]
    """

    encoders: Annotated[
        tuple[str, ...], Parameter(metavar="NAME|FILE|FILE.py:CLASS", consume_multiple=True)
    ] = (
        "linear",
        "quadratic",
        "cubic",
        "pca-ik",
        "mean",
        "trained",
    )
    """Encoders to evaluate."""

    capture: Annotated[
        tuple[str, ...], Parameter(metavar="builtin|FILE|DIR|LIST", consume_multiple=True)
    ] = ()
    """Test captures. builtin, the default: the simulated subject's test days. FILE: a capture. DIR:
    a folder of captures. LIST: a text file (.txt) with one capture per line. May be repeated."""

    train: Annotated[str, Parameter(metavar="own|split|FILE")] = BUILTIN
    """Training data. own or builtin: day 0 of the simulated subject. FILE: a capture. split: four
    fifths of the takes of the single --capture FILE; the other fifth is the test data."""

    days: int = 3
    """Number of test days."""

    day_seed: int = 0
    """Seed that chooses the test days."""

    json: Annotated[Path | None, Parameter(metavar="OUT")] = None
    """File for all numbers as JSON; - is the terminal."""

    plots: Annotated[Path | None, Parameter(metavar="DIR")] = None
    """Folder for pictures of the tables and hands, as PNG and SVG; needs the extra `plots`."""

    copas: Annotated[bool, Parameter(negative="--no-copas")] = True
    """Run the Copas test, which trains every encoder twenty more times."""


@dataclass(frozen=True, kw_only=True)
class PaalmJudgeOptions:
    """Measures PAALM (paper of 2013) for every recording: angles, finger labels, jitter and time.

    simulated: a simulated Leap sees simulated hands, with and without drop-outs, and also as joints
    (v3). The frozen configuration determines the people. FOLDER: recordings. Their ground truth is
    either the bones that the device reports, if PIP and DIP are independent (in v2 they are equal
    by construction), or the poses that `sandbox devices leap simulate` wrote beside the frames.
    Recordings of the first software have no ground truth. In these recordings, the poses that are
    impossible for a real hand are counted in two ways: with the whole recording known, and as for a
    live device. The method as printed in the paper is measured only on the device of the paper.

    Try: sandbox evaluate --paalm simulated --takes 4 --json out.json
    """

    paalm: Annotated[str, Parameter(metavar="simulated|FOLDER")]
    """Data: simulated hands, or a folder of recordings."""

    json: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """File for all numbers as JSON; - is the terminal."""

    takes: int = 8
    """Number of simulated people, 30 seconds each."""


def main(argv: list[str]) -> int:
    """Runs `sandbox evaluate ...`."""
    if any(a == "--paalm" or a.startswith("--paalm=") for a in argv):
        # The paper of 2013 has other inputs and other tables.
        return judge_paalm(parse(PaalmJudgeOptions, "sandbox evaluate", argv))
    try:
        options = parse(EvaluateOptions, "sandbox evaluate", argv)
    except SystemExit:
        # `--help` shows the options of both forms of the command.
        print("\nWith --paalm:\n", flush=True)
        parse(PaalmJudgeOptions, "sandbox evaluate", ["--help"])
        raise
    from encoders.captures.subject.subject import first_subject

    return measure(options, first_subject())


def measure(options: EvaluateOptions, person: Subject) -> int:
    """Measures encoders, prints and writes the report.

    Args:
        options: Options of the command.
        person: The simulated subject of `--capture builtin` and `--train own`.

    Returns:
        Exit status: 2 if an encoder failed and was left out.

    Raises:
        InputError: An option names an unknown encoder or capture, or a result cannot be written.
    """
    _check(options)
    from encoders.evaluation.measure_method import MethodResult, Tests, evaluate_method
    from encoders.evaluation.methods import check_names
    from encoders.evaluation.result_values import report
    from encoders.regression.encoder_registry import ENCODER_PLUGINS, is_external
    from sandbox.evaluation.evaluated_data import gather, refuse_learned
    from sandbox.evaluation.printed_tables import show

    check_names(options.encoders)
    console = Console()
    console = Console(width=max(console.width, 110))
    with _bars() as progress:
        data = gather(
            list(options.capture) or [BUILTIN],
            BUILTIN if options.train == "own" else options.train,
            person,
            options.days,
            options.day_seed,
            progress,
        )
        refuse_learned(options.encoders, data.tests)
        tests = Tests(data.tests)
        results: dict[str, MethodResult] = {}
        failed: list[tuple[str, HandSandboxError]] = []
        for name in options.encoders:
            bar = progress.add_task(f"{name}: training", total=1.0)
            shown = partial(_show, progress, bar)
            learned = data.training.capture if options.copas else None
            try:
                method = data.training.method(name, shown)
                progress.update(bar, description=method.name, completed=0.0)
                external = is_external(name)
                guard = ENCODER_PLUGINS.guarded(name, "the encoder fails")
                with guard if external else nullcontext():
                    results[method.name] = evaluate_method(method, tests, learned, shown)
            except HandSandboxError as error:
                failed.append((name, error))
            progress.update(bar, completed=1.0)
        if not results:
            raise failed[0][1]
        document = report(
            results,
            tests,
            data.training.capture,
            {
                "encoders": list(options.encoders),
                "copas": options.copas,
                **data.configuration,
            },
        )
    show(console, document)
    errors = Console(stderr=True)
    for text in data.remarks:
        errors.print(text, markup=False, highlight=False, soft_wrap=True)
    for name, why in failed:
        errors.print(f"{name} was left out: {why}", markup=False, soft_wrap=True)
    write_json(options.json, document, sort_keys=True)
    if options.plots is not None:
        from sandbox.figures import draw_all

        with _writing(f"--plots {options.plots}"), console.status("drawing"):
            paths = draw_all(options.plots, document, results, tests)
        console.print(f"{len(paths)} pictures in {options.plots}")
    return 2 if failed else 0


def judge_paalm(options: PaalmJudgeOptions) -> int:
    """Measures PAALM, prints and writes the report.

    Args:
        options: Options of the command.

    Returns:
        Exit status.

    Raises:
        InputError: There are no people or recordings, or the report cannot be written.
    """
    if options.takes < 1:
        raise InputError(
            "too few simulated people", where="--takes", got=options.takes, expected="1 or more"
        )
    check_output(options.json)
    if options.paalm != PAALM_SIMULATED:
        refuse_replacing(options.json, {"--paalm": Path(options.paalm)}, "--json")
    from sandbox.evaluation.paalm_evaluation import (
        judge_folder,
        judge_simulated,
        show_judgements,
    )

    with _bars() as bar:
        job = bar.add_task("judging", total=1.0)

        def show_progress(share: float) -> None:
            bar.update(job, completed=share)

        if options.paalm == PAALM_SIMULATED:
            judgements = judge_simulated(options.takes, show_progress)
        else:
            judgements = judge_folder(Path(options.paalm), show_progress)
    judgements = {"schema": PAALM_SCHEMA, **judgements}
    show_judgements(judgements)
    write_json(options.json, judgements)
    return 0


def _check(options: EvaluateOptions) -> None:
    """Checks, before the computation, that the results can be written."""
    if options.days < 1:
        raise InputError("no test day", where="--days", got=options.days, expected="1 or more")
    if options.day_seed < 0:
        raise InputError(
            "no such seed", where="--day-seed", got=options.day_seed, expected="0 or more"
        )
    check_output(options.json)
    named = [Path(place) for place in options.capture]
    named += map(Path, (options.train, *options.encoders))
    refuse_replacing(options.json, {str(path): path for path in named}, "--json")
    if options.plots is not None:
        from sandbox.figures import need_matplotlib

        need_matplotlib()
        with _writing(f"--plots {options.plots}"):
            options.plots.mkdir(parents=True, exist_ok=True)


def _show(progress: Progress, bar: TaskID, share: float) -> None:
    progress.update(bar, completed=share)


@contextmanager
def _bars() -> Iterator[Progress]:
    console = Console(stderr=True)
    # Without a terminal, even hidden bars would leave an empty line.
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        yield progress


@contextmanager
def _writing(where: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(
            "the pictures cannot be written",
            where=where,
            got=str(error),
            remedy="Name another folder",
        ) from error
