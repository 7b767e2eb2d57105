"""A headset as a hand device: its page sends the joints of both hands, or controllers."""

from __future__ import annotations

import threading
import time
from collections import Counter, deque
from collections.abc import Sequence

from encoders.air.joint_fit import seen_size
from models.errors import FrameError
from models.frames import FINGERS, HandFrame, TrackedHand
from models.plausible import (
    JUMPED,
    ON_ANOTHER,
    HandJumps,
    LiveUnits,
    SideDoubt,
    lie_on,
    unit_size,
)
from models.reader_report import ReaderReport
from models.skeleton import ADULT
from sandbox.devices.device import HandDevice
from sandbox.devices.webxr.joints import held_hand, quantities, seen_hand, with_possible_fingers
from sandbox.server.protocol import HeldController, PageHands, PageScreen, PageTouches, SeenJoints
from sandbox.server.web import PageDevice

KEPT = 1024
"""Largest number of frames that wait for the session, 11 s at 90 Hz; if there are more, the oldest
are dropped."""


_PALM = 0.1
"""Approximate size of a palm (m)."""


class HeadsetDevice(HandDevice, PageDevice[HandFrame]):
    """Hands or controllers in a headset, sent by a page that enters VR and draws the table.

    The page places the table in the room, and sends positions in the world frame of the table.

    Attributes:
        counts: Number of hands that could not be used, by reason.
    """

    name = "webxr"
    frame_ready: threading.Event

    def __init__(self) -> None:
        super().__init__()
        self.counts: Counter[str] = Counter()
        self._seen = False
        self._sizes: deque[float] = deque(maxlen=KEPT)
        self._units = LiveUnits({"length": "m"})
        self._jumps, self._held, self._side = HandJumps(), HandJumps(), SideDoubt()

    @property
    def touched(self) -> bool:
        """True while a hand is in view."""
        with self._lock:
            return self._seen

    @property
    def hand_size(self) -> float | None:
        """Length of the person's hand relative to an average hand, from the bones that the headset
        reports; None before a hand was seen."""
        sizes = sorted(self._sizes)
        return sizes[len(sizes) // 2] if sizes else None

    def receive(self, message: PageTouches | PageHands, screen: PageScreen) -> bool:
        """Processes a message with hands; called in the server's thread.

        Returns False for other messages.
        """
        if not isinstance(message, PageHands):
            return False
        hands: dict[str, TrackedHand] = {}
        held: set[str] = set()
        everything: list[SeenJoints | HeldController] = [*message.hands, *message.controllers]
        for told in everything:
            try:
                hand = held_hand(told) if isinstance(told, HeldController) else self._hand(told)
            except FrameError as error:
                self.counts[error.what] += 1
                continue
            if hand is None:
                self.counts["hands without a palm"] += 1
            elif len(hand.fingers) < len(FINGERS):
                self.counts["hands without a finger"] += 1
            if hand is None:
                continue
            if told.side in hands:
                self.counts["further hands of the same side"] += 1
                continue
            if any(lie_on([hand.palm], [other.palm], _PALM) for other in hands.values()):
                self.counts[ON_ANOTHER] += 1
                continue
            hands[told.side] = hand
            if isinstance(told, HeldController):
                held.add(told.side)
                continue
            if self._side.due():
                self._side.look_at(hand)
            size = seen_size(hand, ADULT)
            if size is not None:
                self._sizes.append(size)
        now = time.monotonic()
        places = {side: hand.palm for side, hand in hands.items()}
        jumped = self._jumps.find(now, {s: place for s, place in places.items() if s not in held})
        # Controllers are checked separately: one that lies on the table does not move.
        jumped |= self._held.find(now, {s: place for s, place in places.items() if s in held})
        if jumped:
            self.counts[JUMPED] += len(jumped)
        seen = tuple(hand for side, hand in hands.items() if side not in jumped)
        self._put_hands(seen, message.seq)
        return True

    def _hand(self, seen: SeenJoints) -> TrackedHand | None:
        if not self._units.decided:
            self._units.look(quantities(seen))
            if self._units.decided:
                # Later positions may be in another unit: do not compare them with earlier ones.
                self._jumps.forget()
        hand = seen_hand(seen, unit_size(self._units.units, "length"))
        return with_possible_fingers(hand) if hand and self._units.decided else hand

    @property
    def report(self) -> ReaderReport:
        """Report on hands that could not be used so far, and on assumptions."""
        report = ReaderReport(+self.counts)
        for sentence in (*self.notices, *filter(None, (self._jumps.doubt,))):
            report.assume(sentence)
        return report

    @property
    def notices(self) -> Sequence[str]:
        """Messages about an assumed unit other than metres, and about doubtful sides of hands."""
        return tuple(filter(None, (self._units.notice, self._side.sentence)))

    def cancel_all(self) -> None:
        """Called when the page was closed or has become silent: no hand is in view."""
        if self.touched:
            self._put_hands((), self.applied)

    def poll(self, now: float = 0.0) -> Sequence[HandFrame]:
        """Returns all frames since the last call, oldest first; `now` is ignored."""
        return self._take()

    def _put_hands(self, hands: tuple[TrackedHand, ...], seq: int) -> None:
        with self._lock:
            self._seen = bool(hands)
            self._put(HandFrame(time.monotonic(), hands, self.name), seq)
