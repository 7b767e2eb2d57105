"""`sandbox study note`: decisions about participants after their sessions, and remarks on them."""

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
    """Records a decision or a remark about a participant, and makes the tables again.

    Try: sandbox study note studies/NAME --participant B5G5T3 --exclude "did not follow the task"

    --include reverts an exclusion. If the number of the participant was freed, the participant gets
    it back, or the next free number if a new participant has it now. --withdraw and --accept-loss
    cannot be undone.
    """

    folder: Annotated[Path, Parameter(metavar="DIR")] = field(kw_only=False)
    """Folder of the study."""

    participant: Annotated[str, Parameter(metavar="ID")]
    """Pseudonym of the participant."""

    session: Annotated[int, Parameter(metavar="N")] = 1
    """Session of --trial."""

    trial: Annotated[int | None, Parameter(metavar="N")] = None
    """Number of the trial to decide about. Default: all trials of the participant."""

    exclude: Reason = ""
    """Exclude the trial, or all trials, from the results. Nothing is deleted."""

    include: Reason = ""
    """Revert an exclusion."""

    release: Reason = ""
    """Free the participant's number, with its orders, for the next new participant."""

    remark: Annotated[str, Parameter(metavar="TEXT")] = ""
    """A remark for the tables and the report."""

    withdraw: bool = False
    """Delete all data of a participant who withdraws consent. You type the pseudonym to confirm."""

    accept_loss: Reason = ""
    """Accept that records of a session are missing or changed, so that the session can be
    continued. Recordings without a record become trials if they fit the plan. A copy of the earlier
    tables is stored."""


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
            "exactly one decision is required",
            where="sandbox study note",
            got=", ".join(f"--{name.replace('_', '-')}" for name in given) or None,
            expected=f"one of {', '.join(names)}",
        )
    (kind,) = given
    if options.trial is not None and kind not in ("exclude", "include", "remark"):
        raise InputError(
            "this option is about a participant, not a trial",
            where=f"--{kind.replace('_', '-')}",
            remedy="Leave out --trial",
        )
    study = StudyFolder.at(options.folder)
    print_copies(study, console)
    try:
        ppid = read_pseudonym(options.participant)
    except StudyError:
        # `find` below raises the same error for an invalid id as for an unknown id.
        ppid = options.participant
    if kind == "withdraw":
        return _withdraw(study, ppid, console)
    study.find(ppid)
    say = sayer(console)
    if kind == "accept_loss":
        return _accept_loss(study, ppid, options.accept_loss, console)
    if print_losses(study, console):
        console.print(
            "[yellow]restore these sessions, or accept their losses, before any other decision[/]"
        )
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
    console.print(f"{about}: recorded, and all tables updated", highlight=False)
    return 0


def _withdraw(study: StudyFolder, ppid: str, console: Console) -> int:
    from sandbox.study.record.notes import withdrawn
    from sandbox.study.share.withdraw import withdraw

    if ppid not in withdrawn(study.records()):
        study.find(ppid)
    console.print(
        f"All data of {ppid} in {escape(str(study.path))} will be deleted. This cannot be "
        "undone. Type the id again, then Enter"
    )
    try:
        answer = input()
    except EOFError:
        raise StudyError(
            "the input ended before the id was typed; nothing was deleted",
            where="the terminal",
            remedy="Run the command in a terminal",
        ) from None
    if answer.strip().upper() != ppid:
        console.print("nothing was deleted")
        return 1
    deleted = withdraw(study, ppid)
    remains = ", which an earlier withdrawal had left" if deleted.before else ""
    console.print(f"{ppid}: {deleted.files} files deleted{remains}")
    if deleted.still:
        console.print(
            "[yellow]these files contain the participant's id, or may contain it because they "
            "are damaged; make them again, or delete them:[/]"
        )
    for line in _by_folder(study.path, deleted.still):
        console.print(f"  {escape(line)}", highlight=False, soft_wrap=True)
    if deleted.copies:
        console.print(
            "[yellow]these copies contain the participant's data; delete them yourself:[/]"
        )
    for path in deleted.copies:
        there = "" if path.exists() else "  (no longer there)"
        console.print(f"  {escape(str(path))}{there}")
    if deleted.unmade:
        console.print(
            f"[yellow]{ppid} is deleted, and in no table. But the tables could not be made again: "
            f"{escape(deleted.unmade)}[/]",
            highlight=False,
            soft_wrap=True,
        )
        return 1
    return 0


def _by_folder(study: Path, files: Sequence[Path]) -> list[str]:
    """Returns a line for each folder of the study with some of the files, and their number."""
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
        say(f"the records of {ppid} have no losses, so nothing was changed")
    return 0
