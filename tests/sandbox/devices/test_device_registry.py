"""A device is added by a module and a registry line, or by a package, and played by its name."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from models.surface import Surface
from sandbox import run_trial
from sandbox.cli.main import main
from sandbox.cli.overview import overview
from sandbox.devices.device import Place
from sandbox.devices.registry import DEVICES, DeviceSettings, built_in, touch_devices
from sandbox.recording.recording import load_recording
from tests.sandbox.devices.registered_devices import CAMERA, PAD, Pad


def test_a_device_is_named_with_an_argument_only_where_it_takes_one() -> None:
    assert built_in("evdev:/dev/input/event5") is DEVICES["evdev"]
    assert built_in("leap-simulated:v1") is DEVICES["leap-simulated"]
    assert built_in("tuio:1") is built_in("nothing") is None


def test_a_line_in_the_registry_adds_a_touch_device(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(DEVICES, "pad", PAD)
    assert "pad" in touch_devices() and "a pad with a finger on its middle" in overview({"a": "b"})
    device = DeviceSettings.of("pad:3").open(Place(Surface()))
    assert isinstance(device, Pad) and len(device.poll(0.0)[0].contacts) == 3
    out, record = tmp_path / "out.json", tmp_path / "run.jsonl"
    arguments = ["--device", "pad:2", "--json", str(out), "--record", str(record)]
    assert main(["run", "box-to-goal", *arguments]) == 0
    assert json.loads(out.read_text())["status"] == "input_ended"
    assert len(load_recording(record).touches()[0].contacts) == 2
    capsys.readouterr()
    assert main(["touches", "show", "--device", "pad", "--frames", "1", "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["contacts"]) == 1


def test_a_line_in_the_registry_adds_a_device_of_hands_in_the_air(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(DEVICES, "camera", CAMERA)
    assert DeviceSettings.of("camera:left").open(Place(Surface())).name == "Camera"
    out = tmp_path / "out.json"
    assert main(["run", "box-to-goal", "--device", "camera", "--json", str(out)]) == 0
    assert json.loads(out.read_text())["status"] == "input_ended"


def test_a_device_of_an_installed_package_is_played_by_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    site = tmp_path / "site"
    info = site / "registry_pads-1.0.dist-info"
    info.mkdir(parents=True)
    # Written without any class of ours, and with the four required members only.
    (site / "registry_pads.py").write_text(
        "from models.frames import Contact, TouchFrame\n"
        "class Pad:\n"
        "    name, finished = 'lab pad', False\n"
        "    def __init__(self, surface, argument):\n"
        "        self.fingers = int(argument)\n"
        "    def poll(self, now):\n"
        "        self.finished = now > 0.2\n"
        "        contacts = (Contact(i, 0.02 * i, 0.05) for i in range(self.fingers))\n"
        "        return [TouchFrame(now, tuple(contacts))]\n"
        "    def close(self):\n"
        "        self.finished = True\n"
    )
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: registry-pads\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[hand_sandbox.devices]\nlab-pad = registry_pads:Pad\n")
    monkeypatch.syspath_prepend(site)
    out, record = tmp_path / "out.json", tmp_path / "run.jsonl"
    arguments = ["--device", "lab-pad:3", "--json", str(out), "--record", str(record)]
    assert "lab-pad" in overview({"a": "b"})
    monkeypatch.setattr("sandbox.trial.driver.RealTime.wait", lambda clock, time: None)
    assert main(["run", "box-to-goal", *arguments]) == 0
    assert json.loads(out.read_text())["status"] == "input_ended"
    assert len(load_recording(record).touches()[0].contacts) == 3


@pytest.mark.parametrize(
    ("frames", "said"),
    [
        ("None", "`poll` of this device fails"),
        ("1 / 0", "ZeroDivisionError"),
        ("sys.exit(0)", "SystemExit"),
        ("[(0, 0.1, 0.1)]", "something else than frames"),
        ("[TouchFrame(now, (Contact(0, float('nan'), 0.1),))]", "must be finite"),
        ("[TouchFrame(now, (Contact(0, 3.0, 2.0),))]", "far off the surface"),
        ("[TouchFrame(now, (Contact(2**70, 0.1, 0.1),))]", "more than 64 bits"),
        ("[TouchFrame(now, (Contact(0.5, 0.1, 0.1),))]", "value that is not a number"),
        ("[TouchFrame(now, (Contact('a', 0.1, 0.1),))]", "value that is not a number"),
    ],
)
def test_an_error_in_the_poll_of_a_device_of_ones_own_is_one_line_with_its_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], frames: str, said: str
) -> None:
    file = tmp_path / "odd.py"
    file.write_text(
        "import sys\nfrom models import Contact, TouchFrame\n"
        "from sandbox import TouchDevice\n"
        "class Odd(TouchDevice):\n"
        f"    def poll(self, now):\n        return {frames}\n"
    )
    assert main(["run", "box-to-goal", "--device", f"{file}:Odd"]) != 0
    lines = [line for line in capsys.readouterr().err.splitlines() if said in line]
    assert len(lines) == 1 and "odd.py:Odd" in lines[0]


@pytest.mark.parametrize(
    ("takes", "said"),
    [
        ("self, port", "cannot be opened with a surface and an argument"),
        ("self, surface, argument", "ValueError: no such port"),
    ],
)
def test_a_device_that_cannot_be_made_is_one_clear_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], takes: str, said: str
) -> None:
    file = tmp_path / "odd.py"
    file.write_text(
        "from sandbox import TouchDevice\n"
        "class Odd(TouchDevice):\n"
        f"    def __init__({takes}):\n        raise ValueError('no such port')\n"
        "    def poll(self, now):\n        return []\n"
    )
    assert main(["run", "box-to-goal", "--device", f"{file}:Odd:7"]) == 2
    (line,) = [line for line in capsys.readouterr().err.splitlines() if said in line]
    assert "odd.py:Odd" in line


def test_numbers_of_numpy_are_recorded_as_any_others(tmp_path: Path) -> None:
    file, record = tmp_path / "pad.py", tmp_path / "run.jsonl"
    file.write_text(
        "import numpy as np\n"
        "from models import Contact, TouchFrame\n"
        "from sandbox import TouchDevice\n"
        "class Pad(TouchDevice):\n"
        "    def poll(self, now):\n"
        "        self.finished = now > 0.1\n"
        "        x, y, size = np.array([0.08, 0.06, 0.01], np.float32)\n"
        "        one = Contact(np.int64(3), x, y, size, np.uint8(1), (size, size))\n"
        "        gone = frozenset({np.int32(2)})\n"
        "        return [TouchFrame(np.float32(now), (one,), np.float32(0.5), gone)]\n"
    )
    run_trial("box-to-goal", seed=1, device=f"{file}:Pad", record=record, real_time=False)
    touches = load_recording(record).touches()
    assert touches and {type(c.x) for frame in touches for c in frame.contacts} == {float}
    assert touches[0].contacts[0].x == float(np.float32(0.08))
