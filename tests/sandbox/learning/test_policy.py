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
from sandbox.learning.sight import in_first_slots, sights


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
        "things": np.tile([0.1, 0.025, 0.025, 0.025], (count, 1, 1)),
        "tips": np.tile(box, (count, 5, 1)),
        "touches": rows,
        "names": np.where(rows[:, :, 0] > 0.5, np.arange(5), -1),
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


def test_touches_that_carry_the_thing_to_its_goal_have_no_way_left() -> None:
    # The first numbers are 50 times what is left to do for each touch, in m.
    seen, surface = moments(np.zeros(2)), Surface()
    left = sights(seen, surface)[-1, :6].reshape(3, 2) / 50.0
    box, goal = seen["objects"][-1, 0], seen["goals"][-1, 0]
    c, s = np.cos(goal[3]), np.sin(goal[3])
    for touch, way in zip(seen["touches"][-1, :3, 1:], left, strict=True):
        grip = surface.to_world(touch) - box[:3]
        turned = np.array([c * grip[0] - s * grip[1], s * grip[0] + c * grip[1], grip[2]])
        assert surface.to_surface(goal[:3] + turned) - touch == pytest.approx(way, abs=1e-12)


@pytest.mark.parametrize("edges, turns", [((0.025, 0.025), 4), ((0.0375, 0.0125), 2)])
def test_a_thing_that_looks_the_same_is_seen_the_same(
    edges: tuple[float, float], turns: int
) -> None:
    seen, surface = moments(np.zeros(2)), Surface()
    seen["things"][:, 0, 1:3] = edges
    for part in range(1, 2 * turns):
        angle = np.pi * part / turns
        turned = {name: values.copy() for name, values in seen.items()}
        turned["objects"][:, 0, 3], turned["objects"][:, 0, 6] = (
            np.cos(angle / 2),
            np.sin(angle / 2),
        )
        same = np.allclose(sights(seen, surface), sights(turned, surface), atol=1e-9)
        assert same == (part % 2 == 0)


def test_a_long_thing_shows_how_far_it_is_along_its_goal_and_across_it() -> None:
    seen, surface = moments(np.zeros(2)), Surface()
    cube = sights(seen, surface).shape[1]
    seen["things"][:, 0, 1:3] = 0.0375, 0.0125
    along = np.array([np.cos(0.3), np.sin(0.3)])
    before = sights(seen, surface)
    seen["objects"][:, 0, :2] -= 0.02 * along
    seen["touches"][10:, :3, 1:] += surface.to_surface(
        np.array([*(-0.02 * along), 0.0])
    ) - surface.to_surface(np.zeros(3))
    after = sights(seen, surface)
    assert before.shape[1] == after.shape[1] == cube + 6
    changed = (after - before)[-1]
    # Farther back along the goal by 20 mm, and no farther aside.
    assert np.isclose(changed, 50.0 * 0.02, atol=1e-9).sum() == 1
    assert np.isfinite(after).all()


def test_what_is_seen_does_not_depend_on_the_names_that_touches_were_given() -> None:
    surface = Surface()
    seen = moments(np.zeros(2))
    order = np.array([0, 1, 2, 3, 4])
    seen["tips"] = seen["tips"] + 0.01 * order[:, None]
    other = {name: values.copy() for name, values in seen.items()}
    other["names"][10:, :3] = [0, 2, 3]  # the same fingers of the person, named otherwise
    other["tips"][:, [2, 3]] = seen["tips"][:, [1, 2]]
    assert np.array_equal(sights(seen, surface), sights(other, surface))


def test_fingers_of_a_demonstration_take_the_first_slots_and_do_the_same() -> None:
    seen = moments(np.zeros(2), 61)
    moved = np.array([0, 2, 3, 1, 4])  # thumb, middle and ring finger
    actions = np.zeros((60, 5, 3))
    actions[9:50, :3] = seen["touches"][10, :3]
    seen["touches"][:] = 0.0
    seen["touches"][1:] = actions
    seen["names"] = np.where(seen["touches"][:, :, 0] > 0.5, moved, -1)
    other = {name: values.copy() for name, values in seen.items()}
    rows = np.zeros_like(actions)
    rows[:, moved] = actions
    other["touches"][:, moved], other["names"][:, moved] = seen["touches"], seen["names"]
    back, done = in_first_slots(other, rows.reshape(60, -1))
    assert np.array_equal(done.reshape(60, 5, 3), actions)
    assert np.array_equal(back["touches"], seen["touches"])
    assert np.array_equal(back["names"], seen["names"])


def test_a_policy_of_another_version_is_refused() -> None:
    seen = moments(np.zeros(2))
    first = {name: values[0] for name, values in seen.items()}
    with pytest.raises(InputError, match="trained by another version"):
        Player(policy(12), Surface(), first)


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
