"""Plots as SVG with the colours (light or dark) and the font of the page.

matplotlib draws with placeholder colours, which are replaced in the SVG by variables of the page's
style sheet. Levels also differ in the shape of their markers, for readers who cannot tell colours
apart.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.study.report.models.intervals import Estimate

INK, MUTED, GRID, PAPER = "#0a0bf0", "#0a0bf1", "#0a0bf2", "#0a0bf3"
_NAMES = {INK: "--ink", MUTED: "--muted", GRID: "--grid", PAPER: "--paper"}
SERIES = tuple(f"#0a0b{i:02x}" for i in range(8))
"""Placeholders of the colours --s0 ... --s7 of the page."""
MARKERS = "osD^vPX*"
FARTHEST = 2.0
"""Farthest end of a drawn interval, in multiples of the span of values; see `_scale`."""
WIDTH = 7.2
"""Width of a plot, in; the page scales it."""
_STYLE: Any = {
    "svg.fonttype": "none",
    # A dollar sign in the name of a level must not start a formula.
    "text.parse_math": False,
    "svg.hashsalt": "sandbox study report",
    "font.size": 10.0,
    "text.color": INK,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "axes.titlesize": 10.0,
    "axes.facecolor": "none",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": GRID,
    "grid.linewidth": 0.8,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "figure.facecolor": "none",
    "savefig.facecolor": "none",
    "legend.frameon": False,
    "lines.linewidth": 1.6,
}


@dataclass(frozen=True)
class Dot:
    """A mean with two intervals, drawn as a thin and a thick line."""

    value: float
    thin: Estimate
    thick: Estimate | None = None


@contextmanager
def _figure(
    body: float,
    left: float = 0.75,
    above: float = 0.1,
    below: float = 0.55,
    columns: int = 1,
    **how: Any,
) -> Iterator[tuple[Any, list[Any]]]:
    """A figure with given margins, in; to compute them would take longer than drawing."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with rc_context(_STYLE):
        height = above + body + below
        figure = Figure(figsize=(WIDTH, height))
        FigureCanvasSVG(figure)
        axes = figure.subplots(1, columns, squeeze=False, **how)
        figure.subplots_adjust(
            left / WIDTH, below / height, 1.0 - 0.15 / WIDTH, 1.0 - above / height, wspace=0.08
        )
        yield figure, list(axes[0])


def _left(names: Sequence[str]) -> float:
    """Left margin for the names beside an axis, in."""
    return 0.25 + 0.075 * max((len(n) for n in names), default=0)


def _above(series: Sequence[str]) -> float:
    """Upper margin for the legend, in."""
    return 0.1 if len(series) < 2 else 0.2 + 0.22 * -(-len(series) // _per_row(series))


def _per_row(series: Sequence[str]) -> int:
    """Number of legend entries that fit in one row."""
    return max(1, min(len(series), int(WIDTH / (0.6 + 0.08 * max(map(len, series))))))


def _legend(figure: Any, axes: Any, series: Sequence[str]) -> None:
    if len(series) > 1:
        figure.legend(
            *axes.get_legend_handles_labels(),
            loc="upper left",
            borderaxespad=0.2,
            ncols=_per_row(series),
        )


def svg_of(figure: Any, name: str, title: str) -> str:
    """Converts a figure to SVG for a page with several figures.

    Args:
        figure: Figure of matplotlib.
        name: Prefix of all ids, so that those of two pictures differ.
        title: Text for readers who cannot see it.
    """
    from html import escape

    out = io.StringIO()
    figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    text = out.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r' id="([^"]+)"', rf' id="{name}-\1"', text)
    text = re.sub(r"url\(#", f"url(#{name}-", text)
    text = re.sub(r'xlink:href="#', f'href="#{name}-', text)
    # The font of the page instead of that of the figure.
    text = re.sub(r"font: (?:[a-z0-9]+ )*?(\d[\d.]*)px [^;\"]+", r"font-size: \1px", text)
    for colour, variable in _NAMES.items():
        text = text.replace(colour, f"var({variable})")
    text = re.sub(r"#0a0b0(\d)", r"var(--s\1)", text)
    text = re.sub(
        r'^<svg [^>]*?viewBox="([^"]+)"[^>]*>',
        rf'<svg viewBox="\1" role="img" aria-label="{escape(title)}">',
        text,
        count=1,
        flags=re.DOTALL,
    )
    return text.strip()


def dots(
    name: str,
    title: str,
    label: str,
    rows: Sequence[str],
    series: Sequence[str],
    values: dict[tuple[str, str], Dot],
    log: bool = False,
    limits: tuple[float, float] | None = None,
) -> str:
    """Plots means with their intervals, by row and series.

    Args:
        name, title: See `svg_of`.
        label: Label of the measure's axis.
        rows: Names of the rows, from the top; one empty name for a single row.
        series: Levels, in colours.
        values: Values by row and series.
        log: True for a logarithmic axis.
        limits: Limits of the axis.
    """
    shown = [_short(r, 34) for r in rows]
    body = 0.3 + len(rows) * (0.22 + 0.24 * len(series))
    with _figure(body, _left(shown), _above(series)) as (figure, (axes,)):
        for j, one in enumerate(series):
            for i, row in enumerate(rows):
                dot = values.get((row, one))
                if dot is None or not np.isfinite(dot.value):
                    continue
                y = i + (j - (len(series) - 1) / 2) * 0.8 / max(len(series), 2)
                colour = SERIES[j % len(SERIES)]
                for e, width in ((dot.thin, 1.4), (dot.thick, 4.0)):
                    if e is not None and np.isfinite(e.low) and np.isfinite(e.high):
                        axes.plot(
                            [e.low, e.high], [y, y], color=colour, lw=width, solid_capstyle="butt"
                        )
                axes.plot(
                    [dot.value], [y], MARKERS[j % 8], color=colour, ms=7.0, mec=PAPER, mew=1.0
                )
            if len(series) > 1:
                axes.plot(
                    [], [], MARKERS[j % 8] + "-", color=SERIES[j % 8], label=_label(one), ms=7.0
                )
        axes.set_yticks(range(len(rows)), shown)
        axes.set_ylim(len(rows) - 0.45, -0.55)
        axes.grid(axis="y", visible=False)
        axes.set_xlabel(label)
        _scale(axes.xaxis, log, [d.value for d in values.values()])
        if limits:
            axes.set_xlim(*limits)
        _legend(figure, axes, series)
        return svg_of(figure, name, title)


def forest(
    name: str,
    title: str,
    label: str,
    rows: Sequence[str],
    values: Sequence[Sequence[Estimate]],
    series: Sequence[str],
    none: float,
    log: bool = False,
) -> str:
    """Plots differences with intervals, and a line at no difference.

    Args:
        name, title: See `svg_of`.
        label: Label of the axis.
        rows: Pairs of levels, from the top.
        values: (series, rows) estimates.
        series: Names of the methods of estimation.
        none: Value that means no difference.
        log: True for a logarithmic axis.
    """
    rows = [_short(r, 40) for r in rows]
    body = 0.3 + len(rows) * (0.16 + 0.22 * len(series))
    with _figure(body, _left(rows), _above(series)) as (figure, (axes,)):
        axes.axvline(none, color=MUTED, lw=1.2, ls=(0, (4, 3)))
        for j, estimates in enumerate(values):
            colour = SERIES[j % 8]
            for i, e in enumerate(estimates):
                y = i + (j - (len(series) - 1) / 2) * 0.3
                if np.isfinite(e.low) and np.isfinite(e.high):
                    axes.plot([e.low, e.high], [y, y], color=colour, lw=2.0)
                if np.isfinite(e.value):
                    axes.plot([e.value], [y], MARKERS[j % 8], color=colour, ms=7.0, mec=PAPER)
            axes.plot([], [], MARKERS[j % 8] + "-", color=colour, label=_label(series[j]), ms=7.0)
        axes.set_yticks(range(len(rows)), rows)
        axes.set_ylim(len(rows) - 0.45, -0.55)
        axes.grid(axis="y", visible=False)
        axes.set_xlabel(label)
        _scale(axes.xaxis, log, [none, *(e.value for some in values for e in some)])
        _legend(figure, axes, series)
        return svg_of(figure, name, title)


def lines_by_person(
    name: str,
    title: str,
    label: str,
    panels: Sequence[str],
    levels: Sequence[Sequence[str]],
    values: Sequence[np.ndarray],
    means: Sequence[Sequence[Estimate]],
    log: bool = False,
) -> str:
    """Plots a line over levels for each person, and the mean over people.

    Args:
        name, title: See `svg_of`.
        label: Label of the measure's axis.
        panels: Factors, side by side.
        levels: Levels of each panel.
        values: Values of each panel, (people, levels); nan if missing.
        means: Means of each panel, with intervals.
        log: True for a logarithmic axis.
    """
    tilted = any(len(some) > 4 for some in levels)
    with _figure(
        2.8, above=0.3, below=0.95 if tilted else 0.4, columns=len(panels), sharey=True
    ) as (figure, all_axes):
        for k, axes in enumerate(all_axes):
            x = np.arange(len(levels[k]))
            # People who did only one level are drawn as points with small shifts.
            many = np.isfinite(values[k]).sum(axis=1) > 1
            axes.plot(x, values[k][many].T, "-", color=MUTED, alpha=0.5, lw=0.9)
            for i, own in enumerate(values[k][~many]):
                shift = 0.16 * ((i * 0.618) % 1.0 - 0.5)
                axes.plot(x + shift, own, "o", color=MUTED, alpha=0.5, ms=3.5)
            centre = np.array([e.value for e in means[k]])
            axes.plot(x, centre, "-", color=SERIES[0], lw=2.0)
            for j, e in enumerate(means[k]):
                if np.isfinite(e.low) and np.isfinite(e.high):
                    axes.plot(
                        [j, j], [e.low, e.high], color=SERIES[0], lw=4.0, solid_capstyle="butt"
                    )
            axes.plot(x, centre, "o", color=SERIES[0], ms=8.0, mec=PAPER)
            axes.set_xticks(
                x,
                [_short(s) for s in levels[k]],
                rotation=25 if tilted else 0,
                ha="right" if tilted else "center",
            )
            axes.set_xlim(-0.5, len(x) - 0.5)
            axes.set_title(panels[k])
            axes.grid(axis="x", visible=False)
        # This must come last, since the panels share the axis.
        _scale(all_axes[0].yaxis, log, np.concatenate([v.ravel() for v in values]))
        all_axes[0].set_ylabel(label)
        return svg_of(figure, name, title)


def curves(
    name: str,
    title: str,
    label: str,
    along: str,
    series: Sequence[str],
    x: Sequence[Sequence[float]],
    values: Sequence[Sequence[Estimate]],
    log: bool = False,
) -> str:
    """Plots means along a horizontal axis, with bands or bars.

    Args:
        name, title: See `svg_of`.
        label, along: Labels of both axes.
        series: Levels.
        x, values: Coordinates of each series.
        log: True for a logarithmic axis of the measure.
    """
    with _figure(2.6, above=_above(series)) as (figure, (axes,)):
        for j, one in enumerate(series):
            colour = SERIES[j % 8]
            low, mid, high = (
                np.array([getattr(e, k) for e in values[j]]) for k in ("low", "value", "high")
            )
            shift = 0.06 * (j - (len(series) - 1) / 2) if len(x[j]) < 8 else 0.0
            at = np.asarray(x[j], dtype=float) + shift
            if len(at) >= 8:
                axes.fill_between(at, low, high, color=colour, alpha=0.15, lw=0)
            else:
                axes.vlines(at, low, high, color=colour, lw=1.6)
            axes.plot(
                at, mid, MARKERS[j % 8] + "-", color=colour, ms=5.5, mec=PAPER, label=_label(one)
            )
        axes.set_xlabel(along)
        axes.set_ylabel(label)
        _scale(axes.yaxis, log, [e.value for some in values for e in some])
        whole = max((max(v, default=0) for v in x), default=0)
        if whole <= 12:
            axes.set_xticks(range(1, int(whole) + 1))
        _legend(figure, axes, series)
        return svg_of(figure, name, title)


def _label(name: str) -> str:
    """Entry of a legend; matplotlib ignores names that begin with an underscore."""
    return "\u200b" + name if name.startswith("_") else name


def _short(text: str, most: int = 18) -> str:
    return text if len(text) <= most else text[: most - 1] + "…"


def _scale(axis: Any, log: bool, values: Sequence[float] | np.ndarray = ()) -> None:
    """Sets limits of an axis around values, and plain numbers as ticks of a logarithmic one.

    Intervals over two or three people can be so wide that nothing else would be visible. The axis
    therefore ends at `FARTHEST` times the span of the values beyond them.
    """
    known = np.asarray(values, dtype=float)
    known = known[np.isfinite(known) & ((known > 0.0) | (not log))]
    if len(known):
        change, back = (np.log, np.exp) if log else (np.asarray, np.asarray)
        low, high = change(known.min()), change(known.max())
        reach = FARTHEST * max(high - low, 0.5 if log else 0.2 * abs(high), 1e-9)
        ends = sorted(axis.get_view_interval())
        inside = (max(ends[0], back(low - reach)), min(ends[1], back(high + reach)))
        axis.axes.set_xlim(*inside) if axis.axis_name == "x" else axis.axes.set_ylim(*inside)
    if not log:
        return
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

    if not len(known):
        return
    axis.axes.set_xscale("log") if axis.axis_name == "x" else axis.axes.set_yscale("log")
    # Finer ticks where the axis is shorter.
    low, high = sorted(axis.get_view_interval())
    steps: tuple[float, ...] = (1.0,)
    if high / low < 6.0:
        steps = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)
    elif high / low < 500.0:
        steps = (1.0, 2.0, 5.0)
    axis.set_major_locator(LogLocator(base=10.0, subs=steps))
    axis.set_minor_locator(NullLocator())
    axis.set_minor_formatter(NullFormatter())
    axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:.4g}"))
