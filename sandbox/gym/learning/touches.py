"""Actions that are touches, with a slot for every finger."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from encoders.reconstruction.reconstructor import Reconstructor
from models.arithmetic.arrays import Array
from models.frames import FINGERS, Contact, TouchFrame
from models.pose import ROOT_ROTATION
from models.rotations import exp
from models.surface import Surface
from sandbox.gym.actions import Hands
from sandbox.gym.learning.options import LearningOptions
from sandbox.session.messages import HandView

AHEAD = 0.05
"""m along the hand, by which its direction on the surface is found."""


class FingerTouches(Hands):
    """Touches of one hand, one slot a finger, thumb first.

    An action is (15,), or (16,) with a lift control, 0 (down) to 1: for every finger whether it
    touches (0.5 or more), and two numbers. With `touch` they are x and y, m on the surface. With
    `delta` and `hand` they are steps from -1 to 1, in shares of `step`: `delta` along the surface's
    axes, right and down; `hand` along those of the hand, to its right and to its fingertips. A
    finger that begins to touch does so beneath its simulated fingertip, and a step farther.

    Touches that begin in one period get their ids from left to right, so that ids do not depend on
    the slots.

    Args:
        surface: The surface of this hand.
        lifts: True if the task has a lift control.
        options: The contract.

    Attributes:
        places: (5, 2) m on the surface, where each finger touches, or last did; with steps, where a
            lifted one would.
    """

    def __init__(self, surface: Surface, lifts: bool, options: LearningOptions) -> None:
        self._surface, self._lifts, self._options = surface, lifts, options
        width, height = surface.size
        least, most = ([0.0, 0.0], [width, height])
        if options.action != "touch":
            least, most = [-1.0, -1.0], [1.0, 1.0]
        self.low = np.array([0.0, *least] * len(FINGERS) + [0.0] * lifts)
        self.high = np.array([1.0, *most] * len(FINGERS) + [1.0] * lifts)
        self.touch_ids: list[int | None] = [None] * len(FINGERS)
        self.places = np.zeros((len(FINGERS), 2))
        self._axes = np.eye(2)
        self._next = 0
        self._contacts: tuple[Contact, ...] = ()
        self._lift: float | None = 0.0 if lifts else None

    def see(self, hand: HandView) -> None:
        """Takes in where the hand is; steps begin there."""
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
        """Takes an action."""
        rows = action[: 3 * len(FINGERS)].reshape(len(FINGERS), 3)
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
        told = self._options.names == "told"
        contacts = [
            Contact(id, float(x), float(y), label=finger if told else None)
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
        """Returns the reconstructor for touches unchanged."""
        return touched

    def _within(self, places: Array) -> Array:
        return np.clip(places, 0.0, self._surface.size)
