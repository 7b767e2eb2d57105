"""A headset as a hand device: its page sends the joints of both hands, or controllers."""

from __future__ import annotations

import threading
import time
from collections import Counter, deque
from collections.abc import Sequence

from encoders.headset.joint_points import seen_size
from models.errors import FrameError
from models.frames import FINGERS, HandFrame, TrackedHand
from models.skeleton import ADULT
from sandbox.devices.device import HandDevice
from sandbox.devices.webxr.joints import held_hand, seen_hand
from sandbox.server.protocol import HeldController, PageHands, PageScreen, PageTouches, SeenJoints
from sandbox.server.web import PageDevice
from sandbox.trial.latency import LatencyLog

KEPT = 1024
"""Largest number of frames that wait for the session, 11 s at 90 Hz; beyond it the oldest are
dropped."""


class HeadsetDevice(HandDevice, PageDevice[HandFrame]):
    """Hands in a headset, or controllers: a page that enters VR draws the table and sends them.

    The page lays the table into the room, and sends places in the world of the table.

    Args:
        latency: See `PageDevice`.

    Attributes:
        counts: Number of hands that could not be used, by reason.
    """

    name = "webxr"
    latency: LatencyLog
    frame_ready: threading.Event

    def __init__(self, latency: LatencyLog | None = None) -> None:
        super().__init__(latency)
        self.counts: Counter[str] = Counter()
        self._seen = False
        self._sizes: deque[float] = deque(maxlen=KEPT)

    @property
    def touched(self) -> bool:
        """True while a hand is seen."""
        with self._lock:
            return self._seen

    @property
    def hand_size(self) -> float | None:
        """Length of the person's hand relative to the average one, by the bones that the headset
        reports; None before a hand was seen."""
        sizes = sorted(self._sizes)
        return sizes[len(sizes) // 2] if sizes else None

    def receive(self, message: PageTouches | PageHands, screen: PageScreen) -> bool:
        """Takes in hands; called from the server's thread."""
        if not isinstance(message, PageHands):
            return False
        hands: dict[str, TrackedHand] = {}
        everything: list[SeenJoints | HeldController] = [*message.hands, *message.controllers]
        for told in everything:
            try:
                hand = held_hand(told) if isinstance(told, HeldController) else seen_hand(told)
            except FrameError as error:
                self.counts[error.what] += 1
                continue
            if hand is None:
                self.counts["hands without a palm"] += 1
            elif len(hand.fingers) < len(FINGERS):
                self.counts["hands without a finger"] += 1
            if hand is None:
                continue
            hands.setdefault(told.side, hand)
            size = seen_size(hand, ADULT)
            if isinstance(told, SeenJoints) and size is not None:
                self._sizes.append(size)
        self._put_hands(tuple(hands.values()), message.seq)
        return True

    def cancel_all(self) -> None:
        """The page was closed or fell silent: no hand is seen."""
        if self.touched:
            self._put_hands((), self.applied)

    def poll(self, now: float = 0.0) -> Sequence[HandFrame]:
        """Every frame since the last call, oldest first; `now` is ignored."""
        return self._take()

    def _put_hands(self, hands: tuple[TrackedHand, ...], seq: int) -> None:
        now = time.monotonic()
        with self._lock:
            self._seen = bool(hands)
            self._put(HandFrame(now, hands, self.name), seq, now)
