"""Studies before a camera: its consent, its page for the whole session, its recordings."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from encoders.air.camera import Camera
from models.errors import StudyError
from models.frames import LandmarkFrame
from sandbox.devices.webcam.landmarks import message_of
from sandbox.devices.webcam.webcam import CLOSED, WAITING
from sandbox.recording.recording import load_recording
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.run.run_device import SessionCamera
from sandbox.study.run.runner import SessionOutcome
from sandbox.study.run.simulated_study import simulate
from sandbox.trial.replay import replay
from tests.encoders.air.seen_hands import SIZE, held_up, seen
from tests.sandbox.study.run.study_before_camera import BEFORE_A_CAMERA, CameraSession
from tests.support.study_files import design, quiet


class Page(threading.Thread):
    """Stands for the camera's page: sends what a camera sees of a hand until it is sent away."""

    def __init__(self, address: str) -> None:
        super().__init__(daemon=True)
        self.bye = ""
        self._address = address.replace("http", "ws").replace("/?", "/landmarks?")
        self._origin = address.partition("/?")[0]

    def run(self) -> None:
        hand = seen(held_up(30.0), Camera())
        with (
            connect(self._address, additional_headers={"Origin": self._origin}) as socket,
            suppress(ConnectionClosed),
        ):
            self.wanted = json.loads(socket.recv())
            while not self.bye:
                now = time.monotonic()
                frame = LandmarkFrame(now, (hand,), SIZE, now)
                socket.send(json.dumps(message_of(frame)))
                with suppress(TimeoutError):
                    self.bye = json.loads(socket.recv(timeout=0.03))["why"]


class OnPage(CameraSession):
    """A session whose camera's page a client stands for.

    Attributes:
        pages: Pages that were opened.
    """

    def __init__(self, folder: Path) -> None:
        self.pages: list[Page] = []
        super().__init__(folder, Path("engine"))
        for page in self.pages:
            page.join(10.0)

    def open_page(self, address: str) -> None:
        self.pages.append(Page(address))
        self.pages[-1].start()


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> OnPage:
    return OnPage(tmp_path_factory.mktemp("webcam") / "study")


def test_one_page_is_the_camera_of_all_trials_and_goes_off_at_the_end(session: OnPage) -> None:
    assert session.outcome is SessionOutcome.COMPLETE
    (page,) = session.pages
    assert page.wanted["sides"] == ["right"]
    assert page.bye.startswith("The session is over: the camera is off.")


def test_recordings_hold_landmarks_and_no_pictures_and_replay_to_the_bit(session: OnPage) -> None:
    recordings = sorted((session.path / "trials").glob("*.jsonl*"))
    assert len(recordings) == 2
    for path in recordings:
        recording = load_recording(path)
        (hand,) = recording.header["settings"]["hands"]
        assert hand["in_air"]["camera"]["view"] == 70.0
        _, verdict = replay(recording)
        assert verdict.exact and verdict.complete
        frames = [line.frame for line in recording.inputs[0]]
        assert any(isinstance(f, LandmarkFrame) and f.hands for f in frames)


def test_simulated_participants_have_no_camera_and_that_is_one_line(tmp_path: Path) -> None:
    study = StudyFolder(tmp_path / "study", design(BEFORE_A_CAMERA), SIMULATED)
    with pytest.raises(StudyError, match="simulated participants have no camera"):
        simulate(study, 1, False, quiet)
    assert not study.participants()


@pytest.fixture
def opened() -> Iterator[tuple[SessionCamera, list[str]]]:
    said: list[str] = []
    with SessionCamera(Path("engine"), ("right",), False, said.append) as camera:
        yield camera, said


def test_a_page_that_is_closed_between_trials_is_told_and_waited_for(
    opened: tuple[SessionCamera, list[str]],
) -> None:
    camera, said = opened
    with ExitStack() as stack:
        stack.callback(camera.close)
        pages: list[Page] = []

        def poll() -> None:
            """Opens the page once its absence was told."""
            if said[-1] in (WAITING, CLOSED) and not (pages and pages[-1].is_alive()):
                pages.append(Page(said[0][said[0].index("http://") :]))
                pages[-1].start()

        camera.wait_until_on(poll)
        assert said[1:] == [WAITING]
        trial = camera.of_trial()
        pages[-1].bye = "closed by the person"
        pages[-1].join(10.0)
        trial.close()
        assert trial.finished and not trial.poll(0.0)
        camera.wait_until_on(poll)
        assert said[2:] == [CLOSED] and len(pages) == 2
