"""The contract of devices: sources of touch frames and hand frames, and how they are opened.

A device of this program is a folder in `sandbox/devices` with a `DeviceEntry`, and a line in
`sandbox.devices.registry`. The entry has the device's kind (`DeviceKind`), its options and the
function that opens it: `open(options, place) -> AnyDevice`. `Place` has the surface and the person.

A device overrides `poll` and the members that it supports; every other member has a default.
`DeviceWrapper`, the base class of wrappers, forwards all members. A device from another package,
without these base classes, gets the defaults when it is opened (`sandbox.devices.own_device`).
Callers therefore never need `hasattr`.
"""

from __future__ import annotations

import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from types import MappingProxyType, TracebackType
from typing import TYPE_CHECKING, Any, Generic, Self, TypeVar

from models.frames import Frame, HandFrame, LandmarkFrame, TouchFrame
from models.person import Person
from models.reader_report import ReaderReport
from models.surface import Surface
from tasks.user import UserConfiguration

if TYPE_CHECKING:
    from builtins import property as default

    from models.arithmetic import Array
    from sandbox.devices.hand_input import HandInput
    from sandbox.session.messages import Snapshot
    from sandbox.trial.logs import LatencyLog
    from tasks.task import Task
else:

    class default:  # noqa: N801  (used as a decorator, as `property` is)
        """A read-only property that a class attribute or an attribute of the object may replace."""

        def __init__(self, compute: Callable[[Any], Any]) -> None:
            self._compute, self.__doc__ = compute, compute.__doc__

        def __get__(self, device: Any, kind: type | None = None) -> Any:
            return self if device is None else self._compute(device)


PAUSE = 0.002
"""Sleep of the default `wait`, for devices that cannot signal the arrival of a frame, s."""

_NO_TRUTH: Mapping[int, int] = MappingProxyType({})

D = TypeVar("D")
O = TypeVar("O")  # noqa: E741  (options of a device)


class Sees(StrEnum):
    """Kind of a device's input: touches, or a hand in the air."""

    TOUCHES = "touches"
    LEAP = "leap"
    CAMERA = "camera"
    HEADSET = "headset"


class Source(StrEnum):
    """Origin of a device's frames."""

    LIVE = "live"
    SIMULATED = "simulated"
    FILE = "file"


@dataclass(frozen=True)
class DeviceKind:
    """Properties of a device that are available without opening it.

    Attributes:
        sees: Touches, or hands over a Leap, before a camera or in a headset.
        source: `LIVE`: a person or another program; the session runs in real time. `SIMULATED`: a
            simulated user. `FILE`: a file. The last two run as fast as the machine can.
        labels: The device can label the fingers; otherwise the program always labels them.
        in_scene: The device needs a scene: a window, visible objects, or a hand. Other devices can
            also be used by `sandbox touches`.
        one_hand: The device serves one hand; a task for two hands needs a second device.
        guessed_size: The device does not report the size of its surface. Without --surface, the
            size is a guess.
    """

    sees: Sees = Sees.TOUCHES
    source: Source = Source.LIVE
    labels: bool = False
    in_scene: bool = False
    one_hand: bool = False
    guessed_size: bool = False

    @property
    def in_air(self) -> bool:
        """True if the device tracks hands in the air."""
        return self.sees is not Sees.TOUCHES

    @property
    def live(self) -> bool:
        """True if a person or another program drives the device."""
        return self.source is Source.LIVE

    @property
    def simulated(self) -> bool:
        """True if a simulated user drives the device."""
        return self.source is Source.SIMULATED


@dataclass(frozen=True)
class Place:
    """Surface, person and task for which a device is opened.

    Attributes:
        surface: The touch surface, placed in the world.
        argument: Text after the colon of the device's name, or the path of a file; else empty.
        hand: Index of the hand in the scene. If the device serves both hands, index of the first.
        sides: Side of each hand that the device serves, `right` or `left`.
        person: The person who uses the device.
        task: The drawn task, for simulated users; None without a task.
        seed: Seed of all random numbers of a simulated user.
        labels: True if a device that can label contacts should do so.
        home: Centre (2,) of the hand's part of the surface, m in the world; None for the whole
            surface.
        at: Position (3,) of a simulated device that tracks hands in the air, m in the world.
    """

    surface: Surface
    argument: str = ""
    hand: int = 0
    sides: tuple[str, ...] = ("right",)
    person: Person = field(default_factory=Person)
    task: Task | None = None
    seed: int = 0
    labels: bool = False
    home: Array | None = None
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def drawn_task(self) -> Task:
        """The drawn task, which a simulated user needs."""
        assert self.task is not None, "simulated users are opened for a task"
        return self.task


@dataclass(frozen=True)
class NoOptions:
    """Options class of a device that has no options."""


@dataclass(frozen=True, kw_only=True)
class UnitOptions:
    """Option for the units of a recording made by another program."""

    unit: str = field(default="", metadata={"metavar": "UNIT,..."})
    """Units of a recording, such as cm,ms. Lengths: m, cm, mm or in. Times: s, ms, us or ns. Places
    in a picture: px or 0..1. Default: units for which the hand has a possible size, or the touches
    lie on the surface, and the frames have a possible rate. These units are reported if they differ
    from the format's units."""


@dataclass(frozen=True, kw_only=True)
class PlayedOptions(UnitOptions):
    """Options of a device that plays a file, and of a user's own device."""

    user: UserConfiguration | None = None
    """The simulated user who made the recording; None for a person or an unknown origin."""

    own: Mapping[str, Any] = field(default_factory=dict)
    """Options declared by a user's own device, by name."""


def _anything(options: Any, argument: str) -> None:
    """Checks nothing."""


def _the_same(options: Any) -> Any:
    """Returns the options unchanged."""
    return options


def _no_surface(options: Any, argument: str) -> Surface | None:
    """Returns None: the device reports no surface."""
    return None


@dataclass(frozen=True)
class DeviceEntry(Generic[O]):
    """Registry entry of a device: its kind, its options, and the function that opens it.

    Attributes:
        help: A phrase that describes the device, for lists.
        open: Opens the device; called with an object of `options` and the place.
        options: Dataclass of the options, all with defaults. `--help` shows the docstrings of the
            fields, and `metadata["metavar"]` of a field as the placeholder of its value. A
            recording's header stores the values.
        kind: Properties of the device.
        argument: Name of the argument that may follow the device's name and a colon, such as NODE;
            empty if the device has no argument.
        check: Checks options and argument before anything is built.
        surface: Returns the surface that the device reports, from its options on the command line
            and its argument; None if it reports no surface.
        command_options: Dataclass of the options on the command line; None if they are `options`.
            For hands in the air, the class adds the placement and calibration of the device. Fields
            of `options` get the values of the fields of this class with the same names.
        hand_input: For a device that tracks hands in the air: returns the input settings of a hand
            from the options on the command line, the argument and the hand's side.
        for_second: Returns the options of a second device of this kind, from those of the first,
            such as another port.
    """

    help: str
    open: Callable[[O, Place], AnyDevice]
    options: type[O]
    kind: DeviceKind = DeviceKind()
    argument: str = ""
    check: Callable[[O, str], None] = _anything
    surface: Callable[[Any, str], Surface | None] = _no_surface
    command_options: type[Any] | None = None
    hand_input: Callable[[Any, str, str], HandInput] | None = None
    for_second: Callable[[O], O] = _the_same

    @property
    def on_command_line(self) -> type[Any]:
        """Dataclass of the device's options on the command line."""
        return self.command_options or self.options


class AnyDevice(ABC):
    """Common base class of touch devices and of devices that track hands in the air.

    Anything that may block (a socket, a file, a window) belongs in a thread of the device; `poll`
    is called from the session's loop and must return at once.

    Attributes:
        frame_ready: Event that the device sets when a frame has arrived, so that a session need not
            wait for its next tick; `poll` clears it. None if the device has no such event. Several
            devices may share one event.
    """

    frame_ready: threading.Event | None = None
    _closed = False

    @default
    def name(self) -> str:
        """Name in messages and logs; by default the name of the class."""
        return type(self).__name__

    @abstractmethod
    def poll(self, now: float) -> Sequence[Frame]:
        """Returns the frames since the last call, oldest first; never waits.

        Args:
            now: Session time, seconds of simulated time. A live device ignores it; a device that
                plays a file or a simulation returns the frames due by `now`.
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
        """True if the device's frames carry a lift control."""
        return False

    @default
    def takes_snapshots(self) -> bool:
        """True if the device needs snapshots of the scene, passed to `show`."""
        return False

    def show(self, snapshot: Snapshot) -> None:  # noqa: B027  (most devices ignore the scene)
        """Receives every snapshot of the session if `takes_snapshots`; does nothing by default."""

    @default
    def notices(self) -> Sequence[str]:
        """Current messages for the person, such as why the hand does not move; usually empty."""
        return ()

    def mode_requests(self, now: float) -> Sequence[str]:
        """Contact modes requested since the last call, up to session time `now`, s.

        `sandbox.session.collision_gating` lists the modes.
        """
        return ()

    def wait(self, seconds: float) -> bool:
        """Waits for a frame, at most `seconds`; returns False if no frame came in time.

        The default sleeps for up to `PAUSE` and returns True, as there may be a frame.
        """
        time.sleep(min(PAUSE, seconds))
        return True

    @default
    def address(self) -> str:
        """Address at which the device listens, as a person types it; empty if it has none."""
        return ""

    @default
    def title(self) -> str:
        """Name in `sandbox touches show`; by default `name`."""
        return self.name

    @default
    def plays_file(self) -> bool:
        """True if the device plays recorded frames."""
        return False

    @default
    def damage(self) -> Exception | None:
        """The error that ended a recorded file early; None if the file is undamaged."""
        return None

    @default
    def report(self) -> ReaderReport | None:
        """Report of left-out input and of assumptions about it; None if the device has none."""
        return None

    @default
    def clock_origin(self) -> float | None:
        """Origin of the frames' times on the machine's monotonic clock, s.

        None if frames carry session time: such frames have no latency to measure.
        """
        return 0.0

    @default
    def latency(self) -> LatencyLog | None:
        """Log of the time that frames waited for the session; None if the device has none."""
        return None

    @default
    def true_labels(self) -> Mapping[int, int]:
        """True finger (thumb 0 .. little 4) of each contact, by id; empty if unknown.

        Only results and tables use the true labels; labellers never see them.
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
        """Returns the first device of a class among this device and those inside it, or None."""
        return next((device for device in self.within() if isinstance(device, kind)), None)


class Device(AnyDevice):
    """A source of touch frames."""

    @abstractmethod
    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Returns the touch frames since the last call, oldest first; see `AnyDevice.poll`."""


class HandDevice(AnyDevice):
    """A source of hand frames: hands tracked in the air."""

    @abstractmethod
    def poll(self, now: float) -> Sequence[HandFrame]:
        """Returns the hand frames since the last call, oldest first; see `AnyDevice.poll`."""


class LandmarkDevice(AnyDevice):
    """A source of landmark frames: hands in a camera's pictures."""

    @abstractmethod
    def poll(self, now: float) -> Sequence[LandmarkFrame]:
        """Returns the landmark frames since the last call, oldest first; see `AnyDevice.poll`."""


class FilePlayer(AnyDevice):
    """Plays recorded frames at their times; the first frame plays at session time 0.

    Args:
        frames: Frames in order of time.
        damage: Error that ended the file early; None without damage.
        report: The file reader's report on left-out data and assumptions.
    """

    plays_file = True
    damage: Exception | None
    report: ReaderReport | None

    def __init__(
        self,
        frames: Sequence[Any],
        damage: Exception | None = None,
        report: ReaderReport | None = None,
    ) -> None:
        self._frames, self.damage, self.report = frames, damage, report
        self._next = 0

    @property
    def finished(self) -> bool:
        """True after the last frame."""
        return self._next >= len(self._frames)

    def poll(self, now: float) -> Sequence[Any]:
        """Returns the frames due by `now`, oldest first."""
        first, start = self._next, self._frames[0].time if self._frames else 0.0
        while not self.finished and self._frames[self._next].time - start <= now:
            self._next += 1
        return self._frames[first : self._next]

    def close(self) -> None:
        """Ends playback."""
        self._next = len(self._frames)


class TouchDevice(Device):
    """Base class of a user's own touch device; a subclass has to define only `poll`.

    The device runs until it is closed. A device that ends by itself sets `self.finished = True`, or
    overrides `finished` as a property. `Device` declares the other members that a subclass may
    override.

    Args:
        surface: The touch surface.
        argument: Text after the colon that follows the device's name on the command line; empty
            if there is none.
    """

    finished: bool = False

    def __init__(self, surface: Surface, argument: str = "") -> None:
        self.surface, self.argument = surface, argument

    def close(self) -> None:
        """Ends the device and releases its resources; may be called twice."""
        super().close()
        if not isinstance(getattr(type(self), "finished", None), property):
            self.finished = True


class DeviceWrapper(Device):
    """Base class of devices that wrap another device and forward every member to it.

    A subclass overrides the members that it changes.

    Args:
        device: The wrapped device.

    Attributes:
        device: As given.
    """

    def __init__(self, device: AnyDevice) -> None:
        self.device = device

    @property
    def name(self) -> str:
        """Name of the wrapped device."""
        return self.device.name

    def poll(self, now: float) -> Sequence[Any]:
        """Returns the wrapped device's frames."""
        return self.device.poll(now)

    @property
    def finished(self) -> bool:
        """True if the wrapped device has finished."""
        return self.device.finished

    def close(self) -> None:
        """Closes the wrapped device."""
        self.device.close()

    @property
    def lift(self) -> bool:
        """`lift` of the wrapped device."""
        return self.device.lift

    @property
    def takes_snapshots(self) -> bool:
        """`takes_snapshots` of the wrapped device."""
        return self.device.takes_snapshots

    def show(self, snapshot: Snapshot) -> None:
        """Passes the snapshot to the wrapped device."""
        self.device.show(snapshot)

    @property
    def notices(self) -> Sequence[str]:
        """`notices` of the wrapped device."""
        return self.device.notices

    def mode_requests(self, now: float) -> Sequence[str]:
        """Returns `mode_requests` of the wrapped device."""
        return self.device.mode_requests(now)

    @property
    def frame_ready(self) -> threading.Event | None:
        """`frame_ready` of the wrapped device; assigning it sets that of the wrapped device."""
        return self.device.frame_ready

    @frame_ready.setter
    def frame_ready(self, frame_ready: threading.Event | None) -> None:
        self.device.frame_ready = frame_ready

    def wait(self, seconds: float) -> bool:
        """Calls `wait` of the wrapped device."""
        return self.device.wait(seconds)

    @property
    def address(self) -> str:
        """`address` of the wrapped device."""
        return self.device.address

    @property
    def title(self) -> str:
        """`title` of the wrapped device."""
        return self.device.title

    @property
    def plays_file(self) -> bool:
        """`plays_file` of the wrapped device."""
        return self.device.plays_file

    @property
    def damage(self) -> Exception | None:
        """`damage` of the wrapped device."""
        return self.device.damage

    @property
    def report(self) -> ReaderReport | None:
        """`report` of the wrapped device."""
        return self.device.report

    @property
    def clock_origin(self) -> float | None:
        """`clock_origin` of the wrapped device."""
        return self.device.clock_origin

    @property
    def latency(self) -> LatencyLog | None:
        """`latency` of the wrapped device."""
        return self.device.latency

    @property
    def true_labels(self) -> Mapping[int, int]:
        """`true_labels` of the wrapped device."""
        return self.device.true_labels

    @property
    def parts(self) -> tuple[AnyDevice, ...]:
        """The wrapped device."""
        return (self.device,)


SILENCE = 0.5
"""Time (s) without a frame after which a device that tracks hands in the air sees no hand.

Such a device sends many frames a second, even without a hand in view. Touch devices send only
changes, so their silence means nothing.
"""


class LatestFrame:
    """The latest frame of a device.

    Args:
        empty: Frame that is used until the first frame of the device.

    Attributes:
        frame: The latest frame, with session time.
    """

    def __init__(self, empty: Frame) -> None:
        self.frame = empty
        self._heard = 0.0

    def take(self, frames: Sequence[Frame], time: float) -> bool:
        """Updates `frame` from the frames since the last control period; True if there were any.

        If there are several frames, `frame` is the last of them, with the touches that any of them
        cancelled.

        Args:
            frames: Frames of one kind, oldest first.
            time: s, session time.
        """
        last = frames[-1] if frames else self.frame
        if frames:
            self._heard = time
        if isinstance(last, TouchFrame):
            self.frame = (
                _stamped([f for f in frames if isinstance(f, TouchFrame)], time)
                if frames
                else TouchFrame(time, last.contacts, last.lift, source=last.source)
            )
        elif time - self._heard > SILENCE and isinstance(last, LandmarkFrame):
            self.frame = replace(last, time=time, hands=())
        elif time - self._heard > SILENCE:
            self.frame = HandFrame(time, (), last.source)
        else:
            self.frame = last if last.time == time else replace(last, time=time)
        return bool(frames)


def _stamped(frames: Sequence[TouchFrame], time: float) -> TouchFrame:
    """Returns the last frame at time `time`, with the touches that any frame cancelled."""
    last = frames[-1]
    if len(frames) == 1 and last.time == time and not last.cancelled:
        return last
    cancelled = frozenset().union(*(f.cancelled for f in frames))
    present = {c.id for c in last.contacts}
    return replace(last, time=time, cancelled=frozenset(cancelled - present))


class Closeable(ABC):
    """Base class of context managers that call `close` at the end of a `with` block."""

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
