"""Profiles of persons: side, size and seat as measured by `sandbox calibrate`, in a file.

A profile is for people who play. Measurements and comparisons ignore it unless --profile is given.
A recording holds the values themselves, so that it replays without a profile.
"""

from __future__ import annotations

import json
import os
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

from msgspec import Struct

from models.errors import InputError
from models.json_input import check_layout, decoded, read_bytes
from models.person import Person

SCHEMA = 1
"""Version of the file's layout."""

KIND = "hand-sandbox profile"
DEFAULT = "default"
"""Name of the profile that `sandbox calibrate` writes without --out."""

_UNSOUND = "a value of the profile cannot be used"
_REMEDY = "`sandbox calibrate` makes a valid one"


class _ProfileFile(Struct, forbid_unknown_fields=True):
    """The fields of a profile's file; those of `Person` are checked there."""

    kind: str
    schema: int
    hand: str
    hand_size: float
    turn: int
    hand_size_95: tuple[float, float]
    device: str
    simulated: bool


@dataclass(frozen=True)
class Profile:
    """A calibrated person.

    Attributes:
        person: Side, size and seat.
        interval: 95 % interval of the size, a ratio.
        device: Device of the measurement.
        simulated: True if a simulated person was measured.
    """

    person: Person
    interval: tuple[float, float]
    device: str
    simulated: bool

    @property
    def line(self) -> str:
        """Summary in one line."""
        low, high = self.interval
        who = "a SIMULATED person's " if self.simulated else ""
        seat = f", from {self.person.turn} degrees round the screen" if self.person.turn else ""
        return (
            f"{who}{self.person.hand} hand, {self.person.hand_size:.2f} times as long as the "
            f"trained hand ({low:.2f} to {high:.2f}){seat}"
        )


def default_path() -> Path:
    """Returns the path of this user's profile, in the system's folder for settings."""
    if sys.platform == "win32":
        base = os.environ.get("APPDATA") or Path.home() / "AppData" / "Roaming"
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Application Support"
    else:
        base = os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config"
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


def load_profile(path: Path) -> Profile:
    """Reads a profile.

    Raises:
        InputError: The file is missing, is not a profile, or holds an invalid value.
    """
    where = str(path)
    data = read_bytes(path, InputError, what="the profile cannot be read", remedy=_REMEDY)
    check_layout(
        data, KIND, SCHEMA, InputError, what="this is not a profile", where=where, remedy=_REMEDY
    )
    values = decoded(data, _ProfileFile, InputError, what=_UNSOUND, where=where, remedy=_REMEDY)
    return _profile(values, where)


def find_profile(name: str) -> Profile:
    """Returns the profile of a name: `default`, or a file."""
    return load_profile(default_path() if name == DEFAULT else Path(name))


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
    return Profile(person, (low, high), values.device, values.simulated)
