"""Books: every trial is a fair one, a book that moves ends it, and poses put palms elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

from models.arithmetic import Array
from models.surface import Surface
from tasks.clutter.books import BOOK, GAP, MOVED, Books
from tasks.task import Measure
from tasks.variation import Variation, vary
from tests.support.simulation import run
from tests.support.task_scene import TaskScene

TABLET = Surface().centred_at((0.0, 0.0, Books.touch_height))


def places(task: Books) -> tuple[Array, Array, Array]:
    """(2,), (2,) and (2, 2) m: start, goal, and middles of the books."""
    start, *books = (np.array(thing.position[:2]) for thing in task.objects)
    return start, np.array(task.goals[0].position[:2]), np.array(books)


class Trial(TaskScene[Books]):
    """A trial in its real scene, with the box at its goal."""

    def __init__(self, seed: int = 3) -> None:
        super().__init__(Books.draw(seed, TABLET))
        self.data.joint("box").qpos[:3] = self.task.goals[0].position


def test_a_box_at_its_goal_between_books_that_stand_is_there() -> None:
    trial = Trial()
    run(trial.scene, trial.data, 0.2)
    assert trial.measure() == Measure(True, 1.0, "")


@pytest.mark.parametrize("book", ["book1", "book2"])
def test_a_book_that_is_moved_by_a_centimetre_ends_the_trial(book: str) -> None:
    trial = Trial()
    trial.data.joint(book).qpos[0] += 0.9 * MOVED
    assert not trial.measure().lost
    trial.data.joint(book).qpos[0] += 0.2 * MOVED
    moved = trial.measure()
    assert moved.lost and not moved.reached and moved.reason == "a book has been moved"


@pytest.mark.parametrize("factor", [0.9, 1.2])
def test_room_is_the_gap_and_nothing_else(factor: float) -> None:
    task = Books.draw(5, TABLET)
    varied = vary(task, Variation(room=factor), TABLET)
    assert isinstance(varied, Books)
    before, after = places(task)[2], places(varied)[2]
    assert np.allclose(before.mean(axis=0), after.mean(axis=0))
    assert np.linalg.norm(after[0] - after[1]) - BOOK[1] == pytest.approx(factor * GAP)
    assert varied.objects[0] == task.objects[0] and varied.goals == task.goals
