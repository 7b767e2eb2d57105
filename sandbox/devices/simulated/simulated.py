"""The simulated user as a device: looks at snapshots like a window, touches like a tablet."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError
from models.frames import TouchFrame
from models.objects import SceneObject, Tray
from models.person import Person
from models.surface import Surface
from sandbox.devices.wrappers.drop_outs import DropOuts
from sandbox.session.device import Device
from sandbox.session.messages import Snapshot
from tasks.registry import hands_of
from tasks.simulated_user.carrier import Carrier
from tasks.simulated_user.control_users import IdleUser, RandomUser
from tasks.simulated_user.front_stacker import FrontStacker
from tasks.simulated_user.front_view import FrontUser, FrontView
from tasks.simulated_user.lift import IdleLiftUser, RandomLiftUser
from tasks.simulated_user.seated import Seat, SeatedUser
from tasks.simulated_user.stacker import Stacker
from tasks.simulated_user.user import SkilledUser
from tasks.task import Task
from tasks.user import SeenObject, Sight, User, UserConfiguration

_USERS: dict[str, type[SkilledUser] | type[IdleUser] | type[RandomUser]] = {
    "skilled": SkilledUser,
    "idle": IdleUser,
    "random": RandomUser,
}

_LIFTING: dict[str, type[Stacker] | type[IdleLiftUser] | type[RandomLiftUser]] = {
    "skilled": Stacker,
    "idle": IdleLiftUser,
    "random": RandomLiftUser,
}
"""Who plays a task with a lift control."""

NEXT_PERSON = 1_000_003
"""Added to the seed of who plays the second hand; beyond all seeds of trials."""


class SimulatedDevice(Device):
    """A tablet under the fingers of a simulated user.

    Args:
        task: For the shapes of what is drawn; the user never gets the task itself.
        configuration: What kind of person.
        surface: The tablet.
        seed: Of the person's chance.
        tell_labels: Tells which finger touches (an upper bound for labelling; never the default).
        drop_outs: Times per second that the screen loses each touch for a moment.
        person: Which hand they use and where they sit.
        hand: Which of the scene's hands is theirs.
        home: (2,) m in the world, the middle of their part of the screen; None is the screen's.

    Attributes:
        truth: Which finger each touch was, thumb 0 .. little 4, by the id that the screen gave it;
            empty for users who only press about. No user and no encoder gets to see it.
    """

    name = "simulated"
    has_lift = True
    looks = True
    finished = False
    truth: dict[int, int]

    def __init__(
        self,
        task: Task,
        configuration: UserConfiguration,
        surface: Surface,
        seed: int,
        tell_labels: bool = False,
        drop_outs: float = 0.0,
        person: Person | None = None,
        hand: int = 0,
        home: NDArray[np.float64] | None = None,
    ) -> None:
        self.truth = {}
        self._hand = hand
        # Two people do not share their chance.
        seed += hand * NEXT_PERSON
        self._shapes = {thing.name: thing for thing in task.objects}
        self._tell_labels = tell_labels
        self._screen = DropOuts(drop_outs, seed)
        person = person or Person()
        upright, view = surface.upright, FrontView(surface)
        surface = view.surface if upright else surface
        seat = Seat(person, surface)
        plain = Person(hand_size=person.hand_size) == person
        make = _USERS[configuration.kind]
        if upright and make is SkilledUser:
            make = FrontStacker
        used = surface if plain else seat.surface
        own = type(task).user if configuration.kind == "skilled" else None
        carried = any(isinstance(thing, Tray) for thing in task.objects)
        if own is None and configuration.kind == "skilled" and hands_of(task) > 1 and not carried:
            raise InputError(
                "two simulated users only know how to carry a tray",
                where=task.name,
                remedy="Give the task a user of its own",
            )
        if own is None and configuration.kind == "skilled" and not task.goals:
            raise InputError(
                "the simulated user brings things to goals, and this task has none",
                where=task.name,
                remedy="Give the task goals, or a user of its own",
            )
        if home is not None and not plain:
            home = seat.point(np.array([*home, 0.0]))[:2]
        self.user: User = (
            own(configuration, used, seed)
            if own is not None
            else Carrier(configuration, used, seed, task.lift_range, home)
            if hands_of(task) > 1 and configuration.kind == "skilled"
            else _LIFTING[configuration.kind](configuration, used, seed, task.lift_range)
            if task.lift_range > 0
            else make(configuration, used, seed)
        )
        # Who looks and touches: the user where they are, or from another seat.
        self._seated: User = self.user if plain else SeatedUser(self.user, seat)
        if upright:
            self._seated = FrontUser(self._seated, view)

    def show(self, snapshot: Snapshot) -> None:
        """Lets the user look at the screen."""
        # Without the device in it, which keeps what its user looks at and would be kept by that.
        shown = partial(_sight, snapshot, self._hand, self._shapes, self._screen.own_id)
        if self._screen.loses:
            # Who is who on such a screen is known only now.
            self._seated.look(shown())
            return
        # Who acts four times in a second need not see sixty pictures.
        self._seated.look(Sight.deferred(lambda: vars(shown()), time=snapshot.time))

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """What the user touches now."""
        if self.finished:
            return []
        frame = self._seated.touch(now)
        if not isinstance(self.user, SkilledUser):
            return [self._screen.spoil(frame)]
        # The user puts down thumb, index, ... in this order.
        ids = self.user.finger_ids
        if self._tell_labels:
            contacts = tuple(replace(c, label=ids().index(c.id)) for c in frame.contacts)
            frame = replace(frame, contacts=contacts)
        frame = self._screen.spoil(frame)
        for contact in frame.contacts:
            if contact.id not in self.truth:
                own = self._screen.own_id(contact.id)
                if own in ids():
                    self.truth[contact.id] = ids().index(own)
        return [frame]

    def close(self) -> None:
        """The user leaves; there is nothing to give back."""
        self.finished = True


def _sight(
    snapshot: Snapshot, hand: int, shapes: Mapping[str, SceneObject], own_id: Callable[[int], int]
) -> Sight:
    """What is seen of a snapshot by who has one of its hands."""
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
