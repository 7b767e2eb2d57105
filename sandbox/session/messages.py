"""Messages of a session to its views: snapshots, of which the latest wins and any may be dropped.

A snapshot is all that a window, a film or a simulated user gets to see. Events, which are ordered
and never lost, are in `sandbox.trial.events`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from models.arithmetic.arrays import Array
from models.later import Later
from tasks.score import Score
from tasks.task import Goal


@dataclass(frozen=True)
class ContactView:
    """A contact as it is drawn.

    Attributes:
        id: Id of the contact.
        position: (3,) m, in the world, on the touch surface.
        label: Its finger, or None while it has none.
        state: `active`; `lost` while it lives on for a moment; `ignored`: drawn grey.
    """

    id: int
    position: Array
    label: int | None
    state: str


@dataclass(frozen=True)
class HandView:
    """A hand as it is drawn.

    Attributes:
        target: (48,) commanded pose in the world: the ghost hand.
        tips: (5, 3) m, fingertips of the simulated hand.
        solid: Labels of the fingers that can touch things now; empty: the hand is a ghost.
        phase: Where the hand is between hovering and being down (see the reconstructor).
        contacts: What touches the surface.
    """

    target: Array
    tips: Array
    solid: frozenset[int]
    phase: str
    contacts: tuple[ContactView, ...]


@dataclass(frozen=True)
class ObjectView:
    """An object as it is drawn: position (3,) m and rotation (3, 3)."""

    position: Array
    rotation: Array


@dataclass(frozen=True)
class Snapshot(Later):
    """One moment of a session.

    Attributes:
        time: s of simulated time since the trial's start.
        step: Physics steps since the trial's start.
        qpos: All joint positions of the scene's model, for a view with its own MjData.
        hands: One per hand of the scene.
        objects: By name.
        goals: What is to be reached, all of it placed in the world.
        score: So far.
        notices: Words to the person.
        contact: How hands and objects touch: `hard`, `soft` or `none`.
    """

    time: float
    step: int
    qpos: Array
    hands: tuple[HandView, ...]
    objects: Mapping[str, ObjectView]
    goals: tuple[Goal, ...]
    score: Score
    notices: tuple[str, ...] = ()
    contact: str = "hard"

    @property
    def notice(self) -> str:
        """All notices in one line, or empty."""
        return "; ".join(self.notices)
