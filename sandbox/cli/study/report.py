"""`sandbox study tables` and `report`: makes a study's tables, and a page with its results."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.errors import HandSandboxError, InputError, StudyError
from models.message import counted
from sandbox.cli.study.printing import print_copies, print_losses, sayer


@dataclass(frozen=True, kw_only=True)
class ReportOptions:
    """Writes a page with the results of a study, CSV files and an R script.

    The command makes the tables of the study first. The report reads only these tables, so it can
    also be made from a copy of them. Before the study has ended, the report covers the data so far.
    Needs the extra `study`.

    sandbox study report studies/three-encoders

    sandbox study report studies/three-encoders-pilot --out pilot-report

    sandbox study report studies/three-encoders --measure placement_error_m --measure regrasps
    """

    folder: Annotated[Path, Parameter(metavar="FOLDER")] = field(kw_only=False)
    """Folder of the study, which contains tables/trials.csv."""

    out: Annotated[Path | None, Parameter(metavar="DIR")] = None
    """Folder for the report. Default: FOLDER/report."""

    measure: Annotated[tuple[str, ...], Parameter(metavar="NAME")] = ()
    """Column of trials.csv to compare, like time and success; may be repeated. It is tested unless
    the design names primary outcomes. Columns that are not compared are only described."""


@dataclass(frozen=True, kw_only=True)
class TablesOptions:
    """Makes the tables of a study from its records: FOLDER/tables/*.csv.

    Try: sandbox study tables studies/NAME

    First, missing frames of trials are made by replays. Exit status 1: records are missing or
    changed, and no table was written.
    """

    folder: Annotated[Path, Parameter(metavar="FOLDER")] = field(kw_only=False)
    """Folder of the study, which contains notes/A.jsonl."""

    uxf_names: bool = False
    """Name the first columns as UXF does: experiment, ppid, session_num, trial_num, ..."""


def tables(options: TablesOptions, console: Console) -> int:
    """Runs `sandbox study tables`."""
    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.run.decisions import unsealed
    from sandbox.study.tables.tables import make_tables

    study = StudyFolder.at(options.folder)
    print_copies(study, console)
    if print_losses(study, console):
        console.print("[yellow]until that is decided, the tables are left as they are[/]")
        return 1
    for session in unsealed(study):
        line = f"{session}: no seal; perhaps the notes of its site were not copied"
        console.print(f"[yellow]{line}[/]", highlight=False)
    done = make_tables(study, sayer(console), uxf_names=options.uxf_names, compare=True)
    console.print(
        f"{escape(str(study.path))}: tables of {counted(done['participants'], 'participant')}, "
        f"{counted(done['trials'], 'trial that counts', 'trials that count')}, "
        f"{done['excluded']} excluded"
    )
    return 0


def report(options: ReportOptions, console: Console) -> int:
    """Runs `sandbox study report`."""
    from sandbox.study.report.make import REPORTS, make_report
    from sandbox.study.tables.column import TABLES

    if options.out is not None and options.out.is_file():
        raise InputError("this is a file", where="--out", got=str(options.out), expected="a folder")
    lacking = _bring_up_to_date(options.folder, console)
    if lacking and not (options.folder / TABLES / "trials.csv").is_file():
        raise StudyError(
            "the study has no tables, and they cannot be made",
            where=str(options.folder),
            remedy=lacking,
        )
    with console.status("") as status:
        out = options.out or options.folder / REPORTS
        page = make_report(
            options.folder,
            out,
            options.measure,
            lambda text: status.update(f"[dim]{text}[/]"),
            lambda text: console.print(f"[yellow]{escape(text)}[/]"),
            lacking,
        )
    console.print(
        f"{escape(str(page))}: open it in a browser; tables and analysis.R are in the same folder"
    )
    return 0


def _bring_up_to_date(folder: Path, console: Console) -> str:
    """Makes the tables of a study, unless records of it are lost.

    Returns:
        Sentences on data that the tables do not have; empty if the tables are complete.
    """
    from sandbox.study.record.folder import StudyFolder, is_study
    from sandbox.study.tables.tables import make_tables

    if not is_study(folder):
        return ""
    try:
        study = StudyFolder.at(folder)
        print_copies(study, console)
        if ppids := print_losses(study, console):
            console.print("[yellow]until that is decided, the tables are left as they are[/]")
            return (
                f"Records of {', '.join(ppids)} are missing or changed, so trials may be missing "
                "in this report. Restore the records from a backup, or accept the loss with "
                "`sandbox study note --accept-loss`."
            )
        make_tables(study, sayer(console), compare=True)
    except HandSandboxError as error:
        console.print(f"[yellow]the newest trials are not in the tables: {escape(str(error))}[/]")
        return (
            "The newest trials are missing in this report, because the tables could not be made "
            f"again: {error}."
        )
    return ""
