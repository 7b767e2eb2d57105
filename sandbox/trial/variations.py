"""Option `--vary`: quantities of a trial or a screen that can be varied, with their units."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, isfinite

from models.errors import InputError, unknown_name
from tasks.variation import RANGES, Variation


@dataclass(frozen=True)
class Kind:
    """A quantity that can be varied.

    Attributes:
        name: Name on the command line.
        about: Description, for tables and axes.
        neutral: Value without variation.
        unit: Unit of the values; empty for a factor.
        scale: One unit in SI units.
        down: Values below the neutral one, which a sweep tries in turn until success breaks off.
        up: The same, above the neutral one.
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
        """Name of the attribute of `Variation`, or of the hand's settings."""
        return self.name.replace("-", "_")

    def text(self, value: float) -> str:
        """Returns a value with its unit."""
        return f"{value:g} {self.unit}".rstrip()


HAND_SIZE = "hand-size"
"""Name of the factor on the hand's size, which is a setting of the run and not of the trial."""

KINDS = {
    quantity.name: quantity
    for quantity in (
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
            "resistance",
            "springs and friction of joints",
            1.0,
            down=(0.5, 0.2, 0.1),
            up=(1.5, 2.0, 3.0, 5.0, 8.0),
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
            "room",
            "room between the things",
            1.0,
            down=(0.95, 0.9, 0.85, 0.8, 0.5, 0.25),
            up=(1.05, 1.1, 1.2, 1.5, 2.0),
        ),
        Kind(
            HAND_SIZE,
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
"""Quantities by name."""


def help_with_units(kinds: Iterable[Kind]) -> str:
    """Text that names all quantities by their units: `size, mass: factors. noise: mm.`"""
    by_unit: dict[str, list[str]] = {}
    for kind in kinds:
        by_unit.setdefault(kind.unit or "factors", []).append(kind.name)
    return " ".join(f"{', '.join(names)}: {unit}." for unit, names in by_unit.items())


def help_with_names(kinds: Iterable[Kind]) -> str:
    """Text that names all quantities: `size, mass or noise`."""
    *names, last = (kind.name for kind in kinds)
    return f"{', '.join(names)} or {last}" if names else last


def find_kind(name: str) -> Kind:
    """Returns the quantity of a name.

    Raises:
        InputError: The name is unknown.
    """
    if name not in KINDS:
        raise unknown_name("unknown quantity", name, KINDS, where="--vary")
    return KINDS[name]


def parse_value(quantity: Kind, text: str) -> float:
    """Parses a value of a quantity.

    Raises:
        InputError: The text is not a number or is out of range.
    """
    try:
        value = float(text)
        if not isfinite(value):
            raise ValueError
    except ValueError:
        raise InputError(
            "not a number",
            where=f"--vary {quantity.name}",
            got=text,
            expected=f"such as {quantity.name}={(quantity.up or quantity.down)[0]:g}",
            # `run` separates quantities by commas, where one trial has all of them.
            remedy="Separate quantities by spaces here: each is varied by itself"
            if "=" in text
            else None,
        ) from None
    combined([(quantity, value)])
    return value


def parse_variation(text: str) -> tuple[Variation, float]:
    """Parses a text such as `size=0.8,latency=50`.

    Returns:
        The variation, and the factor on the hand's size.

    Raises:
        InputError: `text` is not NAME=VALUE,...
    """
    chosen: list[tuple[Kind, float]] = []
    for part in filter(None, (p.strip() for p in text.split(","))):
        name, equals, value = part.partition("=")
        quantity = find_kind(name.strip())
        if not equals:
            raise InputError(
                "the value is missing",
                where=f"--vary {text}",
                got=part,
                expected=f"such as {name}={(quantity.up or quantity.down)[0]:g}",
            )
        if quantity in (k for k, _ in chosen):
            raise InputError("given twice", where=f"--vary {text}", got=name)
        chosen.append((quantity, parse_value(quantity, value)))
    return combined(chosen)


def combined(chosen: Sequence[tuple[Kind, float]]) -> tuple[Variation, float]:
    """Combines values into a variation, and the factor on the hand's size.

    Args:
        chosen: Quantities with values in their own units.

    Raises:
        InputError: A value is out of range.
    """
    values = {quantity.field: value * quantity.scale for quantity, value in chosen}
    hand = values.pop(KINDS[HAND_SIZE].field, 1.0)
    if not 0.0 < hand < 10.0:
        raise InputError(
            "out of range",
            where=f"--vary {HAND_SIZE}",
            got=hand,
            expected="more than 0, less than 10",
        )
    for quantity, value in chosen:
        least, most = RANGES.get(quantity.field, (-inf, inf))
        if not least <= value * quantity.scale <= most:
            raise InputError(
                "out of range",
                where=f"--vary {quantity.name}",
                got=quantity.text(value),
                expected=f"{least / quantity.scale:g} to {quantity.text(most / quantity.scale)}",
            )
    return Variation(**values), hand
