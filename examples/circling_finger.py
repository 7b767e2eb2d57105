"""A custom touch device: fingers that move in circles. See docs/write-a-device.md.

sandbox touches show --device examples/circling_finger.py:CirclingFinger:3
"""

import math

from models import Contact, TouchFrame
from sandbox import TouchDevice


class CirclingFinger(TouchDevice):
    time = 0.0

    def __init__(self, surface, argument):
        super().__init__(surface, argument)
        self.fingers = int(argument or 1)  # other text gives a one-line error

    def poll(self, now):
        """Frames since the last call. Never waits: read a thread's queue, or compute."""
        width, height = self.surface.size
        frames = []
        while not self.finished and self.time <= now:
            contacts = []
            for i in range(self.fingers):
                angle = self.time + 2 * math.pi * i / self.fingers
                x = width * (0.5 + 0.3 * math.cos(angle))
                y = height * (0.5 + 0.3 * math.sin(angle))
                contacts.append(Contact(i, x, y))
            frames.append(TouchFrame(self.time, tuple(contacts)))
            self.time += 1 / 60
        return frames
