"""Robots' hands by name, or by file."""

from __future__ import annotations

from pathlib import Path

from models.errors import InputError, unknown_name
from models.robot.mapping import MODEL_SUFFIXES, RobotMapping, load_mapping

ROBOTS = ("shadow", "adroit", "inspire", "allegro", "leap")
"""Hands that are known by name. The first two are in the package gymnasium-robotics, the extra
`robots`: the Shadow Dexterous Hand, and Adroit, which is a Shadow Hand on an arm with other limits.
The Inspire Hand is in the package robosuite, whose other needs clash with ours, so no extra brings
it. The Allegro Hand and the LEAP Hand, which have no little finger, are in mujoco_menagerie: in a
clone where the package robot_descriptions keeps it, or in the package mujoco-menagerie."""


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
            "this model has no mapping to a person's hand beside it",
            where="--robot",
            got=name,
            expected=str(mapping),
            remedy=f"`sandbox devices robot fit {name} --tips ...` writes it",
        )
    return load_mapping(mapping)
