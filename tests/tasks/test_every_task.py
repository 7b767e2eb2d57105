"""Every task begins undone, stays undone by itself, and is refused where it has no room."""

from __future__ import annotations

import pytest

from models.errors import SurfaceTooSmallError
from models.surface import Surface
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.registry import TASKS, find_task
from tasks.task import place_surface

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


@pytest.mark.parametrize("name", TASKS)
def test_a_surface_without_room_is_refused_in_one_line(name: str) -> None:
    task = find_task(name)
    for size in NO_ROOM[name]:
        with pytest.raises(SurfaceTooSmallError) as error:
            task.draw(1, place_surface(Surface(*size), task))
        assert "\n" not in str(error.value)


@pytest.mark.parametrize("name", TASKS)
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
