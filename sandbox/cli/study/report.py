"""`sandbox study report`: what a study found, as one page with its tables and an R script."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console
from rich.markup import escape

from models.errors import HandSandboxError, InputError


@dataclass(frozen=True)
class ReportOptions:
    """Makes a page of a study's results, with CSVs and an R script beside it.

    Reads nothing but the CSVs in the study's folder, so any copy of it will do, at any time: before
    the study has ended, the report is about what there is. Needs the extra `study`.

    sandbox study report studies/three-encoders

    sandbox study report studies/three-encoders-pilot --out pilot-report

    sandbox study report studies/three-encoders --measure placement_error_m --measure regrasps
    """

    folder: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FOLDER")]
    """The study's: where its trial_results.csv is."""

    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    """Where the report goes; FOLDER/report unless told otherwise."""

    measure: Annotated[
        tyro.conf.UseAppendAction[tuple[str, ...]], tyro.conf.arg(metavar="NAME")
    ] = ()
    """A column of trial_results.csv that is compared like completion time and success; may be
    repeated. All others are described and not tested."""


def report(options: ReportOptions, console: Console) -> int:
    """Makes the report and says where it is."""
    from sandbox.study.report.make import make_report

    if options.out is not None and options.out.is_file():
        raise InputError("this is a file", where="--out", got=str(options.out), expected="a folder")
    _bring_up_to_date(options.folder, console)
    with console.status("") as status:
        out = options.out or options.folder / "report"
        page = make_report(
            options.folder, out, options.measure, lambda text: status.update(f"[dim]{text}[/]")
        )
    console.print(f"{escape(str(page))}: open it in a browser; tables and analysis.R are beside it")
    return 0


def _bring_up_to_date(folder: Path, console: Console) -> None:
    """Makes the tables anew where a program was killed in the middle of a session."""
    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.tables.tables import rebuild_study, tables_are_outdated

    if not tables_are_outdated(folder):
        return
    try:
        rebuild_study(StudyFolder.at(folder), console.print)
    except HandSandboxError as error:
        console.print(f"[yellow]the newest trials are not in the tables: {escape(str(error))}[/]")
    else:
        console.print("[dim]the tables were made anew: some journals were newer[/]")
