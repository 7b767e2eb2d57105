"""The simulated user as a device: it gets the same snapshots as a window, and returns touches."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError
from models.frames import TouchFrame
from models.objects import Box, SceneObject, Tray
from models.person import Person
from models.plugins import Registry
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.simulated import NEXT_PERSON
from sandbox.devices.wrappers.degraded import DropOuts
from sandbox.session.messages import Snapshot
from tasks.registry import hands_of
from tasks.simulated_user.view import FrontUser, FrontView, Seat, SeatedUser
from tasks.task import Task
from tasks.user import FingersKnown, LateSight, SeenObject, Sight, User, UserConfiguration

_USERS: Registry[Callable[..., User]] = Registry(
    {
        "skilled": "tasks.simulated_user.user:SkilledUser",
        "skilled, upright": "tasks.simulated_user.stacker:FrontStacker",
        "skilled, lifting": "tasks.simulated_user.stacker:Stacker",
        "skilled, two hands": "tasks.simulated_user.carrier:Carrier",
        "idle": "tasks.simulated_user.user:IdleUser",
        "idle, lifting": "tasks.simulated_user.user:IdleLiftUser",
        "random": "tasks.simulated_user.user:RandomUser",
        "random, lifting": "tasks.simulated_user.user:RandomLiftUser",
    }
)
"""Simulated users, by kind and by the movement that a task requires."""


class SimulatedDevice(Device):
    """A tablet under the fingers of a simulated user.

    Args:
        task: The drawn task, for the shapes of its objects; the user does not get the task itself.
        configuration: Configuration of the simulated user.
        surface: The tablet's touch surface.
        seed: Seed of all random numbers of the user.
        labels: True labels each contact with its true finger (an upper bound for labelling).
        drop_outs: 1/s, rate at which the screen loses each touch for a moment.
        person: Side of the hand, its size, and where the person sits.
        hand: Index of the user's hand in the scene.
        home: (2,) m in the world, centre of the user's part of the screen; None for the whole
            screen.

    Attributes:
        true_labels: True finger of each touch, thumb 0 .. little 4, by the id that the screen
            reported; empty for users who press at random. Neither user nor encoder receives it.
    """

    name = "simulated"
    lift = True
    takes_snapshots = True
    true_labels: dict[int, int]

    def __init__(
        self,
        task: Task,
        configuration: UserConfiguration,
        surface: Surface,
        seed: int,
        labels: bool = False,
        drop_outs: float = 0.0,
        person: Person | None = None,
        hand: int = 0,
        home: NDArray[np.float64] | None = None,
    ) -> None:
        self.true_labels = {}
        self._hand = hand
        # Two people need independent random numbers.
        seed += hand * NEXT_PERSON
        self._shapes = {thing.name: thing for thing in task.objects}
        self._labels = labels
        self._screen = DropOuts(drop_outs, seed)
        person = person or Person()
        configuration = replace(configuration, hand_size=person.hand_size)
        upright, view = surface.upright, FrontView(surface)
        surface = view.surface if upright else surface
        seat = Seat(person, surface)
        plain = Person(hand_size=person.hand_size) == person
        # Only a task's own user has instructions that differ from what a skilled user does.
        kind = "skilled" if configuration.kind == "demonstrating" else configuration.kind
        skilled = kind == "skilled"
        used = surface if plain else seat.surface
        own = type(task).user if skilled else None
        carried = any(isinstance(thing, Tray) for thing in task.objects)
        if own is None and skilled and hands_of(task) > 1 and not carried:
            raise InputError(
                "the only task that two simulated users know is to carry a tray",
                where=task.name,
                remedy="Define the task's own simulated user (`user`)",
            )
        if own is None and skilled and not task.goals:
            raise InputError(
                "the simulated user brings objects to goals, and this task has no goals",
                where=task.name,
                remedy="Give the task goals, or its own simulated user (`user`)",
            )
        if (
            own is None
            and skilled
            and hands_of(task) == 1
            and (upright or task.lift_range > 0)
            and not all(isinstance(thing, Box) for thing in task.objects)
        ):
            raise InputError(
                "the simulated user can only lift boxes, and put them upright",
                where=task.name,
                got=", ".join(t.name for t in task.objects if not isinstance(t, Box)),
                remedy="Define the task's own simulated user (`user`), or play it by hand",
            )
        if home is not None and not plain:
            home = seat.point(np.array([*home, 0.0]))[:2]
        self.user: User = (
            own(configuration, used, seed)
            if own is not None
            else _USERS["skilled, two hands"](configuration, used, seed, task.lift_range, home)
            if hands_of(task) > 1 and skilled
            else _USERS[f"{kind}, lifting"](configuration, used, seed, task.lift_range)
            if task.lift_range > 0
            else _USERS["skilled, upright" if upright and skilled else kind](
                configuration, used, seed
            )
        )
        # A user at another seat, or with another hand, is the same user behind a wrapper.
        self._seated: User = self.user if plain else SeatedUser(self.user, seat)
        if upright:
            self._seated = FrontUser(self._seated, view)

    def show(self, snapshot: Snapshot) -> None:
        """Shows the snapshot to the user."""
        sight = partial(_sight, snapshot, self._hand, self._shapes, self._screen.own_id)
        if self._screen.loses:
            # The mapping of ids changes with drop-outs, so it is applied now.
            self._seated.observe(sight())
            return
        self._seated.observe(LateSight.of(snapshot.time, sight))

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The user's touches now."""
        if self.finished:
            return []
        frame = self._seated.touch(now)
        if not isinstance(frame, TouchFrame):
            raise InputError(
                "`touch` of the simulated user did not return a TouchFrame",
                where=type(self.user).__name__,
                got=repr(frame)[:80],
                expected="TouchFrame(now) if nothing touches",
                remedy="Every branch of `touch` needs a `return`",
            )
        if not isinstance(self.user, FingersKnown):
            return [self._screen.degrade(frame)]
        finger_of = self.user.finger_of
        if self._labels:
            contacts = tuple(replace(c, label=finger_of(c.id)) for c in frame.contacts)
            frame = replace(frame, contacts=contacts)
        frame = self._screen.degrade(frame)
        for contact in frame.contacts:
            if contact.id not in self.true_labels:
                finger = finger_of(self._screen.own_id(contact.id))
                if finger is not None:
                    self.true_labels[contact.id] = finger
        return [frame]


def _sight(
    snapshot: Snapshot, hand: int, shapes: Mapping[str, SceneObject], own_id: Callable[[int], int]
) -> Sight:
    """Returns the part of a snapshot that the person with this hand sees."""
    mine = snapshot.hands[hand]
    return Sight(
        snapshot.time,
        {own_id(c.id): mine.tips[c.label] for c in mine.contacts if c.label is not None},
        bool(mine.solid),
        {
            name: SeenObject(shapes[name], o.position, o.rotation)
            for name, o in snapshot.objects.items()
        },
        snapshot.goals,
        snapshot.score.held,
    )
