"""`sandbox replay STUDY --verify`: nine points, a line each."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.markup import escape

from sandbox.study.record.folder import is_study
from sandbox.study.share.verify import verify
from sandbox.trial.replay import Verification


def study_folder(name: str, out: Path) -> Path | None:
    """The folder of a study with this name, here or in the folder of studies; None for others."""
    return next((path for path in (Path(name), out / name) if is_study(path)), None)


def verify_study(study: Path, console: Console, seals: Path | None = None) -> int:
    """Verifies a study, prints a line for each point and for all that is wrong.

    Args:
        study: Folder of the study.
        console: Where it is printed.
        seals: A copy of `notes/SITE.jsonl` that was kept elsewhere.

    Returns:
        The exit status.
    """
    done = verify(study, seals)
    for found in done.found.values():
        for finding in found:
            console.print(f"[red]{escape(str(finding))}[/]", highlight=False, soft_wrap=True)
    for note in done.notes:
        console.print(f"[dim]{escape(note)}[/]", highlight=False, soft_wrap=True)
    for line in done.lines():
        console.print(escape(line), highlight=False, soft_wrap=True)
    console.print(
        "[green]all is as it was written[/]" if done.sound else "[red]verification failed[/]"
    )
    return int(not done.sound)


def verdict(verification: Verification) -> str:
    """Returns the result of a replay in one line, with what has changed in the task since."""
    changed = escape(verification.task_change)
    if not changed:
        return _compared(verification)
    if verification.exact:
        return f"{_compared(verification)}; [yellow]yet {changed}[/]"
    return f"{_compared(verification)}[red]: {changed}[/]"


def _compared(verification: Verification) -> str:
    if verification.exact:
        whole = "" if verification.complete else ", up to where it breaks off"
        return f"[green]exact[/]: {verification.compared} states equal to the bit{whole}"
    if verification.compared == 0:
        return "[yellow]nothing to compare: the recording holds no input[/]"
    differs = f"differs[/] from physics step {verification.first_difference} on"
    if verification.same_machine:
        return f"[red]{differs}"
    return f"[yellow]{differs}, as it may: {elsewhere(verification)}"


def elsewhere(verification: Verification) -> str:
    """Differences between this machine and the recording's."""
    return f"it was recorded elsewhere; what differs is {' and '.join(verification.differs_in)}"
