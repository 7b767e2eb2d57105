"""`python -m training all`: makes all files that ship, into a folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from models.errors import InputError
from sandbox.cli.common.command_line import parse
from training.cli.shipped_file import make, people_to_train_on
from training.shipped import FILES


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


def main(argv: list[str]) -> int:
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
