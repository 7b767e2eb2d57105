"""A touch device of one's own: fingers that run in circles. See docs/write-a-device.md.

sandbox touches show --device examples/circling_finger.py:CirclingFinger:3
"""

import math

from models.frames import Contact, TouchFrame


class CirclingFinger:
    name = "circling-finger"

    def __init__(self, surface, argument):
        """The surface tells its size; the argument is what stands after the name."""
        self.width, self.height = surface.size
        self.fingers = int(argument or 1)
        self.finished = False
        self.time = 0.0

    def poll(self, now):
        """Frames since the last call. Never waits: read a thread's queue, or compute."""
        frames = []
        while not self.finished and self.time <= now:
            contacts = []
            for i in range(self.fingers):
                angle = self.time + 2 * math.pi * i / self.fingers
                x = self.width * (0.5 + 0.3 * math.cos(angle))
                y = self.height * (0.5 + 0.3 * math.sin(angle))
                contacts.append(Contact(i, x, y))
            frames.append(TouchFrame(self.time, tuple(contacts)))
            self.time += 1 / 60
        return frames

    def close(self):
        self.finished = True
