"""`sandbox study recover`: sessions whose journal has lost records."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.errors import InputError
from models.message import counted

if TYPE_CHECKING:
    from sandbox.study.record.folder import StudyFolder


@dataclass(frozen=True, kw_only=True)
class RecoverOptions:
    """Shows what journals of a study have lost, and takes in or sets aside what is still there.

    Try: sandbox study recover studies/NAME

    Then: sandbox study recover studies/NAME --take-in --reason "the disk lost 4 KiB"

    A session whose journal has fewer records than its tables, or whole recordings without a record,
    is not continued until this was decided. Exit status 1: something was lost, and nothing decided.
    """

    folder: Annotated[Path, Parameter(metavar="DIR")] = field(kw_only=False)
    """Folder of the study."""

    take_in: bool = False
    """Take whole recordings in as finished trials, at times that are not known; what does not fit
    the plan is set aside."""

    set_aside: bool = False
    """Leave whole recordings where they are, uncounted; their trials are run again."""

    reason: str = ""
    """Reason, stored in the journals."""


def tell_losses(study: StudyFolder, console: Console) -> tuple[str, ...]:
    """Says which journals have lost something.

    Returns:
        The participants whose journals have lost something, each once.
    """
    from sandbox.study.run.recover import losses

    lost: dict[str, None] = {}
    for loss in losses(study):
        lost[loss.person.ppid] = None
        whole = counted(len(loss.found), "whole recording")
        console.print(
            f"[yellow]{loss.person.ppid}, session {loss.session}: the journal has lost records "
            f"({loss.records} that its log has; {whole} without one). "
            f"`sandbox study recover {escape(str(study.path))}` shows them[/]",
            soft_wrap=True,
            highlight=False,
        )
    return tuple(lost)


def recover(options: RecoverOptions, console: Console) -> int:
    """Runs `sandbox study recover`."""
    from sandbox.cli.study.run import sayer
    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.run.recover import losses
    from sandbox.study.run.recover import recover as decide

    if options.take_in and options.set_aside:
        raise InputError("--take-in and --set-aside exclude each other")
    decided = options.take_in or options.set_aside
    if decided and not options.reason:
        raise InputError("the reason is missing", where="--reason", expected="a few words")
    study = StudyFolder.at(options.folder)
    say = sayer(console)
    found = list(losses(study))
    for loss in found:
        say(f"{loss.person.ppid}, session {loss.session}: {loss.records} records are lost")
        for one in loss.found:
            what = f"trial {one.trial.number}" if one.trial else f"cannot count: {one.why_not}"
            say(f"  {one.file}: {what}")
        if decided:
            decide(study, loss, options.take_in, options.reason, say)
    if not found:
        say("no journal has lost anything that its session still knows of")
        return 0
    if not decided:
        say("--take-in takes these recordings in, --set-aside leaves them uncounted")
    return 0 if decided else 1
