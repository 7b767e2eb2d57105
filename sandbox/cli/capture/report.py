"""`sandbox capture report`: evaluates a recording of touches under a camera."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter
from rich.console import Console

from encoders.captures.conversion import ConversionReport, ConversionRules
from encoders.captures.overhead.capture_from_camera import NamedTouches
from encoders.captures.overhead.naming import NamedContact
from models.frames import FINGERS
from models.surface import parse_surface
from sandbox.captures.recorded import read_session
from sandbox.cli.common.command_line import parse
from sandbox.cli.common.json_out import check_output, write_json
from sandbox.devices.files.paired_capture import RequestedFingers, read_requests

SETTLED = 0.3
"""Time for which the requested number of fingers must be down before touches count, s."""
SCHEMA = 1


@dataclass(frozen=True)
class RequestAgreement:
    """Agreement of labels with the fingers that `sandbox capture record` asked the person to use.

    The counts include only contacts that were down while the requested number of fingers touched.

    Attributes:
        contacts: Number of these contacts.
        named: Number of these contacts with a label.
        as_asked: Number of these contacts with the label of a requested finger.
    """

    contacts: int
    named: int
    as_asked: int


def report_of(
    named: NamedTouches, asked: Sequence[RequestedFingers], simulated: bool
) -> dict[str, Any]:
    """Returns the report as JSON values.

    Args:
        named: Touches, labelled by the camera.
        asked: Requests of `sandbox capture record`, on the touches' clock.
        simulated: True if no person took part.
    """
    contacts = named.contacts
    with_name = [c for c in contacts if c.finger is not None]
    why: dict[str, int] = {}
    for one in contacts:
        if one.finger is None:
            why[one.why] = why.get(one.why, 0) + 1
    agreement = agreement_of(contacts, asked)
    distances = [1000.0 * c.distance for c in with_name]
    return {
        "schema": SCHEMA,
        "simulated": simulated,
        "touches": len(contacts),
        "named": len(with_name),
        "unnamed": why,
        "by_finger": {n: sum(c.finger == f for c in contacts) for f, n in enumerate(FINGERS)},
        "doubt_percent": {
            "mean": round(100.0 * float(np.mean([1.0 - c.share.max() for c in with_name])), 3),
            "worst": round(100.0 * max(1.0 - float(c.share.max()) for c in with_name), 2),
        },
        "touch_to_pad_mm": {
            "median": round(float(np.median(distances)), 1),
            "95_percent": round(float(np.percentile(distances, 95)), 1),
        },
        "clocks_offset_s": round(named.clock.offset, 4),
        "hand_seen_percent": round(100.0 * named.seen, 1),
        "pictures_per_s": round(float(1.0 / np.median(np.diff(named.pictures.time))), 1),
        "asked": None if agreement is None else asdict(agreement),
    }


def agreement_of(
    contacts: Sequence[NamedContact], asked: Sequence[RequestedFingers]
) -> RequestAgreement | None:
    """Compares labels with the requested fingers; returns None if there were no requests."""
    if not asked:
        return None
    counted = named = right = 0
    for one in contacts:
        time = _when_as_many(one, contacts, asked)
        if time is None:
            continue
        counted += 1
        named += one.finger is not None
        right += one.finger in _requested_at(asked, time)
    return RequestAgreement(counted, named, right)


def _requested_at(asked: Sequence[RequestedFingers], time: float) -> list[int]:
    before = [a for a in asked if a.host <= time]
    return before[-1].asked if before else []


def _when_as_many(
    one: NamedContact, contacts: Sequence[NamedContact], asked: Sequence[RequestedFingers]
) -> float | None:
    """Returns a time (s) at which a contact can be compared with the requested fingers.

    At this time exactly the requested number of contacts is down, `one` among them, and all have
    been down for `SETTLED`. Returns None if there is no such time.
    """
    track = one.track
    time = track.start + SETTLED
    while time < track.end:
        begin = time - SETTLED
        wanted = _requested_at(asked, time)
        down = [c for c in contacts if c.track.start <= time < c.track.end]
        whole = [c for c in down if c.track.start <= begin]
        if (
            wanted
            and wanted == _requested_at(asked, begin)
            and len(down) == len(whole) == len(wanted)
        ):
            return time
        time += SETTLED / 3.0
    return None


def lines_of(report: dict[str, Any]) -> list[str]:
    """Returns the report as sentences."""
    share = 100.0 * report["named"] / max(report["touches"], 1)
    out = []
    if report["simulated"]:
        out.append("SIMULATED: no person and no camera took part.")
    out.append(
        f"{report['touches']} touches, {report['named']} labelled by the camera ({share:.1f} %): "
        + ", ".join(f"{n} {k}" for k, n in report["by_finger"].items())
    )
    out += [f"not labelled, {why}: {n}" for why, n in report["unnamed"].items()]
    doubt, miss = report["doubt_percent"], report["touch_to_pad_mm"]
    out.append(
        f"probability that a label is wrong: {doubt['mean']:g} % on average, "
        f"{doubt['worst']:g} % at most"
    )
    out.append(
        f"distance of a touch from its fingertip in the picture: {miss['median']:g} mm (median; "
        f"95 % within {miss['95_percent']:g} mm)"
    )
    out.append(
        f"the hand was seen in {report['hand_seen_percent']:g} % of pictures, "
        f"{report['pictures_per_s']:g} a second; pictures are "
        f"{1000 * report['clocks_offset_s']:.0f} ms later than touches"
    )
    asked = report["asked"]
    if asked is None:
        out.append("no comparison with requested fingers: this recording has no requests")
    elif asked["named"]:
        out.append(
            f"while the requested number of fingers was down: {asked['as_asked']} of "
            f"{asked['named']} labels are a requested finger "
            f"({100.0 * asked['as_asked'] / asked['named']:.1f} %), "
            f"{asked['contacts'] - asked['named']} touches are not labelled"
        )
    out.append("these numbers compare labels with requests; they do not prove labels right")
    return out


@dataclass(frozen=True, kw_only=True)
class ReportOptions:
    """Prints how many touches a camera over a tablet labelled, with which probability, and how
    often the labels were fingers that the guide had requested.

    Try:

        sandbox capture simulate --hands webcam --day 1 --out day
        sandbox capture report day
    """

    folder: Annotated[Path, Parameter(metavar="FOLDER")] = field(kw_only=False)
    """Folder made by `sandbox capture record --hands webcam`."""

    surface: Annotated[str | None, Parameter(metavar="SIZE")] = None
    """Size of the touch surface, if the recording does not contain it."""

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
