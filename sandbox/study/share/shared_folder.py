"""Makes the shared folder of a study: new pseudonyms, no dates, no free text, no names of folders.

The shared folder is an ordinary study folder: it can be opened, replayed and reported like the
original. It is built only from the declared fields of records, notes, recordings and frames
(`sandbox.study.share.masking`), so that its tables contain no other data. No list of old and new
pseudonyms is written, but anyone with the original can match the two by seeds, state hashes or
results.
"""

from __future__ import annotations

import os
import shutil
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from models.errors import StudyError
from models.message import counted
from sandbox.recording.recording import SUFFIX, packed, read_stored, stored
from sandbox.study.design.design import DEMOGRAPHICS, FILLED, Design
from sandbox.study.design.session_plan import in_the_air
from sandbox.study.record.copies import JOURNAL
from sandbox.study.record.durable_files import (
    TEMPORARY,
    json_bytes,
    make_folder,
    remove_locks,
    study_error,
    write_atomically,
)
from sandbox.study.record.folder import SITE, StudyFolder, withdrawals_of, write_design
from sandbox.study.record.journal import HASH, Record, journal_bytes, read_journal
from sandbox.study.record.notes import (
    ANONYMISED,
    DECISIONS,
    NOTES,
    PARTICIPANT,
    PERSON_NOTES,
    SEALED,
    STUDY,
    WITHDRAWN,
    write_notes,
)
from sandbox.study.record.pseudonym import new_pseudonym
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import (
    StoredSession,
    all_sessions,
    design_of,
    session_path,
)
from sandbox.study.record.trial_files import TRIALS, frames_of, recording_digest
from sandbox.study.share.masking import (
    HAND_SIZE,
    LEFT_OUT,
    SMALLEST,
    Groups,
    PersonMasking,
    binned,
    groups,
    shared_frames,
    shared_line,
    shared_note,
    shared_records,
)
from sandbox.study.share.verify import verify
from sandbox.study.tables.column import TABLES
from sandbox.study.tables.tables import make_tables
from sandbox.system.files import sync_folder

HAND_SIZE_BIN = 0.1
"""Default bin width of hand sizes. Hand sizes of people have a standard deviation of about 0.07
(`sandbox.study.run.simulated_study`)."""
ABOUT = "anonymised.json"
"""File that describes the masking and what was left out; the note `ANONYMISED` has the same
content."""
README, VERIFIED = "README.md", "verify.txt"
"""Files with the list of contents, and with the result of a verification of the folder."""

Say = Callable[[str], object]


@dataclass(frozen=True)
class Masking:
    """Settings of an anonymous copy.

    Attributes:
        words: True keeps free-text answers and texts typed by the experimenter.
        drop: Names of demographic items that are left out.
        bins: Bin widths by demographic item, or `hand_size`. Numbers are rounded down to a multiple
            of the width.
        recordings: True includes recordings of trials.
        hands: True includes recordings that reveal the shape of a hand: of hands in the air, since
            they contain the lengths of fingers; of hands with a rare exact size; and of sessions
            that learn layouts of fingers.
    """

    words: bool = False
    drop: tuple[str, ...] = ()
    bins: Mapping[str, float] | None = None
    recordings: bool = True
    hands: bool = False


@dataclass(frozen=True)
class Shared:
    """Counts of a shared folder.

    Attributes:
        people: Number of participants in the folder.
        without_consent: Number of participants who were left out because they did not consent.
        groups: Groups of participants with equal demographics.
        hands: Number of recordings that were left out because they reveal the shape of a hand.
    """

    people: int
    without_consent: int
    groups: Groups
    hands: int = 0


def share_study(
    study: StudyFolder,
    out: Path,
    masking: Masking,
    say: Say,
    complete: Callable[[Path], object] = lambda folder: None,
) -> Shared:
    """Makes the shared folder of a study.

    Args:
        study: The study.
        out: The folder, which must not exist.
        masking: Settings of the copy.
        say: Callback for progress messages.
        complete: Called with the temporary folder when everything except the report is written,
            before the folder gets its final name.

    Raises:
        StudyError: A journal is damaged, there are no participants, or the folder cannot be
            written.
    """
    sessions = {person.ppid: kept_session for person, kept_session in all_sessions(study)}
    # The current design first, then the designs of earlier sessions.
    of_sessions = [design_of(study, s) for some in sessions.values() for s in some]
    designs = list({d.digest: d for d in (study.design, *of_sessions)}.values())
    asked = list(dict.fromkeys(x.name for design in designs for x in design.demographics))
    _check(asked, masking)
    agreed = {
        p: some for p, some in sessions.items() if all(s.state.consent is not False for s in some)
    }
    if not agreed:
        raise StudyError(
            "the study has no participant to share",
            where=str(study.path),
            expected="a participant who has begun and did not decline to consent",
        )
    names = _new_names(agreed)
    sizes = {p: some[0].state.start[HAND_SIZE] for p, some in agreed.items()}
    # If a session learns layouts, headers of recordings contain layouts of the person's fingers.
    # An earlier design may have had learning, too.
    learns = study.design.learning == "session"
    learned = {p for p, some in agreed.items() if learns or any(s.state.learned for s in some)}
    tell_hands = learned | _rare(sizes)
    with _new_folder(out) as work:
        about = {**study.about, "build": study.build}
        make_folder(work / NOTES)
        write_design(work, study.design)
        for old in sorted(agreed, key=names.__getitem__):
            answer = _answer(designs, masking)
            person_masking = PersonMasking(
                names[old], answer, masking.words, lambda size: shared_size(size, masking)
            )
            for session in agreed[old]:
                say(f"{names[old]}: {len(session.records)} records")
                _write_session(work, session, person_masking, masking, old in tell_hands)
        copied = [(names[old], agreed[old]) for old in sorted(agreed, key=names.__getitem__)]
        exact = {names[old]: size for old, size in sizes.items()}
        left_out = len(sessions) - len(agreed), withdrawals_of(study.records())
        shared = _finish(work, about, copied, masking, left_out, exact, asked)
        complete(work)
    starts = [
        in_the_air(r["values"]) or ppid in tell_hands
        for ppid, some in agreed.items()
        for session in some
        for r in session.records
        if r["kind"] == "trial"
    ]
    hidden = masking.recordings and not masking.hands
    return replace(shared, hands=sum(starts) if hidden else 0)


def shared_size(size: float, masking: Masking) -> float:
    """Returns the size of a hand in the copy: it is rounded down to the bin width."""
    return float(binned(size, (masking.bins or {}).get(HAND_SIZE, HAND_SIZE_BIN)))


def _rare(sizes: Mapping[str, float]) -> set[str]:
    """Returns the participants whose exact hand size, which recordings contain, is rare."""
    shared = Counter(sizes.values())
    return {ppid for ppid, size in sizes.items() if shared[size] < min(SMALLEST, len(sizes))}


def _check(known: Sequence[str], masking: Masking) -> None:
    for option, names, usable in (
        ("--drop", masking.drop, known),
        ("--bin", masking.bins or {}, (*known, HAND_SIZE)),
    ):
        for name in names:
            if name not in usable:
                raise StudyError(
                    "no such demographic item",
                    where=option,
                    got=name,
                    expected=", ".join(usable) or "no option: this study asks no demographics",
                )


def _item_name(item: str) -> str:
    """Returns the name of a demographic item, made distinct from the program's own columns."""
    return f"{item} (asked)" if item in FILLED else item


def _new_names(sessions: Mapping[str, object]) -> dict[str, str]:
    """Draws new pseudonyms that differ from all old ones."""
    names: dict[str, str] = {}
    for old in sessions:
        new = new_pseudonym()
        while new in sessions or new in names.values():
            new = new_pseudonym()
        names[old] = new
    return names


def _answer(designs: Sequence[Design], masking: Masking) -> Callable[[str, str, Any], Any]:
    """Returns a function of form, item and answer, for `PersonMasking.answer`.

    Args:
        designs: Designs of all sessions.
        masking: Settings of the copy.
    """
    kinds: dict[tuple[str, str], set[str]] = {}
    for design in designs:
        for form in design.questionnaires:
            for item in form.items:
                kinds.setdefault((form.name, item.name), set()).add(item.kind)
        for item in design.demographics:
            kinds.setdefault((DEMOGRAPHICS, item.name), set()).add(item.kind)

    def shared_answer(form: str, item: str, value: Any) -> Any:
        # The kind of an item that no design contains is unknown, so it is left out.
        if (form, item) not in kinds or ("text" in kinds[form, item] and not masking.words):
            return None
        if form == DEMOGRAPHICS and item in masking.drop:
            return None
        if form == DEMOGRAPHICS and masking.bins and item in masking.bins:
            return binned(value, masking.bins[item])
        return value

    return shared_answer


def _write_notes(
    work: Path,
    study: Mapping[str, Any],
    people: Sequence[tuple[str, list[StoredSession]]],
    masking: Masking,
) -> list[Record]:
    """Writes the notes of a copy: about each participant, and about the study, with new seals.

    Returns:
        The notes of the study.
    """
    mask = PersonMasking("", words=masking.words)
    notes: list[Record] = [shared_note({**study, "kind": STUDY}, mask)]
    head = {"time": notes[0]["time"]}
    for ppid, sessions in people:
        mask = PersonMasking(
            ppid, words=masking.words, hand_size=lambda size: shared_size(size, masking)
        )
        first = {**sessions[0].state.start, "kind": PARTICIPANT}
        # A note about no single session is in the lists of all sessions, but is written once.
        decided = {id(note): note for session in sessions for note in session.notes}.values()
        person = [shared_note(n, mask) for n in decided if n["kind"] in DECISIONS]
        write_notes(
            work / ppid / PERSON_NOTES, [{**shared_note(first, mask), "ppid": ppid}, *person]
        )
        for session in sessions:
            copied = read_journal(session_path(work, ppid, session.number) / JOURNAL)
            seal = {"records": len(copied), HASH: copied[-1][HASH]}
            notes.append({**head, "kind": SEALED, "ppid": ppid, "session": session.number, **seal})
    write_notes(work / NOTES / f"{SITE}.jsonl", notes)
    return notes


def _write_session(
    work: Path,
    session: StoredSession,
    person_masking: PersonMasking,
    masking: Masking,
    tells_hand: bool,
) -> None:
    """Writes a session.

    Args:
        work: Folder of the copy.
        session: The original session.
        person_masking, masking: Settings.
        tells_hand: True if all recordings of the person reveal the shape of the hand.
    """
    source, records = session.path, shared_records(session.records, person_masking)
    path = session_path(work, person_masking.ppid, session.number)
    make_folder(path / TRIALS)
    for attempt in (a for some in SessionState.of(records).attempts.values() for a in some):
        recording = source / attempt.start["file"]
        tells = tells_hand or in_the_air(attempt.start["values"])
        kept = masking.recordings and (masking.hands or not tells)
        if kept and stored(recording).exists():
            # A half-written last line is left out.
            *lines, _ = read_stored(recording).data.split(b"\n")
            copied = (shared_line(line, person_masking, str(recording)) for line in lines if line)
            data = packed(b"".join(line + b"\n" for line in copied if line))
            write_atomically(path / f"{attempt.start['file']}{SUFFIX}", data, durable=False)
        frames = frames_of(recording)
        if frames.exists():
            data = shared_frames(frames.read_bytes())
            write_atomically(path / TRIALS / frames.name, data, durable=False)
    for record in records:
        if record.get("recording") is not None:
            record["recording"] = recording_digest(path / record["file"]) or LEFT_OUT
    write_atomically(path / JOURNAL, journal_bytes(records), durable=False)


def _finish(
    work: Path,
    study: Record,
    copied: Sequence[tuple[str, list[StoredSession]]],
    masking: Masking,
    left_out: tuple[int, int],
    exact: Mapping[str, float],
    questions: Sequence[str],
) -> Shared:
    """Makes all tables from the written files, and the files that describe the copy.

    Args:
        work: Folder of the copy.
        study: Values of the study's first note.
        copied: Sessions by new pseudonym.
        masking: Settings of the copy.
        left_out: Numbers of participants who did not consent, and of participants who withdrew.
        exact: Exact sizes of hands by new pseudonym.
        questions: Names of all questions about the person, in any design of the study.
    """
    without_consent, withdrawn = left_out
    notes = _write_notes(work, study, copied, masking)
    copy = StudyFolder.at(work)
    people: list[dict[str, Any]] = []
    make_tables(copy)
    for _, sessions in all_sessions(copy):
        start = sessions[0].state.start
        asked = [s.state.about_person for s in sessions if s.state.about_person is not None]
        answers = asked[-1] if asked else {}
        # The exact hand size is visible if recordings are included.
        seen = masking.recordings and masking.hands
        people.append(
            {
                **{_item_name(name): value for name, value in answers.items()},
                "hand": start["hand"],
                HAND_SIZE: exact[start["ppid"]] if seen else start[HAND_SIZE],
                "language": start["language"],
            }
        )
    # Left-out answers are None for every participant.
    known = ["hand", HAND_SIZE, "language", *map(_item_name, questions)]
    columns = [name for name in known if len({p.get(name) for p in people}) > 1]
    group_sizes = groups(people, columns)
    recordings = len(list(work.glob("*/S*/trials/T*.jsonl.gz")))
    about = {
        "participants": len(people),
        "left_out_without_consent": without_consent,
        WITHDRAWN: withdrawn,
        "words_kept": masking.words,
        "left_out": list(masking.drop),
        "rounded_down_to": {HAND_SIZE: HAND_SIZE_BIN, **(masking.bins or {})},
        "recordings": recordings,
        "recordings_that_tell_how_a_hand_is_made": masking.recordings and masking.hands,
        "compared": list(group_sizes.columns),
        "smallest_group": group_sizes.smallest,
        "people_in_groups_below_5": group_sizes.exposed,
        "may_still_tell": [
            "the order of arrival (number)",
            "how somebody moves (recordings and poses)",
        ],
    }
    write_atomically(work / ABOUT, json_bytes(about))
    last = {"time": notes[0]["time"], "kind": ANONYMISED, "about": about}
    write_notes(copy.notes, [*notes, last])
    make_tables(copy)
    write_atomically(work / README, _readme(copy, about).encode())
    found = verify(work, replays=False)
    if not found.sound:
        wrong = [finding for some in found.found.values() for finding in some]
        raise StudyError(
            "the shared folder failed its own verification, so it was not written",
            where=str(wrong[0]),
            got=counted(len(wrong), "finding"),
            remedy="`sandbox replay STUDY --verify` shows whether the study itself has faults",
        )
    replays = "`sandbox replay FOLDER --verify` replays the recordings"
    replays = replays if recordings else "this folder has no recordings"
    lines = [*found.lines(), *found.notes, f"replays: {replays}"]
    write_atomically(work / VERIFIED, "".join(f"{line}\n" for line in lines).encode())
    for folder in (work, work / TABLES):
        remove_locks(folder)
    return Shared(len(people), without_consent, group_sizes)


def _readme(study: StudyFolder, about: Mapping[str, Any]) -> str:
    """Returns the README of a shared folder."""
    people = counted(about["participants"], "participant")
    gone = [
        *("names, dates and times of day, and people who did not agree to the consent form",),
        *([] if about["words_kept"] else ["answers in words, and the experimenter's notes"]),
        *([f"the answers to {', '.join(about['left_out'])}"] if about["left_out"] else []),
        *(
            []
            if about["recordings_that_tell_how_a_hand_is_made"]
            else ["recordings that reveal the shape of a hand"]
        ),
    ]
    replayed = "| `*/S*/trials/*.jsonl.gz` | recordings, which replay |\n"
    recordings = replayed if about["recordings"] else ""
    compares = "records, tables and replays" if about["recordings"] else "records and tables"
    exposed = counted(about["people_in_groups_below_5"], "person", "people")
    design = study.design
    return f"""# {design.title or design.name}

`{design.name}`, a user study with Hand Sandbox ({study.mode} data): {people}, with new pseudonyms.
The design plans {design.participants}.

Licence: (to be filled in)

| file | content |
| --- | --- |
| `tables/*.csv` | all results; `tables/codebook.csv` has the meaning and unit of each column |
| `report/report.html`, `report/results.csv` | the results as a page, and its numbers |
| `report/people.csv`, `report/codebook.csv` | means of each person; columns of these files |
| `report/analysis.R` | models in R, which read `tables/` and write `results_R.csv` |
| `design.toml` | the design, with its texts; forms that it only names are those of the program |
| `*/S*/session.jsonl` | the record of each session, from which the tables follow |
| `*/notes.jsonl`, `notes/` | decisions about people, and about the study |
| `*/S*/trials/*.frames.csv.gz` | poses and objects of each trial, 62.5 times a second |
{recordings}| `{ABOUT}`, `{VERIFIED}` | what was left out; what a verification found |

With the program (`pip install hand-sandbox[study]`), `sandbox study report FOLDER` makes the report
again, and `sandbox replay FOLDER --verify` compares {compares}.

Not in here: {"; ".join(gone)}. Every session begins on 1 January 2000.

Data that may still identify a person: the smallest group of people with equal hand, language and
answers about themselves has size {about["smallest_group"]} (k-anonymity); {exposed} are in groups
of fewer than 5. `number` is the order in which people came. Frames show how a person moves.
"""


@contextmanager
def _new_folder(out: Path) -> Iterator[Path]:
    """Context that creates a folder under a temporary name, and renames it at its end.

    Args:
        out: The final path, which must not exist.

    Raises:
        StudyError: The path exists, or the folder cannot be created.
    """
    refuse_existing(out)
    make_folder(out.parent)
    work = out.parent / f"{TEMPORARY}{os.getpid()}-{out.name}"
    try:
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir()
        yield work
        refuse_existing(out)
        work.rename(out)
        sync_folder(out.parent)
    except OSError as error:
        raise study_error(error, out, "the folder cannot be written") from None
    finally:
        shutil.rmtree(work, ignore_errors=True)


def refuse_existing(out: Path) -> None:
    """Refuses to overwrite an existing file or folder.

    Raises:
        StudyError: The path exists.
    """
    if out.exists() or out.is_symlink():
        raise StudyError(
            "this path exists already, and is not overwritten",
            where=str(out),
            remedy="Choose another name with --out",
        )
