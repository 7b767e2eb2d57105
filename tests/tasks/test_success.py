"""Success over many seeds, and long hours of nonsense; runs with `.ci/run --full`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.judged import configuration, freeze, frozen_seeds, judged_seeds
from benchmarks.success import trial, wilson
from models.arithmetic import Array
from models.errors import InputError
from models.frames import Contact, TouchFrame
from sandbox.devices.device import Device
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings
from tasks.score import Scorer


def test_the_wilson_interval_is_the_published_one() -> None:
    # Newcombe (1998), Statistics in Medicine 17, table I: 81 of 263 and 0 of 20, method 3.
    assert np.allclose(np.array(wilson(81, 263)) / 100, (0.2553, 0.3662), atol=5e-5)
    assert np.allclose(np.array(wilson(0, 20)) / 100, (0.0, 0.1611), atol=5e-5)


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


class Nonsense(Device):
    """Contacts that come, go, jump and are cancelled at random."""

    name = "nonsense"
    finished = False

    def __init__(self, size: Array) -> None:
        self.rng = np.random.default_rng(0)
        self.size = size
        self.contacts: dict[int, Array] = {}

    def poll(self, now: float) -> list[TouchFrame]:
        gone = {i for i in self.contacts if self.rng.random() < 0.05}
        cancelled = frozenset(i for i in gone if self.rng.random() < 0.5)
        for i in gone:
            del self.contacts[i]
        for i, place in self.contacts.items():
            jump = self.rng.normal(0.0, 0.1 if self.rng.random() < 0.01 else 0.004, 2)
            self.contacts[i] = np.clip(place + jump, 0.0, self.size)
        while self.rng.random() < 0.15 and len(self.contacts) < 8:
            new = int(self.rng.integers(0, 10**6))
            self.contacts[new] = self.rng.uniform(0.0, 1.0, 2) * self.size
        contacts = tuple(Contact(i, *p.tolist()) for i, p in self.contacts.items())
        return [TouchFrame(now, contacts, cancelled=cancelled)]

    def close(self) -> None:
        pass


@pytest.mark.full
@pytest.mark.parametrize("impulse", [100.0, 0.5])
def test_ten_minutes_of_nonsense_neither_diverge_nor_command_an_illegal_pose(
    impulse: float,
) -> None:
    session = build(
        Settings().changed(impulse=impulse), (lambda task, surface: Nonsense(surface.size),)
    )
    skeleton = session.rigs[0].hand.skeleton
    for _ in range(10 * 60 * 62):
        session.advance()
        joints = session.reconstructions[0].q[6:]
        assert np.all(joints > skeleton.lower - 1e-9) and np.all(joints < skeleton.upper + 1e-9)
        if session.over:
            # The trial has ended; the hand goes on.
            session.scorer = Scorer(session.task)
    assert np.isfinite(session.data.qpos).all()
