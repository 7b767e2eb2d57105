"""Lines for the experimenter that several commands of `sandbox study` print."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from rich.console import Console
from rich.markup import escape

from models.message import counted

if TYPE_CHECKING:
    from sandbox.study.design.checks import Finding
    from sandbox.study.record.folder import StudyFolder


def say_findings(found: Iterable[Finding], console: Console) -> None:
    """Prints what is right in form and misleads, one line a cause."""
    for finding in found:
        colour = "red" if finding.error else "yellow"
        console.print(f"[{colour}]{escape(str(finding))}[/]", highlight=False)


def say_noted(study: StudyFolder, say: Callable[[str], object]) -> None:
    """Prints what has changed without a need to force an upgrade, if anything has."""
    if study.anew:
        changed = ", ".join(study.anew)
        say(f"nobody has taken part yet, so the study is now locked to what has changed: {changed}")
    if study.noted:
        say(f"noted, and no state depends on it: {', '.join(study.noted)}")


def sayer(console: Console) -> Callable[[str], object]:
    """Returns a function that prints a message for the experimenter at once."""

    def say(text: str) -> None:
        console.print(f"[dim]{escape(text)}[/]", highlight=False)
        sys.stdout.flush()

    return say


def print_copies(study: StudyFolder, console: Console) -> tuple[str, ...]:
    """Names folders inside of a study that are copies, and no data.

    Returns:
        Their names in the study.
    """
    from sandbox.study.record.copies import copies

    found = {copy.path.relative_to(study.path).as_posix(): copy for copy in copies(study.path)}
    for name, copy in found.items():
        line = f"{name} {copy}. Nothing of it counts"
        console.print(f"[yellow]{escape(line)}[/]", highlight=False, soft_wrap=True)
    return tuple(found)


def print_losses(study: StudyFolder, console: Console) -> tuple[str, ...]:
    """Says which sessions have lost something.

    Returns:
        Their participants, each once.
    """
    from sandbox.study.run.decisions import losses

    lost: dict[str, None] = {}
    for loss in losses(study):
        ppid = loss.person.ppid
        lost[ppid] = None
        other = "; others than were sealed" if loss.unlike else ""
        damaged = f"line {loss.damaged} of its record is damaged; " if loss.damaged else ""
        lines = "line from there on" if loss.damaged else "sealed line"
        more = "lines from there on" if loss.damaged else "sealed lines"
        console.print(
            f"[yellow]{ppid}, session {loss.session}: it is not what was written "
            f"({damaged}{counted(loss.records, lines, more)} lost{other}; "
            f"{counted(len(loss.found), 'whole recording')} without a record). Restore it from a "
            f"backup, or accept it: `sandbox study note {escape(str(study.path))} --participant "
            f'{ppid} --accept-loss "REASON"`[/]',
            soft_wrap=True,
            highlight=False,
        )
        for one in loss.found:
            what = f"trial {one.trial.number}" if one.trial else f"cannot count: {one.why_not}"
            console.print(f"[dim]  {one.file}: {what}[/]", highlight=False)
    return tuple(lost)
