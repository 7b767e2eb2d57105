"""Message for a screen too small for a task, whose objects keep their true size on it."""

from __future__ import annotations

import re
from dataclasses import replace

from models.errors import InputError
from models.surface import Surface
from sandbox.trial.assembly import place_surface
from sandbox.trial.settings import RunSettings
from tasks.registry import TASKS, draw_task, hands_of


def explain_refusal(error: InputError, settings: RunSettings) -> str:
    """Returns a message for the player on why a trial cannot begin, and what to do instead.

    Args:
        error: Error raised when the trial was built.
        settings: Settings of the trial.
    """
    if "too small" not in error.what:
        return str(error)
    surface = settings.surface
    size = f"{surface.width_in:.1f} by {surface.height_in:.1f} inches"
    needed = re.sub(r"([\d.]+)x([\d.]+)in\b", r"\1 by \2 inches", error.expected or "")
    message = [
        f"This screen is too small for {error.where}: it has {size}, and hand and objects are "
        f"shown in true size. The task needs {needed}."
    ]
    rotated = replace(surface, width_in=surface.height_in, height_in=surface.width_in)
    if settings.task in TASKS and _fits(settings.task, rotated, settings.seed):
        message.append("Rotate the screen: then there is enough room.")
    elif others := [n for n in fitting(surface, settings.seed) if n != settings.task]:
        message.append(f"Tasks that fit on it: {', '.join(others)}.")
    else:
        message.append(
            "No task fits on it. Open the link on a tablet or a laptop to play; this screen then "
            "shows the session."
        )
    if not surface.calibrated:
        message.append("Its size is a guess: under Tasks you can measure it with a bank card.")
    return "\n".join(message)


def fitting(surface: Surface, seed: int) -> tuple[str, ...]:
    """Returns the names of built-in tasks for one hand that fit on a surface."""
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
