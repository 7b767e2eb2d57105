"""Anonymous copy of a study: new pseudonyms, no dates, no free text, no names of folders.

The result is an ordinary study folder, built only from masked journals and recordings, so that its
tables contain nothing else. It opens, replays and reports like the original. No list of old and new
pseudonyms is written, but anyone with the original can match the two by seeds, state hashes or
results.
"""

from __future__ import annotations

import gzip
import shutil
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from uuid import uuid4

from models.errors import StudyError
from sandbox.recording.recording import read_stored, stored
from sandbox.study.design.design import DEMOGRAPHICS, FILLED, Design
from sandbox.study.design.plan import in_the_air
from sandbox.study.record.chain import DIGEST, Record
from sandbox.study.record.file_digests import file_digests, recording_digests, tables_of
from sandbox.study.record.files import json_bytes, make_folder, remove_locks, write_atomically
from sandbox.study.record.folder import (
    ANONYMISED,
    LOCK,
    STUDY_FILE,
    STUDY_JOURNAL,
    WITHDRAWN,
    StudyFolder,
    copy_earlier_designs,
    withdrawals_of,
    write_design,
)
from sandbox.study.record.journal import journal_bytes, read_journal
from sandbox.study.record.pseudonym import new_pseudonym
from sandbox.study.record.session_folder import BEGUN, SEALED
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import (
    JOURNAL,
    StoredSession,
    all_sessions,
    design_of,
    session_path,
)
from sandbox.study.share.export_folder import new_folder
from sandbox.study.share.privacy_groups import SMALLEST, Groups, binned, groups
from sandbox.study.share.privacy_records import (
    EPOCH,
    HAND_SIZE,
    LEFT_OUT,
    PersonMasking,
    anonymous_line,
    anonymous_records,
    without_folders,
)
from sandbox.study.tables.tables import rebuild_all, rebuild_study

HAND_SIZE_BIN = 0.1
"""Bin width of the size of hands, unless another one is given. Over people it has a standard
deviation of about 0.07 (`sandbox.study.run.simulate`)."""
ABOUT = "anonymised.json"
"""File that says what was done; the record `ANONYMISED` has the same content."""

Say = Callable[[str], object]


@dataclass(frozen=True)
class Masking:
    """Settings of an anonymous copy.

    Attributes:
        words: True keeps free-text answers and texts typed by the experimenter.
        drop: Names of demographic items that are left out.
        bins: Bin width by demographic item, and of `hand_size`; numbers are rounded down to a
            multiple of it.
        recordings: True includes recordings of trials.
        hands: True includes recordings that tell how a hand is made: those in the air, which
            contain the lengths of fingers, those of hands whose exact size too few share, and those
            of sessions that learn layouts of fingers.
    """

    words: bool = False
    drop: tuple[str, ...] = ()
    bins: Mapping[str, float] | None = None
    recordings: bool = True
    hands: bool = False


@dataclass(frozen=True)
class Anonymised:
    """Result of an anonymous copy.

    Attributes:
        people: Number of participants in the copy.
        without_consent: Number of participants left out for lack of consent.
        groups: Groups of participants with equal demographics.
        hands: Number of recordings that were left out, since they tell how a hand is made.
    """

    people: int
    without_consent: int
    groups: Groups
    hands: int = 0


def anonymise(study: StudyFolder, out: Path, masking: Masking, say: Say) -> Anonymised:
    """Writes an anonymous copy.

    Args:
        study: The original study.
        out: The copy's folder, which must not exist.
        masking: Settings of the copy.
        say: Callback for progress messages.

    Raises:
        StudyError: A journal is damaged, there are no participants, or the copy cannot be
            written.
    """
    sessions = {person.ppid: kept_session for person, kept_session in all_sessions(study)}
    # The design first, then those that earlier sessions were run by.
    of_sessions = [design_of(study, s) for some in sessions.values() for s in some]
    designs = list({d.digest: d for d in (study.design, *of_sessions)}.values())
    asked = list(dict.fromkeys(x.name for design in designs for x in design.demographics))
    _check(asked, masking)
    agreed = {
        p: some for p, some in sessions.items() if all(s.state.consent is not False for s in some)
    }
    if not agreed:
        raise StudyError("the study has no participant to export", where=str(study.path))
    names = _new_names(agreed)
    new_id = str(uuid4())
    sizes = {p: some[0].state.start[HAND_SIZE] for p, some in agreed.items()}
    # Recordings of sessions that learn have layouts of the person's fingers in their headers; an
    # earlier design may have let them learn.
    learns = study.design.learning == "session"
    learned = {p for p, some in agreed.items() if learns or any(s.state.learned for s in some)}
    tell_hands = learned | _rare(sizes)
    with new_folder(out) as work:
        about = {**study.about, "study": new_id, "created": EPOCH.isoformat()}
        about["build"] = without_folders(study.build)
        write_atomically(work / STUDY_FILE, json_bytes(about))
        write_design(work, study.design)
        copy_earlier_designs(study.path, work)
        for old in sorted(agreed, key=names.__getitem__):
            answer = _answer(designs, masking)
            person_masking = PersonMasking(
                names[old], new_id, answer, masking.words, lambda size: shared_size(size, masking)
            )
            for session in agreed[old]:
                say(f"{names[old]}: {len(session.records)} records")
                _write_session(work, session, person_masking, masking, old in tell_hands)
        copied = [(names[old], agreed[old]) for old in sorted(agreed, key=names.__getitem__)]
        exact = {names[old]: size for old, size in sizes.items()}
        left_out = len(sessions) - len(agreed), withdrawals_of(study.records())
        anonymised = _finish(work, about, copied, masking, left_out, exact, asked)
    starts = [
        in_the_air(r["values"]) or ppid in tell_hands
        for ppid, some in agreed.items()
        for session in some
        for r in session.records
        if r["kind"] == "trial_start"
    ]
    hidden = masking.recordings and not masking.hands
    return replace(anonymised, hands=sum(starts) if hidden else 0)


def shared_size(size: float, masking: Masking) -> float:
    """Size of a hand as the copy tells it."""
    return float(binned(size, (masking.bins or {}).get(HAND_SIZE, HAND_SIZE_BIN)))


def _rare(sizes: Mapping[str, float]) -> set[str]:
    """Participants whose exact hand size, which recordings contain, too few others share."""
    shared = Counter(sizes.values())
    return {ppid for ppid, size in sizes.items() if shared[size] < min(SMALLEST, len(sizes))}


def _check(known: Sequence[str], masking: Masking) -> None:
    for name in (*masking.drop, *(masking.bins or {})):
        if name not in known and (name != HAND_SIZE or name in masking.drop):
            raise StudyError(
                "no such demographic item",
                where="--drop or --bin",
                got=name,
                expected=", ".join(known) or f"no demographics; --bin takes {HAND_SIZE}",
            )


def _asked(item: str) -> str:
    """Name of a demographic item next to what the program knows of a person."""
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
    """Returns a function of form, item and answer that returns the kept part of the answer.

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

    def kept(form: str, item: str, value: Any) -> Any:
        # Items that are in no design are treated as free text.
        if "text" in kinds.get((form, item), {"text"}) and not masking.words:
            return None
        if form == DEMOGRAPHICS and item in masking.drop:
            return None
        if form == DEMOGRAPHICS and masking.bins and item in masking.bins:
            return binned(value, masking.bins[item])
        return value

    return kept


def _study_records(
    work: Path,
    about: Record,
    people: Sequence[tuple[str, list[StoredSession]]],
    masking: Masking,
) -> list[Record]:
    """Records of the study's journal: its lock, and the participants with their sessions."""
    records: list[Record] = [{"kind": LOCK, **about}]
    for ppid, sessions in people:
        start = sessions[0].state.start
        records.append(
            {
                "kind": "participant",
                "ppid": ppid,
                **{k: start[k] for k in ("number", "hand", "language")},
                HAND_SIZE: shared_size(start[HAND_SIZE], masking),
                "user": without_folders(start["user"]),
            }
        )
        for session in sessions:
            of = {"ppid": ppid, "session": session.number}
            copied = read_journal(session_path(work, ppid, session.number) / JOURNAL)
            records.append({"kind": BEGUN, **of})
            records.append(
                {
                    "kind": SEALED,
                    **of,
                    "records": len(copied),
                    "digest_of_last": copied[-1][DIGEST],
                }
            )
    return records


def _write_study_journal(work: Path, records: Sequence[Record]) -> None:
    head = {"time": EPOCH.isoformat(timespec="milliseconds"), "clock": 0.0}
    write_atomically(work / STUDY_JOURNAL, journal_bytes([{**head, **r} for r in records]))


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
        tells_hand: True if the hand's size, which all recordings contain, identifies the person.
    """
    source, records = session.path, anonymous_records(session.records, person_masking)
    path = session_path(work, person_masking.ppid, session.number)
    for folder in ("trials", "trackers", "session_info"):
        make_folder(path / folder)
    emptied: dict[str, str] = {}
    for attempt in (a for some in SessionState.of(records).attempts.values() for a in some):
        recording = source / attempt.start["file"]
        tells = tells_hand or in_the_air(attempt.start["values"])
        kept = masking.recordings and (masking.hands or not tells)
        if kept and stored(recording).exists():
            copied = b"\n".join(
                anonymous_line(line, person_masking, str(recording)) if line else b""
                for line in _whole_lines(read_stored(recording).data).split(b"\n")
            )
            write_atomically(path / attempt.start["file"], copied, durable=False)
        # Tables of poses and touches contain only numbers and names of fingers and objects, but
        # touches beside poses of the trained size tell the size of the hand.
        for table in tables_of(source / "trackers", recording.stem):
            copy = path / "trackers" / table.name
            if tells_hand and not masking.hands and table.name.startswith("touches_"):
                emptied |= _without_rows(table, copy)
            else:
                shutil.copyfile(table, copy)
    for record in records:
        if record["kind"] == "tables":
            theirs = {name: emptied.get(name, digest) for name, digest in record["files"].items()}
            record["files"] = theirs
        if record.get("recording") is not None:
            digests = recording_digests(path / record["file"])
            record["recording"] = digests or {LEFT_OUT: True}
    write_atomically(path / JOURNAL, journal_bytes(records), durable=False)


def _without_rows(table: Path, copy: Path) -> dict[str, str]:
    """Writes a table with its columns and no rows; returns its name and digest."""
    with gzip.open(table) as file:
        columns = file.readline()
    write_atomically(copy, gzip.compress(columns, mtime=0), durable=False)
    return file_digests([copy])


def _whole_lines(data: bytes) -> bytes:
    """A recording without a half-written last line."""
    return data[: data.rfind(b"\n") + 1]


def _finish(
    work: Path,
    study: Record,
    copied: Sequence[tuple[str, list[StoredSession]]],
    masking: Masking,
    left_out: tuple[int, int],
    exact: Mapping[str, float],
    questions: Sequence[str],
) -> Anonymised:
    """Builds all tables from the written files, and documents the anonymisation in the folder.

    Args:
        work: Folder of the copy.
        study: Content of its `study.json`.
        copied: Sessions by new pseudonym.
        masking: Settings of the copy.
        left_out: Numbers of participants who did not agree, and who withdrew.
        exact: Exact sizes of hands by new pseudonym.
        questions: Names of all questions about the person, of any design.
    """
    without_consent, withdrawn = left_out
    records = _study_records(work, study, copied, masking)
    _write_study_journal(work, records)
    copy = StudyFolder.at(work)
    people: list[dict[str, Any]] = []
    for sessions in rebuild_all(copy).values():
        start = sessions[0].state.start
        asked = [s.state.about_person for s in sessions if s.state.about_person is not None]
        answers = asked[-1] if asked else {}
        # Recordings contain the exact size.
        seen = masking.recordings and masking.hands
        people.append(
            {
                **{_asked(name): value for name, value in answers.items()},
                "hand": start["hand"],
                HAND_SIZE: exact[start["ppid"]] if seen else start[HAND_SIZE],
                "language": start["language"],
            }
        )
    # Answers that are left out are the same for everybody: None.
    known = ["hand", HAND_SIZE, "language", *map(_asked, questions)]
    columns = [name for name in known if len({p.get(name) for p in people}) > 1]
    group_sizes = groups(people, columns)
    about = {
        "participants": len(people),
        "left_out_without_consent": without_consent,
        WITHDRAWN: withdrawn,
        "words_kept": masking.words,
        "left_out": list(masking.drop),
        "rounded_down_to": {HAND_SIZE: HAND_SIZE_BIN, **(masking.bins or {})},
        "recordings": masking.recordings,
        "recordings_that_tell_how_a_hand_is_made": masking.recordings and masking.hands,
        "touches_that_tell_how_a_hand_is_made": masking.hands,
        "compared": list(group_sizes.columns),
        "smallest_group": group_sizes.smallest,
        "people_in_groups_below_5": group_sizes.exposed,
        "may_still_tell": [
            "the order of arrival (participant_number)",
            "how somebody moves (touches and poses)",
        ],
    }
    write_atomically(work / ABOUT, json_bytes(about))
    _write_study_journal(work, [*records, {"kind": ANONYMISED, "about": about}])
    rebuild_study(copy)
    remove_locks(work)
    return Anonymised(len(people), without_consent, group_sizes)
