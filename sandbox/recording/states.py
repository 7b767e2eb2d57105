"""Generations of simulated states: which of them a recording was made with, and what plays it.

With equal `STATES` and models a recording replays to the bit where the fingerprint is equal. With
other `STATES` it cannot be played again, only read: its recorded poses, its score, its header.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from models.errors import RecordingError
from sandbox.recording.recording import Recording
from sandbox.recording.versions import versions

STATES = 2
"""Generation of simulated states. Every commit that changes state hashes raises it, and updates
`tools/gate.json`. A header without it has the first."""


class OtherStatesError(RecordingError):
    """A recording was made with other `STATES`, so it cannot be played again."""


def states_of(header: Mapping[str, Any]) -> int:
    """The generation of states that a recording's header names.

    Args:
        header: Header of the recording, checked (see `sandbox.recording.recording.read_header`).
    """
    return int(header.get("states", 1))


def made_with(header: Mapping[str, Any]) -> str:
    """States, version and commit of the program that made a recording, in words."""
    there = header.get("versions")
    return _program(states_of(header), there if isinstance(there, dict) else {})


def this_program() -> str:
    """States, version and commit of this program, in words."""
    return _program(STATES, versions())


def other_states(header: Mapping[str, Any]) -> str:
    """A line on a recording of other `STATES`; empty for one of these."""
    if states_of(header) == STATES:
        return ""
    return f"made with {made_with(header)}; this program has states {STATES}"


def check_states(recording: Recording) -> None:
    """Refuses to play a recording of other `STATES` again.

    Raises:
        OtherStatesError: It was made with other states.
    """
    if states_of(recording.header) != STATES:
        raise OtherStatesError(
            "it cannot be played again",
            where=str(recording.path),
            got=f"made with {made_with(recording.header)}",
            expected=f"states {STATES}, which this program has",
            remedy="Play it with that version; `sandbox export` writes its recorded poses here, "
            "too, and its result can be read",
        )


def _program(states: int, known: Mapping[str, Any]) -> str:
    """A generation of states, with the version and the commit that had it."""
    commit = f", commit {known['commit']}" if known.get("commit") else ""
    return f"states {states} (hand-sandbox {known.get('hand-sandbox', 'unknown')}{commit})"
