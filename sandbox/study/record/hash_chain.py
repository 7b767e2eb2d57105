"""The hash chain of a session's record: each line carries a hash of itself and of the line before.

A line ends with `"hash":"..."}`. The hash is BLAKE2b (32 bytes, hex) of the hash of the line before
(empty for the first one), followed by the line's bytes without the field `hash`. A change of one
bit is therefore found in its line, and a line that is missing, new or moved at the next one. Since
the end of a trial names the digest of its recording, the last hash stands for everything that the
person did.
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
"""Field of every record: the hash of its line and of the line before."""

_TAIL = len(f',"{HASH}":""}}') + 2 * SIZE
"""Bytes of a line from the comma before its hash on."""


def digest_of(data: bytes) -> str:
    """Digest of bytes: BLAKE2b, hex."""
    return blake2b(data, digest_size=SIZE).hexdigest()


def chained(record: Mapping[str, Any], before: str) -> tuple[Record, bytes]:
    """Puts a record behind another one.

    Args:
        record: The record; a hash that it has is left out.
        before: Hash of the record before; empty for the first one.

    Returns:
        The record with its hash, and its line.
    """
    body = {name: value for name, value in record.items() if name != HASH}
    text = json.dumps(body, separators=(",", ":"), ensure_ascii=False).encode()
    own = digest_of(before.encode() + text)
    return {**body, HASH: own}, text[:-1] + f',"{HASH}":"{own}"}}\n'.encode()


def follows(line: bytes, own: str, before: str) -> bool:
    """True if a line, without its line break, has the hash of its content behind another one.

    Args:
        line: The line.
        own: The hash that it names.
        before: Hash of the line before; empty for the first one.
    """
    ends = line[-_TAIL:] == f',"{HASH}":"{own}"}}'.encode()
    return ends and digest_of(before.encode() + line[:-_TAIL] + b"}") == own


def chained_bytes(records: Iterable[Mapping[str, Any]]) -> bytes:
    """Lines of a new record of a session, in a chain of their own."""
    before, lines = "", []
    for record in records:
        linked, line = chained(record, before)
        before = linked[HASH]
        lines.append(line)
    return b"".join(lines)
