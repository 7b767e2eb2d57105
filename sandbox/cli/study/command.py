"""`sandbox study`: designs, plans and sessions of user studies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.resources import files
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.errors import StudyError, unknown_name
from models.message import counted
from sandbox.cli.common.command_line import parse
from sandbox.cli.study import data_commands
from sandbox.cli.study.plan_options import PlanOptions, participants_of, say_power
from sandbox.cli.study.recover import RecoverOptions, recover
from sandbox.cli.study.report import ReportOptions, report
from sandbox.cli.study.run import run, say_findings, say_noted, sayer
from sandbox.cli.study.run_options import StudyRunOptions
from sandbox.cli.study.sheet import SheetOptions, sheet

if TYPE_CHECKING:
    from sandbox.study.design.design import Design

FIRST_STEPS = """
First steps:

  sandbox study new design.toml
  sandbox study check design.toml
  sandbox study sheet design.toml
  sandbox study simulate design.toml --out out --participants 2
  sandbox study report out/my-study-simulated

`sandbox study COMMAND --help` explains each command. The page "User studies" of the site explains
the rest; in the repository it is docs/studies.md."""

File = Annotated[Path, Parameter(metavar="DESIGN")]


@dataclass(frozen=True, kw_only=True)
class NewOptions:
    """Writes a template of a design; an existing file is never overwritten."""

    file: File = field(default=Path("design.toml"), kw_only=False)
    """File for the new design."""


@dataclass(frozen=True, kw_only=True)
class CheckOptions:
    """Checks a design and lists every mistake with line and remedy. A mistake: exit status 2."""

    file: File = field(kw_only=False)
    """Design file."""


@dataclass(frozen=True, kw_only=True)
class StudySimulateOptions:
    """Runs a study with simulated participants of different skill and hand size.

    Their data go to a separate folder, NAME-simulated, and every row is marked as simulated.
    """

    file: File = field(kw_only=False)
    """Design file."""

    out: Annotated[Path, Parameter(metavar="DIR")]
    """Folder of studies."""

    participants: Annotated[int | None, Parameter(metavar="N")] = None
    """Number of participants. Default: that of the design."""

    resume: bool = False
    """Continue an earlier run, even if it was interrupted."""

    witness: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """Append the digests of all journals to this file after every session, for `sandbox replay
    STUDY --verify --witness FILE`."""

    force_upgrade: Annotated[str, Parameter(metavar="REASON")] = ""
    """Continue although program, encoder or design have changed; the reason is logged."""


def main(argv: list[str]) -> int:
    """Runs `sandbox study ...`."""
    if not argv or argv[0] in ("-h", "--help"):
        print("usage: sandbox study {" + ",".join(ACTIONS) + "} [--help]\n")
        for name, (options, _) in ACTIONS.items():
            print(f"  {name:<9} {(options.__doc__ or '').splitlines()[0]}")
        print(FIRST_STEPS)
        return 0
    if argv[0] not in ACTIONS:
        raise unknown_name("no such command", argv[0], ACTIONS, where="sandbox study")
    options, action = ACTIONS[argv[0]]
    return action(parse(options, f"sandbox study {argv[0]}", argv[1:]), Console(soft_wrap=True))


def _new(options: NewOptions, console: Console) -> int:
    template = files("sandbox.study.design").joinpath("template.toml").read_bytes()
    try:
        with options.file.open("xb") as file:
            file.write(template)
    except FileExistsError:
        raise StudyError(
            "the file exists already", where=str(options.file), remedy="Choose another name"
        ) from None
    except OSError as error:
        raise StudyError(
            "the file cannot be written", where=str(options.file), got=error.strerror
        ) from None
    console.print(f"{escape(str(options.file))}: edit it, then `sandbox study check`")
    return 0


def _load(file: Path) -> Design:
    from sandbox.study.design.design_file import load_design

    return load_design(file)


def _check(options: CheckOptions, console: Console) -> int:
    from sandbox.study.design.balance import cycle_line
    from sandbox.study.design.checks import findings
    from sandbox.study.design.conditions import combinations
    from sandbox.study.design.design_file import read_draft
    from sandbox.study.design.reading import DesignError

    try:
        design = _load(options.file)
    except DesignError:
        draft = read_draft(options.file)
        say_findings(findings(draft) if draft else [], console)
        raise
    count = sum(1 for _ in combinations(design))
    found = findings(design)
    say_findings(found, console)
    if any(finding.error for finding in found):
        return 2
    console.print(cycle_line(design), highlight=False)
    warnings = f", {len(found)} warnings" if len(found) > 1 else ", 1 warning" if found else ""
    console.print(
        f"[green]{design.name}[/]: no mistakes{warnings}, {count} combinations of levels, all of "
        "which can be run here"
    )
    return 0


def _plan(options: PlanOptions, console: Console) -> int:
    from sandbox.cli.study.plan_table import add_session, own_limits, plan_table
    from sandbox.study.design.plan import duration, session_plan, trials_of

    design = _load(options.file)
    count = participants_of(options.participants, design)
    table = plan_table(design)
    minutes, practice = [], 0
    for number, session in product(range(count), range(1, design.sessions + 1)):
        steps = session_plan(design, number, session)
        minutes.append(duration(design, steps) / 60)
        practice = max(practice, sum(t.practice for t in trials_of(steps)))
        add_session(table, design, number, session, steps, minutes[-1])
    console.print(table)
    console.print(
        f"a session takes about {max(minutes):.0f} min, all of them "
        f"{sum(minutes) / 60:.1f} h; a trial taken as {design.expected:g} s"
        + (f"; {practice} of a session's trials are practice" if practice else "")
    )
    if limits := own_limits(design):
        console.print(limits, highlight=False)
    _say_breaks(design, count, console)
    _say_cycle(design, count, console)
    say_power(design, options, console)
    return 0


def _say_breaks(design: Design, people: int, console: Console) -> None:
    """Prints where breaks come."""
    from sandbox.cli.study.plan_table import break_lines

    for i, line in enumerate(break_lines(design, people)):
        console.print(line, style="yellow" if i else None, highlight=False, markup=False)


def _say_cycle(design: Design, people: int, console: Console) -> None:
    """Prints how many participants a full cycle takes, and what so many leave confounded."""
    from sandbox.cli.study.plan_table import cycle_lines

    whole, *missing = cycle_lines(design, people)
    console.print(whole, highlight=False)
    for line in missing:
        console.print(f"[yellow]{escape(line)}[/]", highlight=False)


def _simulate(options: StudySimulateOptions, console: Console) -> int:
    from sandbox.study.design.checks import findings
    from sandbox.study.record.folder import SIMULATED, StudyFolder
    from sandbox.study.run.simulate import simulate

    design = _load(options.file)
    count = participants_of(options.participants, design)
    say_findings(findings(design), console)
    study = StudyFolder(options.out, design, SIMULATED, options.force_upgrade)
    say_noted(study, sayer(console))
    done = simulate(study, count, options.resume, sayer(console), options.witness)
    console.print(
        f"{escape(str(study.path))}: {counted(done['participants'], 'simulated participant')}, "
        f"{counted(done['trials'], 'trial that counts', 'trials that count')}, "
        f"{done['excluded']} excluded"
    )
    return 0


ACTIONS: dict[str, tuple[Any, Callable[[Any, Console], int]]] = {
    "new": (NewOptions, _new),
    "check": (CheckOptions, _check),
    "plan": (PlanOptions, _plan),
    "sheet": (SheetOptions, sheet),
    "run": (StudyRunOptions, run),
    "simulate": (StudySimulateOptions, _simulate),
    "report": (ReportOptions, report),
    "recover": (RecoverOptions, recover),
    **data_commands.ACTIONS,
}
"""Action -> its options and what it does."""
