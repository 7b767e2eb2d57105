"""`sandbox study`: designs, plans and sessions of user studies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.errors import StudyError, unknown_name
from models.message import counted
from sandbox.cli.common.command_line import parse
from sandbox.cli.study.note import NoteOptions, note
from sandbox.cli.study.plan import PlanOptions, SheetOptions, participants_of, plan, sheet
from sandbox.cli.study.report import ReportOptions, TablesOptions, report, tables
from sandbox.cli.study.run import run, say_findings, say_noted, sayer
from sandbox.cli.study.run_options import StudyRunOptions
from sandbox.cli.study.share import ShareOptions, share

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
    """Checks form and numbers of a design, and lists every mistake with line and remedy.

    A mistake: exit status 2. Texts are not read; print `sandbox study sheet` for those who read
    them.
    """

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

    site: Annotated[str, Parameter(metavar="LETTER")] = "A"
    """Letter of the place of these participants; numbers count at each place by themselves."""

    resume: bool = False
    """Continue an earlier run, even if it was interrupted."""

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
    from sandbox.study.design.checks import UNREAD, findings
    from sandbox.study.design.conditions import combinations
    from sandbox.study.design.power import power_lines

    design = _load(options.file)
    count = sum(1 for _ in combinations(design))
    found = findings(design)
    say_findings(found, console)
    for line in (cycle_line(design), *power_lines(design, design.participants)):
        console.print(line, highlight=False, markup=False)
    errors = sum(finding.error for finding in found)
    said = f"{counted(errors, 'error')}, with which `run` refuses real participants"
    console.print(
        f"[{'red' if errors else 'green'}]{design.name}[/]: {said if errors else 'no mistakes'}, "
        f"{counted(len(found) - errors, 'warning')}, {count} combinations of levels, all of which "
        "can be run here",
        highlight=False,
    )
    console.print(UNREAD, highlight=False, markup=False)
    return 2 if errors else 0


def _simulate(options: StudySimulateOptions, console: Console) -> int:
    from sandbox.study.design.checks import findings
    from sandbox.study.record.folder import SIMULATED, StudyFolder
    from sandbox.study.run.simulate import simulate

    design = _load(options.file)
    count = participants_of(options.participants, design)
    say_findings(findings(design), console)
    study = StudyFolder(options.out, design, SIMULATED, options.force_upgrade, options.site)
    say_noted(study, sayer(console))
    done = simulate(study, count, options.resume, sayer(console))
    console.print(
        f"{escape(str(study.path))}: {counted(done['participants'], 'simulated participant')}, "
        f"{counted(done['trials'], 'trial that counts', 'trials that count')}, "
        f"{done['excluded']} excluded"
    )
    return 0


ACTIONS: dict[str, tuple[Any, Callable[[Any, Console], int]]] = {
    "new": (NewOptions, _new),
    "check": (CheckOptions, _check),
    "plan": (PlanOptions, plan),
    "sheet": (SheetOptions, sheet),
    "run": (StudyRunOptions, run),
    "simulate": (StudySimulateOptions, _simulate),
    "tables": (TablesOptions, tables),
    "report": (ReportOptions, report),
    "share": (ShareOptions, share),
    "note": (NoteOptions, note),
}
"""Action -> its options and what it does."""
