"""Code that is not ours: what installed packages offer, files that are loaded, and their errors.

Tasks and devices of other people come this way. Nothing of theirs is run before it is asked for.
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
        # A package that is on the path twice, as in a checkout, offers the same thing twice.
        same = entries.setdefault(entry.name, [])
        if entry.value not in [e.value for e in same]:
            same.append(entry)
    return entries


def package(entry: EntryPoint) -> str:
    """Name and version of the package that offers an entry point."""
    return f"{entry.dist.name} {entry.dist.version}" if entry.dist else "an unnamed package"


def failure(error: BaseException) -> str:
    """An error of somebody else's code in a line: what, and in which line of which file."""
    trace = traceback.extract_tb(error.__traceback__)
    text = f"{type(error).__name__}: {' '.join(str(error).split())[:300]}"
    # The machinery of imports says nothing to anybody.
    theirs = [step for step in trace if not step.filename.startswith("<frozen")]
    if isinstance(error, SyntaxError | ImportError) or not theirs:
        return text
    return f"{text} ({theirs[-1].filename}:{theirs[-1].lineno})"


@cache
def load_file(path: Path) -> ModuleType:
    """The module in a file, run once; whatever it raises comes through.

    Args:
        path: Absolute, of a Python file.
    """
    # A name of its own, so that it hides no module; dataclasses look their module up by name.
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
