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
    """Makes all files that ship into a folder, and compares them with the shipped ones. Exit status
    1 if one differs by more than rounding.

    Try:

        python -m training all --out made
    """

    out: Annotated[Path, Parameter(metavar="FOLDER")]
    """Folder for the files; it is made if there is none."""

    population: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """People to train on, by `python -m training people`. Default: they are made anew."""


def main(argv: list[str]) -> int:
    """Runs `python -m training all ...`."""
    options = parse(AllOptions, "python -m training all", argv)
    people = people_to_train_on(options.population)
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            "the folder cannot be made", where=f"--out {options.out}", got=str(error)
        ) from error
    agree = [make(name, options.out / file.file.name, people) for name, file in FILES.items()]
    return 0 if all(agree) else 1
