"""Loads external encoders: from installed packages by entry point, from a file or a module.

A package offers its encoders under a name:

    [project.entry-points."hand_sandbox.encoders"]
    my-lab-forest = "my_lab.encoders:Forest"

A package is loaded only when its encoder is requested. Errors in an encoder are reported then, in
one line; they do not affect other encoders.
"""

from __future__ import annotations

import inspect
from contextlib import AbstractContextManager
from hashlib import blake2b
from importlib.metadata import EntryPoint
from pathlib import Path
from types import ModuleType
from typing import Any

from encoders.encoder import Encoder
from models.errors import EncoderError
from models.outside import OutsideKind, Place, place_in

OUTSIDE = OutsideKind("encoder", "hand_sandbox.encoders", EncoderError, article="an")

EXAMPLE = "docs/write-an-encoder.md shows an encoder"


def offered() -> dict[str, list[EntryPoint]]:
    """Entry points of installed packages by name; loads none of them."""
    return OUTSIDE.offered()


def load_offered(name: str) -> type[Encoder] | None:
    """Loads an encoder that a package offers; returns None if no package offers it.

    Raises:
        EncoderError: Two packages offer it, or it cannot be used.
    """
    loaded = OUTSIDE.load_offered(name)
    return None if loaded is None else checked(loaded.thing, loaded.where)


def is_place(text: str) -> bool:
    """True for a text of the form `FILE.py`, `FILE.py:CLASS` or `MODULE:CLASS`."""
    return _place(text) is not None


def load_place(text: str) -> type[Encoder]:
    """Loads the encoder at a place; see `is_place`.

    Raises:
        EncoderError: The file or module does not exist, or contains no encoder.
    """
    place = _place(text)
    assert place is not None
    loaded = OUTSIDE.load_place(place, _encoders_in)
    return checked(loaded.thing, loaded.where)


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
            remedy=EXAMPLE,
        )
    kind: type[Encoder] = candidate
    if inspect.isabstract(kind):
        lacking = sorted(
            name for name, value in inspect.getmembers(kind) if name in _REQUIRED and _open(value)
        )
        raise EncoderError(
            "this encoder lacks a method",
            where=where,
            got=f"no {', '.join(lacking)}",
            remedy=EXAMPLE,
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


def guarded(what: str, where: str) -> AbstractContextManager[None]:
    """Converts any error of external code to an `EncoderError` of one line."""
    return OUTSIDE.guarded(where, what)


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


def _place(text: str) -> Place | None:
    place = place_in(text)
    return place if place and place.argument is None else None
