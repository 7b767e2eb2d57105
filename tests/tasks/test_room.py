"""A surface that has no room for a task is refused in one line that says what needs room."""

from __future__ import annotations

import pytest

from models.errors import SurfaceTooSmallError
from models.surface import Surface
from tasks.registry import TASKS, find_task
from tasks.task import place_surface

NO_ROOM = {
    "box-to-goal": ("too small", [(2.0, 2.0), (3.0, 10.0), (5.0, 3.0)]),
    "stack": ("too small", [(2.0, 2.0), (2.5, 10.0), (4.0, 3.0)]),
    "stack-three": ("too small", [(2.0, 2.0), (2.5, 10.0), (4.0, 3.0)]),
    "stack-vertical": ("too small for this task", [(4.0, 6.0), (7.76, 3.0)]),
    "wrench-slide": ("too small", [(2.0, 2.0), (4.0, 3.0), (1.0, 12.0)]),
    "wrench-turn": ("too small", [(2.0, 2.0), (4.0, 3.0), (1.0, 12.0)]),
    "books": ("two books", [(5.0, 4.0)]),
    "slalom": ("two gates of pins", [(6.0, 4.0)]),
    "gather": ("a ring and twelve dice", [(7.0, 4.0), (4.6, 4.6)]),
    "insert": ("a peg on its way to a socket", [(3.0, 3.0)]),
    "close-case": ("a case between two hands", [(7.76, 5.82)]),
    "chords": ("five keys", [(4.0, 3.0)]),
    "single-keys": ("five keys", [(4.0, 3.0)]),
    "dial": ("a hand around a knob", [(3.0, 3.0)]),
    "carry-together": ("too small", [(7.76, 5.82)]),
}
"""What needs room, and inches of surfaces without it, by task."""


@pytest.mark.parametrize("name", TASKS)
def test_a_surface_without_room_is_refused_with_what_needs_room(name: str) -> None:
    task = find_task(name)
    needs, sizes = NO_ROOM[name]
    for size in sizes:
        with pytest.raises(SurfaceTooSmallError, match=needs) as error:
            task.draw(1, place_surface(Surface(*size), task))
        assert "\n" not in str(error.value)
