"""Options of `sandbox study plan`, and what it says about power and a preregistration."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro
from rich.console import Console

from models.errors import InputError

if TYPE_CHECKING:
    from sandbox.study.design.design import Design
    from sandbox.study.planning.pilot import Pilot


@dataclass(frozen=True)
class PlanOptions:
    """Shows the order of conditions for each participant, and how long sessions take.

    sandbox study plan design.toml --power --from studies/NAME-pilot --detect 15%
    """

    file: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DESIGN")]
    """Design file."""

    participants: Annotated[int | None, tyro.conf.arg(metavar="N")] = None
    """Number of participants. Default: that of the design."""

    power: tyro.conf.FlagCreatePairsOff[bool] = False
    """Show which effects this number of participants can detect."""

    pilot: Annotated[Path | None, tyro.conf.arg(name="from", metavar="PILOT")] = None
    """For --power: folder of a pilot, whose spread between people and success rates are used. Its
    effects are not. Needs the extra `study`."""

    detect: Annotated[str, tyro.conf.arg(metavar="CHANGE")] = ""
    """For --power: show how many participants are needed for an effect such as 15%: of completion
    time, or 15 percentage points of success."""

    spread: float = 0.30
    """For --power without --from: standard deviation between people of the difference in log
    completion time between two conditions. A guess."""

    preregistration: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Write the text of a preregistration: design, participants, power, exclusions, analysis, and
    what the study is locked to. An existing file is never overwritten."""


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
    """Says what can be detected, and writes the preregistration, if asked to.

    Raises:
        InputError: An option has a wrong value, or needs another one.
        StudyError: The pilot cannot be read, or the file cannot be written.
    """
    if not 0.0 < options.spread < 10.0:
        raise InputError(
            "not a spread", where="--spread", got=options.spread, expected="between 0 and 10"
        )
    wanted = options.power or options.preregistration is not None
    if not wanted:
        if options.pilot or options.detect:
            raise InputError(
                "this option needs another one",
                where="--from" if options.pilot else "--detect",
                expected="--power",
            )
        return
    from sandbox.study.planning.needed import NO_PEOPLE, TO_WRITE, change_of, power_lines

    change = change_of(options.detect) if options.detect else None
    people = participants_of(options.participants, design)
    pilot = _pilot(design, options)
    about = (design, people, pilot, options.spread, change)
    nobody = {NO_PEOPLE} if pilot is None else {NO_PEOPLE, pilot.rehearsed}
    if options.power:
        for line in power_lines(*about):
            colour = "yellow" if line in nobody else None
            console.print(line, style=colour, highlight=False, markup=False)
    if options.preregistration is not None:
        from sandbox.study.planning.preregistration import write_preregistration

        lines = list(power_lines(*about, marked=True))
        write_preregistration(options.preregistration, design, people, lines)
        if not options.power:
            for line in lines:
                if line in nobody or line.startswith(TO_WRITE):
                    console.print(line, style="yellow", highlight=False, markup=False)
        console.print(f"{options.preregistration}: read it and complete it", markup=False)


def _pilot(design: Design, options: PlanOptions) -> Pilot | None:
    if options.pilot is None:
        return None
    from sandbox.study.design.planned import planned_tests
    from sandbox.study.planning.pilot import read_pilot
    from sandbox.study.report.make import check_libraries

    check_libraries()
    return read_pilot(options.pilot, planned_tests(design))
