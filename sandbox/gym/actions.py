"""Actions of an agent in one control period: touches on the surface, or the hand's pose."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from encoders.reconstruction.arrival import Phase
from encoders.reconstruction.reconstructor import Reconstructor
from encoders.reconstruction.touch_reconstructor import Reconstruction
from models.arithmetic.arrays import Array
from models.frames import FINGERS, Contact, TouchFrame
from models.limits import RateLimit, within_limits
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION
from models.skeleton import Skeleton
from models.surface import Surface
from sandbox.session.device import Device
from tasks.task import Task

SLOTS = len(FINGERS)
"""Number of simultaneous touches, one for each finger."""

REACH = ((-0.40, -0.40, -0.05), (0.40, 0.40, 0.50))
"""m in the world; bounds of the commanded root position of a hand."""


class Hands(Device):
    """Device of an agent, which converts its actions to the session's input.

    Attributes:
        low: Lower bounds of an action.
        high: Upper bounds of an action.
        touch_ids: Id of the contact in every slot; None in an empty slot.
    """

    name, finished = "gymnasium", False
    low: Array
    high: Array
    touch_ids: list[int | None]

    @abstractmethod
    def act(self, action: Array) -> None:
        """Takes an action, finite and within its bounds, for the next control period."""

    @abstractmethod
    def reconstructor_for(self, touched: Reconstructor) -> Reconstructor:
        """Returns the reconstructor to use; `touched` is the one for touches."""


class TouchHands(Hands):
    """Actions that are five touches, and the lift control if the task has one.

    An action is (15,): for every slot a touch flag (0.5 or more touches), x and y in metres on the
    surface, right and down of its top left corner; or (16,) with the lift, 0 (down) to 1. A slot
    that touches again after a pause is a new contact, like a lifted finger.

    Args:
        surface: The screen.
        task: The task, which may have a lift control.
    """

    def __init__(self, surface: Surface, task: type[Task]) -> None:
        self._lifts = task.lift_range > 0
        width, height = surface.size
        self.low = np.zeros(3 * SLOTS + self._lifts)
        self.high = np.array([1.0, width, height] * SLOTS + [1.0] * self._lifts)
        self.touch_ids: list[int | None] = [None] * SLOTS
        self._next = 0
        self._contacts: tuple[Contact, ...] = ()
        self._lift: float | None = 0.0 if self._lifts else None

    def act(self, action: Array) -> None:
        """Takes an action."""
        contacts = []
        for slot, (down, x, y) in enumerate(action[: 3 * SLOTS].reshape(SLOTS, 3)):
            if down < 0.5:
                self.touch_ids[slot] = None
                continue
            id = self.touch_ids[slot]
            if id is None:
                id, self._next = self._next, self._next + 1
                self.touch_ids[slot] = id
            contacts.append(Contact(id, float(x), float(y)))
        # Contacts are in the order of touch-down, as on a device.
        self._contacts = tuple(sorted(contacts, key=lambda c: c.id))
        if self._lifts:
            self._lift = float(action[-1])

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Returns the current touches."""
        return [TouchFrame(now, self._contacts, self._lift, source=self.name)]

    def reconstructor_for(self, touched: Reconstructor) -> Reconstructor:
        """Returns the reconstructor for touches unchanged."""
        return touched


class PoseHands(Hands):
    """Actions that are whole poses, without labels and encoder.

    An action is (53,): the pose (48,) in the world, m and rad (see `models.pose`), then for every
    finger whether it may be solid (0.5 or more). Joints are clipped to their ranges, speeds to the
    limits of a session, and a finger becomes solid only outside of objects.

    Args:
        skeleton: The hand's skeleton.
    """

    def __init__(self, skeleton: Skeleton) -> None:
        self._skeleton = skeleton
        self.low, self.high = np.empty(POSE_SIZE + SLOTS), np.empty(POSE_SIZE + SLOTS)
        for bound, reach, turn, joints, flag in (
            (self.low, REACH[0], -np.pi, skeleton.lower, 0.0),
            (self.high, REACH[1], np.pi, skeleton.upper, 1.0),
        ):
            bound[ROOT_POSITION], bound[ROOT_ROTATION] = reach, turn
            bound[JOINTS], bound[POSE_SIZE:] = joints, flag
        self.touch_ids: list[int | None] = [None] * SLOTS
        self._pose: Array | None = None
        self._solid: frozenset[int] = frozenset()

    def act(self, action: Array) -> None:
        """Takes an action."""
        self._pose = within_limits(action[:POSE_SIZE], self._skeleton)
        self._solid = frozenset(np.flatnonzero(action[POSE_SIZE:] >= 0.5).tolist())

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """No touches."""
        return []

    def reconstructor_for(self, touched: Reconstructor) -> Reconstructor:
        """Returns a reconstructor that follows the poses, from the waiting pose of a hand."""
        return _PoseFollower(self, touched)

    def wanted(self) -> tuple[Array | None, frozenset[int]]:
        """The pose (48,) last commanded, None before the first, and the fingers to be solid."""
        return self._pose, self._solid


class _PoseFollower:
    """A reconstructor that passes through the agent's pose."""

    def __init__(self, hands: PoseHands, touched: Reconstructor) -> None:
        self._hands, self._touched = hands, touched
        self._rate = RateLimit()
        self.counts: dict[str, int] = {}
        self.empty, self.notice = touched.empty, ""
        self.reset()

    @property
    def surface(self) -> Surface:
        return self._touched.surface

    @property
    def commanded(self) -> Array:
        return self._commanded

    def reset(self) -> None:
        self._touched.reset()
        self._commanded = self._touched.commanded
        self._time: float | None = None

    def lead(self, offsets: Array | None) -> None:
        self._touched.lead(offsets)

    def step(self, frame: TouchFrame) -> Reconstruction:
        dt = 0.0 if self._time is None else frame.time - self._time
        self._time = frame.time
        pose, solid = self._hands.wanted()
        if pose is not None:
            self._commanded = self._rate(self._commanded, pose, dt)
        return Reconstruction(self._commanded, Phase.DOWN, solid, None, 1.0, 0.0, ())
