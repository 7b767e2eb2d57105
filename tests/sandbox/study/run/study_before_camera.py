"""What tests of studies before a camera share: a design, and a session that it plays."""

from __future__ import annotations

from pathlib import Path

from sandbox.devices.registry import DeviceSettings
from sandbox.study.record.folder import PILOT, StudyFolder
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.players import HeadlessPlayer
from sandbox.study.run.run_device import SessionCamera, person_devices, settings_fitter
from tests.support.study_files import SHORT, design, play_session

CAMERA = "fov=70,at=0/0.4/0.1"
BEFORE_A_CAMERA = SHORT.replace(
    "[settings]\n", f'[settings]\ndevice = "webcam"\nwebcam = "{CAMERA}"\n'
)


class CameraSession:
    """Somebody's session before a camera, whose page is opened when its link is told.

    Args:
        folder: A new folder for the study.
        engine: Folder of the engine.

    Attributes:
        said: Lines for the experimenter.
    """

    def __init__(self, folder: Path, engine: Path) -> None:
        self.said: list[str] = []
        self.study = StudyFolder(folder, design(BEFORE_A_CAMERA), PILOT)
        person = self.study.add(hand="right", hand_size=1.0, language="en")
        with SessionCamera(engine, ("right",), False, self.say) as camera:
            self.outcome = play_session(
                self.study,
                person,
                person_devices(DeviceSettings.of("mouse"), person, camera=camera),
                player=HeadlessPlayer(paced=True),
                say=self.say,
                device=DeviceSettings.of("webcam"),
                fit=settings_fitter("mouse", camera=camera),
            )
        self.path = session_path(self.study.path, person.ppid)

    def say(self, text: str) -> None:
        self.said.append(text)
        if "http://" in text:
            self.open_page(text[text.index("http://") :])

    def open_page(self, address: str) -> None:
        """Opens the camera's page."""
        raise AssertionError(address)
