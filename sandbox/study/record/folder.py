"""The folder of a study: its participants, and its lock to a program and a design.

OUT/EXPERIMENT/            real data; pilot data are in EXPERIMENT-pilot, simulated data in
                           EXPERIMENT-simulated
  design.toml              the design in force for the next session, with its questionnaires
  notes/SITE.jsonl         the study's name, mode and lock, seals, copies and withdrawals
  PPID/                    all data of one person
    notes.jsonl            the person's pseudonym, number and hand, and decisions about the person
    S001/                  a session
  tables/                  tables, which are derived from all other files

All data of a person are in the person's folder, except the seals of the sessions. Each site counts
its own participants. So the data of two computers are merged by copying the folders of people and
the notes of each site into one folder.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from models.errors import InputError, StudyError
from sandbox.study.design.design import Design
from sandbox.study.record.build import build_of, changes, noted_changes
from sandbox.study.record.copies import JOURNAL, person_folders, session_folders
from sandbox.study.record.durable_files import (
    locked,
    make_folder,
    remove_unfinished,
    write_atomically,
)
from sandbox.study.record.journal import Record, read_journal
from sandbox.study.record.notes import (
    ANEW,
    ANONYMISED,
    INCLUDE,
    LIBRARIES,
    NOTES,
    PARTICIPANT,
    PERSON_NOTES,
    RELEASE,
    STUDY,
    UPGRADE,
    WITHDRAWN,
    add_note,
    read_notes,
    site_notes,
    withdrawn,
)
from sandbox.study.record.pseudonym import new_pseudonym
from sandbox.study.record.records import RUNS, SCHEMA

if TYPE_CHECKING:
    from sandbox.trial.settings import Settings
    from tasks.user import UserConfiguration

REAL, PILOT, SIMULATED = "real", "pilot", "simulated"
"""Kinds of data. Each kind has its own folder, which is never opened as another kind, and every row
of the tables names the kind."""
SITE = "A"
"""Site of a study that is run at one place only."""


@dataclass(frozen=True)
class Participant:
    """A participant.

    Attributes:
        ppid: Pseudonym.
        number: 1, 2, ... in order of arrival at the site; it determines the orders of levels.
        hand: `right` or `left`, the hand with which the participant touches.
        hand_size: Length of that hand, relative to the hand on which the encoders were trained.
        language: Language of the texts.
        user: The simulated user's configuration; None for a person.
        site: The site; each site counts its own numbers.
    """

    ppid: str
    number: int
    hand: str = "right"
    hand_size: float = 1.0
    language: str = "en"
    user: dict[str, Any] | None = None
    site: str = SITE

    @property
    def simulated_user(self) -> UserConfiguration:
        """Configuration of the simulated user of a simulated participant.

        `user` also contains the skill, and, if an earlier version wrote it, values that no longer
        exist. These are ignored.
        """
        from tasks.user import UserConfiguration

        known = {each.name for each in fields(UserConfiguration)}
        values = {name: v for name, v in (self.user or {}).items() if name in known}
        return UserConfiguration(**{**values, "reaction": tuple(values["reaction"])})


DESIGN_FILE = "design.toml"
REPORT = "report.html"
"""File name of a report's page."""
SETTINGS = "settings"
"""Field of the first note of a site: the default settings of a trial when the study began. So a
later change of a default does not change a study that has begun."""
FILES = "files"
"""Field of the records with which a run begins: texts of the design and its questionnaires."""
OLD_LAYOUT = "study.jsonl"
"""A file of an earlier layout of studies; `python -m tools.convert_study` converts such a study."""


class StudyFolder:
    """Opens a study's folder, or creates it.

    Args:
        out: Folder of all studies.
        design: Design of this study.
        mode: `REAL`, `PILOT` or `SIMULATED`.
        upgrade: Reason to continue although the program, an encoder or the design has changed;
            if empty, such a change is refused.
        site: Letter of the site.

    Attributes:
        noted: Changes, since the study was last opened, of versions to which it is not locked.
        anew: Changes, since the study was last opened, of the program, encoders or design. They are
            accepted because the study has no participant yet.

    Raises:
        StudyError: The folder has participants and is locked to another program, encoder or design;
            it has data of another mode; or it cannot be written.
    """

    def __init__(
        self, out: Path, design: Design, mode: str, upgrade: str = "", site: str = SITE
    ) -> None:
        if not (len(site) == 1 and site.isascii() and site.isupper()):
            raise StudyError(
                "this is not the letter of a site",
                where="--site",
                got=site,
                expected="a letter, A to Z",
            )
        self.design, self.mode, self.site = design, mode, site
        self.path = folder_of(out, design.name, mode)
        self.noted: list[str] = []
        self.anew: list[str] = []
        self._designs: dict[str, Design] = {}
        _refuse_old_layout(self.path)
        make_folder(self.path / NOTES)
        with self.lock():
            remove_unfinished(self.path)
            self._lock_to(build_of(design), upgrade)
            write_design(self.path, design)

    @classmethod
    def at(cls, path: Path) -> StudyFolder:
        """Opens an existing study to read it, maintain it or build its tables.

        The build is not compared with the study's lock. The site is the first site in the folder.

        Raises:
            StudyError: The path is not a study folder, or the design cannot be read.
        """
        from sandbox.study.design.design_file import load_design

        _refuse_old_layout(path)
        sites = sorted((path / NOTES).glob("*.jsonl"))
        if not sites:
            raise StudyError(
                "not a study folder",
                where=str(path),
                expected="a folder that contains notes/A.jsonl, such as studies/NAME",
            )
        folder = cls.__new__(cls)
        folder.noted, folder.anew, folder._designs = [], [], {}
        folder.path, folder.site = path, sites[0].stem
        folder._take(read_notes(sites[0]))
        folder.mode = str(folder._about["mode"])
        folder.design = load_design(path / DESIGN_FILE, try_out=False)
        return folder

    @property
    def notes(self) -> Path:
        """File with the notes of this site."""
        return self.path / NOTES / f"{self.site}.jsonl"

    @property
    def about(self) -> dict[str, Any]:
        """First note of this site: schema, experiment, mode, settings, and the first build."""
        return dict(self._about)

    @property
    def build(self) -> dict[str, Any]:
        """Program, encoders and design to which the study is locked."""
        return dict(self._build)

    @property
    def settings(self) -> Settings:
        """Default settings of a trial, which the design's settings override."""
        from sandbox.trial.settings import Settings, decoded

        return decoded(self._about[SETTINGS]) if SETTINGS in self._about else Settings()

    def design_of(self, digest: str) -> Design:
        """Returns the design with a digest, from the records of a session.

        Returns the current design if no session has a design with this digest, or if this version
        of the program cannot read it.
        """
        if digest == self.design.digest:
            return self.design
        if digest not in self._designs:
            files = next((f for d, f in self._files() if d == digest), None)
            found = readable_design(files) if files else None
            self._designs[digest] = found or self.design
        return self._designs[digest]

    def session_designs(self) -> list[str]:
        """Digests of the designs by which sessions were run."""
        return list(dict.fromkeys(digest for digest, _ in self._files()))

    def _files(self) -> Iterator[tuple[str, dict[str, str]]]:
        """Digests and texts of the designs by which sessions were run."""
        for session in (s for p in person_folders(self.path) for s in session_folders(p)):
            for record in read_journal(session / JOURNAL):
                if record["kind"] in RUNS and FILES in record:
                    yield record["design"], record[FILES]

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Locks the files of the study, but not its sessions, which other programs may run."""
        with locked(self.path / ".lock", wait=True, what="the study"):
            yield

    def participants(self) -> list[Participant]:
        """All participants so far, in order of arrival.

        Raises:
            StudyError: Notes of a person are damaged.
        """
        return [person for person, _ in self._people()]

    def find(self, ppid: str, remedy: str = "") -> Participant:
        """Finds a participant by pseudonym.

        Args:
            ppid: The pseudonym.
            remedy: Remedy in the error; if empty, it names the table with all participants.

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
                remedy=remedy or "Check the id: tables/participants.csv of the study lists all ids",
            )
        return participant

    def add(self, number: int | None = None, **about: Any) -> Participant:
        """Adds a participant and creates the participant's folder.

        Args:
            number: Number of the participant. If another participant has this number, that
                participant is returned. None chooses the first free number of this site.
            about: Further attributes of `Participant`.

        Raises:
            StudyError: Another program has locked the study to another build since it was opened.
        """
        with self.lock():
            different = changes(self.build, _build_of(read_notes(self.notes)))
            if different:
                raise StudyError(
                    "another program has locked the study to other values since it was opened here",
                    where=str(self.path),
                    got=", ".join(different),
                    remedy="Begin the session again",
                )
            taken = self._holders()
            if number in taken:
                return taken[number]
            if number is None:
                number = _first_free(taken)
            gone = withdrawn(self.records())
            ppid = new_pseudonym()
            while ppid in gone or (self.path / ppid / PERSON_NOTES).exists():
                ppid = new_pseudonym()
            person = Participant(ppid, number, site=self.site, **about)
            make_folder(self.path / ppid)
            add_note(self.path / ppid / PERSON_NOTES, PARTICIPANT, schema=SCHEMA, **vars(person))
            return person

    def note(self, kind: str, /, **values: Any) -> Record:
        """Writes a note of this site, durably."""
        with self.lock():
            return add_note(self.notes, kind, **values)

    def note_about(self, ppid: str, kind: str, /, **values: Any) -> Record:
        """Writes a note about a person into their folder, durably."""
        with self.lock():
            return add_note(self.path / ppid / PERSON_NOTES, kind, **values)

    def records(self) -> list[Record]:
        """Notes of all sites."""
        return site_notes(self.path)

    def release(self, ppid: str, reason: str) -> None:
        """Frees a participant's number, so that the next new participant gets it and its orders."""
        self.note_about(ppid, RELEASE, reason=reason)

    def is_released(self, ppid: str) -> bool:
        """True if a participant's number was freed, and the participant was not included again."""
        return next((free for p, free in self._people() if p.ppid == ppid), False)

    def include(
        self, person: Participant, begun: bool, **values: Any
    ) -> tuple[Participant, Participant | None]:
        """Writes a note that a participant whose number was freed is included again.

        The participant gets the earlier number back. If another participant has it now, a
        participant without trials gets the first free number. A participant with trials shares the
        earlier number, since it determined the orders of these trials.

        Args:
            person: The participant.
            begun: True if the participant has begun a trial.
            values: Further values of the note.

        Returns:
            The participant with the number, and the other participant who has the earlier number,
            or None.
        """
        with self.lock():
            held = {
                p.number: p
                for p, free in self._people()
                if not free and p.site == person.site and p.ppid != person.ppid
            }
            number, other = person.number, held.get(person.number)
            if other is not None and not begun:
                number = _first_free(held)
            path = self.path / person.ppid / PERSON_NOTES
            add_note(path, INCLUDE, schema=SCHEMA, number=number, **values)
            return replace(person, number=number), other

    def _holders(self) -> dict[int, Participant]:
        """Participants of this site whose number was not freed, by number."""
        return {p.number: p for p, free in self._people() if not free and p.site == self.site}

    def _people(self) -> list[tuple[Participant, bool]]:
        """Participants in order of arrival, and whether their number was freed."""
        found = []
        gone = withdrawn(self.records())
        for folder in person_folders(self.path):
            path = folder / PERSON_NOTES
            notes = read_notes(path) if folder.name not in gone else []
            if not notes:
                # The participant withdrew, or the program was killed before the first note.
                continue
            person, free = person_of(notes[0], path), False
            for note in notes:
                free = note["kind"] == RELEASE or (free and note["kind"] != INCLUDE)
                if note["kind"] == INCLUDE and note.get("number") is not None:
                    person = replace(person, number=note["number"])
            found.append((notes[0]["time"], person, free))
        found.sort(key=lambda one: (one[0], one[1].site, one[1].number))
        return [(person, free) for _, person, free in found]

    def _take(self, notes: list[Record]) -> None:
        """Reads the first note and the lock of the study from the notes of this site."""
        self._about, self._build = notes[0] if notes else {}, _build_of(notes)
        if self._about.get("kind") != STUDY:
            raise StudyError(
                "the notes of a site do not begin with a note about the study",
                where=str(self.notes),
                remedy="Restore them from a backup; nothing was changed",
            )

    def _lock_to(self, build: dict[str, Any], upgrade: str) -> None:
        others = [n for n in self.records() if n["kind"] == STUDY]
        if not read_notes(self.notes):
            about = {"experiment": self.design.name, "mode": self.mode, "build": build}
            if not others or others[0]["mode"] == self.mode:
                add_note(self.notes, STUDY, schema=SCHEMA, **about, settings=_default_settings())
        self._take(read_notes(self.notes) or others)
        if self._about["mode"] != self.mode:
            raise StudyError(
                f"this folder holds {self._about['mode']} data",
                where=str(self.path),
                got=self.mode,
                remedy="Choose another folder with --out",
            )
        people = len(self._people()) + withdrawals_of(self.records())
        before = self._build
        different, self.noted = changes(before, build), noted_changes(before, build)
        if not different and not self.noted:
            return
        if different and people and not upgrade:
            design = self.path / DESIGN_FILE
            ours = any(name.startswith("design ") for name in different)
            raise StudyError(
                "the study is locked to the program, encoders, tasks and design that its "
                "participants had, but these have changed",
                where=str(self.path),
                got=", ".join(different),
                remedy="Restore the earlier ones, begin a new folder with --out FOLDER, or "
                'continue with --force-upgrade "REASON", which is recorded'
                + (f". The locked design is {design}: `diff` shows what differs" if ours else ""),
            )
        about = {"changed": [*different, *self.noted], "before": before, "after": build}
        if different and not people and not upgrade:
            self.anew = different
            add_note(self.notes, ANEW, **about)
        elif different:
            add_note(self.notes, UPGRADE, reason=upgrade, people=people, **about)
        else:
            add_note(self.notes, LIBRARIES, **about)
        self._build = build


def _first_free(taken: Collection[int]) -> int:
    """Returns the smallest free number."""
    return next(i for i in range(1, len(taken) + 2) if i not in taken)


def is_study(path: Path) -> bool:
    """True for the folder of a study, also in the layout of an earlier version."""
    return (path / NOTES).is_dir() or (path / OLD_LAYOUT).is_file()


def _refuse_old_layout(path: Path) -> None:
    if (path / OLD_LAYOUT).exists():
        raise StudyError(
            "this study has the layout of an earlier version",
            where=str(path),
            remedy=f"Run `python -m tools.convert_study {path} NEW` in a checkout: it makes a copy "
            "in the present layout",
        )


def _build_of(notes: list[Record]) -> dict[str, Any]:
    """The build to which a study is locked, from the notes of a site; empty without notes."""
    builds = [note["after"] for note in notes if note["kind"] in (ANEW, UPGRADE, LIBRARIES)]
    first: dict[str, Any] = notes[0].get("build", {}) if notes else {}
    return builds[-1] if builds else first


def _default_settings() -> dict[str, Any]:
    """All settings of a trial with their defaults, as JSON."""
    from sandbox.trial.settings import Settings, encoded

    values: dict[str, Any] = json.loads(json.dumps(encoded(Settings())))
    return values


def person_of(note: Record, where: Path) -> Participant:
    """Returns the participant described by the first note about them.

    Raises:
        StudyError: The note is of another kind.
    """
    if note["kind"] != PARTICIPANT:
        raise StudyError(
            "the notes of a person do not begin with a note about the participant",
            where=str(where),
            remedy="Restore them from a backup; nothing was changed",
        )
    # Notes of a later version may have more fields.
    return Participant(**{f.name: note[f.name] for f in fields(Participant) if f.name in note})


def readable_design(files: Mapping[str, str]) -> Design | None:
    """Reads a design from the texts of its files, by file name; None if this version cannot."""
    from sandbox.study.design.design_file import load_design

    with TemporaryDirectory() as folder:
        for name, text in files.items():
            path = Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(text.encode())
        try:
            return load_design(Path(folder, DESIGN_FILE), try_out=False)
        except InputError:
            return None


def write_design(folder: Path, design: Design) -> None:
    """Writes a design and the files of its questionnaires into a study folder."""
    for name, text in design_files(design).items():
        make_folder((folder / name).parent)
        write_atomically(folder / name, text.encode())


def design_files(design: Design) -> dict[str, str]:
    """Returns the texts of a design's files, by name.

    These are the design, the files of its questionnaires, and the file of its own measure.
    """
    sources = [form.source for form in design.questionnaires if form.source]
    sources += [design.own_source] if design.own_source else []
    return {DESIGN_FILE: design.text, **dict(sources)}


def folder_of(out: Path, name: str, mode: str) -> Path:
    """Path of the folder of a study's data of one kind."""
    return out / (name if mode == REAL else f"{name}-{mode}")


def withdrawals_of(notes: list[Record]) -> int:
    """Number of participants who withdrew, from the notes of a study or of an anonymous copy."""
    before = [n["about"].get(WITHDRAWN, 0) for n in notes if n["kind"] == ANONYMISED]
    return len(withdrawn(notes)) + sum(before)  # any order: whole numbers
