"""`sandbox profile`: shows what a profile knows of a person, and forgets layouts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from sandbox.cli.common.command_line import parse
from sandbox.options.profiles import default_path, load_profile, save_profile


@dataclass(frozen=True, kw_only=True)
class ProfileOptions:
    """Shows a profile: the hand, its size and seat, and how many layouts of five fingers it has.

    Layouts come from `sandbox calibrate`, and from `sandbox play --learn`. They help to name two,
    three and four fingers.

    Try: sandbox profile --forget
    """

    file: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """File of the profile. Default: this user's own profile."""

    forget: bool = False
    """Forget all layouts. Hand, size and seat stay."""


def main(argv: list[str]) -> int:
    """Runs `sandbox profile ...`."""
    options = parse(ProfileOptions, "sandbox profile", argv)
    path = options.file or default_path()
    console = Console()
    if options.forget:
        # Also layouts that cannot be used are forgotten.
        profile = replace(load_profile(path, with_layouts=False), layouts=())
        save_profile(profile, path)
        console.print(f"{path}: all layouts are forgotten", soft_wrap=True, markup=False)
    else:
        profile = load_profile(path)
    console.print(f"{path}: {profile.line}", soft_wrap=True, markup=False)
    return 0
