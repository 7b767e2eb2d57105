"""Creates the report of a study: `report.html`, the CSV files and the R script."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from models.errors import StudyError
from models.message import counted
from sandbox.study.record.files import make_folder, write_atomically
from sandbox.study.record.folder import REPORT

SCRIPT = "analysis.R"
NEEDS = ("pandas", "statsmodels", "matplotlib", "jinja2")


def make_report(
    folder: Path,
    out: Path,
    measures: Sequence[str] = (),
    say: Callable[[str], object] = lambda text: None,
    note: Callable[[str], object] = lambda text: None,
    lacking: str = "",
) -> Path:
    """Creates a report.

    Args:
        folder: Folder of the study, or of a copy of its tables.
        out: Folder of the report, created if needed.
        measures: Names of measures to compare besides time and success.
        say: Callback for progress messages.
        note: Callback for lines that the reader of the report must know.
        lacking: What the tables lack, in sentences for the top of the page.

    Returns:
        Path of the page.

    Raises:
        StudyError: A table is missing or damaged, a measure is unknown, a library is missing, or a
            file cannot be written.
    """
    check_libraries()
    from sandbox.study.report.models.analysis import analyse
    from sandbox.study.report.models.data import load_study
    from sandbox.study.report.out_tables import tables
    from sandbox.study.report.page.page import page
    from sandbox.study.report.script import script

    say("reading the tables")
    data = load_study(folder)
    for line in (*data.upgrades, *data.kept, *data.clock_steps):
        note(line)
    if data.withdrawn:
        note(data.withdrawals)
    if data.rehearsed:
        note(data.rehearsed)
    say(
        f"models of {counted(len(data.used), 'trial')} of {counted(len(data.ppids), 'participant')}"
    )
    analysis = analyse(data, measures)
    make_folder(out)
    say("plots and tables")
    for name, content in tables(analysis).items():
        write_atomically(out / name, content, durable=False)
    write_atomically(out / SCRIPT, script(analysis).encode(), durable=False)
    write_atomically(out / REPORT, page(analysis, lacking).encode(), durable=False)
    return out / REPORT


def check_libraries() -> None:
    """Checks that the libraries of the report are installed.

    Raises:
        StudyError: A library is missing; the error names the extra to install.
    """
    from importlib.util import find_spec

    missing = [name for name in NEEDS if find_spec(name) is None]
    if missing:
        raise StudyError(
            "the report needs more libraries",
            got=", ".join(missing),
            expected="the extra `study`",
            remedy="pip install 'hand-sandbox[study]'",
        )
