"""Which modules of the four packages import which, read from their source."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("models", "encoders", "tasks", "sandbox")
NOT_SOURCE = {"node_modules", "static"}
"""Folders with built or fetched files."""


def modules() -> dict[str, Path]:
    """Dotted name -> file of every module; a package's `__init__.py` has its folder's name."""
    found = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            place = path.relative_to(ROOT)
            if not NOT_SOURCE & set(place.parts):
                name = place.as_posix().removesuffix(".py").removesuffix("/__init__")
                found[name.replace("/", ".")] = path
    return found


def import_graph() -> dict[str, set[str]]:
    """Module -> modules that it imports, at its top, in functions and for types alone."""
    known = modules()
    graph = {}
    for name, path in known.items():
        names = set(imported_names(name, path))
        targets = names & known.keys()
        # `from a.b import c` with a module c: the arrow goes to c, not to the package a.b.
        for target in list(targets):
            below = {other for other in names if other.rpartition(".")[0] == target}
            if known[target].name == "__init__.py" and below and below <= known.keys():
                targets.discard(target)
        graph[name] = targets - {name}
    return graph


def imported_names(module: str, path: Path) -> Iterator[str]:
    """Dotted names that a module imports. `from a.b import c` gives both `a.b` and `a.b.c`."""
    package = module.split(".")
    if path.name != "__init__.py":
        package = package[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            base = ".".join([*above, *filter(None, [node.module])])
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)
