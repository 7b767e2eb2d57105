"""The hash chain of a session's record: each line carries a hash of itself and of the line before.

A line ends with `"hash":"..."}`. The hash is the BLAKE2b digest (32 bytes, in hex) of two parts:
first the hash of the line before (empty for the first line), then the line's bytes without the
field `hash`. So a changed bit is found in its line, and a missing, new or moved line is found at
the line after it. The record of a trial's end has the digest of the trial's recording, so the last
hash covers the whole session.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from hashlib import blake2b
from typing import Any

Record = dict[str, Any]

SIZE = 32
"""Bytes of a hash."""
HASH = "hash"
"""Name of the field with the hash of a record."""

_TAIL = len(f',"{HASH}":""}}') + 2 * SIZE
"""Number of bytes at the end of a line, from the comma before the field `hash`."""


def digest_of(data: bytes) -> str:
    """Digest of bytes: BLAKE2b, hex."""
    return blake2b(data, digest_size=SIZE).hexdigest()


def chained(record: Mapping[str, Any], before: str) -> tuple[Record, bytes]:
    """Adds a record to a chain.

    Args:
        record: The record; a field `hash` in it is ignored.
        before: Hash of the record before; empty for the first record.

    Returns:
        The record with its hash, and its line.
    """
    body = {name: value for name, value in record.items() if name != HASH}
    text = json.dumps(body, separators=(",", ":"), ensure_ascii=False).encode()
    own = digest_of(before.encode() + text)
    return {**body, HASH: own}, text[:-1] + f',"{HASH}":"{own}"}}\n'.encode()


def follows(line: bytes, own: str, before: str) -> bool:
    """True if a line has the right hash for its content and its place in the chain.

    Args:
        line: The line, without its line break.
        own: The hash in the line.
        before: Hash of the line before; empty for the first line.
    """
    ends = line[-_TAIL:] == f',"{HASH}":"{own}"}}'.encode()
    return ends and digest_of(before.encode() + line[:-_TAIL] + b"}") == own


def chained_bytes(records: Iterable[Mapping[str, Any]]) -> bytes:
    """Lines of some records, as a new hash chain."""
    before, lines = "", []
    for record in records:
        linked, line = chained(record, before)
        before = linked[HASH]
        lines.append(line)
    return b"".join(lines)
