"""Names of touches while a person touches: a name comes with the first pictures after a landing."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from encoders.captures.overhead.names import Belief, NamingRules, chosen
from encoders.captures.overhead.picture_track import LAST_JOINTS, TIPS
from encoders.captures.overhead.tablet_plane import TabletPlane
from models.arithmetic import Array
from models.frames import FINGERS, LandmarkFrame, TouchFrame

KEPT = 2.0
"""s for which touches are kept, for pictures that arrive late."""
_LONGEST = 0.25
"""s for which one picture stands at most."""
_RESTS = 0.1
"""s between two frames of touches beyond which fingers rested in between."""
_UNKNOWN = np.full(len(FINGERS), np.nan)


def hand_in(frame: LandmarkFrame, side: str) -> Array | None:
    """(21, 2) px of the hand of a side, or of a single one of the other side, which the engine may
    have mistaken; None without one. A left hand is as a mirror shows it."""
    own = [h for h in frame.hands if h.side == side]
    hands = own or (list(frame.hands) if len(frame.hands) == 1 else [])
    if not hands:
        return None
    image = np.array(max(hands, key=lambda h: h.score).image)
    return image * [-1.0, 1.0] + [float(frame.size[0]), 0.0] if side == "left" else image


class ArrivalClock:
    """The host's time of a device's times, by the earliest arrival: what arrives cannot be late by
    less than nothing."""

    def __init__(self) -> None:
        self._least = np.inf

    def host(self, device: float, stamp: float, arrived: float) -> float:
        """Host time, s, of a moment on the device's clock.

        Args:
            device: s, the moment.
            stamp: s on the same clock, when the message was sent.
            arrived: s, when it arrived, on the host's clock.
        """
        self._least = min(self._least, arrived - stamp)
        return device + self._least


@dataclass(frozen=True)
class LiveName:
    """A name of a contact.

    Attributes:
        id: The device's id of the contact.
        finger: Thumb 0 to little 4.
        share: Its probability.
        since: s from the landing's arrival to that of the picture.
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
        """Takes in touches that arrived at a time, s on the host's clock."""
        self._frames.append((arrived, {c.id: (c.x, c.y) for c in frame.contacts}))
        while len(self._frames) > 2 and self._frames[1][0] < arrived - KEPT:
            self._frames.popleft()

    def at(self, time: float) -> dict[int, Array]:
        """Places (2,) m of the contacts that were down at a time, by their ids."""
        before: tuple[float, dict[int, tuple[float, float]]] | None = None
        for entry in self._frames:
            if entry[0] > time:
                if before is None:
                    return {}
                span = entry[0] - before[0]
                # A device that says nothing for long has fingers that rest.
                share = (time - before[0]) / max(span, 1e-9) if span < _RESTS else 0.0
                return {
                    i: np.array(p) + share * (np.array(entry[1].get(i, p)) - np.array(p))
                    for i, p in before[1].items()
                }
            before = entry
        return {} if before is None else {i: np.array(p) for i, p in before[1].items()}


class LiveNames:
    """Names touches by pictures, both as they arrive.

    Args:
        plane: The surface in the picture; of a left hand, both mirrored.
        side: `right` or `left`.
        offset: s by which pictures are later than touches.
        rules: What a look tells.

    Attributes:
        names: Fingers of the contacts that are down and have a name, by the device's ids.
        plane: The surface in the picture; may be set anew.
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
        """Takes in touches.

        Args:
            frame: The frame; x of a left hand is already mirrored.
            arrived: s on the host's clock.
        """
        self._touches.add(frame, arrived)
        down = [c.id for c in frame.contacts]
        self._landed = {i: self._landed.get(i, arrived) for i in down}
        self.names = {i: f for i, f in self.names.items() if i in down}

    def picture(self, frame: LandmarkFrame, taken: float, arrived: float) -> list[LiveName]:
        """Takes in a picture; returns the names that it gave.

        Args:
            frame: The picture.
            taken: s on the host's clock.
            arrived: s on the host's clock.
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
        """(5, 2) m, where fingers would touch; None without the hand."""
        image = hand_in(frame, self._side)
        if image is None:
            return None
        return self.plane.pads(image[list(TIPS)], image[list(LAST_JOINTS)])
