"""Sections of attributes in docstrings: each name is an attribute of its class."""

from __future__ import annotations

import ast
import inspect
import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("models", "encoders", "tasks", "sandbox")


@cache
def classes() -> dict[str, list[tuple[Path, ast.ClassDef]]]:
    """Classes of the packages by name; several may share one."""
    found: dict[str, list[tuple[Path, ast.ClassDef]]] = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            if "node_modules" in path.parts:
                continue
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ClassDef):
                    found.setdefault(node.name, []).append((path, node))
    return found


def listed(doc: str | None) -> list[str]:
    """What stands before the colons of a docstring's attributes; a line without one as a whole."""
    _, _, section = inspect.cleandoc(doc or "").partition("\nAttributes:\n")
    lines = re.split(r"^(?=\S)", section, maxsplit=1, flags=re.M)[0].splitlines()
    return [line.strip().partition(": ")[0] for line in lines if re.match(r" {4}\S", line)]


def members(node: ast.ClassDef) -> set[str]:
    """Names that a class and those that it is derived from define, or set on `self`."""
    names = set()
    for each in ast.walk(node):
        if isinstance(each, ast.FunctionDef):
            names.add(each.name)
        elif isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store):
            names.add(each.id)
        elif isinstance(each, ast.Attribute) and isinstance(each.ctx, ast.Store):
            names.add(each.attr)
    for base in node.bases:
        base = base.value if isinstance(base, ast.Subscript) else base
        name = base.attr if isinstance(base, ast.Attribute) else getattr(base, "id", "")
        for _, other in classes().get(name, []):
            names |= members(other) if other is not node else set()
    return names


@pytest.mark.parametrize("package", PACKAGES)
def test_every_name_among_a_docstring_s_attributes_is_an_attribute(package: str) -> None:
    wrong = [
        f"{path.relative_to(ROOT)} {name}: {entry}"
        for name, nodes in classes().items()
        for path, node in nodes
        if path.is_relative_to(ROOT / package)
        for entry in listed(ast.get_docstring(node))
        if not set(entry.split(", ")) <= members(node)
    ]
    assert not wrong
