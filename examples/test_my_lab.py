"""A lab's own task and encoder, tested over seeds. Copy it beside your code.

    pytest -p sandbox.regression --sandbox-update-baseline test_my_lab.py     once: makes baselines
    pytest -p sandbox.regression --sandbox-workers 2 test_my_lab.py           from then on

A test fails only on a loss beyond chance, and its message lists the seeds that were lost. With 8
seeds only a large loss is beyond chance; use more seeds to detect a small one
(docs/regression-runs.md). Put the baselines under version control, and review changes of them like
changes of code.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from encoders import builtin_capture, train
from tasks import Measure, Sensing, check_task
from tasks.box_to_goal import BoxToGoal

pytest_plugins = ["sandbox.regression"]

NEAR = 0.015
"""Largest distance (m) from the goal at which a box counts as put away."""


@dataclass(frozen=True)
class PutAway(BoxToGoal):
    """Bring the box to within 1.5 cm of its goal, in any orientation, and let go of it."""

    name: ClassVar[str] = "my-lab-put-away"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 15.0

    def measure(self, sensing: Sensing) -> Measure:
        """Returns whether the goal is reached, the progress from 0 to 1, and the reason."""
        box, goal = sensing.object("box"), np.asarray(self.goals[0].position)
        way = float(np.linalg.norm(goal - np.asarray(self.objects[0].position)))
        off = float(np.linalg.norm(goal - box.position))
        if off > NEAR:
            return Measure(False, float(np.clip(1 - off / way, 0, 0.99)), "it is not there yet")
        if box.held:
            return Measure(False, 0.99, "a hand still touches it")
        return Measure(True, 1.0, "")


def test_our_task_keeps_to_the_rules():
    check_task(PutAway)


def test_our_task_is_no_harder_than_it_was(regression):
    regression(PutAway, seeds="0:8", baseline="put-away.json")


def test_our_encoder_is_no_worse_than_best(regression):
    ours = train(builtin_capture(), "ours", degree=2, ridge=1e-3)
    regression(PutAway, "0:8", ours, "put-away.json", across_encoders=True)
