"""Recordings of finished trials are compressed, and neither a kill nor a full disk loses one."""

from __future__ import annotations

import resource
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from models.errors import StudyError
from sandbox.recording.recording_file import packed, read_stored, stored
from sandbox.study.record.files import sweep
from sandbox.study.record.kept_sessions import session_path
from sandbox.study.record.pack import pack
from sandbox.study.run.simulate import run_simulated
from tests.support.study_files import TRIALS, in_child, killed_after, open_study

Say = Callable[[str], object]


def recordings(folder: Path, count: int) -> dict[Path, bytes]:
    """Files that look like recordings, and what is in them."""
    rng = np.random.default_rng(8)
    made = {}
    for i in range(count):
        lines = [b'{"kind":"input","hash":"%s"}' % rng.bytes(16).hex().encode() for _ in range(900)]
        path = folder / f"T{i:03d}.jsonl"
        path.write_bytes(b"\n".join(lines) + b"\n")
        made[path] = path.read_bytes()
    return made


def test_every_finished_trial_is_compressed_and_its_row_says_where(tmp_path: Path) -> None:
    study = open_study(tmp_path)
    run_simulated(study, 0, lambda text: None)
    folder = session_path(study.path, study.participants()[0].ppid)
    files = sorted(p.name for p in (folder / "trials").iterdir())
    assert files == [f"T{n:03d}.jsonl.gz" for n in range(1, TRIALS + 1)]
    for table in (folder / "trial_results.csv", study.path / "trial_results.csv"):
        told = table.read_text()
        assert all(f"trials/{name}" in told for name in files)


def test_a_session_that_an_older_version_left_uncompressed_is_compressed_when_it_is_opened(
    tmp_path: Path,
) -> None:
    study = open_study(tmp_path)
    run_simulated(study, 0, lambda text: None)
    folder = session_path(study.path, study.participants()[0].ppid)
    small = folder / "trials/T002.jsonl.gz"
    before, plain = small.read_bytes(), folder / "trials/T002.jsonl"
    plain.write_bytes(read_stored(plain).data)
    small.unlink()
    run_simulated(study, 0, lambda text: None)
    assert small.read_bytes() == before and not plain.exists()


def test_a_kill_while_recordings_are_compressed_loses_none(tmp_path: Path) -> None:
    made = recordings(tmp_path, 4)

    def work(say: Say) -> None:
        while True:
            for path, data in made.items():
                pack(path)
                say("packed")
                path.write_bytes(data)

    rng, told = np.random.default_rng(9), 0
    for _ in range(15):
        killed, said = killed_after(in_child(work), float(rng.uniform(0.01, 0.15)))
        assert killed
        told += said.count("packed")
        for path, data in made.items():
            whole = Path(f"{path}.gz")
            # The plain file is half there where the kill came while this test wrote it.
            assert (whole if whole.exists() else path).exists()
            assert read_stored(whole if whole.exists() else path) == (data, True)
            path.write_bytes(data)
            pack(path)
            assert stored(path) == whole and read_stored(path) == (data, True)
        sweep(tmp_path)
        assert len(list(tmp_path.iterdir())) == len(made)
    assert told > 15


def test_where_there_is_no_room_the_recording_stays_as_it_is(tmp_path: Path) -> None:
    ((path, data),) = recordings(tmp_path, 1).items()

    def work(say: Say) -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
        try:
            pack(path)
        except StudyError as error:
            say(f"refused: {error}")

    killed, said = killed_after(in_child(work), 60.0)
    assert not killed and "refused" in said
    assert path.read_bytes() == data and [path] == list(tmp_path.iterdir())


def test_where_something_else_is_read_than_was_written_the_recording_stays_as_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ((path, data),) = recordings(tmp_path, 1).items()
    monkeypatch.setattr(
        "sandbox.study.record.pack.packed", lambda found: packed(found.replace(b"a", b"b"))
    )
    with pytest.raises(StudyError, match="not what was written"):
        pack(path)
    assert path.read_bytes() == data and [path] == list(tmp_path.iterdir())


def test_two_that_are_the_same_become_one_and_packing_twice_is_no_error(tmp_path: Path) -> None:
    ((path, data),) = recordings(tmp_path, 1).items()
    small = pack(path)
    path.write_bytes(data)
    assert pack(path) == small == pack(path)
    assert list(tmp_path.iterdir()) == [small]
    assert read_stored(path) == (data, True)


def test_a_file_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    (tmp_path / "T001.jsonl").mkdir()
    with pytest.raises(StudyError, match="cannot be read"):
        pack(tmp_path / "T001.jsonl")
