"""Options for a second hand, which are given by their own names or by repeating the first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from models.errors import InputError
from sandbox.devices.registry import kind_of
from sandbox.options.headings import SECOND
from sandbox.recording.recording import Recording
from sandbox.trial.settings import Settings
from tasks.registry import find_task, hands_of

TWICE = ("--device", "--hand", "--hand-size", "--turn", "--user")
"""Options whose second occurrence is for the second hand."""


@dataclass(frozen=True, kw_only=True)
class SecondOptions:
    """Options of a second hand."""

    second_device: Annotated[str | None, Parameter(group=SECOND, metavar="DEVICE")] = None
    """Device of a second hand; web gives it a page of its own. A second --device, --hand,
    --hand-size, --turn or --user means the same as the option with --second. The first hand is at
    the right, unless it is a left hand and the second one is a right hand. Tasks for two hands
    always have a second hand."""

    second_hand: Annotated[Literal["right", "left"] | None, Parameter(group=SECOND)] = None
    """Side of the second hand. Default: opposite to the first."""

    second_hand_size: Annotated[float | None, Parameter(group=SECOND, metavar="RATIO")] = None
    """Length of the second hand, as --hand-size. Default: that of the first."""

    second_turn: Annotated[Literal[0, 90, 180, 270] | None, Parameter(group=SECOND)] = None
    """Seat of the second hand's person, as --turn."""

    second_user: Annotated[Literal["skilled", "idle", "random"] | None, Parameter(group=SECOND)] = (
        None
    )
    """Simulated user of the second hand. Default: that of the first."""

    one_surface: Annotated[bool, Parameter(group=SECOND)] = False
    """Both hands touch one surface; its contacts are divided between them."""


def with_second_names(argv: Sequence[str]) -> list[str]:
    """Returns the command line with a repeated `--device` renamed to `--second-device`, and so on.

    Raises:
        InputError: An option is given three times.
    """
    seen: dict[str, int] = {}
    renamed = []
    for word in argv:
        name, equals, value = word.partition("=")
        if name in TWICE:
            seen[name] = seen.get(name, 0) + 1
            if seen[name] > 2:
                raise InputError(
                    "there are at most two hands",
                    where=name,
                    got="three times",
                    expected="once or twice",
                )
            if seen[name] == 2:
                name = "--second-" + name.removeprefix("--")
        renamed.append(name + equals + value)
    return renamed


def with_second_hand(
    settings: Settings, options: SecondOptions, device: str, recording: Recording | None
) -> Settings:
    """Returns settings with a second hand if the task or the options need one.

    Args:
        settings: Settings with the first hand.
        options: Options of the second hand.
        device: Device of the first hand.
        recording: Recording that the first device plays, which brings its own second hand; None
            if it plays none.

    Raises:
        InputError: The options contradict each other.
    """
    asked = {
        "side": options.second_hand,
        "size": options.second_hand_size,
        "turn": options.second_turn,
    }
    given: dict[str, Any] = {name: v for name, v in asked.items() if v is not None}
    if recording is not None and len(settings.hands) > 1:
        return settings
    for_two = _for_two(settings.task)
    wanted = options.second_device is not None or options.one_surface
    if not (for_two or wanted):
        if given or options.second_user:
            raise InputError(
                "an option of a second hand is given, and there is only one hand",
                where="--hand, --turn or --user twice",
                remedy="Give --device twice, or --one-surface",
            )
        return settings
    simulated = (device, options.second_device or "simulated") == ("simulated",) * 2
    if options.one_surface and not simulated and options.second_device is not None:
        raise InputError(
            "one surface has one device",
            where="--one-surface",
            got=f"{device} and {options.second_device}",
            remedy="Leave out the second --device",
        )
    if options.one_surface and device == "mouse":
        raise InputError("this device takes only one hand", where="--one-surface", got=device)
    alone = options.second_device is None and not kind_of(device).one_hand
    first = settings.hands[0]
    return settings.changed(
        hands=(first, replace(first.other, **given)), shared=options.one_surface or alone
    )


def _for_two(task: str) -> bool:
    """True if a task is for two hands; an unknown task is refused later, when it is drawn."""
    try:
        return hands_of(find_task(task)) > 1
    except InputError:
        return False
