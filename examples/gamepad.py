"""A Linux gamepad whose two sticks are two fingers: a device with its own option.

sandbox play box-to-goal --device examples/gamepad.py:GAMEPAD --dead-zone 0.2
"""

import os
import struct
from dataclasses import dataclass, field

from models import Contact, DeviceError, TouchFrame
from sandbox import DeviceEntry, TouchDevice

NODE = "/dev/input/js0"  # the first gamepad
EVENT = struct.Struct("IhBB")  # time in ms, value, kind, number of the axis or button
BUTTON, AXIS = 1, 2
STICKS = ((0, 1), (3, 4))  # the axes of the left and the right stick: x and y
SHOULDERS = (4, 5)  # a button is held: the finger of its stick is down
SPEED = 0.15  # m/s, of a finger whose stick is pushed to its end


@dataclass(frozen=True)
class GamepadOptions:
    """Options of the gamepad."""

    dead_zone: float = field(default=0.1, metadata={"metavar": "SHARE"})
    """Share (0 to 1) of a stick's range in which the stick counts as at rest."""


class Gamepad(TouchDevice):
    name = "gamepad"
    clock_origin = None  # frames have the session's time, not a clock of their own

    def __init__(self, surface, node, dead_zone):
        super().__init__(surface, node)
        self.dead_zone = dead_zone
        try:
            self.node = os.open(node, os.O_RDONLY | os.O_NONBLOCK)
        except OSError as error:
            raise DeviceError("no gamepad", where=node, got=error.strerror) from None
        self.state = {}  # (BUTTON or AXIS, number) -> value
        self.rest = b""  # first bytes of an event that is not complete yet
        self.error = None  # the error when the gamepad was disconnected
        self.places = [[0.35, 0.5], [0.65, 0.5]]  # of the fingers, as shares of the surface
        self.ids = [None, None]
        self.time, self.touches = 0.0, 0

    def poll(self, now):
        """Returns one frame for every call, with the fingers that touch at the time `now` (s)."""
        if self.finished:
            return []
        if self.error:
            raise self.error
        self.read()
        if self.error:  # cancels all touches now; the next poll raises the error
            return [TouchFrame(now, cancelled=frozenset(id for id in self.ids if id is not None))]
        passed, self.time = now - self.time, now
        size, contacts = self.surface.size, []
        for finger, place in enumerate(self.places):
            for k, axis in enumerate(STICKS[finger]):
                held = self.state.get((AXIS, axis), 0) / 32767
                if abs(held) > self.dead_zone:
                    place[k] = min(max(place[k] + SPEED * held * passed / size[k], 0.0), 1.0)
            if not self.state.get((BUTTON, SHOULDERS[finger])):
                self.ids[finger] = None
                continue
            if self.ids[finger] is None:  # a new touch gets an id that no touch had before
                self.ids[finger], self.touches = self.touches, self.touches + 1
            contacts.append(Contact(self.ids[finger], place[0] * size[0], place[1] * size[1]))
        return [TouchFrame(now, tuple(contacts))]

    def read(self):
        """Reads the events that have arrived; does not wait for more."""
        try:
            while data := os.read(self.node, 64 * EVENT.size):
                data = self.rest + data
                whole = len(data) - len(data) % EVENT.size
                self.rest = data[whole:]
                for _, value, kind, number in EVENT.iter_unpack(data[:whole]):
                    self.state[kind & 3, number] = value  # 128 marks the state at the beginning
        except BlockingIOError:
            pass
        except OSError as error:
            self.error = DeviceError(
                "the gamepad was disconnected", where=self.argument, got=error.strerror
            )

    def close(self):
        if not self.finished:
            os.close(self.node)
        super().close()


GAMEPAD = DeviceEntry(
    "a gamepad whose two sticks are two fingers",
    lambda options, place: Gamepad(place.surface, place.argument or NODE, options.dead_zone),
    GamepadOptions,
    argument="NODE",
)
