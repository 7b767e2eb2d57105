"""What a page's server asks of a device that a page is: it hears the player's messages."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod

from sandbox.server.protocol.protocol import PageHands, PageScreen, PageTouches
from sandbox.trial.latency import LatencyLog


class PageDevice(ABC):
    """A device whose input comes from a page; `hear` is called in the server's thread.

    Attributes:
        latency: Log of the time that messages waited for the session; a server sets its own.
        frame_ready: Event that is set when a message has arrived.
        applied: Sequence number of the newest message that the session has processed.
    """

    latency: LatencyLog
    frame_ready: threading.Event
    applied: int

    @property
    @abstractmethod
    def touched(self) -> bool:
        """True while the person plays: a finger is down, or a hand is seen."""

    @abstractmethod
    def hear(self, message: PageTouches | PageHands, screen: PageScreen) -> bool:
        """Takes in a message; False if it is none for this device."""

    @abstractmethod
    def begin_page(self) -> None:
        """A page begins to send: its messages are counted anew."""

    @abstractmethod
    def cancel_all(self) -> None:
        """The page was closed or fell silent: nothing is touched or seen any more."""
