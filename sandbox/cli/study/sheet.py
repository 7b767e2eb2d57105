"""`sandbox study sheet`: what a participant will meet, in order, before anybody takes part."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from models.errors import InputError


@dataclass(frozen=True, kw_only=True)
class SheetOptions:
    """Prints what a participant will meet in order: texts, questions, practice, trials, breaks.

    Nothing is run and nothing is written down. The steps and texts are those of the session.

    sandbox study sheet design.toml

    sandbox study sheet design.toml --participant-number 2 --out sheet.html
    """

    file: Annotated[Path, Parameter(metavar="DESIGN")] = field(kw_only=False)
    """Design file."""

    participant_number: Annotated[int, Parameter(metavar="N")] = 1
    """Number of the participant in order of arrival, which determines the orders; from 1, while
    the tables of a study count from 0."""

    language: str = ""
    """Language of the participant. Default: the first one of the design."""

    out: Annotated[Path | None, Parameter(metavar="FILE.html")] = None
    """Write a page to print instead. An existing file is never overwritten."""


def sheet(options: SheetOptions, console: Console) -> int:
    """`sandbox study sheet`."""
    from sandbox.study.design.design_file import load_design
    from sandbox.study.run.sheet import session_sheet, sheet_lines

    if options.out is not None and options.out.suffix != ".html":
        raise InputError(
            "not the name of a page", where="--out", got=str(options.out), expected="FILE.html"
        )
    design = load_design(options.file)
    sheets = [
        session_sheet(design, options.participant_number, number, options.language)
        for number in range(1, design.sessions + 1)
    ]
    if options.out is not None:
        from sandbox.study.record.files import write_new
        from sandbox.study.run.sheet_page import sheet_page

        write_new(options.out, sheet_page(sheets))
        console.print(f"{options.out}: open it in a browser, and print it there", markup=False)
        return 0
    for i, one in enumerate(sheets):
        for line in ("", *sheet_lines(one)) if i else sheet_lines(one):
            console.print(line, markup=False, highlight=False)
    return 0
