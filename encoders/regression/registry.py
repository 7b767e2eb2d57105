"""Encoders by name: ours, those that installed packages offer, and those at a place in a file."""

from __future__ import annotations

from typing import Any

from encoders.discovery import is_place, load_offered, load_place, offered
from encoders.encoder import Encoder
from encoders.regression.mean import MeanEncoder
from encoders.regression.pca_ik import PcaIkEncoder
from encoders.regression.polynomial import (
    CubicEncoder,
    LinearEncoder,
    PolynomialEncoder,
    QuadraticEncoder,
)
from encoders.regression.regularised_ik import MapIkEncoder, NullSpaceIkEncoder
from encoders.regression.turned import TurnedEncoder
from models.errors import EncoderError
from models.outside import loaded_from

ENCODERS: dict[str, type[Encoder]] = {
    "polynomial": PolynomialEncoder,
    "linear": LinearEncoder,
    "quadratic": QuadraticEncoder,
    "cubic": CubicEncoder,
    "turned": TurnedEncoder,
    "pca-ik": PcaIkEncoder,
    "pca-ik-null": NullSpaceIkEncoder,
    "map-ik": MapIkEncoder,
    "mean": MeanEncoder,
}
"""Name -> class of our encoders. A model's file has the first name that its encoder belongs to."""


def find_encoder(name: str) -> type[Encoder]:
    """The class of a name, ours or of an installed package; or at a place such as `FILE.py:CLASS`.

    Raises:
        EncoderError: There is none, or it cannot be used.
    """
    if name in ENCODERS:
        return ENCODERS[name]
    if is_place(name):
        return load_place(name)
    found = load_offered(name)
    if found is None:
        raise EncoderError(
            "there is no such encoder",
            where="--encoder",
            got=name,
            expected=", ".join((*ENCODERS, *sorted(offered()))) + " or FILE.py:CLASS",
        )
    return found


def is_outside(name: str) -> bool:
    """Whether a name stands for an encoder that is not ours: a place, or an installed package's."""
    return is_place(name) or (name not in ENCODERS and name in offered())


def kind_of(encoder: Encoder) -> str | None:
    """The first name of our encoders that an encoder belongs to; None where it is not ours."""
    if type(encoder) not in ENCODERS.values():
        return None
    return next(name for name, kind in ENCODERS.items() if isinstance(encoder, kind))


def origin(name: str) -> dict[str, Any]:
    """Where the encoder of a name comes from if it is not ours; else empty. See `origin_of`."""
    return origin_of(find_encoder(name)) if is_outside(name) else {}


def origin_of(kind: type[Encoder]) -> dict[str, Any]:
    """Where a class comes from that is not ours, for whoever looks for it again.

    Returns:
        `file`, absolute, and `member`; or `entry_point` as `module:Class`, with `package` and
        `version` where an installed package offers it.

    Raises:
        EncoderError: It is within another class or a function, where nobody finds it.
    """
    member = kind.__qualname__
    if not member.isidentifier():
        raise EncoderError(
            "this encoder cannot be found again",
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
