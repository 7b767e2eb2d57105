"""`sandbox capture report`: what a camera over a tablet saw of a volunteer's ten minutes."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from encoders.captures.conversion import ConversionReport, ConversionRules
from models.surface import parse_surface
from sandbox.captures.camera_report import lines_of, report_of
from sandbox.captures.recorded import read_session
from sandbox.cli.common.command_line import parse
from sandbox.cli.common.json_out import check_output, write_json
from sandbox.devices.files.paired_capture import read_requests


@dataclass(frozen=True, kw_only=True)
class ReportOptions:
    """Tells what a camera over a tablet saw: how many touches it named, how surely, and how often
    its names were those that the guide had asked for.

    Try:

        sandbox capture simulate --hands webcam --day 1 --out day
        sandbox capture report day
    """

    folder: Annotated[Path, Parameter(metavar="FOLDER")] = field(kw_only=False)
    """Folder by `sandbox capture record --hands webcam`."""

    surface: Annotated[str | None, Parameter(metavar="SIZE")] = None
    """Size of the touch surface, where the recording does not say it."""

    json: Annotated[Path | None, Parameter(metavar="OUT")] = None
    """File for all numbers as JSON; - is the terminal."""


def main(argv: list[str]) -> int:
    """Runs `sandbox capture report ...`."""
    options = parse(ReportOptions, "sandbox capture report", argv)
    check_output(options.json)
    surface = parse_surface(options.surface) if options.surface else None
    errors = Console(stderr=True)
    with errors.status("clocks, the tablet in the picture, names"):
        session = read_session(options.folder, surface)
        report = ConversionReport()
        named = session.names(ConversionRules(), report)
        asked = read_requests(options.folder)
        document = report_of(named, asked, session.about.simulated)
        document["subject"] = session.about.subject
        document["dropped_contacts"] = report.contacts
    for text in session.damage:
        errors.print(text, soft_wrap=True, markup=False)
    write_json(options.json, document, sort_keys=True)
    if options.json is None or str(options.json) != "-":
        for line in lines_of(document):
            print(line)
    return 0
