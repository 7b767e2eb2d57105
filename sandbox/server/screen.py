"""The touch rectangle of a page's screen, and messages for a player whose screen is too small."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from models.errors import InputError, SurfaceTooSmallError
from models.message import Message
from models.surface import METRES_PER_INCH, PRESETS, Surface
from sandbox.server.protocol import LIFT_STRIP_PX, PageScreen
from sandbox.trial.assembly import lifts
from sandbox.trial.settings import Settings
from tasks.guarded import draw_task
from tasks.registry import TASKS, hands_of
from tasks.task import place_surface

LARGEST = (10.32, 7.74)
"""Largest touch rectangle (in): that of the largest tablets. On a larger screen it is centred,
since a hand does not reach farther."""

LEAST = PRESETS["ipad2"]
"""Touch rectangle (in) on which every task fits."""


def room(screen: PageScreen, lifts: bool = False) -> tuple[float, float]:
    """Returns the largest width and height of a touch rectangle on a screen, inches.

    Args:
        screen: The screen.
        lifts: True for a task that lifts: the lift control is beside the rectangle.
    """
    width = max(screen.width_px - (LIFT_STRIP_PX if lifts else 0.0), 1.0)
    return width / screen.px_per_in, screen.height_px / screen.px_per_in


def rectangle(screen: PageScreen, hands: int = 1, lifts: bool = False) -> dict[str, Any]:
    """Returns the touch rectangle of a screen, as settings.

    It fills the screen, but is at most as large as the largest tablet, or for two hands as two of
    these tablets side by side. For `lifts` see `room`.
    """
    most = (hands * LARGEST[0], LARGEST[1])
    size = tuple(
        round(min(side, end), 4) for side, end in zip(room(screen, lifts), most, strict=True)
    )
    return {"size_in": size, "calibrated": screen.calibrated}


def scaled(screen: PageScreen, lifts: bool = False) -> dict[str, Any]:
    """Returns the touch rectangle, as settings, of a screen on which the table is drawn to scale.

    With a mouse, the table is as large as the largest tablet, in the proportions of the screen, but
    not smaller than the paper's table, so that every task fits. On a phone, it is as small as the
    paper's table allows, so that fingers cover less of it. Results count for a mouse, but not on a
    phone.
    """
    width, height = room(screen, lifts)
    (most_w, most_h), (least_w, least_h) = LARGEST, LEAST
    scale = min(width / least_w, height / least_h)
    if screen.fit == "mouse":
        scale = min(max(width / most_w, height / most_h), scale)
    size = min(width / scale, most_w), min(height / scale, most_h)
    return {
        "size_in": tuple(round(side, 4) for side in size),
        # A scaled table needs no calibration.
        "calibrated": True,
        "scale": scale,
        "scored": screen.fit == "mouse",
    }


def common(rectangles: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Returns the largest touch rectangle that fits on each of several screens, as settings."""
    sizes = [r["size_in"] for r in rectangles]
    return {
        "size_in": tuple(min(sides) for sides in zip(*sizes, strict=True)),
        "calibrated": all(r["calibrated"] for r in rectangles),
    }


CANNOT_BEGIN = Message(
    "cannot_begin", "This cannot be played with these settings: the computer shows the reason."
)
"""Message of the page for errors other than `SurfaceTooSmallError`. The texts of these errors are
for the person at the command line."""


def explain_refusal(error: InputError, settings: Settings, strip_in: float = 0.0) -> list[Message]:
    """Returns the messages for a player whose trial cannot begin, with a remedy.

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
                "Its size is a guess: under Settings you can measure it with a bank card.",
            )
        )
    return sentences


def _lengths(width_in: float, height_in: float) -> dict[str, str]:
    """Returns width and height in inches and in centimetres; each language uses one unit."""
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
