"""The home folder of whoever runs the program."""

from __future__ import annotations

from pathlib import Path

from models.errors import InputError


def home() -> Path:
    """The home folder.

    Raises:
        InputError: None is known, as of a user without an account in a container.
    """
    try:
        return Path.home()
    except RuntimeError as error:
        raise InputError(
            "no home folder is known", got=str(error), remedy="Set HOME to a folder of yours"
        ) from None
