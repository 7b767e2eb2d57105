"""Settings of a trial: one nested value, from the command line to a recording's header.

To add a setting, add a field with its docstring to `PipelineSettings` or `PhysicsSettings`. The
command line then has an option of the same name, and a study's design may contain the setting.
`sandbox regress` sends it to its workers, and a recording's header stores it. Files that are older
than the field lack it. The field declares its value for these files:
`field(default=..., metadata={BEFORE: value})`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import Field, dataclass, field, fields, is_dataclass, replace
from difflib import get_close_matches
from functools import cache
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import msgspec

from encoders.labels.labelling import parse_finger_sets
from encoders.regression.encoder_registry import find_encoder
from encoders.regression.model_registry import DEFAULT_MODEL
from models.errors import InputError, RecordingError
from models.hand import IMPULSE_PROFILES
from models.json_input import in_plain_words
from models.person import HANDS, Person, RestSamples
from models.plugins import how_to_get, place_of
from models.surface import PRESETS, Surface
from sandbox.devices.hand_input import HandInput
from sandbox.devices.registry import DeviceSettings, device_options
from sandbox.recording.versions import STATES, states_of
from sandbox.session.own_layouts import Layouts
from tasks.user import UserConfiguration
from tasks.variation import Variation

BEFORE = "before"
"""Key of a field's metadata: the field's value for a header without this field."""

_Labels = Literal["population", "paper", "device"]
_Solid = Literal["fingertips", "hand"]

LABELS = get_args(_Labels)
"""Values of `PipelineSettings.labels`."""

SOLID = get_args(_Solid)
"""Values of `PhysicsSettings.solid`."""

MOST_HANDS = 2
"""Largest number of hands in a scene."""


class _Checked:
    """A group of settings. Values are checked against their types when a group is created."""

    def __post_init__(self) -> None:
        """Checks types, choices and bounds.

        Raises:
            InputError: A value is not allowed; `where` is its field.
        """
        kind: Any = type(self)
        hints = _hints(kind)
        for each in fields(kind):
            if _dataclass_in(hints[each.name]) is not None:
                # A nested dataclass checks its own values.
                continue
            value = getattr(self, each.name)
            try:
                msgspec.convert(value, hints[each.name])
            except msgspec.ValidationError as error:
                raise InputError(
                    "not a value of this setting",
                    where=each.name,
                    got=value,
                    expected=expected_values(hints[each.name], error),
                ) from None


@dataclass(frozen=True, kw_only=True)
class PipelineSettings(_Checked):
    """How touches become poses."""

    encoder: str = DEFAULT_MODEL
    """Encoder, which estimates the hand's pose from the touches. paper: least squares with the
    paper's labels, without correction and smoothing. All other encoders use --labels, correction
    and smoothing. linear, quadratic, cubic: polynomials. pca-ik: inverse kinematics in principal
    components. population: for any person, trained on hundreds of simulated people. FILE: a model
    of one person, written by `sandbox train`. FILE.py:CLASS or MODULE:CLASS: an encoder of your own
    (docs/write-an-encoder.md)."""

    labels: _Labels = "population"
    """How fingers are labelled. population: from earlier touches, by a model trained on hundreds of
    simulated people, so that any person can play without a measurement; it also learns from five
    fingers that touch together. paper: by the nearest training pose, as in the paper. device: the
    simulated user reports which finger touches, an upper bound for labelling; contacts without a
    reported label are labelled as by population. Labels that any other device reports for all
    contacts are always used."""

    finger_sets: str = field(default="", metadata={BEFORE: ""})
    """Sets of fingers that the person uses, such as thumb+index,thumb+index+middle. A number after
    a colon weights a set: thumb+index:3,index+middle means that the first set is three times as
    frequent. For a moment, only some fingers of a set may touch. Labels by population are chosen
    among the sets. Default: any set of fingers, weighted by how often people use it."""

    correction: bool = True
    """Fingertips are corrected to meet their touches."""

    smoothing: bool = True
    """Touches and posture are low-pass filtered."""

    arrival: bool = True
    """The hand hovers, comes down from above and rises; otherwise it is at its place at once."""

    hover: Annotated[float, msgspec.Meta(gt=0.0, le=0.3)] = field(
        default=0.09, metadata={BEFORE: 0.09}
    )
    """Height above its place at which the hand waits before it comes down, m, above 0 to 0.3."""

    ghost_until_clear: bool = True
    """A hand that is down becomes solid only outside objects."""

    distal_only: bool = True
    """Only the last links of touching fingers become solid."""

    stitch: bool = True
    """A lost contact is continued for a moment, until it returns or expires."""

    encode: bool = True
    """The encoder's pose is used; otherwise the mean training pose."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.finger_sets:
            return
        parse_finger_sets(self.finger_sets)
        if self.labels == "paper":
            raise InputError(
                "labels by the paper's rule cannot be restricted to sets of fingers",
                where="finger_sets",
                got=self.finger_sets,
                remedy="Leave out --finger-sets, or use --labels population",
            )


@dataclass(frozen=True, kw_only=True)
class PhysicsSettings(_Checked):
    """Servos, contacts and time step of the simulation."""

    servo: Literal["orientation", "position"] = "orientation"
    """orientation: one servo on the rotation of each ball joint. position: three servos, one on
    each component."""

    impulse: Annotated[float, msgspec.Meta(gt=0.0, le=1e9)] = IMPULSE_PROFILES["paper"]
    """Limit of every servo, N s (N m s) per 1/60 s, above 0."""

    contact: Literal["hard", "soft", "none"] = "hard"
    """Contact between hand and objects at the start. soft: the hand yields and pushes with 3 N at
    most. none: the hand passes through everything. Key c in the window changes the contact."""

    solid: _Solid = "fingertips"
    """Parts of the hand that collide. fingertips: the last links of touching fingers. hand: the
    palm and all links of all fingers, with objects and with the other hand; fingers that do not
    touch avoid objects."""

    robot: str = ""
    """Robot hand to simulate in place of the human hand (docs/robots.md): shadow, adroit, inspire,
    allegro or leap; or FILE.xml, with the mapping that `sandbox devices robot fit` wrote beside it.
    Default: the human hand."""

    timestep: Annotated[float, msgspec.Meta(gt=0.0, lt=1.0)] = 0.002
    """Physics time step, s, between 0 and 1."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.robot and self.solid != SOLID[0]:
            raise InputError(
                "a robot hand can have only solid fingertips",
                where="--solid",
                got=self.solid,
                expected=SOLID[0],
                remedy=f"Leave out --robot, or use --solid {SOLID[0]}",
            )


@dataclass(frozen=True)
class SurfaceSettings(_Checked):
    """The touch surface of one hand, not yet placed in the world."""

    size_in: tuple[float, float] = PRESETS["ipad2"]
    """Width and height, inches."""

    calibrated: bool = True
    """False if the size is a guess."""

    scale: float = 1.0
    """Length on the screen divided by the length on the surface (`models.surface.Surface.scale`).
    """

    shared: bool = False
    """All hands touch one surface; otherwise each hand has its own surface, of the same size."""

    @property
    def rectangle(self) -> Surface:
        """The surface of one hand, at the world's origin."""
        return Surface(*self.size_in, calibrated=self.calibrated, scale=self.scale)


@dataclass(frozen=True)
class HandSettings(_Checked):
    """One hand in the scene, and the person whose hand it is."""

    side: str = HANDS[0]
    """`right` or `left`."""

    size: float = 1.0
    """Length of the person's hand relative to the trained hand, 0.6 to 1.6."""

    turn: int = 0
    """Direction in which the person sits, degrees: 0, 90, 180 or 270 (see `models.person.Person`).
    """

    in_air: HandInput | None = None
    """Settings of the 3-D device that drives the hand; None if touches drive it."""

    layouts: Layouts = ()
    """Known places of the person's five fingers, m (see `sandbox.session.own_layouts`). Labels by
    `population` use them."""

    rest: RestSamples = ()
    """Samples of the person's hand at rest (see `encoders.person.rest_posture`). The encoder
    `population` uses them."""

    def __post_init__(self) -> None:
        super().__post_init__()
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
        """The same with another side. A change of side removes layouts and rest posture, which are
        valid for one side only."""
        return self if side == self.side else replace(self, side=side, layouts=(), rest=())

    @property
    def opposite(self) -> HandSettings:
        """The same person's other hand, driven by touches from the screen's lower edge."""
        return HandSettings(HANDS[1] if self.side == HANDS[0] else HANDS[0], self.size)


@dataclass(frozen=True)
class Settings:
    """Everything that determines a trial, except its input."""

    task: str = "box-to-goal"
    """Name of the task, or its place: `FILE.py`, `FILE.py:CLASS`, `MODULE:CLASS`."""

    seed: int = 0
    """Seed of the task's start and goal, and of a simulated user."""

    variation: Variation = field(default_factory=Variation)
    """Differences from the drawn trial, and disturbances of the touches."""

    hands: tuple[HandSettings, ...] = field(default_factory=lambda: (HandSettings(),))
    """One entry per hand, in the order of devices, rigs and recorded inputs; one or two."""

    pipeline: PipelineSettings = field(default_factory=PipelineSettings)
    """How touches become poses."""

    physics: PhysicsSettings = field(default_factory=PhysicsSettings)
    """Servos, contacts and time step."""

    surface: SurfaceSettings = field(default_factory=SurfaceSettings)
    """The touch surface."""

    device: DeviceSettings = field(default_factory=DeviceSettings)
    """Device of the first hand, with its options."""

    second_device: DeviceSettings | None = None
    """Device of the second hand; None if there is one hand, or if both hands share one device."""

    scored: bool = True
    """False if the result does not count, as on the scaled table of a phone."""

    def __post_init__(self) -> None:
        if not 1 <= len(self.hands) <= MOST_HANDS:
            raise InputError(
                "a run must have one or two hands",
                where="hands",
                got=len(self.hands),
                expected=f"1 to {MOST_HANDS}",
            )

    @property
    def hand_names(self) -> tuple[str, ...]:
        """A distinct name for every hand: its side, with `_too` if the first hand has this side."""
        sides = [hand.side for hand in self.hands]
        return tuple(s if s not in sides[:i] else f"{s}_too" for i, s in enumerate(sides))

    @property
    def in_air(self) -> bool:
        """True if all hands are driven by 3-D devices, without any touches."""
        return all(hand.in_air is not None for hand in self.hands)

    @property
    def shares_device(self) -> bool:
        """True if there are two hands and one device."""
        return len(self.hands) > 1 and self.second_device is None

    def device_of(self, hand: int) -> DeviceSettings:
        """The device of a hand."""
        return self.second_device if hand and self.second_device else self.device

    def with_layouts(self, layouts: Mapping[str, Layouts]) -> Settings:
        """The same with stored layouts, by the hand's name, if the labeller uses layouts."""
        if self.pipeline.labels != "population":
            return self
        hands = tuple(
            replace(hand, layouts=layouts.get(name, hand.layouts))
            for name, hand in zip(self.hand_names, self.hands, strict=True)
        )
        return replace(self, hands=hands)

    def changed(self, **values: Any) -> Settings:
        """The same with other values of its own fields, or of fields of its groups.

        Args:
            values: Values by the names of the fields.

        Raises:
            InputError: No field has this name, or a value is not allowed.
        """
        own: dict[str, Any] = {}
        groups: dict[str, dict[str, Any]] = {}
        for name, value in values.items():
            group = group_of(name)
            if group:
                groups.setdefault(group, {})[name] = value
            else:
                own[name] = value
        for group, some in groups.items():
            own[group] = replace(getattr(self, group), **some)
        return replace(self, **own)


GROUPS = {
    "pipeline": PipelineSettings,
    "physics": PhysicsSettings,
    "surface": SurfaceSettings,
}
"""Groups of `Settings`. `Settings.changed` accepts the names of their fields without the group."""


def field_types(group: Any) -> dict[str, Any]:
    """Types of the fields of a class of settings, with their bounds, by name."""
    return {each.name: _hints(group)[each.name] for each in fields(group)}


def is_allowed(group: str, name: str, value: Any) -> bool:
    """True if a field of a group may have a JSON value."""
    kind = field_types(GROUPS[group]).get(name)
    try:
        msgspec.convert(value, kind)
    except (msgspec.ValidationError, TypeError):
        return False
    return kind is not None


def setting_names() -> list[str]:
    """Names that `Settings.changed` accepts, without the names of groups and devices."""
    own = [each.name for each in fields(Settings) if each.name not in (*GROUPS, *_DEVICES)]
    return [*own, *(each.name for kind in GROUPS.values() for each in fields(kind))]


_DEVICES = ("device", "second_device")


def group_of(name: str) -> str:
    """The group that a setting is in; empty for a field of `Settings` itself.

    Raises:
        InputError: There is no such setting; the error names the setting with the nearest name.
    """
    own = [each.name for each in fields(Settings)]
    if name in own:
        return ""
    within = {each.name: group for group, kind in GROUPS.items() for each in fields(kind)}
    if name not in within:
        raise InputError("no such setting", got=name, remedy=_nearest(name, [*own, *within]))
    return within[name]


PAPER_PIPELINE = {"labels": "paper", "correction": False, "smoothing": False}
"""Settings of the paper's own pipeline: its labels, no correction, no smoothing."""


def encoded(settings: Settings) -> dict[str, Any]:
    """All values of settings as JSON, for a header."""
    values: dict[str, Any] = msgspec.to_builtins(settings)
    return values


def decoded(values: Any) -> Settings:
    """Decodes settings that `encoded` returned, possibly in an earlier version of the program.

    Raises:
        RecordingError: A setting is missing, unknown or of the wrong type.
        InputError: A value is not allowed.
    """
    try:
        settings = msgspec.convert(_whole(values, Settings, "settings"), Settings)
    except msgspec.ValidationError as error:
        raise RecordingError(
            "these settings cannot be read",
            where="settings",
            got=str(error),
            remedy="The file is damaged, or another program wrote it",
        ) from None
    second = settings.second_device
    return replace(
        settings,
        device=settings.device.decoded(),
        second_device=second and second.decoded(),
    )


def _whole(values: Any, kind: Any, where: str) -> dict[str, Any]:
    """Values of all fields of a dataclass, by name.

    A field that is missing in an earlier file gets the value that it declares for such files.

    Raises:
        RecordingError: A name is unknown, or a value is missing.
    """
    known: dict[str, Field[Any]] = {each.name: each for each in fields(kind)}
    if not isinstance(values, Mapping):
        raise RecordingError(
            "these settings cannot be read",
            where=where,
            got=str(values)[:80],
            expected="an object with " + ", ".join(known),
        )
    for name in values:
        if name not in known:
            raise RecordingError(
                "this program has no such setting",
                where=where,
                got=name,
                remedy=f"{_place_of(name, known)} Use the version of the sandbox that the header "
                "names",
            )
    whole = {}
    for name, each in known.items():
        if name not in values:
            if BEFORE not in each.metadata:
                raise RecordingError(
                    "a setting is missing",
                    where=where,
                    got=name,
                    remedy="The file is damaged, or another program wrote it",
                )
            whole[name] = each.metadata[BEFORE]
            continue
        hint, value = _hints(kind)[name], values[name]
        inner, several = _dataclass_in(hint), get_origin(hint) is tuple
        if inner is not None and several and isinstance(value, list | tuple):
            whole[name] = [_whole(v, inner, f"{where}.{name}") for v in value]
        elif inner is not None and not several and value is not None:
            whole[name] = _whole(value, inner, f"{where}.{name}")
        else:
            whole[name] = value
    return whole


def declared(values: Any, kind: Any = Settings) -> Any:
    """JSON values of settings without undeclared fields.

    Args:
        values: The values. Settings may be missing, and settings of an early header may be outside
            their groups.
        kind: Class of the settings.
    """
    if not isinstance(values, Mapping):
        return values
    known = dict.fromkeys([*_RENAMED, *setting_names()]) if kind is Settings else {}
    known |= _hints(kind)
    kept = {}
    for name, value in values.items():
        if name in known:
            inner = None if known[name] is None else _dataclass_in(known[name])
            several = isinstance(value, list | tuple)
            some = [declared(v, inner) if inner else v for v in (value if several else [value])]
            kept[name] = some if several else some[0]
    return kept


def _place_of(name: str, known: Any) -> str:
    """Sentence with the group to which a setting belongs, or with the nearest name."""
    within = [group for group, kind in GROUPS.items() if name in field_types(kind)]
    return f"This setting belongs to {within[0]}." if within else _nearest(name, known)


def _dataclass_in(hint: Any) -> type[Any] | None:
    """The dataclass in a field's type: the type itself, or a part of a union or a tuple."""
    if get_origin(hint) in (Union, UnionType, tuple):
        inner = [_dataclass_in(each) for each in get_args(hint)]
        return next((each for each in inner if each is not None), None)
    return hint if isinstance(hint, type) and is_dataclass(hint) else None


@cache
def _hints(kind: Any) -> dict[str, Any]:
    return get_type_hints(kind, include_extras=True)


_BOUNDS = {"gt": "above", "ge": "at least", "lt": "below", "le": "at most"}
"""Bound of `msgspec.Meta` -> words."""


def expected_values(hint: Any, error: msgspec.ValidationError) -> str:
    """The values that a setting takes, in words."""
    if get_origin(hint) is Literal:
        return "one of " + ", ".join(map(str, get_args(hint)))
    for bounds in getattr(hint, "__metadata__", ()):
        values = {word: getattr(bounds, name, None) for name, word in _BOUNDS.items()}
        return "a number " + " and ".join(f"{w} {v:g}" for w, v in values.items() if v is not None)
    return in_plain_words(str(error).removeprefix("Expected ").partition(", got ")[0])


def _nearest(name: str, known: Any) -> str:
    """Remedy for a name that does not exist."""
    near = get_close_matches(name, list(known), 1)
    return f"Did you mean {near[0]}?" if near else f"Settings here: {', '.join(known)}."


def recorded_settings(header: Mapping[str, Any], *names: str) -> Settings:
    """The settings of a recording.

    For a recording with other `STATES`, settings and values that this program does not have are
    left out, and missing settings have their defaults. The caller reports `states_difference`.

    Args:
        header: Header of the recording.
        names: Fields and groups of `Settings` that are needed; empty means all. For a recording
            with other `STATES`, all other fields and groups have their defaults.

    Raises:
        RecordingError: A setting is missing, unknown or of the wrong type.
        InputError: A value is not allowed.
    """
    values = header["settings"]
    if isinstance(values, Mapping) and not values.keys() & GROUPS.keys():
        values = _in_groups(values, header)
    if states_of(header) != STATES and isinstance(values, Mapping):
        needed = names or values.keys()
        known = {name: value for name, value in values.items() if name in needed}
        for group in GROUPS.keys() & known.keys():
            known[group] = {k: v for k, v in known[group].items() if is_allowed(group, k, v)}
        values = _laid_over(encoded(Settings()), known)
    return decoded(values)


def recorded_users(header: Mapping[str, Any]) -> tuple[UserConfiguration | None, ...]:
    """The simulated users who drove the two hands of a recording; None for a person."""
    made = recorded_settings(header, "hands", "device", "second_device")
    return made.device.user, made.device_of(1).user


def _in_groups(flat: Mapping[str, Any], header: Mapping[str, Any]) -> dict[str, Any]:
    """Settings in groups, from a header without groups.

    Settings that are missing in such a header have their defaults. Unknown settings remain in the
    result, so that `decoded` refuses them. The devices are entries of the header itself.
    """
    values = encoded(Settings())
    second = header.get("second")
    values["device"] = _recorded_device(header)
    values["second_device"] = _recorded_device(second) if isinstance(second, Mapping) else None
    for name, value in flat.items():
        new = _RENAMED.get(name, name)
        try:
            group = group_of(new)
        except InputError:
            values[name] = value
            continue
        if group:
            values[group][new] = value
        elif new == "hands" and isinstance(value, list):
            values[new] = [_laid_over(_PLAIN_HAND, hand, all_of_it=True) for hand in value]
        else:
            values[new] = value
    return values


def _recorded_device(beside: Mapping[str, Any]) -> dict[str, Any]:
    """The device of a header without groups, with its recorded options.

    Args:
        beside: The header, or its entry for the second hand.
    """
    name = str(beside.get("device", "simulated"))
    options: dict[str, Any] = {}
    for each in fields(device_options(name)):
        value = beside.get(each.name)
        if each.name == "user" and isinstance(value, Mapping):
            known = {field.name for field in fields(UserConfiguration)}
            options["user"] = {k: v for k, v in value.items() if k in known}
        elif value is not None:
            options[each.name] = value
    return {"name": name, "options": options}


_RENAMED = {
    "surface_in": "size_in",
    "surface_calibrated": "calibrated",
    "surface_scale": "scale",
    "one_surface": "shared",
}
"""Names of settings in headers without groups -> their names now."""

_PLAIN_HAND = msgspec.to_builtins(HandSettings())


def _laid_over(
    base: Mapping[str, Any], over: Mapping[str, Any], all_of_it: bool = False
) -> dict[str, Any]:
    """Values with replacements; unknown replacements are left out.

    Args:
        base: The values.
        over: The replacements.
        all_of_it: True also takes replacements whose names are not in `base`.
    """
    values = dict(base)
    for name, value in over.items():
        if name not in base and not all_of_it:
            continue
        inner = values.get(name)
        if name == "hands" and isinstance(value, list):
            values[name] = [_laid_over(_PLAIN_HAND, hand) for hand in value]
        elif isinstance(inner, Mapping) and isinstance(value, Mapping) and name != "options":
            values[name] = _laid_over(inner, value)
        else:
            values[name] = value
    return values


def recorded_encoder(header: Mapping[str, Any], where: str) -> str:
    """The name under which a recording's encoder can be loaded on this machine.

    Args:
        header: Header of the recording.
        where: The recording, for error messages.

    Raises:
        RecordingError: The encoder is not on this machine; the error names what to install.
    """
    name = recorded_settings(header, "pipeline").pipeline.encoder
    source = header.get("encoder_from")
    if not isinstance(source, dict):
        return name
    place = place_of(source)
    try:
        find_encoder(place)
    except InputError as error:
        raise RecordingError(
            "its encoder is not on this machine",
            where=where,
            got=str(error),
            expected=f"{name} from {place}",
            remedy=how_to_get(source),
        ) from error
    return place
