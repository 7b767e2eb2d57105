"""The live run of a trial: physics in its own thread at real time, the picture in the caller's.

Play and studies, in a window and on pages, all run a trial by `LiveRun.play`. Only what one turn
of the caller's thread does differs: a window draws a picture, a page's server looks at requests.

`Pace` and `RealTime` wait for the wall clock. When a trial is behind real time it slows down and
says so; it never skips steps.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from models.scene import CONTROL_PERIOD
from sandbox.session.messages import Snapshot
from sandbox.trial.driver import Trial

if TYPE_CHECKING:
    from sandbox.server.page_server import PageServer
    from sandbox.server.protocol import Pause
    from sandbox.session.session import Rig

TICK = 0.02
"""s between two turns of a run that draws no picture."""


class LiveRun:
    """Runs a trial in its own thread; a window or a page takes the newest snapshot.

    A frame of any device wakes the thread: the step that takes the frame in is made at once, up to
    one control period ahead of the clock.

    Args:
        trial: A trial that is ready for its first step. Its views are called in its thread.
        pages: Servers of the pages that show the trial. They show why time stands still, and the
            last snapshot.
        speed: Simulated seconds per second.

    Attributes:
        failure: The error that ended the thread early; None without one.
    """

    def __init__(self, trial: Trial, pages: Sequence[PageServer] = (), speed: float = 1.0) -> None:
        self._trial, self._pages = trial, tuple(pages)
        self._pace = Pace(speed, _shared_event(trial.session.rigs))
        self._stop = threading.Event()
        self._running = threading.Event()
        self._running.set()
        self._thread = threading.Thread(target=self._run, name="session", daemon=True)
        self.failure: BaseException | None = None

    def play(
        self,
        turn: Callable[[], Pause | None],
        end: Callable[[], None] | None = None,
        tick: float = TICK,
        lingers: bool = False,
    ) -> None:
        """Plays the trial until it is over, or until `turn` ends it.

        Args:
            turn: Called again and again in this thread, first before the first step. Returns why
                simulated time must stand still, empty if it may run, and None to end the run.
            end: Called once: as soon as the trial is over, or when it is left before, also by an
                exception.
            tick: s to sleep after a turn; 0 where a turn waits for the screen.
            lingers: True goes on after the trial is over, with its last picture, until `turn`
                returns None.

        Raises:
            BaseException: The error that ended the trial's thread: the trial was not played.
        """
        ending = [end] if end else []
        try:
            while not self.over or (lingers and not self.failure):
                pause = turn()
                if pause is None:
                    break
                self.pause(bool(pause))
                self.start()
                if pause:
                    self._publish(pause)
                if self.over and ending:
                    ending.pop()()
                time.sleep(tick)
        finally:
            self.stop()
            if ending:
                ending.pop()()
        self._publish()
        if self.failure:
            raise self.failure

    @property
    def over(self) -> bool:
        """True when the trial's thread has ended."""
        return not self._thread.is_alive() and self._thread.ident is not None

    @property
    def newest(self) -> Snapshot | None:
        """The latest snapshot; None before the first step."""
        return self._trial.newest

    @property
    def lost(self) -> float:
        """s of real time given up so far because the machine was too slow."""
        return self._pace.lost

    def start(self) -> None:
        """Starts the thread; does nothing if it was started."""
        if self._thread.ident is None:
            self._thread.start()

    def pause(self, paused: bool) -> None:
        """Pauses simulated time, or resumes it."""
        if paused:
            self._running.clear()
        else:
            self._running.set()

    def set_speed(self, speed: float) -> None:
        """Sets the pace in simulated seconds per second; the simulation itself stays the same."""
        self._pace.speed = speed

    def stop(self) -> None:
        """Ends the thread; the score stays as it is."""
        self._stop.set()
        self._running.set()
        if self._thread.ident is not None:
            self._thread.join()

    def _publish(self, pause: Pause = "") -> None:
        """Sends the pages the newest snapshot and why time stands still."""
        if self._pages:
            # While time begins to stand still, the thread may be in its last step.
            snapshot = self.newest if pause else None
            for page in self._pages:
                page.publish(snapshot or self._trial.session.snapshot(), pause)

    def _run(self) -> None:
        try:
            self._trial.run(self._pace, self._wait_while_paused, self._stop.is_set)
        except BaseException as error:  # nothing may end a trial without a word
            self.failure = error

    def _wait_while_paused(self) -> bool:
        """Waits while the trial is paused; True if it was."""
        if self._running.is_set():
            return False
        self._running.wait()
        for rig in self._trial.session.rigs:
            if rig.device.latency is not None:
                rig.device.latency.resume()
        return True


def _shared_event(rigs: Sequence[Rig]) -> threading.Event | None:
    """The event that all devices set when a frame has arrived; None if none has such an event."""
    devices = [
        device for rig in rigs for device in rig.device.within() if device.frame_ready is not None
    ]
    for device in devices:
        device.frame_ready = devices[0].frame_ready
    return devices[0].frame_ready if devices else None


LEEWAY = 0.10
"""s behind real time beyond which the session gives up the lost time. It then runs slower than real
time and says so, instead of hurrying to catch up."""

ROOM = 0.004
"""s before an expected frame in which no step is made without a frame; a step takes 1 to 2 ms."""
JITTER = 0.001
"""s by which a frame may come earlier or later than expected."""


class RealTime:
    """Waits for the wall clock to catch up with simulated time.

    Args:
        speed: Simulated seconds per second.
        simulated: s, simulated time that is due now.

    Attributes:
        lost: s of real time given up so far because the machine was too slow.
    """

    def __init__(self, speed: float = 1.0, simulated: float = 0.0) -> None:
        self.speed = speed
        self.lost = 0.0
        self._origin = time.monotonic() - simulated / speed
        self._heard = self._expected = float("-inf")

    def wait(
        self, simulated: float, frame_ready: threading.Event | None = None, lead: float = 0.0
    ) -> None:
        """Returns when a simulated time is due, or earlier when a frame has arrived.

        Args:
            simulated: s, simulated time.
            frame_ready: Event of an arrived frame: while it is set, simulated time may run ahead of
                the clock, so that a touch between two steps need not wait. None waits for the
                clock.
            lead: s of real time by which simulated time may run ahead.
        """
        due = self._origin + simulated / self.speed
        ahead = due - time.monotonic()
        if frame_ready is not None and ahead > 0:
            # Wakes up early enough for a frame that comes earlier than expected.
            if ahead > lead + JITTER:
                time.sleep(ahead - lead - JITTER)
            if frame_ready.wait(max(clear_of(due, self._expected) - time.monotonic(), 0.0)):
                now = time.monotonic()
                # The next frame is expected after the same interval as this one.
                self._expected, self._heard = 2.0 * now - self._heard, now
        elif ahead > 0:
            time.sleep(ahead)
        elif ahead < -LEEWAY:
            self._origin -= ahead
            self.lost -= ahead


class Pace:
    """Keeps a trial at real time, also when its speed changes or the trial is paused.

    Args:
        speed: Simulated seconds per second.
        frame_ready: See `RealTime.wait`; the step that takes a frame in may be one control period
            early.

    Attributes:
        speed: As given; may be changed at any time, from any thread.
    """

    def __init__(self, speed: float = 1.0, frame_ready: threading.Event | None = None) -> None:
        self.speed = speed
        self._frame_ready = frame_ready
        self._clock: RealTime | None = None
        self._given_up = 0.0

    @property
    def lost(self) -> float:
        """s of real time given up so far because the machine was too slow."""
        return self._given_up + (self._clock.lost if self._clock else 0.0)

    def begin(self, simulated: float) -> None:
        """Starts the clock at a simulated time, s; a pause before it is not caught up with."""
        self._given_up = self.lost
        self._clock = RealTime(self.speed, simulated)

    def wait(self, simulated: float) -> None:
        """Returns when a simulated time, s, is due."""
        clock = self._clock
        if clock is None or clock.speed != self.speed:
            # The step that was just made began at the old speed; the new one starts here.
            self.begin(simulated)
            return
        clock.wait(simulated, self._frame_ready, CONTROL_PERIOD / clock.speed)


def clear_of(due: float, expected: float) -> float:
    """Time at which to make a step without a frame, s, so that an expected frame need not wait.

    Touches come at a rate of their own. A few times a second a step falls due just before a touch,
    which would have to wait for the whole step; that step is made earlier.

    Args:
        due: s, time at which the step is due.
        expected: s, time at which a frame is expected.
    """
    return due - ROOM if due - JITTER < expected < due + ROOM else due
