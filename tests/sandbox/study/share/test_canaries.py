"""A23: a shared folder has what is in a field of a study only if that is declared to be shared.

Canaries are unique texts. Fields are found by reflection, so that a new field has one by itself.
"""

from __future__ import annotations

import gzip
import json
import re
import types
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, Union, get_args, get_origin, get_type_hints

import pytest
from msgspec import Struct

from sandbox.recording.recording import SHARED_FIELDS, packed, read_stored
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import journal_bytes, read_journal
from sandbox.study.record.notes import (
    COPIED,
    EXCLUDE,
    FORMS,
    REMARK,
    SEALED,
    read_notes,
    write_notes,
)
from sandbox.study.record.records import forms, shared_fields
from sandbox.study.report.make import make_report
from sandbox.study.run.simulated_study import run_simulated
from sandbox.study.share.masking import PersonMasking, shared_line, shared_note, shared_records
from sandbox.study.share.shared_folder import Masking, share_study
from sandbox.study.share.verify import verify
from sandbox.trial.result import ResultRecord, TrialResult, record_fields
from tests.sandbox.study.share.test_share import TEXT, contents
from tests.support.study_files import design, quiet

MARK = "canary"


OWN = ("time", "clock", "hash", "ppid", "boot", "answers", "answer", "item", "calibration")
"""Fields that no record shares as they are."""


def canary(where: str, hint: Any) -> Any:
    """A value of a type that is nowhere else, or holds a text that is nowhere else."""
    kind = get_origin(hint) or hint
    if kind is Annotated:
        return canary(where, get_args(hint)[0])
    if kind in (Union, types.UnionType):
        return canary(where, next(h for h in get_args(hint) if h is not type(None)))
    if kind is dict:
        return {f"{MARK} key {where}": f"{MARK} {where}"}
    if kind in (list, tuple):
        return [f"{MARK} {where}"]
    if kind is datetime:
        return "2026-11-21T10:00:00.000+00:00"
    plain = {int: 1, float: 1.0, bool: True}
    return plain.get(kind, f"{MARK} {where}")


def canaries(form: type[Struct], name: str) -> dict[str, Any]:
    """A record or note with a canary in every declared field, and in one of a later version."""
    hints = get_type_hints(form, include_extras=True)
    fields = {f: canary(f"{name}.{f}.", hints[f]) for f in form.__struct_fields__}
    return {**fields, "later": f"{MARK} later"}


def found_in(value: Any) -> set[str]:
    """Fields whose canaries are in a JSON value."""
    text = json.dumps(value, ensure_ascii=False)
    return set(re.findall(rf"{MARK} (?:key )?[a-z_]+\.([a-z_]+)\.", text)) | (
        {"later"} if f"{MARK} later" in text else set()
    )


@pytest.mark.parametrize("words", [False, True])
@pytest.mark.parametrize("kind", sorted(forms()))
def test_a_record_shares_the_fields_that_are_declared_and_no_other(kind: str, words: bool) -> None:
    record = {**canaries(forms()[kind], kind), "kind": kind, "n": 0}
    if kind == "command":
        record["command"] = "note"
    if kind == "form":
        record["answers"] = {"item": f"{MARK} form.answers."}
    masking = PersonMasking("NEW", lambda form, item, answer: None, words)
    (found,) = shared_records([record], masking)
    declared = shared_fields(forms()[kind])
    allowed = {name for name, are_words in declared.items() if words or not are_words}
    assert found_in(found) <= allowed - {*OWN}
    assert found["time"].startswith("2000-01-01") and "2026" not in json.dumps(found)


@pytest.mark.parametrize("kind", sorted(FORMS))
def test_a_note_shares_the_fields_that_are_declared_and_no_other(kind: str) -> None:
    note = {**canaries(FORMS[kind], kind), "kind": kind}
    declared = shared_fields(FORMS[kind])
    found = found_in(shared_note(note, PersonMasking("NEW")))
    assert found <= {name for name, are_words in declared.items() if not are_words} - {*OWN}


def test_lines_of_a_recording_share_the_fields_that_are_declared_and_no_other() -> None:
    hints = get_type_hints(TrialResult, include_extras=True)
    result = {f: canary(f"result.{f}.", hints[f]) for f in TrialResult.__struct_fields__}
    result |= {"later": f"{MARK} later", "settings": {"task": "quick", "later": f"{MARK} later"}}
    shared = set(record_fields(ResultRecord.SHARED))
    for line in (
        {"kind": "header", "schema": 1, **result},
        {"kind": "end", "step": 1, "hash": "", "result": result},
    ):
        found = json.loads(shared_line(json.dumps(line).encode(), PersonMasking("NEW")))
        assert found_in(found) <= shared - {"study", "versions"}
    assert not shared & {"learned", "dump_error", "broken_off", "extra"}
    for kind in ("input", "event", "keyframe", "track"):
        line = {**dict.fromkeys(SHARED_FIELDS[kind], ""), "kind": kind, "later": MARK}
        assert MARK.encode() not in shared_line(json.dumps(line).encode(), PersonMasking("NEW"))
    assert shared_line(b'{"kind":"later","later":"canary"}', PersonMasking("NEW")) == b""


def poison_lines(lines: list[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Lines of a recording with canaries in everything that is not needed to play it."""
    for line in lines:
        line["later"] = f"{MARK} line"
        if line["kind"] == "header":
            line["settings"]["later"] = line["study"]["later"] = f"{MARK} header"
            line["versions"]["processor"] = line["versions"]["host"] = f"{MARK} machine"
        if line["kind"] == "end":
            yield {"kind": "event", "step": line["step"], "event": "clock", "host": f"{MARK} host"}
            yield {"kind": "later", "step": line["step"], "words": f"{MARK} kind"}
            line["result"] |= {
                **dict.fromkeys(("learned", "dump_error", "later"), f"{MARK} result"),
                "dump": f"/home/{MARK}/T001-diverged.jsonl",
            }
        yield line


def poison(study: StudyFolder) -> None:
    """Puts canaries into every field and file of a study from which it still can be read."""
    for path in study.path.glob("*/S001/session.jsonl"):
        records = read_journal(path)
        for record in records:
            form = forms()[record["kind"]]
            hints = get_type_hints(form, include_extras=True)
            for name in form.__struct_fields__:
                value = canary(f"{record['kind']}.{name}.", hints[name])
                needed = ("time", "hash", "ppid", "clock", "answers")
                if not isinstance(value, str) or name in needed:
                    continue
                if shared_fields(form).get(name, True):
                    record[name] = value
            record["later"] = f"{MARK} later"
            if record.get("form") == "demographics":
                record["answers"] |= {"remarks": f"{MARK} remarks", "later": f"{MARK} unasked"}
            if record.get("result"):
                record["result"] |= {"dump_error": f"{MARK} dump", "later": f"{MARK} result"}
            if record["kind"] == "session":
                record["user"]["later"] = record["build"]["later"] = f"{MARK} user"
                record["versions"]["processor"] = f"{MARK} processor"
        path.write_bytes(journal_bytes(records))
    for path in study.path.glob("*/S001/trials/T*.jsonl.gz"):
        lines = [json.loads(line) for line in read_stored(path).data.splitlines()]
        data = [json.dumps(line).encode() + b"\n" for line in poison_lines(lines)]
        path.write_bytes(packed(b"".join(data)))
    for path in study.path.glob("*/S001/trials/*.frames.csv.gz"):
        head, *rows = gzip.decompress(path.read_bytes()).decode().splitlines()
        text = "\n".join([f"{head},{MARK}", *(f"{row},{MARK} cell" for row in rows), ""])
        path.write_bytes(gzip.compress(text.encode()))
    for person in study.participants():
        after = {"1": 3}
        for kind in (REMARK, EXCLUDE):
            study.note_about(
                person.ppid,
                kind,
                reason=f"{MARK} {kind}",
                after=after,
                later=MARK,
                trial=2,
                session=1,
            )
    study.note(COPIED, path=f"/{MARK}", ppids=[MARK])
    for path in (*study.path.glob("notes/*.jsonl"), *study.path.glob("*/notes.jsonl")):
        notes = [{**note, "host": f"{MARK} note"} for note in read_notes(path)]
        write_notes(path, [note for note in notes if note["kind"] != SEALED])
    for folder in ("tables", "report", "forms", ".", *(p.ppid for p in study.participants())):
        (study.path / folder).mkdir(exist_ok=True)
        (study.path / folder / f"{MARK}.csv").write_text(f"{MARK}\n")


@pytest.fixture(scope="module")
def poisoned(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    study = StudyFolder(tmp_path_factory.mktemp("kept"), design(TEXT), SIMULATED)
    run_simulated(study, 1, quiet)
    poison(study)
    assert sum(data.count(MARK.encode()) for data in contents(study.path).values()) > 500
    return study


def shared(study: StudyFolder, out: Path, masking: Masking) -> dict[str, bytes]:
    """Files of the folder that is made of a study."""

    def finish(folder: Path) -> None:
        (folder / "report").mkdir()
        make_report(folder, folder / "report")

    share_study(study, out, masking, quiet, finish)
    return contents(out)


def test_no_canary_is_in_a_shared_folder_and_the_folder_replays_and_reports(
    poisoned: StudyFolder, tmp_path: Path
) -> None:
    out = tmp_path / "shared"
    files = shared(poisoned, out, Masking(hands=True))
    assert len(files) > 20 and any(name.endswith("T001.jsonl.gz") for name in files)
    for name, data in files.items():
        assert MARK not in name and MARK.encode() not in data, name
        assert poisoned.records()[0]["time"][:10].encode() not in data, name
    assert {"README.md", "verify.txt", "report/report.html", "report/analysis.R"} <= set(files)
    assert "tables/codebook.csv" in files and "anonymised.json" in files
    found = verify(out)
    assert found.sound, list(found.lines())


def test_with_words_kept_there_are_canaries_in_fields_with_words_alone(
    poisoned: StudyFolder, tmp_path: Path
) -> None:
    files = shared(poisoned, tmp_path / "words", Masking(words=True))
    text = "\n".join(data.decode(errors="replace") for data in files.values())
    told = set(re.findall(rf"{MARK}[a-z_ .]*", text))
    fields = {f"{MARK} {kind}.{name}." for kind in forms() for name in ("reason", "text", "why")}
    assert told and told <= {*fields, f"{MARK} remarks", f"{MARK} remark", f"{MARK} exclude"}
