"""Converts a study from the layout before version 0.2.0 to the current layout, as a new folder.

    python -m tools.convert_study studies/OLD studies/NEW

The old layout has a journal of the study, `study.jsonl`, and in each session's folder
`journal.jsonl`, `trackers/` and tables. The lines of its journals are checked by their digests
before anything is written. The new records are chained and sealed like those of a new study.
"""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Mapping
from hashlib import blake2b
from pathlib import Path
from typing import Any

from models.errors import HandSandboxError, StudyError
from sandbox.study.record.durable_files import make_folder, write_atomically
from sandbox.study.record.folder import FILES, SITE, StudyFolder
from sandbox.study.record.journal import HASH, Record, chained_bytes, read_journal
from sandbox.study.record.notes import (
    ANEW,
    ANONYMISED,
    LIBRARIES,
    NOTES,
    PARTICIPANT,
    PERSON_NOTES,
    RELEASE,
    SEALED,
    STUDY,
    UPGRADE,
    WITHDRAWN,
    write_notes,
)
from sandbox.study.record.records import RUNS, SCHEMA
from sandbox.study.tables.tables import make_tables

DROPPED = ("tables", "packed", "moved", "left_out")
"""Old kinds of records that the current layout does not have."""
KINDS = {
    "session_start": "session",
    "session_resume": "resume",
    "session_end": "end",
    "step_done": "done",
    "calibration": "done",
    "draft": "answer",
    "answers": "form",
    "trial_start": "trial",
    "trial_broken": "trial_end",
    "recovered": "repaired",
    "lost": "repaired",
    "leftover": "repaired",
    "set_aside": "repaired",
}
"""Old kind of a record -> its name in the current layout, for kinds that were renamed."""
COMMANDS = ("pause", "go_on", "repeat", "skip", "exclude", "note")
"""Old kinds of records that are commands in the current layout."""


def old_records(path: Path) -> list[Record]:
    """Reads an old journal, and checks the digests of its records.

    Raises:
        StudyError: A line does not fit its digest.
    """
    records: list[Record] = []
    before, replaced = "", dict[str, str]()
    lines = path.read_bytes().split(b"\n")[:-1]
    others: dict[int, str] = {}
    for number, line in enumerate(lines, start=1):
        record: Record = json.loads(line)
        tail = f',"digest":"{record["digest"]}"}}'.encode()
        own = blake2b(line.removesuffix(tail) + b"}", digest_size=32).hexdigest()
        if record["previous"] != before or not line.endswith(tail):
            raise StudyError("the journal is damaged", where=f"{path}, line {number}")
        if own != record["digest"]:
            others[record["n"]] = own
        replaced |= record.get("replaced", {})
        before = record["digest"]
        records.append(record)
    wrong = [n for n, own in others.items() if replaced.get(str(n)) != own]
    if wrong:
        raise StudyError("the journal is damaged", where=f"{path}, record {wrong[0]}")
    return [{k: v for k, v in r.items() if k not in ("previous", "digest")} for r in records]


def convert(old: Path, new: Path) -> None:
    """Writes a study of the old layout in the current layout.

    Args:
        old: Folder with `study.jsonl`.
        new: Folder that does not exist yet.

    Raises:
        StudyError: `old` is not a study of the old layout, a journal is damaged, or `new` exists.
    """
    if not (old / "study.jsonl").is_file():
        raise StudyError(
            "not a study of the layout before 0.2.0",
            where=str(old),
            expected="a folder with study.jsonl",
        )
    if new.exists():
        raise StudyError("the folder exists already", where=str(new), remedy="Name a new folder")
    journal = old_records(old / "study.jsonl")
    people = [r for r in journal if r["kind"] == PARTICIPANT]
    sessions = {
        path: old_records(path / "journal.jsonl")
        for person in people
        for path in sorted((old / person["ppid"]).glob("S[0-9][0-9][0-9]"))
        if (path / "journal.jsonl").exists()
    }
    texts = _designs(old)
    make_folder(new / NOTES)
    for name, text in texts[""].items():
        make_folder((new / name).parent)
        write_atomically(new / name, text.encode())
    notes, begun = [_study(journal[0])], 0
    for record in journal:
        head = {"time": record["time"], "kind": record["kind"]}
        begun += record["kind"] in (PARTICIPANT, WITHDRAWN)
        if record["kind"] in (ANEW, UPGRADE, LIBRARIES):
            changed = {k: record[k] for k in ("changed", "before", "after")}
            more = {"reason": record["reason"], "people": begun} if "reason" in record else {}
            notes.append({**head, **changed, **more})
        elif record["kind"] == WITHDRAWN:
            notes.append({**head, "ppid": record["ppid"]})
        elif record["kind"] == ANONYMISED:
            notes.append({**head, "about": record["about"]})
    for person in people:
        freed = [r for r in journal if r["kind"] == "released" and r["ppid"] == person["ppid"]]
        own = [{**_without(person, "n", "clock"), "site": person.get("site", SITE)}]
        own += [{"time": r["time"], "kind": RELEASE, "reason": r["reason"] or ""} for r in freed]
        make_folder(new / person["ppid"])
        write_notes(new / person["ppid"] / PERSON_NOTES, own)
    for path, records in sessions.items():
        folder = new / path.relative_to(old)
        make_folder(folder / "trials")
        _copy_trials(path, folder / "trials")
        site = next(p.get("site", SITE) for p in people if p["ppid"] == path.parent.name)
        write_atomically(folder / "session.jsonl", _session(records, path.parent.name, site, texts))
        written = read_journal(folder / "session.jsonl")
        seal = {"records": len(written), HASH: written[-1][HASH]}
        of = {"ppid": path.parent.name, "session": int(path.name[1:])}
        notes.append({"time": written[-1]["time"], "kind": SEALED, **of, **seal})
    write_notes(new / NOTES / f"{SITE}.jsonl", notes)
    make_tables(StudyFolder.at(new))


def _study(lock: Record) -> Record:
    """First note of the study, from the first record of the old journal."""
    names = ("experiment", "mode", "build", "settings")
    kept: Record = {name: lock[name] for name in names if name in lock}
    return {"time": lock["time"], "kind": STUDY, "schema": SCHEMA, **kept}


def _without(record: Record, *names: str) -> Record:
    return {name: value for name, value in record.items() if name not in names}


def _designs(old: Path) -> dict[str, dict[str, str]]:
    """Digest of a design -> path of a file -> its text. The key of the latest design is empty."""
    folders = {"": old, **{path.name: path for path in sorted(old.glob("earlier_designs/*"))}}
    found = {}
    for digest, folder in folders.items():
        found[digest] = {
            path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8")
            for path in sorted(folder.rglob("*.toml"))
            if digest or "earlier_designs" not in path.parts
        }
    return found


def _session(
    records: list[Record], ppid: str, site: str, texts: Mapping[str, dict[str, str]]
) -> bytes:
    """Content of a session's record file in the current layout."""
    made: list[Record] = []
    design = ""
    for record in records:
        if record["kind"] in DROPPED:
            continue
        gone = ("study", "files") if record["kind"].startswith("session_") else ("files",)
        values: dict[str, Any] = _without(record, *gone)
        if isinstance(values.get("recording"), dict):
            values["recording"] = values["recording"].get("data", "left_out")
        kind = record["kind"]
        values["kind"] = "command" if kind in COMMANDS else KINDS.get(kind, kind)
        if kind in COMMANDS:
            values["command"] = kind
        if values["kind"] in RUNS:
            values |= {"ppid": ppid, "site": site}
            if record["design"] != design:
                design = record["design"]
                values[FILES] = texts.get(design, texts[""])
        made.append({**values, "n": len(made)})
    return chained_bytes(made)


def _copy_trials(session: Path, trials: Path) -> None:
    for path in sorted((session / "trials").iterdir()):
        shutil.copyfile(path, trials / path.name)
    for path in sorted((session / "trackers").glob("frames_T*.csv.gz")):
        stem = path.name.removeprefix("frames_").removesuffix(".csv.gz")
        shutil.copyfile(path, trials / f"{stem}.frames.csv.gz")


def main() -> int:
    """Converts a study; returns the exit status."""
    if len(sys.argv) != 3:
        print("usage: python -m tools.convert_study OLD NEW", file=sys.stderr)
        return 2
    try:
        convert(Path(sys.argv[1]), Path(sys.argv[2]))
    except HandSandboxError as error:
        print(error, file=sys.stderr)
        return 2
    print(f"{sys.argv[2]}: verify it with `sandbox replay {sys.argv[2]} --verify`")
    return 0


if __name__ == "__main__":
    sys.exit(main())
