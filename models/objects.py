"""Things to manipulate."""

from __future__ import annotations

from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.hand import CONTACT_OBJECT, CONTACT_TABLE

Array = NDArray[np.float64]

RED = (0.86, 0.30, 0.24)


@dataclass(frozen=True)
class Box:
    """A solid box, free to move.

    Attributes:
        name: Of its body.
        half_size: (3,) m, half its edges.
        mass: kg.
        position: (3,) m, centre at the start.
        yaw: rad about the vertical at the start.
        rgb: Colour, 0 to 1.
    """

    name: str
    half_size: tuple[float, float, float]
    mass: float
    position: tuple[float, float, float]
    yaw: float = 0.0
    rgb: tuple[float, float, float] = RED

    def body(self) -> Element:
        """MJCF of the box."""
        quat = (np.cos(self.yaw / 2), 0.0, 0.0, np.sin(self.yaw / 2))
        body = Element("body", {"name": self.name, "pos": _text(self.position),
                                "quat": _text(quat)})  # fmt: skip
        SubElement(body, "freejoint", {"name": self.name})
        # An object answers to hands (bit 1), objects and the table.
        SubElement(body, "geom", {
            "name": self.name, "type": "box", "size": _text(self.half_size),
            "mass": f"{self.mass:.9g}", "contype": str(CONTACT_OBJECT | CONTACT_TABLE),
            "conaffinity": "7", "condim": "4", "friction": "1 .01 .0001",
            "solref": ".004 1", "solimp": ".95 .99 .001", "rgba": _text((*self.rgb, 1.0)),
        })  # fmt: skip
        return body

    def clearance(self, points: ArrayLike, position: Array, rotation: Array) -> Array:
        """(n,) m, signed distance of world points (n, 3) to the box, negative inside.

        Args:
            points: World points.
            position: (3,) m, where the box is now.
            rotation: (3, 3) how it is turned now.
        """
        local = np.abs((np.asarray(points, float) - position) @ rotation) - self.half_size
        outside = np.linalg.norm(np.maximum(local, 0.0), axis=-1)
        return outside + np.minimum(local.max(axis=-1), 0.0)


def _text(values: ArrayLike) -> str:
    return " ".join(f"{float(v):.9g}" for v in np.asarray(values, float))
