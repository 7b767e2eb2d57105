"""Collision gating: a hand collides only once it is down and no fingertip is inside an object.

Until then the hand is a ghost that passes through objects. A finger that becomes solid inside an
object would throw the object across the room. A person who sees the ghost moves the finger out of
the object instead.

Contact modes (hard, soft, none) can change during a session without a jump of its state. Soft
contacts give way, and a soft hand is weak, so that it does not throw an object that it squeezes by
mistake. With `none` the hand passes through everything. Hardness changes gradually: a fingertip a
few millimetres inside an object would throw the object if contacts became hard in one step.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from encoders.reconstruction.hand_motion import Phase
from encoders.reconstruction.reconstructor import Reconstruction
from models.arithmetic import Array, power, squared_lengths
from models.errors import InputError
from models.frames import FINGERS, finger_bits
from models.hand import IMPULSE_PERIOD, Link
from models.message import Message
from models.scene import CONTROL_PERIOD, BodyPoses, Scene
from sandbox.session.messages import MOVE_APART

if TYPE_CHECKING:
    from sandbox.session.collision_avoidance import SolidLinks


class ContactMode(StrEnum):
    """Contact modes of hands and objects."""

    HARD = "hard"
    SOFT = "soft"
    NONE = "none"

    @property
    def next(self) -> ContactMode:
        """The mode that follows when a person cycles through the modes."""
        modes = list(ContactMode)
        return modes[(modes.index(self) + 1) % len(modes)]


SOFT_IMPULSE = 0.05
"""Impulse limit (N s per 1/60 s) of every servo of a soft hand: 3 N."""
SOFT_SOLREF = (0.080, 1.0)
"""Time constant (s) and damping ratio of a soft contact. The time constant of a hard contact is
4 ms. A fingertip that holds a box at 3 N is 1.3 mm inside the box."""
SOFT_SOLIMP = (0.97, 0.995, 0.001, 0.5, 2.0)
"""Impedance of a soft contact (MuJoCo's `solimp`), no lower than that of a hard contact. A held box
creeps by 0.8 mm in 5 s if softness comes from a lower impedance, and by 0.1 mm if softness comes
from the time constant (measured at db485e42)."""
SOFT_TOLERANCE = 1e-11
"""Solver tolerance while contacts are soft. The residual at MuJoCo's default of 1e-8 is negligible
with hard contacts, but with soft contacts it rocks an object held by two fingers. The lower
tolerance takes no measurable time."""
CHANGE = 0.2
"""Duration (s) of a change from hard to soft contacts, or from soft to hard ones."""

_OWN = 1e6
"""Weight of a soft hand's contact parameters (MuJoCo's `solmix`), so large that the parameters of
the object have no effect."""


def contact_mode(name: str) -> ContactMode:
    """The contact mode of this name.

    Raises:
        InputError: No mode has this name.
    """
    try:
        return ContactMode(name)
    except ValueError:
        raise InputError(
            "no such contact mode", where="--contact", got=name, expected=", ".join(ContactMode)
        ) from None


class ContactModes:
    """Writes the contact mode of a scene's hands into the scene's model, step by step.

    Args:
        scene: The scene; its model must not be shared with another session.
        mode: Initial mode, in full effect from the start.

    Attributes:
        mode: The mode that was requested last.
        softness: Current softness, 0 (hard) to 1 (soft), during a change.
    """

    def __init__(self, scene: Scene, mode: ContactMode = ContactMode.HARD) -> None:
        self._model = model = scene.model
        hands = scene.spec.hands
        self._geoms = np.array(sorted(g for i in range(len(hands)) for g in scene.parts(i)))
        names = tuple(f"{h.name}_" for h in hands)
        self._actuators = np.array(
            [i for i in range(model.nactuator) if model.actuator(i).name.startswith(names)]
        )
        self._solref = model.geom_solref[self._geoms].copy()
        self._solimp = model.geom_solimp[self._geoms].copy()
        self._solmix = model.geom_solmix[self._geoms].copy()
        self._range = model.actuator_forcerange[self._actuators].copy()
        self._tolerance = float(model.opt.tolerance)
        self.mode = mode
        self.softness = self._goal
        self._apply()

    @property
    def ghost(self) -> bool:
        """True if hands pass through everything."""
        return self.mode is ContactMode.NONE

    @property
    def signature(self) -> bytes:
        """State outside MuJoCo's state that affects the next step; empty for hard contacts."""
        if self.mode is ContactMode.HARD and self.softness == 0.0:
            return b""
        return self.mode.encode() + struct.pack("<d", self.softness)

    def step(self) -> None:
        """Advances a change of softness by one control period."""
        if self.softness != self._goal:
            share = CONTROL_PERIOD / CHANGE
            self.softness += float(np.clip(self._goal - self.softness, -share, share))
            self._apply()

    @property
    def _goal(self) -> float:
        return 1.0 if self.mode is ContactMode.SOFT else 0.0

    def _apply(self) -> None:
        """Writes the model: times and forces change geometrically, impedances linearly."""
        model, soft = self._model, self.softness
        if soft == 0.0:
            model.geom_solref[self._geoms] = self._solref
            model.geom_solimp[self._geoms] = self._solimp
            model.geom_solmix[self._geoms] = self._solmix
            model.actuator_forcerange[self._actuators] = self._range
            model.opt.tolerance = self._tolerance
            return
        model.geom_solref[self._geoms] = self._solref * power(SOFT_SOLREF / self._solref, soft)
        model.geom_solimp[self._geoms] = self._solimp + soft * (SOFT_SOLIMP - self._solimp)
        model.geom_solmix[self._geoms] = self._solmix * power(_OWN / self._solmix, soft)
        limit = self._range[:, 1:]
        weaker = power(np.minimum(SOFT_IMPULSE / IMPULSE_PERIOD / limit, 1.0), soft)
        model.actuator_forcerange[self._actuators] = self._range * weaker
        model.opt.tolerance = self._tolerance * (SOFT_TOLERANCE / self._tolerance) ** soft


CLEARANCE = 0.0005
"""Smallest distance (m) of a fingertip's surface from an object at which the fingertip becomes
solid."""
ARRIVED = 0.008
"""Largest distance (m) of a simulated fingertip from its commanded place at which it becomes
solid."""

FINGERTIP = 0.010
"""Approximate radius (m) of a fingertip: its surface extends this far beyond its touch."""
ALONG = np.linspace(0.0, 1.0, 7)
"""Positions along the solid part of a last link, as shares of its length, at which the distance to
objects is checked. The thumb's last link is 52 mm long. With fewer points, the corner of a box
between two points could be 6 mm deep in the link without detection; with these points, at most half
a millimetre."""

GHOST: frozenset[int] = frozenset()

_LOW = (Phase.COMING_DOWN, Phase.DOWN)

STUCK = Message("stuck", f"{MOVE_APART}: a finger is inside an object")
STUCK_TIME = 0.15
"""Time (s) for which a finger of a hand that is down must be inside an object before the person
gets a notice. `TipOffsets` needs less time to move a fingertip at an object's side out of it."""


@dataclass(frozen=True)
class CollisionGatingRules:
    """Collision gating: decides which links of a hand may collide, and when.

    Attributes:
        ghost_until_clear: A hand that is down stays a ghost until its tips are outside all objects.
        distal_only: Only the last links of touching fingers become solid; otherwise all their
            links.
        links: Number of solid links of a finger, counted from its tip.
        together: All fingers of a hand become solid in the same step; otherwise each separately.
        lead: Fingertips at objects are moved away from their touches, out of the objects. The
            fingertips then keep the width of their grip until the fingers spread.
        from_above: A hand becomes solid on its way down, so that it presses objects under it. A
            finger that starts to touch while the hand is down also becomes solid on its way down.
        all_over: Once the touching fingertips are solid, the palm and all links of all fingers
            become solid, each part as soon as it is clear. Replaces `distal_only` and `links`.
    """

    ghost_until_clear: bool = True
    distal_only: bool = True
    links: int = 1
    together: bool = True
    lead: bool = False
    from_above: bool = False
    all_over: bool = False


class CollisionGate:
    """Decides step by step which fingers of one hand are solid.

    Args:
        scene: The scene.
        hand: Index of the hand.
        rules: Rules of collision gating.
        parts: Chooses the solid parts besides the touching fingertips, for the rule `all_over`;
            None without this rule.

    Attributes:
        fingers: Labels of the touching fingers that are solid now.
        inside: Labels of the fingers that cannot become solid because they are inside an object.
    """

    def __init__(
        self,
        scene: Scene,
        hand: int,
        rules: CollisionGatingRules,
        parts: SolidLinks | None = None,
    ) -> None:
        self._scene, self._hand, self._rules = scene, hand, rules
        self._parts = parts
        links = scene.spec.hands[hand].links
        body = scene.model.body
        self._has = frozenset(link.finger for link in links)
        # If the hand lacks a finger, the palm stands in for it. This finger is never solid.
        palm = [Link(0, scene.spec.hands[hand].palm, 0.0, 0.0, "", "")] * 2
        fingers = [
            [link for link in links if link.finger == f] or palm for f in range(len(FINGERS))
        ]
        last = [own[-1] for own in fingers]
        self._bodies = np.array([body(link.body).id for link in last])
        # At most two links of a finger are checked before they become solid.
        before = [own[-2] for own in fingers]
        self._before_radius = np.array([link.radius for link in before])
        self._before = np.array([body(link.body).id for link in before])
        self._reach = np.array([link.length for link in last])
        self._radius = np.array([link.radius for link in last])
        self._commanded = scene.spec.hands[hand].tips_of()
        # The whole part that becomes solid must be clear of objects, not only its tip: part of a
        # leaning finger may be inside a high object while the tip is outside.
        inner = np.array([link.solid_from for link in last])
        self._shares = inner + ALONG[:, None] * (1.0 - inner)
        self._behind = ((self._shares - 1.0) * self._reach)[:, :, None]
        self.fingers = GHOST
        self.inside = GHOST
        # Number of consecutive steps for which each finger has been inside an object.
        self._stuck: dict[int, int] = {}

    @property
    def notice(self) -> str:
        """Message for the person whose hand stays a ghost; empty otherwise."""
        return STUCK if self.inside and not self.fingers else ""

    @property
    def solid(self) -> frozenset[int]:
        """Labels of all fingers that are solid now, whether they touch or not."""
        return self.fingers if self._parts is None else self._parts.fingers

    @property
    def signature(self) -> bytes:
        """The solid parts, which affect the next step and are not in MuJoCo's state."""
        mine = bytes([finger_bits(self.fingers)])
        return mine if self._parts is None else mine + self._parts.signature

    def tips(self, data: BodyPoses) -> Array:
        """(5, 3) m, fingertips of the simulated hand; the palm for a finger that the hand lacks."""
        return self._along(data, 1.0)

    def links(self, data: mujoco.MjData) -> Array:
        """(35, 3) m, 7 points on the solid part of each last link; fingers vary fastest."""
        return np.concatenate([self._along(data, share) for share in self._shares])

    def balls(self, data: mujoco.MjData) -> tuple[Array, Array]:
        """Middles (n, 3) and radii (n,), m, of balls that cover all parts that can be solid."""
        if self._parts is not None:
            return self._parts.balls(data)
        points = self.links(data)
        return points, np.full(len(points), FINGERTIP)

    def behind_tips(self, data: BodyPoses) -> Array:
        """(7, 5, 3) m, the points of `links`, relative to each finger's tip."""
        # The middle column of each rotation is a bone's own direction.
        axis = data.xmat.take(self._bodies, 0)[:, 1::3]
        behind: Array = self._behind * axis
        return behind

    def update(
        self,
        data: mujoco.MjData,
        reconstruction: Reconstruction,
        ghost: bool = False,
    ) -> None:
        """Chooses the solid fingers for the next step.

        Args:
            data: Current state of the simulation.
            reconstruction: Current reconstruction from touches or hand frames.
            ghost: True makes every finger a ghost, whatever the reconstruction is.
        """
        low = _LOW if self._rules.from_above else (Phase.DOWN,)
        arrived = reconstruction.phase in low and not ghost
        wanted = reconstruction.fingers & self._has if arrived else GHOST
        staying = self.fingers & wanted
        joining = wanted - staying
        stuck: dict[int, int] = {}
        if joining:
            target = self._commanded(reconstruction.q)
            near = np.sqrt(squared_lengths(self.tips(data) - target)) < ARRIVED
            if self._rules.from_above and staying:
                # A finger may press a key before it reaches its place, while others rest on their
                # keys.
                near = np.full_like(near, True)
            free = near & (self._clear(data) if self._rules.ghost_until_clear else True)
            fit = frozenset(f for f in joining if free[f])
            stuck = {f: self._stuck.get(f, 0) + 1 for f in joining if near[f] and not free[f]}
            # All touching fingers of a hand that comes down become solid together: a finger that
            # becomes solid earlier would push away the object to grasp.
            if staying or not self._rules.together:
                staying |= fit
            elif fit == joining:
                staying = fit
        self._stuck = stuck
        self.inside = frozenset(
            f for f, steps in stuck.items() if steps * CONTROL_PERIOD > STUCK_TIME
        )
        if self._parts is not None:
            self._parts.update(data, staying, wanted)
            self.fingers = staying
        elif staying != self.fingers:
            rules = self._rules
            self._scene.set_solid(
                self._hand, staying, whole=not rules.distal_only, links=rules.links
            )
            self.fingers = staying

    def _clear(self, data: mujoco.MjData) -> NDArray[np.bool_]:
        """(5,) bool, True if a finger's links are outside all objects."""
        points = np.concatenate([self.links(data), *self._inner_links(data)])
        rows = self._scene.clearance(data, points).reshape(-1, len(self._reach))
        last, inner = rows[: len(ALONG)], rows[len(ALONG) :]
        clear = last.min(axis=0) - self._radius > CLEARANCE
        if len(inner):
            clear &= inner.min(axis=0) - self._before_radius > CLEARANCE
        return np.asarray(clear)

    def _inner_links(self, data: BodyPoses) -> list[Array]:
        """Points along each finger's last link but one: an array (5, 3), m, for each share of its
        length. The list is empty if only last links are solid."""
        if self._rules.links == 1:
            return []
        start, end = data.xpos.take(self._before, 0), data.xpos.take(self._bodies, 0)
        return [start + share * (end - start) for share in ALONG]

    def _along(self, data: BodyPoses, share: float | Array) -> Array:
        """(5, 3) m, points on the last links, from their joints (0) to their tips (1)."""
        # The middle column of each rotation is a bone's own direction.
        axis = data.xmat.take(self._bodies, 0)[:, 1::3]
        return data.xpos.take(self._bodies, 0) + (share * self._reach)[:, None] * axis
