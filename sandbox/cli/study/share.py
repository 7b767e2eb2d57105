"""`sandbox study share`: makes an anonymous copy of a study."""

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
    """Makes a copy of a study to publish, such as on OSF: without names, dates and free text.

    Try: sandbox study share studies/NAME --out NAME-shared

    Only fields that are declared as shared are copied. Participants get new pseudonyms; no list of
    old and new pseudonyms is written. Every session begins on 1 January 2000. People who did not
    agree to the consent form are left out. The copy can be replayed and reported like the study.
    The page "What becomes of a study's data" of the site (docs/privacy.md in the repository)
    describes what may still identify a person.
    """

    folder: Folder = field(kw_only=False)
    """Folder of the study, which contains notes/A.jsonl."""

    out: Out
    """New folder."""

    keep_words: bool = False
    """Keep free-text answers and the experimenter's notes. Read all of them before you publish the
    copy."""

    keep_hands: bool = False
    """Keep recordings that reveal the shape of a hand. These are recordings of hands in the air,
    which contain the lengths of fingers; of hands whose exact size fewer than five participants
    have; and of sessions that learn layouts of fingers."""

    drop: Annotated[tuple[str, ...], Parameter(metavar="ITEM")] = ()
    """Demographic item to leave out; may be repeated."""

    bin: Annotated[tuple[str, ...], Parameter(metavar="ITEM:WIDTH")] = ()
    """Demographic number, or hand_size, to round down to a multiple of WIDTH, such as age:10
    (default: hand_size:0.1); may be repeated."""

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
        options.keep_words, options.drop, _bins(options.bin), options.recordings, options.keep_hands
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
    from sandbox.study.share.masking import NARROWEST, WIDEST

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
    from sandbox.study.share.masking import SMALLEST

    people = counted(done.people, "participant")
    console.print(f"{escape(str(out))}: {people} without names or dates")
    if done.without_consent:
        refused = counted(done.without_consent, "participant")
        console.print(f"  {refused} without consent left out")
    if done.hands:
        console.print(
            f"  {counted(done.hands, 'recording')} left out because they reveal the shape of a "
            "hand; --keep-hands keeps them"
        )
    sizes = done.groups
    if not sizes.exposed:
        others = sizes.smallest - 1
        console.print(
            f"  k = {sizes.smallest}: at least {others} other participants have the same hand, "
            "language and demographic answers as each participant"
        )
    elif not sizes.columns:
        console.print(
            f"[yellow]k = {sizes.smallest}: the folder has fewer than {SMALLEST} people. Whoever "
            "knows that they took part may recognise them. Only more participants change that[/]"
        )
    else:
        several = sizes.exposed != 1
        console.print(
            f"[yellow]k = {sizes.smallest}: {counted(sizes.exposed, 'person', 'people')} "
            f"{'share' if several else 'shares'} their {', '.join(sizes.columns)} with fewer than "
            f"{SMALLEST - 1} others, and may be recognised by people who know them. --bin "
            "ITEM:WIDTH and --drop ITEM make groups larger[/]"
        )


def _progress(console: Console) -> Callable[[str], object]:
    return lambda text: console.print(f"[dim]{escape(text)}[/]", highlight=False)
