"""`sandbox hand`: measures a person's hand and rest posture, shows its profile, deletes layouts."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from sandbox.cli.common.command_line import application, run
from sandbox.cli.hand.measure import measure
from sandbox.cli.hand.rest import rest
from sandbox.trial.profiles import Profile, default_path, load_profile, save_profile

File = Annotated[Path | None, Parameter(metavar="FILE")]


def main(argv: list[str]) -> int:
    """Runs `sandbox hand ...`; returns the exit status."""
    about = "Measures a person's hand, and shows or changes its profile."
    return int(run(application("sandbox hand", about, measure, rest, show, forget), argv) or 0)


def show(file: File = None) -> int:
    """Shows a profile: side and size of the hand, the screen edge at which the person sits, and
    the number of layouts of five fingers.

    A layout is the positions of five resting fingertips. Layouts come from `sandbox hand measure`
    and `sandbox play --learn`. They help to label two, three and four fingers.

    Args:
        file: File of the profile. Default: this user's own profile.
    """
    path = file or default_path()
    _print(path, load_profile(path))
    return 0


def forget(file: File = None) -> int:
    """Deletes all layouts of five fingers from a profile. All other values stay.

    Args:
        file: File of the profile. Default: this user's own profile.
    """
    path = file or default_path()
    # Layouts are not read, so a profile with unusable layouts can be repaired.
    profile = replace(load_profile(path, with_layouts=False), layouts=())
    save_profile(profile, path)
    Console().print(f"{path}: all layouts are deleted", soft_wrap=True, markup=False)
    _print(path, profile)
    return 0


def _print(path: Path, profile: Profile) -> None:
    Console().print(f"{path}: {profile.line}", soft_wrap=True, markup=False)
