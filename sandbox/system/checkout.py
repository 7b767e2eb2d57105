"""The commit that a program runs from, where it runs from a checkout of its repository."""

from __future__ import annotations

import subprocess
from pathlib import Path

PATIENCE = 5.0
"""s that git may take."""


def commit(root: Path) -> str:
    """Short name of the commit of a folder's files, `with changes` where files differ from it.

    Empty where the folder is not the root of a checkout, or git cannot tell.

    Args:
        root: Folder of the packages.
    """
    if not (root / ".git").exists():
        return ""
    name = _git(root, "rev-parse", "--short", "HEAD")
    if name and _git(root, "status", "--porcelain", "--untracked-files=no"):
        return f"{name} with changes"
    return name


def _git(root: Path, *words: str) -> str:
    """What git says, empty if it fails or is not there."""
    command = ["git", "-C", str(root), *words]
    try:
        said = subprocess.run(
            command, capture_output=True, text=True, check=False, timeout=PATIENCE
        )
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return said.stdout.strip() if said.returncode == 0 else ""
