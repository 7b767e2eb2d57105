"""Reads whole text files of other programs, or refuses them with one clear error."""

from __future__ import annotations

import gzip
import math
import zlib
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from models.errors import MotionError
from models.reader_report import ReaderReport

LARGEST = 512 * 2**20
"""Largest size in bytes. A day of motion capture is smaller, a decompression bomb is larger."""
MOST = 1e15
"""Largest length or angle in any unit. Sines of larger angles have no correct digits, and squares
of much larger lengths overflow."""


def read_lines(path: Path, what: str, report: ReaderReport) -> list[str]:
    """Reads the lines of a text file, plain or packed with gzip (recognised by content).

    Numbers and key words are ASCII in all formats; only names can contain other bytes. A file that
    is not UTF-8 or UTF-16 is read as Shift-JIS or Latin-1.

    Args:
        path: The file.
        what: The expected kind of file, for messages: "a BVH file".
        report: Receives the encoding of the text if it is not UTF-8.

    Raises:
        MotionError: The file is missing, damaged, too large, or not text.
    """
    where = str(path)
    try:
        with path.open("rb") as file:
            packed = file.read(2) == b"\x1f\x8b"
        with gzip.open(path, "rb") if packed else path.open("rb") as file:
            data = file.read(LARGEST + 1)
    except FileNotFoundError:
        raise MotionError("no such file", where=where) from None
    except (EOFError, zlib.error, gzip.BadGzipFile) as error:
        raise MotionError("the packed file is damaged", where=where, got=str(error)) from None
    except OSError as error:
        raise MotionError("the file cannot be read", where=where, got=error.strerror) from None
    if len(data) > LARGEST:
        raise MotionError(
            "the file is too large", where=where, expected=f"at most {LARGEST:,} bytes"
        )
    if not data.strip():
        raise MotionError("the file is empty", where=where, expected=what)
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        # Spreadsheets and editors call UTF-16 "Unicode".
        data = data.decode("utf-16", errors="replace").encode()
    if b"\0" in data:
        raise MotionError("this is not text", where=where, expected=what)
    text = decoded(data, report)
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def decoded(data: bytes, report: ReaderReport) -> str:
    """The text of a file; reports its encoding if it is not UTF-8."""
    # Latin-1 is tried last, since it can decode any bytes. It has no letters at 0x80 to 0x9F, where
    # most characters of Shift-JIS begin.
    encodings = ["utf-8-sig", "latin-1"]
    if any(0x80 <= byte < 0xA0 for byte in set(data)):
        encodings.insert(1, "cp932")
    for encoding in encodings:
        with suppress(UnicodeDecodeError):
            text = data.decode(encoding)
            break
    if encoding != "utf-8-sig":
        name = "Shift-JIS" if encoding == "cp932" else "Latin-1"
        report.assume(f"the text is not UTF-8; names are read as {name}")
    return text


def numbers(tokens: Sequence[str], count: int, where: str) -> list[float]:
    """Parses words as finite numbers.

    Raises:
        MotionError: There are more or fewer words than `count`, or one is not a finite number.
    """
    if len(tokens) != count:
        raise MotionError(
            "wrong number of values", where=where, got=len(tokens), expected=str(count)
        )
    values = []
    for token in tokens:
        try:
            value = float(token)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise MotionError(
                "not a finite number", where=where, got=token[:40], expected="a number"
            )
        if abs(value) > MOST:
            raise MotionError(
                "the number is too large",
                where=where,
                got=token[:40],
                expected=f"up to {MOST:g}",
            )
        values.append(value)
    return values
