"""Figures of an evaluation: bar charts of the tables, and reconstructed beside captured hands.

matplotlib is an extra (`plots`) and is imported only when a figure is drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.figures.charts import need_matplotlib as need_matplotlib
from sandbox.figures.charts import save

if TYPE_CHECKING:
    from encoders.evaluation.measure_method import MethodResult, Tests


def draw_all(
    folder: Path,
    report: dict[str, Any],
    results: Mapping[str, MethodResult],
    tests: Tests,
) -> list[Path]:
    """Draws all figures into a folder, each as PNG and SVG.

    Args:
        folder: An existing folder.
        report: Report from `encoders.evaluation.result_values`.
        results: Results of the same methods, with the poses from which hands are drawn.
        tests: The test captures.

    Returns:
        Paths of the files.

    Raises:
        InputError: matplotlib is not installed.
        OSError: A file cannot be written.
    """
    from sandbox.figures import charts, hands

    drawn: dict[str, Callable[[], Any]] = {
        "table-1": lambda: charts.errors(report),
        "table-2": lambda: charts.labels(report),
        "by-fingers": lambda: charts.by_fingers(report),
        "pca-variance": lambda: charts.variance(report),
        "figure-2": lambda: hands.side_by_side(report, results, tests),
    }
    paths = []
    for name, draw in drawn.items():
        paths += save(draw(), folder / name)
    return paths
