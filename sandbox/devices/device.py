"""The contract of devices: the interface between a session and a source of touches or hand frames.

A device overrides `poll` and the members that it supports; every other member has a default.
Wrappers keep the same contract (`sandbox.devices.wrappers.device_wrapper`). A device that was
written elsewhere without these base classes gets the defaults when it is opened
(`sandbox.devices.wrappers.adapted`). Callers therefore never need `hasattr`.
"""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType, TracebackType
from typing import TYPE_CHECKING, Any, Self, TypeVar

from models.frames import Frame, HandFrame, LandmarkFrame, TouchFrame
from models.surface import Surface

if TYPE_CHECKING:
    from builtins import property as default

    from sandbox.session.messages import Snapshot
    from sandbox.trial.latency import LatencyLog
else:

    class default:  # noqa: N801  (used as a decorator, as `property` is)
        """A read-only property that a class attribute or an attribute of the object may replace."""

        def __init__(self, compute: Callable[[Any], Any]) -> None:
            self._compute, self.__doc__ = compute, compute.__doc__

        def __get__(self, device: Any, kind: type | None = None) -> Any:
            return self if device is None else self._compute(device)


PAUSE = 0.002
"""s that the default `wait` sleeps, for devices that cannot signal the arrival of a frame."""

_NO_TRUTH: Mapping[int, int] = MappingProxyType({})

D = TypeVar("D")


class AnyDevice(ABC):
    """Common base class of touch devices and of devices that track hands in the air.

    Anything that may block (a socket, a file, a window) belongs in a thread of the device; `poll`
    is called from the session's loop and must return at once.

    Attributes:
        frame_ready: Event that the device sets when a frame has arrived and that `poll` clears, so
            that a session need not wait for its next tick; None where the device has no such event.
            Several devices may share one event.
    """

    frame_ready: threading.Event | None = None
    _closed = False

    @default
    def name(self) -> str:
        """Name in messages and logs; by default that of the class."""
        return type(self).__name__

    @abstractmethod
    def poll(self, now: float) -> Sequence[Frame]:
        """Frames committed since the last call, oldest first.

        Args:
            now: Session time, seconds of simulated time. A live device ignores it; a device that
                plays a file or a simulation returns the frames due by then.
        """

    @default
    def finished(self) -> bool:
        """True when no further frame can arrive, as at a file's end; by default once closed."""
        return self._closed

    def close(self) -> None:
        """Releases sockets, files and threads; may be called twice."""
        self._closed = True

    @default
    def lift(self) -> bool:
        """True if its frames carry a lift control."""
        return False

    @default
    def wants_snapshots(self) -> bool:
        """True if it needs snapshots of the scene, passed to `show`."""
        return False

    def show(self, snapshot: Snapshot) -> None:  # noqa: B027  (most devices ignore the scene)
        """Receives every snapshot of the session if `wants_snapshots`; does nothing by default."""

    @default
    def notices(self) -> Sequence[str]:
        """Messages for the person now, such as why nothing moves; empty without a problem."""
        return ()

    def mode_requests(self, now: float) -> Sequence[str]:
        """Contact modes requested since the last call, up to session time `now`, s.

        `sandbox.session.contact_modes` lists the modes.
        """
        return ()

    def wait(self, seconds: float) -> bool:
        """Waits for a frame, at most `seconds`; False if none came in time.

        The default sleeps for up to `PAUSE` and returns True, as there may be a frame.
        """
        time.sleep(min(PAUSE, seconds))
        return True

    @default
    def address(self) -> str:
        """Address at which it listens, as a person types it; empty if it does not listen."""
        return ""

    @default
    def title(self) -> str:
        """Name in `sandbox touches show`; by default `name`."""
        return self.name

    @default
    def plays_file(self) -> bool:
        """True if it plays recorded frames."""
        return False

    @default
    def damage(self) -> Exception | None:
        """The error that ended a recorded file early; None if the file is undamaged."""
        return None

    @default
    def clock_origin(self) -> float | None:
        """s on the machine's monotonic clock at which the time of its frames is 0.

        None where frames carry session time, in which nothing can be late.
        """
        return 0.0

    @default
    def latency(self) -> LatencyLog | None:
        """Log of the time that its frames waited for the session; None if it keeps none."""
        return None

    @default
    def true_labels(self) -> Mapping[int, int]:
        """True finger (thumb 0 .. little 4) of each contact, by id; empty if unknown.

        Only results and tables use it.
        """
        return _NO_TRUTH

    @default
    def parts(self) -> tuple[AnyDevice, ...]:
        """Devices directly inside this one, such as the device in a wrapper."""
        return ()

    def within(self) -> Iterator[AnyDevice]:
        """Yields this device and all devices inside it, outermost first."""
        yield self
        for part in self.parts:
            yield from part.within()

    def find(self, kind: type[D]) -> D | None:
        """The first device of a class among this one and those inside it; None without one."""
        return next((device for device in self.within() if isinstance(device, kind)), None)


class Device(AnyDevice):
    """A source of touch frames."""

    @abstractmethod
    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Touch frames committed since the last call, oldest first; see `AnyDevice.poll`."""


class HandDevice(AnyDevice):
    """A source of hand frames, of hands tracked in the air."""

    @abstractmethod
    def poll(self, now: float) -> Sequence[HandFrame]:
        """Hand frames since the last call, oldest first; see `AnyDevice.poll`."""


class LandmarkDevice(AnyDevice):
    """A source of landmark frames, of hands in a camera's pictures."""

    @abstractmethod
    def poll(self, now: float) -> Sequence[LandmarkFrame]:
        """Landmark frames since the last call, oldest first; see `AnyDevice.poll`."""


class TouchDevice(Device):
    """A touch device that the command line opens; a subclass has to define only `poll`.

    It runs until it is closed. A device that ends by itself sets `self.finished = True`, or
    overrides `finished` as a property. `Device` declares the other members that it may override.

    Args:
        surface: The touch surface.
        argument: Text after the colon that follows the device's name on the command line; empty
            without one.
    """

    finished: bool = False

    def __init__(self, surface: Surface, argument: str = "") -> None:
        self.surface, self.argument = surface, argument

    def close(self) -> None:
        """Ends the device and releases its resources; may be called twice."""
        super().close()
        if not isinstance(getattr(type(self), "finished", None), property):
            self.finished = True


SILENCE = 0.5
"""s without a frame after which a 3-D device or a camera is taken to see no hand. A working one
sends many frames a second, also without a hand in view; touch devices send only changes."""


class LatestFrame:
    """Keeps the latest frame of a device.

    Args:
        empty: Frame that stands in until the first one.

    Attributes:
        frame: The latest frame, with session time.
    """

    def __init__(self, empty: Frame) -> None:
        self.frame = empty
        self._heard = 0.0

    def take(self, frames: Sequence[Frame], time: float) -> bool:
        """Takes in the frames since the last control period; True if there were any.

        Of several frames the last one counts; touches that were cancelled in any of them stay
        cancelled.

        Args:
            frames: Oldest first, of one kind.
            time: s, session time.
        """
        last = frames[-1] if frames else self.frame
        if frames:
            self._heard = time
        if isinstance(last, TouchFrame):
            self.frame = (
                _stamped([f for f in frames if isinstance(f, TouchFrame)], time)
                if frames
                else replace(last, time=time, cancelled=frozenset())
            )
        elif time - self._heard > SILENCE and isinstance(last, LandmarkFrame):
            self.frame = replace(last, time=time, hands=())
        elif time - self._heard > SILENCE:
            self.frame = HandFrame(time, (), last.source)
        else:
            self.frame = last if last.time == time else replace(last, time=time)
        return bool(frames)


def _stamped(frames: Sequence[TouchFrame], time: float) -> TouchFrame:
    """The last frame, stamped with a time, with the touches that were cancelled in any frame."""
    last = frames[-1]
    if len(frames) == 1 and last.time == time and not last.cancelled:
        return last
    cancelled = frozenset().union(*(f.cancelled for f in frames))
    present = {c.id for c in last.contacts}
    return replace(last, time=time, cancelled=frozenset(cancelled - present))


class Closeable(ABC):
    """Calls its `close` at the end of a `with` block, also after an exception."""

    @abstractmethod
    def close(self) -> None:
        """Releases all resources; may be called twice."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
