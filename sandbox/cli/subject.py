"""`sandbox subject`: makes captures of a simulated subject."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import tyro
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress

from encoders.captures.subject import FROZEN, SEED, simulate
from encoders.store import save_capture
from models.errors import InputError
from models.messages.wording import counted
from sandbox.cli.common.parse import parse
from training.population import save_population, simulate_population
from training.population.population import PEOPLE


@dataclass(frozen=True)
class SubjectOptions:
    """Makes a capture of a SIMULATED subject: touches of its fingers, and poses of its hand.

    The simulated subject replaces the motion capture of a person, since no such recording is
    public; its data are never real. Every seed is another subject. Day 0 is the training script:
    all 26 sets of 2 to 5 fingers, each moving, grasping, pinching and rotating, 7,083 frames.
    Every later day is free play with newly placed markers, 2,538 frames, for tests. The same seed
    and day make the same file. A capture is an .npz file: time (s), trial, ids, xy (m on the
    surface, x right, y down, by finger), q (48 numbers in m and rad), and a header.

    `sandbox subject population` makes hundreds of people at once.

    Try:

        sandbox subject --seed 7 --day 0 --out training.npz
        sandbox train --capture training.npz --out mine.npz
    """

    out: Annotated[Path, tyro.conf.arg(metavar="FILE")]
    """File for the capture; an existing file is replaced."""

    seed: int = SEED
    """Number of the subject. The built-in models are trained on subject 0."""

    day: int = 0
    """Day: 0 is the training script, 1 and later are free play."""


@dataclass(frozen=True)
class PopulationOptions:
    """Makes captures of hundreds of SIMULATED people, to train names of fingers for any person.

    People have their own bones, resting postures, habits and sensors. They come from both
    generators of simulated subjects with settings drawn at random, and from random postures of
    random hands. By default there are people to train on, people to choose settings on, and people
    to judge on; nobody is in two groups. The file's header has their seeds and a digest. The same
    salt gives the same people.

    Try:

        sandbox subject population --out people.npz
        sandbox train --population people.npz --out names.npz
        sandbox train --population people.npz --part pose --out population.npz
    """

    out: Annotated[Path, tyro.conf.arg(metavar="FILE")]
    """File for the population; an existing file is replaced."""

    salt: str = ""
    """Any text; another one draws other people."""

    group: Literal["train", "choose", "judge", "all"] = "all"
    """Make the people of one group only."""

    share: float = 1.0
    """Make this share of the people only, 0 to 1, for a quick try."""


def main(argv: list[str]) -> int:
    """Runs `sandbox subject ...`."""
    if argv[:1] == ["population"]:
        return _population(argv[1:])
    options = parse(SubjectOptions, "sandbox subject", argv)
    if not options.out.absolute().parent.is_dir():
        raise InputError(
            "no such folder", where=f"--out {options.out}", remedy="Make it, or name another"
        )
    console = Console()
    bars = Console(stderr=True)
    with Progress(console=bars, transient=True, disable=not bars.is_terminal) as progress:
        bar = progress.add_task(f"subject {options.seed}, day {options.day}", total=1.0)
        capture = simulate(
            FROZEN, options.seed, options.day, lambda share: progress.update(bar, completed=share)
        )
    try:
        save_capture(capture, options.out, np.float32)
    except OSError as error:
        raise InputError(
            "the capture cannot be written", where=f"--out {options.out}", got=str(error)
        ) from error
    fingers = capture.down.sum(axis=1)
    split = ", ".join(f"{(fingers == n).sum():,} with {n}" for n in range(2, 6))
    console.print(
        f"{escape(str(options.out))}: {len(capture):,} frames at {capture.meta['rate_hz']:g} Hz in "
        f"{len(np.unique(capture.trial))} takes ({split} fingers), simulated",
        soft_wrap=True,
    )
    return 0


def _population(argv: list[str]) -> int:
    options = parse(PopulationOptions, "sandbox subject population", argv)
    if not options.out.absolute().parent.is_dir():
        raise InputError(
            "no such folder", where=f"--out {options.out}", remedy="Make it, or name another"
        )
    if not 0.0 < options.share <= 1.0:
        raise InputError("not a share", where="--share", got=options.share, expected="0 to 1")
    groups = {
        group: {source: ceil(options.share * count) for source, count in sources.items()}
        for group, sources in PEOPLE.items()
        if options.group in (group, "all")
    }
    console = Console()
    bars = Console(stderr=True)
    with Progress(console=bars, transient=True, disable=not bars.is_terminal) as progress:
        bar = progress.add_task("people", total=1.0)
        population = simulate_population(
            options.salt, groups, lambda share: progress.update(bar, completed=share)
        )
    try:
        save_population(population, options.out)
    except OSError as error:
        raise InputError(
            "the population cannot be written", where=f"--out {options.out}", got=str(error)
        ) from error
    frames = sum(len(person) for person in population.people)
    console.print(
        f"{escape(str(options.out))}: {counted(len(population.people), 'person', 'people')}, "
        f"{counted(frames, 'frame')}, digest {population.digest}, simulated",
        soft_wrap=True,
    )
    return 0
