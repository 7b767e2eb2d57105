"""Plots as SVG, with the colours (light or dark) and the font of the page.

matplotlib draws with placeholder colours. In the SVG, these are replaced by variables of the page's
style sheet.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from sandbox.study.report.numbers import Estimate

INK, MUTED, GRID, PAPER = "#0a0bf0", "#0a0bf1", "#0a0bf2", "#0a0bf3"
_NAMES = {INK: "--ink", MUTED: "--muted", GRID: "--grid", PAPER: "--paper"}
SERIES = tuple(f"#0a0b{i:02x}" for i in range(8))
"""Placeholders of the colours --s0 ... --s7 of the page."""
FARTHEST = 2.0
"""Largest distance of an axis's end from the values, in multiples of the span of the values; see
`_scale`."""
MARGIN = 0.03
"""Space beyond fixed ends of an axis, as a share of its length, so that markers are not cut."""
WIDTH, LEFT = 7.2, 0.75
"""Width of a plot, and of its left margin, inches; the page scales plots."""
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


@contextmanager
def _figure(
    body: float, above: float = 0.1, below: float = 0.55, columns: int = 1, **how: Any
) -> Iterator[tuple[Any, list[Any]]]:
    """Context of a figure with given height and margins, inches.

    matplotlib could compute margins, but this takes longer than drawing.
    """
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with rc_context(_STYLE):
        height = above + body + below
        figure = Figure(figsize=(WIDTH, height))
        FigureCanvasSVG(figure)
        axes = figure.subplots(1, columns, squeeze=False, **how)
        figure.subplots_adjust(
            LEFT / WIDTH, below / height, 1.0 - 0.15 / WIDTH, 1.0 - above / height, wspace=0.08
        )
        yield figure, list(axes[0])


def _above(series: Sequence[str]) -> float:
    """Upper margin for the legend, inches."""
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
        name: Prefix of all ids, so that the ids of two figures differ.
        title: Description for screen readers.
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
    # The page's font replaces the figure's font; only the size stays.
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


def lines_by_person(
    name: str,
    title: str,
    label: str,
    panels: Sequence[str],
    levels: Sequence[Sequence[str]],
    values: Sequence[np.ndarray],
    means: Sequence[Sequence[Estimate]],
    log: bool = False,
    ends: tuple[float, float] | None = None,
) -> str:
    """Plots a line over levels for each person, and the mean over people.

    Args:
        name, title: See `svg_of`.
        label: Label of the measure's axis.
        panels: Names of the factors; each has a panel, side by side.
        levels: Levels of each panel.
        values: Values of each panel, (people, levels); nan if missing.
        means: Means of each panel, with intervals.
        log: True for a logarithmic axis.
        ends: Ends of the measure's axis, such as 0 and 100 for shares in %; None to fit the axis to
            the values.
    """
    tilted = any(len(some) > 4 for some in levels)
    with _figure(
        2.8, above=0.3, below=0.95 if tilted else 0.4, columns=len(panels), sharey=True
    ) as (figure, all_axes):
        for k, axes in enumerate(all_axes):
            x = np.arange(len(levels[k]))
            # People who did only one level are points, slightly shifted to the left or right.
            many = np.isfinite(values[k]).sum(axis=1) > 1
            axes.plot(x, values[k][many].T, "-", color=MUTED, alpha=0.5, lw=0.9)
            for i, own in enumerate(values[k][~many]):
                shift = 0.16 * ((i * 0.618) % 1.0 - 0.5)
                axes.plot(x + shift, own, "o", color=MUTED, alpha=0.5, ms=3.5)
            centre = np.array([e.value for e in means[k]])
            axes.plot(x, centre, "-", color=SERIES[0], lw=2.0)
            for j, e in enumerate(means[k]):
                if e.is_known:
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
        # The panels share the axis, so its limits are set after all panels are drawn.
        if ends is None:
            _scale(all_axes[0], log, np.concatenate([v.ravel() for v in values]))
        else:
            margin = MARGIN * (ends[1] - ends[0])
            all_axes[0].set_ylim(ends[0] - margin, ends[1] + margin)
            all_axes[0].set_yticks(np.linspace(*ends, 6))
        all_axes[0].set_ylabel(label)
        return svg_of(figure, name, title)


def solved(series: Sequence[str], times: Sequence[np.ndarray], limit: float) -> str:
    """Plots the share of trials that have succeeded by each second.

    Args:
        series: Levels.
        times: Times of the trials of each level, s; infinity for a trial without success.
        limit: End of the axis, s.
    """
    with _figure(2.4, above=_above(series)) as (figure, (axes,)):
        for j, (one, of) in enumerate(zip(series, times, strict=True)):
            known = np.sort(of[np.isfinite(of)])
            x = np.concatenate([[0.0], known, [limit]])
            y = np.concatenate([[0.0], np.arange(1, len(known) + 1), [len(known)]])
            axes.step(x, 100.0 * y / max(len(of), 1), where="post", color=SERIES[j % 8])
            axes.plot([], [], "-", color=SERIES[j % 8], label=_label(one))
        axes.set_xlim(0.0, limit)
        axes.set_ylim(0.0, 102.0)
        axes.set_xlabel("time (s)")
        axes.set_ylabel("solved (% of trials)")
        _legend(figure, axes, series)
        return svg_of(figure, "solved", "Share of trials solved by each second")


def practice(
    label: str, people: Sequence[tuple[np.ndarray, np.ndarray]], mean: tuple[np.ndarray, np.ndarray]
) -> str:
    """Plots a measure from trial to trial: a thin line for each person, and the mean.

    Args:
        label: Label of the measure's axis.
        people: For each person, numbers of trials and values.
        mean: Numbers of trials and values of the mean.
    """
    with _figure(2.4) as (figure, (axes,)):
        for x, y in people:
            axes.plot(x, y, "-", color=MUTED, alpha=0.5, lw=0.9)
        axes.plot(*mean, "o-", color=SERIES[0], lw=2.0, ms=5.5, mec=PAPER)
        axes.set_xlabel("trial of the person, without practice")
        axes.set_ylabel(label)
        _scale(axes, False, np.concatenate([y for _, y in people]))
        return svg_of(figure, "practice", "Time to success from trial to trial")


def _label(name: str) -> str:
    """Entry of a legend. A character without width precedes an underscore, since matplotlib ignores
    names that begin with one."""
    return "\u200b" + name if name.startswith("_") else name


def _short(text: str) -> str:
    return text if len(text) <= 18 else text[:17] + "…"


def _scale(axes: Any, log: bool, values: np.ndarray) -> None:
    """Sets the limits of the vertical axis, and the ticks if it is logarithmic.

    Intervals can be so wide that nothing else would be visible. So the axis ends at most `FARTHEST`
    times the span of the values below and above the values.
    """
    known = values[np.isfinite(values) & ((values > 0.0) | (not log))]
    if not len(known):
        return
    change, back = (np.log, np.exp) if log else (np.asarray, np.asarray)
    low, high = change(known.min()), change(known.max())
    reach = FARTHEST * max(high - low, 0.5 if log else 0.2 * abs(high), 1e-9)
    axis = axes.yaxis
    ends = sorted(axis.get_view_interval())
    axes.set_ylim(max(ends[0], back(low - reach)), min(ends[1], back(high + reach)))
    if not log:
        return
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

    axes.set_yscale("log")
    # A shorter axis has finer ticks.
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
