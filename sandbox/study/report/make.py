"""Creates the report of a study: the page, its numbers as CSV files, and a script for R."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

from models.errors import StudyError
from models.message import counted

REPORTS = "report"
"""Folder of a study with its report."""
PAGE = "report.html"
"""Name of the page."""
SCRIPT, OF_SCRIPT = "analysis.R", "results_R.csv"
"""The R script next to the page, and its output."""
SCRIPT_COLUMNS = (
    *("outcome", "factor", "first", "second", "model", "kind"),
    *("estimate", "low", "high", "p"),
)
"""Columns of the script's output."""
NEEDS = ("pandas", "matplotlib", "jinja2")
"""Libraries that a report needs, and which the core of the program does not."""
RESULTS = (
    ("outcome", "column of trials.csv, or name of a questionnaire"),
    (
        "scale",
        "limit: a time, which is the time limit without success; share: 0 or 1; count; log: "
        "compared by ratios; plain: any other number; score: of a questionnaire",
    ),
    ("unit", "unit of the outcome; shares are from 0 to 1"),
    (
        "row",
        "condition or level: a mean over people; pair: second level compared with the first; "
        "interaction: difference of two such differences; further: a mean of an outcome that is "
        "not compared",
    ),
    ("factor", "factor of the levels"),
    ("first", "condition, level, or the first level of a pair, which is the reference"),
    ("second", "second level of a pair"),
    ("kind", "difference or ratio, of the second level to the first; empty for means"),
    ("people", "number of people"),
    ("trials", "number of trials; empty for pairs"),
    ("estimate", "mean, difference or ratio"),
    ("low", "lower end of the 95 % interval; empty below six people"),
    ("high", "upper end of this interval"),
    (
        "sd",
        "standard deviation over people of the difference, or, for ratios, of its logarithm; for "
        "two groups, the standard deviation within groups",
    ),
    ("dz", "difference divided by sd; for two groups, Cohen's d"),
    ("median", "median over people of the difference, or ratio"),
    ("role", "confirmatory: tested; exploratory: not tested"),
    ("test", "name of the test"),
    ("p", "p value of this test, not adjusted"),
    ("p_holm", "p value adjusted for all tests of the study (Holm)"),
)
"""Columns of `results.csv`, with their meanings."""
PEOPLE = (
    ("ppid", "pseudonym"),
    ("outcome", "as in results.csv"),
    ("condition", "as in trials.csv"),
    ("mean", "mean over this person's trials; geometric for logarithmic outcomes"),
    ("trials", "number of trials"),
)
"""Columns of `people.csv`."""

Row = dict[str, Any]


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
        folder: Folder of the study, or of a copy that has its tables.
        out: Folder of the report, created if needed.
        measures: Names of measures to compare besides time and success.
        say: Callback for progress messages.
        note: Callback for lines that the reader of the report should know.
        lacking: Sentences on data that the tables do not have, for the top of the page.

    Returns:
        Path of the page.

    Raises:
        StudyError: A table is missing or damaged, a measure is unknown, a library is missing, or a
            file cannot be written.
    """
    check_libraries()
    from sandbox.study.report.data import load_study
    from sandbox.study.report.numbers import results
    from sandbox.study.report.page import page

    say("reading the tables")
    data = load_study(folder)
    for line in (*data.upgrades, *data.without_frames, *data.clock_steps):
        note(line)
    if data.withdrawn:
        note(data.withdrawals)
    if data.rehearsed:
        note(data.rehearsed)
    say(f"{counted(len(data.used), 'trial')} of {counted(len(data.ppids), 'participant')}")
    found = results(data, measures)
    script = files("sandbox.study.report").joinpath(SCRIPT).read_bytes()
    text = page(found, lacking, read_script_rows(out / OF_SCRIPT))
    for name, content in {**tables(found), SCRIPT: script, PAGE: text.encode()}.items():
        try:
            out.mkdir(parents=True, exist_ok=True)
            (out / name).write_bytes(content)
        except OSError as error:
            raise StudyError(
                "the report cannot be written",
                where=str(out / name),
                got=error.strerror,
                remedy="Free disk space or give write permission",
            ) from None
    return out / PAGE


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


def read_script_rows(path: Path) -> list[dict[str, str]]:
    """Rows that `analysis.R` has written; empty if it has not run."""
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def tables(found: Any) -> dict[str, bytes]:
    """Contents of the report's CSV files, by name.

    Args:
        found: `Results` of a study.
    """
    book = [
        {"file": file, "column": name, "meaning": meaning}
        for file, columns in (("results.csv", RESULTS), ("people.csv", PEOPLE))
        for name, meaning in columns
    ]
    return {
        "results.csv": csv_of(_rows(found), [name for name, _ in RESULTS]),
        "people.csv": csv_of(_people(found), [name for name, _ in PEOPLE]),
        "codebook.csv": csv_of(book, ["file", "column", "meaning"]),
    }


def _rows(found: Any) -> Iterator[Row]:
    """Rows of `results.csv`."""
    from sandbox.study.report.numbers import mean_of
    from sandbox.study.report.page import further

    for one in found.compared:
        what = one.what
        head = {"outcome": what.name, "scale": what.scale, "unit": what.unit, "role": one.role}
        for name, means in (("", one.cells), *one.levels.items()):
            for mean in means:
                kind = {"row": "level" if name else "condition", "factor": name}
                numbers = {"people": mean.people, "trials": mean.trials}
                yield {**head, **kind, "first": mean.name, **numbers, **_ends(mean.mean)}
        for pair in one.pairs:
            yield {**head, "row": "pair", **vars(pair), **_ends(pair.estimate)}
        for name, estimate, people in one.interactions:
            kind = {"row": "interaction", "first": name, "people": people, "role": "exploratory"}
            yield {**head, **kind, **_ends(estimate)}
    for what, values in further(found):
        head = {"outcome": what.name, "scale": what.scale, "unit": what.unit, "row": "further"}
        for i, name in enumerate(values.names):
            mean = mean_of(what, values, name, [i])
            numbers = {"people": mean.people, "trials": mean.trials}
            yield {**head, "first": name, **numbers, **_ends(mean.mean)}


def _ends(estimate: Any) -> Row:
    return {"estimate": estimate.value, "low": estimate.low, "high": estimate.high}


def _people(found: Any) -> Iterator[Row]:
    """Rows of `people.csv`."""
    from sandbox.study.report.numbers import Estimate

    for one in found.compared:
        for i, ppid in enumerate(found.data.ppids):
            for j, name in enumerate(one.values.names):
                if one.values.trials[i, j]:
                    mean = one.what.in_unit(Estimate(float(one.values.means[i, j]))).value
                    yield {
                        "ppid": ppid,
                        "outcome": one.what.name,
                        "condition": name,
                        "mean": mean,
                        "trials": int(one.values.trials[i, j]),
                    }


def csv_of(rows: Any, columns: Sequence[str]) -> bytes:
    """A table as CSV, with ten significant digits of every number and empty unknown values."""
    import pandas as pd

    cells = [{k: _cell(v) for k, v in row.items() if k in columns} for row in rows]
    frame = pd.DataFrame(cells, columns=list(columns), dtype=object)
    text: str = frame.to_csv(index=False, lineterminator="\n")
    return text.encode()


def _cell(value: Any) -> Any:
    import numpy as np

    if isinstance(value, bool | np.bool_):
        return int(value)
    if not isinstance(value, float):
        return value
    # Digits after the tenth may differ between machines.
    return float(f"{value:.10g}") if np.isfinite(value) else None
