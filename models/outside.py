"""Loads tasks and devices of other people: entry points of installed packages, Python files.

Outside code runs only when its task or device is asked for. Its errors are shortened to one line.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from hashlib import blake2b
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any


def offered(group: str) -> dict[str, list[EntryPoint]]:
    """Entry points of a group that installed packages offer, by name; nothing of it is loaded."""
    entries: dict[str, list[EntryPoint]] = {}
    for entry in sorted(entry_points(group=group), key=lambda e: (e.name, e.value)):
        # A package that is on the path twice, as in a checkout, has every entry point twice.
        same = entries.setdefault(entry.name, [])
        if entry.value not in [e.value for e in same]:
            same.append(entry)
    return entries


def package(entry: EntryPoint) -> str:
    """Name and version of the package that offers an entry point."""
    return f"{entry.dist.name} {entry.dist.version}" if entry.dist else "an unnamed package"


def failure(error: BaseException) -> str:
    """One line about an error in outside code: the error, and the file and line that raised it."""
    trace = traceback.extract_tb(error.__traceback__)
    text = f"{type(error).__name__}: {' '.join(str(error).split())[:300]}"
    # Lines of Python's import machinery do not help the reader.
    theirs = [step for step in trace if not step.filename.startswith("<frozen")]
    if isinstance(error, SyntaxError | ImportError) or not theirs:
        return text
    return f"{text} ({theirs[-1].filename}:{theirs[-1].lineno})"


_FILES: dict[str, Path] = {}
"""Name of a module that `load_file` has made -> its file."""

_neighbours: dict[str, Path] = {}
"""Modules that loaded files have imported from their own folders, and that folder."""


@contextmanager
def _importing_from(folder: Path) -> Iterator[None]:
    """Lets `import NAME` find NAME.py in a folder, after everything else on Python's path.

    Files of two folders may each have a neighbour of the same name: each gets its own.
    """
    for name, owner in list(_neighbours.items()):
        if owner != folder and _is_beside(folder, name):
            sys.modules.pop(name, None)
            del _neighbours[name]
    before = set(sys.modules)
    sys.path.append(str(folder))
    importlib.invalidate_caches()
    try:
        yield
    finally:
        sys.path.remove(str(folder))
        new = set(sys.modules) - before
        _neighbours.update({name: folder for name in new if _is_beside(folder, name)})


def _is_beside(folder: Path, name: str) -> bool:
    """True if a folder holds the module or package of a dotted name."""
    top = folder / name.partition(".")[0]
    return top.with_suffix(".py").is_file() or (top / "__init__.py").is_file()


@cache
def load_file(path: Path) -> ModuleType:
    """Loads a Python file as a module; its errors pass through unchanged.

    While the file runs, it can import modules that lie beside it.

    Args:
        path: Absolute, of a Python file.
    """
    # A unique name, so that it hides no other module; dataclasses look up their module by name.
    name = f"{path.stem}_{blake2b(str(path).encode(), digest_size=4).hexdigest()}"
    _FILES[name] = path
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        with _importing_from(path.parent):
            spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def loaded_from(module: str) -> Path | None:
    """The file of a module that has no name to import it by: of a file loaded, or of a script."""
    if module == "__main__":
        script = sys.modules[module].__dict__.get("__file__")
        return Path(script).resolve() if script else None
    return _FILES.get(module)


def place_of(source: Mapping[str, Any]) -> str:
    """`FILE.py:CLASS` or `MODULE:CLASS`, as what was recorded of somebody else's class tells it.

    Args:
        source: `file` and `member`, or `entry_point`, perhaps with `package` and `version`.
    """
    if source.get("file"):
        return f"{source['file']}:{source.get('member', '')}"
    return str(source.get("entry_point", ""))


def how_to_get(source: Mapping[str, Any]) -> str:
    """The next step for whoever lacks that class: what to install, or what to put where."""
    if source.get("package"):
        return f"Install it: pip install '{source['package']}=={source.get('version')}'"
    if source.get("file"):
        return f"Put {Path(str(source['file'])).name} back where it was"
    module = str(source.get("entry_point", "")).partition(":")[0]
    return f"Put the module {module} on the path: PYTHONPATH=its folder"
