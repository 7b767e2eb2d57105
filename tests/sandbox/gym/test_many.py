"""Environments in several processes are those of one, and say what is wrong with them."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np
import pytest

from models.errors import InputError
from models.surface import Surface
from sandbox.gym import learning_id
from sandbox.gym.many import ManyEnvs
from tests.sandbox.gym.scripted_grip import ScriptedGrip

ID = learning_id("box-to-goal")
SURFACE = Surface().size


@pytest.fixture(scope="module")
def three() -> Iterator[ManyEnvs]:
    """Three environments in two processes."""
    made = ManyEnvs(ID, 3, 2, observe=["touches"])
    yield made
    made.close()


def test_states_are_those_of_one_environment_alone(three: ManyEnvs) -> None:
    seen, _ = three.reset(seed=[5, 6, 7])
    rng = np.random.default_rng(0)
    space: Any = three.single_action_space
    low, high = space.low, space.high
    actions = rng.uniform(low, high, (12, 3, len(low)))
    hashes: list[Any] = []
    for rows in actions:
        seen, rewards, ended, cut, info = three.step(rows)
        hashes.append(info["state_hash"])
    assert seen["touches"].shape == (3, 5, 3) and rewards.shape == ended.shape == cut.shape == (3,)
    for number, seed in enumerate((5, 6, 7)):
        env: Any = gymnasium.make(ID, observe=["touches"])
        env.reset(seed=seed)
        for rows, expected in zip(actions, hashes, strict=True):
            one, *_, own = env.step(rows[number])
            assert own["state_hash"] == expected[number]
        assert np.array_equal(one["tips"], seen["tips"][number])
        env.close()


def test_one_seed_is_that_of_the_first_and_the_others_follow(three: ManyEnvs) -> None:
    _, info = three.reset(seed=20)
    assert info["seed"].tolist() == [20, 21, 22]


def test_an_environment_that_is_over_starts_anew_at_the_next_step() -> None:
    many = ManyEnvs(ID, 1, 1)
    policy = ScriptedGrip(SURFACE)
    seen, _ = many.reset(seed=200)
    ended = np.zeros(1, bool)
    while not ended.any():
        seen, _, ended, cut, info = many.step(policy({k: v[0] for k, v in seen.items()})[None])
        assert not cut.any()
    assert info["is_success"][0] and info["trial"]["status"][0] == "held"
    seen, rewards, ended, _, info = many.step(np.zeros((1, 15)))
    assert not ended.any() and not rewards.any() and info["seed"][0] != 200
    assert seen["time"][0, 0] == 0.0
    many.close()


def test_spaces_have_a_row_for_each(three: ManyEnvs) -> None:
    seen, _ = three.reset(seed=3)
    assert three.num_envs == 3 and three.action_space.shape == (3, 15)
    assert three.observation_space.contains(seen)


def test_what_is_wrong_is_said_here(three: ManyEnvs) -> None:
    three.reset(seed=3)
    with pytest.raises(InputError, match="not finite"):
        three.step(np.full((3, 15), np.nan))
    with pytest.raises(InputError, match="an action for each"):
        three.step(np.zeros((2, 15)))
    with pytest.raises(InputError, match="a seed for each"):
        three.reset(seed=[1, 2])
    with pytest.raises(InputError, match="there must be environments"):
        ManyEnvs(ID, 0)
    with pytest.raises(InputError, match="there must be processes"):
        ManyEnvs(ID, 2, 0)


def test_the_process_that_asks_has_its_share() -> None:
    alone = ManyEnvs(ID, 2, 1)
    assert alone.pids == []
    alone.close()
    many = ManyEnvs(ID, 3, 8)
    assert len(many.pids) == 2
    many.close()


def test_a_process_that_has_ended_is_one_clear_error() -> None:
    many = ManyEnvs(ID, 2, 2)
    many.reset(seed=1)
    (other,) = many._processes
    other.kill()
    other.join()
    with pytest.raises(InputError, match="has ended") as error:
        many.step(np.zeros((2, 15)))
    assert "\n" not in str(error.value)
    many.close()


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="no choice of processors here")
def test_processes_are_as_many_as_this_program_has_processors_to_use() -> None:
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(before)})
    try:
        many = ManyEnvs(ID, 2)
        many.close()
        assert many.pids == []
    finally:
        os.sched_setaffinity(0, before)
