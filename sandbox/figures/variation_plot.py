"""Plots success against variations, with a panel for each variation and a line for each task."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from models.errors import InputError
from sandbox.figures.charts import COLOURS, DPI, FAINT, STYLE, figure
from sandbox.regress import statistics
from sandbox.regress.sweep import Curve, Sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".svg")
ACROSS = 3
"""Largest number of panels side by side."""


def check_plot(path: Path) -> None:
    """Checks, before the trials run, that the picture can be drawn.

    Raises:
        InputError: matplotlib is not installed, or the file cannot be a picture.
    """
    from importlib.util import find_spec

    where = f"--plot {path}"
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(
            "this name has not the ending of a picture",
            where=where,
            expected=" or ".join(SUFFIXES),
        )
    if not path.absolute().parent.is_dir():
        raise InputError("no such folder", where=where, remedy="Create it, or name another folder")
    if find_spec("matplotlib") is None:
        raise InputError(
            "a picture needs matplotlib", where=where, remedy="pip install 'hand-sandbox[plots]'"
        )


def draw(found: Sweep) -> Figure:
    """Draws success in percent with Wilson intervals, and rings at values that break a task."""
    from matplotlib import rc_context

    kinds = list(dict.fromkeys(curve.kind for curve in found.curves))
    tasks = list(dict.fromkeys(curve.task for curve in found.curves))
    across = min(ACROSS, max(1, len(kinds)))
    down = -(-max(1, len(kinds)) // across)
    with rc_context(STYLE):
        made = figure(max(5.0, 3.4 * across), 0.7 + 2.6 * down)
        panels = made.subplots(down, across, squeeze=False, sharey=True).ravel()
        for panel, kind in zip(panels, kinds, strict=False):
            for curve in found.curves:
                if curve.kind == kind:
                    _line(panel, curve, COLOURS[tasks.index(curve.task) % len(COLOURS)])
            panel.set_xlabel(f"{kind.about}, {kind.unit or 'factor'}")
            panel.set_ylim(-3.0, 103.0)
            if kind.neutral:
                _logarithmic(
                    panel, [p.value for c in found.curves if c.kind == kind for p in c.run]
                )
            panel.axvline(kind.neutral, color=FAINT, linewidth=0.8, linestyle=":")
        for panel in panels[len(kinds) :]:
            panel.set_visible(False)
        for panel in panels[::across]:
            panel.set_ylabel("success, %")
        if kinds:
            # Inside a panel, the legend could hide a ring.
            lines, names = panels[0].get_legend_handles_labels()
            made.legend(lines, names, loc="outside lower center", ncols=min(len(names), 4))
        encoder = found.plan.settings[0].pipeline.encoder
        made.suptitle(
            f"SIMULATED user, {len(found.plan.seeds)} seeds, encoder {encoder}; 95 % intervals; "
            "ring: breaks the task",
            fontsize=9.0,
        )
    return made


def save_plot(made: Figure, path: Path) -> None:
    """Writes a figure; equal figures give equal files.

    Raises:
        InputError: The figure cannot be written.
    """
    from matplotlib import rc_context

    metadata = {".png": {"Software": None}, ".svg": {"Date": None}}[path.suffix.lower()]
    try:
        with rc_context(STYLE):
            made.savefig(path, dpi=DPI, metadata=metadata)
    except OSError as error:
        raise InputError(
            "the figure cannot be written", where=f"--plot {path}", got=error.strerror
        ) from None


def _line(panel: Axes, curve: Curve, colour: str) -> None:
    points = [p for p in curve.run if p.result.n]
    x = [p.value for p in points]
    rates = [100.0 * p.result.successes / p.result.n for p in points]
    intervals = [statistics.wilson(p.result.successes, p.result.n) for p in points]
    ends = [
        [max(r - 100.0 * low, 0.0) for r, (low, _) in zip(rates, intervals, strict=True)],
        [max(100.0 * high - r, 0.0) for r, (_, high) in zip(rates, intervals, strict=True)],
    ]
    panel.errorbar(
        x,
        rates,
        yerr=ends,
        color=colour,
        marker="o",
        markersize=3.5,
        linewidth=1.2,
        elinewidth=0.8,
        capsize=2.0,
        label=curve.task,
    )
    broken = [(p.value, r) for p, r in zip(points, rates, strict=True) if p.breaks]
    if broken:
        panel.plot(
            *zip(*broken, strict=True),
            linestyle="",
            marker="o",
            markersize=10,
            markerfacecolor="none",
            markeredgecolor=colour,
        )


def _logarithmic(panel: Axes, values: list[float]) -> None:
    """Makes the axis logarithmic, so that a factor and its inverse are equally far from 1."""
    from matplotlib.ticker import FixedLocator, NullLocator

    ticks = sorted(set(values))
    panel.set_xscale("log")
    panel.xaxis.set_major_locator(FixedLocator(ticks))
    panel.xaxis.set_minor_locator(NullLocator())
    panel.set_xticks(ticks, [f"{v:g}" for v in ticks])
