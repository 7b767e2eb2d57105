"""`sandbox study report`: the results of a study, as a page with tables and an R script."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.errors import HandSandboxError, InputError
from sandbox.cli.study.recover import tell_losses


@dataclass(frozen=True, kw_only=True)
class ReportOptions:
    """Writes a page with the results of a study, CSV files and an R script.

    It reads only the CSV files in the study's folder, so that it also works on a copy. Before the
    study has ended, the report covers the data so far. Needs the extra `study`.

    sandbox study report studies/three-encoders

    sandbox study report studies/three-encoders-pilot --out pilot-report

    sandbox study report studies/three-encoders --measure placement_error_m --measure regrasps
    """

    folder: Annotated[Path, Parameter(metavar="FOLDER")] = field(kw_only=False)
    """Folder of the study, which contains trial_results.csv."""

    out: Annotated[Path | None, Parameter(metavar="DIR")] = None
    """Folder for the report. Default: FOLDER/report."""

    measure: Annotated[tuple[str, ...], Parameter(metavar="NAME")] = ()
    """Column of trial_results.csv that is compared like completion time and success; may be
    repeated. It is tested unless the design names primary outcomes. All other columns are described
    only."""


def report(options: ReportOptions, console: Console) -> int:
    """Runs `sandbox study report`."""
    from sandbox.study.report.make import make_report

    if options.out is not None and options.out.is_file():
        raise InputError("this is a file", where="--out", got=str(options.out), expected="a folder")
    lacking = _bring_up_to_date(options.folder, console)
    with console.status("") as status:
        out = options.out or options.folder / "report"
        page = make_report(
            options.folder,
            out,
            options.measure,
            lambda text: status.update(f"[dim]{text}[/]"),
            lambda text: console.print(f"[yellow]{escape(text)}[/]"),
            lacking,
        )
    console.print(f"{escape(str(page))}: open it in a browser; tables and analysis.R are beside it")
    return 0


def _bring_up_to_date(folder: Path, console: Console) -> str:
    """Rebuilds outdated tables, as after a program was killed during a session.

    Tables that have more than a journal are left as they are.

    Returns:
        What the tables lack, in sentences; empty if they are whole.
    """
    from sandbox.study.record.folder import STUDY_JOURNAL, StudyFolder
    from sandbox.study.tables.tables import rebuild_closed, rebuild_study, tables_are_outdated

    if not (folder / STUDY_JOURNAL).exists():
        return ""
    try:
        study = StudyFolder.at(folder)
        if ppids := tell_losses(study, console):
            console.print("[yellow]until that is decided, the tables are left as they are[/]")
            return (
                f"Records of {', '.join(ppids)} are lost, and nobody has decided about them: some "
                "trials may be missing here. `sandbox study recover` shows them."
            )
        if not tables_are_outdated(folder):
            return ""
        rebuild_closed(study)
        rebuild_study(study, console.print)
    except HandSandboxError as error:
        console.print(f"[yellow]the newest trials are not in the tables: {escape(str(error))}[/]")
        return "The newest trials are missing here, because the tables could not be rebuilt."
    console.print("[dim]the tables were rebuilt, since some journals were newer[/]")
    return ""
