"""Films of the tasks, played by the simulated user.

    python -m tools.docs.task_films                # draws the missing films
    python -m tools.docs.task_films NAME ...       # draws the films of these tasks again

Needs OpenGL. A film shows the first seed that succeeds, and the name of its file ends with this
seed.
"""

from __future__ import annotations

import argparse
import re
import sys
from dataclasses import dataclass
from math import ceil
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from models.errors import HandSandboxError, InputError
from sandbox import run_trial
from tasks.registry import TASKS

ROOT = Path(__file__).resolve().parents[2]
FILMS = ROOT / "docs" / "pictures" / "tasks"
SIZE = (480, 270)
"""Width and height (px) of a film."""
RATE = 15.0
"""Number of pictures per second of simulated time, as in `run_trial`."""
MOST_FRAMES = 60
"""Largest number of frames in a film. A longer film has fewer frames per second."""
SEEDS = 20
"""Number of seeds that are tried until one succeeds."""
WHOLE_HAND = ("books",)
"""Tasks whose films are played with a hand that is solid as a whole."""
QUALITY = 55
"""Quality of WebP, 0 to 100."""


@dataclass(frozen=True)
class TaskFilm:
    """A film in the repository.

    Attributes:
        path: Its file.
        task: Name of the task.
        seed: Seed of the trial.
    """

    path: Path
    task: str
    seed: int

    @property
    def command(self) -> str:
        """The command that plays the same trial and films it."""
        solid = " --solid hand" if self.task in WHOLE_HAND else ""
        return f"sandbox run {self.task} --seed {self.seed}{solid} --film {self.task}.webp"


def film_of(task: str) -> TaskFilm | None:
    """The film of a task in the repository; None if there is none."""
    for path in sorted(FILMS.glob(f"{task}-*.webp")):
        if match := re.fullmatch(rf"{re.escape(task)}-(\d+)", path.stem):
            return TaskFilm(path, task, int(match[1]))
    return None


def draw(task: str) -> TaskFilm:
    """Draws the film of a task, and replaces an earlier film.

    Raises:
        InputError: No seed succeeds.
        GraphicsError: This machine has no OpenGL.
    """
    for seed in range(SEEDS):
        solid = "hand" if task in WHOLE_HAND else "fingertips"
        run = run_trial(task, seed=seed, solid=solid, pictures=SIZE, trajectories=False)
        if not run.success:
            continue
        assert run.pictures is not None
        old = film_of(task)
        if old is not None:
            old.path.unlink()
        FILMS.mkdir(parents=True, exist_ok=True)
        film = TaskFilm(FILMS / f"{task}-{seed}.webp", task, seed)
        _write(run.pictures, film.path)
        return film
    raise InputError("no seed succeeds", where=task, got=f"{SEEDS} failures")


def _write(pictures: NDArray[np.uint8], path: Path) -> None:
    step = ceil(len(pictures) / MOST_FRAMES)
    frames = [Image.fromarray(picture) for picture in pictures[::step]]
    each = round(1000 * step / RATE)
    frames[0].save(
        path, save_all=True, append_images=frames[1:], duration=each, loop=0, quality=QUALITY
    )


def main() -> int:
    """Draws films; returns 2 if one cannot be drawn."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("tasks", nargs="*", metavar="NAME", choices=[*TASKS, []])
    asked = parser.parse_args().tasks
    try:
        for task in asked or [name for name in TASKS if film_of(name) is None]:
            film = draw(task)
            print(f"{film.path.relative_to(ROOT)}: {film.path.stat().st_size / 1000:.0f} kB")
    except HandSandboxError as error:
        print(f"task_films: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
