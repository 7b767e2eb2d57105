"""Prints the report of `sandbox evaluate`. The paper's numbers are in separate rows, since they are
of another data set."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table

from encoders.evaluation.methods import TRAINED
from encoders.evaluation.paper_results import row
from sandbox.evaluation.evaluated_data import BUILTIN, SPLIT

Report = dict[str, Any]

_PAPER = "  [dim]paper[/]"

_OWN = "trained on this person"
"""Name of the row `trained` if the training data are of the tested person."""


def show(console: Console, report: Report) -> None:
    """Prints a report."""
    report = _with_own_row(report)
    _header(console, report)
    console.print(_table_1(report))
    console.print(_own_labels(report))
    console.print(_table_2(report))
    console.print(_motion(report))
    console.print(_fit(report))
    console.print(_variance(report))
    console.print(
        "[dim]Brackets: 95 % over takes (bootstrap). SEM: the paper's, as if frames were "
        "independent; too small. Rows `paper`: Chung, Kim, Han and Pollard (2015), one real "
        "person; ANOTHER DATA SET. Definitions: docs/evaluation.md[/]",
        soft_wrap=True,
    )


def _with_own_row(report: Report) -> Report:
    """The report, with `trained` renamed to `_OWN` if training data are of the tested person."""
    about = report["configuration"]
    one_day = about["train"] == BUILTIN and not about["captures"]
    if not one_day and about["train"] != SPLIT:
        return report
    encoders = {_OWN if k == TRAINED else k: v for k, v in report["encoders"].items()}
    return {**report, "encoders": encoders}


def _header(console: Console, report: Report) -> None:
    training, tests = report["training"], report["tests"]
    kind = "[bold yellow]SIMULATED[/] captures" if report["simulated"] else "captures"
    console.print(
        f"{kind}. Methods, except models from files, were trained on {training['frames']:,} frames "
        f"of {_source(training)} in {training['takes']} takes.",
        soft_wrap=True,
    )
    for test in tests:
        mark = "" if test["simulated"] else " (not marked as simulated)"
        console.print(
            f"Tested on {test['frames']:,} frames of {_source(test)} in {test['takes']} "
            f"takes{mark}",
            soft_wrap=True,
        )


def _source(capture: dict[str, Any]) -> str:
    name = str(capture.get("file") or capture.get("subject") or "an unnamed subject")
    return f"{name}, day {capture['day']}" if "day" in capture else name


def _table_1(report: Report) -> Table:
    table = Table(title="Table 1: true labels", title_justify="left")
    for column in ("method", "wrist cm", "SEM", "joint angle deg", "SEM", "|component| deg"):
        table.add_column(column, justify="left" if column == "method" else "right")
    paper = report["paper"]["table_1"]
    for name, e in report["encoders"].items():
        table.add_row(
            name,
            _interval(e, "wrist_cm", "true_labels"),
            _number(e["wrist_sem"]["true_labels"], 3),
            _interval(e, "angle_deg", "true_labels"),
            _number(e["angle_sem"]["true_labels"], 3),
            _interval(e, "component_deg", "true_labels"),
        )
        if row(name) in paper:
            wrist, wrist_sem, angle, angle_sem = paper[row(name)]
            table.add_row(
                _PAPER,
                f"{wrist:.2f}",
                f"{wrist_sem:.3f}",
                f"{angle:.2f}",
                f"{angle_sem:.3f}",
                "",
                style="dim",
            )
    return table


def _own_labels(report: Report) -> Table:
    table = Table(title="The same with each method's own labels", title_justify="left")
    for column in ("method", "wrist cm", "SEM", "joint angle deg", "SEM", "|component| deg"):
        table.add_column(column, justify="left" if column == "method" else "right")
    for name, e in report["encoders"].items():
        table.add_row(
            name,
            _interval(e, "wrist_cm", "own_labels"),
            _number(e["wrist_sem"]["own_labels"], 3),
            _interval(e, "angle_deg", "own_labels"),
            _number(e["angle_sem"]["own_labels"], 3),
            _interval(e, "component_deg", "own_labels"),
        )
    return table


def _table_2(report: Report) -> Table:
    title = "Table 2: frames with all fingers labelled correctly, %"
    table = Table(title=title, title_justify="left")
    table.add_column("method")
    for column in ("1 (first)", "1 (stayed)", "2", "3", "4", "5", "2-5"):
        table.add_column(column, justify="right")
    paper = report["paper"]["table_2"]
    for name, e in report["encoders"].items():
        shares = e["labels_percent"]
        table.add_row(
            name,
            *(_number(shares[k], 1) for k in ("1_first", "1", "2", "3", "4", "5")),
            _interval(e, "labels_percent", "all", 1),
        )
        if row(name) in paper:
            table.add_row(_PAPER, "", "", *(f"{x:.1f}" for x in paper[row(name)]), "", style="dim")
    return table


def _motion(report: Report) -> Table:
    table = Table(title="Motion and fingertips, true labels", title_justify="left")
    table.add_column("method")
    for column in (
        "jump at a change\ndeg/frame (largest)",
        "largest joint's\ndeg/frame",
        "wrist jump\ncm (largest)",
        "acceleration\ndeg/s2",
        "tip error\ncm",
        "beyond limits\n%",
    ):
        table.add_column(column, justify="right")
    rows = {"[i]captured[/]": report["truth"]} | report["encoders"]
    for name, e in rows.items():
        table.add_row(
            name,
            f"{_number(e['jump_deg'], 2)} ({_number(e['jump_largest_deg'], 1)})",
            _number(e["joint_jump_largest_deg"], 1),
            f"{_number(e['wrist_jump_cm'], 2)} ({_number(e['wrist_jump_largest_cm'], 1)})",
            _number(e["acceleration_deg_s2"], 0),
            _number(e["tip_cm"], 2),
            _number(100.0 * e["limit_violations"], 2),
        )
    return table


def _fit(report: Report) -> Table:
    tested = any(e["copas"] for e in report["encoders"].values())
    what = "Overfitted joints of 48 (Copas test), and time" if tested else "Time"
    table = Table(title=what, title_justify="left")
    table.add_column("method")
    if tested:
        for column in ("random frames", "clustered", "slope", "whole takes", "clustered", "slope"):
            table.add_column(column, justify="right")
    for column in ("one pose us", "in a batch us"):
        table.add_column(column, justify="right")
    counts, times = report["paper"]["overfitted_joints"], report["paper"]["us_per_pose"]
    for name, e in report["encoders"].items():
        cells: list[str] = []
        for folds in ("random", "blocked") if tested else ():
            test = e["copas"].get(folds)
            if test is None:
                cells += ["", "", ""]
                continue
            joints = test["overfitted_joints"]
            cells += [_number(joints["f_test"], 1), _number(joints["clustered"], 1)]
            cells.append(_number(test["median_slope"], 2))
        table.add_row(
            name, *cells, _number(e["us_per_pose"], 1), _number(e["us_per_pose_batch"], 2)
        )
        known = row(name)
        if known in times or (tested and known in counts):
            figures = [_number(counts.get(known), 1), "", "", "", "", ""] if tested else []
            table.add_row(_PAPER, *figures, _number(times.get(known), 1), "", style="dim")
    return table


def _variance(report: Report) -> Table:
    table = Table(title="Training data's variance in components, %", title_justify="left")
    shares = report["training"]["pca_variance_percent"]
    table.add_column("of")
    for k in shares["pose"]:
        table.add_column(k, justify="right")
    table.add_row("the joints, 42 numbers", *(f"{x:.1f}" for x in shares["joints"].values()))
    table.add_row("the relative pose, 48", *(f"{x:.1f}" for x in shares["pose"].values()))
    paper = report["paper"]["pca_variance_percent"]
    table.add_row(_PAPER, *(f"{paper[k]:.0f}" for k in shares["pose"]), style="dim")
    return table


def _interval(method: Report, key: str, part: str, digits: int = 2) -> str:
    low, high = method[f"{key}_interval"][part]
    value = _number(method[key][part], digits)
    if not value or low is None:
        return value
    return f"{value} ({_number(low, digits)} to {_number(high, digits)})"


def _number(value: float | None, digits: int) -> str:
    return "" if value is None else f"{value:,.{digits}f}"
