"""Tables 1 and 2 and Figure 2 of the paper of 2015, beside the results of this program.

    pip install -e ".[plots]"
    python -m tools.docs.paper_tables             # prints the tables, draws out/paper/figure-2.png
    python -m tools.docs.paper_tables --keep      # also writes docs/pictures/figure-2.png

The command runs `sandbox evaluate` for the methods that the paper compares, on one judged day of a
*simulated* person. The numbers of the paper are from one real person, whose data are not public.
"""

from __future__ import annotations

import argparse
import io
import json
import sys
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from PIL import Image

from encoders.evaluation.paper_results import TABLE_1, TABLE_2
from sandbox.cli.main import main as sandbox
from tools.docs.markdown_table import markdown_table

ROOT = Path(__file__).resolve().parents[2]
METHODS = tuple(TABLE_1)
"""Methods that the paper compares."""
FIGURE = "figure-2.png"
WIDEST = 1600
"""Largest width and height (px) of the figure in the docs."""


def evaluated(out: Path, methods: Sequence[str] = METHODS) -> dict[str, Any]:
    """Evaluates methods on one judged day and draws the pictures; returns the report.

    Args:
        out: Folder for the pictures and the report; it is created.
        methods: Names of methods, as for `sandbox evaluate --encoders`.
    """
    report = out / "report.json"
    out.mkdir(parents=True, exist_ok=True)
    asked = ["evaluate", "--encoders", *methods, "--days", "1", "--no-copas"]
    with redirect_stdout(io.StringIO()):
        sandbox([*asked, "--plots", str(out), "--json", str(report)])
    document: dict[str, Any] = json.loads(report.read_text(encoding="utf-8"))
    return document


def table_1(encoders: Mapping[str, Any]) -> str:
    """Table 1 as Markdown: errors of wrist and joints, with true labels."""
    rows = []
    for name in METHODS:
        ours, (wrist, _, angle, _) = encoders[name], TABLE_1[name]
        rows.append(
            (
                name,
                f"{wrist:.2f}",
                _with_interval(ours, "wrist_cm", "true_labels", 2),
                f"{angle:.2f}",
                _with_interval(ours, "angle_deg", "true_labels", 2),
            )
        )
    return markdown_table(
        ("", "wrist, cm: paper", "ours", "joint angle, degrees: paper", "ours"), rows
    )


def table_2(encoders: Mapping[str, Any]) -> str:
    """Table 2 as Markdown: share of frames in which all labels are correct, percent."""
    rows = []
    for name in METHODS:
        shares, there = encoders[name]["labels_percent"], TABLE_2[name]
        cells = [
            cell
            for count, paper in zip("2345", there, strict=True)
            for cell in (f"{paper:.1f}", f"{shares[count]:.1f}")
        ]
        rows.append((name, *cells))
    columns = [word for n in "2345" for word in (f"{n} fingers: paper", "ours")]
    return markdown_table(("", *columns), rows)


def main() -> int:
    """Prints the tables and draws the figure; returns 2 if matplotlib is missing."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=Path("out/paper"), help="folder of pictures")
    parser.add_argument("--keep", action="store_true", help="write the figure of the docs")
    options = parser.parse_args()
    if find_spec("matplotlib") is None:
        print("matplotlib is missing: pip install -e '.[plots]'", file=sys.stderr)
        return 2
    report = evaluated(options.out)
    print("Paper: one real person. Ours: a SIMULATED person. Two different data sets.\n")
    print(f"Table 1\n\n{table_1(report['encoders'])}\n\nTable 2\n\n{table_2(report['encoders'])}\n")
    print(f"Figure 2: {options.out / FIGURE}")
    if options.keep:
        with Image.open(options.out / FIGURE) as picture:
            picture.thumbnail((WIDEST, WIDEST))
            picture.convert("RGB").quantize(128).save(
                ROOT / "docs" / "pictures" / FIGURE, optimize=True
            )
    return 0


def _with_interval(encoder: Mapping[str, Any], name: str, labels: str, digits: int) -> str:
    low, high = encoder[f"{name}_interval"][labels]
    return f"{encoder[name][labels]:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


if __name__ == "__main__":
    sys.exit(main())
