"""`sandbox replay STUDY --verify`: journals, recordings, tables and the lock; then every state."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from models.message import counted
from sandbox.recording.recording import load_recording
from sandbox.recording.versions import other_states
from sandbox.study.audit.audit import audit, is_study
from sandbox.study.audit.witness import read_witnesses
from sandbox.trial.replay import Verification, replay


def study_folder(name: str, out: Path) -> Path | None:
    """The folder of a study with this name, here or in the folder of studies; None for others."""
    return next((path for path in (Path(name), out / name) if is_study(path)), None)


def verify_study(study: Path, witnesses: tuple[Path, ...], console: Console) -> int:
    """Verifies a study, prints one line for everything that is wrong; returns the exit status.

    Raises:
        StudyError: A file of witnesses cannot be read.
    """
    known = {str(path): read_witnesses(path) for path in witnesses}
    found = audit(study, known)
    findings = found.findings
    for finding in findings.found:
        console.print(f"[red]{escape(str(finding))}[/]", highlight=False, soft_wrap=True)
    for note in findings.notes:
        console.print(f"[dim]{escape(note)}[/]", highlight=False, soft_wrap=True)
    differ, others = 0, Counter[str]()
    for path in found.finished:
        recording = load_recording(path)
        if reason := other_states(recording.header):
            others[reason] += 1
            continue
        _, verification = replay(recording)
        if not verified(verification):
            differ += 1
            name = escape(findings.name(path))
            console.print(f"{name}: {verdict(verification)}", highlight=False, soft_wrap=True)
    for reason, count in others.items():
        line = f"{counted(count, 'recording')} not replayed: {reason}"
        console.print(f"[yellow]{escape(line)}[/]", highlight=False, soft_wrap=True)
    findings.counts["recordings replayed"] = len(found.finished) - others.total()
    counts = ", ".join(f"{count} {name}" for name, count in findings.counts.items() if count)
    console.print(escape(counts), highlight=False, soft_wrap=True)
    wrong = not findings.sound or differ > 0
    console.print("[red]verification failed[/]" if wrong else "[green]all is as it was written[/]")
    return int(wrong)


def verified(verification: Verification) -> bool:
    """True if a recording is complete, and its states are equal or agree as another machine's."""
    agrees = (
        not verification.same_machine
        and verification.agreement is not None
        and verification.agreement.holds
    )
    return (verification.exact or agrees) and verification.complete


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
