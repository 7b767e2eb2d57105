"""The folder of a study: its participants, and the program and design that it is locked to.

OUT/EXPERIMENT/            real data; pilot data are in EXPERIMENT-pilot, simulated data in
                           EXPERIMENT-simulated
  study.json               versions of program, encoders and design that the study is locked to
                           (derived from the journal of the study)
  study.jsonl              journal of the study: its lock, participants, sessions, upgrades
  design.toml              the locked design
  earlier_designs/DIGEST/  each design that participants had before, with its questionnaires
  participants.csv  trial_results.csv  questionnaires.csv  codebook.csv     (derived tables)
  PPID/S001/               a session, with the layout of UXF (Unity Experiment Framework)
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from msgspec import Struct

from models.errors import InputError, StudyError
from models.json_input import check_layout, checked, decoded_record
from sandbox.study.design.design import Design
from sandbox.study.record.build import build_of, changes, noted_changes
from sandbox.study.record.chain import Record
from sandbox.study.record.files import (
    json_bytes,
    locked,
    make_folder,
    remove_unfinished,
    study_error,
    write_atomically,
)
from sandbox.study.record.journal import Journal, now, read_journal
from sandbox.study.record.pseudonym import new_pseudonym

if TYPE_CHECKING:
    from sandbox.trial.settings import Settings

SCHEMA = 1
"""Version of the folder's layout."""

REAL, PILOT, SIMULATED = "real", "pilot", "simulated"
"""Kinds of data. Each kind has its own folder and is named in every row of the tables; a folder is
never opened as another kind."""


@dataclass(frozen=True)
class Participant:
    """A participant.

    Attributes:
        ppid: Pseudonym.
        number: 0, 1, ... in order of arrival; it determines the orders of levels.
        hand, hand_size: The participant's hand, and its length relative to the trained hand.
        language: Language of the texts.
        user: The simulated user's configuration; None for a person.
    """

    ppid: str
    number: int
    hand: str = "right"
    hand_size: float = 1.0
    language: str = "en"
    user: dict[str, Any] | None = None


WITHDRAWN = "withdrawn"
"""Kind of the record that takes the place of a participant's who withdrew consent."""
ANONYMISED = "anonymised"
"""Kind of the last record of an anonymous copy: what was done, and how many had withdrawn."""
LOCK = "study"
"""Kind of the first record of a study's journal: what the study is, and what it is locked to."""
ANEW = "locked_anew"
"""Kind of the record of a study that is locked to something else before anybody has taken part."""
STUDY_JOURNAL, STUDY_FILE, DESIGN_FILE = "study.jsonl", "study.json", "design.toml"
EARLIER = "earlier_designs"
"""Folder of the designs that `--force-upgrade` has replaced, each in a folder with the name of its
digest."""
REPORT = "report.html"
"""Name of the page of a report, wherever it is."""
_ABOUT = ("schema", "study", "experiment", "mode", "created", "build")
"""Fields of `study.json`, in order."""

SETTINGS = "settings"
"""Field of `study.json` with all settings of a trial that the design leaves as they are: a default
that changes later changes no study that has begun."""


class _StudyFile(Struct):
    """The fields that `study.json` must have."""

    study: str
    experiment: str
    mode: str
    build: dict[str, Any]


class StudyFolder:
    """Opens a study's folder, or creates it.

    Args:
        out: Folder of all studies.
        design: Design of this study.
        mode: `REAL`, `PILOT` or `SIMULATED`.
        upgrade: Reason to continue with another program, encoder or design than the locked one;
            empty refuses such a change.

    Attributes:
        noted: Versions that have changed since the study was last opened, and on which no state
            depends.
        anew: What has changed since the study was last opened and is accepted, as nobody has taken
            part yet.

    Raises:
        StudyError: The folder is locked to another program, encoder or design and has a
            participant, has another mode, or cannot be written.
    """

    def __init__(self, out: Path, design: Design, mode: str, upgrade: str = "") -> None:
        self.design, self.mode = design, mode
        self.path = folder_of(out, design.name, mode)
        self._about: dict[str, Any] = {}
        self.noted: list[str] = []
        self.anew: list[str] = []
        self._designs: dict[str, Design] = {}
        make_folder(self.path)
        with self.lock():
            remove_unfinished(self.path)
            self._lock_to(build_of(design), upgrade)
            self._keep_design()
            write_design(self.path, design)

    @classmethod
    def at(cls, path: Path) -> StudyFolder:
        """Opens an existing study to read it, maintain it or build its tables.

        The version of the program does not matter.

        Raises:
            StudyError: The path is not a study folder, or the design cannot be read.
        """
        from sandbox.study.design.design_file import load_design

        if not (path / STUDY_FILE).is_file():
            raise StudyError(
                "not a study folder",
                where=str(path),
                expected="a folder that contains study.json, such as studies/NAME",
            )
        folder = cls.__new__(cls)
        folder._about = read_study_json(path / STUDY_FILE)
        folder.noted, folder.anew, folder._designs = [], [], {}
        folder.path, folder.mode = path, str(folder._about["mode"])
        folder.design = load_design(path / DESIGN_FILE, try_out=False)
        return folder

    @property
    def about(self) -> dict[str, Any]:
        """Content of `study.json`."""
        return dict(self._about)

    @property
    def id(self) -> str:
        """Id of this study, recorded in every session."""
        return str(self._about["study"])

    @property
    def build(self) -> dict[str, Any]:
        """Program, encoders and design that the study is locked to."""
        return dict(self._about["build"])

    @property
    def settings(self) -> Settings:
        """Settings of trials where the design leaves them as they are."""
        from sandbox.trial.settings import Settings, decoded

        return decoded(self._about[SETTINGS]) if SETTINGS in self._about else Settings()

    def design_of(self, digest: str) -> Design:
        """The design of a digest, as a session's records name it; today's one if it was not kept or
        cannot be read any more."""
        if digest == self.design.digest:
            return self.design
        if digest not in self._designs:
            path = self.path / EARLIER / digest / DESIGN_FILE
            found = _readable(path)
            self._designs[digest] = found if found and found.digest == digest else self.design
        return self._designs[digest]

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Locks the files of the study itself; sessions of other participants continue."""
        with locked(self.path / ".lock", wait=True, what="the study"):
            yield

    def participants(self) -> list[Participant]:
        """All participants so far, in order of arrival."""
        return participants_of(self.records())

    def find(self, ppid: str, remedy: str = "") -> Participant:
        """Finds a participant by pseudonym.

        Args:
            ppid: The pseudonym.
            remedy: What to do if there is no such participant; empty says where all are listed.

        Raises:
            StudyError: The participant does not exist.
        """
        known = self.participants()
        participant = next((p for p in known if p.ppid == ppid), None)
        if participant is None:
            raise StudyError(
                "no such participant in this study",
                where=str(self.path),
                got=ppid,
                expected=", ".join(p.ppid for p in known[-8:]) or None,
                remedy=remedy
                or "Look for a typing error: the column ppid of participants.csv there lists all",
            )
        return participant

    def add(self, number: int | None = None, **about: Any) -> Participant:
        """Adds a participant.

        Args:
            number: Number of the participant; if it is in use, its participant is returned. None
                uses the first free number.
            about: Further attributes of `Participant`.

        Raises:
            StudyError: Somebody has locked the study to something else since it was opened.
        """
        with self.lock(), self._journal() as journal:
            now_locked = about_of(journal.records, self.path / STUDY_FILE)["build"]
            different = changes(self.build, now_locked)
            if different:
                raise StudyError(
                    "the study was locked to something else while it was open here",
                    where=str(self.path),
                    got=", ".join(different),
                    remedy="Begin the session again",
                )
            people = participants_of(journal.records)
            released = {r["ppid"] for r in journal.records if r["kind"] == "released"}
            taken = {p.number: p for p in people if p.ppid not in released}
            if number in taken:
                return taken[number]
            if number is None:
                number = next(i for i in range(len(people) + 1) if i not in taken)
            names = {p.ppid for p in people}
            ppid = new_pseudonym()
            while ppid in names or (self.path / ppid).exists():
                ppid = new_pseudonym()
            person = Participant(ppid, number, **about)
            journal.append("participant", durable=True, **vars(person))
            return person

    def note(self, kind: str, **values: Any) -> Record:
        """Writes a record into the journal of the study, durably."""
        with self.lock(), self._journal() as journal:
            return journal.append(kind, durable=True, **values)

    def records(self) -> list[Record]:
        """Records of the journal of the study."""
        path = self.path / STUDY_JOURNAL
        return read_journal(path) if path.exists() else []

    def release(self, ppid: str, reason: str) -> None:
        """Frees a participant's number, so that the next new participant gets it and its orders."""
        self.note("released", ppid=ppid, reason=reason)

    @contextmanager
    def _journal(self) -> Iterator[Journal]:
        journal = Journal(self.path / STUDY_JOURNAL)
        try:
            yield journal
        finally:
            journal.close()

    def _keep_design(self) -> None:
        """Keeps the design in the folder, before another one takes its place, if somebody may have
        taken part by it."""
        path = self.path / DESIGN_FILE
        begun = any(r["kind"] in ("participant", WITHDRAWN) for r in self.records())
        if not begun or not path.is_file():
            return
        before = _readable(path)
        if before is None:
            # What cannot be read any more is kept as it is, by the digest of its text.
            data = path.read_bytes()
            name = blake2b(data, digest_size=16).hexdigest()
            make_folder(self.path / EARLIER / name)
            write_atomically(self.path / EARLIER / name / DESIGN_FILE, data)
        elif before.digest != self.design.digest:
            write_design(self.path / EARLIER / before.digest, before)

    def _lock_to(self, build: dict[str, Any], upgrade: str) -> None:
        path = self.path / STUDY_FILE
        with self._journal() as journal:
            begun = any(r["kind"] in ("participant", WITHDRAWN) for r in journal.records)
            if not journal.records:
                journal.append(
                    LOCK,
                    durable=True,
                    schema=SCHEMA,
                    study=str(uuid4()),
                    experiment=self.design.name,
                    mode=self.mode,
                    created=now(),
                    build=build,
                    settings=_default_settings(),
                )
            locked_to = about_of(journal.records, path)
        if path.exists():
            lock = read_study_json(path)
            # An upgrade that was cut short is in the journal only.
            if {**lock, "build": 0} != {**locked_to, "build": 0}:
                raise StudyError(
                    "study.json is not what the journal of the study says",
                    where=str(path),
                    remedy="Restore both from a backup; nothing was changed",
                )
        self._about = locked_to
        write_atomically(path, json_bytes(self._about))
        if self._about["mode"] != self.mode:
            raise StudyError(
                f"this folder holds {self._about['mode']} data",
                where=str(self.path),
                got=self.mode,
                remedy="Choose another folder with --out",
            )
        before = self._about["build"]
        different, self.noted = changes(before, build), noted_changes(before, build)
        if not different and not self.noted:
            return
        if different and begun and not upgrade:
            design = self.path / DESIGN_FILE
            ours = any(name.startswith("design ") for name in different)
            raise StudyError(
                "the study is locked to the program, encoders, tasks and design that its "
                "participants had, and these differ now",
                where=str(self.path),
                got=", ".join(different),
                remedy="Restore the locked ones, begin a new folder with --out FOLDER, or continue "
                'with --force-upgrade "REASON", which is logged'
                + (f". The locked design is {design}: `diff` shows what differs" if ours else ""),
            )
        with self._journal() as journal:
            about = {"changed": [*different, *self.noted], "before": before, "after": build}
            if different and not begun and not upgrade:
                self.anew = different
                journal.append(ANEW, durable=True, **about)
            elif different:
                journal.append("upgrade", durable=True, reason=upgrade, **about)
            else:
                journal.append("libraries", durable=True, **about)
        self._about = {**self._about, "build": build}
        write_atomically(path, json_bytes(self._about))


def _default_settings() -> dict[str, Any]:
    """All settings of a trial with their defaults, as JSON."""
    from sandbox.trial.settings import Settings, encoded

    values: dict[str, Any] = json.loads(json.dumps(encoded(Settings())))
    return values


def about_of(records: list[Record], where: Path) -> dict[str, Any]:
    """Content of `study.json` according to the journal of the study.

    Raises:
        StudyError: The journal does not begin with the lock.
    """
    start = records[0] if records else {}
    if start.get("kind") != LOCK or not set(_ABOUT) <= start.keys():
        raise StudyError(
            "the journal of the study does not begin with what the study is locked to",
            where=str(where.with_name(STUDY_JOURNAL)),
            remedy="Restore it from a backup; nothing was changed",
        )
    # A merged study has the upgrades of its sites, too.
    own = [r for r in records if "site" not in r]
    builds = [r["after"] for r in own if r["kind"] in (ANEW, "upgrade", "libraries")]
    about = {name: start[name] for name in (*_ABOUT, SETTINGS) if name in start}
    return {**about, "build": builds[-1]} if builds else about


def copy_earlier_designs(source: Path, to: Path) -> None:
    """Copies the designs of earlier participants from one study folder to another."""
    for path in sorted((source / EARLIER).rglob("*")):
        if path.is_file():
            copy = to / path.relative_to(source)
            make_folder(copy.parent)
            write_atomically(copy, path.read_bytes())


def _readable(path: Path) -> Design | None:
    """A design, or None if it is not there or this version cannot read it."""
    from sandbox.study.design.design_file import load_design

    try:
        return load_design(path, try_out=False)
    except InputError:
        return None


def write_design(folder: Path, design: Design) -> None:
    """Writes a design and the files of its questionnaires into a study folder."""
    for name, data in design_files(design).items():
        make_folder((folder / name).parent)
        write_atomically(folder / name, data)


def design_files(design: Design) -> dict[str, bytes]:
    """The files of a design in a study folder, by name: the design and its questionnaires."""
    sources = (form.source for form in design.questionnaires if form.source)
    return {
        DESIGN_FILE: design.text.encode(),
        **{name: text.encode() for name, text in sources},
    }


def folder_of(out: Path, name: str, mode: str) -> Path:
    """Path of the folder of a study's data of one kind."""
    return out / (name if mode == REAL else f"{name}-{mode}")


def participants_of(records: list[Record]) -> list[Participant]:
    """The participants in a study's journal."""
    return [
        checked(
            record,
            Participant,
            StudyError,
            what="the record of a participant is damaged",
            where=f"{STUDY_JOURNAL}, record {record['n']}",
        )
        for record in records
        if record["kind"] == "participant"
    ]


def withdrawals_of(records: list[Record]) -> int:
    """Number of participants who withdrew, by a study's journal or that of an anonymous copy."""
    gone = {record["ppid"] for record in records if record["kind"] == WITHDRAWN}
    before = [r["about"].get(WITHDRAWN, 0) for r in records if r["kind"] == ANONYMISED]
    return len(gone) + sum(before)  # any order: whole numbers


def read_study_json(path: Path) -> dict[str, Any]:
    """Reads `study.json`.

    Raises:
        StudyError: The file cannot be read, or another version of the program wrote it.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise study_error(error, path, "the study cannot be read") from None
    what, where = "the study cannot be read", str(path)
    remedy = "Restore this file from a backup"
    check_layout(data, None, SCHEMA, StudyError, what=what, where=where, remedy=remedy)
    about = decoded_record(data, StudyError, what=what, where=where, remedy=remedy)
    checked(about, _StudyFile, StudyError, what=what, where=where, remedy=remedy)
    return about
