"""Profiles: what `sandbox calibrate` found out about a person, kept in a file of theirs.

A profile is for people who play. What is measured and compared ignores it unless asked to use it,
and every recording holds the values themselves, so that it replays without any profile.
"""

from __future__ import annotations

import json
import math
import os
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from models.errors import InputError
from models.person import Person

SCHEMA = 1
"""Version of the file's layout."""

KIND = "hand-sandbox profile"
DEFAULT = "default"
"""Name of the profile that `sandbox calibrate` writes unless told where."""

_REMEDY = "`sandbox calibrate` makes a sound one"


@dataclass(frozen=True)
class Profile:
    """A person, as calibrated.

    Attributes:
        person: Hand, size and seat.
        interval: The 95 % interval of the size.
        device: What it was measured with.
        simulated: Nobody real was measured.
    """

    person: Person
    interval: tuple[float, float]
    device: str
    simulated: bool

    @property
    def line(self) -> str:
        """A line for the person."""
        low, high = self.interval
        who = "a SIMULATED person's " if self.simulated else ""
        seat = f", from {self.person.turn} degrees round the screen" if self.person.turn else ""
        return (
            f"{who}{self.person.hand} hand, {self.person.hand_size:.2f} times as long as the "
            f"trained one ({low:.2f} to {high:.2f}){seat}"
        )


def default_path() -> Path:
    """Where this user's profile is, by the custom of the system."""
    if sys.platform == "win32":
        base = os.environ.get("APPDATA") or Path.home() / "AppData" / "Roaming"
    elif sys.platform == "darwin":
        base = Path.home() / "Library" / "Application Support"
    else:
        base = os.environ.get("XDG_CONFIG_HOME") or Path.home() / ".config"
    return Path(base) / "hand-sandbox" / "profile.json"


def save_profile(profile: Profile, path: Path) -> None:
    """Writes a profile, whole or not at all.

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
        InputError: There is no such file, it is no profile, or a value of it is none.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not text"
        raise InputError(
            "the profile cannot be read", where=str(path), got=reason, remedy=_REMEDY
        ) from None
    try:
        values = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(
            "this is not a profile", where=str(path), got=str(error), expected="JSON",
            remedy=_REMEDY,
        ) from None  # fmt: skip
    if not isinstance(values, dict) or values.get("kind") != KIND:
        raise InputError(
            "this is not a profile", where=str(path), expected=f'"kind": "{KIND}"', remedy=_REMEDY
        )
    if values.get("schema") != SCHEMA:
        raise InputError(
            "another version's profile", where=str(path), got=values.get("schema"),
            expected=f"schema {SCHEMA}", remedy=_REMEDY,
        )  # fmt: skip
    return _checked(values, str(path))


def find_profile(name: str) -> Profile:
    """The profile of a name: `default`, or a file."""
    return load_profile(default_path() if name == DEFAULT else Path(name))


def _checked(values: dict[str, Any], where: str) -> Profile:
    names = {"kind", "schema", "hand", "hand_size", "turn", "hand_size_95", "device", "simulated"}
    if set(values) != names:
        raise InputError(
            "the profile's values are not those of a profile", where=where,
            got=", ".join(sorted(map(str, set(values) ^ names))) + " missing or unknown",
            remedy=_REMEDY,
        )  # fmt: skip

    def bad(name: str, expected: str) -> InputError:
        got = values[name]
        shown = got if isinstance(got, int | float) else str(got)[:80]
        return InputError(
            "a value of the profile is out of range", where=f"{where}: {name}", got=shown,
            expected=expected, remedy=_REMEDY,
        )  # fmt: skip

    interval = values["hand_size_95"]
    if not (isinstance(interval, list) and len(interval) == 2 and all(map(_number, interval))):
        raise bad("hand_size_95", "two numbers")
    for name in ("hand", "device"):
        if not isinstance(values[name], str):
            raise bad(name, "a text")
    if not _number(values["hand_size"]):
        raise bad("hand_size", "a number")
    if not (_number(values["turn"]) and isinstance(values["turn"], int)):
        raise bad("turn", "a whole number")
    if not isinstance(values["simulated"], bool):
        raise bad("simulated", "true or false")
    try:
        person = Person(values["hand"], float(values["hand_size"]), values["turn"])
    except InputError as error:
        raise InputError(
            error.what, where=f"{where}: {(error.where or '').strip('-').replace('-', '_')}",
            got=error.got, expected=error.expected, remedy=_REMEDY,
        ) from None  # fmt: skip
    low, high = (float(v) for v in interval)
    if not 0.0 < low <= person.hand_size <= high:
        raise bad("hand_size_95", "an interval around hand_size")
    return Profile(person, (low, high), values["device"], values["simulated"])


def _number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    # A whole number may be too large for any float.
    return abs(value) < 1e9 and math.isfinite(value)
