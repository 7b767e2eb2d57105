"""Options of `sandbox study plan`, and what it says about power."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.console import Console

from models.errors import InputError

if TYPE_CHECKING:
    from sandbox.study.design.design import Design


@dataclass(frozen=True, kw_only=True)
class PlanOptions:
    """Shows the order of conditions for each participant, and how long sessions take.

    sandbox study plan design.toml --power --detect 15%
    """

    file: Annotated[Path, Parameter(metavar="DESIGN")] = field(kw_only=False)
    """Design file."""

    participants: Annotated[int | None, Parameter(metavar="N")] = None
    """Number of participants. Default: that of the design."""

    power: bool = False
    """Show which effects this number of participants can detect."""

    detect: Annotated[str, Parameter(metavar="CHANGE")] = ""
    """For --power: show how many participants are needed for a change of completion time such as
    15%."""

    spread: float = 0.30
    """For --power: standard deviation between people of the difference in log completion time
    between two conditions. A guess."""


def participants_of(asked: int | None, design: Design) -> int:
    """Number of participants that was asked for; that of the design without one.

    Raises:
        InputError: Nobody would take part.
    """
    if asked is None:
        return design.participants
    if asked < 1:
        raise InputError(
            "not a number of participants", where="--participants", got=asked, expected="1 or more"
        )
    return asked


def say_power(design: Design, options: PlanOptions, console: Console) -> None:
    """Says what can be detected, if asked to.

    Raises:
        InputError: An option has a wrong value, or needs another one.
    """
    if not 0.0 < options.spread < 10.0:
        raise InputError(
            "not a spread", where="--spread", got=options.spread, expected="between 0 and 10"
        )
    if not options.power:
        if options.detect:
            raise InputError("this option needs another one", where="--detect", expected="--power")
        return
    from sandbox.study.design.needed import change_of, power_lines

    change = change_of(options.detect) if options.detect else None
    people = participants_of(options.participants, design)
    for line in power_lines(design, people, options.spread, change):
        console.print(line, highlight=False, markup=False)
