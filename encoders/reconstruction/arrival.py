"""Height of a hand over its place: arrival, departure, and the lift control.

The hand hovers as a ghost over its place, comes down from above once it is there and the touches
rest, and rises when they leave. Task success depends more on this path of the hand than on its
final place (measured with the simulated user: without these rules, a box is knocked over before it
is touched).

The lift control, moved by the other hand, raises the hand along the surface's normal. A slider is
never quite still: 3 % of 18 cm would shake a held box by millimetres, sixty times a second, so its
value is smoothed.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import expm1, inf

from models.arithmetic.products import distance

_EARLY = 1e-9
"""s, by which a control step may be early: times are sums of periods."""

_Places = Mapping[int, tuple[float, float]]
"""(x, y) m on the surface by contact."""


class Phase(StrEnum):
    """Phase of a hand's arrival."""

    AWAY = "away"
    """No contact: the hand holds its pose up in the air."""
    WAITING = "waiting"
    """Contacts have come, and their fingers are not decided yet."""
    ABOVE = "above"
    """The hand moves to its place, still up."""
    COMING_DOWN = "coming down"
    DOWN = "down"


@dataclass(frozen=True)
class ArrivalSettings:
    """Settings of arrival and departure.

    Attributes:
        hover: m above its place at which the hand waits; 0 switches these rules off.
        settle: s for which the set of contacts must be unchanged before fingers are named.
        dwell: s for which the touches must rest before the hand comes down.
        rest: m/s below which touches count as resting. They also rest while each stays, for `dwell`
            s, within as far as it comes at this speed: noise of a screen is quick from step to
            step, and goes nowhere.
        patience: s after which the hand comes down although the touches do not rest.
        place: m, how near to its place the hand must be to come down.
        down: m/s of the hand on its way down.
        up: m/s of the hand on its way up.
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
            dt: s, length of the step.
            touched: True if there is a contact; for a hand that is down, one whose finger is known.
            named: True if the fingers of all contacts are known. A contact that comes while the
                hand is down may be unlabelled for a while without lifting the hand.
            speed: m/s of the fastest contact.
            off: m, distance of the hand from its place, seen along the surface's normal.
            moved: m, farthest that a contact is from where it was `dwell` s ago; infinite where
                none is known that long.
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
    """Remembers where contacts were, a moment long.

    Args:
        span: s, the moment.
    """

    def __init__(self, span: float) -> None:
        self._span = span
        self._before: deque[tuple[float, _Places]] = deque()

    def reset(self) -> None:
        """Forgets."""
        self._before.clear()

    def step(self, time: float, places: _Places) -> None:
        """Adds the places of a control step.

        Args:
            time: s, which never runs backwards.
            places: Where the contacts are now.
        """
        before = self._before
        before.append((time, places))
        while len(before) > 1 and before[1][0] <= time - self._span + _EARLY:
            before.popleft()

    @property
    def moved(self) -> float:
        """Farthest, m, that a contact is from where it was a moment ago; infinite where none is
        known that long."""
        (then, first), (time, places) = self._before[0], self._before[-1]
        known = places.keys() & first.keys()
        if then > time - self._span + _EARLY or not known:
            return inf
        return max(distance(first[i], places[i]) for i in known)


@dataclass(frozen=True)
class LiftSettings:
    """Settings of the lift control.

    Attributes:
        reach: m by which the hand rises at control 1; 0 for hands that are not lifted.
        tau: s, time constant of the low pass.
        speed: m/s, maximum speed.
    """

    reach: float = 0.0
    tau: float = 0.12
    speed: float = 0.30


class Lift:
    """Computes the height of a hand from the lift control, step by step.

    Attributes:
        height: m along the surface's normal.
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
            dt: s, length of the step.
        """
        s = self.settings
        wanted = s.reach * (control or 0.0)
        if wanted == self._smooth == self.height == 0.0:
            return
        self._smooth += (wanted - self._smooth) * -expm1(-dt / s.tau)
        most = s.speed * dt
        self.height += min(max(self._smooth - self.height, -most), most)
