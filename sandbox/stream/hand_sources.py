"""Sources of streamed hands: a live Leap, or a session; and one live hand for other programs.

A session computes commanded poses without physics. If a device needs the scene, as a simulated
person does, physics runs too.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Protocol

import numpy as np

from encoders.paalm.calibration import HandCalibration
from encoders.reconstruction.reconstructor import AirReconstructor, Reconstructor
from models.arithmetic import Array
from models.errors import DeviceError
from models.motion.armature import Armature, Keys
from models.motion.sampling import Poses, Sampler
from models.scene import CONTROL_PERIOD
from sandbox.devices.device import AnyDevice, Closeable, HandDevice, LatestFrame
from sandbox.export.leap_source import (
    described,
    devices_by_side,
    leap_armatures,
    straight_reconstructors,
)
from sandbox.export.motion_source import MotionSource, PoseCallback, poses_of, together
from sandbox.export.sources import commanded_poses
from sandbox.export.targets import simulated_poses
from sandbox.session.session import Session
from sandbox.stream.lines import HandLines, StreamTarget
from sandbox.stream.sender import Moment
from sandbox.trial.driver import RealTime, Trial


def source_of_session(
    session: Session, stop: threading.Event, of: str = "commanded"
) -> MotionSource:
    """Source of a session's hands in real time, until the session is over or `stop` is set.

    Args:
        session: A session that is ready for its first step.
        stop: Event that ends the source.
        of: `commanded` for the commanded poses, or `simulated` for the motion of simulated hands,
            which needs physics.
    """
    looking = [rig.device.show for rig in session.rigs if rig.device.takes_snapshots]
    physics = bool(looking) or of == "simulated"
    names = tuple(rig.hand.name for rig in session.rigs)
    armatures = tuple(Armature.of_hand(rig.hand) for rig in session.rigs)
    what = "the simulated hand" if of == "simulated" else "the commanded pose"

    def run(take: PoseCallback) -> str:
        if physics:
            return _with_physics(session, stop, of, take)
        return _without_physics([(r.device, r.reconstructor) for r in session.rigs], stop, take)

    return MotionSource(armatures, names, 0.0, what, run)


def source_of_leap(
    device: HandDevice,
    sides: Sequence[str],
    calibrations: Mapping[str, HandCalibration],
    stop: threading.Event,
) -> MotionSource:
    """Source of the hands over a live Leap in real time, in the device's frame, until `stop`.

    Args:
        device: The running device.
        sides: Sides of the hands, one or both.
        calibrations: Calibrations by side. A hand without a calibration has the bones that the
            device reports when it first sees the hand, or those of an average hand.
        stop: Event that ends the source.
    """
    names = tuple(sides)

    def run(take: PoseCallback) -> str:
        reconstructors = straight_reconstructors(names, calibrations)
        pairs = list(zip(devices_by_side(device, names), reconstructors, strict=True))
        return _without_physics(pairs, stop, take)

    remarks = tuple(
        f"without --calibration, the {side} hand has the bones that the Leap reports, or those of "
        "an average hand"
        for side in names
        if side not in calibrations
    )
    return MotionSource(leap_armatures(names), names, 0.0, described(names), run, remarks)


def _with_physics(session: Session, stop: threading.Event, of: str, take: PoseCallback) -> str:
    poses: Callable[..., Poses] = commanded_poses if of == "commanded" else simulated_poses
    Trial(session, [lambda snapshot: take(poses(snapshot))]).run(RealTime(), stop=stop.is_set)
    return f"the simulation diverged: {session.diverged}" if session.diverged else ""


def follow(
    hands: Sequence[tuple[AnyDevice, Reconstructor | AirReconstructor]],
    stop: threading.Event,
    show: Callable[[float, Sequence[Array]], None],
) -> None:
    """Computes commanded poses in real time and without physics, until all devices are finished.

    Args:
        hands: Device and reconstructor of each hand.
        stop: Event that ends the computation early.
        show: Called every control period with its time, s, and the pose (48,) of each hand.
    """
    newest = [LatestFrame(reconstructor.empty) for _, reconstructor in hands]
    clock, ticks = RealTime(), 0
    while not (stop.is_set() or all(device.finished for device, _ in hands)):
        now = ticks * CONTROL_PERIOD
        poses = []
        for (device, reconstructor), heard in zip(hands, newest, strict=True):
            heard.take(device.poll(now), now)
            poses.append(reconstructor.step(heard.frame).q)  # type: ignore[arg-type]
        show(now, poses)
        ticks += 1
        clock.wait(ticks * CONTROL_PERIOD)


def _without_physics(
    hands: Sequence[tuple[AnyDevice, Reconstructor | AirReconstructor]],
    stop: threading.Event,
    take: PoseCallback,
) -> str:
    def show(time: float, poses: Sequence[Array]) -> None:
        take(together([poses_of(np.array([time]), q[None]) for q in poses]))

    follow(hands, stop, show)
    return ""


class LiveHand(Closeable):
    """The commanded pose of a session's first hand in real time, for programs that need the newest
    pose.

    Physics runs only if a device needs the scene, as a simulated person does.

    Args:
        session: A session that is ready for its first step. `close` also closes the session.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._pose = session.rigs[0].reconstructor.commanded
        self._stop, self._lock = threading.Event(), threading.Lock()
        self._failure: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="live hand", daemon=True)
        self._thread.start()

    @property
    def over(self) -> bool:
        """True when the device has no more frames, as at the end of a recording."""
        return not self._thread.is_alive()

    def pose(self) -> Array:
        """The newest commanded pose (48,) in the world; after the end, the last pose.

        Raises:
            DeviceError: The device failed.
        """
        if self._failure is not None:
            raise DeviceError("the hand is lost", got=str(self._failure)) from self._failure
        with self._lock:
            return self._pose.copy()

    def close(self) -> None:
        """Stops the thread and closes the session; may be called twice."""
        self._stop.set()
        self._thread.join()
        self._session.close()

    def _take(self, pose: Array) -> None:
        with self._lock:
            self._pose = pose

    def _run(self) -> None:
        try:
            if any(rig.device.takes_snapshots for rig in self._session.rigs):
                views = [lambda snapshot: self._take(snapshot.hands[0].target)]
                Trial(self._session, views).run(RealTime(), stop=self._stop.is_set)
            else:
                hands = [(rig.device, rig.reconstructor) for rig in self._session.rigs]
                follow(hands, self._stop, lambda time, poses: self._take(poses[0]))
        except Exception as error:
            self._failure = error


class CommandReceiver(Protocol):
    """Contract of receivers of commands: a `Sender`, or a printer."""

    def show(
        self, hand: str, moment: Moment, wait: float = 0.0, stop: threading.Event | None = None
    ) -> bool:
        """Receives a moment of a hand; `stop` ends the wait for the last moment."""
        ...

    def order(self, command: str) -> None:
        """Receives a command that must not be lost."""
        ...


class Stopped(Exception):  # noqa: N818
    """Raised inside a source to end it early; `StreamPlayer` catches it."""


@dataclass(frozen=True)
class StreamPace:
    """Rate and speed of the stream.

    Attributes:
        rate: Moments per second, Hz.
        speed: Seconds of motion per second; 0 for a live source, which has its own clock.
        wait: Longest wait for an unsent moment before the next moment, s; 0 drops the unsent
            moment.
    """

    rate: float = 60.0
    speed: float = 0.0
    wait: float = 0.0


class StreamPlayer:
    """Streams the hands of a source.

    Args:
        source: Source of poses.
        target: Program that receives the commands.
        pace: Rate and speed of the stream.

    Attributes:
        hands: Writers of lines, one for each hand.
        moments: Number of moments sent or dropped so far. All hands share a moment.
        work: Processor time of writing lines so far, in the sender's thread, s.
    """

    def __init__(self, source: MotionSource, target: StreamTarget, pace: StreamPace) -> None:
        self._source, self._pace = source, pace
        self._sampler = Sampler(source.armatures, pace.rate)
        self.hands = [
            HandLines(armature, name, target)
            for armature, name in zip(source.armatures, source.names, strict=True)
        ]
        self.moments = 0
        self.work = 0.0
        self._clock: RealTime | None = None

    @property
    def greeting(self) -> list[str]:
        """Commands for the beginning of a connection."""
        return [hand.rig for hand in self.hands]

    def play(self, sender: CommandReceiver, stop: threading.Event) -> str:
        """Streams to the end of the source, then sends the commands to stop.

        Args:
            sender: A receiver of commands; a `Sender` must be created with `greeting`.
            stop: Event that ends the stream early.

        Returns:
            Error text of the source; empty without an error.
        """

        def take(poses: Poses) -> None:
            if stop.is_set():
                raise Stopped
            keys = self._sampler.add(poses)
            if keys is None:
                return
            for i in range(len(keys[0].root)):
                if stop.is_set():
                    raise Stopped
                now = [Keys(k.root[i : i + 1], k.turns[i : i + 1]) for k in keys]
                self._show(sender, now, stop)

        try:
            return self._source.play(take)
        except Stopped:
            return ""
        finally:
            for hand in self.hands:
                sender.order(hand.stop)

    def _show(self, sender: CommandReceiver, hands: list[Keys], stop: threading.Event) -> None:
        moment = self.moments / self._pace.rate
        if self._pace.speed:
            self._clock = self._clock or RealTime(self._pace.speed)
            self._clock.wait(moment)
        for name, lines, keys in zip(self._source.names, self.hands, hands, strict=True):
            commands = partial(self._commands, lines, moment, keys)
            sender.show(name, commands, self._pace.wait, stop)
        self.moments += 1

    def _commands(self, lines: HandLines, moment: float, keys: Keys) -> list[str]:
        """Returns the commands of a moment; called in the sender's thread."""
        begin = time.thread_time()
        commands = lines.lines(moment, keys)
        self.work += time.thread_time() - begin
        return commands
