"""Snapshots, which a session sends to its views; a view may drop any but the latest.

A window, a film or a simulated user sees nothing but snapshots. Events, which are ordered and never
lost, are in `sandbox.trial.events`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Protocol

from models.arithmetic.arrays import Array
from sandbox.session.contact_forces import HandLoad, KeptLoads
from tasks.score import Score
from tasks.task import Goal

MOVE_APART = "Move apart"
"""What a person is told beside a finger that is inside an object."""

SURE = 0.8
"""Probability of a finger's name below which views show that it is not sure."""

TOLD, STRONGEST = 1.0, 70.0
"""N stored by a grip: below the first views say nothing, as a resting finger presses with as much;
at the second, the strongest grip that people were tried at, the arc around a finger is closed."""


@dataclass(frozen=True)
class ContactView:
    """A contact as views draw it.

    Attributes:
        id: Id of the contact.
        position: (3,) m, in the world, on the touch surface.
        label: Its finger, thumb 0 to little 4; None before it is labelled.
        state: `active`; `lost` during the grace period after it was lost; `palm` (drawn as a faint
            patch); `ignored` (drawn grey).
        probability: Probability of the label, 0 to 1; 1 where no label is given.
    """

    id: int
    position: Array
    label: int | None
    state: str
    probability: float = 1.0

    @property
    def sure(self) -> bool:
        """False if the label may well be wrong."""
        return self.probability >= SURE


@dataclass(frozen=True)
class HandView:
    """A hand as views draw it.

    Attributes:
        target: (48,) commanded pose in the world, drawn as the ghost hand.
        tips: (5, 3) m, fingertips of the simulated hand.
        solid: Labels of the fingers that can collide now; the hand is a ghost while it is empty.
        phase: Phase between hovering and down (`encoders.reconstruction.arrival.Phase`).
        contacts: Contacts on the touch surface.
        inside: Labels of the fingers that are inside an object and therefore not solid; beside them
            a view says `MOVE_APART`.
    """

    target: Array
    tips: Array
    solid: frozenset[int]
    phase: str
    contacts: tuple[ContactView, ...]
    inside: frozenset[int] = frozenset()


@dataclass(frozen=True)
class ObjectView:
    """An object as views draw it: position (3,) m and rotation (3, 3)."""

    position: Array
    rotation: Array


class SceneView(Protocol):
    """What is drawn of a scene at one moment.

    Attributes:
        hands: One view per hand of the scene.
        objects: Views of the objects by name.
        goals: Goals of the task, placed in the world.
    """

    @property
    def hands(self) -> tuple[HandView, ...]: ...

    @property
    def objects(self) -> Mapping[str, ObjectView]: ...

    @property
    def goals(self) -> tuple[Goal, ...]: ...


@dataclass(frozen=True)
class DrawnScene:
    """A `SceneView` that is known as a whole."""

    hands: tuple[HandView, ...] = ()
    objects: Mapping[str, ObjectView] = field(default_factory=dict)
    goals: tuple[Goal, ...] = ()


@dataclass(frozen=True)
class Snapshot:
    """One moment of a session.

    Attributes:
        time: s of simulated time since the trial's start.
        step: Physics steps since the trial's start.
        qpos: All joint positions of the scene's model, for a view with its own MjData.
        scene: Hands, objects and goals; a session's are computed at the first look.
        score: Score so far.
        notices: Messages for the person.
        contact: Contact mode: `hard`, `soft` or `none`.
        kept_loads: What the hands press with, for `loads`; None where nobody has kept it.
    """

    time: float
    step: int
    qpos: Array
    scene: SceneView
    score: Score
    notices: tuple[str, ...] = ()
    contact: str = "hard"
    kept_loads: KeptLoads | None = None

    @property
    def hands(self) -> tuple[HandView, ...]:
        """One view per hand of the scene."""
        return self.scene.hands

    @property
    def objects(self) -> Mapping[str, ObjectView]:
        """Views of the objects by name."""
        return self.scene.objects

    @property
    def goals(self) -> tuple[Goal, ...]:
        """Goals of the task, placed in the world."""
        return self.scene.goals

    def with_hands(self, *hands: HandView) -> Snapshot:
        """The same moment with other views of the hands."""
        return replace(self, scene=DrawnScene(hands, self.objects, self.goals))

    @property
    def loads(self) -> tuple[HandLoad, ...]:
        """Loads of each hand, read at the first look; empty where they are not known."""
        return () if self.kept_loads is None else self.kept_loads.hands

    def stored(self, hand: int, label: int | None) -> float:
        """N that a grip of a hand stores in a finger; 0 where nothing is worth telling."""
        if label is None or not self.loads:
            return 0.0
        force = self.loads[hand].fingers[label].stored
        return force if force >= TOLD else 0.0

    def at_limit(self, hand: int, label: int | None) -> bool:
        """True if a hand has no more force for a finger that touches something."""
        return bool(self.loads) and label in self.loads[hand].full

    @property
    def notice(self) -> str:
        """All notices in one line; empty without any."""
        return "; ".join(self.notices)
