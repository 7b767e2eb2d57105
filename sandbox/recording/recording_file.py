"""Files of recordings, plain or compressed; readers need not distinguish.

A recording is written uncompressed, line by line, and may be compressed once it is complete. The
compressed file has the same name with `.gz` appended.
"""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path
from typing import NamedTuple

GZIP = b"\x1f\x8b"
"""First bytes of a compressed file."""
SUFFIX = ".gz"
LEVEL = 6
"""Compression level; level 9 takes three times as long, and saves one percent."""

_PIECE = 1 << 16


def stored(path: Path) -> Path:
    """The file that holds a recording: the plain one, or the compressed one if only it exists."""
    packed = Path(f"{path}{SUFFIX}")
    return packed if not path.exists() and packed.exists() else path


class Stored(NamedTuple):
    """Contents of a recording's file.

    Attributes:
        data: Uncompressed bytes; of a damaged compressed file, those before the damage.
        whole: True unless the compressed data is damaged.
    """

    data: bytes
    whole: bool


def read_stored(path: Path) -> Stored:
    """Reads a recording's bytes, plain or compressed.

    Raises:
        OSError: The file does not exist or cannot be read.
    """
    data = stored(path).read_bytes()
    return _unpacked(data) if data.startswith(GZIP) else Stored(data, True)


def first_line(path: Path, most: int = 1_000_000) -> bytes:
    """Reads a recording's first line, up to `most` bytes.

    Raises:
        OSError: The file does not exist or cannot be read.
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
    """The data compressed; equal data gives equal bytes."""
    return gzip.compress(data, compresslevel=LEVEL, mtime=0)


def _unpacked(data: bytes) -> Stored:
    """Decompresses data up to its end or the damage."""
    reader, pieces = zlib.decompressobj(wbits=31), []
    try:
        # In pieces, so that those before a damaged one are kept.
        while data and not reader.eof:
            pieces.append(reader.decompress(data, _PIECE))
            data = reader.unconsumed_tail
    except zlib.error:
        return Stored(b"".join(pieces), False)
    return Stored(b"".join(pieces), reader.eof)
