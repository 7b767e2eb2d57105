"""Commands on the data of a study: `sandbox study export`, `withdraw`, `backup` and `merge`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.errors import InputError, StudyError
from models.message import counted
from sandbox.cli.study.recover import tell_losses

if TYPE_CHECKING:
    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.share.privacy import Anonymised, Masking

Folder = Annotated[Path, Parameter(metavar="DIR")]
Out = Annotated[Path, Parameter(metavar="PATH")]


@dataclass(frozen=True, kw_only=True)
class StudyExportOptions:
    """Copies a study for others, anonymised, as Motion-BIDS, or both.

    Try: sandbox study export studies/NAME --anonymise --out shared/NAME

    Or: sandbox study export studies/NAME --anonymise --bin age:10 --bids --out shared/NAME-bids

    --anonymise assigns new pseudonyms without keeping a list of them, dates every session to 1
    January 2000, and leaves out free text, names of folders, and participants who did not agree to
    sharing. The page "What becomes of a study's data" of the site (docs/privacy.md in the
    repository) explains what can still be found out.
    """

    folder: Folder = field(kw_only=False)
    """Folder of the study, which contains study.json."""

    out: Out
    """New folder for the copy."""

    anonymise: bool = False
    """Remove what identifies participants, as described above."""

    bids: bool = False
    """Write a Motion-BIDS data set instead of a study folder."""

    keep_words: bool = False
    """Keep free-text answers and the experimenter's notes; read all of them before you share
    them."""

    keep_hands: bool = False
    """Keep recordings over a Leap, which contain the lengths of fingers, and recordings and tables
    of touches of hands whose exact size fewer than five participants share."""

    drop: Annotated[tuple[str, ...], Parameter(metavar="ITEM")] = ()
    """Demographic item to leave out; may be repeated."""

    bin: Annotated[tuple[str, ...], Parameter(metavar="ITEM:WIDTH")] = ()
    """Demographic number to round down, such as age:10, or hand_size (default hand_size:0.1); may
    be repeated."""

    recordings: Annotated[bool, Parameter(negative="--no-recordings")] = True
    """Include recordings. Without them, trials cannot be replayed from the copy."""


@dataclass(frozen=True, kw_only=True)
class WithdrawOptions:
    """Deletes all data of a participant who withdraws consent, and leaves a tombstone record.

    Try: sandbox study withdraw studies/NAME --participant 3B5G5T --reason "by e-mail"

    This cannot be undone. The command lists backups and copies that contain the data; delete them
    yourself.
    """

    folder: Folder = field(kw_only=False)
    """Folder of the study."""

    participant: Annotated[str, Parameter(metavar="ID")]
    """Pseudonym of the participant."""

    reason: str = "wish of the participant"
    """Reason, stored in the tombstone record."""

    yes: bool = False
    """Delete without asking."""


@dataclass(frozen=True, kw_only=True)
class BackupOptions:
    """Writes a study to an archive and verifies it, or checks an existing archive.

    Try: sandbox study backup studies/NAME --out /media/disk/NAME-2026-11-21.tar.gz

    Later: sandbox study backup --check /media/disk/NAME-2026-11-21.tar.gz

    Sessions may run at the same time. `tar -xzf` unpacks the archive; the study can continue there.
    """

    folder: Annotated[Path | None, Parameter(metavar="DIR")] = field(default=None, kw_only=False)
    """Folder of the study."""

    out: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """New file for the archive."""

    check: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """Existing archive, which is read completely and compared with its digests."""


@dataclass(frozen=True, kw_only=True)
class MergeOptions:
    """Merges the folders of two sites into one study; neither is changed.

    Try: sandbox study merge siteA/NAME siteB/NAME --out both/NAME

    Both must be locked to the same design and program. Two people with one pseudonym stay two: the
    second one gets another, and the command names both.
    """

    first: Annotated[Path, Parameter(metavar="A")] = field(kw_only=False)
    """Folder of the first site."""

    second: Annotated[Path, Parameter(metavar="B")] = field(kw_only=False)
    """Folder of the second site."""

    out: Out
    """New folder. To continue the study there, give it the name of the study."""

    force_different: Annotated[str, Parameter(metavar="REASON")] = ""
    """Merge although programs or encoders differ; the reason is logged."""


def export(options: StudyExportOptions, console: Console) -> int:
    """`sandbox study export`."""
    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.share.export_folder import refuse_existing
    from sandbox.study.share.export_log import log_copy
    from sandbox.study.share.privacy import Masking, anonymise

    if not options.anonymise and not options.bids:
        raise InputError(
            "the kind of copy is missing",
            where="sandbox study export",
            expected="--anonymise, --bids, or both",
            remedy="`sandbox study backup` copies everything as it is",
        )
    masks = (options.drop, options.bin, options.keep_words, options.keep_hands)
    if any(masks) and not options.anonymise:
        raise InputError("--drop, --bin, --keep-words and --keep-hands are for --anonymise")
    study = StudyFolder.at(options.folder)
    _outside(study, options.out)
    refuse_existing(options.out)
    if tell_losses(study, console):
        console.print("[yellow]what was lost is not in the copy[/]")
    masking = Masking(
        options.keep_words,
        options.drop,
        _bins(options.bin),
        options.recordings,
        options.keep_hands,
    )
    ppids = [person.ppid for person in study.participants()]
    say = _progress(console)
    if not options.bids:
        _tell(anonymise(study, options.out, masking, say), options.out, console)
    elif options.anonymise:
        _anonymous_bids(study, options.out, masking, console)
    else:
        _bids(study, options.out, console)
        console.print("[yellow]pseudonyms are those of the study; --anonymise assigns new ones[/]")
    log_copy(study, "bids" if options.bids else "export", options.out, ppids)
    return 0


def withdraw(options: WithdrawOptions, console: Console) -> int:
    """`sandbox study withdraw`."""
    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.record.pseudonym import read_pseudonym
    from sandbox.study.share.withdraw import withdraw as delete
    from sandbox.study.share.withdraw import withdrawn

    study = StudyFolder.at(options.folder)
    try:
        ppid = read_pseudonym(options.participant)
    except StudyError:
        # One line for every id that nobody here has, whether it is whole or not.
        ppid = options.participant
    if ppid not in withdrawn(study):
        study.find(ppid)
    if not options.yes:
        console.print(
            f"Everything of {ppid} in {escape(str(study.path))} will be deleted; this "
            "cannot be undone. Type yes or no, then Enter"
        )
        try:
            answer = input()
        except EOFError:
            raise StudyError(
                "the input has ended, so that nobody can answer yes or no; nothing was deleted",
                where="the terminal",
                remedy="Run the command in a terminal; --yes deletes without asking",
            ) from None
        if answer.strip().lower() not in ("y", "yes"):
            console.print("nothing was deleted")
            return 1
    deleted = delete(study, ppid, options.reason)
    remains = ", what an earlier withdrawal had left" if deleted.before else ""
    console.print(f"{ppid}: {deleted.files} files deleted{remains}")
    if deleted.still:
        console.print(
            "[yellow]these files still name the participant, or may, since they are "
            "damaged; make them anew, or delete "
            "them:[/]"
        )
    for path in deleted.still:
        console.print(f"  {escape(str(path))}")
    if deleted.copies:
        console.print(
            "[yellow]copies were made with the data in them; deleting those is up to you:[/]"
        )
    for copy in deleted.copies:
        there = "" if copy.there else "  (no longer there)"
        console.print(f"  {copy.time[:10]}  {copy.what}  {escape(str(copy.path))}{there}")
    return 0


def backup(options: BackupOptions, console: Console) -> int:
    """`sandbox study backup`."""
    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.share.backup import back_up, check_backup
    from sandbox.study.share.export_log import log_copy

    if options.check is not None:
        checked, path = check_backup(options.check), options.check
    elif options.folder is None or options.out is None:
        raise InputError(
            "a study and an archive are needed",
            where="sandbox study backup",
            expected="DIR --out FILE, or --check FILE",
        )
    else:
        study = StudyFolder.at(options.folder)
        checked, path = back_up(study, options.out), options.out
        log_copy(study, "backup", options.out, checked.ppids)
    size = f"{checked.bytes / 1e6:.1f} MB"
    console.print(
        f"{escape(str(path))}: {len(checked.ppids)} participants, {checked.trials} finished "
        f"trials, {checked.files} files, {size}; all digests are correct"
    )
    return 0


def merge(options: MergeOptions, console: Console) -> int:
    """`sandbox study merge`."""
    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.share.export_log import log_copy
    from sandbox.study.share.merge import merge as join

    sites = [StudyFolder.at(options.first), StudyFolder.at(options.second)]
    for study in sites:
        _outside(study, options.out)
    merged = join(sites[0], sites[1], options.out, options.force_different)
    for study in sites:
        ppids = [p.ppid for p in study.participants()]
        log_copy(study, "merge", options.out, ppids)
        # A participant who withdraws from the merged study is still in the sites' folders.
        log_copy(StudyFolder.at(options.out), "site", study.path, ppids)
    console.print(
        f"{escape(str(options.out))}: {merged.people} participants; sites.csv says who "
        "comes from where"
    )
    for old, new in merged.renamed.items():
        console.print(f"  {old} is {new} here: the other site has that pseudonym, too")
    if merged.both:
        console.print(f"  in both folders, and taken once: {', '.join(merged.both)}")
    if merged.left_out:
        console.print(f"  withdrawn, and left out: {', '.join(merged.left_out)}")
    return 0


def _outside(study: StudyFolder, out: Path) -> None:
    if study.path.resolve() in (out.resolve(), *out.resolve().parents):
        raise StudyError(
            "a copy must not be inside its source",
            where=str(out),
            remedy="Choose a folder elsewhere",
        )


def _bins(given: Sequence[str]) -> dict[str, float]:
    from sandbox.study.share.privacy_groups import NARROWEST, WIDEST

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


def _anonymous_bids(study: StudyFolder, out: Path, masking: Masking, console: Console) -> None:
    from dataclasses import replace

    from sandbox.study.record.folder import StudyFolder
    from sandbox.study.share.privacy import anonymise

    with TemporaryDirectory(prefix="hand-sandbox-export-") as folder:
        between = Path(folder) / "study"
        done = anonymise(study, between, replace(masking, recordings=False), _progress(console))
        _bids(StudyFolder.at(between), out, console)
    _tell(done, out, console)


def _bids(study: StudyFolder, out: Path, console: Console) -> None:
    from sandbox.study.share.bids import export_bids

    runs = export_bids(study, out, _progress(console))
    console.print(f"{escape(str(out))}: {runs} runs as Motion-BIDS")


def _tell(done: Anonymised, out: Path, console: Console) -> None:
    from sandbox.study.share.privacy_groups import SMALLEST

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
            f"[yellow]k = {sizes.smallest}: the copy has fewer than {SMALLEST} people, who may be "
            "recognised by who knows that they took part. Only more participants change that[/]"
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


ACTIONS: dict[str, tuple[Any, Callable[[Any, Console], int]]] = {
    "export": (StudyExportOptions, export),
    "backup": (BackupOptions, backup),
    "merge": (MergeOptions, merge),
    "withdraw": (WithdrawOptions, withdraw),
}
"""Action -> its options and what it does."""
