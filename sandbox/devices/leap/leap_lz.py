"""Decoder of LZString's base64 form, the compression of LeapJS recordings (`.json.lz`).

LZString is a dictionary coder after LZ78 on 16-bit characters; codes grow from 3 bits, least
significant bit first. Source: the format of the npm package lz-string, which wrote the recordings.
"""

from __future__ import annotations

from models.errors import RecordingError

MOST_CHARACTERS = 1 << 28
"""Largest length of a decoded text; otherwise a small file could use any amount of memory."""

_ALPHABET = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
_BITS = {ord(c): f"{i:06b}" for i, c in enumerate(_ALPHABET)} | {ord("="): "000000"}
_BYTE, _WORD, _END = 0, 1, 2
"""Codes for a new 8-bit character, a new 16-bit character, and the end."""


def is_json_in_base64(start: bytes) -> bool:
    """True if a text begins as an object or list of JSON does in LZString's base64.

    It begins with the code of a new character (2 bits) and the character (8 bits, least significant
    first): `{` becomes N4 to N7, `[` becomes No to Nr.
    """
    known = set(_ALPHABET.encode()) | set(b"=\r\n")
    return (
        start[:1] == b"N" and start[1:2] in b"4567opqr" and len(start) > 1 and set(start) <= known
    )


def decompress_base64(text: str, limit: int = MOST_CHARACTERS) -> str:
    """The text that LZString's compressToBase64 was given.

    Raises:
        RecordingError: The text is not LZString's base64, is cut short, or is larger than `limit`.
    """
    text = "".join(text.split())
    if not text or not text.isascii() or any(ord(c) not in _BITS for c in set(text)):
        raise RecordingError("the text is not LZString's base64")
    bits = text.translate(_BITS)
    known: list[str] = ["", "", ""]
    position, width, size = 0, 2, 0
    last = ""
    parts: list[str] = []
    while True:
        code, position = _take(bits, position, width)
        if code == _END:
            return "".join(parts)
        fresh = code in (_BYTE, _WORD)
        if fresh:
            character, position = _take(bits, position, 8 if code == _BYTE else 16)
            known.append(chr(character))
            code = len(known) - 1
            width = _width(known, bool(last))
        if code < len(known):
            entry = known[code]
        elif code == len(known) and last:
            entry = last + last[0]
        else:
            raise RecordingError("the LZString text is damaged", got=f"code {code}")
        parts.append(entry)
        size += len(entry)
        if size > limit:
            raise RecordingError("the LZString text is too large", expected=f"up to {limit}")
        if last:
            known.append(last + entry[0])
        last = entry
        width = _width(known, True)


def _width(known: list[str], started: bool) -> int:
    """Number of bits of the next code, enough for all known texts and the next one."""
    return len(known).bit_length() if started else 2


def _take(bits: str, position: int, width: int) -> tuple[int, int]:
    end = position + width
    if end > len(bits):
        raise RecordingError("the LZString text is cut short")
    return int(bits[position:end][::-1], 2), end
