"""Stores the token of a page on a fixed port, so that a tablet can reconnect after a restart.

A tablet tries to reconnect as long as its page is open, and a restarted program has the same
address if the port is fixed. Only this user can read the token's file; delete it to get another
token at the next start.
"""

from __future__ import annotations

import os
import re
import secrets
from pathlib import Path

from models.errors import InputError
from sandbox.server.connections.access import TOKEN_BYTES

_TOKEN = re.compile(r"[A-Za-z0-9_-]{20,64}")


def kept_token(path: Path) -> str:
    """The token in a file, which is made if it does not exist.

    Raises:
        InputError: The file does not hold a token, can be read by others, or cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:
        return _read(path)
    except OSError as error:
        raise _not_stored(path, error) from None
    token = secrets.token_urlsafe(TOKEN_BYTES)
    try:
        with os.fdopen(fresh, "w", encoding="ascii") as file:
            file.write(token + "\n")
    except OSError as error:
        path.unlink(missing_ok=True)
        raise _not_stored(path, error) from None
    return token


def _not_stored(path: Path, error: OSError) -> InputError:
    return InputError(
        "the page's token cannot be stored",
        where=str(path),
        got=error.strerror,
        remedy="Leave --page-port out: then every start has a new token",
    )


def _read(path: Path) -> str:
    remedy = "Delete the file: the next start makes another one"
    try:
        text, mode = path.read_text(encoding="ascii").strip(), path.stat().st_mode
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise InputError(
            "the page's token cannot be read", where=str(path), got=reason, remedy=remedy
        ) from None
    if os.name == "posix" and mode & 0o077:
        raise InputError("other users can read the page's token", where=str(path), remedy=remedy)
    if not _TOKEN.fullmatch(text):
        raise InputError("the file does not hold a token", where=str(path), remedy=remedy)
    return text
