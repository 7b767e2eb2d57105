"""Prints the counts by which the state of this repository is compared before and after a change.

    python -m tools.count_house             # structure and language, in seconds
    python -m tools.count_house --times     # also the start of `sandbox --help`

Counts of language are found by patterns: they show whether a habit fades, not every sentence.
"""

from __future__ import annotations

import argparse
import ast
import re
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator

from tools.house import PACKAGES, ROOT, House, Module, circles, python_files, read_module

SMALL = 80
"""Lines under which a file with one importer is counted."""
MOST_FILES = 18
OPENINGS = ("What", "Who", "Whether", "How", "Of", "As")
"""First words of docstrings that hide what a thing is or does."""


def structure(house: House) -> Iterator[tuple[str, object]]:
    """Counts of folders, arrows and circles."""
    files = {folder: len(paths) for folder, paths in house.files_by_folder.items()}
    importers = house.importers()
    lonely = [m for m in house.modules.values() if len(importers[m.name]) == 1 and not m.is_face]
    yield "Python files in the packages", len(house.modules)
    yield "folders with Python files", len(files)
    full = {folder: n for folder, n in sorted(files.items()) if n > MOST_FILES}
    yield f"folders with more than {MOST_FILES} files", f"{len(full)} {full or ''}"
    yield "arrows between folders", sum(map(len, house.folder_arrows.values()))
    yield "arrows between modules", sum(map(len, house.arrows.values()))
    yield "circles of modules", len(circles(house.arrows))
    yield "circles of folders", len(circles(house.folder_arrows))
    yield "files with one importer", len(lonely)
    yield f"files with one importer and under {SMALL} lines", sum(m.lines < SMALL for m in lonely)
    for package in PACKAGES:
        own = [m for m in house.modules.values() if m.name.split(".")[0] == package]
        yield f"lines of {package}", sum(m.lines for m in own)
    yield "lines of the packages", sum(m.lines for m in house.modules.values())


def docstrings(tree: ast.Module) -> Iterator[str]:
    """All docstrings of a file."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            text = ast.get_docstring(node)
            if text:
                yield text


def strings(tree: ast.Module) -> Iterator[str]:
    """All string literals of a file, docstrings and pieces of f-strings among them."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def names(tree: ast.Module) -> Iterator[str]:
    """All names that a file assigns to or passes by."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id


def calls(tree: ast.Module) -> Iterator[str]:
    """Names of plain functions that a file calls."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            yield node.func.id


def language(modules: list[Module]) -> Iterator[tuple[str, object]]:
    """Counts of habits that make the text hard to read, and of questions to objects."""
    texts = [text for m in modules for text in strings(m.tree)]
    documented = [text for m in modules for text in docstrings(m.tree)]
    opening = re.compile(rf"(?:{'|'.join(OPENINGS)})\b")
    asked = [name for m in modules for name in calls(m.tree)]
    yield "uses of hasattr and getattr", asked.count("hasattr") + asked.count("getattr")
    yield "uses of vars", asked.count("vars")
    yield 'strings that say "is no ..."', sum(bool(re.search(r"\bis no [a-z]", t)) for t in texts)
    yield (
        'attribute lines that begin "Of ..."',
        sum(len(re.findall(r"^\s+\w+: Of ", t, re.MULTILINE)) for t in documented),
    )
    yield "results called `found`", [n for m in modules for n in names(m.tree)].count("found")
    yield "docstrings", len(documented)
    yield (
        f"docstrings that begin with {', '.join(OPENINGS)}",
        sum(bool(opening.match(t)) for t in documented),
    )


def start_of_help() -> float:
    """Median seconds of `sandbox --help` over seven starts."""
    took = []
    for _ in range(7):
        begin = time.perf_counter()
        command = [sys.executable, "-m", "sandbox.cli.main", "--help"]
        subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
        took.append(time.perf_counter() - begin)
    return statistics.median(took)


def main() -> None:
    """Prints a line for every count."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--times", action="store_true", help="measure times as well")
    options = parser.parse_args()
    house = House.of_repository()
    rows = [*structure(house), *language(list(house.modules.values()))]
    tests = [read_module(path) for path in python_files("tests")]
    rows += [
        ("files of the tests", len(tests)),
        ("lines of the tests", sum(m.lines for m in tests)),
        (
            "uses of `fmt: skip`",
            sum(
                path.read_text().count("# fmt: skip")
                for path in python_files(*PACKAGES, "tests", "benchmarks")
            ),
        ),
        (
            "`Array = NDArray` defined",
            sum(
                path.read_text().count("\nArray = NDArray")
                for path in python_files(*PACKAGES, "tests")
            ),
        ),
    ]
    if options.times:
        rows.append(("seconds of `sandbox --help`", f"{start_of_help():.2f}"))
    for name, value in rows:
        print(f"{name:60} {value}")


if __name__ == "__main__":
    main()
