"""Conversion of combinations of levels to the settings of `sandbox run`, which have equal names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from models.errors import HandSandboxError
from sandbox.study.design.design import Design, Level

if TYPE_CHECKING:
    from sandbox.study.design.reading import Reader
    from sandbox.trial.settings import RunSettings
    from tasks.task import Task

PARTNER = "simulated"
"""Value of `second_device`: a simulated user moves the second hand, also next to a person."""

_SIMULATED = {"touch": "simulated", "leap": "leap-simulated", PARTNER: "simulated"}
"""Simulated devices that replace those of a design while its settings are computed."""

SETTINGS: dict[str, type | tuple[type, ...]] = {
    "task": str,
    "device": str,
    "second_device": str,
    "second_hand": str,
    "one_surface": bool,
    "encoder": str,
    "bare": bool,
    "labels": str,
    "without": (list, str),
    "impulse": (str, int, float),
    "contact": str,
    "servo": str,
    "solid": str,
    "surface": str,
    "turn": int,
    "tell_labels": bool,
    "vary": str,
    "leap_at": str,
}
"""Settings that a design may contain, with their types."""

CHOICES = {
    "device": ("touch", "leap"),
    "second_device": ("touch", "leap", PARTNER),
    "second_hand": ("right", "left"),
    "contact": ("hard", "soft", "none"),
    "labels": ("history", "population"),
    "servo": ("orientation", "position"),
    "solid": ("fingertips", "hand"),
    "turn": (0, 90, 180, 270),
}


def run_settings(
    values: Mapping[str, Any], seed: int, hand: str = "right", hand_size: float = 1.0
) -> RunSettings:
    """Creates the settings of one trial.

    Args:
        values: Values by the names of `SETTINGS`.
        seed: Seed of the trial.
        hand: The participant's hand.
        hand_size: Its length relative to the trained one.

    Raises:
        InputError: A value is not allowed.
    """
    from sandbox.options.scene_options import SceneOptions, plan

    given = dict(values)
    if "impulse" in given:
        given["impulse"] = str(given["impulse"])
    if "without" in given:
        some = given["without"]
        given["without"] = tuple([some] if isinstance(some, str) else some)
    # The real devices are opened later; here only hands in the air need other settings.
    given["device"] = _SIMULATED[given.get("device", "touch")]
    if "second_device" in given:
        given["second_device"] = _SIMULATED[given["second_device"]]
    options = SceneOptions(seed=seed, hand=_hand(hand), **given)
    settings = plan(options).settings
    hands = tuple(replace(hand, size=hand.size * hand_size) for hand in settings.hands)
    return replace(settings, hands=hands)


def _hand(hand: str) -> Any:
    return hand


def combinations(design: Design) -> Iterator[dict[str, Level]]:
    """Yields every combination of levels in a design."""

    def inner(chosen: dict[str, Level], depth: int) -> Iterator[dict[str, Level]]:
        if depth == len(design.factors):
            yield dict(chosen)
            return
        factor = design.factors[depth]
        for level in factor.within(chosen):
            yield from inner({**chosen, factor.name: level}, depth + 1)

    yield from inner({}, 0)


def tasks_of(design: Design) -> dict[str, type[Task]]:
    """Tasks of all combinations, by name."""
    from tasks.registry import find_task

    names = [
        run_settings(values_of(design, levels), design.seed % 1000).task
        for levels in combinations(design)
    ]
    return {name: find_task(name) for name in dict.fromkeys(names)}


def values_of(design: Design, levels: Mapping[str, Level]) -> dict[str, Any]:
    """Settings of a combination: those of all trials, overridden by those of its levels."""
    values = dict(design.settings)
    for level in levels.values():
        values |= level.settings
    return values


def any_lifts(design: Design) -> bool:
    """True if a trial of a design needs a lift control."""
    from sandbox.trial.lift import lifts

    every = (values_of(design, levels) for levels in combinations(design))
    return any(lifts(run_settings(values, design.seed % 1000)) for values in every)


def check_conditions(design: Design, reader: Reader) -> None:
    """Checks every combination: its settings, its task on its surface, and its encoder."""
    kinds_wrong = _check_kinds(design, reader)
    if kinds_wrong:
        return
    from sandbox.trial.assembly import load_encoder, place_surface
    from sandbox.trial.surfaces import place_all
    from tasks.registry import draw_task, find_task

    seen: set[str] = set()
    for levels in combinations(design):
        values = values_of(design, levels)
        try:
            settings = run_settings(values, design.seed % 1000)
            kind = find_task(settings.task)
            whole, _ = place_all(place_surface(settings.surface, kind), settings, kind)
            draw_task(kind, settings.seed, whole)
            load_encoder(settings.encoder)
        except HandSandboxError as error:
            if str(error) in seen:
                continue
            seen.add(str(error))
            names = ", ".join(f"{k} = {v.name}" for k, v in levels.items())
            reader.add_mistake(
                _mistake_path(design, levels, error),
                f"{names}: {error}",
                "Change a level of this combination",
            )


def _check_kinds(design: Design, reader: Reader) -> bool:
    wrong = False
    given = [(("settings",), design.settings)]
    given += [
        (("factors", i, "levels"), level.settings)  # type: ignore[misc]
        for i, factor in enumerate(design.factors)
        for level in factor.levels
    ]
    for path, values in given:
        for name, value in values.items():
            is_flag = isinstance(value, bool)
            fits = isinstance(value, SETTINGS[name]) and is_flag == (SETTINGS[name] is bool)
            options = CHOICES.get(name)
            if fits and (options is None or value in options):
                continue
            wrong = True
            at = (*path, name) if path == ("settings",) else path
            remedy = "See `sandbox run --help` for its values"
            if options:
                remedy = "Write one of " + ", ".join(map(str, options))
            reader.add_mistake(at, f"{name} cannot be {value!r}", remedy)
    return wrong


def _mistake_path(design: Design, levels: Mapping[str, Level], error: HandSandboxError) -> Any:
    """Path of the factor or setting that has the rejected value; of all factors if unknown."""
    for i, factor in enumerate(design.factors):
        level = levels[factor.name]
        texts = [str(v) for v in level.settings.values()]
        if any(text and text == str(error.got) for text in texts):
            return ("factors", i, "levels")
    for name, value in design.settings.items():
        if str(value) == str(error.got):
            return ("settings", name)
    return ("factors",)
