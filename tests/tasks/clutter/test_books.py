"""Books: every trial is a fair one, a book that moves ends it, and poses put palms elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arithmetic import Array
from models.surface import PRESETS, Surface
from tasks.box_to_goal import BORDER
from tasks.clutter.books import BEHIND, BOOK, GAP, MOVED, POINTS, TO_THE_LEFT, WAY, Books
from tasks.task import Measure
from tasks.variation import Variation, vary
from tests.support.simulation import run
from tests.support.task_scene import TaskScene

seeds = st.integers(0, 2**63 - 1)
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


@given(seed=seeds, surface=st.sampled_from([Surface(*s) for s in PRESETS.values() if s[1] > 5]))
def test_the_way_leads_straight_in_between_two_books_that_are_on_the_surface(
    seed: int, surface: Surface
) -> None:
    task = Books.draw(seed, surface)
    assert task == Books.draw(seed, surface)
    start, goal, books = places(task)
    along = (goal - start) / WAY
    assert np.linalg.norm(along) == pytest.approx(1.0)
    angle = np.arctan2(along[1], along[0])
    assert TO_THE_LEFT[0] - 1e-9 <= angle - np.pi / 2 <= TO_THE_LEFT[1] + 1e-9
    across = np.array([-along[1], along[0]])
    off = books - goal
    assert np.allclose(np.sort(off @ across), (GAP + BOOK[1]) / 2 * np.array([-1.0, 1.0]))
    assert np.allclose(off @ along, BOOK[0] / 2 - BEHIND)
    for book in task.objects[1:]:
        assert np.isclose(np.cos(book.yaw - angle), 1.0)
    on = surface.to_surface(np.array([t.position for t in task.objects]))
    assert np.all(on >= -1e-9) and np.all(on <= surface.size + 1e-9)
    assert np.all(on[0] >= BORDER - 1e-9)


@given(seed=seeds)
def test_a_hand_that_holds_two_faces_of_the_box_can_point_along_the_way(seed: int) -> None:
    task = Books.draw(seed, TABLET)
    start, goal, _ = places(task)
    way = np.arctan2(*(goal - start)[::-1])
    off = (task.objects[0].yaw - (way - POINTS)) % (np.pi / 2)
    assert min(off, np.pi / 2 - off) == pytest.approx(0.0, abs=1e-9)


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
