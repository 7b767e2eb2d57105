"""Counts the functions that run in all threads, and the modules that are imported."""

from __future__ import annotations

import os
import re
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from inspect import CO_OPTIMIZED
from pathlib import Path
from types import CodeType, FrameType, TracebackType
from typing import Any

PACKAGES = ("models", "encoders", "tasks", "sandbox")
MODULE = "<module>"
INSIDE = {"<listcomp>", "<setcomp>", "<dictcomp>", "<genexpr>"}
"""Names of code that belongs to the function around it. From Python 3.12 on, most of them have no
separate code."""
RE = str(Path(re.__file__).parent) + os.sep
"""Folder of the module `re`."""


@dataclass(frozen=True)
class Trace:
    """Files, functions and classes of this project that ran. Paths are relative to the project's
    root, with slashes.

    Attributes:
        imported: Files whose module body ran, in order.
        functions: File -> its functions that ran, as NAME:LINE. Files and functions are in the
            order in which they first took part.
        classes: Classes of which a method ran, as FILE:NAME, in order.
        calls: Number of calls of Python code in all files, also in imports.
        re_calls: Number of these calls that were of functions of the module `re`.
    """

    imported: list[str]
    functions: dict[str, list[str]]
    classes: list[str]
    calls: int
    re_calls: int

    def numbers(self) -> dict[str, int]:
        """The counts by name."""
        return {
            "files imported": len(self.imported),
            "files that took part": len(self.functions),
            "functions": sum(map(len, self.functions.values())),
            "classes": len(self.classes),
            "calls of Python code": self.calls,
            "calls of module re": self.re_calls,
        }


class Tracer:
    """Watches the thread that enters it, and all threads that start afterwards.

    Args:
        root: Folder of the project.
        packages: Names of the folders in it whose files are the project's own.

    Attributes:
        counting: True while functions and calls are counted; may be changed from any thread.
            Imports are always counted.
    """

    def __init__(self, root: Path, packages: Sequence[str] = PACKAGES) -> None:
        self._root, self._packages = root.resolve(), set(packages)
        self.counting = True
        # By id: equal code in two files, such as two empty modules, compares as equal.
        self._codes: dict[int, CodeType] = {}
        self._calls: dict[int, int] = {}
        self._modules: dict[int, None] = {}
        self._functions: dict[int, None] = {}
        self._thread = threading.local()

    def __enter__(self) -> Tracer:
        threading.setprofile(self._see)
        sys.setprofile(self._see)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        sys.setprofile(None)
        threading.setprofile(None)
        self.counting = False

    def _see(self, frame: FrameType, event: str, argument: Any) -> None:
        if event not in ("call", "return"):
            return
        code = frame.f_code
        key, is_module = id(code), code.co_name == MODULE
        # Number of nested imports in this thread.
        imports: int = getattr(self._thread, "imports", 0)
        if is_module:
            self._thread.imports = imports + (1 if event == "call" else -1)
            self._codes[key] = code
            self._modules.setdefault(key)
        if event == "call" and self.counting:
            self._codes[key] = code
            self._calls[key] = self._calls.get(key, 0) + 1
            if not (is_module or imports):
                self._functions.setdefault(key)

    def trace(self) -> Trace:
        """The trace up to now."""
        functions: dict[str, dict[str, None]] = {}
        classes: dict[str, None] = {}
        for code in map(self._codes.__getitem__, self._functions):
            file = self._own(code)
            if not file or not code.co_flags & CO_OPTIMIZED or code.co_name in INSIDE:
                continue
            functions.setdefault(file, {})[f"{code.co_qualname}:{code.co_firstlineno}"] = None
            owner = code.co_qualname.rpartition(".")[0]
            if owner and not owner.endswith("<locals>"):
                classes[f"{file}:{owner}"] = None
        re_codes = {k for k, code in self._codes.items() if code.co_filename.startswith(RE)}
        imported = dict.fromkeys(self._own(self._codes[key]) for key in self._modules)
        return Trace(
            [file for file in imported if file],
            {file: list(names) for file, names in functions.items()},
            list(classes),
            sum(self._calls.values()),
            sum(count for key, count in self._calls.items() if key in re_codes),
        )

    def _own(self, code: CodeType) -> str | None:
        """File of a code object, relative to the project; None for a file outside the project."""
        path = Path(code.co_filename)
        if not path.is_relative_to(self._root):
            return None
        inside = path.relative_to(self._root)
        return inside.as_posix() if inside.parts[0] in self._packages else None
