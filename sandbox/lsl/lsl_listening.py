"""Forwards recorder calls to other instruments while a session runs.

A listener gets exactly the calls of the recorder. It must return at once, since the session's loop
waits for it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Protocol

from models.arithmetic.arrays import Array
from models.frames import Frame
from models.scene import CONTROL_PERIOD

if TYPE_CHECKING:
    from sandbox.session.session import Recorder, Session


CLOCK_PERIOD = 10.0
"""s of simulated time between two comparisons of clocks in a recording."""
STATES_PER_CLOCK = round(CLOCK_PERIOD / CONTROL_PERIOD)


class SessionListener(Protocol):
    """Contract of listeners, which receive the calls of a recorder."""

    def begin(self, header: Mapping[str, Any]) -> None:
        """Takes the start of a trial, with the header of its recording."""
        ...

    def input(self, step: int, time: float, hand: int, frame: Frame) -> None:
        """Takes a frame that takes effect at a physics step; time in s of simulated time."""
        ...

    def pose(self, step: int, time: float, hand: int, q: Array) -> None:
        """Takes the commanded pose (48,) of a hand in the control period that ended at a step."""
        ...

    def event(self, what: str, details: Mapping[str, Any]) -> None:
        """Takes another event."""
        ...

    def clock(self) -> dict[str, float]:
        """Returns the offset of the listener's clock from ours, as JSON values for the
        recording."""
        ...


_LISTENERS: list[SessionListener] = []


@contextmanager
def forwarding_to(listener: SessionListener) -> Iterator[None]:
    """Context in which all recorded trials are forwarded to a listener, too."""
    _LISTENERS.append(listener)
    try:
        yield
    finally:
        _LISTENERS.remove(listener)


def tell(what: str, details: Mapping[str, Any]) -> None:
    """Sends all listeners an event outside of trials, such as a break."""
    for listener in _LISTENERS:
        listener.event(what, details)


def with_listeners(recorder: Recorder, header: Mapping[str, Any]) -> Recorder:
    """Wraps a recorder to forward calls to the current listeners; returns it unchanged without
    any."""
    return ForwardingRecorder(recorder, tuple(_LISTENERS), header) if _LISTENERS else recorder


class ForwardingRecorder:
    """Recorder that forwards all calls to listeners.

    Args:
        recorder: The recorder, which is called first.
        listeners: The listeners.
        header: Header of the recording.
    """

    def __init__(
        self, recorder: Recorder, listeners: Sequence[SessionListener], header: Mapping[str, Any]
    ) -> None:
        self._recorder, self._listeners = recorder, tuple(listeners)
        self._session: Session | None = None
        self._states, self._posed = 0, 0
        self._header = header

    def watch(self, session: Session) -> None:
        """Sets the session whose poses are sent, and forwards the start of its trial.

        A trial whose scene or device cannot be made has no session, and so neither start nor end.
        """
        self._session = session
        for listener in self._listeners:
            listener.begin(self._header)

    def input(self, step: int, hand: int, frame: Frame, state_hash: str) -> None:
        """See `Recorder`."""
        self._recorder.input(step, hand, frame, state_hash)
        for listener in self._listeners:
            listener.input(step, frame.time, hand, frame)

    def event(self, step: int, what: str, **details: Any) -> None:
        """See `Recorder`."""
        self._recorder.event(step, what, **details)
        for listener in self._listeners:
            listener.event(what, {"step": step, **details})

    def state(
        self,
        step: int,
        state: Array,
        state_hash: str,
        qpos: Array,
        solid: Sequence[frozenset[int]],
    ) -> None:
        """See `Recorder`."""
        self._recorder.state(step, state, state_hash, qpos, solid)
        if self._states % STATES_PER_CLOCK == 0:
            self._compare_clocks(step)
        self._states += 1
        self._pose()

    def end(self, result: Mapping[str, Any]) -> None:
        """Forwards the end of the trial."""
        self._pose()
        if self._session is not None:
            self._compare_clocks(self._session.step)
        outcome = {
            k: result[k] for k in ("status", "success", "time_s", "state_hash") if k in result
        }
        for listener in self._listeners:
            listener.event("trial_end", outcome)

    def _pose(self) -> None:
        """Forwards the poses of the period that has just ended."""
        session = self._session
        if session is None or session.step == self._posed:
            return
        self._posed = session.step
        for hand, reconstruction in enumerate(session.reconstructions):
            for listener in self._listeners:
                listener.pose(session.step, session.time, hand, reconstruction.q)

    def _compare_clocks(self, step: int) -> None:
        for listener in self._listeners:
            self._recorder.event(step, "clock", **listener.clock())
