"""`sandbox study share`: the folder of a study for others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.errors import InputError, StudyError
from models.message import counted
from sandbox.cli.study.printing import print_copies, print_losses

if TYPE_CHECKING:
    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.share.shared_folder import Shared

Folder = Annotated[Path, Parameter(metavar="STUDY")]
Out = Annotated[Path, Parameter(metavar="FOLDER")]


@dataclass(frozen=True, kw_only=True)
class ShareOptions:
    """Makes the folder of a study for others, such as for OSF: without names, dates and words.

    Try: sandbox study share studies/NAME --out NAME-shared

    Only fields that are declared to be shared go into it. Participants get new pseudonyms, of
    which there is no list, every session begins on 1 January 2000, and who did not agree to the
    consent form is left out. The folder replays and reports like the study. The page "What becomes
    of a study's data" of the site (docs/privacy.md in the repository) explains what can still be
    found out.
    """

    folder: Folder = field(kw_only=False)
    """Folder of the study, which contains notes/A.jsonl."""

    out: Out
    """New folder."""

    keep_words: bool = False
    """Keep free-text answers and the experimenter's notes; read all of them before you share
    them."""

    keep_hands: bool = False
    """Keep recordings over a Leap, which contain the lengths of fingers, and recordings of hands
    whose exact size fewer than five participants share."""

    drop: Annotated[tuple[str, ...], Parameter(metavar="ITEM")] = ()
    """Demographic item to leave out; may be repeated."""

    bin: Annotated[tuple[str, ...], Parameter(metavar="ITEM:WIDTH")] = ()
    """Demographic number to round down, such as age:10, or hand_size (default hand_size:0.1); may
    be repeated."""

    recordings: Annotated[bool, Parameter(negative="--no-recordings")] = True
    """Include recordings. Without them, trials cannot be replayed from the folder."""


def share(options: ShareOptions, console: Console) -> int:
    """Runs `sandbox study share`."""
    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.record.notes import COPIED
    from sandbox.study.report.make import (
        OF_SCRIPT,
        REPORTS,
        SCRIPT_COLUMNS,
        check_libraries,
        csv_of,
        make_report,
        read_script_rows,
    )
    from sandbox.study.share.shared_folder import Masking, refuse_existing, share_study

    check_libraries()
    study = StudyFolder.at(options.folder)
    _outside(study, options.out)
    refuse_existing(options.out)
    print_copies(study, console)
    if print_losses(study, console):
        console.print("[yellow]what was lost is not in the folder[/]")
    masking = Masking(
        options.keep_words,
        options.drop,
        _bins(options.bin),
        options.recordings,
        options.keep_hands,
    )
    ppids = [person.ppid for person in study.participants()]
    found_by_script = read_script_rows(options.folder / REPORTS / OF_SCRIPT)

    def complete(folder: Path) -> None:
        """Adds the report."""
        (folder / REPORTS).mkdir()
        if found_by_script:
            data = csv_of(found_by_script, SCRIPT_COLUMNS)
            (folder / REPORTS / OF_SCRIPT).write_bytes(data)
        make_report(folder, folder / REPORTS)

    shared = share_study(study, options.out, masking, _progress(console), complete)
    _print_summary(shared, options.out, console)
    study.note(COPIED, path=str(options.out.resolve()), ppids=ppids)
    return 0


def _outside(study: StudyFolder, out: Path) -> None:
    if study.path.resolve() in (out.resolve(), *out.resolve().parents):
        raise StudyError(
            "a shared folder must not be inside its study",
            where=str(out),
            remedy="Choose a folder elsewhere",
        )


def _bins(given: Sequence[str]) -> dict[str, float]:
    from sandbox.study.share.groups import NARROWEST, WIDEST

    widths = {}
    for text in given:
        name, _, width = text.partition(":")
        try:
            widths[name] = float(width)
        except ValueError:
            widths[name] = 0.0
        if not NARROWEST <= widths[name] <= WIDEST:
            raise InputError(
                "not an item and width",
                where="--bin",
                got=text,
                expected=f"such as age:10; a width from {NARROWEST:g} to {WIDEST:g}",
            )
    return widths


def _print_summary(done: Shared, out: Path, console: Console) -> None:
    from sandbox.study.share.groups import SMALLEST

    people = counted(done.people, "participant")
    console.print(f"{escape(str(out))}: {people} without names or dates")
    if done.without_consent:
        console.print(f"  {done.without_consent} who did not agree are left out")
    if done.hands:
        console.print(
            f"  {done.hands} recordings are left out: they hold the lengths of fingers, or a size "
            "of the hand that few share; --keep-hands keeps them"
        )
    sizes = done.groups
    if not sizes.exposed:
        others = sizes.smallest - 1
        console.print(
            f"  k = {sizes.smallest}: everybody shares hand, language and demographic answers with "
            f"{others} others or more"
        )
    elif not sizes.columns:
        console.print(
            f"[yellow]k = {sizes.smallest}: the folder has fewer than {SMALLEST} people, who may "
            "be recognised by who knows that they took part. Only more participants change that[/]"
        )
    else:
        several = sizes.exposed != 1
        console.print(
            f"[yellow]k = {sizes.smallest}: {counted(sizes.exposed, 'person', 'people')} "
            f"{'share' if several else 'shares'} their {', '.join(sizes.columns)} with fewer than "
            f"{SMALLEST - 1} others, and may be recognised by who knows them. --bin ITEM:WIDTH and "
            "--drop ITEM make groups larger[/]"
        )


def _progress(console: Console) -> Callable[[str], object]:
    return lambda text: console.print(f"[dim]{escape(text)}[/]", highlight=False)
