"""The settings and the program that the results of a regression run follow from."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

ENCODER = "encoder"
"""Option of a trial that names the encoder."""


@dataclass(frozen=True)
class Origin:
    """What the trials of a run follow from, beside tasks and seeds; JSON values.

    Attributes:
        given: Options of `sandbox run` that the user gave; an encoder of one's own is named by its
            digest. Results compare only where these are equal.
        program: The program that ran: `states` (see `sandbox.recording.versions`), `version`,
            from a checkout `commit`, and `models`, the digests of encoder and labels.
        settings: All settings of a trial, but for task, seed and what follows from the task, so
            that a changed default is named; empty in a baseline that does not have them.
    """

    given: Mapping[str, Any]
    program: Mapping[str, Any]
    settings: Mapping[str, Any] = field(default_factory=dict)

    @property
    def decides_states(self) -> tuple[Any, Any]:
        """The parts of the program that states follow from."""
        return self.program.get("states"), self.program.get("models")

    def __str__(self) -> str:
        """The program in words, as `states 2 (hand-sandbox 0.2.0, commit abc1234)`."""
        at = self.program.get("commit")
        version = self.program.get("version", "unknown") + (f", commit {at}" if at else "")
        return f"states {self.program.get('states')} (hand-sandbox {version})"


def flat(values: Mapping[str, Any]) -> dict[str, Any]:
    """Nested values by dotted name, as JSON reads them back."""

    def walk(prefix: str, value: Any) -> Iterator[tuple[str, Any]]:
        if isinstance(value, dict):
            for name, inner in value.items():
                yield from walk(f"{prefix}.{name}" if prefix else name, inner)
        else:
            yield prefix, value

    return dict(walk("", json.loads(json.dumps(values))))
