"""`python -m training people`: makes a population of simulated people."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress

from models.errors import InputError
from models.message import counted
from sandbox.cli.common.command_line import parse
from sandbox.cli.common.json_out import check_output
from training.population import save_population, simulate_population
from training.population.population import PEOPLE


@dataclass(frozen=True, kw_only=True)
class PeopleOptions:
    """Makes captures of hundreds of SIMULATED people, on whom the files for any person are trained.

    People have their own bones, resting postures, habits and sensors. They come from both
    generators of simulated subjects, with settings drawn at random, and from random postures of
    random hands. By default there are people to train on, people to choose settings on, and people
    to judge on; no person is in two groups. The file's header contains their seeds and a digest.
    The same salt gives the same people.

    Try:

        python -m training people --group train --out people.npz
        python -m training names --population people.npz --out names.npz
    """

    out: Annotated[Path, Parameter(metavar="FILE")]
    """File for the population; an existing file is replaced."""

    salt: str = ""
    """Any text. Another text gives other people."""

    group: Literal["train", "choose", "judge", "all"] = "all"
    """Make the people of one group only."""

    share: float = 1.0
    """Make only this share of the people, above 0 to 1, for a quick test."""


def main(argv: list[str]) -> int:
    """Runs `python -m training people ...`."""
    options = parse(PeopleOptions, "python -m training people", argv)
    check_output(options.out, "--out")
    if not 0.0 < options.share <= 1.0:
        raise InputError(
            "the share of people is out of range",
            where="--share",
            got=options.share,
            expected="above 0 and up to 1",
        )
    groups = {
        group: {source: ceil(options.share * count) for source, count in sources.items()}
        for group, sources in PEOPLE.items()
        if options.group in (group, "all")
    }
    with bars() as progress:
        population = simulate_population(options.salt, groups, bar(progress, "people"))
    try:
        save_population(population, options.out)
    except OSError as error:
        raise InputError(
            "the population cannot be written", where=f"--out {options.out}", got=str(error)
        ) from error
    frames = sum(len(person) for person in population.people)
    Console().print(
        f"{escape(str(options.out))}: {counted(len(population.people), 'person', 'people')}, "
        f"{counted(frames, 'frame')}, digest {population.digest}, simulated",
        soft_wrap=True,
    )
    return 0


@contextmanager
def bars() -> Iterator[Progress]:
    """Progress bars on the terminal, which vanish when they are done; none if the output is not a
    terminal."""
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        yield progress


def bar(progress: Progress, what: str) -> Callable[[float], None]:
    """Adds a bar, and returns a function that sets the share done, 0 to 1."""
    task = progress.add_task(what, total=1.0)
    return lambda share: progress.update(task, completed=share)
