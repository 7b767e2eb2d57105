"""Ways to damage an npz file, for all tests that must see it refused."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np


def rewritten(path: Path, **changes: Any) -> None:
    """Replaces arrays of a file; None takes one out."""
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    arrays |= changes
    with path.open("wb") as file:
        np.savez_compressed(file, **{k: v for k, v in arrays.items() if v is not None})


def header_of(text: str) -> np.ndarray:
    """A header array that says `text`."""
    return np.frombuffer(text.encode(), np.uint8)


def with_pickle(path: Path, name: str) -> None:
    """Replaces an array by a pickled object, which would run whatever it likes when loaded."""
    rewritten(path, **{name: np.array([{"a": 1}], dtype=object)})


def claiming_too_much(path: Path) -> None:
    """Makes the zip's directory say that its first part unpacks to 2 GiB."""
    data = bytearray(path.read_bytes())
    entry = data.index(b"PK\x01\x02")
    data[entry + 24 : entry + 28] = struct.pack("<I", 2**31 - 1)
    path.write_bytes(data)
