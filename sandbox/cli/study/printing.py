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
    """Prints the findings of `checks.findings`, one line each."""
    for finding in found:
        colour = "red" if finding.error else "yellow"
        console.print(f"[{colour}]{escape(str(finding))}[/]", highlight=False)


def say_noted(study: StudyFolder, say: Callable[[str], object]) -> None:
    """Prints changes of the program or design that were accepted without `--force-upgrade`."""
    if study.anew:
        changed = ", ".join(study.anew)
        say(f"the study has no participant yet, so these changes are accepted: {changed}")
    if study.noted:
        say(f"recorded; no state depends on these changes: {', '.join(study.noted)}")


def sayer(console: Console) -> Callable[[str], object]:
    """Returns a function that prints a message for the experimenter at once."""

    def say(text: str) -> None:
        console.print(f"[dim]{escape(text)}[/]", highlight=False)
        sys.stdout.flush()

    return say


def print_copies(study: StudyFolder, console: Console) -> tuple[str, ...]:
    """Prints the folders inside of a study that are copies of other folders.

    Returns:
        Paths of these folders, relative to the study.
    """
    from sandbox.study.record.copies import copies

    found = {copy.path.relative_to(study.path).as_posix(): copy for copy in copies(study.path)}
    for name, copy in found.items():
        line = f"{name} {copy}. Its data do not count"
        console.print(f"[yellow]{escape(line)}[/]", highlight=False, soft_wrap=True)
    return tuple(found)


def print_losses(study: StudyFolder, console: Console) -> tuple[str, ...]:
    """Prints the sessions whose records are missing or changed.

    Returns:
        Pseudonyms of the participants of these sessions.
    """
    from sandbox.study.run.decisions import losses

    lost: dict[str, None] = {}
    for loss in losses(study):
        ppid = loss.person.ppid
        lost[ppid] = None
        other = "; sealed lines have changed" if loss.unlike else ""
        damaged = f"line {loss.damaged} of its journal is damaged; " if loss.damaged else ""
        lines = "line from there on" if loss.damaged else "sealed line"
        more = "lines from there on" if loss.damaged else "sealed lines"
        console.print(
            f"[yellow]{ppid}, session {loss.session}: records are missing or changed "
            f"({damaged}{counted(loss.records, lines, more)} lost{other}; "
            f"{counted(len(loss.found), 'whole recording')} without a record). Restore the session "
            f"from a backup, or accept the loss: `sandbox study note {escape(str(study.path))} "
            f'--participant {ppid} --accept-loss "REASON"`[/]',
            soft_wrap=True,
            highlight=False,
        )
        for one in loss.found:
            what = f"trial {one.trial.number}" if one.trial else f"cannot count: {one.why_not}"
            console.print(f"[dim]  {one.file}: {what}[/]", highlight=False)
    return tuple(lost)
