"""Rows of the gate: values under a group and a name, and the comparison of two sets of rows."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from sandbox.recording.versions import versions

Observed = dict[str, Any]
"""Plain values of one row, as JSON holds them."""

Rows = dict[str, dict[str, Observed]]
"""Group -> name -> values."""

MACHINE_BOUND = frozenset({"hash", "time_s"})
"""Keys that are equal only on machines with the same fingerprint."""

CHAOTIC = ("gather", "soft")
"""Words in the names of rows whose outcomes differ on a machine with another fingerprint: in
`gather` many boxes touch, and soft servos let small differences grow."""

DIGITS = 16
"""Digits of a state hash that are compared."""


def fingerprint() -> str:
    """Fingerprint of this machine: machines that share it compute the same states."""
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
    """A row that differs from the file's.

    Attributes:
        group: Group of the row.
        name: Name of the row.
        before, now: Values of the keys that differ; None where there is no such row.
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
    """Rows that differ from the file's, and rows that ended in an error.

    Args:
        before: Rows of the file.
        now: Rows of this checkout.
        groups: Groups that were observed.
        whole: True where all rows of these groups were observed, so that a missing one differs.
        same_machine: True where the fingerprints are equal; otherwise hashes and times are not
            compared, nor the outcomes of chaotic rows.
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
