"""Gather: every trial is a fair one, dice count where their middles are, sweeps bring them in."""

from __future__ import annotations

import numpy as np
import pytest

from models.surface import Surface
from tasks.clutter.gather import COUNT, EDGE, RADIUS, Gather
from tasks.task import Measure
from tasks.variation import Variation, vary
from tests.support.simulation import run
from tests.support.task_scene import TaskScene

TABLET = Surface().centred_at((0.0, 0.0, Gather.touch_height))


class Trial(TaskScene[Gather]):
    """A trial in its real scene, with dice put where a test wants them."""

    def __init__(self, seed: int = 3) -> None:
        super().__init__(Gather.draw(seed, TABLET))
        for goal in self.task.goals:
            self.data.joint(goal.object).qpos[:3] = goal.position


def test_dice_where_the_translucent_ones_are_are_all_in_the_ring() -> None:
    trial = Trial()
    places = np.array([goal.position for goal in trial.task.goals])
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) + np.eye(COUNT)
    assert apart.min() > 1.3 * EDGE
    run(trial.scene, trial.data, 0.3)
    assert trial.measure() == Measure(True, 1.0, "")


@pytest.mark.parametrize("inside", [True, False])
def test_a_die_counts_where_its_middle_is(inside: bool) -> None:
    trial = Trial()
    x, y = trial.task.ring.middle
    off = RADIUS + (-1e-4 if inside else 1e-4)
    trial.data.joint("die12").qpos[:3] = (x + off * np.cos(0.35), y + off * np.sin(0.35), EDGE / 2)
    measure = trial.measure()
    assert measure.reached == inside
    assert inside or measure.reason == "1 of the dice are not in the ring"
    assert inside or measure.progress == pytest.approx(11 / 12)


@pytest.mark.parametrize("factor", [0.8, 1.5])
def test_room_is_the_radius_of_the_ring_and_nothing_else(factor: float) -> None:
    task = Gather.draw(5, TABLET)
    varied = vary(task, Variation(room=factor), TABLET)
    assert isinstance(varied, Gather)
    assert varied.ring.radius == pytest.approx(factor * RADIUS)
    assert varied.ring.middle == task.ring.middle and varied.objects == task.objects
    off = [np.linalg.norm(np.subtract(g.position[:2], task.ring.middle)) for g in varied.goals]
    assert max(off) == pytest.approx(0.78 * factor * RADIUS)
