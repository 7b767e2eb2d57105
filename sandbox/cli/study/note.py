"""`sandbox study note`: decisions about participants after their sessions, and remarks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.errors import InputError, StudyError
from models.message import counted
from sandbox.cli.study.printing import print_copies, print_losses, sayer

if TYPE_CHECKING:
    from sandbox.study.record.folder import StudyFolder

Reason = Annotated[str, Parameter(metavar="REASON")]


@dataclass(frozen=True, kw_only=True)
class NoteOptions:
    """Notes a decision about a participant, or a remark, and derives the tables again.

    Try: sandbox study note studies/NAME --participant B5G5T3 --exclude "did not follow the task"

    --include takes an exclusion back. Somebody whose number was freed has it again, or the next
    free one if a newcomer has got it. --withdraw and --accept-loss
    cannot be undone.
    """

    folder: Annotated[Path, Parameter(metavar="DIR")] = field(kw_only=False)
    """Folder of the study."""

    participant: Annotated[str, Parameter(metavar="ID")]
    """Pseudonym of the participant."""

    session: Annotated[int, Parameter(metavar="N")] = 1
    """Session of --trial."""

    trial: Annotated[int | None, Parameter(metavar="N")] = None
    """Number of the trial that the decision is about. Default: all of the participant."""

    exclude: Reason = ""
    """Leave the trial, or all trials, out of the results; nothing is deleted."""

    include: Reason = ""
    """Take an exclusion back."""

    release: Reason = ""
    """Free the number of the participant, and with it the orders, for the next newcomer."""

    remark: Annotated[str, Parameter(metavar="TEXT")] = ""
    """A remark for the tables and the report."""

    withdraw: bool = False
    """Delete all data of the participant, who withdraws consent. The pseudonym is typed again."""

    accept_loss: Reason = ""
    """Go on with a session that is not what was sealed. Recordings without a record become trials
    where they fit the plan; the tables of before stay."""


DECISIONS = ("exclude", "include", "release", "remark", "withdraw", "accept_loss")


def note(options: NoteOptions, console: Console) -> int:
    """Runs `sandbox study note`."""
    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.record.pseudonym import read_pseudonym
    from sandbox.study.run.decisions import decide
    from sandbox.study.tables.tables import make_tables

    given = [name for name in DECISIONS if getattr(options, name)]
    names = [f"--{name.replace('_', '-')}" for name in DECISIONS]
    if len(given) != 1:
        raise InputError(
            "one decision is needed",
            where="sandbox study note",
            got=", ".join(f"--{name.replace('_', '-')}" for name in given) or None,
            expected=f"one of {', '.join(names)}",
        )
    (kind,) = given
    if options.trial is not None and kind not in ("exclude", "include", "remark"):
        raise InputError(
            "this is about a participant, not a trial", where=f"--{kind.replace('_', '-')}"
        )
    study = StudyFolder.at(options.folder)
    print_copies(study, console)
    try:
        ppid = read_pseudonym(options.participant)
    except StudyError:
        # One line for every id that nobody here has, whether it is whole or not.
        ppid = options.participant
    if kind == "withdraw":
        return _withdraw(study, ppid, console)
    study.find(ppid)
    say = sayer(console)
    if kind == "accept_loss":
        return _accept_loss(study, ppid, options.accept_loss, console)
    if print_losses(study, console):
        console.print("[yellow]until that is decided, nothing else is[/]")
        return 1
    if kind == "release":
        study.release(ppid, options.release)
    else:
        session = None if options.trial is None else options.session
        said = decide(study, ppid, kind, getattr(options, kind), session, options.trial)
        if said:
            say(said)
    make_tables(study, say)
    about = ppid if options.trial is None else f"{ppid}, trial {options.trial}"
    console.print(f"{about}: noted, and in all tables", highlight=False)
    return 0


def _withdraw(study: StudyFolder, ppid: str, console: Console) -> int:
    from sandbox.study.record.notes import withdrawn
    from sandbox.study.share.withdraw import withdraw

    if ppid not in withdrawn(study.records()):
        study.find(ppid)
    console.print(
        f"Everything of {ppid} in {escape(str(study.path))} will be deleted; this cannot be "
        "undone. Type the id again, then Enter"
    )
    try:
        answer = input()
    except EOFError:
        raise StudyError(
            "the input has ended, so that nobody can type the id; nothing was deleted",
            where="the terminal",
            remedy="Run the command in a terminal",
        ) from None
    if answer.strip().upper() != ppid:
        console.print("nothing was deleted")
        return 1
    deleted = withdraw(study, ppid)
    remains = ", what an earlier withdrawal had left" if deleted.before else ""
    console.print(f"{ppid}: {deleted.files} files deleted{remains}")
    if deleted.still:
        console.print(
            "[yellow]these files still name the participant, or may, since they are "
            "damaged; make them anew, or delete them:[/]"
        )
    for line in _by_folder(study.path, deleted.still):
        console.print(f"  {escape(line)}", highlight=False, soft_wrap=True)
    if deleted.copies:
        console.print(
            "[yellow]copies were made with the data in them; deleting those is up to you:[/]"
        )
    for path in deleted.copies:
        there = "" if path.exists() else "  (no longer there)"
        console.print(f"  {escape(str(path))}{there}")
    if deleted.unmade:
        console.print(
            f"[yellow]{ppid} is deleted, and in no table. The tables could not be made anew, "
            f"because of another record: {escape(deleted.unmade)}[/]",
            highlight=False,
            soft_wrap=True,
        )
        return 1
    return 0


def _by_folder(study: Path, files: Sequence[Path]) -> list[str]:
    """A line for each folder of a study that has some of the files, with their number."""
    folders: dict[Path, list[Path]] = {}
    for path in files:
        inside = path.relative_to(study)
        folders.setdefault(study / inside.parts[0], []).append(path)
    return [
        str(some[0]) if len(some) == 1 else f"{folder}: {counted(len(some), 'file')}"
        for folder, some in folders.items()
    ]


def _accept_loss(study: StudyFolder, ppid: str, reason: str, console: Console) -> int:
    from sandbox.study.run.decisions import accept_loss, losses

    say = sayer(console)
    lost = [loss for loss in losses(study) if loss.person.ppid == ppid]
    for loss in lost:
        accept_loss(study, loss, reason, say)
    if not lost:
        say(f"nothing of {ppid} is other than it was sealed")
    return 0
