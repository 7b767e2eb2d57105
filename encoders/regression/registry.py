"""Finds encoders by name: built-in ones, those of installed packages, and those in a file."""

from __future__ import annotations

from typing import Any

from encoders.discovery import is_place, load_offered, load_place, offered
from encoders.encoder import Encoder
from encoders.regression.pca_ik import PcaIkEncoder
from encoders.regression.polynomial import (
    CubicEncoder,
    LinearEncoder,
    PolynomialEncoder,
    QuadraticEncoder,
)
from encoders.regression.yaw_normalised import YawNormalisedEncoder
from models.errors import EncoderError
from models.outside import loaded_from

ENCODERS: dict[str, type[Encoder]] = {
    "polynomial": PolynomialEncoder,
    "linear": LinearEncoder,
    "quadratic": QuadraticEncoder,
    "cubic": CubicEncoder,
    "turned": YawNormalisedEncoder,
    "pca-ik": PcaIkEncoder,
}
"""Built-in encoders by name. A model's file contains the first name that matches its encoder."""


def find_encoder(name: str) -> type[Encoder]:
    """Finds an encoder class by name: built-in, of an installed package, or at `FILE.py:CLASS`.

    Raises:
        EncoderError: No encoder has this name, or it cannot be used.
    """
    if name in ENCODERS:
        return ENCODERS[name]
    if is_place(name):
        return load_place(name)
    encoder = load_offered(name)
    if encoder is None:
        raise EncoderError(
            "no such encoder",
            where="--encoder",
            got=name,
            expected=", ".join((*ENCODERS, *sorted(offered()))) + " or FILE.py:CLASS",
        )
    return encoder


def is_external(name: str) -> bool:
    """True for the name of an external encoder: a place, or one of an installed package."""
    return is_place(name) or (name not in ENCODERS and name in offered())


def builtin_name(encoder: Encoder) -> str | None:
    """First name of a built-in encoder; None for an external one."""
    if type(encoder) not in ENCODERS.values():
        return None
    return next(name for name, kind in ENCODERS.items() if isinstance(encoder, kind))


def origin(name: str) -> dict[str, Any]:
    """Origin of an external encoder (see `origin_of`); empty for a built-in one."""
    return origin_of(find_encoder(name)) if is_external(name) else {}


def origin_of(kind: type[Encoder]) -> dict[str, Any]:
    """Origin of an external class, needed to load it again.

    Returns:
        `file`, absolute, and `member`; or `entry_point` as `module:Class`, with `package` and
        `version` where an installed package offers it.

    Raises:
        EncoderError: The class is inside another class or a function and cannot be imported.
    """
    member = kind.__qualname__
    if not member.isidentifier():
        raise EncoderError(
            "this encoder cannot be loaded again",
            where=f"{kind.__module__}.{member}",
            expected="a class at the top of its module",
        )
    file = loaded_from(kind.__module__)
    if file is not None:
        return {"file": str(file), "member": member}
    place = f"{kind.__module__}:{member}"
    entries = (entry for same in offered().values() for entry in same)
    dist = next((e.dist for e in entries if e.value == place and e.dist), None)
    package = {"package": dist.name, "version": dist.version} if dist else {}
    return {"entry_point": place, **package}
