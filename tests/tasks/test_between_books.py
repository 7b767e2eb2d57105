"""The task of the benchmark with two books is a fair one, and asks what it says."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from benchmarks.between_books import BOOK, GAP, POINTS, WAY, BetweenBooks, palm
from models.scene import Scene, SceneSpec
from models.surface import Surface
from sandbox.trial.assembly import place_surface
from tasks.sensing import Sensing

SURFACE = place_surface(Surface(), BetweenBooks)


def gap_of(task: BetweenBooks) -> float:
    """m between the inner faces of the books."""
    one, other = (np.array(book.position[:2]) for book in task.objects[1:])
    return float(np.linalg.norm(one - other)) - BOOK[1]


@pytest.mark.parametrize("seed", range(6))
def test_the_box_lies_between_the_books_and_goes_straight_in(seed: int) -> None:
    task = BetweenBooks.draw(seed, SURFACE)
    assert task == BetweenBooks.draw(seed, SURFACE)
    box, goal = task.objects[0], task.goals[0]
    way = np.array(goal.position[:2]) - box.position[:2]
    assert np.linalg.norm(way) == pytest.approx(WAY)
    assert np.arctan2(way[1], way[0]) == pytest.approx(goal.yaw + POINTS)
    assert gap_of(task) == pytest.approx(GAP)


def test_room_is_the_gap_and_nothing_else() -> None:
    task = BetweenBooks.draw(3, SURFACE)
    narrower = task.with_room(0.5)
    assert gap_of(narrower) == pytest.approx(GAP / 2)
    assert narrower.goals == task.goals and narrower.objects[0] == task.objects[0]


def test_a_book_that_was_moved_or_fell_is_no_success() -> None:
    task = BetweenBooks.draw(3, SURFACE)
    scene = Scene(SceneSpec((), task.objects, task.table_friction))
    data = mujoco.MjData(scene.model)
    data.joint("box").qpos[:2] = task.goals[0].position[:2]
    for _ in range(200):
        mujoco.mj_step(scene.model, data)
    sensing = Sensing(scene, data)
    assert task.measure(sensing).reached
    data.joint("book1").qpos[0] += 0.02
    mujoco.mj_forward(scene.model, data)
    assert task.measure(sensing).reason == "a book has been moved"
    data.joint("book1").qpos[3:] = (np.cos(0.4), np.sin(0.4), 0.0, 0.0)
    mujoco.mj_forward(scene.model, data)
    assert task.measure(sensing).lost


def test_the_two_palms_are_farthest_apart_where_the_wrist_is_turned_to_the_left() -> None:
    apart = [
        float(np.linalg.norm(palm("mean pose", turned, 0) - palm("what ships", turned, 0)))
        for turned in (-40.0, 0.0, 40.0)
    ]
    assert apart[2] > apart[0] and apart[2] > apart[1]
