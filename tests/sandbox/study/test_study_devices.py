"""Trials with touches from elsewhere: what comes over TUIO is played, and sizes are not made up."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from sandbox.cli.main import main
from sandbox.devices.registry import DeviceSettings
from sandbox.recording.recording import load_recording
from sandbox.study.record.folder import PILOT, StudyFolder
from sandbox.study.run.players import HeadlessPlayer
from sandbox.study.run.run_device import person_devices, settings_fitter
from sandbox.study.run.runner import SessionOutcome
from sandbox.trial.replay import replay
from tests.support.study_files import SHORT, design, play_session, rows_of
from tests.support.tuio_packets import frame


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextmanager
def somebody_touches(port: int) -> Iterator[None]:
    """Two fingers that slide, sixty times a second."""
    over = threading.Event()

    def send() -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            for number in range(1, 100_000):
                x = 0.3 + 0.001 * (number % 200)
                packet = frame(number, {1: (x, 0.6), 2: (x + 0.1, 0.55)})
                out.sendto(packet, ("127.0.0.1", port))
                if over.wait(1 / 60):
                    return

    thread = threading.Thread(target=send)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


@pytest.mark.parametrize("told", [True, False])
def test_touches_over_tuio_are_played_and_inches_are_a_guess_unless_the_design_tells_them(
    tmp_path: Path, told: bool
) -> None:
    size = 'surface = "197x148mm"\n' if told else ""
    text = SHORT.replace("[settings]\n", f"[settings]\n{size}")
    study = StudyFolder(tmp_path, design(text), PILOT)
    person = study.add(hand="right", hand_size=1.0, language="en")
    device = DeviceSettings.of("tuio", {"port": free_port()})
    with somebody_touches(device.options.port):
        devices, player = person_devices(device, person), HeadlessPlayer(paced=True)
        fit = settings_fitter("tuio")
        outcome = play_session(study, person, devices, player=player, device=device, fit=fit)
    assert outcome is SessionOutcome.COMPLETE
    rows = rows_of(study.path / "tables/trials.csv")
    assert len(rows) == 2 and all(float(r["first_contact_s"]) < 0.3 for r in rows)
    for path in study.path.glob("*/S001/trials/*.jsonl.gz"):
        recording = load_recording(path)
        assert recording.header["settings"]["surface"]["calibrated"] is told
        _, found = replay(recording)
        assert found.exact and found.complete


@pytest.mark.parametrize(
    "wrong",
    [
        ["--device", "evdev:/dev/input/nothing"],
        ["--device", "nothing"],
        ["--lan", "nowhere"],
        ["--device", "web", "--forms", "terminal"],
        ["--tablet", "--device", "tuio"],
        ["--device", "mouse", "--view", "none"],
    ],
)
def test_what_cannot_be_is_said_before_anybody_takes_part(
    tmp_path: Path, wrong: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "design.toml"
    file.write_text(SHORT)
    command = ["study", "run", str(file), "--out", str(tmp_path), "--participant", "new"]
    assert main([*command, "--view", "none", *wrong]) == 2
    assert capsys.readouterr().err.count("\n") <= 6
    assert not list(tmp_path.glob("quick*/*/S001"))
