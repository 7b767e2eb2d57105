"""docs/page.md says which tasks have no room on which tablet."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from models.errors import InputError
from models.surface import PRESETS, Surface
from tasks.registry import TASKS, find_task

LIFT_CONTROL = 17.0 / 25.4
"""in, width of the lift control on most iPads."""

PAGE = (Path(__file__).parents[1] / "docs" / "page.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| `(ipad\S*)` \| (\S+) x (\S+) \| (.+) \|$", PAGE, re.MULTILINE)


def has_room(name: str, width: float, height: float) -> bool:
    """True if a task can be drawn for each of twelve seeds."""
    task = find_task(name)
    surface = Surface(width - (LIFT_CONTROL if task.lift_range else 0.0), height)
    try:
        for seed in range(12):
            task.draw(seed, surface)
    except InputError:
        return False
    return True


def test_the_table_has_every_preset_at_its_size() -> None:
    told = {name: (float(width), float(height)) for name, width, height, _ in ROWS}
    assert told == PRESETS


@pytest.mark.parametrize(("tablet", "width", "height", "tasks"), ROWS, ids=[r[0] for r in ROWS])
def test_the_tasks_without_room_are_those_that_the_table_names(
    tablet: str, width: str, height: str, tasks: str
) -> None:
    without = [name for name in TASKS if not has_room(name, float(width), float(height))]
    assert tasks.split(", ") == without
