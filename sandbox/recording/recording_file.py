"""Files of recordings, as they are or compressed: whoever reads one need not know.

A recording is written as it is, line by line, and may be compressed once it is complete. It keeps
its name then, with `.gz` after it.
"""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path
from typing import NamedTuple

GZIP = b"\x1f\x8b"
"""What a compressed file begins with."""
SUFFIX = ".gz"
LEVEL = 6
"""Of the compression: 9 takes three times as long, and saves one percent."""

_PIECE = 1 << 16


def stored(path: Path) -> Path:
    """The file that a recording is in: the one of its name, or the compressed one."""
    packed = Path(f"{path}{SUFFIX}")
    return packed if not path.exists() and packed.exists() else path


class Stored(NamedTuple):
    """What is in a recording's file.

    Attributes:
        data: As it was written; of a damaged compressed file, what could be had.
        whole: The compression, if any, is not damaged.
    """

    data: bytes
    whole: bool


def read_stored(path: Path) -> Stored:
    """A recording's bytes, whichever way they are kept.

    Raises:
        OSError: There is no such file, or it cannot be read.
    """
    data = stored(path).read_bytes()
    return _unpacked(data) if data.startswith(GZIP) else Stored(data, True)


def first_line(path: Path, most: int = 1_000_000) -> bytes:
    """A recording's first line, up to so many bytes of it.

    Raises:
        OSError: There is no such file, or it cannot be read.
    """
    with stored(path).open("rb") as file:
        head = file.read(2)
        file.seek(0)
        if head != GZIP:
            return file.readline(most)
        try:
            with gzip.open(file) as text:
                return text.readline(most)
        except (EOFError, zlib.error):
            return b""


def packed(data: bytes) -> bytes:
    """Compressed; the same bytes every time."""
    return gzip.compress(data, compresslevel=LEVEL, mtime=0)


def _unpacked(data: bytes) -> Stored:
    """As much as can be had."""
    reader, found = zlib.decompressobj(wbits=31), []
    try:
        # In pieces: where one fails, those before it are there.
        while data and not reader.eof:
            found.append(reader.decompress(data, _PIECE))
            data = reader.unconsumed_tail
    except zlib.error:
        return Stored(b"".join(found), False)
    return Stored(b"".join(found), reader.eof)
