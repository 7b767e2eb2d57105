"""Converts combinations of factor levels to the settings of a trial.

A setting has the same name as the option of `sandbox run`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any, Literal, cast

import msgspec

from models.errors import HandSandboxError
from sandbox.study.design.design import Design, Level
from sandbox.words import words_in

if TYPE_CHECKING:
    from sandbox.study.design.reading import Reader
    from sandbox.trial.settings import Settings
    from tasks.task import Task

PARTNER = "simulated"
"""Value of `second_device`: a simulated user moves the second hand, even if a person moves the
first."""

WEBCAM = "webcam"
"""Value of `device` and `second_device` for a hand that a camera sees."""

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
"""Settings that a design writes in the form of the command line, with their types."""


@cache
def setting_types() -> dict[str, Any]:
    """Settings that a design may contain, with their types.

    These are the fields of `PipelineSettings` and `PhysicsSettings`, and the settings of
    `_ABBREVIATIONS`, which are written in the form of the command line.
    """
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
        hand_size: Length of that hand, relative to the hand on which the encoders were trained.
        base: Settings that the values change; None for the defaults.

    Raises:
        InputError: A value is not allowed.
    """
    from sandbox.devices.hand_input import HandInput
    from sandbox.devices.webcam import webcam_choice
    from sandbox.trial.trial_options import TrialOptions, trial_settings

    given = dict(values)
    if "impulse" in given:
        given["impulse"] = str(given["impulse"])
    # Real devices are opened later. The settings depend only on the kind of device (touches, or
    # hands in the air), so a simulated device of the same kind stands in for the real one.
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
    """True if a camera sees a hand in any trial of a design."""
    return any(before_camera(values) for values in every_values(design))


def before_camera(values: Mapping[str, Any]) -> bool:
    """True if, with these settings, a camera sees a hand."""
    return WEBCAM in (values.get("device"), values.get("second_device"))


def consent_text(design: Design, language: str) -> str:
    """The text of the consent form in a language.

    For a design with a camera, a text is added: the camera is on, and its pictures do not leave
    the web page.
    """
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

    names = [run_settings(values, design.seed % 1000).task for values in every_values(design)]
    return {name: find_task(name) for name in dict.fromkeys(names)}


def values_of(design: Design, levels: Mapping[str, Level]) -> dict[str, Any]:
    """Settings of a combination: the settings of all trials, overridden by those of its levels."""
    values = dict(design.settings)
    for level in levels.values():
        values |= level.settings
    return values


def every_values(design: Design) -> Iterator[dict[str, Any]]:
    """Yields the settings of every combination of levels; see `values_of`."""
    return (values_of(design, levels) for levels in combinations(design))


def any_lifts(design: Design) -> bool:
    """True if a trial of a design needs a lift control."""
    from sandbox.trial.assembly import lifts

    every = (run_settings(values, design.seed % 1000) for values in every_values(design))
    return any(map(lifts, every))


_VARIED_SEEDS = 20
"""Number of seeds for which a varied trial is drawn as a test, since its objects may overlap for
some seeds only."""


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
            # Tables and the lock of a study identify tasks by their names.
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
                # With strict=True, numbers and booleans are not accepted as strings.
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
    """Writes a table of numbers as the text that `vary` expects.

    For any other value, returns an example of such a text.
    """
    if not isinstance(value, dict) or not value:
        return VARY_EXAMPLE
    return ",".join(f"{name}={number}" for name, number in value.items())


def _mistake_path(design: Design, levels: Mapping[str, Level], error: HandSandboxError) -> Any:
    """Path, in the design, of the factor or setting that the error names or whose value it rejects.

    If there is none, returns the path of all factors.
    """
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
