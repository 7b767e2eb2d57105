"""When simulated time stands still on pages: before the first touch, and while a player is away.

Play and studies use this rule. `PageServer.away` says when one page is away.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

from sandbox.server.page_server import PageServer
from sandbox.server.protocol import Pause
from sandbox.server.web import PageDevice


class AutoPause:
    """Stops simulated time while a player cannot play, and lists for how long.

    Time begins with the first touch on any page. It stops as soon as a page is away, and goes on
    when that page is back and touched, or touched still. A goal that is held already needs nobody,
    so the trial is played to its end.

    Args:
        pages: Server and device of every page; a page without a device counts as touched while it
            is not away.
        begun: True if time runs before the first touch.
        stops: False if time goes on while a page is away.

    Attributes:
        begun: True once time has begun.
        away: Indices of the pages that were away at the last check.
    """

    def __init__(
        self,
        pages: Sequence[tuple[PageServer, PageDevice | None]],
        begun: bool = False,
        stops: bool = True,
    ) -> None:
        self._pages, self._stops = tuple(pages), stops
        self.begun = begun or not any(device for _, device in self._pages)
        self._awaits_touch = not self.begun
        self._awaited: set[int] = set()
        self._since: tuple[float, float] | None = None
        self._ended: list[dict[str, float]] = []
        self.away: set[int] = set()

    def check(self, time_s: float, held: bool, paused: bool = False) -> Pause:
        """Why simulated time must stand still now; empty if it may run.

        Args:
            time_s: s, simulated time.
            held: True if the goal has been held.
            paused: True during a pause by the experimenter, after which time goes on with the next
                touch on any page.
        """
        self.away = {i for i, (server, _) in enumerate(self._pages) if server.away}
        if self.begun and self._stops and not held:
            self._awaited |= self.away
        if paused:
            self._awaits_touch = True
            return "menu"
        devices = [device for _, device in self._pages]
        touched = {i for i, d in enumerate(devices) if d is None or d.touched} - self.away
        if self._awaits_touch and touched:
            self._awaits_touch, self.begun = False, True
        if not self.begun:
            return "start"
        self._awaited -= touched
        if held:
            self._awaited.clear()
        if self._awaited and self._since is None:
            self._since = time_s, time.monotonic()
        elif not self._awaited:
            self._end()
        if not (self._awaited or self._awaits_touch):
            return ""
        return "away" if self.away else "back"

    def listed(self) -> list[dict[str, float]]:
        """All absences: `at_s`, simulated time, and `lasted_s`, real time until the next touch."""
        self._end()
        return self._ended

    def _end(self) -> None:
        if self._since is None:
            return
        at, began = self._since
        self._since = None
        self._ended.append({"at_s": round(at, 3), "lasted_s": round(time.monotonic() - began, 3)})
