"""`sandbox evaluate --paalm simulated|FOLDER`: how well PAALM reconstructs hands."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.progress import Progress

from models.errors import InputError
from sandbox.cli.common.command_line import parse
from sandbox.cli.common.json_out import check_output, refuse_replacing, write_json
from sandbox.evaluation.paalm_evaluation import (
    judge_folder,
    judge_simulated,
    show_judgements,
)

SCHEMA = 1
SIMULATED = "simulated"


@dataclass(frozen=True, kw_only=True)
class PaalmJudgeOptions:
    """Measures PAALM (paper of 2013) for every recording: angles, finger labels, jitter and time.

    simulated: a simulated Leap sees simulated hands, with and without drop-outs, and also as joints
    (v3). The frozen configuration determines the people. FOLDER: recordings. Their ground truth is
    either the bones that the device reports, if PIP and DIP are independent (in v2 they are equal
    by construction), or the poses that `sandbox devices leap simulate` wrote beside the frames.
    Recordings of the first software have no ground truth: poses that are impossible for a real hand
    are counted, once with the whole recording known and once as for a live device. The method as
    printed in the paper is measured only on the device of the paper.

    Try: sandbox evaluate --paalm simulated --takes 4 --json out.json
    """

    paalm: Annotated[str, Parameter(metavar="simulated|FOLDER")]
    """Data: simulated hands, or a folder of recordings."""

    json: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """File for all numbers as JSON; - is the terminal."""

    takes: int = 8
    """Number of simulated people, 30 seconds each."""


def main(argv: list[str]) -> int:
    """Runs `sandbox evaluate --paalm ...`."""
    options = parse(PaalmJudgeOptions, "sandbox evaluate", argv)
    if options.takes < 1:
        raise InputError(
            "too few simulated people", where="--takes", got=options.takes, expected="1 or more"
        )
    check_output(options.json)
    if options.paalm != SIMULATED:
        refuse_replacing(options.json, {"--paalm": Path(options.paalm)}, "--json")
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        job = bar.add_task("judging", total=1.0)

        def show_progress(share: float) -> None:
            bar.update(job, completed=share)

        if options.paalm == SIMULATED:
            judgements = judge_simulated(options.takes, show_progress)
        else:
            judgements = judge_folder(Path(options.paalm), show_progress)
    judgements = {"schema": SCHEMA, **judgements}
    show_judgements(judgements)
    write_json(options.json, judgements)
    return 0
