"""Books, slalom and gather: what is in the way ends a trial, dice count by their middles, and room
is varied alone."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import pdist

from models.arithmetic import Array
from models.objects import Cylinder
from models.rotations import exp, matrix_to_quaternion
from models.surface import Surface
from tasks.books import BOOK, GAP, MOVED, Books
from tasks.gather import EDGE, RADIUS, Gather
from tasks.slalom import FALLEN, OPENING, PIN_RADIUS, Slalom
from tasks.task import Task
from tasks.variation import Variation, vary
from tests.support.task_scene import TaskScene

TABLET = Surface().centred_at((0.0, 0.0, 0.006))
seeds = st.integers(0, 2**63 - 1)


@pytest.mark.parametrize("book", ["book1", "book2"])
def test_a_book_that_is_moved_by_a_centimetre_ends_the_trial(book: str) -> None:
    trial = TaskScene(Books.draw(3, TABLET)).at_goals()
    trial.data.joint(book).qpos[0] += 0.9 * MOVED
    assert not trial.measure().lost
    trial.data.joint(book).qpos[0] += 0.2 * MOVED
    moved = trial.measure()
    assert moved.lost and not moved.reached and moved.reason == "a book has been moved"


@pytest.mark.parametrize("pin", ["pin1", "pin2", "pin3", "pin4"])
def test_a_pin_that_leans_is_not_enough_and_one_that_fell_ends_the_trial(pin: str) -> None:
    trial = TaskScene(Slalom.draw(3, TABLET)).at_goals()

    def tilt(angle: float) -> None:
        trial.data.joint(pin).qpos[3:] = matrix_to_quaternion(exp(np.array([angle, 0.0, 0.0])))

    tilt(np.deg2rad(8.0))
    leaning = trial.measure()
    assert leaning.reason == "a pin does not stand upright" and not leaning.lost
    tilt(FALLEN + 0.01)
    fallen = trial.measure()
    assert fallen.reason == "a pin has been toppled" and fallen.lost and not fallen.reached


@pytest.mark.parametrize("inside", [True, False])
def test_a_die_counts_where_its_middle_is(inside: bool) -> None:
    trial = TaskScene(Gather.draw(3, TABLET)).at_goals()
    x, y = trial.task.ring.middle
    off = RADIUS + (-1e-4 if inside else 1e-4)
    trial.data.joint("die12").qpos[:3] = (x + off * np.cos(0.35), y + off * np.sin(0.35), EDGE / 2)
    measure = trial.measure()
    assert measure.reached == inside
    assert inside or measure.reason == "1 of the dice are not in the ring"
    assert inside or measure.progress == pytest.approx(11 / 12)


def pairs(task: Task) -> Array:
    """(n, 2, 2) m, middles of the books, or of the pins of each gate."""
    return np.array([each.position[:2] for each in task.objects[1:]]).reshape(-1, 2, 2)


def straight_path(task: Task) -> tuple[Array, Array]:
    """Axes (2, 2) along and across the straight path from start to goal, and that path (2,) m."""
    way = np.subtract(task.goals[0].position, task.objects[0].position)[:2]
    x, y = way / np.linalg.norm(way)
    return np.array([[x, y], [-y, x]]), way


@given(seed=seeds)
def test_gates_are_8_mm_to_either_side_of_the_straight_path_and_5_cm_apart(seed: int) -> None:
    task = Slalom.draw(seed, TABLET)
    axes, way = straight_path(task)
    middles = (pairs(task).mean(axis=1) - task.objects[0].position[:2]) @ axes.T
    assert sorted(middles[:, 1]) == pytest.approx([-0.008, 0.008])
    assert 0.0 < middles[0, 0] == pytest.approx(middles[1, 0] - 0.050)
    assert middles[1, 0] < np.linalg.norm(way)
    assert np.diff(pairs(task) @ axes[0], axis=1) == pytest.approx(0.0)
    on = TABLET.to_surface(np.array([each.position for each in task.objects]))
    assert np.all(on >= 0.005 - 1e-9) and np.all(on <= TABLET.size - 0.005 + 1e-9)


@given(seed=seeds)
def test_the_path_leads_to_the_left_in_between_two_books_and_the_box_is_askew_to_it(
    seed: int,
) -> None:
    task = Books.draw(seed, TABLET)
    axes, _ = straight_path(task)
    angle = np.arctan2(axes[0, 1], axes[0, 0])
    assert 60.0 - 1e-9 <= np.rad2deg(angle) - 90.0 <= 75.0 + 1e-9
    middles = (pairs(task)[0] - task.objects[0].position[:2]) @ axes.T
    assert sorted(middles[:, 1]) == pytest.approx([-(GAP + BOOK[1]) / 2, (GAP + BOOK[1]) / 2])
    # The box stands 4 cm inside of the gap.
    assert middles[:, 0] - BOOK[0] / 2 == pytest.approx(-0.040)
    box, *books = task.objects
    assert np.cos(4 * (box.yaw - angle)) == pytest.approx(-1.0)
    assert [np.cos(2 * (book.yaw - angle)) for book in books] == pytest.approx([1.0, 1.0])


@given(seed=seeds)
def test_twelve_dice_are_apart_outside_of_the_ring_and_away_from_the_border(seed: int) -> None:
    task = Gather.draw(seed, TABLET)
    places = np.array([die.position for die in task.objects])
    assert len(places) == 12 and pdist(places).min() > 0.018
    assert np.linalg.norm(places[:, :2] - task.ring.middle, axis=1).min() > 0.040 + 0.012
    for place, border in (*((each, 0.028) for each in places), ([*task.ring.middle, 0.0], 0.055)):
        on = TABLET.to_surface(place)
        assert np.all(on >= border - 1e-9) and np.all(on <= TABLET.size - border + 1e-9)


@pytest.mark.parametrize(
    ("kind", "room", "thick"), [(Books, GAP, BOOK[1]), (Slalom, OPENING, 2 * PIN_RADIUS)]
)
@pytest.mark.parametrize("factor", [0.9, 1.2])
def test_room_is_the_gap_between_books_or_pins_and_nothing_else(
    kind: type[Task], room: float, thick: float, factor: float
) -> None:
    task = kind.draw(5, TABLET)
    varied = vary(task, Variation(room=factor), TABLET)
    before, after = pairs(task), pairs(varied)
    assert np.allclose(before.mean(axis=1), after.mean(axis=1))
    wide = np.linalg.norm(after[:, 0] - after[:, 1], axis=1) - thick
    assert np.allclose(wide, factor * room)
    assert varied.objects[0] == task.objects[0] and varied.goals == task.goals


@pytest.mark.parametrize("factor", [0.8, 1.5])
def test_room_is_the_radius_of_the_ring_and_nothing_else(factor: float) -> None:
    task = Gather.draw(5, TABLET)
    varied = vary(task, Variation(room=factor), TABLET)
    assert isinstance(varied, Gather)
    assert varied.ring.radius == pytest.approx(factor * RADIUS)
    assert varied.ring.middle == task.ring.middle and varied.objects == task.objects


def test_distances_to_a_cylinder_are_those_that_mujoco_measures() -> None:
    rng = np.random.default_rng(4)
    pin = Cylinder("pin", 0.01, 0.03, 0.02, (0.1, 0.0, 0.03)).scaled(1.5)
    assert pin.position[2] == pytest.approx(0.045)
    turn, place = exp(rng.normal(size=3)), rng.normal(0.0, 0.05, 3)
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody>"
        "<body mocap='true'><geom name='a' type='cylinder' size='.015 .045'/></body>"
        "<body mocap='true'><geom name='b' type='sphere' size='.001'/></body></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    data.mocap_pos[0], data.mocap_quat[0] = place, matrix_to_quaternion(turn)
    points = place + rng.normal(0.0, 0.05, (40, 3))
    for point, far in zip(points, pin.clearance(points, place, turn), strict=True):
        data.mocap_pos[1] = point
        mujoco.mj_kinematics(model, data)
        if far > 0.002:
            assert far - 0.001 == pytest.approx(
                mujoco.mj_geomDistance(model, data, 0, 1, 1.0, None), abs=1e-6
            )
