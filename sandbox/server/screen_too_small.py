"""Sentences on a page that cannot show a trial, such as a screen too small for a task."""

from __future__ import annotations

from dataclasses import replace

from models.errors import InputError, SurfaceTooSmallError
from models.message import Message
from models.surface import METRES_PER_INCH, Surface
from sandbox.trial.lift import lifts
from sandbox.trial.settings import Settings
from tasks.guarded import draw_task
from tasks.registry import TASKS, hands_of
from tasks.task import place_surface

CANNOT_BEGIN = Message(
    "cannot_begin", "This cannot be played as it was asked for: the computer says why."
)
"""What a page says of every other error, whose text is for whoever typed the command."""


def explain_refusal(error: InputError, settings: Settings, strip_in: float = 0.0) -> list[Message]:
    """Returns what a player is told on why a trial cannot begin, and what to do instead.

    Args:
        error: Error raised when the trial was built.
        settings: Settings of the trial.
        strip_in: Inches of the screen's width that the lift control takes in tasks that lift.
    """
    if not isinstance(error, SurfaceTooSmallError):
        return [CANNOT_BEGIN]
    surface = settings.surface.rectangle
    strip = strip_in if lifts(settings) else 0.0
    sentences = [
        Message(
            "too_small_beside_lift" if strip else "too_small",
            "This screen is too small for {task}: it has {width_in} by {height_in} inches"
            f"{' beside the lift control' if strip else ''}, and hand and objects are shown in "
            "true size.",
            task=settings.task,
            **_lengths(surface.width_in, surface.height_in),
        )
    ]
    if error.example_in:
        text = "The task needs about {width_in} by {height_in} inches."
        sentences.append(Message("needs_room", text, **_lengths(*error.example_in)))
    whole = replace(surface, width_in=surface.width_in + strip)
    rotated = replace(whole, width_in=whole.height_in, height_in=whole.width_in)
    if settings.task in TASKS and _fits(settings.task, rotated, settings.seed, strip_in):
        sentences.append(Message("rotate_screen", "Rotate the screen: then there is enough room."))
    elif others := [n for n in fitting(whole, settings.seed, strip_in) if n != settings.task]:
        sentences.append(Message("tasks_that_fit", "Tasks that fit on it: {task}.", task=others))
    else:
        sentences.append(
            Message(
                "no_task_fits",
                "No task fits on it. Open the link on a tablet or a laptop to play; this screen "
                "then shows the session.",
            )
        )
    if not surface.calibrated:
        sentences.append(
            Message(
                "size_is_a_guess",
                "Its size is a guess: under Tasks you can measure it with a bank card.",
            )
        )
    return sentences


def _lengths(width_in: float, height_in: float) -> dict[str, str]:
    """Width and height in inches and in centimetres: a language says one of them."""
    cm = 100.0 * METRES_PER_INCH
    return {
        "width_in": f"{width_in:.1f}",
        "height_in": f"{height_in:.1f}",
        "width_cm": f"{cm * width_in:.1f}",
        "height_cm": f"{cm * height_in:.1f}",
    }


def fitting(screen: Surface, seed: int, strip_in: float = 0.0) -> tuple[str, ...]:
    """Returns the names of built-in tasks for one hand that fit on a screen.

    For `strip_in` see `explain_refusal`.
    """
    return tuple(
        name
        for name, task in TASKS.items()
        if hands_of(task) == 1 and _fits(name, screen, seed, strip_in)
    )


def _fits(name: str, screen: Surface, seed: int, strip_in: float) -> bool:
    task = TASKS[name]
    try:
        strip = strip_in if task.lift_range > 0 else 0.0
        surface = replace(screen, width_in=screen.width_in - strip)
        draw_task(task, seed, place_surface(surface, task))
    except InputError:
        return False
    return True
