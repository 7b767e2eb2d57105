"""A hand that is not ours: five upright pins, each carried to a fingertip's place by slides."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from models.arithmetic import Array
from models.frames import FINGERS
from models.hand import CONTACT_HAND, Link
from models.single_pose import SinglePose
from models.skeleton import ADULT, Skeleton

LENGTH, RADIUS = 0.03, 0.008
"""m, of each of a pin's two links."""


@dataclass(frozen=True)
class PinHand:
    """Keeps to `models.hand.SceneHand` and shares no part of the built-in hand's model.

    It has 15 controls where the built-in hand has 48, and no skeleton, so no skin.
    """

    name: str = "pins"
    skeleton: Skeleton | None = None

    @property
    def palm(self) -> str:
        return f"{self.name}_palm"

    @property
    def first_joint(self) -> str:
        return f"{self.name}_{FINGERS[0]}_x"

    @cached_property
    def links(self) -> tuple[Link, ...]:
        return tuple(
            Link(finger, f"{self.name}_{name}_{part}", LENGTH, RADIUS, geom, geom)
            for finger, name in enumerate(FINGERS)
            for part in ("upper", "lower")
            for geom in [f"{self.name}_{name}_{part}"]
        )

    def defaults(self) -> Element:
        default = Element("default", {"class": "pins"})
        SubElement(default, "geom", {"type": "capsule", "condim": "4", "friction": "1 .01 .0001"})
        return default

    def body(self) -> Element:
        palm = Element("body", {"name": self.palm, "childclass": "pins"})
        for name in FINGERS:
            upper = SubElement(
                palm,
                "body",
                {
                    # y points down, along the pin.
                    "name": f"{self.name}_{name}_upper",
                    "euler": "-90 0 0",
                    "gravcomp": "1",
                },
            )
            for axis, direction in zip("xyz", ("1 0 0", "0 0 1", "0 -1 0"), strict=True):
                SubElement(
                    upper,
                    "joint",
                    {
                        "name": f"{self.name}_{name}_{axis}",
                        "type": "slide",
                        "axis": direction,
                        "armature": "1",
                    },
                )
            lower = SubElement(
                upper,
                "body",
                {
                    "name": f"{self.name}_{name}_lower",
                    "pos": f"0 {LENGTH} 0",
                    "gravcomp": "1",
                },
            )
            for body, part in ((upper, "upper"), (lower, "lower")):
                SubElement(
                    body,
                    "geom",
                    {
                        "name": f"{self.name}_{name}_{part}",
                        "fromto": f"0 0 0 0 {LENGTH} 0",
                        "size": f"{RADIUS}",
                        "contype": str(CONTACT_HAND),
                        "conaffinity": "0",
                    },
                )
        return palm

    def actuators(self) -> list[Element]:
        return [
            Element(
                "position",
                {
                    "name": f"{self.name}_{name}_{axis}",
                    "joint": f"{self.name}_{name}_{axis}",
                    "kp": "8000",
                    "dampratio": "1",
                    "forcerange": "-100 100",
                },
            )
            for name in FINGERS
            for axis in "xyz"
        ]

    def controls(self, q: Array) -> Array:
        """(15,) m, each pin's upper end above the fingertip of the pose."""
        return (self.tips_of()(q) + np.array([0.0, 0.0, 2 * LENGTH])).ravel()

    def assets(self) -> list[Element]:
        return []

    def follower(self) -> None:
        pass

    def coordinates(self, qpos: Array) -> Array:
        return qpos

    def joint_positions(self, q: Array) -> Array:
        return self.controls(q)

    def tips_of(self) -> Callable[[Array], Array]:
        return SinglePose(ADULT).tips
