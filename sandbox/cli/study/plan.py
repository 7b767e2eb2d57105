"""`sandbox study plan` and `sheet`: the sessions of participants, before the study begins."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.table import Table

from models.errors import InputError

if TYPE_CHECKING:
    from sandbox.study.design.design import Design


@dataclass(frozen=True, kw_only=True)
class PlanOptions:
    """Shows the order of conditions for each participant, and how long sessions take.

    sandbox study plan design.toml --power --detect 0.5

    sandbox study plan design.toml --markdown > preregistration.md
    """

    file: Annotated[Path, Parameter(metavar="DESIGN")] = field(kw_only=False)
    """Design file."""

    participants: Annotated[int | None, Parameter(metavar="N")] = None
    """Number of participants. Default: the number in the design."""

    power: bool = False
    """Show the differences that a study with this number of participants can detect."""

    detect: Annotated[float | None, Parameter(metavar="SD")] = None
    """With --power: a difference, in standard deviations. Show how many participants are needed to
    detect it."""

    markdown: bool = False
    """Print design, orders, people, exclusions and tests as a text for a preregistration."""


@dataclass(frozen=True, kw_only=True)
class SheetOptions:
    """Prints a participant's session, step by step: texts, questions, practice, trials, breaks.

    Nothing is run or recorded. The steps and texts are the same as in the session.

    sandbox study sheet design.toml

    sandbox study sheet design.toml --participant-number 2 --out sheet.html
    """

    file: Annotated[Path, Parameter(metavar="DESIGN")] = field(kw_only=False)
    """Design file."""

    participant_number: Annotated[int, Parameter(metavar="N")] = 1
    """Number of the participant in order of arrival, from 1. It determines the orders of levels."""

    language: str = ""
    """Language of the participant. Default: the first language of the design."""

    out: Annotated[Path | None, Parameter(metavar="FILE.html")] = None
    """Write an HTML page for printing instead. An existing file is never overwritten."""


def participants_of(asked: int | None, design: Design) -> int:
    """The number of participants in the options, or in the design if the options have none.

    Raises:
        InputError: The number is below 1.
    """
    if asked is None:
        return design.participants
    if asked < 1:
        raise InputError(
            "the number of participants is too small",
            where="--participants",
            got=asked,
            expected="1 or more",
        )
    return asked


def plan(options: PlanOptions, console: Console) -> int:
    """`sandbox study plan`."""
    from sandbox.study.design.design_file import load_design
    from sandbox.study.design.plan_text import cycle_lines, order_rows, plan_markdown, session_lines
    from sandbox.study.design.power import power_lines

    _check(options)
    design = load_design(options.file)
    people = participants_of(options.participants, design)
    if options.markdown:
        print(plan_markdown(design, people))
        return 0
    heads, *rows = order_rows(design, people)
    table = Table(*heads)
    for row in rows:
        table.add_row(*row)
    console.print(table)
    lines = [*session_lines(design, people), *cycle_lines(design, people)]
    if options.power:
        lines += power_lines(design, people, options.detect)
    for line in lines:
        console.print(line, highlight=False, markup=False)
    return 0


def _check(options: PlanOptions) -> None:
    if options.detect is None:
        return
    if not 0.0 < options.detect < 10.0:
        raise InputError(
            "this difference is out of range",
            where="--detect",
            got=options.detect,
            expected="a number of standard deviations above 0 and below 10",
        )
    if not options.power:
        raise InputError(
            "this option needs --power", where="--detect", remedy="Add --power, or leave it out"
        )


def sheet(options: SheetOptions, console: Console) -> int:
    """`sandbox study sheet`."""
    from sandbox.study.design.design_file import load_design
    from sandbox.study.run.sheet import session_sheet, sheet_lines, sheet_page

    if options.out is not None and options.out.suffix != ".html":
        raise InputError(
            "this is not the name of an HTML file",
            where="--out",
            got=str(options.out),
            expected="FILE.html",
        )
    design = load_design(options.file)
    sheets = [
        session_sheet(design, options.participant_number, number, options.language)
        for number in range(1, design.sessions + 1)
    ]
    if options.out is not None:
        from sandbox.study.record.durable_files import write_new

        write_new(options.out, sheet_page(sheets).encode())
        console.print(f"{options.out}: open it in a browser, and print it there", markup=False)
        return 0
    for i, one in enumerate(sheets):
        for line in ("", *sheet_lines(one)) if i else sheet_lines(one):
            console.print(line, markup=False, highlight=False)
    return 0
