"""Actions of an agent in one control period: touches on the surface, or the hand's pose."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from encoders.reconstruction.hand_motion import Phase, RateLimit
from encoders.reconstruction.reconstructor import Reconstruction, Reconstructor
from models.arithmetic import Array
from models.frames import FINGERS, Contact, TouchFrame
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION, within_limits
from models.rotations import exp
from models.skeleton import Skeleton
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.gym.environment_options import EnvOptions
from sandbox.session.messages import HandView

SLOTS = len(FINGERS)
"""Number of simultaneous touches, one for each finger."""

REACH = ((-0.40, -0.40, -0.05), (0.40, 0.40, 0.50))
"""Bounds of the commanded root position of a hand, m in the world."""
AHEAD = 0.05
"""Distance along the hand from its root to a second point, m. The two points give the hand's
direction on the surface."""


class Hands(Device):
    """Device of an agent. It converts the agent's actions to the session's input.

    Attributes:
        low: Lower bounds of an action.
        high: Upper bounds of an action.
        touch_ids: Id of the contact in every slot; None in an empty slot.
        places: (5, 2) m on the surface, place of each finger's current touch. For a lifted finger,
            the place of its last touch for the action `touch`, and the place under its fingertip
            for `delta` and `hand`. All 0 for `pose`.
    """

    name = "gymnasium"
    low: Array
    high: Array

    def __init__(self) -> None:
        self.touch_ids: list[int | None] = [None] * SLOTS
        self.places = np.zeros((SLOTS, 2))

    @abstractmethod
    def act(self, action: Array) -> None:
        """Sets the action for the next control period; it must be finite and within its bounds."""

    def see(self, hand: HandView) -> None:
        """Receives the current pose of the hand."""

    @abstractmethod
    def reconstructor_for(self, touched: Reconstructor) -> Reconstructor:
        """Returns the reconstructor to use; `touched` is the reconstructor for touches."""


class TouchHands(Hands):
    """Actions that are touches of one hand, one slot per finger, thumb first.

    An action is (15,), or (16,) with a lift control. It has three numbers per finger: whether the
    finger touches (0.5 or more), and two coordinates. For `touch`, the coordinates are x and y, m
    on the surface. For `delta` and `hand` they are a step of the touch: multiples of `step`, from
    -1 to 1. The axes of `delta` are those of the surface, right and down. The axes of `hand` are
    those of the hand, to its right and towards its fingertips. A finger that begins to touch starts
    under its simulated fingertip, and the step is added. The last of 16 numbers is the lift
    control, 0 (down) to 1.

    A slot that touches again after a pause gets a new contact, like a finger that was lifted.
    Touches that begin in one period get their ids from left to right, so that ids do not depend on
    the slots.

    Args:
        surface: The surface of this hand.
        lifts: True if the task has a lift control.
        options: Options of the environment.
    """

    def __init__(self, surface: Surface, lifts: bool, options: EnvOptions) -> None:
        super().__init__()
        self._surface, self._lifts, self._options = surface, lifts, options
        width, height = surface.size
        least, most = ([0.0, 0.0], [width, height])
        if options.action != "touch":
            least, most = [-1.0, -1.0], [1.0, 1.0]
        self.low = np.array([0.0, *least] * SLOTS + [0.0] * lifts)
        self.high = np.array([1.0, *most] * SLOTS + [1.0] * lifts)
        self._axes = np.eye(2)
        self._next = 0
        self._contacts: tuple[Contact, ...] = ()
        self._lift: float | None = 0.0 if lifts else None

    def see(self, hand: HandView) -> None:
        """Receives the current pose of the hand, at which the steps of new touches begin."""
        if self._options.action == "touch":
            return
        lifted = [finger for finger, id in enumerate(self.touch_ids) if id is None]
        self.places[lifted] = self._within(self._surface.to_surface(hand.tips[lifted]))
        ahead = AHEAD * exp(hand.target[ROOT_ROTATION])[:, 1]
        way = self._surface.to_surface(np.stack([hand.target[:3], hand.target[:3] + ahead]))
        along = way[1] - way[0]
        size = float(np.sqrt(np.sum(along * along)))
        if size > 1e-6:
            x, y = along / size
            # Right of the fingers' direction, on a surface whose y points down.
            self._axes = np.array([[-y, x], [x, y]])

    def act(self, action: Array) -> None:
        """Sets the touches for the next control period."""
        rows = action[: 3 * SLOTS].reshape(SLOTS, 3)
        down = rows[:, 0] >= 0.5
        if self._options.action == "touch":
            self.places[down] = rows[down, 1:]
        else:
            steps = self._options.step * rows[:, 1:]
            if self._options.action == "hand":
                steps = steps[:, :1] * self._axes[0] + steps[:, 1:] * self._axes[1]
            self.places[down] = self._within(self.places + steps)[down]
        for finger in np.flatnonzero(~down):
            self.touch_ids[finger] = None
        new = [finger for finger in np.flatnonzero(down) if self.touch_ids[finger] is None]
        for finger in sorted(new, key=lambda f: (self.places[f, 0], self.places[f, 1], f)):
            self.touch_ids[finger], self._next = self._next, self._next + 1
        labelled = self._options.true_labels
        contacts = [
            Contact(id, float(x), float(y), label=finger if labelled else None)
            for finger, (id, (x, y)) in enumerate(zip(self.touch_ids, self.places, strict=True))
            if id is not None
        ]
        # In the order of touch-down, as on a device.
        self._contacts = tuple(sorted(contacts, key=lambda c: c.id))
        if self._lifts:
            self._lift = float(action[-1])

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Returns the current touches."""
        return [TouchFrame(now, self._contacts, self._lift, source=self.name)]

    def reconstructor_for(self, touched: Reconstructor) -> Reconstructor:
        """Returns the reconstructor for touches, unchanged."""
        return touched

    def _within(self, places: Array) -> Array:
        return np.clip(places, 0.0, self._surface.size)


class PoseHands(Hands):
    """Actions that are whole poses, without labels and encoder.

    An action is (53,): the pose (48,) in the world, m and rad (see `models.pose`), then for every
    finger whether it may be solid (0.5 or more). Joints are clipped to their ranges, and speeds to
    the limits of a session. A finger becomes solid only outside of objects.

    Args:
        skeleton: The hand's skeleton.
    """

    def __init__(self, skeleton: Skeleton) -> None:
        super().__init__()
        self._skeleton = skeleton
        self.low, self.high = np.empty(POSE_SIZE + SLOTS), np.empty(POSE_SIZE + SLOTS)
        for bound, reach, turn, joints, flag in (
            (self.low, REACH[0], -np.pi, skeleton.lower, 0.0),
            (self.high, REACH[1], np.pi, skeleton.upper, 1.0),
        ):
            bound[ROOT_POSITION], bound[ROOT_ROTATION] = reach, turn
            bound[JOINTS], bound[POSE_SIZE:] = joints, flag
        self._pose: Array | None = None
        self._solid: frozenset[int] = frozenset()

    def act(self, action: Array) -> None:
        """Sets the pose for the next control period, and the fingers that may be solid."""
        self._pose = within_limits(action[:POSE_SIZE], self._skeleton)
        self._solid = frozenset(np.flatnonzero(action[POSE_SIZE:] >= 0.5).tolist())

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Returns no touches."""
        return []

    def reconstructor_for(self, touched: Reconstructor) -> Reconstructor:
        """Returns a reconstructor that follows the poses, starting from a hand's initial pose."""
        return _PoseFollower(self, touched)

    def command(self) -> tuple[Array | None, frozenset[int]]:
        """The last commanded pose (48,), or None before the first; and the fingers to be solid."""
        return self._pose, self._solid


class _PoseFollower:
    """A reconstructor that returns the agent's pose, with limited speeds."""

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

    def set_tip_offsets(self, offsets: Array | None) -> None:
        self._touched.set_tip_offsets(offsets)

    def step(self, frame: TouchFrame) -> Reconstruction:
        dt = 0.0 if self._time is None else frame.time - self._time
        self._time = frame.time
        pose, solid = self._hands.command()
        if pose is not None:
            self._commanded = self._rate(self._commanded, pose, dt)
        return Reconstruction(self._commanded, Phase.DOWN, solid, None, 1.0, 0.0)
