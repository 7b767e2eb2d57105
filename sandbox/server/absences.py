"""When simulated time stands still on pages: before the first touch, and while a player is away."""

from __future__ import annotations

import time
from collections.abc import Sequence

from sandbox.server.page_device import PageDevice
from sandbox.server.page_server import PageServer
from sandbox.server.protocol.protocol import Pause


class Absences:
    """Stops simulated time while a player cannot play, and lists for how long.

    Time begins with the first touch on any page. It stops as soon as a player's page is closed,
    hidden or silent, and goes on when that player is back and touches it, or touches it still. A
    goal that is held already needs nobody, so the trial is played to its end.

    Args:
        players: Server and device of every page whose touches count; empty stops nothing.
    """

    def __init__(self, players: Sequence[tuple[PageServer, PageDevice]]) -> None:
        self._players = tuple(players)
        self._begun = not players
        self._awaited: set[int] = set()
        self._since: tuple[float, float] | None = None
        self._ended: list[dict[str, float]] = []

    def check(self, time_s: float, held: bool) -> Pause:
        """Why simulated time must stand still now; empty if it may run.

        Args:
            time_s: s, simulated time.
            held: True if the goal has been held.
        """
        away = {i for i, (server, _) in enumerate(self._players) if server.away}
        touched = {i for i, (_, device) in enumerate(self._players) if device.touched} - away
        if not self._begun:
            self._begun = bool(touched)
            return "" if self._begun else "start"
        self._awaited = set() if held else (self._awaited | away) - touched
        if self._awaited and self._since is None:
            self._since = time_s, time.monotonic()
        elif not self._awaited:
            self._end()
        if not self._awaited:
            return ""
        return "away" if self._awaited & away else "back"

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
