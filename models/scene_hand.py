"""The contract of hands in a scene.

`models.hand.Hand` is the built-in hand with 48 degrees of freedom, driven by the pose itself. Other
hands, such as robot hands, have their own MJCF, convert a pose to their own controls, and assign
their links to fingers. Scene, session, collision gating, sensing and views use only this contract.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Protocol
from xml.etree.ElementTree import Element

from models.arithmetic.arrays import Array
from models.skeleton import Skeleton


@dataclass(frozen=True)
class Link:
    """One link of a finger: a capsule along the y axis of its body, beginning at its joint.

    Attributes:
        finger: Label of its finger, thumb 0 to little 4.
        body: Name of its body in the model.
        length: m, from its joint to the next one, or to the centre of the fingertip.
        radius: m, radius of the capsule.
        geom: Name of the geom that collides if the whole link is solid.
        tip_geom: Name of the geom that collides if only fingertips are solid; `geom` for a link
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


class Follower(Protocol):
    """Turns the poses of one movement into controls; it may go on from its last result."""

    @property
    def missed(self) -> frozenset[int] | None:
        """Labels of the fingers that touch and whose tips could not be put where the last pose has
        them; None for a hand that can take every pose."""
        ...

    def __call__(self, q: Array, fingers: Collection[int]) -> Array:
        """Controls (m,) for a pose (48,).

        Args:
            q: The pose.
            fingers: Labels of the fingers that touch: where not all fingertips can be where the
                pose has them, theirs matter.
        """
        ...


class PoseFollower:
    """A follower whose controls are a function of the pose alone."""

    missed = None

    def __init__(self, controls: Callable[[Array], Array]) -> None:
        self._controls = controls

    def __call__(self, q: Array, fingers: Collection[int]) -> Array:
        """Controls (m,) for a pose (48,)."""
        return self._controls(q)


class SceneHand(Protocol):
    """A hand of a scene."""

    @property
    def name(self) -> str:
        """Prefix of its elements' names in the model: every name begins with it and `_`."""
        ...

    @property
    def palm(self) -> str:
        """Name of the palm's body, a child of the world with all links below it."""
        ...

    @property
    def first_joint(self) -> str:
        """Name of its first joint."""
        ...

    @property
    def links(self) -> tuple[Link, ...]:
        """Links of its fingers, finger by finger, from the palm outwards; two or more each.

        A finger that the hand lacks has no links, and never becomes solid.
        """
        ...

    @property
    def skeleton(self) -> Skeleton | None:
        """Skeleton to which the shipped skin is fitted; None shows the hand's own geoms."""
        ...

    def defaults(self) -> Element:
        """MJCF default class of its elements; hands with a class of the same name share it."""
        ...

    def body(self) -> Element:
        """MJCF body of the palm with all links.

        The geoms of `links` are compiled with the collision bit `CONTACT_HAND` of `models.hand`:
        MuJoCo decides at compile time which bodies may collide at all.
        """
        ...

    def assets(self) -> list[Element]:
        """MJCF assets, such as meshes; every name begins with the hand's name and `_`."""
        ...

    def actuators(self) -> list[Element]:
        """MJCF actuators in the order of its controls."""
        ...

    def controls(self, q: Array) -> Array:
        """Controls (m,) that make it follow a pose q (48,) in the world; m is constant."""
        ...

    def follower(self) -> Follower:
        """Follower that turns the poses of one movement into controls."""
        ...

    def coordinates(self, qpos: Array) -> Array:
        """Joint positions (..., n) as numbers without quaternions: the palm's place (m) and
        rotation vector (rad), then a rotation vector or an angle of every joint."""
        ...

    def joint_positions(self, q: Array) -> Array:
        """Joint positions (n,) of the hand at a pose q (48,), as in MuJoCo's qpos."""
        ...

    def tips_of(self) -> Callable[[Array], Array]:
        """Function from a pose (48,) to the intended positions (5, 3) m of the fingertips; those of
        fingers that it lacks have no meaning.

        The function may use buffers of its own, so it serves one thread at a time.
        """
        ...
