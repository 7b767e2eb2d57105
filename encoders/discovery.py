"""Loads external encoders: from installed packages by entry point, from a file or a module.

A package offers its encoders under a name:

    [project.entry-points."hand_sandbox.encoders"]
    my-lab-forest = "my_lab.encoders:Forest"

A package is loaded only when its encoder is requested. Errors in an encoder are reported then, in
one line; they do not affect other encoders.
"""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import blake2b
from importlib.metadata import EntryPoint
from pathlib import Path
from types import ModuleType
from typing import Any

from encoders.encoder import Encoder
from models import outside
from models.errors import EncoderError, HandSandboxError
from models.outside import failure, load_file, package

GROUP = "hand_sandbox.encoders"
"""Group of the entry points."""

HOW = "docs/write-an-encoder.md shows one"

_FILE = re.compile(r"(?P<file>.+\.py)(:(?P<member>[A-Za-z_]\w*))?")
_MODULE = re.compile(r"(?P<module>[A-Za-z_][\w.]*):(?P<member>[A-Za-z_]\w*)")


def offered() -> dict[str, list[EntryPoint]]:
    """Entry points of installed packages by name; loads none of them."""
    return outside.offered(GROUP)


def load_offered(name: str) -> type[Encoder] | None:
    """Loads an encoder that a package offers; returns None if no package offers it.

    Raises:
        EncoderError: Two packages offer it, or it cannot be used.
    """
    entries = offered().get(name, [])
    if not entries:
        return None
    if len(entries) > 1:
        raise EncoderError(
            "several packages offer an encoder of this name",
            where=name,
            got="; ".join(f"{e.value} of {package(e)}" for e in entries),
            remedy=f"Uninstall all but one, or name it by its place, such as {entries[0].value}",
        )
    entry = entries[0]
    where = f"entry point {name} = {entry.value} of {package(entry)}"
    with guarded("this encoder cannot be loaded", where):
        encoder = entry.load()
    return checked(encoder, where)


def is_place(text: str) -> bool:
    """True for a text of the form `FILE.py`, `FILE.py:CLASS` or `MODULE:CLASS`."""
    return bool(_FILE.fullmatch(text) or _MODULE.fullmatch(text))


def load_place(text: str) -> type[Encoder]:
    """Loads the encoder at a place; see `is_place`.

    Raises:
        EncoderError: The file or module does not exist, or contains no encoder.
    """
    in_file, in_module = _FILE.fullmatch(text), _MODULE.fullmatch(text)
    if in_file:
        path = Path(in_file["file"])
        if not path.is_file():
            raise EncoderError("no such file", where="the encoder's file", got=str(path))
        with guarded("this encoder cannot be loaded", str(path)):
            module = load_file(path.resolve())
        member = in_file["member"] or _only_encoder(module, str(path))
    else:
        assert in_module is not None
        with guarded("this encoder cannot be loaded", text):
            module = importlib.import_module(in_module["module"])
        member = in_module["member"]
    members = dict(inspect.getmembers(module))
    if member not in members:
        raise EncoderError(
            "the module has nothing of this name", where=text, got=member, expected=_names(module)
        )
    return checked(members[member], text)


def checked(candidate: Any, where: str) -> type[Encoder]:
    """Checks that a loaded object is an encoder class that can be instantiated.

    Raises:
        EncoderError: It is something else, lacks a method, or requires arguments.
    """
    if not (inspect.isclass(candidate) and issubclass(candidate, Encoder)):
        raise EncoderError(
            "not an encoder",
            where=where,
            got=repr(candidate)[:80],
            expected="a class that inherits from encoders.encoder.Encoder",
            remedy=HOW,
        )
    kind: type[Encoder] = candidate
    if inspect.isabstract(kind):
        lacking = sorted(
            name for name, value in inspect.getmembers(kind) if name in _REQUIRED and _open(value)
        )
        raise EncoderError(
            "this encoder lacks a method", where=where, got=f"no {', '.join(lacking)}", remedy=HOW
        )
    with guarded("this encoder cannot be created without arguments", where):
        kind()
    return kind


def source_digest(kind: type[Encoder]) -> str:
    """BLAKE2b of the file that defines a class, hexadecimal; imported files are not included.

    Raises:
        EncoderError: The class is not in a file, for example in an interactive session.
    """
    try:
        source = Path(inspect.getfile(kind)).read_bytes()
    except (OSError, TypeError) as error:
        raise EncoderError(
            "an encoder must be in a file",
            where=kind.__qualname__,
            got=str(error),
            remedy="Write the class to a file, and import it from there",
        ) from error
    return blake2b(source, digest_size=16).hexdigest()


@contextmanager
def guarded(what: str, where: str) -> Iterator[None]:
    """Converts any error of external code to an `EncoderError` of one line."""
    try:
        yield
    except HandSandboxError:
        raise
    except Exception as error:
        raise EncoderError(what, where=where, got=failure(error), remedy=HOW) from error


_REQUIRED = ("fit", "predict")


def _open(method: Any) -> bool:
    """True for an abstract method of the contract itself."""
    return method in (Encoder.fit, Encoder.predict)


def _encoders_in(module: ModuleType) -> list[str]:
    """Names of the encoder classes that a module defines itself."""
    return [
        name
        for name, kind in inspect.getmembers(module, inspect.isclass)
        if kind.__module__ == module.__name__ and issubclass(kind, Encoder)
    ]


def _only_encoder(module: ModuleType, path: str) -> str:
    names = _encoders_in(module)
    if len(names) != 1:
        raise EncoderError(
            "unclear which encoder of the file is meant",
            where=path,
            got=_names(module),
            expected=f"one encoder, or {Path(path).name}:CLASS",
        )
    return names[0]


def _names(module: ModuleType) -> str:
    return ", ".join(_encoders_in(module)) or "no encoder"
