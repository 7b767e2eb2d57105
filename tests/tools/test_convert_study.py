"""A study of the layout of before is brought into that of today, with the same tables."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterable
from hashlib import blake2b
from pathlib import Path
from typing import Any

import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.recording.recording import read_stored
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import digest_of, read_journal
from sandbox.study.record.notes import read_notes
from sandbox.study.record.records import RUNS
from sandbox.study.run.simulated_study import simulate
from tests.support.study_files import DESIGN, design, rows_of
from tools.convert_study import convert

BEFORE = {
    "session": "session_start",
    "resume": "session_resume",
    "end": "session_end",
    "done": "step_done",
    "answer": "draft",
    "form": "answers",
    "trial": "trial_start",
}
"""Names of kinds in the layout of before."""
TABLES = ("trials.csv", "participants.csv", "answers.csv", "events.csv")


def old_lines(records: Iterable[dict[str, Any]]) -> bytes:
    """Records as the lines of a journal of before."""
    before, lines = "", []
    for n, record in enumerate(records):
        kept = {k: v for k, v in record.items() if k not in ("n", "hash")}
        body = {"n": n, "clock": 0.0, **kept, "previous": before}
        text = json.dumps(body, separators=(",", ":"), ensure_ascii=False).encode()
        before = blake2b(text, digest_size=32).hexdigest()
        lines.append(text[:-1] + f',"digest":"{before}"}}\n'.encode())
    return b"".join(lines)


def as_before(study: StudyFolder, out: Path) -> Path:
    """The study in the layout of before."""
    notes = study.records()
    journal = [{**notes[0], "schema": 1, "study": "id"}]
    for person in study.participants():
        about = read_notes(study.path / person.ppid / "notes.jsonl")[0]
        kept = {k: v for k, v in about.items() if k not in ("site", "schema")}
        journal.append({**kept, "number": about["number"] - 1})
    out.mkdir()
    shutil.copyfile(study.path / "design.toml", out / "design.toml")
    (out / "study.jsonl").write_bytes(old_lines(journal))
    for record in study.path.glob("*/S001/session.jsonl"):
        session = out / record.parent.relative_to(study.path)
        for name in ("trials", "trackers"):
            (session / name).mkdir(parents=True)
        records = []
        for one in read_journal(record):
            kept = {k: v for k, v in one.items() if k not in ("files", "site")}
            if kept["kind"] in RUNS:
                kept |= {"schema": 2, "number": kept["number"] - 1}
            kept["kind"] = BEFORE.get(kept["kind"], kept["kind"])
            if kept.get("recording"):
                data = read_stored(record.parent / kept["file"]).data
                kept["recording"] = {"data": digest_of(data), "packed": None}
            records += [kept, {**one, "kind": "tables"}] if kept["kind"] == "trial_end" else [kept]
        (session / "journal.jsonl").write_bytes(old_lines(records))
        for path in (record.parent / "trials").iterdir():
            stem, _, rest = path.name.partition(".")
            if rest == "jsonl.gz":
                shutil.copyfile(path, session / "trials" / path.name)
            else:
                kind, _, ending = rest.partition(".")
                shutil.copyfile(path, session / "trackers" / f"{kind}_{stem}.{ending}")
    return out


def test_a_study_of_before_has_the_same_tables_in_the_new_layout_and_is_refused_in_the_old_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = StudyFolder(tmp_path / "a", design(), SIMULATED)
    simulate(study, 2, False, lambda text: None)
    old = as_before(study, tmp_path / "old")
    assert main(["study", "tables", str(old)]) == 2
    assert "python -m tools.convert_study" in capsys.readouterr().err
    assert main(["replay", str(old), "--verify"]) == 2
    assert "python -m tools.convert_study" in capsys.readouterr().err
    before = {p: p.read_bytes() for p in old.rglob("*") if p.is_file()}
    convert(old, tmp_path / "new")
    assert {p: p.read_bytes() for p in before} == before
    for name in TABLES:
        assert rows_of(tmp_path / "new/tables" / name) == rows_of(study.path / "tables" / name)
    assert main(["replay", str(tmp_path / "new"), "--verify"]) == 0
    assert StudyFolder.at(tmp_path / "new").design.text == DESIGN
    with pytest.raises(StudyError, match="exists already"):
        convert(old, tmp_path / "new")


def test_a_journal_of_before_that_was_changed_is_not_converted(tmp_path: Path) -> None:
    study = StudyFolder(tmp_path / "a", design(), SIMULATED)
    simulate(study, 1, False, lambda text: None)
    old = as_before(study, tmp_path / "old")
    (journal,) = old.glob("*/S001/journal.jsonl")
    text = journal.read_bytes()
    journal.write_bytes(text.replace(b'"kind":"consent"', b'"kind":"consend"'))
    with pytest.raises(StudyError, match="damaged"):
        convert(old, tmp_path / "new")
    assert not (tmp_path / "new").exists()
