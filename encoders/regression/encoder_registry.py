"""Finds encoders by name: built-in encoders, encoders of installed packages, encoders in a file.

A package offers its encoders under a name:

    [project.entry-points."hand_sandbox.encoders"]
    my-lab-forest = "my_lab.encoders:Forest"

An encoder is imported only when it is named. Errors of its code are then reported in one line, and
do not affect other encoders.
"""

from __future__ import annotations

import inspect
from hashlib import blake2b
from pathlib import Path
from typing import Any

from encoders.encoder import Encoder
from models.errors import EncoderError, unknown_name
from models.plugins import PluginKind, Registry, loaded_from

_REGRESSION = "encoders.regression"

ENCODERS: Registry[type[Encoder]] = Registry(
    {
        "polynomial": f"{_REGRESSION}.polynomial:PolynomialEncoder",
        "linear": f"{_REGRESSION}.polynomial:LinearEncoder",
        "quadratic": f"{_REGRESSION}.polynomial:QuadraticEncoder",
        "cubic": f"{_REGRESSION}.polynomial:CubicEncoder",
        "turned": f"{_REGRESSION}.yaw_normalised:YawNormalisedEncoder",
        "pca-ik": f"{_REGRESSION}.pca_ik:PcaIkEncoder",
    }
)
"""Built-in encoders by name. A model's file contains the first of these names whose class fits its
encoder."""

EXAMPLE = "docs/write-an-encoder.md shows an encoder"

_REQUIRED = ("fit", "predict")


def is_encoder(value: Any) -> bool:
    """True for a class that inherits from `Encoder`."""
    return inspect.isclass(value) and issubclass(value, Encoder)


ENCODER_PLUGINS: PluginKind[type[Encoder]] = PluginKind(
    "encoder", "hand_sandbox.encoders", EncoderError, ENCODERS, is_encoder, article="an"
)


def find_encoder(name: str) -> type[Encoder]:
    """Finds an encoder class by name: built-in, of an installed package, or at `FILE.py:CLASS`.

    Raises:
        EncoderError: No encoder has this name, or it cannot be used.
    """
    if name in ENCODERS:
        return ENCODERS[name]
    plugin = ENCODER_PLUGINS.find(name)
    if plugin is None:
        raise unknown_name(
            "no such encoder",
            name,
            ENCODER_PLUGINS.names(),
            where="--encoder",
            others="FILE.py:CLASS",
            kind=EncoderError,
        )
    return checked(plugin.value, plugin.where)


def checked(value: Any, where: str) -> type[Encoder]:
    """Checks that a loaded object is an encoder class that can be instantiated.

    Args:
        value: The loaded object.
        where: Its place, for messages.

    Raises:
        EncoderError: The object is something else, lacks a method, or requires arguments.
    """
    if not is_encoder(value):
        raise EncoderError(
            "not an encoder",
            where=where,
            got=repr(value)[:80],
            expected="a class that inherits from encoders.encoder.Encoder",
            remedy=EXAMPLE,
        )
    kind: type[Encoder] = value
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
    with ENCODER_PLUGINS.guarded(where, "this encoder cannot be created without arguments"):
        kind()
    return kind


def is_external(name: str) -> bool:
    """True for the name of an external encoder: `FILE.py:CLASS`, `MODULE:CLASS`, or a name that an
    installed package offers."""
    if ENCODER_PLUGINS.place_in(name) is not None:
        return True
    return name not in ENCODERS and name in ENCODER_PLUGINS.offered()


def builtin_name(encoder: Encoder) -> str | None:
    """First name of a built-in encoder in `ENCODERS`; None for an external encoder."""
    own = type(encoder).__module__.partition(".")[0] == __name__.partition(".")[0]
    if not own or type(encoder) not in ENCODERS.values():
        return None
    return next(name for name, kind in ENCODERS.items() if isinstance(encoder, kind))


def origin(name: str) -> dict[str, Any]:
    """Origin of an external encoder (see `origin_of`); empty for a built-in encoder."""
    return origin_of(find_encoder(name)) if is_external(name) else {}


def origin_of(kind: type[Encoder]) -> dict[str, Any]:
    """Origin of an external class, needed to load it again.

    Returns:
        For a class in a file: `file` (absolute path) and `member`. For a class of a module:
        `entry_point` (`module:Class`), and `package` and `version` if an installed package offers
        it.

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
    return ENCODER_PLUGINS.package_of(kind)


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


def _open(method: Any) -> bool:
    """True for an abstract method of `Encoder` itself, which a class does not override."""
    return method in (Encoder.fit, Encoder.predict)
