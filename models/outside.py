"""Loads tasks and devices of other people: entry points of installed packages, Python files.

Outside code runs only when its task or device is asked for. Its errors are shortened to one line.
"""

from __future__ import annotations

import importlib.util
import sys
import traceback
from functools import cache
from hashlib import blake2b
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType


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


@cache
def load_file(path: Path) -> ModuleType:
    """Loads a Python file as a module; its errors pass through unchanged.

    Args:
        path: Absolute, of a Python file.
    """
    # A unique name, so that it hides no other module; dataclasses look up their module by name.
    name = f"{path.stem}_{blake2b(str(path).encode(), digest_size=4).hexdigest()}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module
