"""A policy sees places relative to the thing, plans touches, and is read as it was written."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

from models.arithmetic.arrays import Array
from models.errors import InputError
from models.surface import Surface
from sandbox.learning.policy import CHUNK, DONE_AT_ONCE, STRIDE, Player, Policy
from sandbox.learning.sight import sights


def moments(shift: Array, count: int = 40) -> dict[str, Array]:
    """Observations of three resting fingers beside a box; all of it shifted in the world."""
    surface = Surface()
    box = np.array([0.05 + shift[0], -0.06 + shift[1], 0.025])
    rows = np.zeros((count, 5, 3))
    offsets = np.array([[-0.03, 0.0], [0.03, 0.01], [0.03, -0.01]])
    rows[10:, :3, 0] = 1.0
    rows[10:, :3, 1:] = surface.to_surface(box) + offsets
    goal = np.array([0.06, 0.02, 0.0])
    state = np.concatenate([box, [1.0, 0, 0, 0], np.zeros(6)])
    return {
        "objects": np.tile(state, (count, 1, 1)),
        "goals": np.tile([*(box + goal), 0.3], (count, 1, 1)),
        "tips": np.tile(box, (count, 5, 1)),
        "touches": rows,
        "solid": np.zeros((count, 5)),
        "phase": np.zeros((count, 5)),
        "contact": np.zeros((count, 5, 2)),
    }


def policy(size: int) -> Policy:
    rng = np.random.default_rng(2)
    sizes = (size, 16, CHUNK // STRIDE * 15)
    pairs = list(pairwise(sizes))
    weights = tuple(rng.normal(0.0, 0.1, pair) for pair in pairs)
    return Policy(np.zeros(size), np.ones(size), weights, tuple(np.zeros(b) for _, b in pairs))


def test_only_the_place_of_the_thing_itself_tells_where_on_the_surface_it_is() -> None:
    here = sights(moments(np.zeros(2)), Surface())
    there = sights(moments(np.array([0.03, -0.02])), Surface())
    changed = np.flatnonzero(np.abs(here - there).max(axis=0) > 1e-9)
    assert len(changed) == 2
    assert np.allclose(there[0, changed] - here[0, changed], [0.3, 0.2])


def test_what_is_seen_now_does_not_depend_on_what_comes_later() -> None:
    whole, surface = moments(np.zeros(2)), Surface()
    part = {name: values[:25] for name, values in whole.items()}
    assert np.array_equal(sights(whole, surface)[:25], sights(part, surface))


def test_it_is_read_as_it_was_written(tmp_path: Path) -> None:
    seen = sights(moments(np.zeros(2)), Surface())
    made = policy(seen.shape[1])
    made.save(tmp_path / "policy.npz")
    again = Policy.load(tmp_path / "policy.npz")
    for one, two in zip(made.plan(seen[-1]), again.plan(seen[-1]), strict=True):
        assert np.array_equal(one, two)
    (tmp_path / "cut.npz").write_bytes((tmp_path / "policy.npz").read_bytes()[:200])
    with pytest.raises(InputError, match="not a policy"):
        Policy.load(tmp_path / "cut.npz")


def test_it_plays_in_the_environment_and_its_touches_stay_on_the_surface() -> None:
    env: Any = gymnasium.make(
        "sandbox.gym:hand_sandbox/BoxToGoalLearn-v1", names="found", observe="all"
    ).unwrapped
    seen, _ = env.reset(seed=7)
    (surface,) = env.surfaces
    size = sights({name: values[None] for name, values in seen.items()}, surface).shape[1]
    player = Player(policy(size), surface, seen)
    for _ in range(2 * DONE_AT_ONCE):
        action = player.act()
        assert action.shape == env.action_space.shape and np.isfinite(action).all()
        seen, *_ = env.step(action)
        player.see(seen)
    env.close()
