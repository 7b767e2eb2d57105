"""`python -m training capture`, `names`, `skin` and so on, and `all`: makes one file that ships or
all of them, and compares each with the shipped file."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.errors import InputError
from sandbox.cli.common.command_line import parse
from sandbox.cli.common.json_out import check_output, refuse_replacing
from training.cli.people import bar, bars
from training.population import Population, load_population, simulate_population
from training.population.population import PEOPLE
from training.shipped import FILES, Inputs, compared


@dataclass(frozen=True, kw_only=True)
class FileOptions:
    """Makes a file that ships, and compares it with the shipped file. The exit status is 1 if they
    differ by more than rounding; the file is written in any case.

    Try:

        python -m training linear --out linear.npz
    """

    out: Annotated[Path, Parameter(metavar="FILE")]
    """Path of the new file. To ship it, name its place in the checkout."""


@dataclass(frozen=True, kw_only=True)
class PeopleFileOptions:
    """Trains a file that ships on simulated people, and compares it with the shipped file. The exit
    status is 1 if they differ by more than rounding; the file is written in any case.

    Try:

        python -m training people --group train --out people.npz
        python -m training names --population people.npz --out names.npz
    """

    out: Annotated[Path, Parameter(metavar="FILE")]
    """Path of the new file. To ship it, name its place in the checkout."""

    population: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """People to train on, written by `python -m training people`. Default: simulate them again."""


@dataclass(frozen=True, kw_only=True)
class AllOptions:
    """Makes all files that ship, in a folder, and compares them with the shipped files. The exit
    status is 1 if a file differs by more than rounding.

    Try:

        python -m training all --out made
    """

    out: Annotated[Path, Parameter(metavar="FOLDER")]
    """Folder for the files; it is created if it does not exist."""

    population: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """People to train on, written by `python -m training people`. Default: simulate them again."""


def make_one(name: str, argv: list[str]) -> int:
    """Runs the command of a file, `python -m training NAME ...`."""
    file, prog = FILES[name], f"python -m training {name}"
    population = None
    if file.on_people:
        chosen = parse(PeopleFileOptions, prog, argv)
        out, population = chosen.out, chosen.population
    else:
        out = parse(FileOptions, prog, argv).out
    check_output(out, "--out")
    refuse_replacing(out, {"--population": population})
    return 0 if make(name, out, people_to_train_on(population)) else 1


def make_all(argv: list[str]) -> int:
    """Runs `python -m training all ...`."""
    options = parse(AllOptions, "python -m training all", argv)
    people = people_to_train_on(options.population)
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            "the folder cannot be created", where=f"--out {options.out}", got=str(error)
        ) from error
    agree = [make(name, options.out / file.file.name, people) for name, file in FILES.items()]
    return 0 if all(agree) else 1


def people_to_train_on(file: Path | None) -> Callable[[], Population]:
    """Function that returns the people of a file, or simulates them when it is first called.

    Args:
        file: A population written by `python -m training people`; None simulates people.

    Raises:
        CaptureError: The file is missing, damaged or of another version.
    """
    if file is not None:
        population = load_population(file)
        return lambda: population

    @cache
    def simulated() -> Population:
        with bars() as progress:
            return simulate_population(
                "", {"train": PEOPLE["train"]}, bar(progress, "people to train on")
            )

    return simulated


def make(name: str, out: Path, people: Callable[[], Population]) -> bool:
    """Makes a file, writes it and prints the comparison with the shipped file.

    Args:
        name: Name of the file's command.
        out: Path of the new file.
        people: Function that returns the people to train on.

    Returns:
        True if the file agrees with the shipped file.

    Raises:
        InputError: The file cannot be written.
    """
    file = FILES[name]
    population = people() if file.on_people else None
    with TemporaryDirectory() as folder:
        made = Path(folder) / file.file.name
        with bars() as progress:
            file.make(made, Inputs(population, bar(progress, name)))
        # The comparison comes first, since writing may replace the shipped file.
        comparison = compared(made, file.file, file.compare)
        try:
            shutil.copyfile(made, out)
        except OSError as error:
            raise InputError(
                "the file cannot be written", where=f"--out {out}", got=str(error)
            ) from error
    verdict = "[green]agrees[/] with" if comparison.agrees else "[red]differs[/] from"
    Console().print(
        f"{escape(str(out))} {verdict} {file.path}: {comparison.how}",
        soft_wrap=True,
    )
    return comparison.agrees
