"""Bar charts of a report: Tables 1 and 2, errors by number of fingers, and components."""

from __future__ import annotations

import math
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from encoders.evaluation.paper_results import row
from models.errors import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


STYLE: Any = {
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.grid.axis": "y",
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "svg.hashsalt": "hand sandbox",
}

COLOURS = ("#3a6ea5", "#d1803a", "#5d9a59", "#a85f8c", "#8a8a3c", "#4fa3a8", "#7a6fb0", "#999999")
PAPER_COLOUR = "#333333"
FAINT = "#666666"

DPI = 150


def need_matplotlib() -> None:
    """Checks that matplotlib is installed.

    Raises:
        InputError: matplotlib is not installed.
    """
    if find_spec("matplotlib") is None:
        raise InputError(
            "figures of an evaluation need matplotlib",
            where="--plots",
            remedy="pip install 'hand-sandbox[plots]', or leave --plots out",
        )


def figure(width: float, height: float) -> Figure:
    """Returns an empty figure; width and height in inches.

    Raises:
        InputError: matplotlib is not installed.
    """
    need_matplotlib()
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def save(made: Figure, stem: Path) -> list[Path]:
    """Writes a figure as PNG and SVG; equal figures give equal files."""
    from matplotlib import rc_context

    paths = []
    with rc_context(STYLE):
        for kind, metadata in (("png", {"Software": None}), ("svg", {"Date": None})):
            path = stem.with_name(f"{stem.name}.{kind}")
            made.savefig(path, dpi=DPI, metadata=metadata)
            paths.append(path)
    return paths


def source(report: dict[str, Any]) -> str:
    """Description of the measured frames, for the foot of a figure."""
    frames, tests = report["test_frames"]["all"], report["tests"]
    takes = sum(test["takes"] for test in tests)
    kind = "SIMULATED captures" if report["simulated"] else "captures"
    many = f"{len(tests)} test captures" if len(tests) > 1 else "one test capture"
    return f"{kind}: {frames:,} frames in {takes} takes of {many}"


Report = dict[str, Any]

COUNTS = ("1", "2", "3", "4", "5")
NAMED = {"true_labels": "true labels", "own_labels": "own labels"}
PAPER = "paper (another data set: one real hand)"


def errors(report: Report) -> Figure:
    """Draws Table 1: errors of wrist and joints, with true and with estimated labels."""
    from matplotlib import rc_context

    methods, paper = report["encoders"], report["paper"]["table_1"]
    with rc_context(STYLE):
        made = figure(max(6.0, 1.0 + 1.5 * len(methods)), 5.6)
        axes = made.subplots(2, 1, sharex=True)
        measures = (("wrist_cm", "wrist error, cm", 0), ("angle_deg", "joint angle error, deg", 2))
        for axis, (key, title, column) in zip(axes, measures, strict=True):
            for i, labels in enumerate(NAMED):
                _bars(
                    axis,
                    np.arange(len(methods)) + (i - 0.5) * 0.34,
                    [e[key][labels] for e in methods.values()],
                    [e[f"{key}_interval"][labels] for e in methods.values()],
                    0.32,
                    COLOURS[i],
                    NAMED[labels],
                )
            known = [(x, paper[row(n)][column]) for x, n in enumerate(methods) if row(n) in paper]
            _marks(axis, known, 0.36)
            axis.set_ylabel(title)
        axes[-1].set_xticks(range(len(methods)), list(methods))
        _finish(made, axes[0], "Table 1: errors, with 95 % intervals over takes", source(report))
    return made


def labels(report: Report) -> Figure:
    """Draws Table 2: share of frames with all fingers labelled correctly."""
    from matplotlib import rc_context

    methods, paper = report["encoders"], report["paper"]["table_2"]
    with rc_context(STYLE):
        made = figure(max(7.0, 1.0 + 1.9 * len(methods)), 3.6)
        axis = made.subplots()
        width = 0.8 / len(COUNTS)
        known = []
        for i, count in enumerate(COUNTS):
            x = np.arange(len(methods)) + (i - (len(COUNTS) - 1) / 2) * width
            _bars(
                axis,
                x,
                [e["labels_percent"][count] for e in methods.values()],
                [e["labels_percent_interval"][count] for e in methods.values()],
                0.92 * width,
                COLOURS[i],
                "1 finger, others lifted" if count == "1" else f"{count} fingers",
            )
            if count != "1":
                known += [
                    (float(place), paper[row(n)][i - 1])
                    for place, n in zip(x, methods, strict=True)
                    if row(n) in paper
                ]
        _marks(axis, known, 0.5 * width)
        axis.set_ylabel("frames labelled correctly, %")
        axis.set_ylim(0, 105)
        axis.set_xticks(range(len(methods)), list(methods))
        title = "Table 2: fingers labelled correctly, with 95 % intervals over takes"
        _finish(made, axis, title, source(report))
    return made


def by_fingers(report: Report) -> Figure:
    """Draws errors with true labels by number of touching fingers."""
    from matplotlib import rc_context

    methods = report["encoders"]
    counts = [k for k in COUNTS if report["test_frames"][k]]
    with rc_context(STYLE):
        made = figure(max(6.0, 1.5 + 1.3 * len(counts)), 5.6)
        axes = made.subplots(2, 1, sharex=True)
        width = 0.84 / max(len(methods), 1)
        for axis, (key, title) in zip(
            axes,
            (("wrist_cm", "wrist error, cm"), ("angle_deg", "joint angle error, deg")),
            strict=True,
        ):
            for i, (name, e) in enumerate(methods.items()):
                _bars(
                    axis,
                    np.arange(len(counts)) + (i - (len(methods) - 1) / 2) * width,
                    [e["by_fingers"][k][key]["true_labels"] for k in counts],
                    [e["by_fingers"][k][f"{key}_interval"]["true_labels"] for k in counts],
                    0.92 * width,
                    COLOURS[i % len(COLOURS)],
                    name,
                )
            axis.set_ylabel(title)
        axes[-1].set_xticks(range(len(counts)), [f"{k} fingers" for k in counts])
        _finish(made, axes[0], "Errors by number of fingers, true labels", source(report))
    return made


def variance(report: Report) -> Figure:
    """Draws the variance of the training poses in principal components."""
    from matplotlib import rc_context

    shares = report["training"]["pca_variance_percent"]
    counts = list(shares["pose"])
    with rc_context(STYLE):
        made = figure(5.6, 3.6)
        axis = made.subplots()
        rows = (("joints", "joints, 42 numbers"), ("pose", "relative pose, 48 numbers"))
        for i, (key, title) in enumerate(rows):
            x = np.arange(len(counts)) + (i - 0.5) * 0.36
            values = [shares[key][k] for k in counts]
            axis.bar(x, values, 0.34, color=COLOURS[i], label=title)
        paper = report["paper"]["pca_variance_percent"]
        _marks(axis, [(float(x), paper[k]) for x, k in enumerate(counts)], 0.38)
        axis.set_xticks(range(len(counts)), [f"{k} components" for k in counts])
        axis.set_ylabel("variance of training poses, %")
        axis.set_ylim(0, 105)
        training = report["training"]
        kind = "SIMULATED capture" if training["simulated"] else "capture"
        subtitle = f"{kind}: {training['frames']:,} frames in {training['takes']} takes"
        _finish(made, axis, "Principal components of the training poses", subtitle)
    return made


def _bars(
    axis: Axes,
    x: Any,
    values: list[float | None],
    intervals: list[list[float | None]],
    width: float,
    colour: str,
    label: str,
) -> None:
    """Draws bars with intervals; missing values leave a gap."""
    y = np.array([np.nan if v is None else v for v in values], float)
    ends = np.array([[np.nan if v is None else v for v in pair] for pair in intervals], float)
    axis.bar(x, np.nan_to_num(y), width, color=colour, label=label)
    known = np.isfinite(y) & np.isfinite(ends).all(axis=1)
    reach = np.abs(ends[known] - y[known, None]).T
    axis.errorbar(
        np.asarray(x)[known], y[known], reach, fmt="none", ecolor="black", elinewidth=0.8, capsize=2
    )


def _marks(axis: Axes, known: Sequence[tuple[float, float]], half: float) -> None:
    """Draws the paper's numbers as lines across the bars, since they are from other data."""
    for i, (x, y) in enumerate(known):
        axis.plot(
            [x - half, x + half],
            [y, y],
            color=PAPER_COLOUR,
            linewidth=1.6,
            linestyle=(0, (2, 1)),
            label=PAPER if i == 0 else None,
        )


def _finish(made: Figure, axis: Axes, title: str, subtitle: str) -> None:
    """Adds title, description of the frames, and one legend below, with the paper's lines last."""
    handles, names = axis.get_legend_handles_labels()
    order = sorted(range(len(names)), key=lambda i: names[i] == PAPER)
    # The number of rows follows from the approximate width of a single row in inches.
    rows = math.ceil(sum(0.6 + 0.068 * len(name) for name in names) / made.get_figwidth())
    made.legend(
        [handles[i] for i in order],
        [names[i] for i in order],
        loc="outside lower center",
        ncols=math.ceil(len(names) / rows),
    )
    made.suptitle(title, fontsize=11, fontweight="bold")
    axis.set_title(subtitle, fontsize=8, color=FAINT)
