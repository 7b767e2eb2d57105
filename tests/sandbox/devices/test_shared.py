"""One device for two hands: each hand gets its own frames, and the tray is played by both."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from encoders.air.camera import Camera
from models.errors import InputError
from models.frames import HandFrame
from models.surface import Surface
from sandbox.devices.device import AnyDevice, HandDevice, Sees
from sandbox.devices.simulated.in_air import SimulatedHeadset
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.devices.wrappers.shared import SharedDevice, SharedPart, Split
from sandbox.server.protocol import PageHands, PageScreen
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import DeviceMakers, build, device_makers, shared_makers
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.task import Task
from tasks.user import UserConfiguration
from tests.encoders.air.seen_hands import film_file

TASK = "carry-together"
SCREEN = PageScreen(100.0, 1000.0, 500.0, True)


class PeopleInHeadset(HandDevice):
    """A headset whose page sends the right and the left hand of two simulated people."""

    takes_snapshots = True

    def __init__(self, task: Task, settings: Settings) -> None:
        self.people = [
            SimulatedHeadset(task, UserConfiguration(), settings.seed, hand.person, i)
            for i, hand in enumerate(settings.hands)
        ]
        self.headset, self.sent = HeadsetDevice(), 0

    def show(self, snapshot: Snapshot) -> None:
        for person in self.people:
            person.show(snapshot)

    def poll(self, now: float) -> Sequence[HandFrame]:
        self.sent += 1
        hands = [person.joints(now) for person in self.people]
        self.headset.receive(PageHands(self.sent, 0.0, hands), SCREEN)
        return self.headset.poll(now)


def screen(folder: Path) -> tuple[Settings, DeviceMakers]:
    chosen = trial_settings(TrialOptions(task=TASK, one_surface=True, surface="15.5x5.8in", seed=3))
    return chosen, device_makers(chosen)


def leap(folder: Path) -> tuple[Settings, DeviceMakers]:
    chosen = trial_settings(TrialOptions(task=TASK, device="leap-simulated", seed=2))
    return chosen, device_makers(chosen)


def headset(folder: Path) -> tuple[Settings, DeviceMakers]:
    chosen = trial_settings(TrialOptions(task=TASK, device="webxr", seed=2))

    def people(task: Task, surface: Surface) -> Any:
        return PeopleInHeadset(task, chosen)

    return chosen, shared_makers(people, chosen, Sees.HEADSET)


def camera_file(folder: Path) -> Path:
    """Landmarks of both hands before a camera."""
    return film_file(folder / "hands.jsonl", Camera(70.0, (0.0, 0.45, 0.12)), both=True)


def camera(folder: Path) -> tuple[Settings, DeviceMakers]:
    chosen = trial_settings(TrialOptions(task=TASK, device=str(camera_file(folder))))
    return chosen, device_makers(chosen)


OPENED: list[Callable[[Path], tuple[Settings, DeviceMakers]]] = [screen, leap, headset, camera]


@pytest.mark.parametrize("opened", OPENED, ids=lambda opened: opened.__name__)
def test_the_tray_is_played_by_two_hands_with_one_device(
    opened: Callable[[Path], tuple[Settings, DeviceMakers]], tmp_path: Path
) -> None:
    chosen, makers = opened(tmp_path)
    session = build(chosen, makers)
    first, second = (rig.device for rig in session.rigs)
    assert [hand.side for hand in chosen.hands] == ["right", "left"]
    assert isinstance(first, SharedPart) and first.device is second.parts[0]
    assert not second.takes_snapshots and not second.address
    right, left = played(session, 2.0)
    assert right > 0.01 and left < -0.01, "each hand is over its own half of the table"


@pytest.mark.parametrize("device", ["leap-simulated", "webxr", "camera"])
def test_two_right_hands_before_one_device_are_refused_and_so_is_noise(
    device: str, tmp_path: Path
) -> None:
    device = str(camera_file(tmp_path)) if device == "camera" else device
    with pytest.raises(InputError, match="a right and a left hand"):
        trial_settings(TrialOptions(task=TASK, device=device, second_hand="right"))
    with pytest.raises(InputError, match="hands in the air cannot"):
        trial_settings(TrialOptions(device=device, vary="noise=0.001"))


def played(session: Session, seconds: float) -> tuple[float, float]:
    """Plays a session for a while; m, where each hand's fingertips are at the end, to the right."""
    looking = [rig.device for rig in session.rigs if rig.device.takes_snapshots]
    snapshot = session.snapshot()
    while session.time < seconds and not session.over:
        snapshot = session.advance()
        for device in looking:
            device.show(snapshot)
    session.close()
    right, left = (float(hand.tips[:, 0].mean()) for hand in snapshot.hands)
    return right, left


class Counted(HandDevice):
    """A device that has one frame at every poll, and counts the polls."""

    polls = 0
    address = "here:1"
    notices = ("look here",)

    def poll(self, now: float) -> Sequence[HandFrame]:
        self.polls += 1
        return [] if self.finished else [HandFrame(now)]


def test_a_shared_device_is_polled_once_at_a_time_and_says_everything_once() -> None:
    device = Counted()
    first, second = SharedDevice(device, Split()).parts
    for now in (0.1, 0.2):
        (mine,), (other,) = first.poll(now), second.poll(now)
        assert mine is other
    assert device.polls == 2 and not first.poll(0.2)
    parts: tuple[AnyDevice, AnyDevice] = (first, second)
    assert [part.notices for part in parts] == [("look here",), ()]
    assert [part.address for part in parts] == ["here:1", ""]
    first.close()
    assert device.finished and first.finished and second.finished and not second.poll(0.3)
