"""Encoders that are not ours: from installed packages by entry point, from a file, from a module.

A package offers its encoders under a name:

    [project.entry-points."hand_sandbox.encoders"]
    my-lab-forest = "my_lab.encoders:Forest"

Nothing of a package is loaded before its encoder is asked for. An encoder that cannot be used is
refused in one line, and concerns nobody who does not ask for it.
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
    """Encoders that installed packages offer, by name; nothing of them is loaded."""
    return outside.offered(GROUP)


def load_offered(name: str) -> type[Encoder] | None:
    """The encoder that a package offers under a name; None where none does.

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
        found = entry.load()
    return checked(found, where)


def is_place(text: str) -> bool:
    """True for a text of the form `FILE.py`, `FILE.py:CLASS` or `MODULE:CLASS`."""
    return bool(_FILE.fullmatch(text) or _MODULE.fullmatch(text))


def load_place(text: str) -> type[Encoder]:
    """The encoder at a place; see `is_place`.

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
            "there is nothing of this name", where=text, got=member, expected=_names(module)
        )
    return checked(members[member], text)


def checked(found: Any, where: str) -> type[Encoder]:
    """Checks that a loaded object is an encoder class that can be instantiated.

    Raises:
        EncoderError: It is something else, lacks a method, or wants arguments.
    """
    if not (inspect.isclass(found) and issubclass(found, Encoder)):
        raise EncoderError(
            "not an encoder",
            where=where,
            got=repr(found)[:80],
            expected="a class that inherits from encoders.encoder.Encoder",
            remedy=HOW,
        )
    kind: type[Encoder] = found
    if inspect.isabstract(kind):
        lacking = sorted(
            name for name, value in inspect.getmembers(kind) if name in _REQUIRED and _open(value)
        )
        raise EncoderError(
            "this encoder lacks a method", where=where, got=f"no {', '.join(lacking)}", remedy=HOW
        )
    with guarded("this encoder cannot be made without arguments", where):
        kind()
    return kind


def source_digest(kind: type[Encoder]) -> str:
    """BLAKE2b of the file that a class is in, hexadecimal; files that it imports do not count.

    Raises:
        EncoderError: The class is in no file, as when it was typed in.
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
    """Makes one line of whatever error somebody else's code raises."""
    try:
        yield
    except HandSandboxError:
        raise
    except Exception as error:
        raise EncoderError(what, where=where, got=failure(error), remedy=HOW) from error


_REQUIRED = ("fit", "predict")


def _open(method: Any) -> bool:
    """True if a method is the contract's own, which does nothing."""
    return method in (Encoder.fit, Encoder.predict)


def _encoders_in(module: ModuleType) -> list[str]:
    """Names of the encoders that a module makes itself."""
    return [
        name
        for name, kind in inspect.getmembers(module, inspect.isclass)
        if kind.__module__ == module.__name__ and issubclass(kind, Encoder)
    ]


def _only_encoder(module: ModuleType, path: str) -> str:
    names = _encoders_in(module)
    if len(names) != 1:
        raise EncoderError(
            "which encoder of this file is not clear",
            where=path,
            got=_names(module),
            expected=f"one encoder, or {Path(path).name}:CLASS",
        )
    return names[0]


def _names(module: ModuleType) -> str:
    return ", ".join(_encoders_in(module)) or "no encoder"
