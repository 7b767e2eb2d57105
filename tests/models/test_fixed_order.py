"""What becomes part of a state is computed in a fixed order: every machine gets the same bits."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

ROOMS = (
    "models/*.py",
    "models/robot/*.py",
    "encoders/*.py",
    "encoders/labels/*.py",
    "encoders/paalm/*.py",
    "encoders/person/*.py",
    "encoders/reconstruction/*.py",
    "encoders/regression/*.py",
    "encoders/air/*.py",
    "tasks/*.py",
    "tasks/simulated_user/*.py",
    "sandbox/devices/*.py",
    "sandbox/devices/simulated/*.py",
    "sandbox/devices/wrappers/*.py",
    "sandbox/session/*.py",
    "sandbox/trial/*.py",
)
"""Where what a recording replays is computed."""

TABLES = (
    "sandbox/study/design/design.py",
    "sandbox/study/design/questionnaires.py",
    "sandbox/study/measures/*.py",
    "sandbox/study/tables/*.py",
)
"""Where tables are computed that are compared when they are made anew."""

APART = {
    "models/kinematics.py": "captures and training",
    "encoders/capture.py": "captures",
    "encoders/labels/hand_split.py": "a study of labels, not a session",
    "encoders/paalm/angles.py": "measured angles of tracked joints, for evaluations",
    "encoders/paalm/calibration.py": "a calibration's file holds the result",
    "encoders/paalm/coupling.py": "a calibration's file holds the result",
    "encoders/person/hand_size.py": "a profile's file holds the result",
    "encoders/regression/bone_fit.py": "training",
    "encoders/regression/least_squares.py": "training",
    "encoders/regression/training.py": "training",
    "encoders/regression/trained.py": "training; what ships is stored",
    "encoders/validation.py": "training",
    "sandbox/session/contact_forces.py": "what views say about a grip",
    "models/robot/mapping_fit.py": "a mapping's file holds the result",
    "models/person.py": "turns by quarters, whose products are exact in any order",
    "tasks/task_checks.py": "checks of a draw",
    "tasks/guarded.py": "checks of a draw",
}
"""Files of these rooms that make no state, and what they are for."""

MARK = "# any order:"
"""Stands on a line that may use what is refused elsewhere, with the reason."""

PRODUCTS = {"dot", "matmul", "inner", "vdot", "tensordot", "einsum", "linalg", "lapack", "blas"}
FUNCTIONS = {
    *("sin", "cos", "tan", "exp", "exp2", "expm1", "log", "log2", "log10", "log1p", "logaddexp"),
    *("arctan", "arctan2", "arcsin", "arccos", "hypot", "power", "float_power", "sinc", "cbrt"),
    *("sinh", "cosh", "tanh", "arcsinh", "arccosh", "arctanh", "angle", "quantile", "percentile"),
}
"""NumPy's functions of which several versions exist, chosen by the processor."""
PYTHON = {"hypot", "dist", "sumprod"}
"""Functions of `math` that versions of Python compute in different ways."""
WHOLE = {"len", "int", "bool", "any", "all", "isinstance", "str.isupper"}
"""Functions whose results are whole numbers, True or False."""


def refused(tree: ast.Module) -> Iterator[tuple[ast.expr | ast.stmt, str]]:
    """Parts of a file whose last digits depend on the machine, and what they are."""
    for node in ast.walk(tree):
        if isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.MatMult):
            yield node, "@"
        elif isinstance(node, ast.Attribute):
            of_numpy = isinstance(node.value, ast.Name) and node.value.id == "np"
            of_math = isinstance(node.value, ast.Name) and node.value.id == "math"
            if node.attr in PRODUCTS or (of_numpy and node.attr in FUNCTIONS):
                yield node, node.attr
            elif of_math and node.attr in PYTHON:
                yield node, f"math.{node.attr}"
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = {alias.name for alias in node.names}
            if node.module == "math" and names & PYTHON:
                yield node, f"math.{', '.join(names & PYTHON)}"
            elif node.module.partition(".")[0] == "scipy":
                yield node, node.module
        elif (
            isinstance(node, ast.Call)
            and ast.unparse(node.func) == "sum"
            and not adds_whole_numbers(node)
        ):
            yield node, "sum, which is not the same in all versions of Python"


def adds_whole_numbers(call: ast.Call) -> bool:
    """True if it can be seen that a `sum` adds only counts, answers or bits."""
    terms = call.args[0]
    if isinstance(terms, ast.GeneratorExp | ast.ListComp | ast.SetComp):
        return whole(terms.elt)
    if isinstance(terms, ast.Call) and isinstance(terms.func, ast.Name) and terms.args:
        return terms.func.id == "map" and ast.unparse(terms.args[0]) in WHOLE
    return False


def whole(value: ast.expr) -> bool:
    """True if it can be seen that a value is a whole number, True or False."""
    match value:
        case ast.Constant():
            return isinstance(value.value, int)
        case ast.Compare() | ast.UnaryOp(op=ast.Not()) | ast.BinOp(op=ast.LShift()):
            return True
        case ast.BoolOp():
            return all(map(whole, value.values))
        case ast.Call():
            return ast.unparse(value.func) in WHOLE
        case ast.IfExp():
            return whole(value.body) and whole(value.orelse)
    return False


def marked(tree: ast.Module, lines: list[str], node: ast.AST) -> bool:
    """True if the statement around a part of a file says why any order will do."""
    line = node.lineno  # type: ignore[attr-defined]
    spans = [
        (s.end_lineno - s.lineno, s.lineno, s.end_lineno)
        for s in ast.walk(tree)
        if isinstance(s, ast.stmt) and s.end_lineno and s.lineno <= line <= s.end_lineno
    ]
    _, first, last = min(spans)
    return any(MARK in text for text in lines[first - 1 : last])


def files() -> list[str]:
    found = {str(p.relative_to(ROOT)) for room in ROOMS for p in ROOT.glob(room)}
    assert set(APART) <= found, sorted(set(APART) - found)
    return sorted(found - set(APART))


def found_in(path: Path) -> list[str]:
    """What a file leaves to the machine, with its line."""
    text = path.read_text()
    tree, lines = ast.parse(text), text.splitlines()
    return [
        f"{path.name}:{node.lineno}: {what}. Use models.arithmetic, or say after `{MARK}` on the "
        "line why any order will do"
        for node, what in refused(tree)
        if not marked(tree, lines, node)
    ]


@pytest.mark.parametrize("name", files())
def test_a_room_that_makes_states_leaves_no_rounding_to_the_machine(name: str) -> None:
    assert not found_in(ROOT / name)


@pytest.mark.parametrize(
    "path", sorted(p for room in TABLES for p in ROOT.glob(room)), ids=lambda path: path.name
)
def test_tables_add_floats_in_the_same_way_on_every_python(path: Path) -> None:
    assert not [text for text in found_in(path) if ": sum," in text]
