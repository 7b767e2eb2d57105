"""The contract of devices: what a source of touches, or of hands in the air, offers to a session.

A device overrides `poll` and the members that it has; every other member has a default. Wrappers
keep the same contract (`sandbox.devices.wrappers.device_wrapper`), and a device that was written
elsewhere without these base classes gets the defaults where it is opened
(`sandbox.devices.discovery`). So nobody has to ask a device what it can do.
"""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar

from models.frames import Frame, HandFrame, TouchFrame
from sandbox.session.latency import LatencyLog

if TYPE_CHECKING:
    from builtins import property as default

    from sandbox.session.messages import Snapshot
else:

    class default:  # noqa: N801  (used as a decorator, as `property` is)
        """A read-only property that a class attribute or an attribute of the object may replace."""

        def __init__(self, compute: Callable[[Any], Any]) -> None:
            self._compute, self.__doc__ = compute, compute.__doc__

        def __get__(self, device: Any, kind: type | None = None) -> Any:
            return self if device is None else self._compute(device)


PAUSE = 0.002
"""s that `wait` takes for a device that cannot say when a frame comes."""

_NO_TRUTH: Mapping[int, int] = MappingProxyType({})

D = TypeVar("D")


class AnyDevice(ABC):
    """Members that devices of touches and of hands in the air share.

    Whatever may block (a socket, a file, a window) lives in the device's own thread; `poll` is
    called from the session's loop and returns at once.

    Attributes:
        news: Set by the device when a frame has come, and cleared by `poll`, so that a session need
            not wait for its next tick; None where the device cannot say. Several devices may be
            given one event in common.
    """

    news: threading.Event | None = None
    _closed = False

    @default
    def name(self) -> str:
        """In messages and logs; the class's name unless said otherwise."""
        return type(self).__name__

    @abstractmethod
    def poll(self, now: float) -> Sequence[Frame]:
        """Frames committed since the last call, oldest first.

        Args:
            now: Session time, seconds of simulated time. A live device ignores it; one that plays
                from a file or from a simulation gives the frames due by then.
        """

    @default
    def finished(self) -> bool:
        """True when no further frame can come, as at the end of a file; by default once closed."""
        return self._closed

    def close(self) -> None:
        """Gives back sockets, files and threads; may be called twice."""
        self._closed = True

    @default
    def has_lift(self) -> bool:
        """True where its frames carry a lift control."""
        return False

    @default
    def looks(self) -> bool:
        """True where it must see the scene, through `show`, before it moves."""
        return False

    def show(self, snapshot: Snapshot) -> None:  # noqa: B027  (most devices see nothing)
        """Receives every snapshot of the session; does nothing by default."""

    @default
    def notice(self) -> str:
        """A message for the person now, such as why nothing moves; empty while all is well."""
        return ""

    def switches(self, now: float) -> Sequence[str]:
        """Contact modes asked for since the last call, up to session time `now`, s; see
        `sandbox.session.contact_modes`."""
        return ()

    def wait(self, seconds: float) -> bool:
        """Waits for a frame to fetch, at most `seconds`; False where none came in time.

        By default it waits for a moment, and says that there may be one.
        """
        time.sleep(min(PAUSE, seconds))
        return True

    @default
    def address(self) -> str:
        """Where it listens, as a person types it; empty where it does not listen."""
        return ""

    @default
    def title(self) -> str:
        """What `sandbox touches show` calls it; its name unless said otherwise."""
        return self.name

    @default
    def plays_file(self) -> bool:
        """True where its frames were recorded."""
        return False

    @default
    def damage(self) -> Exception | None:
        """What ended a recorded file early; None where there is no damage."""
        return None

    @default
    def clock_origin(self) -> float:
        """s on the machine's monotonic clock at which the time of its frames is 0."""
        return 0.0

    @default
    def latency(self) -> LatencyLog | None:
        """How long its frames waited for the session; None where it does not measure that."""
        return None

    @default
    def truth(self) -> Mapping[int, int]:
        """The true finger (thumb 0 .. little 4) of each contact, by id; empty where unknown. Only
        results and tables use it."""
        return _NO_TRUTH

    @default
    def parts(self) -> tuple[AnyDevice, ...]:
        """Devices directly inside this one, as in a wrapper."""
        return ()

    def within(self) -> Iterator[AnyDevice]:
        """This device and all inside it, outermost first."""
        yield self
        for part in self.parts:
            yield from part.within()

    def find(self, kind: type[D]) -> D | None:
        """The first device of a class, this one or one inside it; None where there is none."""
        return next((device for device in self.within() if isinstance(device, kind)), None)


class Device(AnyDevice):
    """A source of touch frames."""

    @abstractmethod
    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Touch frames committed since the last call, oldest first; see `AnyDevice.poll`."""


class HandDevice(AnyDevice):
    """A source of frames of hands in the air."""

    @abstractmethod
    def poll(self, now: float) -> Sequence[HandFrame]:
        """Hand frames since the last call, oldest first; see `AnyDevice.poll`."""
