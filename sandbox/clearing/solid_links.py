"""Solid links: every part of a hand is solid by itself, once it is clear of things.

A hand that is solid all over becomes so when its touching fingertips do. A part that is inside of
something then stays a ghost until it is out: it would throw the thing.
"""

from __future__ import annotations

import mujoco
import numpy as np

from models.arithmetic.arrays import Array
from models.scene import Scene
from sandbox.clearing.hand_distances import HandDistances

CLEARANCE = 0.0005
"""m, least distance of a part from things when it becomes solid."""

INSIDE = 0.0015
"""m, depth in a thing, by the thing's own distances, at which a part does not become solid."""

_ALONG = np.linspace(-1.0, 1.0, 9)
"""Shares of half a capsule's length, from its middle, at which a ball covers it."""


class SolidLinks:
    """Decides step by step which parts of one hand are solid.

    Args:
        scene: The scene.
        hand: Index of the hand.
        distances: Distances of its parts.

    Attributes:
        fingers: Labels of the fingers whose last link is solid, whether they touch or not.
    """

    def __init__(self, scene: Scene, hand: int, distances: HandDistances) -> None:
        self._scene, self._hand, self._distances = scene, hand, distances
        links, geom = scene.spec.hands[hand].links, scene.model.geom
        self._parts = tuple(scene.parts(hand))
        # Of each finger: its links from the palm outwards, and the solid end of the last.
        self._links: dict[int, list[int]] = {}
        for link in links:
            self._links.setdefault(link.finger, []).append(geom(link.geom).id)
        self._ends = {link.finger: geom(link.tip_geom).id for link in links}
        of_fingers = {g for own in self._links.values() for g in own} | set(self._ends.values())
        self._palm = [g for g in self._parts if g not in of_fingers]
        sizes = scene.model.geom_size[list(self._parts)]
        self._radii, self._halves = sizes[:, 0], sizes[:, 1]
        self.fingers: frozenset[int] = frozenset()
        self._touching: frozenset[int] = frozenset()
        self._solid: frozenset[int] = frozenset()

    @property
    def signature(self) -> bytes:
        """Which parts are solid: state outside MuJoCo's that affects the next step."""
        mask = sum(1 << i for i, part in enumerate(self._parts) if part in self._solid)
        return mask.to_bytes((len(self._parts) + 7) // 8, "little")

    def balls(self, data: mujoco.MjData) -> tuple[Array, Array]:
        """Middles (n, 3) and radii (n,), m, of balls along all parts, which are capsules."""
        parts = list(self._parts)
        axes = data.geom_xmat[parts].reshape(-1, 3, 3)[:, :, 2]
        along = _ALONG[:, None] * self._halves
        middles = data.geom_xpos[parts] + along[:, :, None] * axes
        return middles.reshape(-1, 3), np.tile(self._radii, len(_ALONG))

    def update(
        self, data: mujoco.MjData, pressing: frozenset[int], touching: frozenset[int]
    ) -> None:
        """Chooses the solid parts for the next step.

        Args:
            data: Current state of the simulation.
            pressing: Fingers whose tips are solid and touch; none makes the hand a ghost.
            touching: Fingers that touch.
        """
        before = self._solid
        solid = self._joined(data, pressing, touching) if pressing else frozenset()
        self._touching = touching
        if solid != before:
            self._solid = solid
            self._scene.set_solid_geoms(self._hand, solid)
            self.fingers = frozenset(
                f for f in self._links if self._links[f][-1] in solid or self._ends[f] in solid
            )

    def _joined(
        self, data: mujoco.MjData, pressing: frozenset[int], touching: frozenset[int]
    ) -> frozenset[int]:
        """The parts that are solid next."""
        # A finger that begins to touch or is lifted begins anew: it may be inside of what it
        # held, or on its way into something.
        anew = touching ^ self._touching
        solid = {
            part
            for f in self._links
            if f not in anew and (f in pressing or f not in touching)
            for part in (*self._links[f], self._ends[f])
            if part in self._solid
        }
        solid.update(part for part in self._palm if part in self._solid)
        missing = {part for part in self._palm if part not in solid}
        for f in self._links:
            if f in pressing or f not in touching:
                missing.update(part for part in self._links[f] if part not in solid)
            if f in pressing and self._links[f][-1] not in solid:
                solid.add(self._ends[f])
        if not missing:
            return frozenset(solid)
        parts, distances, _ = self._distances.near(data)
        blocked = {p for p, far in zip(parts, distances, strict=True) if far < CLEARANCE}
        for f in self._links:
            last, end = self._links[f][-1], self._ends[f]
            if f not in pressing and end in blocked:
                # The whole last link of a finger that does not touch must be out.
                blocked.add(last)
        joining = missing - blocked
        if joining:
            solid |= joining - self._inside(data)
        for f in self._links:
            if self._links[f][-1] in solid and self._ends[f] != self._links[f][-1]:
                # The whole link takes the place of its end.
                solid.discard(self._ends[f])
        return frozenset(solid)

    def _inside(self, data: mujoco.MjData) -> frozenset[int]:
        """Parts that are inside of things, whatever MuJoCo says.

        It takes a capsule for clear of a box that its axis goes right through.
        """
        middles, radii = self.balls(data)
        far = (self._scene.clearance(data, middles) - radii).reshape(len(_ALONG), -1).min(axis=0)
        return frozenset(part for part, d in zip(self._parts, far, strict=True) if d < -INSIDE)
