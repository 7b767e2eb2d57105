"""What other people's touch senders and files send, as a person sees it in the commands."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.cli.devices.show import DeviceTable
from sandbox.cli.main import main
from sandbox.devices.device import TouchDevice
from sandbox.devices.files.frame_file import header_record
from sandbox.devices.files.touch_files import open_file
from sandbox.devices.own_device import GuardedDevice
from tests.support.tuio_packets import blobs, frame, frame20


def finger_file(path: Path, width: float, height: float, second: float = 1.0) -> Path:
    """A finger that moves over an iPad; width and height of its contact in inches."""
    lines = [header_record(Surface(), "page")]
    lines += [
        {
            "time": n / 50 * second,
            "contacts": [{"id": 1, "x": 2 + n / 50, "y": 3, "width": width, "height": height}],
        }
        for n in range(80)
    ]
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return path


def rows(path: Path) -> dict[str, str]:
    """The table of a file."""
    device = open_file(path, None).device
    table = DeviceTable(device, in_place=False)
    table.take(device.poll(1e9))
    return table.rows()


def test_the_table_says_what_is_left_out_and_which_units_are_assumed(tmp_path: Path) -> None:
    shown = rows(finger_file(tmp_path / "a.jsonl", 0.3, 20.0, second=1e3))
    assert shown["frames a second"] == "50.0"
    assert shown["left out: sizes that no finger or hand has"] == "80"
    assert "times are read in ms" in shown["assumed"]


class Pad(TouchDevice):
    """A device of one's own whose fingers are 2000 px high."""

    def poll(self, now: float) -> list[TouchFrame]:
        fingers = Contact(1, 0.1, 0.1, 0.008), Contact(2, 0.1, 0.05, 0.07, 3, (0.006, 0.4))
        return [TouchFrame(now, fingers)]


def test_a_device_of_one_s_own_has_no_impossible_sizes_either() -> None:
    device = GuardedDevice(Pad(Surface()), Surface(), "pad.py")
    ((first, second),) = (frame.contacts for frame in device.poll(0.5))
    assert first.size == 0.008
    assert (second.id, second.label, second.size, second.extent) == (2, 3, None, None)
    assert device.report.line() == "left out: 1 sizes that no finger or hand has"


def test_units_that_do_not_follow_are_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(finger_file(tmp_path / "a.jsonl", 0.3, 0.4, second=1e-3))
    assert main(["touches", "show", "--device", path]) == 2
    assert "--unit" in capsys.readouterr().err
    assert main(["touches", "show", "--device", path, "--unit", "s"]) == 0


def test_json_has_the_report_at_its_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "packets.jsonl"
    packets = [frame(1, {1: (0.5, 7.0), 2: (0.5, 0.5)}, source="x"), frame20(1, {2: (0.5, 0.5)})]
    packets += [blobs(2, {2: (0.5, 0.5, 40.0, 30.0)}), frame(2, {2: (0.5, 0.5)})]
    records = [{"t": n / 10, "hex": p.hex(), "from": "h:1"} for n, p in enumerate(packets)]
    path.write_text("".join(json.dumps(record) + "\n" for record in records))
    assert main(["touches", "show", "--device", str(path), "--json"]) == 0
    end = json.loads(capsys.readouterr().err.splitlines()[-1])
    assert end["left_out"] == {
        "positions beyond the surface": 1,
        "sizes that no finger or hand has": 1,
    }
    assert end["assumed"] == ["two sends every touch twice; each counts once"]
