"""For which systems and Pythons every dependency has a wheel.

    pip install -e ".[release]"
    python -m tools.release.wheels               # prints the table
    python -m tools.release.wheels --keep        # also writes docs/measured/laptops.md

uv resolves each extra for another system and another Python from the package index, with wheels
alone. A package without a wheel there is then allowed to be built from its source: if it is plain
Python, pip does so by itself, and if not, a compiler is needed. Nothing is installed, so this says
nothing of whether it runs.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Collection, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import date
from importlib.util import find_spec
from itertools import product
from pathlib import Path

from tools.docs.markdown_table import markdown_table

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "measured" / "laptops.md"
SYSTEMS = {
    "Windows, x86-64": "x86_64-pc-windows-msvc",
    "macOS, Apple silicon": "aarch64-apple-darwin",
    "macOS, Intel": "x86_64-apple-darwin",
    "Linux, x86-64": "x86_64-unknown-linux-gnu",
    "Linux, ARM": "aarch64-unknown-linux-gnu",
}
"""System -> its name for uv."""
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
AT_A_TIME = 10
"""Questions to the index at a time."""
LEFT_OUT = ("dev", "lint", "release")
"""Extras of developers that no laptop of a user needs."""
_WITHOUT = re.compile(r"hint: Wheels are required for `([\w.-]+)`")
_CAUSE = re.compile(r"cause: Because ([^\s<>=]+)[^\n]* (?:has|have) no wheels")


@dataclass(frozen=True)
class Resolved:
    """The answer for one extra, system and Python.

    Attributes:
        sources: Packages that have no wheel and come as source.
        problem: Cause for which no set of packages exists; empty if one does.
    """

    sources: tuple[str, ...] = ()
    problem: str = ""

    def beyond(self, known: Collection[str]) -> str:
        """What is lacking besides packages that are known to lack; empty if nothing is."""
        more = [f"`{name}`" for name in self.sources if name not in known]
        return self.problem or " ".join(more)


def extras() -> list[str]:
    """Extras of the project; the first, empty one stands for the program alone."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return ["", *(name for name in project["optional-dependencies"] if name not in LEFT_OUT)]


def resolved(extra: str, system: str, python: str) -> Resolved:
    """Resolves an extra for a system and a Python.

    Args:
        extra: Its name; empty for the program alone.
        system: A value of `SYSTEMS`.
        python: Such as 3.13.
    """
    asked = ["uv", "pip", "compile", "pyproject.toml", "--no-header", "--quiet", "--color=never"]
    asked += ["--only-binary", ":all:", "--python-platform", system, "--python-version", python]
    asked += ["--python", sys.executable, *(["--extra", extra] if extra else [])]
    sources: list[str] = []
    while True:
        allowed = [word for name in sources for word in ("--no-binary", name)]
        # A line that is broken would break names as well.
        done = subprocess.run(
            [sys.executable, "-m", *asked, *allowed],
            cwd=ROOT,
            env={**os.environ, "COLUMNS": "10000", "UV_PYTHON_DOWNLOADS": "never"},
            capture_output=True,
            text=True,
            check=False,
        )
        if not done.returncode:
            return Resolved(tuple(sources))
        without = _WITHOUT.search(done.stderr)
        if without is None or without[1] in sources:
            cause = _CAUSE.search(done.stderr)
            problem = f"`{cause[1]}` cannot be had" if cause else done.stderr.strip()
            return Resolved(problem=problem)
        sources.append(without[1])


def rows() -> Iterator[tuple[str, ...]]:
    """Rows of the table: an extra, then for each system what it lacks beyond the program itself."""
    combinations = list(product(SYSTEMS.values(), PYTHONS))
    known: dict[tuple[str, str], tuple[str, ...]] = {}
    # uv mostly waits for the index.
    with ThreadPoolExecutor(AT_A_TIME) as pool:
        for extra in extras():
            asked = [(extra, *one) for one in combinations]
            answers = pool.map(lambda one: resolved(*one), asked)
            lacking = dict(zip(combinations, answers, strict=True))
            cells = []
            for system in SYSTEMS.values():
                words = {}
                for python in PYTHONS:
                    words[python] = lacking[system, python].beyond(known.get((system, python), ()))
                cells.append(_cell(words))
            if not extra:
                known = {one: answer.sources for one, answer in lacking.items()}
            row = (f"`{extra}`" if extra else "the program", *cells)
            print(" | ".join(row), file=sys.stderr, flush=True)
            yield row


def _cell(words: dict[str, str]) -> str:
    """What is lacking by Python, said once where it is the same on all of them."""
    different = set(words.values())
    if len(different) == 1:
        return different.pop() or "wheels"
    return "; ".join(f"{python}: {lacks}" for python, lacks in words.items() if lacks)


def page(table: str) -> str:
    """The page with the table."""
    return f"""# Any laptop

`python -m tools.release.wheels --keep`, {date.today():%B %Y}. For Python {", ".join(PYTHONS)}.

A cell says `wheels` where every dependency has a wheel on all these Pythons, and otherwise names
what has none: pip builds plain Python from source by itself, and all else needs a compiler. The
rows of extras leave out what the program itself lacks. **Nothing was installed or run**: no Windows
and no macOS was at hand ([installing.md](../installing.md#other-systems)).

{table}
"""


def main() -> int:
    """Prints the table; returns 2 if uv is missing."""
    parser = argparse.ArgumentParser(
        prog="python -m tools.release.wheels",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--keep", action="store_true", help=f"write {PAGE.relative_to(ROOT)}")
    options = parser.parse_args()
    if find_spec("uv") is None:
        print('uv is missing: pip install -e ".[release]"', file=sys.stderr)
        return 2
    table = markdown_table(("extra", *SYSTEMS), rows())
    print(table)
    if options.keep:
        PAGE.write_text(page(table), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
