"""Writes and reads npz files with arrays and a JSON header; files are not trusted.

Pickle is off, sizes are limited before unpacking, and any damage is reported in one sentence.
"""

from __future__ import annotations

import json
import os
import zipfile
import zlib
from collections.abc import Iterable, Mapping
from pathlib import Path
from tokenize import TokenError
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError

LARGEST = 2**30
"""Largest size (bytes) of an unpacked file, 100 times that of the paper's capture. A larger file is
a mistake or an attack."""

_DAMAGE = (
    OSError,
    ValueError,
    KeyError,
    TypeError,
    EOFError,
    NotImplementedError,
    RuntimeError,
    zipfile.BadZipFile,
    zlib.error,
    SyntaxError,
    TokenError,
    OverflowError,
    MemoryError,
)
"""Errors that numpy, zipfile and zlib raise for damaged files (measured by mutation)."""


def write_npz(path: Path, header: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Writes arrays and a header of JSON values; equal contents give equal files.

    An existing file is replaced once the new file is complete.
    """
    text = json.dumps(dict(header), sort_keys=True, allow_nan=False)
    everything: dict[str, Any] = {"header": np.frombuffer(text.encode(), np.uint8), **arrays}
    # The file to which a symbolic link points is replaced, not the link.
    target = path.resolve()
    if target.exists() and not target.is_file():
        with target.open("wb") as file:
            np.savez_compressed(file, **everything)
        return
    part = target.with_name(f"{target.name}.{os.getpid()}.part")
    try:
        with part.open("wb") as file:
            np.savez_compressed(file, **everything)
        part.replace(target)
    finally:
        part.unlink(missing_ok=True)


def read_npz(
    path: Path, names: Iterable[str] | None, error: type[InputError], what: str, remedy: str
) -> tuple[dict[str, Any], dict[str, NDArray[Any]]]:
    """Reads header and arrays of a file.

    Args:
        path: The file.
        names: Names of required arrays; None reads all arrays.
        error: Class of the error for a file that is missing, damaged or too large.
        what: Kind of file, for the message: "a capture".
        remedy: Next step in the message.
    """
    where = str(path)
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(m.file_size for m in archive.infolist())  # any order: whole numbers
            if size > LARGEST:
                what_is_wrong = "the file is too large"
                expected = f"at most {LARGEST} bytes unpacked"
                raise error(what_is_wrong, where=where, got=size, expected=expected)
            # Check the checksums first; numpy would parse damaged text otherwise.
            bad = archive.testzip()
        if bad is not None:
            raise zipfile.BadZipFile(f"checksum of {bad}")
        with np.load(path, allow_pickle=False) as file:
            wanted = [n for n in file.files if n != "header"] if names is None else names
            arrays = {name: file[name] for name in wanted}
            header = json.loads(bytes(file["header"].tobytes()).decode())
    except FileNotFoundError:
        raise error("no such file", where=where, expected=what, remedy=remedy) from None
    except error:
        raise
    except _DAMAGE as damage:
        raise error(
            f"this is not {what}, or it is damaged",
            where=where,
            got=f"{type(damage).__name__}: {damage}"[:200],
            remedy=remedy,
        ) from damage
    if not isinstance(header, dict):
        raise error(
            "the header is damaged",
            where=where,
            got=type(header).__name__,
            expected="a JSON object",
            remedy=remedy,
        )
    return header, arrays
