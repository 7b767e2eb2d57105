"""Replays the recordings of releases, and gives the verdict that is promised."""

from __future__ import annotations

from dataclasses import dataclass

from models.errors import HandSandboxError
from sandbox.recording.recording import load_recording
from sandbox.recording.versions import decisive_differences
from sandbox.trial.replay import replay
from tools.release.released import Release, file_digest

NEAR = 0.9
"""Share of a release's recordings that are near enough for the second verdict on other machines:
loose things that push each other, as in `gather`, are not (docs/measured/other-machines.md)."""


@dataclass(frozen=True)
class Verdict:
    """What the replay of one recording gave.

    Attributes:
        name: Name of the recording.
        holds: What is promised of this recording by itself is kept.
        near: Its states are equal, or near enough for the second verdict.
        says: The verdict in words.
    """

    name: str
    holds: bool
    near: bool
    says: str


def verdict(release: Release, name: str) -> Verdict:
    """Replays a recording: to the bit where the fingerprint is equal, else to the same outcome."""
    path, entry = release.path(name), release.recordings[name]
    if not path.is_file() or file_digest(path) != entry["sha256"]:
        return Verdict(name, False, False, "its file is missing, or not the one that was released")
    try:
        recording = load_recording(path)
        session, found = replay(recording)
        session.close()
    except HandSandboxError as error:
        return Verdict(name, False, False, str(error))
    if found.exact and found.complete:
        return Verdict(name, True, True, f"{found.compared} states equal to the bit")
    if found.same_machine:
        says = f"states differ from physics step {found.first_difference} on"
        return Verdict(name, False, False, says)
    agreed = found.agreement
    if agreed is None:
        return Verdict(name, False, False, "states differ, and no poses can be compared")
    distance = f"objects within {agreed.objects_mm:.2f} mm, hands within {agreed.hands_mm:.2f} mm"
    outcome = "same outcome" if agreed.same_outcome else "another outcome"
    # Without a recorded end, only places can tell.
    holds = agreed.holds or agreed.same_outcome is True
    return Verdict(name, holds, agreed.holds, f"another machine: {outcome}, {distance}")


def promised(release: Release) -> str:
    """Which verdict is promised here, in words."""
    differs = decisive_differences(release.versions)
    if not differs:
        return "to the bit"
    return f"to the same outcome, since this machine differs in {' and '.join(differs)}"
