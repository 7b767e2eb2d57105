"""Mapping between a robot hand and a person's hand, as a small TOML file.

    model = "my_hand.xml"
    side = "right"
    palm = "palm"
    tips = ["th_tip", "ff_tip", "mf_tip", "rf_tip", "lf_tip"]
    radii = [0.009, 0.007, 0.007, 0.007, 0.007]
    scales = [1.1, 1.05, 1.05, 1.05, 1.1]
    offset = [0.0, 0.0, 0.0]
    turn = [1.0, 0.0, 0.0, 0.0]

    [coupled]
    ff_dip = ["ff_pip", 1.0]
    mf_dip = ["mf_pip", [0.3, 0.9, 0.1]]

A coupled joint follows another joint: by the ratio of their angles, or by a polynomial in the other
joint's angle (rad). The polynomial's constant coefficient comes first.

`sandbox devices robot fit` writes such a file.
"""

from __future__ import annotations

import hashlib
import os
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib import import_module
from importlib.util import find_spec
from math import isfinite
from pathlib import Path
from typing import Any

import msgspec

from models.arithmetic import total
from models.errors import InputError, unknown_name
from models.frames import FINGERS
from models.person import HANDS

REMEDIES = {
    "gymnasium_robotics": "pip install 'hand-sandbox[robots]'",
    "robosuite": "pip install --no-deps robosuite==1.5.2",
}
"""Package -> command that installs it. Only the model files of robosuite are needed. It is
installed without its dependencies, which require NumPy before 2."""
MENAGERIE = "mujoco_menagerie"
"""Models by Google DeepMind. They are available as a repository, which the package
robot_descriptions clones into its cache folder, and as a package, which downloads a model when it
is first used."""


URDF = ".urdf"
MODEL_SUFFIXES = (".xml", URDF)
"""Suffixes of the model files that MuJoCo reads."""

LEAST_FINGERS = 3
"""Least number of fingers of a hand, thumb included. With fewer fingers, left and right hands look
alike."""


@dataclass(frozen=True)
class RobotMapping:
    """Content of a mapping file.

    Attributes:
        model: MJCF file of the robot: a path relative to the mapping file, or `package:path` for a
            file inside an installed package or in mujoco_menagerie.
        side: `right` or `left`.
        palm: Name of the body that carries all fingers.
        tips: Names of the sites or bodies at the middle of the n fingertips, thumb first; n is
            three to five. A hand with four fingertips lacks the little finger, a hand with three
            also the ring finger.
        radii: (n,) m, radii of the fingertips.
        scales: (n,) length of each finger relative to that of a person's finger.
        offset: (3,) m, origin of the robot's palm in the frame of a person's hand of trained size.
        turn: (4,) quaternion (w, x, y, z): a person's hand from the robot's palm.
        coupled: Joints that follow other joints: name -> name of the followed joint, and either the
            ratio of the angles or the coefficients of a polynomial in the followed joint's angle
            (rad), the constant coefficient first.
        places: n positions (3,) m, the middle of each fingertip in the frame of the body that
            `tips` names. Empty if `tips` are sites, or bodies with their origins at the middle of
            the fingertips.
        file: The file from which the mapping was read.
    """

    model: str
    side: str
    palm: str
    tips: tuple[str, ...]
    radii: tuple[float, ...]
    scales: tuple[float, ...]
    offset: tuple[float, float, float]
    turn: tuple[float, float, float, float]
    coupled: dict[str, tuple[str, float | tuple[float, ...]]] = field(default_factory=dict)
    places: tuple[tuple[float, float, float], ...] = ()
    file: str = ""

    def __post_init__(self) -> None:
        check_tips(self.tips, self.file or "mapping")
        for what, values in (("radii", self.radii), ("scales", self.scales)):
            if len(values) != len(self.tips):
                raise InputError(
                    f"a hand needs as many {what} as tips",
                    where=self.file or "mapping",
                    got=len(values),
                    expected=str(len(self.tips)),
                )
        if len(self.places) not in (0, len(self.tips)):
            raise InputError(
                "`places` has another number of entries than `tips`",
                where=self.file or "mapping",
                got=len(self.places),
                expected=f"{len(self.tips)}, or none",
            )
        for what, some in (
            ("offset", self.offset),
            ("places", [number for place in self.places for number in place]),
            ("turn", self.turn),
            (
                "ratios of [coupled]",
                [c for _, law in self.coupled.values() for c in coefficients(law)],
            ),
        ):
            if not all(map(isfinite, some)):
                raise InputError(
                    f"the {what} must be finite numbers",
                    where=self.file or "mapping",
                    got=str(list(some)),
                )
        laws = {joint: coefficients(law) for joint, (_, law) in self.coupled.items()}
        if still := [joint for joint, law in laws.items() if not any(law[1:])]:
            raise InputError(
                "a coupled joint does not depend on the other joint",
                where=f"{self.file or 'mapping'}, [coupled]",
                got=", ".join(still),
                remedy="Leave it out of [coupled]",
            )
        for what, numbers in (("radii", self.radii), ("scales", self.scales)):
            if not all(0.0 < number < 10.0 for number in numbers):
                raise InputError(
                    f"the {what} must be between 0 and 10",
                    where=self.file or "mapping",
                    got=str(list(numbers)),
                )
        if self.side not in HANDS:
            raise InputError(
                "no such side", where=self.file, got=self.side, expected=" or ".join(HANDS)
            )
        square = total(part * part for part in self.turn)
        if not 0.99 < square < 1.01:
            raise InputError(
                "the turn is not a unit quaternion",
                where=self.file or "mapping",
                got=str(list(self.turn)),
                expected="w, x, y, z of length 1",
            )

    @property
    def path(self) -> Path:
        """The MJCF file.

        Raises:
            InputError: The package is not installed, or there is no such file.
        """
        return located(self.model, Path(self.file).parent)

    def as_toml(self) -> str:
        """The text of a mapping file."""
        lines = [
            f"model = {_quoted(self.model)}",
            f'side = "{self.side}"',
            f"palm = {_quoted(self.palm)}",
            f"tips = [{', '.join(map(_quoted, self.tips))}]",
            *([f"places = [{', '.join(map(_numbers, self.places))}]"] if self.places else []),
            f"radii = {_numbers(self.radii)}",
            f"scales = {_numbers(self.scales)}",
            f"offset = {_numbers(self.offset)}",
            f"turn = {_numbers(self.turn)}",
        ]
        if self.coupled:
            lines += ["", "[coupled]"]
            lines += [
                f"{_quoted(joint)} = [{_quoted(other)}, {_law(law)}]"
                for joint, (other, law) in self.coupled.items()
            ]
        return "\n".join(lines) + "\n"


def coefficients(law: float | tuple[float, ...]) -> tuple[float, ...]:
    """Coefficients of a coupling's polynomial, the constant coefficient first. A ratio gives two
    coefficients."""
    return law if isinstance(law, tuple) else (0.0, law)


def check_tips(tips: Sequence[str], where: str) -> None:
    """Refuses names of fingertips that are too few or too many for a hand, or not unique.

    Raises:
        InputError: The names are refused.
    """
    if not LEAST_FINGERS <= len(tips) <= len(FINGERS):
        raise InputError(
            "a hand needs three to five fingertips: that of the thumb, then those of index, "
            "middle, ring and little finger, as far as the hand has them",
            where=where,
            got=len(tips),
            expected=f"{LEAST_FINGERS} to {len(FINGERS)}",
        )
    if twice := [tip for tip in dict.fromkeys(tips) if tips.count(tip) > 1]:
        raise InputError(
            "two fingers have the same fingertip",
            where=where,
            got=", ".join(twice) + " twice",
        )


def located(model: str, folder: Path) -> Path:
    """The file of a model.

    Args:
        model: Its path, or `package:path` for a file inside an installed package.
        folder: Folder to which the path is relative.

    Raises:
        InputError: The package is not installed, or there is no such file.
    """
    package, _, inside = model.partition(":")
    path = folder / model
    if inside and package == MENAGERIE:
        path = _in_menagerie(inside)
    elif inside and len(package) > 1:
        try:
            spec = find_spec(package)
        except (ModuleNotFoundError, ValueError):
            # The parent package does not exist, or no package can have this name.
            spec = None
        if spec is None or not spec.submodule_search_locations:
            raise InputError(
                f"the package with this hand is not installed: {package}",
                where="--robot",
                remedy=REMEDIES.get(package, f"pip install {package}"),
            )
        path = Path(next(iter(spec.submodule_search_locations))) / inside
    if not path.is_file():
        raise InputError(
            "the file of this robot's model does not exist", where="--robot", got=str(path)
        )
    return path


def menagerie() -> Path:
    """Folder of mujoco_menagerie, in which the package robot_descriptions stores it."""
    cache = os.environ.get("ROBOT_DESCRIPTIONS_CACHE") or "~/.cache/robot_descriptions"
    return Path(cache).expanduser() / MENAGERIE


def _in_menagerie(inside: str) -> Path:
    """Path of a file of mujoco_menagerie, from a clone or from the package."""
    path = menagerie() / inside
    if path.is_file():
        return path
    if find_spec(MENAGERIE) is None:
        raise InputError(
            "mujoco_menagerie, which contains this hand's model, is not installed",
            where="--robot",
            got=str(path),
            remedy="pip install mujoco-menagerie, or git clone --depth 1 "
            f"https://github.com/google-deepmind/mujoco_menagerie {menagerie()}",
        )
    package = import_module(MENAGERIE)
    robot, _, file = inside.partition("/")
    try:
        return Path(package.get(robot).path()) / file
    except package.MenagerieError as error:
        raise InputError(
            "mujoco_menagerie cannot provide this hand's model", where="--robot", got=str(error)
        ) from None


def load_mapping(path: Path) -> RobotMapping:
    """Reads a mapping file.

    Raises:
        InputError: The file cannot be read, or is not a mapping.
    """
    try:
        values: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
        return msgspec.convert({**values, "file": str(path)}, RobotMapping)
    except OSError as error:
        raise InputError("no such mapping", where=str(path), got=error.strerror) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, msgspec.ValidationError) as error:
        raise InputError(
            "this is not a mapping of a robot's hand",
            where=str(path),
            got=str(error),
            remedy="`sandbox devices robot fit FILE.xml` writes one; docs/robots.md shows it",
        ) from None


def digest(*parts: bytes) -> str:
    """Digest of a hand, computed from the bytes of its parts."""
    whole = hashlib.blake2b(digest_size=16)
    for part in parts:
        whole.update(len(part).to_bytes(8, "little") + part)
    return whole.hexdigest()


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _law(law: float | tuple[float, ...]) -> str:
    return _numbers(law) if isinstance(law, tuple) else f"{law:.9g}"


def _numbers(values: tuple[float, ...]) -> str:
    return "[" + ", ".join(f"{value:.9g}" for value in values) + "]"


ROBOTS = ("shadow", "adroit", "inspire", "allegro", "leap")
"""Hands that are known by name. The package gymnasium-robotics (extra `robots`) contains the Shadow
Dexterous Hand, and Adroit, which is a Shadow Hand on an arm with other joint limits. The package
robosuite contains the Inspire Hand; its dependencies conflict with those of this program, so no
extra includes it. mujoco_menagerie contains the Allegro Hand and the LEAP Hand, which have no
little finger. It is read from a clone in the folder of the package robot_descriptions, or from the
package mujoco-menagerie."""


def find_robot(name: str) -> RobotMapping:
    """The mapping of a robot's hand.

    Args:
        name: One of `ROBOTS`, or a file: a mapping (`.toml`), or a model (`.xml`, `.urdf`) with a
            mapping of the same name beside it.

    Raises:
        InputError: There is no such hand, or its mapping cannot be used.
    """
    if name in ROBOTS:
        return load_mapping(Path(__file__).parent / f"{name}.toml")
    path = Path(name)
    if path.suffix not in (*MODEL_SUFFIXES, ".toml"):
        others = "FILE.xml, FILE.urdf or FILE.toml"
        raise unknown_name("no such robot", name, ROBOTS, where="--robot", others=others)
    if not path.is_file():
        raise InputError("no such file", where="--robot", got=name)
    mapping = path.with_suffix(".toml")
    if not mapping.is_file():
        raise InputError(
            "this model has no mapping file beside it",
            where="--robot",
            got=name,
            expected=str(mapping),
            remedy=f"`sandbox devices robot fit {name} --tips ...` writes it",
        )
    return load_mapping(mapping)
