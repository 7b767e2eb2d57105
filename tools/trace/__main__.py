"""Runs the trace; the package's docstring has the command lines."""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

from rich.console import Console
from rich.table import Table

import tools.trace
from tools.trace.paths import PATHS
from tools.trace.tracer import Trace, Tracer

ROOT = Path(__file__).resolve().parent.parent.parent


def table(name: str, trace: Trace) -> Table:
    """Table with a line for each number."""
    shown = Table(title=f"trace of {name}", show_header=False)
    shown.add_column()
    shown.add_column(justify="right")
    for number, count in trace.numbers().items():
        shown.add_row(number, f"{count:,}")
    shown.add_row("share of module re", f"{trace.re_calls / max(trace.calls, 1):.1%}")
    return shown


def main() -> int:
    """The command line. The exit status is 1 if the traced command failed."""
    parser = argparse.ArgumentParser(
        prog="python -m tools.trace",
        description=tools.trace.__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("path", choices=PATHS, help="command to run")
    parser.add_argument("--list", action="store_true", help="print files and functions in order")
    parser.add_argument("--json", type=Path, metavar="OUT", help="write numbers and names here")
    options = parser.parse_args()
    if options.json and not options.json.absolute().parent.is_dir():
        parser.error(f"--json {options.json}: its folder does not exist")
    printed = io.StringIO()
    tracer = Tracer(ROOT)
    status: int | None = None
    try:
        with (
            tempfile.TemporaryDirectory() as folder,
            contextlib.redirect_stdout(printed),
            contextlib.redirect_stderr(printed),
        ):
            status = PATHS[options.path](tracer, Path(folder))
    finally:
        if status != 0:
            print(printed.getvalue(), file=sys.stderr)
    if status:
        print(f"the traced command ended with exit status {status}", file=sys.stderr)
        return 1
    trace = tracer.trace()
    if options.list:
        for file, functions in trace.functions.items():
            print(file, *(f"    {name}" for name in functions), sep="\n")
    Console().print(table(options.path, trace))
    if options.json:
        text = json.dumps({"numbers": trace.numbers(), **asdict(trace)}, indent=1)
        options.json.write_text(text + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
