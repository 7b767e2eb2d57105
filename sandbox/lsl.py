"""Lab Streaming Layer: touches, poses and markers for other instruments (extra `lsl`).

There are three streams, and with a second hand two more (`sandbox_touch_2`, `sandbox_hand_2`):

- `sandbox_touch`, irregular: a sample for every touch frame, when the frame takes effect;
- `sandbox_hand`, 62.5 Hz: the commanded pose of every control period;
- `sandbox_markers`, irregular: JSON texts.

The session's loop only puts samples on a queue; another thread sends them. Time stamps are taken in
the loop by Python's monotonic clock. They are converted to LSL's clock by an offset that is
measured repeatedly.
"""

from __future__ import annotations

import json
import os
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, Protocol
from uuid import uuid4

import numpy as np

from models.arithmetic import Array
from models.errors import DeviceError
from models.frames import Frame, TouchFrame
from models.pose import POSE_SIZE
from models.scene import CONTROL_PERIOD
from sandbox.recording.versions import versions
from sandbox.system.files import home
from sandbox.trial.driver import LISTENERS

if TYPE_CHECKING:
    from sandbox.session.session import Recorder, Session

CONTACTS = 10
"""Number of contacts in a touch sample; further contacts are not sent."""
PER_CONTACT = ("id", "x", "y", "size", "finger")
TOUCH_CHANNELS = ("step", "time", *(f"{name}_{i}" for i in range(CONTACTS) for name in PER_CONTACT))
HAND_CHANNELS = ("step", "time", *(f"q_{i}" for i in range(POSE_SIZE)))
KINDS: dict[str, tuple[str, tuple[str, ...], float]] = {
    "touch": ("Touch", TOUCH_CHANNELS, 0.0),
    "hand": ("MoCap", HAND_CHANNELS, 1.0 / CONTROL_PERIOD),
    "markers": ("Markers", ("json",), 0.0),
}
"""Kind of stream -> LSL's type, channels, samples per second (0: irregular)."""
NAMES = ("sandbox_touch", "sandbox_hand", "sandbox_markers")
TRIES = 9
"""Number of measurements of the clocks' offset; only the fastest measurement is used."""


def touch_sample(step: int, time_: float, frame: TouchFrame) -> Array:
    """Returns a touch frame in the order of `TOUCH_CHANNELS`; NaN for missing values."""
    sample = np.full(len(TOUCH_CHANNELS), np.nan)
    sample[:2] = step, time_
    for i, contact in enumerate(sorted(frame.contacts, key=lambda c: c.id)[:CONTACTS]):
        size = np.nan if contact.size is None else contact.size
        finger = np.nan if contact.label is None else contact.label
        at = 2 + len(PER_CONTACT) * i
        sample[at : at + len(PER_CONTACT)] = contact.id, contact.x, contact.y, size, finger
    return sample


def hand_sample(step: int, time_: float, q: Array) -> Array:
    """Returns a pose in the order of `HAND_CHANNELS`."""
    return np.concatenate([[step, time_], q])


class LslOutlets:
    """LSL streams of this program; implements `SessionListener`.

    Raises:
        DeviceError: pylsl or its library is missing.
    """

    def __init__(self) -> None:
        self._lsl = _pylsl()
        self.source = f"hand-sandbox-{uuid4()}"
        self._streams: dict[str, Any] = {}
        for name in NAMES:
            self._open(name)
        self._queue: SimpleQueue[tuple[str, Any, float] | None] = SimpleQueue()
        self._offset = self._measure()
        self._lost, self._why = 0, ""
        self._thread = threading.Thread(target=self._send, name="lsl", daemon=True)
        self._thread.start()

    def wait_for_consumers(self, seconds: float) -> bool:
        """Waits for a receiver of the markers; returns True if there is one."""
        return bool(self._streams[NAMES[-1]].wait_for_consumers(seconds))

    def close(self) -> None:
        """Sends the rest of the queue, and closes the streams.

        Raises:
            DeviceError: Some samples or markers could not be sent.
        """
        self._queue.put(None)
        self._thread.join()
        # An outlet closes when its object is deleted.
        self._streams.clear()
        if self._lost:
            raise DeviceError(
                "samples or markers were not sent over Lab Streaming Layer",
                where="--lsl",
                got=f"{self._lost} samples or markers lost: {self._why}",
                remedy="Use recordings or journals, which are complete",
            )

    def begin(self, header: Mapping[str, Any]) -> None:
        """See `SessionListener`."""
        settings = header.get("settings", {})
        known = {**settings, **settings.get("pipeline", {})}
        about = {k: known[k] for k in ("task", "seed", "encoder") if k in known}
        self.event("trial_start", {**about, **header.get("study", {})})

    def input(self, step: int, time: float, hand: int, frame: Frame) -> None:
        """See `SessionListener`. Hands in the air have no touches, so only their poses are sent."""
        if isinstance(frame, TouchFrame):
            self._put(_named("touch", hand), (touch_sample, step, time, frame))

    def pose(self, step: int, time: float, hand: int, q: Array) -> None:
        """See `SessionListener`."""
        self._put(_named("hand", hand), (hand_sample, step, time, q))

    def event(self, what: str, details: Mapping[str, Any]) -> None:
        """See `SessionListener`."""
        self._put(NAMES[-1], {"event": what, **details})

    def clock(self) -> dict[str, float]:
        """Returns LSL's clock minus the monotonic clock, s, and the monotonic clock, s."""
        self._offset = self._measure()
        return {"lsl_minus_monotonic_s": self._offset, "monotonic_s": round(time.monotonic(), 6)}

    def _put(self, stream: str, what: Any) -> None:
        self._queue.put((stream, what, time.monotonic()))

    def _send(self) -> None:
        while (waiting := self._queue.get()) is not None:
            try:
                self._push(*waiting)
            except Exception as error:  # one failure must not stop the rest; `close` reports it
                self._lost, self._why = self._lost + 1, self._why or str(error)

    def _push(self, stream: str, what: Any, stamp: float) -> None:
        if isinstance(what, tuple):
            make, *values = what
            sample = make(*values)
        else:
            sample = [json.dumps(what, ensure_ascii=False)]
        if stream not in self._streams:
            # The stream of a second hand opens with its first sample.
            self._open(stream)
        self._streams[stream].push_sample(sample, stamp + self._offset)

    def _measure(self) -> float:
        """Returns LSL's clock minus the monotonic clock, s, from the fastest measurement."""
        measurements = []
        for _ in range(TRIES):
            before = time.monotonic()
            theirs = self._lsl.local_clock()
            after = time.monotonic()
            measurements.append((after - before, theirs - (before + after) / 2))
        return round(min(measurements)[1], 9)

    def _open(self, name: str) -> None:
        kind = name.split("_")[1]
        type_, channels, rate = KINDS[kind]
        form = self._lsl.cf_string if kind == "markers" else self._lsl.cf_double64
        info = self._lsl.StreamInfo(
            name, type_, len(channels), rate, form, f"{self.source}-{name.removeprefix('sandbox_')}"
        )
        about = info.desc()
        about.append_child_value("manufacturer", "Hand Sandbox")
        about.append_child_value("version", versions()["hand-sandbox"])
        channel_list = about.append_child("channels")
        for label in channels:
            channel = channel_list.append_child("channel")
            channel.append_child_value("label", label)
            channel.append_child_value("unit", _unit(label))
        self._streams[name] = self._lsl.StreamOutlet(info)


def _named(kind: str, hand: int) -> str:
    return f"sandbox_{kind}" if hand == 0 else f"sandbox_{kind}_{hand + 1}"


def _unit(channel: str) -> str:
    name = channel.split("_", maxsplit=1)[0]
    if name == "q":
        return "m" if int(channel[2:]) < 3 else "rad"
    return {"time": "s", "x": "m", "y": "m", "size": "m"}.get(name, "")


def _pylsl() -> Any:
    """Imports pylsl and its library."""
    try:
        import pylsl
    except ImportError:
        raise DeviceError(
            "Lab Streaming Layer needs pylsl",
            where="--lsl",
            remedy="pip install 'hand-sandbox[lsl]'",
        ) from None
    except RuntimeError as error:
        # The wheel of pylsl for older systems lacks the library. The import fails only then.
        raise DeviceError(
            "pylsl cannot find its library liblsl",
            where="--lsl",
            got=str(error).splitlines()[0],
            remedy="Install liblsl from github.com/sccn/liblsl/releases, or set "
            "PYLSL_LIB to its file",
        ) from None
    if not any(path.is_file() for path in _settings_files()):
        # If the user has no settings, log only errors.
        pylsl.set_config_content("[log]\nlevel = -2\n")
    return pylsl


def _settings_files() -> list[Path]:
    """Paths at which liblsl looks for settings; the first from the environment variable."""
    name = "lsl_api.cfg"
    given = os.environ.get("LSLAPICFG")
    return [
        *([Path(given)] if given else []),
        Path(name),
        home() / "lsl_api" / name,
        Path("/etc/lsl_api") / name,
    ]


CLOCK_PERIOD = 10.0
"""Simulated time between two comparisons of clocks in a recording, s."""
STATES_PER_CLOCK = round(CLOCK_PERIOD / CONTROL_PERIOD)


class SessionListener(Protocol):
    """Contract of listeners, which receive the calls of a recorder."""

    def begin(self, header: Mapping[str, Any]) -> None:
        """Receives the start of a trial, with the header of its recording."""
        ...

    def input(self, step: int, time: float, hand: int, frame: Frame) -> None:
        """Receives a frame that takes effect at a physics step; `time` is simulated time, s."""
        ...

    def pose(self, step: int, time: float, hand: int, q: Array) -> None:
        """Receives a hand's commanded pose (48,) in the control period that ended at a step."""
        ...

    def event(self, what: str, details: Mapping[str, Any]) -> None:
        """Receives another event."""
        ...

    def clock(self) -> dict[str, float]:
        """Returns the offset of the listener's clock from the monotonic clock, as JSON values for
        the recording."""
        ...


@contextmanager
def forwarding_to(listener: SessionListener) -> Iterator[None]:
    """Context in which all recorded trials are also forwarded to a listener."""
    LISTENERS.append(listener)
    try:
        yield
    finally:
        LISTENERS.remove(listener)


def send_event(what: str, details: Mapping[str, Any]) -> None:
    """Sends an event outside of trials, such as a break, to all listeners."""
    for listener in LISTENERS:
        listener.event(what, details)


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

        If the scene or a device of a trial cannot be made, the trial has no session, and neither
        its start nor its end is forwarded.
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
