"""A record that is not what was sealed is refused and named, and nothing is written before somebody
has decided; the tables of before stay."""

from __future__ import annotations

import os
import shutil
import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import chained_bytes
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.share.withdraw import withdraw
from tests.support.study_driver import (
    SHORT_TRIALS,
    derived,
    everything,
    in_program,
    lost,
    note,
    record_of,
    records,
    results,
    resume,
    run,
    verify,
)
from tests.support.study_files import SHORT, design, rows_of

Rng = np.random.Generator


MUTATIONS = 100
"""Random mutations of each kind."""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(tmp_path_factory.mktemp("made"))


@pytest.fixture
def study(made: Path, tmp_path: Path) -> Path:
    shutil.copytree(made, tmp_path / made.name)
    return tmp_path / made.name


def cut(lines: list[bytes], rng: Rng) -> list[bytes]:
    return lines[: int(rng.integers(1, len(lines)))]


def flipped(lines: list[bytes], rng: Rng) -> list[bytes]:
    data = bytearray(b"".join(lines))
    data[int(rng.integers(len(data)))] ^= 1 << int(rng.integers(8))
    return [bytes(data)]


def moved(lines: list[bytes], rng: Rng) -> list[bytes]:
    one, other = rng.choice(len(lines), 2, replace=False)
    lines = list(lines)
    lines.insert(int(other), lines.pop(int(one)))
    return lines


def added(lines: list[bytes], rng: Rng) -> list[bytes]:
    at = int(rng.integers(len(lines)))
    return [*lines[: at + 1], lines[at], *lines[at + 1 :]]


@pytest.mark.parametrize("change", [cut, flipped, moved, added])
def test_a_sealed_record_that_was_changed_is_refused_and_named_and_nothing_is_written(
    study: Path, change: Callable[[list[bytes], Rng], list[bytes]]
) -> None:
    rng, record = np.random.default_rng(6), record_of(study)
    lines = record.read_bytes().splitlines(keepends=True)
    (study / "tables/trials.csv").unlink()
    for _ in range(MUTATIONS):
        record.write_bytes(b"".join(change(lines, rng)))
        before = everything(study)
        with pytest.raises(StudyError):
            resume(study)
        assert any(record.name in finding for finding in verify(study))
        left = everything(study)
        # Opening a study writes what it is locked to, which is what was there.
        assert left == before


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study whose only session was killed before it was sealed."""
    out = tmp_path_factory.mktemp("killed")

    def run_and_die() -> None:
        # The process is the test's child: nothing of the test is patched.
        SessionFolder.seal = lambda self: os.kill(os.getpid(), signal.SIGKILL)  # type: ignore
        run(out)

    assert in_program(run_and_die) == -signal.SIGKILL
    return next(out.iterdir())


def opened(study: Path) -> bool:
    """True if the program opens the session of a study's only participant."""
    folder = StudyFolder.at(study)
    try:
        SessionFolder(folder, folder.participants()[0]).close()
    except StudyError:
        return False
    return True


@pytest.mark.parametrize("change", [flipped, moved, added])
def test_a_record_that_was_changed_is_refused_although_nobody_has_sealed_it(
    killed: Path, change: Callable[[list[bytes], Rng], list[bytes]]
) -> None:
    rng, record = np.random.default_rng(7), record_of(killed)
    data = record.read_bytes()
    lines = data.splitlines(keepends=True)
    for _ in range(MUTATIONS):
        changed = b"".join(change(lines, rng))
        record.write_bytes(changed)
        # A last line without its end is what a kill leaves.
        assert (changed.endswith(b"\n") and not opened(killed)) or not changed.endswith(b"\n")
        record.write_bytes(data)


def test_a_record_that_nobody_has_sealed_and_that_ends_earlier_is_refused_if_a_recording_tells(
    killed: Path,
) -> None:
    """Nothing else shows a cut at the end of a line: its last hash is for the lab book."""
    record = record_of(killed)
    data = record.read_bytes()
    lines = data.splitlines(keepends=True)
    begins = [i for i, line in enumerate(lines) if b'"kind":"trial"' in line]
    assert len(begins) == SHORT_TRIALS
    for kept in range(1, len(lines)):
        record.write_bytes(b"".join(lines[:kept]))
        assert opened(killed) == (kept > begins[-1])
        record.write_bytes(data)


def test_after_an_accepted_loss_the_tables_of_before_are_there_until_their_people_withdraw(
    study: Path,
) -> None:
    before, record = derived(study), record_of(study)
    lines = record.read_bytes().splitlines(keepends=True)
    record.write_bytes(b"".join(lines[:-9]))
    (ppid,) = lost(study)
    assert main(["study", "tables", str(study)]) == 1
    assert derived(study) == before
    assert note(study, ppid, "--accept-loss", "the disk") == 0
    (kept,) = (study / "tables").glob("before-*")
    for name in ("answers.csv", "trials.csv"):
        assert (kept / name).read_bytes() == before[f"tables/{name}"]
    assert len(rows_of(study / "tables/answers.csv")) < len(rows_of(kept / "answers.csv"))
    assert verify(study) == []
    # The session goes on, and is complete again.
    resume(study)
    assert lost(study) == [] and verify(study) == []
    withdraw(StudyFolder.at(study), ppid)
    assert rows_of(kept / "answers.csv") == []


def test_a_record_that_was_written_anew_is_accepted_only_with_a_reason(study: Path) -> None:
    record, whole = record_of(study), records(study)
    for one in whole:
        if one["kind"] == "form":
            one["answers"] = dict.fromkeys(one["answers"], 0)
    record.write_bytes(chained_bytes(whole))
    with pytest.raises(StudyError, match="sealed records have changed"):
        resume(study)
    assert verify(study) != []
    (ppid,) = lost(study)
    assert note(study, ppid, "--accept-loss", "by hand") == 0
    resume(study)
    assert lost(study) == []


def test_a_design_that_changes_in_the_middle_needs_a_reason_and_leaves_earlier_rows(
    study: Path,
) -> None:
    before, text = results(study), SHORT.replace("step = 5", "step = 10")
    for changed in (text, SHORT.replace("seed = 3", "seed = 4"), SHORT + "# a remark\n"):
        with pytest.raises(StudyError, match="locked to"):
            run(study.parent, changed)
    again = StudyFolder(study.parent, design(text), SIMULATED, "a coarser scale")
    run(study.parent, text, people=2)
    after = results(again.path)
    for name, rows in before.items():
        assert after[name][: len(rows)] == rows
    assert len(after["participants.csv"]) == 2
    assert [r["reason"] for r in again.records() if r["kind"] == "upgrade"] == ["a coarser scale"]
