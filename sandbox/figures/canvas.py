"""Figures in a common style, drawn without a screen."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.errors import InputError

if TYPE_CHECKING:
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
            "pictures of an evaluation need matplotlib",
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
    """Description of the measured frames, for the foot of a picture."""
    frames, tests = report["test_frames"]["all"], report["tests"]
    takes = sum(test["takes"] for test in tests)
    kind = "SIMULATED captures" if report["simulated"] else "captures"
    many = f"{len(tests)} test captures" if len(tests) > 1 else "one test capture"
    return f"{kind}: {frames:,} frames in {takes} takes of {many}"
