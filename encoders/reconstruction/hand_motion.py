"""Motion of a hand from step to step: smoothing, arrival, lift, and bounds on its speed.

*Smoothing* of the posture takes place in surface coordinates, never on poses relative to the
leftmost contact. When another finger becomes the leftmost contact, this origin jumps by the width
of a hand.

*Arrival*: the hand hovers as a ghost over its place. It comes down from above once it is over its
place and the touches rest, and rises when the touches lift. Task success depends more on this path
than on the final place. Without these rules, a hand that arrives knocks a box over before it can
grasp it (measured with the simulated user).

The *lift control*, moved by the other hand, raises the hand along the surface's normal. A slider is
never quite still: noise of 3 % of 18 cm would shake a held box by millimetres, sixty times a
second. The slider's value is therefore smoothed.

The *rate limit* bounds the speed of the commanded pose.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import atan2, cos, expm1, inf, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array, distance
from models.pose import ROOT_ROTATION
from models.rotations import turned_about_normal, unwrapped

_LEAST_TURN = 1e-12
"""Angle (rad) below which a hand has not turned."""


class Motion(NamedTuple):
    """Common motion of the touches since the previous frame."""

    carried: tuple[float, float]
    """Movement (m) of the touches' mean on the surface (y down)."""
    turn: float
    """Rotation (rad) of the touches about their mean, counterclockwise on the screen."""
    about: tuple[float, float]
    """Mean (m) of the touches in the previous frame, on the surface."""


STILL = Motion((0.0, 0.0), 0.0, (0.0, 0.0))
"""Motion without touches."""


def rigid_motion(before: ArrayLike, after: ArrayLike) -> Motion:
    """The best-fitting rigid motion from touches (n, 2) m to the same touches later.

    Touches that are NaN before or after are left out. With fewer than two touches, the turn is 0.
    """
    before, after = np.asarray(before, float), np.asarray(after, float)
    both = np.isfinite(before).all(axis=1) & np.isfinite(after).all(axis=1)
    if not both.any():
        return STILL
    a, b = before[both], after[both]
    middle, later = a.mean(axis=0), b.mean(axis=0)
    (ax, ay), (bx, by) = (a - middle).T, (b - later).T
    # The surface's y points down, so the turn on the screen has the other sign.
    turn = -atan2(np.sum(ax * by - ay * bx), np.sum(ax * bx + ay * by))
    (x, y), (right, down) = middle.tolist(), (later - middle).tolist()
    return Motion((right, down), float(turn), (x, y))


def common_motion(before: Sequence[Sequence[float]], after: Sequence[Sequence[float]]) -> Motion:
    """As `rigid_motion`, for a few touches [(x, y), ..] m without NaN, in plain floats."""
    if not before:
        return STILL
    n = len(before)
    mx = my = lx = ly = across = along = 0.0
    for (ax, ay), (bx, by) in zip(before, after, strict=True):
        mx, my, lx, ly = mx + ax, my + ay, lx + bx, ly + by
    mx, my, lx, ly = mx / n, my / n, lx / n, ly / n
    for (ax, ay), (bx, by) in zip(before, after, strict=True):
        ax, ay, bx, by = ax - mx, ay - my, bx - lx, by - ly
        across += ax * by - ay * bx
        along += ax * bx + ay * by
    # The surface's y points down, so the turn on the screen has the other sign.
    return Motion((lx - mx, ly - my), -atan2(across, along), (mx, my))


class PoseFilter:
    """A first-order low-pass of the hand's posture that is carried along with the touches.

    The common motion and turn of the touches pass at once, so the filter adds no lag to a dragged
    or turned hand. Changes of posture are delayed by `tau`, for example when a contact comes or
    goes. The filter runs before the fingertip correction, which makes the tips exact again.

    Args:
        tau: Time constant (s); 0 switches the filter off.
    """

    def __init__(self, tau: float) -> None:
        self.tau = tau
        self._state: Array | None = None

    def reset(self) -> None:
        """Returns to the initial state; the next pose passes unchanged."""
        self._state = None

    def step(
        self,
        q: ArrayLike,
        carried: Sequence[float],
        dt: float,
        turn: float = 0.0,
        about: Sequence[float] = (0.0, 0.0),
    ) -> Array:
        """Smoothed pose (48,).

        Args:
            q: (48,) encoder's pose in the 3-D surface frame.
            carried: Motion (m) of the touches since the last step, on the surface (y down).
            dt: Time (s) since the last step.
            turn: Rotation (rad) of the touches since the last step, counterclockwise on the screen.
            about: Middle (m) of the touches before this motion, on the surface.
        """
        q = np.array(q, float)
        if self._state is None or self.tau <= 0:
            self._state = q
            return q.copy()
        state = self._state
        x, y = state[:2].tolist()
        along, down = carried
        if abs(turn) > _LEAST_TURN:
            c, s = cos(turn), sin(turn)
            left, up = about[0], -about[1]
            x, y = left + c * (x - left) - s * (y - up), up + s * (x - left) + c * (y - up)
            state[ROOT_ROTATION] = turned_about_normal(state[ROOT_ROTATION], turn)
        state[0], state[1] = x + along, y - down
        root = q[ROOT_ROTATION]
        near = unwrapped(root, state[ROOT_ROTATION])
        if near is not root:
            root[:] = near
        self._state = state + -expm1(-dt / self.tau) * (q - state)
        return self._state.copy()


_EARLY = 1e-9
"""Tolerance (s) for times of control steps, which are rounded sums of periods."""

_Places = Mapping[int, tuple[float, float]]
"""(x, y) m on the surface by contact."""


class Phase(StrEnum):
    """Phase of a hand's arrival."""

    AWAY = "away"
    """No contact: the hand holds its pose up in the air."""
    WAITING = "waiting"
    """Contacts have come, and their labels are not decided yet."""
    ABOVE = "above"
    """The hand moves to its place, still up."""
    COMING_DOWN = "coming down"
    DOWN = "down"


@dataclass(frozen=True)
class ArrivalSettings:
    """Settings of arrival and departure.

    Attributes:
        hover: Height (m) above its place at which the hand waits; 0 switches arrival and departure
            off.
        settle: Time (s) for which the set of contacts must be unchanged before it is labelled.
        dwell: Time (s) for which the touches must rest before the hand comes down.
        rest: Speed (m/s) below which touches count as resting. Touches also rest if, over `dwell`,
            none has moved farther than this speed allows. (Noise of a screen is fast from step to
            step, but does not move a touch away.)
        patience: Time (s) after which the hand comes down although the touches do not rest.
        place: Distance (m) from its place within which the hand comes down.
        down: Speed (m/s) of the hand on its way down.
        up: Speed (m/s) of the hand on its way up.
    """

    hover: float = 0.09
    settle: float = 0.10
    dwell: float = 0.10
    rest: float = 0.05
    patience: float = 1.0
    place: float = 0.006
    down: float = 0.40
    up: float = 0.60


class Arrival:
    """Computes the height of a hand above its place, step by step."""

    def __init__(self, settings: ArrivalSettings) -> None:
        self.settings = settings
        self.reset()

    def reset(self) -> None:
        """Returns to the initial state, in the air."""
        self.phase = Phase.AWAY if self.settings.hover > 0 else Phase.DOWN
        self.height = self.settings.hover
        self._still = 0.0
        self._waited = 0.0

    def step(
        self,
        dt: float,
        *,
        touched: bool,
        named: bool,
        speed: float,
        off: float,
        moved: float = inf,
    ) -> None:
        """Advances by one time step.

        Args:
            dt: Length of the step (s).
            touched: True if there is a contact; for a hand that is down, only labelled contacts
                count.
            named: True if all contacts have labels. A hand that is down, or comes down, is not
                lifted by a new contact without a label.
            speed: Speed (m/s) of the fastest contact.
            off: Distance (m) of the hand from its place, seen along the surface's normal.
            moved: Largest distance (m) of a contact from its place `dwell` seconds ago; infinite if
                no contact is as old as this.
        """
        s = self.settings
        if s.hover <= 0:
            self.phase = Phase.DOWN if touched and named else Phase.AWAY
            return
        low = self.phase in (Phase.COMING_DOWN, Phase.DOWN)
        if not touched:
            self.phase = Phase.AWAY
        elif not named and not low:
            self.phase = Phase.WAITING
        elif self.phase in (Phase.AWAY, Phase.WAITING):
            self.phase, self._still, self._waited = Phase.ABOVE, 0.0, 0.0
        if self.phase is Phase.ABOVE:
            self._waited += dt
            self._still = self._still + dt if speed < s.rest else 0.0
            stayed = self._waited >= s.dwell and moved < s.rest * s.dwell
            ready = self._still >= s.dwell or stayed or self._waited >= s.patience
            if ready and off <= s.place:
                self.phase = Phase.COMING_DOWN
        if self.phase is Phase.COMING_DOWN:
            self.height = max(self.height - s.down * dt, 0.0)
            if self.height == 0.0:
                self.phase = Phase.DOWN
        elif self.phase is not Phase.DOWN:
            self.height = min(self.height + s.up * dt, s.hover)


class RecentPlaces:
    """Remembers the places of contacts for a short time.

    Args:
        span: Time (s) for which places are remembered.
    """

    def __init__(self, span: float) -> None:
        self._span = span
        self._before: deque[tuple[float, _Places]] = deque()

    def reset(self) -> None:
        """Forgets all places."""
        self._before.clear()

    def step(self, time: float, places: _Places) -> None:
        """Adds the places of a control step.

        Args:
            time: Time (s) of the step, which never runs backwards.
            places: Current places of the contacts.
        """
        before = self._before
        before.append((time, places))
        while len(before) > 1 and before[1][0] <= time - self._span + _EARLY:
            before.popleft()

    @property
    def moved(self) -> float:
        """Largest distance (m) of a contact from its place `span` seconds ago; infinite if no
        contact is as old as this."""
        (then, first), (time, places) = self._before[0], self._before[-1]
        known = places.keys() & first.keys()
        if then > time - self._span + _EARLY or not known:
            return inf
        return max(distance(first[i], places[i]) for i in known)


@dataclass(frozen=True)
class LiftSettings:
    """Settings of the lift control.

    Attributes:
        reach: Distance (m) by which the hand rises at control 1; 0 for hands that are not lifted.
        tau: Time constant (s) of the low-pass.
        speed: Largest speed (m/s) of the hand.
    """

    reach: float = 0.0
    tau: float = 0.12
    speed: float = 0.30


class Lift:
    """Computes the height of a hand from the lift control, step by step.

    Attributes:
        height: Height (m) of the hand along the surface's normal.
    """

    def __init__(self, settings: LiftSettings) -> None:
        self.settings = settings
        self.reset()

    def reset(self) -> None:
        """Returns to the initial state, down."""
        self.height = 0.0
        self._smooth = 0.0

    def step(self, control: float | None, dt: float) -> None:
        """Advances by one time step.

        Args:
            control: 0 to 1; None counts as 0, so that devices without a lift control keep the hand
                down.
            dt: Length of the step (s).
        """
        s = self.settings
        wanted = s.reach * (control or 0.0)
        if wanted == self._smooth == self.height == 0.0:
            return
        self._smooth += (wanted - self._smooth) * -expm1(-dt / s.tau)
        most = s.speed * dt
        self.height += min(max(self._smooth - self.height, -most), most)


@dataclass(frozen=True)
class RateLimit:
    """Speed limits of a commanded pose, against jumps of the input.

    Attributes:
        linear: Speed (m/s) of the root.
        angular: Speed (rad/s) of the root and of every ball joint.
    """

    linear: float = 1.0
    angular: float = 12.0

    def or_faster(self, other: RateLimit) -> RateLimit:
        """Limits with the higher linear and the higher angular speed of both."""
        return RateLimit(max(self.linear, other.linear), max(self.angular, other.angular))

    def __call__(self, previous: Array, target: Array, dt: float) -> Array:
        """Pose (48,) on the way from `previous` to `target`, as far as `dt` (s) allows.

        All components are slowed by the same factor, so that the fingers stay in step with the
        wrist.
        """
        if dt <= 0:
            return previous
        goal = target.copy()
        turn = target[ROOT_ROTATION]
        near = unwrapped(turn, previous[ROOT_ROTATION])
        if near is not turn:
            goal[ROOT_ROTATION] = near
        if self.linear == self.angular == inf:
            return goal
        step = goal - previous
        squares = step * step
        # Recorded sessions depend on the order in which the squares are added: do not change it.
        linear, *angular = (squares[::3] + squares[2::3] + squares[1::3]).tolist()
        share = sqrt(max(linear / self.linear**2, max(angular) / self.angular**2)) / dt
        return previous + step / share if share > 1.0 else goal


GENTLE = RateLimit(0.6, 7.0)
"""Speed limits of hands that are not stronger than the profile `safe`. With the default limits of
`RateLimit`, a fingertip may meet an object at 1.6 m/s, which is 3 mm in one physics step. Hands of
30 N and of 6000 N are equally fast (measured at db485e42)."""
