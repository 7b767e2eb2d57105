"""The structure of the four packages, read from the imports in their source.

Modules, the arrows between modules and between folders, and the circles among them. Nothing is
imported or run. `tools/count_house.py` prints counts of it; `tests/test_architecture.py` checks it
against `tools/arrows.toml`.
"""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path, PurePosixPath

PACKAGES = ("models", "encoders", "tasks", "sandbox")
ROOT = Path(__file__).resolve().parent.parent
NOT_SOURCE = {"node_modules", "static", "__pycache__"}
"""Folders with built or fetched files."""

Graph = Mapping[str, set[str]]
"""Name -> names that it imports."""


def python_files(*folders: str, root: Path = ROOT) -> list[Path]:
    """All Python files below the given folders of the repository, sorted."""
    return sorted(
        path
        for folder in folders
        for path in (root / folder).rglob("*.py")
        if not NOT_SOURCE & set(path.relative_to(root).parts)
    )


@dataclass(frozen=True)
class Module:
    """One Python file.

    Attributes:
        path: Relative to the repository, with slashes.
        name: Dotted; a package's `__init__.py` has the name of its folder.
        tree: Its syntax tree.
        lines: Number of lines.
    """

    path: str
    name: str
    tree: ast.Module = field(repr=False)
    lines: int

    @property
    def folder(self) -> str:
        """The folder that the file lies in, relative to the repository."""
        return str(PurePosixPath(self.path).parent)

    @property
    def is_face(self) -> bool:
        """True for an `__init__.py`: it hands names on and belongs to no room's contents."""
        return self.path.endswith("__init__.py")


def read_module(path: Path, root: Path = ROOT) -> Module:
    """Parses one file."""
    where = path.relative_to(root).as_posix()
    text = path.read_text(encoding="utf-8")
    name = where.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    return Module(where, name, ast.parse(text), len(text.splitlines()))


def imported_names(module: Module) -> Iterator[str]:
    """Dotted names that a module imports, at its top, in functions and for types alone.

    `from a.b import c` gives both `a.b` and `a.b.c`, because either may be a module.
    """
    package = module.name.split(".")
    if not module.is_face:
        package = package[:-1]
    for node in ast.walk(module.tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            base = ".".join([*above, *filter(None, [node.module])])
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


@dataclass(frozen=True)
class House:
    """All modules of the four packages and the arrows between them."""

    modules: dict[str, Module]

    @classmethod
    def of_repository(cls, root: Path = ROOT) -> House:
        """Reads the four packages of a checkout."""
        found = (read_module(path, root) for path in python_files(*PACKAGES, root=root))
        return cls({module.name: module for module in found})

    @cached_property
    def arrows(self) -> dict[str, set[str]]:
        """Module -> modules of the four packages that it imports."""
        graph: dict[str, set[str]] = {}
        for module in self.modules.values():
            names = set(imported_names(module))
            targets = {name for name in names if name in self.modules}
            # `from a.b import c` with a module c: the arrow goes to c, not to the package's face.
            targets -= {
                face
                for face in targets
                if self.modules[face].is_face and not self._takes_from_face(names, face)
            }
            graph[module.name] = targets - {module.name}
        return graph

    def _takes_from_face(self, names: set[str], face: str) -> bool:
        """Whether something that is no module is imported from a package's `__init__.py`."""
        below = [n for n in names if n.rpartition(".")[0] == face]
        return not below or any(n not in self.modules for n in below)

    @cached_property
    def folder_arrows(self) -> dict[str, set[str]]:
        """Folder -> other folders that its files import; what faces hand on is left out."""
        graph: dict[str, set[str]] = {m.folder: set() for m in self.modules.values()}
        for module in self.modules.values():
            if not module.is_face:
                graph[module.folder] |= {
                    self.modules[target].folder for target in self.arrows[module.name]
                } - {module.folder}
        return graph

    @cached_property
    def files_by_folder(self) -> dict[str, list[str]]:
        """Folder -> its Python files without `__init__.py`."""
        files: dict[str, list[str]] = defaultdict(list)
        for module in self.modules.values():
            if not module.is_face:
                files[module.folder].append(module.path)
        return dict(files)

    def importers(self) -> dict[str, set[str]]:
        """Module -> modules of the four packages that import it."""
        back: dict[str, set[str]] = {name: set() for name in self.modules}
        for source, targets in self.arrows.items():
            for target in targets:
                back[target].add(source)
        return back


def circles(graph: Graph) -> list[list[str]]:
    """Groups of names that reach one another: strongly connected parts of more than one name.

    Tarjan's algorithm, without recursion.
    """
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    result: list[list[str]] = []
    for root in graph:
        if root in index:
            continue
        work: list[tuple[str, Iterator[str]]] = [(root, iter(sorted(graph[root])))]
        index[root] = low[root] = len(index)
        stack.append(root)
        while work:
            name, rest = work[-1]
            for target in rest:
                if target not in index:
                    index[target] = low[target] = len(index)
                    stack.append(target)
                    work.append((target, iter(sorted(graph.get(target, ())))))
                    break
                if target in stack:
                    low[name] = min(low[name], index[target])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[name])
                if low[name] == index[name]:
                    part = stack[stack.index(name) :]
                    del stack[stack.index(name) :]
                    if len(part) > 1:
                        result.append(sorted(part))
    return sorted(result)


def arrows_between(graph: Graph, names: Iterable[str]) -> list[tuple[str, str]]:
    """The arrows of a graph that begin and end in some names."""
    inside = set(names)
    return sorted((a, b) for a in inside for b in graph.get(a, ()) if b in inside)
