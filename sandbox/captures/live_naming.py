"""Names touches live during a recording under a camera."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from encoders.captures.overhead.naming import MOST, Belief, NamingRules, chosen
from encoders.captures.overhead.picture_track import LAST_JOINTS, TIPS
from encoders.captures.overhead.tablet_plane import (
    Moment,
    TabletPlane,
    mirrored_plane,
    plane_of_corners,
    plane_of_touches,
)
from models.arithmetic import Array
from models.errors import CaptureError, InputError
from models.frames import FINGERS, LandmarkFrame, TouchFrame
from models.surface import Surface
from sandbox.devices.device import Closeable

KEPT = 2.0
"""Time for which touches are stored, for pictures that arrive late, s."""
_LONGEST = 0.25
"""Largest time for which a single picture counts as evidence, s."""
_RESTS = 0.1
"""Time between two touch frames, s. After a longer time, fingers are assumed to have rested in
between."""
_UNKNOWN = np.full(len(FINGERS), np.nan)


def hand_in(frame: LandmarkFrame, side: str) -> Array | None:
    """Returns the landmarks (21, 2) of the hand of a side, px; None without one.

    If there is a single hand, it is accepted even if it has the other side, since the engine may
    mistake the side. A left hand is mirrored.
    """
    own = [h for h in frame.hands if h.side == side]
    hands = own or (list(frame.hands) if len(frame.hands) == 1 else [])
    if not hands:
        return None
    image = np.array(max(hands, key=lambda h: h.score).image)
    return image * [-1.0, 1.0] + [float(frame.size[0]), 0.0] if side == "left" else image


class ArrivalClock:
    """Converts a device's times to the host's clock.

    The offset comes from the message with the smallest delay, since no delay is negative.
    """

    def __init__(self) -> None:
        self._least = np.inf

    def host(self, device: float, stamp: float, arrived: float) -> float:
        """Converts a time on the device's clock to the host's clock, s.

        Args:
            device: The time, s.
            stamp: Time at which the message was sent, on the same clock, s.
            arrived: Time at which it arrived, on the host's clock, s.
        """
        self._least = min(self._least, arrived - stamp)
        return device + self._least


@dataclass(frozen=True)
class LiveName:
    """A name of a contact.

    Attributes:
        id: The device's id of the contact.
        finger: Thumb 0 to little 4.
        share: Probability of the name.
        since: Time from the arrival of the touch-down to the arrival of the picture, s.
    """

    id: int
    finger: int
    share: float
    since: float


class TouchHistory:
    """The last seconds of touches, for pictures that arrive late."""

    def __init__(self) -> None:
        self._frames: deque[tuple[float, dict[int, tuple[float, float]]]] = deque()

    def add(self, frame: TouchFrame, arrived: float) -> None:
        """Adds touches that arrived at a time on the host's clock, s."""
        self._frames.append((arrived, {c.id: (c.x, c.y) for c in frame.contacts}))
        while len(self._frames) > 2 and self._frames[1][0] < arrived - KEPT:
            self._frames.popleft()

    def at(self, time: float) -> dict[int, Array]:
        """Returns the places (2,) of the contacts that were down at a time, by id, m."""
        before: tuple[float, dict[int, tuple[float, float]]] | None = None
        for entry in self._frames:
            if entry[0] > time:
                if before is None:
                    return {}
                span = entry[0] - before[0]
                # If a device sends nothing for a long time, the fingers rest.
                share = (time - before[0]) / max(span, 1e-9) if span < _RESTS else 0.0
                return {
                    i: np.array(p) + share * (np.array(entry[1].get(i, p)) - np.array(p))
                    for i, p in before[1].items()
                }
            before = entry
        return {} if before is None else {i: np.array(p) for i, p in before[1].items()}


class LiveNames:
    """Names touches by a camera's pictures during a recording.

    Args:
        plane: The surface in the picture; for a left hand, both are mirrored.
        side: `right` or `left`.
        offset: Delay of pictures relative to touches, s.
        rules: Rules that turn a picture into probabilities of names.

    Attributes:
        names: Fingers of the named contacts that are down, by the device's ids.
        plane: The surface in the picture; may be changed.
    """

    def __init__(
        self,
        plane: TabletPlane,
        side: str,
        offset: float = 0.0,
        rules: NamingRules | None = None,
    ) -> None:
        self.names: dict[int, int] = {}
        self.plane = plane
        self._side, self._offset = side, offset
        self._rules = rules or NamingRules()
        self._belief = Belief(self._rules)
        self._touches = TouchHistory()
        self._landed: dict[int, float] = {}
        self._last: float | None = None

    def touch(self, frame: TouchFrame, arrived: float) -> None:
        """Adds touches.

        Args:
            frame: The frame; x of a left hand is already mirrored.
            arrived: Time of arrival on the host's clock, s.
        """
        self._touches.add(frame, arrived)
        down = [c.id for c in frame.contacts]
        self._landed = {i: self._landed.get(i, arrived) for i in down}
        self.names = {i: f for i, f in self.names.items() if i in down}

    def picture(self, frame: LandmarkFrame, taken: float, arrived: float) -> list[LiveName]:
        """Adds a picture; returns the new names.

        Args:
            frame: The picture.
            taken: Time at which the picture was taken, on the host's clock, s.
            arrived: Time of arrival on the host's clock, s.
        """
        pads = self._pads(frame)
        off: dict[int, Array] = {}
        for id_, place in self._touches.at(taken - self._offset).items():
            off[id_] = _UNKNOWN if pads is None else np.linalg.norm(pads - place, axis=1)
        since = _LONGEST if self._last is None else min(max(taken - self._last, 0.0), _LONGEST)
        self._last = taken
        self._belief.update(off, since)
        given = []
        for id_, share in self._belief.names().items():
            finger = chosen(share, self._rules)
            near = finger is not None and off[id_][finger] <= 2.0 * self._rules.reach
            if finger is None or not near or id_ not in self._landed:
                continue
            if self.names.get(id_) != finger:
                waited = arrived - self._landed[id_]
                given.append(LiveName(id_, finger, float(share[finger]), waited))
            self.names[id_] = finger
        return given

    def _pads(self, frame: LandmarkFrame) -> Array | None:
        """Returns the places (5, 2) where the fingers would touch, m; None without the hand."""
        image = hand_in(frame, self._side)
        if image is None:
            return None
        return self.plane.pads(image[list(TIPS)], image[list(LAST_JOINTS)])


USUAL_DELAY = 0.05
"""Assumed delay of pictures relative to touches during a recording, s."""
_ENOUGH, _MOST, _AGAIN = 40, 300, 100
"""Numbers of observations: before the first search for the surface; the largest number used in a
search; and between two searches."""


class LiveNaming(Closeable):
    """Finds the surface in the picture while a person touches, and then names touches.

    Args:
        surface: The touch surface.
        side: `right` or `left`.

    Attributes:
        touches: Number of touches since the surface was found.
        named: Number of these touches that got a name.
    """

    def __init__(self, surface: Surface, side: str) -> None:
        self.touches = self.named = 0
        self._surface, self._side = surface, side
        self._clock, self._history = ArrivalClock(), TouchHistory()
        self._moments: list[Moment] = []
        self._next = _ENOUGH
        self._corners: TabletPlane | None = None
        self._marked: Sequence[tuple[float, float]] = ()
        self._search: Future[TabletPlane] | None = None
        self._worker = ThreadPoolExecutor(1, "surface")
        self._live: LiveNames | None = None
        self._seen: set[int] = set()
        self._with_name: set[int] = set()
        self._trouble = ""

    @property
    def text(self) -> str:
        """Returns a line about the state of the naming."""
        if self._live is None:
            return self._trouble or "the camera looks for the tablet: touch with several fingers"
        names = ", ".join(FINGERS[f] for f in sorted(self._live.names.values()))
        return f"the camera names {self.named} of {self.touches} touches; now: {names or 'none'}"

    def corners(self, corners: Sequence[tuple[float, float]], width: int) -> None:
        """Sets the corners that the person marked.

        Args:
            corners: (x, y) of the corners in the picture, px.
            width: Width of the picture, px.
        """
        if not corners or corners == self._marked:
            return
        self._marked = corners
        try:
            self._corners = plane_of_corners(np.array(corners), self._surface.size)
        except InputError as error:
            self._trouble = error.what
            return
        if self._side == "left":
            self._corners = mirrored_plane(self._corners, width)
        self._next = len(self._moments)

    def touch(self, frame: TouchFrame, now: float) -> None:
        """Adds touches that arrived at `now`, s."""
        frame = _mirrored(frame) if self._side == "left" else frame
        self._history.add(frame, now)
        if self._live is not None:
            self._live.touch(frame, now)
            self._seen.update(c.id for c in frame.contacts)
            self.touches = len(self._seen)

    def picture(self, frame: LandmarkFrame, now: float) -> None:
        """Adds a picture that arrived at `now`, s."""
        taken = self._clock.host(frame.taken, frame.time, now)
        if self._live is not None:
            self._with_name.update(name.id for name in self._live.picture(frame, taken, now))
            self.named = len(self._with_name & self._seen)
        image = hand_in(frame, self._side)
        places = list(self._history.at(taken - USUAL_DELAY).values())[:MOST]
        if image is not None and len(places) >= 2:
            touched = np.array(places)
            self._moments.append(Moment(image[list(TIPS)], image[list(LAST_JOINTS)], touched))
            self._moments = self._moments[-_MOST:]
            self._next -= 1
        self._search_surface()

    def _search_surface(self) -> None:
        """Searches for the surface in another thread, so that the recording need not wait."""
        if self._search is None and self._next <= 0 and len(self._moments) >= _ENOUGH // 2:
            self._next = _AGAIN
            moments, corners = tuple(self._moments), self._corners
            self._search = self._worker.submit(plane_of_touches, moments, corners)
        if self._search is None or not self._search.done():
            return
        search, self._search = self._search, None
        try:
            plane = search.result()
        except CaptureError as error:
            self._trouble = f"{error.what}. {error.remedy}" if error.remedy else error.what
            return
        self._trouble = ""
        if self._live is None:
            self._live = LiveNames(plane, self._side, USUAL_DELAY)
        else:
            self._live.plane = plane

    def close(self) -> None:
        """Ends the search."""
        self._worker.shutdown(wait=False, cancel_futures=True)


def _mirrored(frame: TouchFrame) -> TouchFrame:
    return replace(frame, contacts=tuple(replace(c, x=-c.x) for c in frame.contacts))
