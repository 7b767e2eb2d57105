"""Player of a source of poses, which sends commands at a constant rate."""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from models.motion.armature import Keys
from models.motion.sampling import Poses, Sampler
from sandbox.export.motion_source import MotionSource
from sandbox.stream.lines import HandLines, StreamTarget
from sandbox.stream.sender import Moment
from sandbox.trial.driver import RealTime


class CommandReceiver(Protocol):
    """Contract of receivers of commands: a `Sender`, or a printer."""

    def show(
        self, hand: str, moment: Moment, wait: float = 0.0, stop: threading.Event | None = None
    ) -> bool:
        """Takes a moment of a hand; `stop` ends the wait for the last one."""
        ...

    def order(self, command: str) -> None:
        """Takes a command that must not be lost."""
        ...


class Stopped(Exception):  # noqa: N818
    """Raised inside a source to end it early, and caught by the player."""


@dataclass(frozen=True)
class StreamPace:
    """Rate and speed of the stream.

    Attributes:
        rate: Hz of the moments.
        speed: Seconds of the motion per second; 0 leaves the clock to the source, which is live.
        wait: s for which to wait for a moment to be sent before the next one; 0 drops the older.
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
        moments: Number of moments sent or dropped so far, of all hands together.
        work: s of processor time that writing lines took, in the sender's thread.
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
        """Streams to the end of the source, then orders the other side to stop.

        Args:
            sender: Made with `greeting`.
            stop: Ends it early.

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
