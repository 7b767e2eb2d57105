"""Every task has fair trials, which begin undone, stay undone by themselves, and can be done."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.errors import SurfaceTooSmallError
from models.surface import PRESETS, Surface
from sandbox.cli.common.command_line import parse
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.driver import play_trial
from sandbox.trial.result import TrialResult
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.guarded import build_scene, check_apart
from tasks.registry import TASKS, find_task, hands_of
from tasks.task import Measure, place_surface
from tasks.task_checks import check_task
from tests.support.simulation import run
from tests.support.task_scene import TaskScene

NO_ROOM = {
    "box-to-goal": [(2.0, 2.0), (3.0, 10.0), (5.0, 3.0)],
    "stack": [(2.0, 2.0), (2.5, 10.0), (4.0, 3.0)],
    "stack-three": [(2.0, 2.0), (2.5, 10.0), (4.0, 3.0)],
    "stack-vertical": [(4.0, 6.0), (7.76, 3.0)],
    "wrench-slide": [(2.0, 2.0), (4.0, 3.0), (1.0, 12.0)],
    "wrench-turn": [(2.0, 2.0), (4.0, 3.0), (1.0, 12.0)],
    "books": [(5.0, 4.0)],
    "slalom": [(6.0, 4.0)],
    "gather": [(7.0, 4.0), (4.6, 4.6)],
    "insert": [(3.0, 3.0)],
    "close-case": [(7.76, 5.82)],
    "chords": [(4.0, 3.0)],
    "single-keys": [(4.0, 3.0)],
    "dial": [(3.0, 3.0)],
    "carry-together": [(7.76, 5.82)],
}
"""Inches of surfaces without room, by task."""

every = pytest.mark.parametrize("name", TASKS)
metres = st.floats(-0.5, 0.5)


def played(words: str) -> TrialResult:
    """Result of a trial by the simulated user, as `sandbox run` plays it."""
    return play_trial(trial_settings(parse(TrialOptions, "sandbox run", words.split())))


@every
def test_every_task_keeps_to_the_rules(name: str) -> None:
    check_task(name, range(3))


@every
@settings(max_examples=10)
@given(seed=st.integers(0, 2**63 - 1), x=metres, y=metres)
def test_a_trial_follows_from_its_seed_and_moves_with_its_surface(
    name: str, seed: int, x: float, y: float
) -> None:
    task = find_task(name)
    here = place_surface(Surface(7.76 * hands_of(task), 5.82), task)
    shift = np.array([x, 0.0 if task.plane == "front" else y, 0.0])
    there = replace(here, origin=tuple(np.add(here.origin, shift).tolist()))
    one, again, moved = task.draw(seed, here), task.draw(seed, here), task.draw(seed, there)
    for a, b, c in zip(one.objects, again.objects, moved.objects, strict=True):
        assert (b.position, b.yaw) == (a.position, a.yaw)
        np.testing.assert_allclose(c.position, a.position + shift, atol=1e-12)
        assert c.yaw == a.yaw
    for g, h, i in zip(one.goals, again.goals, moved.goals, strict=True):
        assert h == g
        # A goal on an object is relative to that object.
        np.testing.assert_allclose(i.position, g.position + (not g.on) * shift, atol=1e-12)
        assert i.yaw == g.yaw


@every
@settings(max_examples=10)
@given(
    seed=st.integers(0, 2**63 - 1),
    size=st.sampled_from([size for size in PRESETS.values() if min(size) > 5.5]),
)
def test_on_every_tablet_objects_are_apart_and_they_and_their_goals_are_on_the_surface(
    name: str, seed: int, size: tuple[float, float]
) -> None:
    kind = find_task(name)
    surface = place_surface(Surface(size[0] * hands_of(kind), size[1]), kind)
    task = kind.draw(seed, surface)
    check_apart(build_scene(task), name, "")
    places = [each.position for each in task.objects]
    places += [goal.position for goal in task.goals if not goal.on]
    on = surface.to_surface(np.array(places))
    assert np.all(on >= 0.0) and np.all(on <= surface.size)


@pytest.mark.parametrize(
    ("name", "edges", "grams", "aside", "yaw", "way", "turn"),
    [
        ("box-to-goal", (50, 50), (50, 250), 17, 45, (50, 100), 45),
        ("slalom", (40, 40), (50, 150), 22, 45, (102, 114), 30),
        ("books", (40, 40), (50, 150), 22, 180, (60, 60), 0),
        ("stack", (40, 60), (50, 250), 12, 45, None, None),
        ("stack-three", (40, 60), (50, 250), 12, 45, None, None),
        ("stack-vertical", (40, 60), (50, 250), 20, 0, None, None),
    ],
)
@settings(max_examples=20)
@given(
    seed=st.integers(0, 2**63 - 1),
    size=st.sampled_from([size for size in PRESETS.values() if min(size) > 5.5]),
)
def test_boxes_and_their_goals_are_within_the_ranges_of_the_task_s_text(
    name: str,
    edges: tuple[int, int],
    grams: tuple[int, int],
    aside: int,
    yaw: int,
    way: tuple[int, int],
    turn: int,
    seed: int,
    size: tuple[float, float],
) -> None:
    """In mm, g and degrees; `aside` is from the face of an unrotated box to the border."""
    kind = find_task(name)
    surface = place_surface(Surface(*size), kind)
    task = kind.draw(seed, surface)
    boxes: Any = [each for each in task.objects if each.name in ("box", "base", "second", "third")]

    def check_place(position: Any, edge: float) -> None:
        assert position[2] == pytest.approx(edge / 2000)
        on, room = 1000 * surface.to_surface(position), edge / 2 + aside - 1e-6
        inside = (on >= room) & (on <= 1000 * surface.size - room)
        assert inside[0] and (inside[1] or surface.upright)

    for box in boxes:
        edge = 2000 * box.half_size[0]
        assert len(set(box.half_size)) == 1
        assert edges[0] - 1e-6 <= edge <= edges[1] + 1e-6
        assert grams[0] <= 1000 * box.mass <= grams[1]
        assert np.rad2deg(abs(box.yaw)) <= yaw + 1e-6
        check_place(box.position, edge)
    for a, b in combinations(boxes, 2):
        apart = np.linalg.norm(np.subtract(a.position, b.position)[:2])
        assert apart - a.half_size[0] - b.half_size[0] >= 0.030 - 1e-9
    for goal in task.goals:
        if not goal.on:
            (box,) = boxes
            check_place(goal.position, edge)
            far = 1000 * np.linalg.norm(np.subtract(goal.position, box.position))
            assert way[0] - 1e-6 <= far <= way[1] + 1e-6
            assert np.rad2deg(abs(goal.yaw - box.yaw)) <= turn + 1e-6


@pytest.mark.parametrize(
    "name", ["box-to-goal", "wrench-slide", "books", "slalom", "gather", "insert"]
)
def test_a_trial_is_won_by_objects_that_rest_where_their_goals_are_drawn(name: str) -> None:
    kind = find_task(name)
    trial = TaskScene(kind.draw(3, place_surface(Surface(), kind))).at_goals()
    run(trial.scene, trial.data, 0.3)
    assert trial.measure() == Measure(True, 1.0, "")


@every
def test_a_surface_without_room_is_refused_in_one_line(name: str) -> None:
    task = find_task(name)
    for size in NO_ROOM[name]:
        with pytest.raises(SurfaceTooSmallError) as error:
            task.draw(1, place_surface(Surface(*size), task))
        assert "\n" not in str(error.value)


@every
@pytest.mark.parametrize("seed", range(2))
def test_nothing_is_done_at_the_start_nor_without_a_touch(name: str, seed: int) -> None:
    chosen = trial_settings(TrialOptions(task=name, seed=seed, user="idle"))
    if len(chosen.hands) > 1:
        chosen = trial_settings(TrialOptions(task=name, seed=seed, user="idle", second_user="idle"))
    session = build(chosen, device_makers(chosen))
    for _ in range(30):
        snapshot = session.advance()
        for rig in session.rigs:
            rig.device.show(snapshot)
        assert not snapshot.score.instant and snapshot.score.progress < 0.05
    session.close()


@pytest.mark.parametrize(
    "words",
    [
        "stack --seed 2 --fingers 2",
        "stack --seed 2 --fingers 3",
        "stack --seed 2 --fingers 5",
        "stack --seed 0 --hand left",
        "stack --seed 0 --turn 180",
        "stack --seed 0 --hand-size 0.9",
        "stack-three --seed 0",
        "stack-vertical --seed 0",
        "stack-vertical --seed 3 --hand left --fingers 2",
        "wrench-turn --seed 3 --fingers 2",
        "wrench-turn --seed 3 --fingers 3",
        "wrench-turn --seed 3 --fingers 5",
        "wrench-turn --seed 1 --hand left --turn 90",
        "wrench-slide --seed 3 --fingers 2",
        "wrench-slide --seed 3 --fingers 3",
        "wrench-slide --seed 3 --fingers 5",
        "wrench-slide --seed 1 --hand left --turn 90",
        "wrench-turn --seed 1 --vary size=0.7",
        "wrench-turn --seed 1 --vary size=1.4",
        "wrench-slide --seed 1 --vary size=0.7 --fingers 5",
        "wrench-slide --seed 1 --vary size=1.4 --hand left --turn 90",
        "box-to-goal --seed 5 --fingers 3 --turn 90",
        "box-to-goal --seed 5 --fingers 3 --turn 180",
        "box-to-goal --seed 5 --fingers 3 --turn 270",
        "slalom --seed 6001 --solid hand --fingers 2",
        "slalom --seed 6001 --solid hand --fingers 5",
        "slalom --seed 6001 --solid fingertips --fingers 2",
        "slalom --seed 6001 --solid fingertips --fingers 5",
        "books --seed 7001 --solid hand --hand left",
        "books --seed 7001 --solid hand --hand right",
        "books --seed 7001 --solid fingertips --hand left",
        "books --seed 7001 --solid fingertips --hand right",
        "gather --seed 6000 --solid hand",
        "insert --seed 6300 --solid fingertips",
        "insert --seed 6300 --solid hand --vary room=0.5",
        "dial --seed 6000 --solid fingertips",
        "dial --seed 6000 --solid hand",
        "close-case --seed 6400 --solid fingertips",
        "close-case --seed 6400 --solid hand",
        "close-case --seed 6401 --hand left --hand right",
        "carry-together --seed 0",
        "carry-together --seed 4 --hand left --hand right",
        "carry-together --seed 3 --one-surface --surface 15.5x5.8in",
    ],
)
def test_the_simulated_user_does_it(words: str) -> None:
    result = played(words)
    assert result.success and result.final, result.reason
    assert result.respawned == 0 and result.task_version == find_task(result.task).version


@pytest.mark.parametrize(
    "task",
    [
        "books --seed 7001",
        "insert --seed 6300",
        "stack --seed 2",
        "wrench-slide --seed 3",
        "wrench-turn --seed 3",
    ],
)
def test_a_user_who_touches_at_random_does_not(task: str) -> None:
    assert not played(f"{task} --user random").success
