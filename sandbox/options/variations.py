"""Variations by name, as they are asked for on the command line, with units for people."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite

from models.errors import InputError
from tasks.variation import RANGES, Variation


@dataclass(frozen=True)
class Kind:
    """One thing that can be varied.

    Attributes:
        name: On the command line.
        about: What it is, for tables and axes.
        neutral: Value at which nothing is varied.
        unit: Of its values; empty: a factor.
        scale: SI units in one of these.
        down: Values below the neutral one that are tried one after the other until success breaks.
        up: The same, above.
    """

    name: str
    about: str
    neutral: float
    unit: str = ""
    scale: float = 1.0
    down: tuple[float, ...] = ()
    up: tuple[float, ...] = ()

    @property
    def field(self) -> str:
        """Attribute of `Variation`, or of the run's settings for the hand."""
        return self.name.replace("-", "_")

    def text(self, value: float) -> str:
        """A value with its unit."""
        return f"{value:g} {self.unit}".rstrip()


HAND = "hand-size"
"""The hand is no part of a trial: it is the run's own setting, which this multiplies."""

KINDS = {
    kind.name: kind
    for kind in (
        Kind(
            "size",
            "edges of the objects",
            1.0,
            down=(0.8, 0.6, 0.5, 0.4, 0.3),
            up=(1.2, 1.4, 1.6, 1.8, 2.0),
        ),
        Kind(
            "mass",
            "mass of the objects",
            1.0,
            down=(0.5, 0.2, 0.1, 0.05),
            up=(2.0, 4.0, 8.0, 16.0, 32.0),
        ),
        Kind(
            "friction",
            "friction of table, objects and hand",
            1.0,
            down=(0.7, 0.5, 0.35, 0.25, 0.15, 0.1),
            up=(1.5, 2.0, 3.0, 5.0),
        ),
        Kind(
            "start",
            "start, away from where it was drawn",
            0.0,
            "mm",
            1e-3,
            up=(10.0, 20.0, 30.0, 40.0),
        ),
        Kind(
            HAND,
            "hand, against the one that touches",
            1.0,
            down=(0.95, 0.9, 0.85, 0.8, 0.7),
            up=(1.05, 1.1, 1.15, 1.2, 1.3, 1.5),
        ),
        Kind("noise", "noise of touches", 0.0, "mm", 1e-3, up=(0.5, 1.0, 2.0, 3.0, 5.0, 8.0, 12.0)),
        Kind(
            "dropped",
            "times that each touch is lost",
            0.0,
            "per s",
            up=(0.25, 0.5, 1.0, 2.0, 4.0, 8.0),
        ),
        Kind("ghosts", "ghost touches", 0.0, "per s", up=(0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)),
        Kind(
            "latency",
            "latency of touches",
            0.0,
            "ms",
            1e-3,
            up=(50.0, 100.0, 150.0, 200.0, 300.0, 400.0, 600.0),
        ),
    )
}
"""By name."""


def find_kind(name: str) -> Kind:
    """What a name stands for.

    Raises:
        InputError: Nothing.
    """
    if name not in KINDS:
        raise InputError(
            "this cannot be varied", where="--vary", got=name, expected=", ".join(KINDS)
        )
    return KINDS[name]


def parse_value(kind: Kind, text: str) -> float:
    """A value as written.

    Raises:
        InputError: It is no number, or none that this can have.
    """
    try:
        value = float(text)
        if not isfinite(value):
            raise ValueError
    except ValueError:
        raise InputError(
            "this is no number",
            where=f"--vary {kind.name}",
            got=text,
            expected=f"such as {kind.name}={(kind.up or kind.down)[0]:g}",
        ) from None
    made([(kind, value)])
    return value


def parse_variation(text: str) -> tuple[Variation, float]:
    """`size=0.8,latency=50` as a variation, and the factor on the hand's size.

    Raises:
        InputError: It is not like that.
    """
    chosen: list[tuple[Kind, float]] = []
    for part in filter(None, (p.strip() for p in text.split(","))):
        name, equals, value = part.partition("=")
        kind = find_kind(name.strip())
        if not equals:
            raise InputError(
                "how much is missing",
                where=f"--vary {text}",
                got=part,
                expected=f"such as {name}={(kind.up or kind.down)[0]:g}",
            )
        if kind in (k for k, _ in chosen):
            raise InputError("it is varied twice", where=f"--vary {text}", got=name)
        chosen.append((kind, parse_value(kind, value)))
    return made(chosen)


def made(chosen: Sequence[tuple[Kind, float]]) -> tuple[Variation, float]:
    """What some values, in their own units, make together.

    Raises:
        InputError: One is out of range.
    """
    values = {kind.field: value * kind.scale for kind, value in chosen}
    hand = values.pop(KINDS[HAND].field, 1.0)
    if not 0.0 < hand < 10.0:
        raise InputError(
            "no hand is of this size",
            where=f"--vary {HAND}",
            got=hand,
            expected="more than 0, less than 10",
        )
    for kind, value in chosen:
        least, most = RANGES.get(kind.field, (-inf, inf))
        if not least <= value * kind.scale <= most:
            raise InputError(
                "this is out of range",
                where=f"--vary {kind.name}",
                got=kind.text(value),
                expected=f"{least / kind.scale:g} to {kind.text(most / kind.scale)}",
            )
    return Variation(**values), hand
