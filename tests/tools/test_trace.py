"""The trace names what ran, all of it and nothing else."""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path

import pytest

from tests.support.processes import printed
from tools.trace.__main__ import ROOT
from tools.trace.paths import PATHS
from tools.trace.tracer import PACKAGES, Tracer

SHAPES = """
import math
from traced.sizes import doubled

def at_import(function):
    return function

class Square:
    def __init__(self, side):
        self.side = side

    @property
    def area(self):
        def product():
            return self.side * self.side
        return product()

    def never(self):
        return [square() for square in ()]

class Circle:
    @at_import
    def area(self):
        return math.pi

def total(sides):
    return sum(Square(side).area for side in sorted(sides, key=lambda side: -side))
"""
SIZES = """
import threading

def doubled(numbers):
    found = []
    thread = threading.Thread(target=lambda: found.extend([2 * n for n in numbers]))
    thread.start()
    thread.join()
    return found
"""


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project with two packages; the first one is its own."""
    for name, text in {
        "traced/__init__.py": "",
        "traced/empty.py": "",
        "traced/shapes.py": SHAPES,
        "traced/sizes.py": SIZES,
        "foreign/__init__.py": "def function():\n    import traced.empty\n",
    }.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    for name in list(sys.modules):
        if name.partition(".")[0] in ("traced", "foreign"):
            monkeypatch.delitem(sys.modules, name)
    return tmp_path


def test_the_functions_that_ran_are_named_in_their_order_and_no_others(tree: Path) -> None:
    with Tracer(tree, ["traced"]) as tracer:
        shapes = importlib.import_module("traced.shapes")
        assert shapes.total(shapes.doubled([1, 2])) == 20
    trace = tracer.trace()
    names = {
        file: [name.rpartition(":")[0] for name in functions]
        for file, functions in trace.functions.items()
    }
    assert list(names.items()) == [
        ("traced/sizes.py", ["doubled", "doubled.<locals>.<lambda>"]),
        (
            "traced/shapes.py",
            [
                "total",
                "total.<locals>.<lambda>",
                "Square.__init__",
                "Square.area",
                "Square.area.<locals>.product",
            ],
        ),
    ]
    assert trace.classes == ["traced/shapes.py:Square"]
    assert trace.imported == ["traced/__init__.py", "traced/shapes.py", "traced/sizes.py"]


def test_a_function_has_the_line_of_its_definition(tree: Path) -> None:
    with Tracer(tree, ["traced"]) as tracer:
        importlib.import_module("traced.shapes").doubled([])
    for file, functions in tracer.trace().functions.items():
        lines = (tree / file).read_text().splitlines()
        for name in functions:
            of, _, number = name.rpartition(":")
            definition = "lambda" if of.endswith("<lambda>") else f"def {of}("
            assert definition in lines[int(number) - 1]


TRACED = """
import sys
from pathlib import Path
from tools.trace.paths import PATHS
from tools.trace.tracer import Tracer
root = Path(sys.argv[1])
tracer = Tracer(root)
assert PATHS["regress"](tracer, Path(sys.argv[2])) == 0
loaded = [m.__file__ for n, m in sys.modules.items() if n.partition(".")[0] in sys.argv[3:]]
assert {str(root / file) for file in tracer.trace().imported} == set(loaded)
"""


@pytest.mark.slow
def test_all_imports_of_a_fresh_process_are_counted(tmp_path: Path) -> None:
    printed("-c", TRACED, ROOT, tmp_path, *PACKAGES)


@pytest.mark.slow
@pytest.mark.parametrize("path", PATHS)
def test_each_path_names_files_of_this_project_that_it_imported(path: str, tmp_path: Path) -> None:
    out = tmp_path / "trace.json"
    printed("-m", "tools.trace", path, "--list", "--json", out)
    trace = json.loads(out.read_text(encoding="utf-8"))
    assert all((ROOT / file).is_file() for file in trace["imported"])
    assert {file.partition("/")[0] for file in trace["imported"]} == set(PACKAGES)
    assert trace["functions"] and set(trace["functions"]) <= set(trace["imported"])
    # The steps of a touch are counted, not the command that builds the session.
    began_with_the_command = next(iter(trace["functions"])) == "sandbox/cli/main.py"
    assert began_with_the_command == (path != "touch")
    assert path != "touch" or "sandbox/cli/main.py" not in trace["functions"]
