"""Settings of a run: plain values that a recording's header keeps for its replay."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

import msgspec

from encoders.person.rest_posture import Looks
from encoders.regression.model_registry import DEFAULT_MODEL
from models.errors import InputError, RecordingError
from models.hand import IMPULSE_PROFILES, SERVOS
from models.person import HANDS, Person
from models.surface import PRESETS, Surface
from sandbox.session.contact_modes import ContactMode, contact_mode
from sandbox.session.own_layouts import Layouts
from sandbox.trial.hand_input import HandInput
from tasks.variation import Variation

DEFAULT_LABELS = "population"
"""The default of the labels."""

LABELS = ("population", "paper", "device")
"""`population`: a belief carried from contact to contact, trained on hundreds of simulated people,
which also learns from layouts of five fingers during a trial; `paper`: nearest training pose;
`device`: the simulated user labels its touches, an upper bound, and touches without a label are
labelled as by `population`."""

SOLID = ("fingertips", "hand")
"""What of a hand collides: the last links of touching fingers, or palm and all links."""

MOST_HANDS = 2
"""Largest number of hands in a scene."""

_OPTIONAL = {
    "variation",
    "surface_scale",
    "scored",
    "robot",
    "solid",
}
"""Settings that a header may lack."""

_IN_RESULTS = {
    "side": "hand",
    "size": "hand_size",
    "turn": "turn",
    "in_air": "in_air",
    "layouts": "layouts",
    "rest": "rest",
}
"""Names of a hand's settings in results, by their names in headers."""


@dataclass(frozen=True)
class HandSettings:
    """One hand in the scene, and the person whose hand it is; JSON values only.

    Attributes:
        side: `right` or `left`.
        size: Length of the person's hand relative to the trained hand.
        turn: degrees, direction in which the person sits (see `models.person.Person`).
        in_air: Settings of the 3-D device that drives the hand; None if touches drive it.
        layouts: Known touches of the person's five fingers (see `sandbox.session.own_layouts`),
            which names of fingers by `population` use.
        rest: Looks at the person's hand (see `encoders.person.rest_posture`), which the encoder
            `population` uses.
    """

    side: str = HANDS[0]
    size: float = 1.0
    turn: int = 0
    in_air: HandInput | None = None
    layouts: Layouts = ()
    rest: Looks = ()

    def __post_init__(self) -> None:
        _ = self.person

    @classmethod
    def of(cls, person: Person) -> HandSettings:
        """Settings of a person's hand that is driven by touches."""
        return cls(person.hand, person.hand_size, person.turn)

    @property
    def person(self) -> Person:
        """The person whose hand it is, checked."""
        return Person(self.side, self.size, self.turn)

    def on(self, side: str) -> HandSettings:
        """The same with another side; layouts and rest posture are those of one side only."""
        return self if side == self.side else replace(self, side=side, layouts=(), rest=())

    @property
    def other(self) -> HandSettings:
        """The same person's other hand, driven by touches from the screen's lower edge."""
        return HandSettings(HANDS[1] if self.side == HANDS[0] else HANDS[0], self.size)


@dataclass(frozen=True)
class RunSettings:
    """Settings of one run; JSON values only.

    Attributes:
        task: Name of the task.
        seed: Seed of the task's start and goal, and of a simulated user.
        encoder: `population`, `paper`, `linear`, `quadratic`, `cubic`, `pca-ik`, the file of a
            trained model, or an external encoder (`encoders.regression.model_registry`).
        labels: One of `LABELS`.
        correction: Fingertips are corrected to meet their touches.
        smoothing: Touches and posture are low-pass filtered.
        arrival: The hand hovers, comes down from above and rises; otherwise it drops where it is.
        ghost_until_clear: A hand that is down becomes solid only outside objects.
        distal_only: Only last links of touching fingers are ever solid.
        stitch: A lost contact is kept for a moment, until it returns or expires.
        encode: The encoder's pose is used; otherwise the mean training pose.
        servo: One of `models.hand.SERVOS`.
        impulse: N s (N m s) per 1/60 s, limit of every servo.
        contact: Initial contact mode (see `sandbox.session.contact_modes`).
        surface_in: Width and height of a hand's touch surface, inches.
        surface_calibrated: False if the surface's size is a guess.
        surface_scale: Length on the screen of what is one long on the surface (`Surface.scale`).
        scored: False if the result does not count, as on the scaled table of a phone.
        timestep: s, physics time step.
        hands: One entry per hand, in the order of devices, rigs and recorded inputs.
        one_surface: All hands touch one surface; otherwise each has its own, of the same size.
        variation: Differences from the drawn trial, and disturbances of the touches.
        robot: The robot whose hand is in the place of the person's (see `models.robot.known`);
            empty for our own hand.
        solid: One of `SOLID`; a header without it has the first.
    """

    task: str = "box-to-goal"
    seed: int = 0
    encoder: str = DEFAULT_MODEL
    labels: str = DEFAULT_LABELS
    correction: bool = True
    smoothing: bool = True
    arrival: bool = True
    ghost_until_clear: bool = True
    distal_only: bool = True
    stitch: bool = True
    encode: bool = True
    servo: str = SERVOS[0]
    impulse: float = IMPULSE_PROFILES["paper"]
    contact: str = ContactMode.HARD.value
    surface_in: tuple[float, float] = PRESETS["ipad2"]
    surface_calibrated: bool = True
    timestep: float = 0.002
    hands: tuple[HandSettings, ...] = (HandSettings(),)
    one_surface: bool = False
    variation: Variation = field(default_factory=Variation)
    surface_scale: float = 1.0
    scored: bool = True
    robot: str = ""
    solid: str = SOLID[0]

    def __post_init__(self) -> None:
        if not 0.0 < self.timestep < 1.0:
            raise InputError(
                "not a physics time step",
                where="timestep",
                got=self.timestep,
                expected="s, between 0 and 1",
            )
        if self.labels not in LABELS:
            raise InputError(
                "no such labels", where="labels", got=self.labels, expected=", ".join(LABELS)
            )
        if self.solid not in SOLID:
            raise InputError(
                "no such solid part of a hand",
                where="--solid",
                got=self.solid,
                expected=", ".join(SOLID),
            )
        if self.robot and self.solid != SOLID[0]:
            raise InputError(
                "of a robot's hand only fingertips are solid",
                where="--solid",
                got=self.solid,
                expected=SOLID[0],
                remedy=f"Leave out --robot, or use --solid {SOLID[0]}",
            )
        if not 1 <= len(self.hands) <= MOST_HANDS:
            raise InputError(
                "a run must have one or two hands",
                where="hands",
                got=len(self.hands),
                expected=f"1 to {MOST_HANDS}",
            )
        contact_mode(self.contact)

    @property
    def hand_names(self) -> tuple[str, ...]:
        """A distinct name for every hand: its side, or `right_too` for a second right hand."""
        sides = [hand.side for hand in self.hands]
        return tuple(s if s not in sides[:i] else f"{s}_too" for i, s in enumerate(sides))

    @property
    def in_air(self) -> bool:
        """True if all hands are driven by 3-D devices, without any touches."""
        return all(hand.in_air is not None for hand in self.hands)

    @property
    def surface(self) -> Surface:
        """The touch rectangle of one hand, not yet placed in the world."""
        calibrated, scale = self.surface_calibrated, self.surface_scale
        return Surface(*self.surface_in, calibrated=calibrated, scale=scale)

    def knowing(self, layouts: Mapping[str, Layouts]) -> RunSettings:
        """The same with known layouts of hands, by the hand's name, if its labels use them."""
        if self.labels != "population":
            return self
        hands = tuple(
            replace(hand, layouts=layouts.get(name, hand.layouts))
            for name, hand in zip(self.hand_names, self.hands, strict=True)
        )
        return replace(self, hands=hands)

    def as_json(self) -> dict[str, Any]:
        """Values for a recording's header, without a neutral variation, true size, solid
        fingertips, an `in_air` or a camera of None, missing joints, or empty layouts and looks."""
        values = asdict(self)
        if self.variation.neutral:
            del values["variation"]
        if self.surface_scale == 1.0:
            del values["surface_scale"]
        if self.scored:
            del values["scored"]
        if not self.robot:
            del values["robot"]
        if self.solid == SOLID[0]:
            del values["solid"]
        values["hands"] = [_without_defaults(hand) for hand in values["hands"]]
        return values

    @classmethod
    def from_json(cls, values: Any) -> RunSettings:
        """Reads settings that `as_json` wrote.

        Raises:
            RecordingError: A setting is missing, unknown or of the wrong type.
            InputError: A value is not allowed.
        """
        _check_names(values, cls, optional=_OPTIONAL)
        for hand in values["hands"] if isinstance(values["hands"], list) else ():
            _check_names(hand, HandSettings, optional={"in_air", "layouts", "rest"})
            if hand.get("in_air") is not None:
                _check_names(hand["in_air"], HandInput, optional={"camera", "joints"})
        if "variation" in values:
            _check_names(values["variation"], Variation, optional=_names(Variation))
        try:
            return msgspec.convert(values, cls)
        except msgspec.ValidationError as error:
            raise RecordingError(
                "these settings cannot be read",
                where="settings",
                got=str(error),
                remedy="The file is damaged, or was written by another program",
            ) from None


def result_settings(values: Mapping[str, Any]) -> dict[str, Any]:
    """The settings of a header in the form of results, baselines and `run --json`.

    The first hand's settings are at the top level, those of a second hand under `second`.

    Args:
        values: Values that `RunSettings.as_json` returned.
    """
    flat = {name: value for name, value in values.items() if name not in ("hands", "one_surface")}
    first, *others = [
        {_IN_RESULTS[name]: value for name, value in hand.items()} for hand in values["hands"]
    ]
    flat |= first
    if others:
        flat["second"] = {**others[0], "shared": values["one_surface"]}
    return flat


def bare(settings: dict[str, Any]) -> dict[str, Any]:
    """Settings of the paper's own pipeline: its labels, no correction, no smoothing."""
    return {**settings, "labels": "paper", "correction": False, "smoothing": False}


def _without_defaults(hand: dict[str, Any]) -> dict[str, Any]:
    told = {name: value for name, value in hand.items() if value is not None and value != ()}
    if "in_air" in told:
        absent = {"camera": None, "joints": False}
        told["in_air"] = {
            name: v for name, v in told["in_air"].items() if v != absent.get(name, ...)
        }
    return told


def _names(kind: type[Any]) -> set[str]:
    return {f.name for f in fields(kind)}


def _check_names(values: Any, kind: type[Any], optional: set[str] | None = None) -> None:
    """Refuses values whose names are not those of a dataclass's fields."""
    if not isinstance(values, dict):
        raise RecordingError(
            "these settings cannot be read",
            where="settings",
            got=str(values)[:80],
            expected="an object with " + ", ".join(sorted(_names(kind))),
        )
    wrong = (set(values) ^ _names(kind)) - ((optional or set()) - set(values))
    if wrong:
        raise RecordingError(
            "these settings are another version's",
            where="settings",
            got=", ".join(sorted(wrong)) + " missing or unknown",
            remedy="Use the version that the header names",
        )
