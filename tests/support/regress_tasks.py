"""Tasks that are over in a blink, for tests of what runs them: success is a matter of the seed."""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path
from typing import ClassVar

from models.surface import Surface
from tasks.box_to_goal import BoxToGoal
from tasks.sensing import Sensing
from tasks.task import Measure


class Quick(BoxToGoal):
    """Every third seed fails."""

    name: ClassVar[str] = "quick"
    time_limit: ClassVar[float] = 0.3
    hold_time: ClassVar[float] = 0.1

    def measure(self, sensing: Sensing) -> Measure:
        if self.seed % 3 == 0:
            return Measure(False, 0.25, "this seed <fails> & says so")
        return Measure(True, 1.0, "")


class Worse(Quick):
    """All seeds fail: what Quick may have become after a change."""

    def measure(self, sensing: Sensing) -> Measure:
        return Measure(False, 0.0, "it fails now")


class NoPlace(Quick):
    """Its own code finds no place for seed 2."""

    name: ClassVar[str] = "no-place"

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> BoxToGoal:
        if seed == 2:
            raise ValueError("no room for the box")
        return super().draw(seed, surface)


class Newer(Quick):
    """Another version."""

    version: ClassVar[int] = 2


class Dying(Quick):
    """The process of seed 1 is killed, as by a lack of memory, and that of seed 2 exits."""

    name: ClassVar[str] = "dying"

    def measure(self, sensing: Sensing) -> Measure:
        if self.seed == 1:
            os.kill(os.getpid(), signal.SIGKILL)
        if self.seed == 2:
            os._exit(7)
        return super().measure(sensing)


class Raising(Quick):
    """Seed 1 has a bug."""

    name: ClassVar[str] = "raising"

    def measure(self, sensing: Sensing) -> Measure:
        if self.seed == 1:
            raise ZeroDivisionError("a lab's own bug")
        return super().measure(sensing)


class StoppingOnce(Quick):
    """Somebody presses Ctrl-C twice during the first seed 2."""

    name: ClassVar[str] = "stopping"
    interrupts: ClassVar[int] = 0

    def measure(self, sensing: Sensing) -> Measure:
        if self.seed == 2 and StoppingOnce.interrupts < 2:
            StoppingOnce.interrupts += 1
            signal.raise_signal(signal.SIGINT)
        return super().measure(sensing)


class Exiting(Quick):
    """Seed 1 ends the program, and says that all is well."""

    name: ClassVar[str] = "exiting"

    def measure(self, sensing: Sensing) -> Measure:
        if self.seed == 1:
            sys.exit(0)
        return super().measure(sensing)


HELD = "HAND_SANDBOX_TEST_HELD"
"""Environment variable with a folder; while it has a file `hold`, seeds from 4 on wait."""


class Held(Quick):
    """Seeds from 4 on say in the folder which process runs them, and wait."""

    name: ClassVar[str] = "held"

    def measure(self, sensing: Sensing) -> Measure:
        if self.seed >= 4 and (folder := os.environ.get(HELD)):
            Path(folder, f"{self.seed}.pid").write_text(str(os.getpid()))
            while Path(folder, "hold").exists():
                time.sleep(0.01)
        return super().measure(sensing)
