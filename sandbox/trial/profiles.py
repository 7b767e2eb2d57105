"""A profile is a file that describes the hand of one person who touches a screen.

It holds the side and size of the hand, the edge of the screen at which the person sits (the seat),
and places of five fingers that touched together (layouts). `sandbox hand measure` writes a profile,
and `sandbox play --learn` adds layouts.

For a hand over a Leap, `sandbox paalm calibrate` writes a calibration file instead. The option
--profile accepts a calibration file, too.

A profile is for people who play. Measurements and comparisons ignore it unless --profile is given.
A recording holds the values themselves, so that its replay needs no profile.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec import Struct

from encoders.person.rest_posture import check_rest_samples
from models.errors import EncoderError, InputError
from models.json_input import check_layout, decoded, read_bytes
from models.person import Person, RestSample, RestSamples
from sandbox.devices.registry import is_in_air
from sandbox.session.own_layouts import Layouts, known_layouts
from sandbox.system.files import home
from sandbox.trial.settings import HandSettings

if TYPE_CHECKING:
    from sandbox.trial.trial_options import TrialOptions

SCHEMA = 1
"""Version of the file format."""

KIND = "hand-sandbox profile"
DEFAULT = "default"
"""Name of the profile that `sandbox hand measure` writes without --out."""

_UNSOUND = "a value of the profile cannot be used"
_REMEDY = "`sandbox hand measure` writes a valid profile"
FORGET = "`sandbox hand forget` removes them"
"""Remedy for layouts that cannot be used."""


class _ProfileFile(Struct, forbid_unknown_fields=True):
    """Fields of a profile file. Values of the person are checked by `Person`, not here."""

    kind: str
    schema: int
    hand: str
    hand_size: float
    turn: int
    hand_size_95: tuple[float, float]
    device: str
    simulated: bool
    layouts: list[list[tuple[float, float]]] = []
    rest: list[RestSample] = []


@dataclass(frozen=True)
class Profile:
    """A calibrated person.

    Attributes:
        person: Side, size and seat.
        interval: 95 % interval (low, high) of the hand's size relative to the trained hand.
        device: Device with which the person was measured.
        simulated: True if a simulated person was measured.
        layouts: Places of five fingers that touched together; see `sandbox.session.own_layouts`.
        rest: Samples of the hand at rest; see `encoders.person.rest_posture`.
    """

    person: Person
    interval: tuple[float, float]
    device: str
    simulated: bool
    layouts: Layouts = ()
    rest: RestSamples = ()

    @property
    def line(self) -> str:
        """Summary in one line."""
        low, high = self.interval
        who = "a SIMULATED person's " if self.simulated else ""
        seat = f", from {self.person.turn} degrees round the screen" if self.person.turn else ""
        rest = f", a rest posture of {len(self.rest)} samples" if self.rest else ""
        return (
            f"{who}{self.person.hand} hand, {self.person.hand_size:.2f} times as long as the "
            f"trained hand ({low:.2f} to {high:.2f}){seat}, {len(self.layouts)} layouts of five "
            f"fingers{rest}"
        )

    @property
    def hand(self) -> HandSettings:
        """Settings of the person's hand, with its layouts and rest posture."""
        return replace(HandSettings.of(self.person), layouts=self.layouts, rest=self.rest)


def default_path() -> Path:
    """Returns the path of this user's profile, in the system's folder for settings."""
    if sys.platform == "win32":
        base = os.environ.get("APPDATA") or home() / "AppData" / "Roaming"
    elif sys.platform == "darwin":
        base = home() / "Library" / "Application Support"
    else:
        base = os.environ.get("XDG_CONFIG_HOME") or home() / ".config"
    return Path(base) / "hand-sandbox" / "profile.json"


def save_profile(profile: Profile, path: Path) -> None:
    """Writes a profile atomically.

    Raises:
        InputError: The file cannot be written.
    """
    values = {
        "kind": KIND,
        "schema": SCHEMA,
        **asdict(profile.person),
        "hand_size_95": list(profile.interval),
        "device": profile.device,
        "simulated": profile.simulated,
        **({"layouts": profile.layouts} if profile.layouts else {}),
        **({"rest": [asdict(sample) for sample in profile.rest]} if profile.rest else {}),
    }
    beside = path.with_name(path.name + ".new")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        beside.write_text(json.dumps(values, indent=1) + "\n", encoding="utf-8")
        beside.replace(path)
    except OSError as error:
        raise InputError(
            "the profile cannot be written", where=str(path), got=error.strerror
        ) from None


def load_profile(path: Path, with_layouts: bool = True) -> Profile:
    """Reads a profile.

    Args:
        path: File of the profile.
        with_layouts: False leaves the layouts out; their values are not checked.

    Raises:
        InputError: The file is missing, is not a profile, or holds an invalid value.
    """
    where = str(path)
    data = read_bytes(path, InputError, what="the profile cannot be read", remedy=_REMEDY)
    check_layout(
        data, KIND, SCHEMA, InputError, what="this is not a profile", where=where, remedy=_REMEDY
    )
    values = decoded(data, _ProfileFile, InputError, what=_UNSOUND, where=where, remedy=_REMEDY)
    if not with_layouts:
        values.layouts = []
    return _profile(values, where)


def profile_path(name: str) -> Path:
    """Returns the path of the profile that `--profile` names: `default`, or a file."""
    return default_path() if name == DEFAULT else Path(name)


def find_profile(name: str, with_layouts: bool = True) -> Profile:
    """Reads the profile that `--profile` names: `default`, or a file; see `load_profile`."""
    return load_profile(profile_path(name), with_layouts)


def _profile(values: _ProfileFile, where: str) -> Profile:
    try:
        person = Person(values.hand, values.hand_size, values.turn)
    except InputError as error:
        raise InputError(
            error.what,
            where=f"{where}, {(error.where or '').strip('-').replace('-', '_')}",
            got=error.got,
            expected=error.expected,
            remedy=_REMEDY,
        ) from None
    low, high = values.hand_size_95
    if not 0.0 < low <= person.hand_size <= high:
        raise InputError(
            _UNSOUND,
            where=f"{where}, hand_size_95",
            got=f"{low} to {high}",
            expected="an interval around hand_size",
            remedy=_REMEDY,
        )
    layouts = _layouts(values.layouts, person, where)
    rest = tuple(values.rest)
    if rest:
        try:
            check_rest_samples(rest, person.hand_size)
        except EncoderError as error:
            raise InputError(
                error.what,
                where=f"{where}, rest{f', {error.where}' if error.where else ''}",
                got=error.got,
                expected=error.expected,
                remedy="Write a new rest posture with `sandbox hand rest --out FILE`, then run "
                "`sandbox hand measure --rest FILE`",
            ) from None
    return Profile(person, (low, high), values.device, values.simulated, layouts, rest)


def _layouts(given: Sequence[Sequence[tuple[float, float]]], person: Person, where: str) -> Layouts:
    """The layouts of a profile, checked."""
    layouts = tuple(tuple(places) for places in given)
    try:
        known_layouts(layouts, person.hand_size)
    except EncoderError as error:
        raise InputError(
            error.what,
            where=f"{where}, layouts",
            got=error.got,
            expected=error.expected,
            remedy=FORGET,
        ) from None
    return layouts


def own_calibration_path() -> Path:
    """Returns the default path of the Leap calibration, in the folder of the touch profile."""
    return default_path().with_name("hands.json")


def chosen_calibration(options: TrialOptions) -> Path | None:
    """Returns the calibration file that --calibration or --profile names; None without one.

    Args:
        options: Options of a trial.

    Raises:
        InputError: The options name two files.
    """
    named, given = options.profile, options.device_options.get("calibration")
    path: Path | None = None
    if named == DEFAULT:
        path = own_calibration_path() if own_calibration_path().exists() else None
    elif named not in (None, "none") and _is_calibration(str(named)):
        path = Path(str(named))
        if given is not None:
            raise InputError(
                "two calibrations are given",
                where="--profile",
                got=f"--calibration and --profile {named}",
                expected="one of --calibration and --profile",
            )
    return given or path


def _is_calibration(name: str) -> bool:
    """True if the file that --profile names is a Leap calibration."""
    from encoders.paalm.calibration_file import is_calibration

    return is_calibration(Path(name))


def uses_touch_profile(options: TrialOptions) -> bool:
    """True if the touch profile that --profile names must be loaded.

    A named file is loaded for every device. `default` is loaded for touch devices. For hands in the
    air, `default` is loaded only if there is no Leap calibration.

    Raises:
        InputError: The profile is a Leap calibration, and the device sends touches.
    """
    if options.profile in (None, "none"):
        return False
    in_air = is_in_air(options.device)
    if options.profile == DEFAULT:
        # For hands in the air, the Leap calibration takes precedence over the touch profile.
        return not in_air or (not own_calibration_path().exists() and default_path().exists())
    if not _is_calibration(str(options.profile)):
        return True
    if not in_air:
        raise InputError(
            "this profile is a Leap calibration, and the device sends touches",
            where=f"--profile {options.profile}",
            got=f"--device {options.device}",
            expected="--device leap",
            remedy="`sandbox hand measure` writes a profile for touch devices",
        )
    return False
