"""Anonymous copy of a study: new pseudonyms, no dates, no free text, no names of folders.

The result is an ordinary study folder, built only from masked journals and recordings, so that its
tables contain nothing else. It opens, replays and reports like the original. No list of old and new
pseudonyms is written, but anyone with the original can match the two by seeds, state hashes or
results.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from uuid import uuid4

from models.errors import StudyError
from sandbox.recording.recording_file import read_stored, stored
from sandbox.study.design.design import Design
from sandbox.study.design.plan import in_the_air
from sandbox.study.record.files import json_bytes, make_folder, write_atomically
from sandbox.study.record.folder import StudyFolder, write_design
from sandbox.study.record.journal import Record, journal_bytes
from sandbox.study.record.pseudonym import new_pseudonym
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import JOURNAL, StoredSession, all_sessions, session_path
from sandbox.study.share.export_folder import new_folder
from sandbox.study.share.privacy_groups import Groups, binned, groups
from sandbox.study.share.privacy_records import (
    EPOCH,
    PersonMasking,
    anonymous_line,
    anonymous_records,
    without_folders,
)
from sandbox.study.tables.tables import rebuild_all

DEMOGRAPHICS = "demographics"
ABOUT = "anonymised.json"
TABLES = ("csv.gz", "parquet", "json")

Say = Callable[[str], object]


@dataclass(frozen=True)
class Masking:
    """Settings of an anonymous copy.

    Attributes:
        words: True keeps free-text answers and texts typed by the experimenter.
        drop: Names of demographic items that are left out.
        bins: Bin width by demographic item; numbers are rounded down to a multiple of it.
        recordings: True includes recordings of trials.
        hands: True includes recordings of hands in the air, which contain the lengths of fingers.
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
        hands: Number of recordings of hands in the air that were left out.
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
    _check(study.design, masking)
    sessions = {person.ppid: kept_session for person, kept_session in all_sessions(study)}
    agreed = {
        p: some for p, some in sessions.items() if all(s.state.consent is not False for s in some)
    }
    if not agreed:
        raise StudyError("the study has no participant to export", where=str(study.path))
    names = _new_names(agreed)
    new_id = str(uuid4())
    with new_folder(out) as work:
        about = {**study.about, "study": new_id, "created": EPOCH.isoformat()}
        about["build"] = without_folders(study.build)
        write_atomically(work / "study.json", json_bytes(about))
        write_design(work, study.design)
        _write_people(work, agreed, names)
        for old in sorted(agreed, key=names.__getitem__):
            answer = _answer(study.design, masking)
            person_masking = PersonMasking(names[old], new_id, answer, masking.words)
            for session in agreed[old]:
                say(f"{names[old]}: {len(session.records)} records")
                _write_session(work, session, person_masking, masking)
        anonymised = _finish(work, masking, len(sessions) - len(agreed))
    starts = [
        r
        for some in agreed.values()
        for session in some
        for r in session.records
        if r["kind"] == "trial_start"
    ]
    hidden = masking.recordings and not masking.hands
    return replace(anonymised, hands=sum(hidden and in_the_air(r["values"]) for r in starts))


def _check(design: Design, masking: Masking) -> None:
    known = [item.name for item in design.demographics]
    for name in (*masking.drop, *(masking.bins or {})):
        if name not in known:
            raise StudyError(
                "no such demographic item",
                where="--drop or --bins",
                got=name,
                expected=", ".join(known) or "no demographics",
            )


def _new_names(sessions: Mapping[str, object]) -> dict[str, str]:
    """Draws new pseudonyms that differ from all old ones."""
    names: dict[str, str] = {}
    for old in sessions:
        new = new_pseudonym()
        while new in sessions or new in names.values():
            new = new_pseudonym()
        names[old] = new
    return names


def _answer(design: Design, masking: Masking) -> Callable[[str, str, Any], Any]:
    """Returns a function of form, item and answer that returns the kept part of the answer."""
    kinds = {
        (form.name, item.name): item.kind for form in design.questionnaires for item in form.items
    }
    kinds |= {(DEMOGRAPHICS, item.name): item.kind for item in design.demographics}

    def kept(form: str, item: str, value: Any) -> Any:
        # Items that are not in the design are treated as free text.
        if kinds.get((form, item), "text") == "text" and not masking.words:
            return None
        if form == DEMOGRAPHICS and item in masking.drop:
            return None
        if form == DEMOGRAPHICS and masking.bins and item in masking.bins:
            return binned(value, masking.bins[item])
        return value

    return kept


def _write_people(
    work: Path, sessions: Mapping[str, list[StoredSession]], names: Mapping[str, str]
) -> None:
    """Writes the study's journal with the participants, in the order of the new pseudonyms."""
    records: list[Record] = []
    for old in sorted(sessions, key=names.__getitem__):
        start = sessions[old][0].state.start
        records.append(
            {
                "n": len(records),
                "time": EPOCH.isoformat(timespec="milliseconds"),
                "clock": 0.0,
                "kind": "participant",
                "ppid": names[old],
                **{k: start[k] for k in ("number", "hand", "hand_size", "language")},
                "user": without_folders(start["user"]),
            }
        )
    write_atomically(work / "study.jsonl", journal_bytes(records))


def _write_session(
    work: Path, session: StoredSession, person_masking: PersonMasking, masking: Masking
) -> None:
    source, records = session.path, anonymous_records(session.records, person_masking)
    path = session_path(work, person_masking.ppid, session.number)
    for folder in ("trials", "trackers", "session_info"):
        make_folder(path / folder)
    write_atomically(path / JOURNAL, journal_bytes(records), durable=False)
    for attempt in (a for some in SessionState.of(records).attempts.values() for a in some):
        recording = source / attempt.start["file"]
        kept = masking.recordings and (masking.hands or not in_the_air(attempt.start["values"]))
        if kept and stored(recording).exists():
            copied = b"\n".join(
                anonymous_line(line, person_masking, str(recording)) if line else b""
                for line in _whole_lines(read_stored(recording).data).split(b"\n")
            )
            write_atomically(path / attempt.start["file"], copied, durable=False)
        # Tables of poses and touches contain only numbers and names of fingers and objects.
        for stem in ("frames", "touches", "measures"):
            for table in (source / "trackers").glob(f"{stem}_{recording.stem}.*"):
                if table.name.split(f"_{recording.stem}.", 1)[1] in TABLES:
                    shutil.copyfile(table, path / "trackers" / table.name)


def _whole_lines(data: bytes) -> bytes:
    """A recording without a half-written last line."""
    return data[: data.rfind(b"\n") + 1]


def _finish(work: Path, masking: Masking, without_consent: int) -> Anonymised:
    """Builds all tables from the written files, and documents the anonymisation in the folder."""
    copy = StudyFolder.at(work)
    design = copy.design
    people: list[dict[str, Any]] = []
    for sessions in rebuild_all(copy).values():
        start = sessions[0].state.start
        asked = [
            r["answers"]
            for s in sessions
            for r in s.state.answers.values()
            if r["form"] == DEMOGRAPHICS
        ]
        people.append(
            {"hand": start["hand"], "language": start["language"], **(asked[-1] if asked else {})}
        )
    columns = ["hand", "language"] + [
        item.name
        for item in design.demographics
        if item.name not in masking.drop and (masking.words or item.kind != "text")
    ]
    columns = [name for name in columns if len({p.get(name) for p in people}) > 1]
    group_sizes = groups(people, columns)
    (work / ".lock").unlink(missing_ok=True)
    write_atomically(
        work / ABOUT,
        json_bytes(
            {
                "participants": len(people),
                "left_out_without_consent": without_consent,
                "words_kept": masking.words,
                "left_out": list(masking.drop),
                "rounded_down_to": dict(masking.bins or {}),
                "recordings": masking.recordings,
                "recordings_of_hands_in_the_air": masking.recordings and masking.hands,
                "compared": list(group_sizes.columns),
                "smallest_group": group_sizes.smallest,
                "people_in_groups_below_5": group_sizes.exposed,
                "may_still_tell": [
                    "the order of arrival (participant_number)",
                    "hand_size",
                    "how somebody moves (touches and poses)",
                ],
            }
        ),
    )
    return Anonymised(len(people), without_consent, group_sizes)
