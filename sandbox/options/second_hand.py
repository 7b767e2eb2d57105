"""A second hand on the command line: options that are given twice, and what they mean."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

import tyro

from models.errors import InputError
from sandbox.devices.registry import DEVICES
from sandbox.recording.recording import Recording
from sandbox.trial.settings import RunSettings
from tasks.registry import find_task, hands_of

TWICE = ("--device", "--hand", "--hand-size", "--turn", "--user")
"""Options of which the second one is for the second hand."""

ONE_HAND_EACH = tuple(name for name, entry in DEVICES.items() if entry.one_hand)
"""Devices that are one hand's: in a task for two, a simulated user joins in."""


@dataclass(frozen=True)
class SecondOptions:
    """Of a second hand."""

    second_device: Annotated[str | None, tyro.conf.arg(metavar="DEVICE")] = None
    """A device for a second hand; a second --device is the same, and so are a second --hand,
    --hand-size, --turn and --user; web gives it a page of its own. The first hand is the one to
    the right, unless it is a left one and the second a right one. Tasks for two hands have a second
    one in any case."""

    second_hand: Literal["right", "left"] | None = None
    """Which hand the second one is: the other one of the first, unless said otherwise."""

    second_hand_size: Annotated[float | None, tyro.conf.arg(metavar="RATIO")] = None
    """Length of the second hand; the first one's, unless said otherwise."""

    second_turn: Literal[0, 90, 180, 270] | None = None
    """Where the second hand's owner sits, as --turn."""

    second_user: Literal["skilled", "idle", "random"] | None = None
    """The second hand's simulated user; as the first one, unless said otherwise."""

    one_surface: tyro.conf.FlagCreatePairsOff[bool] = False
    """Both hands touch one surface, and its contacts are split between them."""


def named(argv: Sequence[str]) -> list[str]:
    """The command line with the second `--device` as `--second-device`, and others alike.

    Raises:
        InputError: An option is there three times: there are no more than two hands.
    """
    seen: dict[str, int] = {}
    found = []
    for word in argv:
        name, equals, value = word.partition("=")
        if name in TWICE:
            seen[name] = seen.get(name, 0) + 1
            if seen[name] > 2:
                raise InputError(
                    "there are no more than two hands", where=name, expected="once, or twice"
                )
            if seen[name] == 2:
                name = "--second-" + name.removeprefix("--")
        found.append(name + equals + value)
    return found


def with_second(
    settings: RunSettings, options: SecondOptions, device: str, recording: Recording | None
) -> RunSettings:
    """The settings with a second hand where the task, or who asks, wants one.

    Args:
        settings: Of the first hand.
        options: What is asked for.
        device: Of the first hand.
        recording: What the first device plays, if it does; it brings its own second hand along.

    Raises:
        InputError: What is asked for is not one hand more.
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
                "there is one hand only",
                where="--hand, --turn or --user twice",
                remedy="--device twice, or --one-surface",
            )
        return settings
    simulated = (device, options.second_device or "simulated") == ("simulated",) * 2
    if options.one_surface and not simulated and options.second_device is not None:
        raise InputError(
            "one surface is one device",
            where="--one-surface",
            got=f"{device} and {options.second_device}",
            remedy="Leave the second --device out",
        )
    if options.one_surface and device == "mouse":
        raise InputError("this device is one hand's", where="--one-surface", got=device)
    alone = options.second_device is None and device not in ONE_HAND_EACH
    first = settings.hands[0]
    return replace(
        settings,
        hands=(first, replace(first.other, **given)),
        one_surface=options.one_surface or alone,
    )


def _for_two(task: str) -> bool:
    """Whether a task is for two hands; one that there is not is refused where it is drawn."""
    try:
        return hands_of(find_task(task)) > 1
    except InputError:
        return False
