"""Names of touches while they are recorded under a camera, as far as they are known."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from encoders.captures.overhead.live_names import (
    ArrivalClock,
    LiveNames,
    TouchHistory,
    hand_in,
)
from encoders.captures.overhead.names import MOST
from encoders.captures.overhead.picture_track import LAST_JOINTS, TIPS
from encoders.captures.overhead.tablet_plane import (
    Moment,
    TabletPlane,
    mirrored_plane,
    plane_of_corners,
    plane_of_touches,
)
from models.errors import CaptureError, InputError
from models.frames import FINGERS, LandmarkFrame, TouchFrame
from models.surface import Surface
from sandbox.devices.device import Closeable

USUAL_DELAY = 0.05
"""s by which pictures are usually later than touches, until a recording is complete."""
_ENOUGH, _MOST, _AGAIN = 40, 300, 100
"""Looks at touches before a search for the surface, kept for it, and before the next search."""


class LiveNaming(Closeable):
    """Finds the surface in the picture while a person touches, and then names touches.

    Args:
        surface: The touch surface.
        side: `right` or `left`.

    Attributes:
        touches, named: Numbers of touches since the surface was found, and of those with a name.
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
        """One line about what is known."""
        if self._live is None:
            return self._trouble or "the camera looks for the tablet: touch with several fingers"
        names = ", ".join(FINGERS[f] for f in sorted(self._live.names.values()))
        return f"the camera names {self.named} of {self.touches} touches; now: {names or 'none'}"

    def corners(self, corners: Sequence[tuple[float, float]], width: int) -> None:
        """Takes in corners that the person marked, px in a picture of a width."""
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
        """Takes in touches that arrived at `now`, s."""
        frame = _mirrored(frame) if self._side == "left" else frame
        self._history.add(frame, now)
        if self._live is not None:
            self._live.touch(frame, now)
            self._seen.update(c.id for c in frame.contacts)
            self.touches = len(self._seen)

    def picture(self, frame: LandmarkFrame, now: float) -> None:
        """Takes in a picture that arrived at `now`, s."""
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
        """Looks for the surface beside the recording, which must not wait."""
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
