"""The hash chain of a journal: each record carries the digest of the one before, and its own.

A record's line ends with `"previous":"...","digest":"..."}`. `digest` is BLAKE2b (32 bytes, hex) of
the line's bytes without the field `digest` itself; `previous` is the digest of the line before, and
empty in the first line. A change of one bit is therefore found in its line, and a record that is
missing, new or moved at the next one.

A withdrawal must delete what a record says. It replaces the record by another one that keeps
`previous` and `digest`, so that the chain goes on, and appends a record of kind `withdrawal` with
the digest of what is there now. Anything else under a digest that is not its own is a change.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from hashlib import blake2b
from typing import Any

Record = dict[str, Any]

SIZE = 32
"""Bytes of a digest."""
PREVIOUS, DIGEST = "previous", "digest"
"""Fields of every record: the digest of the record before, and its own."""
WITHDRAWAL = "withdrawal"
"""Kind of the record that names the replaced records, with the digests of what replaced them."""
REPLACED = "replaced"
"""Field of a `WITHDRAWAL`: digest of the present content, by number of the record."""

_TAIL = len(f',"{DIGEST}":""}}') + 2 * SIZE
"""Bytes of a line from the comma before its digest on."""


def digest_of(data: bytes) -> str:
    """Digest of bytes: BLAKE2b, hex."""
    return blake2b(data, digest_size=SIZE).hexdigest()


def chained(record: Mapping[str, Any], before: str) -> tuple[Record, bytes]:
    """Puts a record behind another one.

    Args:
        record: The record; a place in another chain is left out.
        before: Digest of the record before; empty for the first one.

    Returns:
        The record with both digests, and its line.
    """
    body = {**without_chain(record), PREVIOUS: before}
    text = _json(body)
    digest = digest_of(text)
    return {**body, DIGEST: digest}, text[:-1] + f',"{DIGEST}":"{digest}"}}\n'.encode()


def without_chain(record: Mapping[str, Any]) -> Record:
    """A record without its place in a chain."""
    return {name: value for name, value in record.items() if name not in (PREVIOUS, DIGEST)}


def record_line(record: Mapping[str, Any]) -> bytes:
    """Line of a record that is in a chain already."""
    return _json(record) + b"\n"


def replaced(record: Mapping[str, Any], original: Mapping[str, Any]) -> tuple[bytes, str]:
    """Line of a record that takes the place of another one, and digest of its content."""
    text = _json({**without_chain(record), PREVIOUS: original[PREVIOUS]})
    return text[:-1] + f',"{DIGEST}":"{original[DIGEST]}"}}\n'.encode(), digest_of(text)


class Chain:
    """Checks the records of a journal in order.

    Attributes:
        head: Digest of the last record; empty before the first one.
    """

    def __init__(self) -> None:
        self.head = ""
        self._other: dict[int, tuple[int, str]] = {}
        self._replaced: dict[int, str] = {}

    def take(self, line: bytes, record: Record, number: int) -> str:
        """Takes the next record.

        Args:
            line: Its line without the line break.
            record: The record.
            number: Number of the line, from 1.

        Returns:
            What is wrong with its place; empty if nothing is. See `changed` for its content.
        """
        own = digest_of(line[:-_TAIL] + b"}")
        if line[-_TAIL:] != f',"{DIGEST}":"{record[DIGEST]}"}}'.encode():
            own = ""
        if own != record[DIGEST]:
            self._other[number] = (record["n"], own)
        if record["kind"] == WITHDRAWAL:
            self._replaced |= {int(n): digest for n, digest in record[REPLACED].items()}
        follows = record[PREVIOUS] == self.head
        self.head = record[DIGEST]
        return "" if follows else "it does not follow the record before it"

    def changed(self) -> list[int]:
        """Numbers of the lines whose content is not that of their digest, from 1."""
        return [
            number
            for number, (n, own) in self._other.items()
            if not own or self._replaced.get(n) != own
        ]

    def replaced(self) -> int:
        """Number of records that a withdrawal has replaced."""
        return len(self._other) - len(self.changed())


def chained_bytes(records: Iterable[Mapping[str, Any]]) -> bytes:
    """Lines of a new journal with the given records, in a chain of their own."""
    before, lines = "", []
    for record in records:
        linked, line = chained(record, before)
        before = linked[DIGEST]
        lines.append(line)
    return b"".join(lines)


def _json(record: Mapping[str, Any]) -> bytes:
    return json.dumps(record, separators=(",", ":"), ensure_ascii=False).encode()
