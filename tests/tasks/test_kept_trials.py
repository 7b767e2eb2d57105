"""Trials of benchmarks are kept as they end: a run is resumed, and runs are joined."""

from __future__ import annotations

import gzip
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import NamedTuple

import pytest

from benchmarks.kept_trials import KeptTrials
from benchmarks.success import load
from models.errors import InputError


class Job(NamedTuple):
    kind: str
    number: int


@dataclass(frozen=True)
class Outcome:
    length: float
    good: bool = True


def trial(job: Job) -> Outcome:
    return Outcome(inf if job.number == 2 else job.number / 3, job.kind == "a")


def forbidden(job: Job) -> Outcome:
    raise AssertionError(f"{job} was played again")


def opened(*files: Path) -> KeptTrials[Job, Outcome]:
    return KeptTrials(Job, Outcome, files)


JOBS = [Job("a", 1), Job("b", 2), Job("a", 3)]


def test_a_run_that_is_resumed_plays_only_what_is_missing_after_a_torn_line(
    tmp_path: Path,
) -> None:
    file = tmp_path / "new folder" / "trials.jsonl"
    opened(file).play(trial, JOBS[:2], 1)
    with file.open("ab") as torn:
        torn.write(b'{"job": ["a", 3], "outc')
    again = opened(file)
    assert list(again.done) == JOBS[:2]
    again.play(forbidden, JOBS[:2], 1)
    again.play(trial, JOBS, 1)
    assert opened(file).done == {job: trial(job) for job in JOBS}
    assert len(file.read_text().splitlines()) == 3


def test_trials_that_are_kept_compressed_are_not_played_again(tmp_path: Path) -> None:
    file, kept = tmp_path / "trials.jsonl", tmp_path / "kept.jsonl.gz"
    opened(file).play(trial, JOBS[:2], 1)
    kept.write_bytes(gzip.compress(file.read_bytes()))
    file.unlink()
    assert opened(kept).done == {job: trial(job) for job in JOBS[:2]}
    opened(file, kept).play(trial, JOBS, 1)
    assert list(opened(file).done) == JOBS[2:]


@pytest.mark.parametrize("line", ["junk", "7", '{"task": "a"}', '{"job": ["a"], "outcome": {}}'])
@pytest.mark.parametrize("name", ["kept.jsonl", "kept.jsonl.gz"])
def test_a_file_of_something_else_is_one_clear_error_that_names_it(
    tmp_path: Path, line: str, name: str
) -> None:
    file, data = tmp_path / name, f"{line}\n".encode()
    file.write_bytes(gzip.compress(data) if file.suffix == ".gz" else data)
    for read in (opened, load):
        with pytest.raises(InputError, match=name):
            read(file)
