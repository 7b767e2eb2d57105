"""A damaged line of one record costs what is behind it, after a decision, and no other person's
data."""

from __future__ import annotations

from pathlib import Path

import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.study.record.folder import StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.share.verify import verify
from tests.support.study_driver import note
from tests.support.study_files import rows_of


@pytest.fixture
def damaged(study: StudyFolder) -> StudyFolder:
    """A study, of which the middle line of the first session has a flipped bit."""
    journal = journal_of(study)
    lines = journal.read_bytes().splitlines(keepends=True)
    middle = bytearray(lines[len(lines) // 2])
    middle[len(middle) // 2] ^= 1
    lines[len(lines) // 2] = bytes(middle)
    journal.write_bytes(b"".join(lines))
    return study


def journal_of(study: StudyFolder, person: int = 0) -> Path:
    return session_path(study.path, people(study)[person]) / "session.jsonl"


def people(study: StudyFolder) -> list[str]:
    return [person.ppid for person in study.participants()]


def test_a_damaged_line_is_a_loss_that_can_be_accepted(
    damaged: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    journal = journal_of(damaged)
    broken = journal.read_bytes()
    with pytest.raises(StudyError, match=r"backup; or .*--accept-loss"):
        read_journal(journal)
    assert main(["study", "tables", str(damaged.path)]) == 1
    assert "--accept-loss" in capsys.readouterr().out
    assert journal.read_bytes() == broken
    assert note(damaged.path, people(damaged)[0], "--accept-loss", "a flipped bit") == 0
    before = broken.splitlines()
    kept = journal.read_bytes().splitlines()
    assert kept[: len(before) // 2] == before[: len(before) // 2]
    assert before[len(before) // 2] not in kept
    (copy,) = journal.parent.glob("damaged-*")
    assert copy.read_bytes() == broken
    assert verify(damaged.path, replays=False).sound, capsys.readouterr().out


def test_a_loss_can_be_accepted_while_another_record_is_damaged(
    damaged: StudyFolder, capsys: pytest.CaptureFixture[str]
) -> None:
    other = journal_of(damaged, 1)
    other.write_bytes(other.read_bytes().replace(b'"trial":1,', b'"trial":2,', 1))
    assert note(damaged.path, people(damaged)[0], "--accept-loss", "a flipped bit") == 0
    assert "tables are not up to date" in capsys.readouterr().out
    assert note(damaged.path, people(damaged)[1], "--accept-loss", "another one") == 0
    assert main(["study", "tables", str(damaged.path)]) == 0


def test_who_withdraws_is_deleted_while_another_record_is_damaged_and_in_no_table(
    damaged: StudyFolder, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    one, other = people(damaged)
    monkeypatch.setattr("builtins.input", lambda: other)
    assert note(damaged.path, people(damaged)[1], "--withdraw") == 1
    printed = capsys.readouterr().out
    assert f"{other} is deleted" in printed and one in printed
    assert not (damaged.path / other).exists()
    assert not any(other in p.read_text() for p in (damaged.path / "tables").glob("*.csv"))
    assert note(damaged.path, people(damaged)[0], "--accept-loss", "a flipped bit") == 0
    assert note(damaged.path, other, "--withdraw") == 0
    assert len(rows_of(damaged.path / "tables/participants.csv")) == 1
