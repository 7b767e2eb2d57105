"""Replays the recordings of releases, and gives the verdict that is promised."""

from __future__ import annotations

from dataclasses import dataclass

from models.errors import HandSandboxError
from sandbox.recording.recording import load_recording
from sandbox.recording.versions import decisive_differences
from sandbox.trial.replay import replay
from tools.release.released import Release, file_digest

OUTCOME_ALONE = ("task-gather", "other-servos")
"""Recordings of which another machine is promised the outcome, and no places. Twelve dice push each
other in the one, soft servos push soft things in the other, so that a rounded digit grows there
(docs/measured/other-machines.md)."""


@dataclass(frozen=True)
class Verdict:
    """What the replay of one recording gave.

    Attributes:
        name: Name of the recording.
        holds: The promise is kept.
        says: The verdict in words.
    """

    name: str
    holds: bool
    says: str


def verdict(release: Release, name: str) -> Verdict:
    """Replays a recording: to the bit where the fingerprint is equal, else the second verdict."""
    path, entry = release.path(name), release.recordings[name]
    if not path.is_file() or file_digest(path) != entry["sha256"]:
        return Verdict(name, False, "its file is missing, or not the one that was released")
    try:
        recording = load_recording(path)
        session, found = replay(recording)
        session.close()
    except HandSandboxError as error:
        return Verdict(name, False, str(error))
    if found.exact and found.complete:
        return Verdict(name, True, f"{found.compared} states equal to the bit")
    if found.same_machine:
        return Verdict(name, False, f"states differ from physics step {found.first_difference} on")
    agreed = found.agreement
    if agreed is None:
        return Verdict(name, False, "states differ, and no poses can be compared")
    distance = f"objects within {agreed.objects_mm:.2f} mm, hands within {agreed.hands_mm:.2f} mm"
    outcome = "same outcome" if agreed.same_outcome else "another outcome"
    holds = agreed.holds or (name in OUTCOME_ALONE and agreed.same_outcome is True)
    return Verdict(name, holds, f"another machine: {outcome}, {distance}")


def promised(release: Release) -> str:
    """Which verdict is promised here, in words."""
    differs = decisive_differences(release.versions)
    if not differs:
        return "to the bit"
    return f"by the second verdict, since this machine differs in {' and '.join(differs)}"
