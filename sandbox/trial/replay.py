"""Replays a recording and compares the states, hash by hash."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from models.errors import InputError, RecordingError
from sandbox.recording.agreement import Agreement, PoseComparison
from sandbox.recording.recorded_device import RecordedDevice
from sandbox.recording.recorded_task import recorded_task, task_change
from sandbox.recording.recording import Recording
from sandbox.recording.states import check_states
from sandbox.recording.versions import decisive_differences
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import build, digests
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers
from sandbox.trial.driver import Trial, ViewMaker, no_views
from sandbox.trial.recorded_poses import RecordedPoses
from sandbox.trial.recorded_settings import recorded_encoder, recorded_settings
from sandbox.trial.settings import Settings


@dataclass(frozen=True)
class Verification:
    """Result of a replay.

    Attributes:
        compared: Number of hashes that were compared.
        first_difference: Physics step of the first hash that differs; None if all agree.
        complete: The recording's end was reached and its last hash compared.
        differs_in: What states depend on and is not the recording's, in words; without any, equal
            states are promised.
        shown_recorded: Views were shown the recorded poses, not those simulated here.
        diverged: Reason of a divergence in the replay; empty without one.
        agreement: The second verdict, where states differ and the recording has poses.
        task_change: What has changed in the recording's own task since it was recorded, and what
            to do, in a line; empty where nothing has, and where the recording does not tell.
    """

    compared: int
    first_difference: int | None
    complete: bool
    differs_in: tuple[str, ...]
    shown_recorded: bool = False
    diverged: str = ""
    agreement: Agreement | None = None
    task_change: str = ""

    @property
    def same_machine(self) -> bool:
        """True if equal states are promised."""
        return not self.differs_in

    @property
    def exact(self) -> bool:
        """True if every compared state was the recorded one."""
        return self.first_difference is None and self.compared > 0


def settings_of(recording: Recording) -> Settings:
    """The settings that a recording was made with, to play it again.

    Raises:
        OtherStatesError: It was made with other `STATES`.
        RecordingError: The task or the encoder is not on this machine, or the encoder or the labels
            of the same name were trained otherwise.
    """
    check_states(recording)
    header, where = recording.header, str(recording.path)
    settings = recorded_settings(header).changed(
        task=recorded_task(header, where), encoder=recorded_encoder(header, where)
    )
    here, there = digests(settings), header.get("digests")
    if here != there:
        before = there if isinstance(there, dict) else {}
        changed = [name for name in here if here[name] != before.get(name)] or list(before)
        remedy = "Use the version of the sandbox that its header names"
        if "encoder" in changed and "encoder_from" in header:
            remedy = (
                "Put the encoder's file back as it was; its libraries or the machine may differ, "
                "too. For replays on other machines, train it once with `sandbox train --encoder` "
                "into a model file"
            )
        elif "encoder" in changed and Path(settings.pipeline.encoder).is_file():
            remedy = "Put the model file, or the code of its encoder, back as it was"
        raise RecordingError(
            f"its {' and '.join(changed) or 'encoder'} of the same name changed since it was made",
            where=where,
            got=", ".join(str(here.get(name)) for name in changed),
            expected=", ".join(str(before.get(name)) for name in changed) or str(there),
            remedy=remedy,
        )
    return settings


def versions_of(recording: Recording) -> dict[str, Any]:
    """The versions that a recording was made with.

    Raises:
        RecordingError: Its header lacks them.
    """
    there = recording.header.get("versions")
    if not isinstance(there, dict):
        raise RecordingError(
            "its header does not say which versions it was made with",
            where=str(recording.path),
            got="nothing" if there is None else repr(there)[:80],
            expected="versions, as `sandbox run --record` writes them",
            remedy="Record it again, or take an undamaged copy",
        )
    return there


def recorded_hands(recording: Recording, hands: int) -> DeviceMakers:
    """Makers of devices that play every hand of a recording."""

    def plays(hand: int) -> DeviceMaker:
        return lambda task, surface: RecordedDevice(recording, hand)

    return tuple(plays(hand) for hand in range(hands))


def replay(recording: Recording, make_views: ViewMaker = no_views) -> tuple[Session, Verification]:
    """Replays a recording to its end and compares the hashes.

    Equal states are promised where nothing that states depend on differs. Elsewhere the recording
    is simulated and compared too, but views are shown the recorded poses.

    Raises:
        RecordingError: See `settings_of`; or its own task has changed, and cannot be played any
            more.
    """
    settings = settings_of(recording)
    versions_of(recording)
    changed = task_change(
        recording.header, settings.task, settings.seed, settings.surface.rectangle
    )
    try:
        session = build(settings, recorded_hands(recording, len(settings.hands)), may_overlap=True)
    except InputError as error:
        if not changed:
            raise
        # Only the kind of failure: what this says goes into tables, which are shared.
        raise RecordingError(changed, where=str(recording.path), got=error.what) from error
    differs_in = tuple(decisive_differences(versions_of(recording)))
    kept = bool(recording.track.qpos)
    poses = RecordedPoses(session, recording) if kept and differs_in else None
    comparison = PoseComparison(session, recording) if kept else None
    views = make_views(session)
    compared, difference = 0, None

    def show(snapshot: Snapshot) -> None:
        shown = poses.show(snapshot, scored=difference is None) if poses else snapshot
        for view in views:
            view(shown)

    trial = Trial(session, [show])
    while True:
        if session.step in recording.hashes:
            compared += 1
            if recording.hashes[session.step] != session.state_hash and difference is None:
                difference = session.step
        if comparison and difference is not None:
            comparison.look()
        # The score may end earlier here than in the recording, whose poses are shown to their end.
        if session.diverged or (session.over and not (poses and session.step < poses.last)):
            break
        trial.step()
    complete = recording.end is not None and session.step == recording.end["step"]
    return session, Verification(
        compared,
        difference,
        complete,
        differs_in,
        poses is not None,
        session.diverged,
        comparison.agreement() if comparison and difference is not None else None,
        changed,
    )
