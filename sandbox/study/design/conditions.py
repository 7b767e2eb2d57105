"""Conversion of combinations of levels to the settings of `sandbox run`, which have equal names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any, Literal, cast

import msgspec

from models.errors import HandSandboxError
from sandbox.study.design.design import Design, Level
from sandbox.words.words import words_in

if TYPE_CHECKING:
    from sandbox.study.design.reading import Reader
    from sandbox.trial.settings import Settings
    from tasks.task import Task

PARTNER = "simulated"
"""Value of `second_device`: a simulated user moves the second hand, also next to a person."""

WEBCAM = "webcam"
"""Value of `device` and `second_device` for a hand before a camera."""

_SIMULATED = {
    "touch": "simulated",
    "leap": "leap-simulated",
    WEBCAM: "leap-simulated",
    PARTNER: "simulated",
}
"""Simulated devices that replace those of a design while its settings are computed."""

_ABBREVIATIONS: dict[str, Any] = {
    "task": str,
    "device": Literal["touch", "leap", "webcam"],
    "second_device": Literal["touch", "leap", "webcam", "simulated"],
    "second_hand": Literal["right", "left"],
    "one_surface": bool,
    "bare": bool,
    "impulse": str | int | float,
    "surface": str,
    "turn": Literal[0, 90, 180, 270],
    "vary": str,
    "leap_at": str,
    "webcam": str,
}
"""Settings that a design writes as the command line does, with their types."""


@cache
def setting_types() -> dict[str, Any]:
    """Settings that a design may contain, with their types: every field of pipeline and physics of
    `sandbox.trial.settings`, and what the command line abbreviates."""
    from sandbox.trial.settings import PhysicsSettings, PipelineSettings, field_types

    return {
        "task": str,
        **field_types(PipelineSettings),
        **field_types(PhysicsSettings),
        **_ABBREVIATIONS,
    }


def run_settings(
    values: Mapping[str, Any],
    seed: int,
    hand: str = "right",
    hand_size: float = 1.0,
    base: Settings | None = None,
) -> Settings:
    """Creates the settings of one trial.

    Args:
        values: Values by the names of `setting_types`.
        seed: Seed of the trial.
        hand: The participant's hand.
        hand_size: Its length relative to the trained one.
        base: Settings that the values change; None has the defaults.

    Raises:
        InputError: A value is not allowed.
    """
    from sandbox.devices.hand_input import HandInput
    from sandbox.devices.webcam import webcam_choice
    from sandbox.trial.trial_options import TrialOptions, trial_settings

    given = dict(values)
    if "impulse" in given:
        given["impulse"] = str(given["impulse"])
    # The real devices are opened later; here only hands in the air need other settings.
    devices = (given.get("device", "touch"), given.get("second_device", given.get("device")))
    before_camera = HandInput(camera=webcam_choice(given.pop("webcam", "")).camera)
    place = given.pop("leap_at", None)
    if place is not None and "leap" in devices:
        given["device_options"] = {"leap_at": place}
    given["device"] = _SIMULATED[devices[0]]
    if "second_device" in given:
        given["second_device"] = _SIMULATED[given["second_device"]]
    options = TrialOptions(seed=seed, hand=cast(Any, hand), given=frozenset(given), **given)
    settings = trial_settings(options, base)
    hands = tuple(
        replace(
            hand,
            size=hand.size * hand_size,
            in_air=before_camera if device == WEBCAM else hand.in_air,
        )
        for hand, device in zip(settings.hands, devices, strict=False)
    )
    return replace(settings, hands=hands)


def uses_camera(design: Design) -> bool:
    """True if a hand of some trial of a design is before a camera."""
    every = (values_of(design, levels) for levels in combinations(design))
    return any(WEBCAM in (v.get("device"), v.get("second_device")) for v in every)


def consent_text(design: Design, language: str) -> str:
    """The consent form in a language; a design with a camera says that it is on, and that pictures
    stay in its page."""
    text = design.consent[language]
    if not uses_camera(design):
        return text
    own = words_in(language, design.page.words.get(language))
    return f"{text}\n\n{own['camera_consent']}"


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
    from sandbox.trial.assembly import lifts

    every = (values_of(design, levels) for levels in combinations(design))
    return any(lifts(run_settings(values, design.seed % 1000)) for values in every)


_VARIED_SEEDS = 20
"""Seeds with which a varied trial is drawn: whether its things overlap depends on the seed."""


def check_conditions(design: Design, reader: Reader) -> None:
    """Checks every combination: its settings, its task on its surface, and its encoder."""
    kinds_wrong = _check_kinds(design, reader)
    if kinds_wrong:
        return
    from sandbox.trial.assembly import drawn, load_encoder
    from tasks.registry import claim_name, find_task

    seen: set[str] = set()
    claimed: dict[str, tuple[str, type[Task]]] = {}
    for levels in combinations(design):
        values = values_of(design, levels)
        try:
            settings = run_settings(values, design.seed % 1000)
            # Tables and the lock of a study know tasks by their names.
            claim_name(claimed, settings.task, find_task(settings.task))
            drawn(settings)
            if not settings.variation.neutral:
                for seed in range(_VARIED_SEEDS):
                    drawn(replace(settings, seed=seed))
            load_encoder(settings.pipeline.encoder)
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
    from sandbox.trial.settings import expected_values

    wrong = False
    given = [(("settings",), design.settings)]
    given += [
        (("factors", i, "levels"), level.settings)  # type: ignore[misc]
        for i, factor in enumerate(design.factors)
        for level in factor.levels
    ]
    for path, values in given:
        for name, value in values.items():
            kind = setting_types()[name]
            try:
                # A number is no word, and neither is true or false.
                msgspec.convert(value, kind, strict=True)
                continue
            except msgspec.ValidationError as error:
                expected = expected_values(kind, error)
            wrong = True
            at = (*path, name) if path == ("settings",) else path
            if name == "vary":
                expected = f'vary = "{_vary_text(value)}"'
            reader.add_mistake(at, f"{name} cannot be {value!r}", f"Write {expected}")
    return wrong


VARY_EXAMPLE = "size=0.7,latency=50"
"""A value of `vary`, as the command line and a design write it."""


def _vary_text(value: object) -> str:
    """The text of `vary` that a table of numbers means, or an example of one."""
    if not isinstance(value, dict) or not value:
        return VARY_EXAMPLE
    return ",".join(f"{name}={number}" for name, number in value.items())


def _mistake_path(design: Design, levels: Mapping[str, Level], error: HandSandboxError) -> Any:
    """Path of the factor or setting that the error names, or that has the rejected value; of all
    factors if unknown."""
    for i, factor in enumerate(design.factors):
        if error.where in levels[factor.name].settings:
            return ("factors", i, "levels")
    if error.where in design.settings:
        return ("settings", error.where)
    for told in (str(error.got), error.where):
        if not told:
            continue
        for i, factor in enumerate(design.factors):
            if told in map(str, levels[factor.name].settings.values()):
                return ("factors", i, "levels")
        for name, value in design.settings.items():
            if str(value) == told:
                return ("settings", name)
    return ("factors",)
