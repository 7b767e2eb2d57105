"""Recordings of finished trials are compressed, and neither a kill nor a full disk loses one."""

from __future__ import annotations

from pathlib import Path

import pytest

from models.errors import StudyError
from sandbox.recording.recording import packed, read_stored
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.record.trial_files import pack
from sandbox.study.run.simulated_study import run_simulated
from tests.support.study_files import open_study, quiet, recordings


def test_a_session_that_an_older_version_left_uncompressed_is_compressed_when_it_is_opened(
    tmp_path: Path,
) -> None:
    study = open_study(tmp_path)
    run_simulated(study, 1, quiet)
    folder = session_path(study.path, study.participants()[0].ppid)
    small = folder / "trials/T002.jsonl.gz"
    before, plain = small.read_bytes(), folder / "trials/T002.jsonl"
    plain.write_bytes(read_stored(plain).data)
    small.unlink()
    run_simulated(study, 1, quiet)
    assert small.read_bytes() == before and not plain.exists()


def test_where_something_else_is_read_than_was_written_the_recording_stays_as_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ((path, data),) = recordings(tmp_path, 1).items()
    monkeypatch.setattr(
        "sandbox.study.record.trial_files.packed", lambda found: packed(found.replace(b"a", b"b"))
    )
    with pytest.raises(StudyError, match="differs from what was written"):
        pack(path)
    assert path.read_bytes() == data and [path] == list(tmp_path.iterdir())


def test_two_that_are_the_same_become_one_and_packing_twice_is_no_error(tmp_path: Path) -> None:
    ((path, data),) = recordings(tmp_path, 1).items()
    small = pack(path)
    path.write_bytes(data)
    assert pack(path) == small == pack(path)
    assert list(tmp_path.iterdir()) == [small]
    assert read_stored(path) == (data, True)
