"""Plays a recording again and compares the states, hash by hash."""

from __future__ import annotations

from dataclasses import dataclass, replace

from models.errors import DivergenceError, RecordingError
from sandbox.assembly import build, digests
from sandbox.devices.recorded import RecordedDevice
from sandbox.headless import ViewMaker, no_views
from sandbox.recorded_task import recorded_task
from sandbox.recording import Recording
from sandbox.session import Session
from sandbox.settings import RunSettings
from sandbox.versions import versions


@dataclass(frozen=True)
class Verification:
    """How a replay went.

    Attributes:
        compared: Hashes that were compared.
        first_difference: Physics step of the first hash that differs; None when all agree.
        complete: The recording's end was reached and its last hash compared.
        same_machine: Versions and kind of processor are the recording's, so that equality is owed.
    """

    compared: int
    first_difference: int | None
    complete: bool
    same_machine: bool

    @property
    def exact(self) -> bool:
        """Whether every state was the recorded one."""
        return self.first_difference is None and self.compared > 0


def settings_of(recording: Recording) -> RunSettings:
    """The settings a recording was made with.

    Raises:
        RecordingError: What it was made with has learned something else here.
    """
    settings = RunSettings.from_json(recording.header["settings"])
    settings = replace(settings, task=recorded_task(recording.header, str(recording.path)))
    here, there = digests(settings), recording.header.get("digests")
    if here != there:
        raise RecordingError(
            "it was made with another encoder, or other labels, of the same name",
            where=str(recording.path),
            got=here,
            expected=str(there),
            remedy="Use the version of the sandbox that its header names",
        )
    return settings


def replay(recording: Recording, make_views: ViewMaker = no_views) -> tuple[Session, Verification]:
    """Plays a recording to its end, comparing hashes on the way."""
    settings = settings_of(recording)
    session = build(settings, lambda task, surface: RecordedDevice(recording))
    views = make_views(session)
    expected = {i.step: i.state_hash for inputs in recording.inputs.values() for i in inputs}
    if recording.end:
        expected[recording.end["step"]] = recording.end["hash"]
    compared, difference = 0, None
    while True:
        if session.step in expected:
            compared += 1
            if expected[session.step] != session.state_hash and difference is None:
                difference = session.step
        if session.over:
            break
        try:
            snapshot = session.advance()
        except DivergenceError:
            break
        for view in views:
            view(snapshot)
    complete = recording.end is not None and session.step == recording.end["step"]
    same = recording.header["versions"].get("fingerprint") == versions()["fingerprint"]
    return session, Verification(compared, difference, complete, same)
