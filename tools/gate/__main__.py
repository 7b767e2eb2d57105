"""Runs the gate; the package's docstring has the command lines."""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from pathlib import Path
from statistics import median
from typing import Any

from rich.console import Console
from rich.table import Table

import tools.gate
from tools.gate.observation import observe
from tools.gate.rows import Difference, Observed, Rows, differences, fingerprint

FILE = Path(__file__).parent.parent / "gate.json"
"""Rows of the commit that wrote the file, and the fingerprint of the machine."""


def table(before: Rows, now: Rows, found: list[Difference]) -> Table:
    """Table with a line for each group: numbers of rows, successes, median times, differences."""
    shown = Table(title="gate")
    for column in ("group", "rows", "success", "was", "median s", "was", "differ"):
        shown.add_column(column, justify="left" if column == "group" else "right")
    for group, rows in now.items():
        old = {name: row for name, row in before.get(group, {}).items() if name in rows}
        differ = sum(d.group == group for d in found)
        shown.add_row(
            group,
            str(len(rows)),
            _successes(rows),
            _successes(old),
            _time(rows),
            _time(old),
            f"[red]{differ}[/]" if differ else "0",
        )
    return shown


def _successes(rows: dict[str, Observed]) -> str:
    judged = [row["success"] for row in rows.values() if "success" in row]
    return f"{sum(judged)}/{len(judged)}" if judged else ""


def _time(rows: dict[str, Observed]) -> str:
    times = [row["time_s"] for row in rows.values() if row.get("time_s") is not None]
    return f"{median(times):.2f}" if times else ""


def update(rows: Rows, path: Path, here: str) -> None:
    """Writes the file with one row per line, so that differences are readable in git."""
    lines = [f' "fingerprint": {json.dumps(here)},', ' "rows": {']
    for i, (group, named) in enumerate(rows.items()):
        lines.append(f"  {json.dumps(group)}: {{")
        inner = [f"   {json.dumps(name)}: {json.dumps(row)}" for name, row in named.items()]
        lines.append(",\n".join(inner))
        lines.append("  }" + ("," if i < len(rows) - 1 else ""))
    path.write_text("\n".join(["{", *lines, " }", "}"]) + "\n", encoding="utf-8")


def main() -> int:
    """The command line. The exit status is 1 if a row differs, and 2 if nothing can be
    compared."""
    parser = argparse.ArgumentParser(
        prog="python -m tools.gate",
        description=tools.gate.__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--quick", action="store_true", help="about a minute on two cores")
    parser.add_argument("--update", action="store_true", help=f"write tools/{FILE.name}")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="processes")
    parser.add_argument("--file", type=Path, default=FILE, help="another file than tools/gate.json")
    options = parser.parse_args()
    if options.quick and options.update:
        parser.error("--update needs all rows, but --quick plays only some: leave out one option")
    if options.workers < 1:
        parser.error(f"--workers must be at least 1, got {options.workers}")
    here = fingerprint()
    stored: dict[str, Any] = {"fingerprint": here, "rows": {}}
    if options.file.exists():
        try:
            stored = json.loads(options.file.read_text(encoding="utf-8"))
            _ = stored["fingerprint"], stored["rows"]
        except (ValueError, KeyError, TypeError) as error:
            parser.error(
                f"{options.file} is not a file of the gate ({error!r}): restore it with git"
            )
    elif not options.update:
        parser.error(f"{options.file} is missing: restore it with git, or write it with --update")
    same = stored["fingerprint"] == here
    if options.update and not same:
        parser.error(
            f"{options.file} is from a machine with fingerprint {stored['fingerprint']}, but this "
            f"machine has {here}: update the file on a machine with the same fingerprint, or "
            "delete it first"
        )
    begun = time.monotonic()
    now = observe(options.quick, options.workers)
    found = differences(stored["rows"], now, now, not options.quick, same)
    console = Console()
    console.print(table(stored["rows"], now, found))
    for difference in found:
        console.print(str(difference), highlight=False, markup=False, soft_wrap=True)
    if not same:
        console.print(
            f"This machine has fingerprint {here}, but the file has {stored['fingerprint']}: only "
            "outcomes are compared, without those of `gather` and soft servos."
        )
    console.print(f"{len(found)} differences, {time.monotonic() - begun:.0f} s")
    if options.update:
        update(now, options.file, here)
        console.print(f"wrote {options.file}")
        return 0
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
