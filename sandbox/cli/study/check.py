"""`sandbox study new` and `check`: writes a template of a design, and checks a design."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.message import counted
from sandbox.cli.study.printing import say_findings

File = Annotated[Path, Parameter(metavar="DESIGN")]


@dataclass(frozen=True, kw_only=True)
class NewOptions:
    """Writes a template of a design; an existing file is never overwritten."""

    file: File = field(default=Path("design.toml"), kw_only=False)
    """File for the new design."""


@dataclass(frozen=True, kw_only=True)
class CheckOptions:
    """Checks form and numbers of a design, and lists every mistake with line and remedy.

    Exit status 2: there is a mistake. The meaning of texts is not checked: print `sandbox study
    sheet`, and have people read it.
    """

    file: File = field(kw_only=False)
    """Design file."""


def new(options: NewOptions, console: Console) -> int:
    """Runs `sandbox study new`."""
    from sandbox.study.record.durable_files import write_new

    template = files("sandbox.study.design").joinpath("template.toml").read_bytes()
    write_new(options.file, template)
    console.print(f"{escape(str(options.file))}: edit it, then `sandbox study check`")
    return 0


def check(options: CheckOptions, console: Console) -> int:
    """Runs `sandbox study check`."""
    from sandbox.study.design.balance import cycle_line
    from sandbox.study.design.checks import UNREAD, findings
    from sandbox.study.design.conditions import combinations
    from sandbox.study.design.design_file import load_design
    from sandbox.study.design.power import power_lines

    design = load_design(options.file)
    count = sum(1 for _ in combinations(design))
    found = findings(design)
    say_findings(found, console)
    for line in (cycle_line(design), *power_lines(design, design.participants)):
        console.print(line, highlight=False, markup=False)
    errors = sum(finding.error for finding in found)
    said = f"{counted(errors, 'error')}, so `run` refuses real participants"
    console.print(
        f"[{'red' if errors else 'green'}]{design.name}[/]: {said if errors else 'no mistakes'}, "
        f"{counted(len(found) - errors, 'warning')}, {count} combinations of levels, all of which "
        "can be run here",
        highlight=False,
    )
    console.print(UNREAD, highlight=False, markup=False)
    return 2 if errors else 0
