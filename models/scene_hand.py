"""The contract of a hand in a scene: any hand that keeps to it can follow a pose.

`models.hand.Hand` is the built-in one: 48 degrees of freedom, driven by the pose itself. Another
hand, a robot's for example, gives its own MJCF, turns a pose into its own controls, and says which
of its links stand for which finger. Scene, session, collision gating, sensing and views know a hand
by this contract alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol
from xml.etree.ElementTree import Element

from models.arithmetic.arrays import Array
from models.skeleton import Skeleton


@dataclass(frozen=True)
class Link:
    """One link of a finger: a capsule along the y axis of its body, from its joint on.

    Attributes:
        finger: Label of its finger, thumb 0 to little 4.
        body: Name of its body in the model.
        length: m, from its joint to the next one, or to the centre of the fingertip.
        radius: m, of the capsule.
        geom: Name of the geom that collides where the whole link is solid.
        tip_geom: Name of the geom that collides where only fingertips are solid; `geom` for a link
            that is solid as a whole or not at all.
        solid_from: Share of the length, from its joint, at which `tip_geom` begins.
    """

    finger: int
    body: str
    length: float
    radius: float
    geom: str
    tip_geom: str
    solid_from: float = 0.0


class SceneHand(Protocol):
    """A hand of a scene."""

    @property
    def name(self) -> str:
        """Prefix of its elements' names in the model: every name begins with it and `_`."""
        ...

    @property
    def palm(self) -> str:
        """Name of the body that all its links hang on, itself a child of the world."""
        ...

    @property
    def first_joint(self) -> str:
        """Name of the joint with which its joint positions begin."""
        ...

    @property
    def links(self) -> tuple[Link, ...]:
        """Links of the five fingers, finger by finger, from the palm outwards; two or more each."""
        ...

    @property
    def skeleton(self) -> Skeleton | None:
        """The bones to which the shipped skin is fitted; None shows the hand's own geoms."""
        ...

    def defaults(self) -> Element:
        """The MJCF default class of its elements; hands with a class of one name share it."""
        ...

    def body(self) -> Element:
        """The MJCF body of the palm with everything that hangs on it.

        The geoms of `links` are compiled with the collision bit `CONTACT_HAND` of `models.hand`:
        MuJoCo decides at compile time which bodies may collide at all.
        """
        ...

    def actuators(self) -> list[Element]:
        """The MJCF actuators, in the order of its controls."""
        ...

    def controls(self, q: Array) -> Array:
        """Controls (m,) that make it follow a pose q (48,) in the world; m is the same always."""
        ...

    def joint_positions(self, q: Array) -> Array:
        """Joint positions (n,) of the hand at a pose q (48,), as MuJoCo's qpos has them."""
        ...

    def tips_of(self) -> Callable[[Array], Array]:
        """A function from a pose (48,) to the places (5, 3) m where it wants the fingertips.

        The function may use buffers of its own, so it serves one thread at a time.
        """
        ...
