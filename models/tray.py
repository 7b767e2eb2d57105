"""A tray for two hands: a deck too broad for one hand, with a handle at either end."""

from __future__ import annotations

from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.hand import CONTACT_OBJECT, CONTACT_TABLE

Array = NDArray[np.float64]

WOOD, DARK_WOOD = (0.80, 0.60, 0.38), (0.55, 0.37, 0.22)

DECK = (0.080, 0.060, 0.007)
"""m, half the edges of the deck of a tray of size 1: broader than a hand opens."""
HANDLE = (0.035, 0.015, 0.018)
"""m, half the edges of each of its handles, which begin where the deck ends."""
GRIP = 0.120
"""m from a tray's middle to where a hand closes on a handle."""


@dataclass(frozen=True)
class Tray:
    """A tray that lies on its deck and handles, free to move.

    Its frame is at the middle of its handles' height, x from handle to handle, z up.

    Attributes:
        name: Name of its body.
        mass: kg, nearly all in the deck.
        position: (3,) m, middle at the start.
        yaw: rad about the vertical at the start.
        size: Factor on all its edges.
    """

    name: str
    mass: float
    position: tuple[float, float, float]
    yaw: float = 0.0
    size: float = 1.0

    @property
    def grip(self) -> float:
        """m, distance from the middle to the point where a hand closes on a handle."""
        return self.size * GRIP

    @property
    def handle(self) -> tuple[float, float, float]:
        """(3,) m, half the edges of a handle."""
        a, b, c = (self.size * half for half in HANDLE)
        return a, b, c

    def scaled(self, size: float) -> Tray:
        """The same tray in another size, with the same place and mass."""
        x, y, z = self.position
        raised = (size - 1.0) * self.size * HANDLE[2]
        return replace(self, size=self.size * size, position=(x, y, z + raised))

    def body(self) -> Element:
        """MJCF of the tray."""
        quat = (np.cos(self.yaw / 2), 0.0, 0.0, np.sin(self.yaw / 2))
        body = Element("body", {"name": self.name, "pos": _text(self.position),
                                "quat": _text(quat)})  # fmt: skip
        SubElement(body, "freejoint", {"name": self.name})
        for name, middle, half in self._pieces():
            deck = name == "deck"
            SubElement(body, "geom", {
                "name": f"{self.name}_{name}", "type": "box", "pos": _text(middle),
                "size": _text(half), "mass": f"{self.mass * (0.8 if deck else 0.1):.9g}",
                "contype": str(CONTACT_OBJECT | CONTACT_TABLE), "conaffinity": "7", "condim": "4",
                "friction": "1 .01 .0001", "solref": ".004 1", "solimp": ".95 .99 .001",
                "rgba": _text((*(WOOD if deck else DARK_WOOD), 1.0)),
            })  # fmt: skip
        return body

    def clearance(self, points: ArrayLike, position: Array, rotation: Array) -> Array:
        """(n,) m, signed distance of world points (n, 3) to the tray, negative inside.

        Args:
            points: World points.
            position: (3,) m, where the tray's middle is now.
            rotation: (3, 3) how it is turned now.
        """
        local = (np.asarray(points, float) - position) @ rotation
        distances = []
        for _, middle, half in self._pieces():
            off = np.abs(local - middle) - half
            outside = np.linalg.norm(np.maximum(off, 0.0), axis=-1)
            distances.append(outside + np.minimum(off.max(axis=-1), 0.0))
        return np.asarray(np.min(distances, axis=0))

    def _pieces(self) -> list[tuple[str, Array, Array]]:
        """Name, middle (3,) and half edges (3,), m, of deck and handles."""
        deck, handle = self.size * np.array(DECK), self.size * np.array(HANDLE)
        out = deck[0] + handle[0]
        # All of them stand on the table.
        return [
            ("deck", np.array([0.0, 0.0, deck[2] - handle[2]]), deck),
            ("right", np.array([out, 0.0, 0.0]), handle),
            ("left", np.array([-out, 0.0, 0.0]), handle),
        ]


def _text(values: ArrayLike) -> str:
    return " ".join(f"{float(v):.9g}" for v in np.asarray(values, float))
