"""Snapshots, which a session sends to its views. A view may drop any snapshot except the latest.

A window, a film and a simulated user get no other data. Events, which are ordered and never lost,
are in `sandbox.trial.logs`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from models.arithmetic import Array
from models.frames import FINGERS, Contact
from models.surface import Surface
from tasks.score import Score
from tasks.task import Goal, place

MOVE_APART = "Spread your fingers"
"""Text for the person next to a finger that is inside an object."""

TOLD, STRONGEST = 1.0, 70.0
"""Forces (N) stored by a grip. Views show no force below `TOLD`, since a resting finger also stores
that much. Larger forces are drawn as an arc around the finger. It is closed at `STRONGEST`, the
strongest grip tested with people."""


@dataclass(frozen=True)
class HandView:
    """A hand as views draw it.

    Attributes:
        target: (48,) commanded pose in the world, drawn as the ghost hand.
        tips: (5, 3) m, fingertips of the simulated hand.
        solid: Labels of the fingers that can collide now; if empty, the hand is a ghost.
        phase: Phase between hovering and down (`encoders.reconstruction.hand_motion.Phase`).
        contacts: Contacts on the touch surface.
        inside: Labels of the fingers that are inside an object and therefore not solid; a view
            shows `MOVE_APART` next to them.
        surface: The touch surface of the contacts, in the world.
        probability: Probability of the labels, 0 to 1.
    """

    target: Array
    tips: Array
    solid: frozenset[int]
    phase: str
    contacts: tuple[Contact, ...]
    inside: frozenset[int] = frozenset()
    surface: Surface = field(default_factory=Surface)
    probability: float = 1.0

    @cached_property
    def places(self) -> Array:
        """(contacts, 3) m, positions of the contacts in the world, on the touch surface."""
        return self.surface.to_world([(c.x, c.y) for c in self.contacts] or np.zeros((0, 2)))


@dataclass(frozen=True)
class ObjectView:
    """An object as views draw it: position (3,) m and rotation (3, 3)."""

    position: Array
    rotation: Array


@dataclass(frozen=True)
class FingerLoad:
    """Load of one finger.

    Attributes:
        force: N, sum of the forces of all its contacts with objects.
        pressing: N, sum of the components perpendicular to the objects' faces.
        sideways: N, sum of the components along the objects' faces, which friction carries.
        used: Share of its force limit that the finger's most loaded servo uses, 0 to 1.
        stored: N, the part of its force that is balanced by other fingers on the same objects. It
            is released when the grip opens. 0 for a finger that pushes alone.
    """

    force: float = 0.0
    pressing: float = 0.0
    sideways: float = 0.0
    used: float = 0.0
    stored: float = 0.0

    @property
    def at_limit(self) -> bool:
        """True if a servo of the finger is at its force limit."""
        return self.used >= FULL


@dataclass(frozen=True)
class HandLoad:
    """Load of one hand.

    Attributes:
        fingers: Loads of its fingers, thumb first.
        used: Share of its force limit that the palm's most loaded servo uses, 0 to 1.
    """

    fingers: tuple[FingerLoad, ...]
    used: float

    @property
    def palm_at_limit(self) -> bool:
        """True if a servo of the palm, which carries all fingers, is at its force limit."""
        return self.used >= FULL

    @property
    def at_limit(self) -> bool:
        """True if a servo is at its force limit."""
        return self.palm_at_limit or any(finger.at_limit for finger in self.fingers)

    @property
    def full(self) -> frozenset[int]:
        """Labels of the fingers that touch objects while a servo of the finger or of the palm is at
        its force limit."""
        return frozenset(
            label
            for label, finger in enumerate(self.fingers)
            if finger.force > 0.0 and (finger.at_limit or self.palm_at_limit)
        )


NO_LOAD = HandLoad((FingerLoad(),) * len(FINGERS), 0.0)
"""The load of a hand that touches nothing."""

FULL = 0.999
"""Share of a servo's limit from which the limit counts as reached."""


@dataclass(frozen=True)
class Snapshot:
    """One moment of a session.

    Attributes:
        time: s of simulated time since the trial's start.
        step: Physics steps since the trial's start.
        qpos: All joint positions of the scene's model, for a view with its own MjData.
        score: Score so far.
        see_hands, see_objects, see_loads: Functions that compute `hands`, `objects` and `loads` of
            this moment. They are called on first use, as most snapshots do not need these values.
        task_goals: Goals of the drawn task, not yet placed in the world.
        notices: Messages for the person.
        contact: Contact mode: `hard`, `soft` or `none`.
    """

    time: float
    step: int
    qpos: Array
    score: Score = field(default_factory=Score)
    see_hands: Callable[[], tuple[HandView, ...]] = tuple
    see_objects: Callable[[], Mapping[str, ObjectView]] = dict
    task_goals: tuple[Goal, ...] = ()
    notices: tuple[str, ...] = ()
    contact: str = "hard"
    see_loads: Callable[[], tuple[HandLoad, ...]] = tuple

    @cached_property
    def hands(self) -> tuple[HandView, ...]:
        """One view per hand of the scene."""
        return self.see_hands()

    @cached_property
    def objects(self) -> Mapping[str, ObjectView]:
        """Views of the objects by name."""
        return self.see_objects()

    @cached_property
    def goals(self) -> tuple[Goal, ...]:
        """Goals of the task, placed in the world."""
        return place(self.task_goals, self.objects)

    def with_hands(self, *hands: HandView) -> Snapshot:
        """The same moment with other views of the hands."""
        return replace(self, see_hands=lambda: hands)

    @cached_property
    def loads(self) -> tuple[HandLoad, ...]:
        """Loads of each hand; empty if no hand is solid, or if the session computes no loads."""
        return self.see_loads()

    def stored(self, hand: int, label: int | None) -> float:
        """Force (N) that a grip of a hand stores in a finger; 0 if it is too small to show."""
        if label is None or not self.loads:
            return 0.0
        force = self.loads[hand].fingers[label].stored
        return force if force >= TOLD else 0.0

    def at_limit(self, hand: int, label: int | None) -> bool:
        """True if a hand has no more force for a touching finger."""
        return bool(self.loads) and label in self.loads[hand].full

    @property
    def notice(self) -> str:
        """All notices in one line; empty without any."""
        return "; ".join(self.notices)
