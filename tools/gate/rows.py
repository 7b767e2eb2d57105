"""Rows of the gate, each with a group, a name and values, and the comparison of two sets of
rows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from sandbox.recording.versions import versions

Observed = dict[str, Any]
"""Values of one row, of JSON types."""

Rows = dict[str, dict[str, Observed]]
"""Group -> name -> values."""

MACHINE_BOUND = frozenset({"hash", "time_s"})
"""Keys that are equal only on machines with the same fingerprint."""

CHAOTIC = ("gather", "soft")
"""Words in the names of rows whose outcomes depend on the machine's fingerprint. In `gather` many
boxes touch, and soft servos let small differences grow."""

DIGITS = 16
"""Number of digits of a state hash that are compared."""


def fingerprint() -> str:
    """Fingerprint of this machine. Machines with the same fingerprint compute the same states."""
    return versions()["fingerprint"]


def outcome(result: Mapping[str, Any]) -> Observed:
    """The values of a trial's result that are compared."""
    return {
        "hash": result["state_hash"][:DIGITS],
        "status": str(result["status"]),
        "success": result["success"],
        "time_s": result["time_s"],
    }


@dataclass(frozen=True)
class Difference:
    """A row that differs from that of the file.

    Attributes:
        group: Group of the row.
        name: Name of the row.
        before, now: Values that differ, of the file and of this checkout; None if one of them has
            no such row.
    """

    group: str
    name: str
    before: Observed | None
    now: Observed | None

    def __str__(self) -> str:
        return f"{self.group}, {self.name}: was {_words(self.before)}, is {_words(self.now)}"


def differences(
    before: Rows, now: Rows, groups: Iterable[str], whole: bool, same_machine: bool
) -> list[Difference]:
    """Rows that differ from those of the file, and rows that ended with an error.

    Args:
        before: Rows of the file.
        now: Rows of this checkout.
        groups: Groups that were observed.
        whole: True if all rows of these groups were observed. A missing row then counts as a
            difference.
        same_machine: True if the fingerprints are equal. Otherwise hashes, times and the outcomes
            of chaotic rows are not compared.
    """
    found = []
    for group in groups:
        old, new = before.get(group, {}), now.get(group, {})
        for name in sorted({*old, *new} if whole else new):
            one, two = old.get(name), new.get(name)
            if one is None or two is None or "error" in two:
                found.append(Difference(group, name, one, two))
                continue
            if not same_machine and any(word in f"{group} {name}" for word in CHAOTIC):
                continue
            keys = [
                key
                for key in sorted({*one, *two})
                if one.get(key) != two.get(key) and (same_machine or key not in MACHINE_BOUND)
            ]
            if keys:
                found.append(
                    Difference(
                        group,
                        name,
                        {k: one.get(k) for k in keys},
                        {k: two.get(k) for k in keys},
                    )
                )
    return found


def _words(observed: Observed | None) -> str:
    if observed is None:
        return "absent"
    return " ".join(f"{key}={value}" for key, value in observed.items())
