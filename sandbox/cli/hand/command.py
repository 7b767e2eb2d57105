"""`sandbox hand`: what is known of a person's hand: measure, see, show and forget it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from sandbox.cli.common.command_line import application, run
from sandbox.cli.hand.measure import measure
from sandbox.cli.hand.rest import rest
from sandbox.hand.profiles import Profile, default_path, load_profile, save_profile

File = Annotated[Path | None, Parameter(metavar="FILE")]


def main(argv: list[str]) -> int:
    """Runs `sandbox hand ...`; returns the exit status."""
    about = "What is known of a person's hand."
    return int(run(application("sandbox hand", about, measure, rest, show, forget), argv) or 0)


def show(file: File = None) -> int:
    """Shows a profile: the hand, its size and seat, and how many layouts of five fingers it has.

    Layouts come from `sandbox hand measure`, and from `sandbox play --learn`. They help to label
    two, three and four fingers.

    Args:
        file: File of the profile. Default: this user's own profile.
    """
    path = file or default_path()
    _print(path, load_profile(path))
    return 0


def forget(file: File = None) -> int:
    """Forgets all layouts of five fingers in a profile. Hand, size and seat stay.

    Args:
        file: File of the profile. Default: this user's own profile.
    """
    path = file or default_path()
    # Also layouts that cannot be used are forgotten.
    profile = replace(load_profile(path, with_layouts=False), layouts=())
    save_profile(profile, path)
    Console().print(f"{path}: all layouts are forgotten", soft_wrap=True, markup=False)
    _print(path, profile)
    return 0


def _print(path: Path, profile: Profile) -> None:
    Console().print(f"{path}: {profile.line}", soft_wrap=True, markup=False)
