"""Success over many seeds: intervals, judged seeds and stored trials; long runs in the full CI."""

from __future__ import annotations

import gzip
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from benchmarks.judged import configuration, freeze, frozen_seeds, judged_seeds
from benchmarks.kept_trials import KeptTrials
from benchmarks.success import load, trial
from models.arithmetic import Array
from models.errors import InputError
from models.frames import Contact, TouchFrame
from models.pose import JOINTS
from models.scene import CONTROL_PERIOD
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings
from tasks.score import Scorer
from tests.support.scripted import Script


def test_judged_seeds_follow_from_the_frozen_configuration_alone() -> None:
    seeds = judged_seeds(20, "box-to-goal")
    assert seeds == judged_seeds(30, "box-to-goal")[:20]
    assert len(set(seeds)) == 20
    assert not {*seeds} & {*judged_seeds(20, "stack")}
    assert not {*seeds} & {*judged_seeds(20, "box-to-goal", "hand")}


def test_only_the_frozen_configuration_is_judged(tmp_path: Path) -> None:
    frozen = tmp_path / "frozen.json"
    freeze(frozen, configuration())
    seeds = frozen_seeds(5, "stack", "hand", frozen, configuration())
    other_task = configuration()
    other_task["tasks"]["box-to-goal"] += 1
    assert frozen_seeds(5, "stack", "hand", frozen, other_task) == seeds
    changed = configuration()
    changed["settings"]["physics"]["impulse"] *= 2.0
    for now, task in ((changed, "stack"), (other_task, "box-to-goal"), (other_task, "no-such")):
        with pytest.raises(InputError, match=r"benchmarks\.judged --freeze"):
            frozen_seeds(5, task, "hand", frozen, now)


@pytest.mark.full
@pytest.mark.parametrize("fingers", [2, 3, 5])
def test_what_ships_succeeds_in_95_of_100_judged_trials(fingers: int) -> None:
    results = [trial(("box-to-goal", "shipped", fingers, seed)) for seed in judged_seeds(100)]
    assert sum(r["success"] for r in results) >= 95


@pytest.mark.full
@pytest.mark.parametrize("row", ["user does nothing", "user touches at random"])
def test_control_users_succeed_in_under_5_of_100_judged_trials(row: str) -> None:
    results = [trial(("box-to-goal", row, 3, seed)) for seed in judged_seeds(100)]
    assert sum(r["success"] for r in results) < 5


@pytest.mark.full
@pytest.mark.parametrize("task", ["stack", "stack-three", "wrench-slide", "wrench-turn"])
def test_random_touches_succeed_in_at_most_5_percent_of_40_judged_trials(task: str) -> None:
    job = task, "user touches at random", 3
    assert sum(trial((*job, seed))["success"] for seed in judged_seeds(40, task)) <= 2


class Nonsense(Script):
    """Contacts that come, go, jump and are cancelled at random."""

    def __init__(self, size: Array) -> None:
        super().__init__()
        self.rng, self.size, self.places = np.random.default_rng(0), size, dict[int, Array]()

    def poll(self, now: float) -> list[TouchFrame]:
        gone = {i for i in self.places if self.rng.random() < 0.05}
        cancelled = frozenset(i for i in gone if self.rng.random() < 0.5)
        self.places = {
            i: np.clip(
                place + self.rng.normal(0.0, 0.1 if self.rng.random() < 0.01 else 0.004, 2),
                0.0,
                self.size,
            )
            for i, place in self.places.items()
            if i not in gone
        }
        while self.rng.random() < 0.15 and len(self.places) < 8:
            self.places[int(self.rng.integers(0, 10**6))] = self.rng.uniform(0.0, self.size)
        contacts = tuple(Contact(i, *p.tolist()) for i, p in self.places.items())
        return [TouchFrame(now, contacts, cancelled=cancelled)]


@pytest.mark.parametrize("minutes", [0.25, pytest.param(10, marks=pytest.mark.full)])
@pytest.mark.parametrize("impulse", [100.0, 0.5])
def test_touches_without_any_sense_neither_diverge_nor_command_an_illegal_pose(
    impulse: float, minutes: float
) -> None:
    session = build(
        Settings().changed(impulse=impulse), (lambda task, surface: Nonsense(surface.size),)
    )
    skeleton = session.rigs[0].hand.skeleton
    for _ in range(round(60 * minutes / CONTROL_PERIOD)):
        session.advance()
        joints = session.reconstructions[0].q[JOINTS]
        assert np.all(joints > skeleton.lower - 1e-9) and np.all(joints < skeleton.upper + 1e-9)
        if session.over:
            # The trial has ended; the hand goes on.
            session.scorer = Scorer(session.task)
    assert np.isfinite(session.data.qpos).all()


class Job(NamedTuple):
    kind: str
    number: int


@dataclass(frozen=True)
class Outcome:
    length: float
    good: bool = True


def outcome(job: Job) -> Outcome:
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
    opened(file).play(outcome, JOBS[:2], 1)
    with file.open("ab") as torn:
        torn.write(b'{"job": ["a", 3], "outc')
    again = opened(file)
    assert list(again.done) == JOBS[:2]
    again.play(forbidden, JOBS[:2], 1)
    again.play(outcome, JOBS, 1)
    assert opened(file).done == {job: outcome(job) for job in JOBS}
    assert len(file.read_text().splitlines()) == 3


def refused_third(job: Job) -> Outcome:
    return forbidden(job) if job.number == 3 else outcome(job)


def test_an_error_of_a_trial_ends_the_run_and_those_before_it_are_in_the_file(
    tmp_path: Path,
) -> None:
    file = tmp_path / "trials.jsonl"
    with pytest.raises(AssertionError, match="played again"):
        opened(file).play(refused_third, JOBS, 1)
    assert list(opened(file).done) == JOBS[:2]


def test_trials_that_are_kept_compressed_are_not_played_again(tmp_path: Path) -> None:
    file, kept = tmp_path / "trials.jsonl", tmp_path / "kept.jsonl.gz"
    opened(file).play(outcome, JOBS[:2], 1)
    kept.write_bytes(gzip.compress(file.read_bytes()))
    file.unlink()
    assert opened(kept).done == {job: outcome(job) for job in JOBS[:2]}
    opened(file, kept).play(outcome, JOBS, 1)
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
