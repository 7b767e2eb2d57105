"""Message for a screen too small for a task, whose objects keep their true size on it."""

from __future__ import annotations

import re
from dataclasses import replace

from models.errors import InputError
from models.surface import Surface
from sandbox.trial.assembly import place_surface
from sandbox.trial.settings import RunSettings
from tasks.registry import TASKS, draw_task, hands_of


def in_plain_words(error: InputError, settings: RunSettings) -> str:
    """Why a trial cannot begin, and what can be done instead, for somebody who plays.

    Args:
        error: Was raised when the trial was made.
        settings: Settings of the trial.
    """
    if "too small" not in error.what:
        return str(error)
    surface = settings.surface
    size = f"{surface.width_in:.1f} by {surface.height_in:.1f} inches"
    needed = re.sub(r"([\d.]+)x([\d.]+)in\b", r"\1 by \2 inches", error.expected or "")
    told = [
        f"This screen is too small for {error.where}: it has {size}, and here hand and things "
        f"have their true size. It needs {needed}."
    ]
    turned = replace(surface, width_in=surface.height_in, height_in=surface.width_in)
    if settings.task in TASKS and _fits(settings.task, turned, settings.seed):
        told.append("Turn the screen: then there is room.")
    elif others := [n for n in fitting(surface, settings.seed) if n != settings.task]:
        told.append(f"Tasks that have room here: {', '.join(others)}.")
    else:
        told.append(
            "No task has room on it. Open the link on a tablet or a laptop, which then plays; "
            "here you can look on."
        )
    if not surface.calibrated:
        told.append("Its size is a guess: under Tasks you can measure it with a bank card.")
    return "\n".join(told)


def fitting(surface: Surface, seed: int) -> tuple[str, ...]:
    """Names of our tasks for one hand that a surface has room for."""
    return tuple(
        name for name, task in TASKS.items() if hands_of(task) == 1 and _fits(name, surface, seed)
    )


def _fits(name: str, surface: Surface, seed: int) -> bool:
    task = TASKS[name]
    try:
        draw_task(task, seed, place_surface(surface, task))
    except InputError:
        return False
    return True
