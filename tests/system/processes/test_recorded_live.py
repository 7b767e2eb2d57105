"""`sandbox capture record` with two devices that run: a Leap service and a sender of TUIO."""

from __future__ import annotations

import json
import socket
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from encoders.capture import load_capture
from encoders.captures.paired.simulated_pair import FROZEN_PAIRED, PairedSession, simulate_paired
from sandbox.cli.capture import record
from sandbox.cli.capture.simulate import write_simulated
from sandbox.cli.main import main
from sandbox.devices.files.paired_capture import HANDS, TOUCHES
from sandbox.devices.leap.leap_fake import FakeLeapd
from sandbox.devices.leap.leap_file import read_leap
from sandbox.devices.tuio.tuio_output import TuioOutput


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


QUICK = replace(FROZEN_PAIRED, play=3.0, leap_rate=100.0, open_seconds=2.6)


class Touching(threading.Thread):
    """Sends a session's touches as they were made, from when somebody listens to the Leap."""

    def __init__(self, s: PairedSession, leapd: FakeLeapd, port: int) -> None:
        super().__init__(daemon=True)
        self._session, self._leapd = s, leapd
        self._out = TuioOutput(f"127.0.0.1:{port}", s.surface)
        self.stop = threading.Event()

    def run(self) -> None:
        while not self._leapd.counts["frames"]:
            if self.stop.wait(0.001):
                return
        begin = time.monotonic() - self._session.leap_arrived[0]
        for frame, due in zip(self._session.touches, self._session.touch_arrived, strict=True):
            if self.stop.wait(max(0.0, begin + due - time.monotonic())):
                break
            self._out.send([frame], time.monotonic())
        self._out.close()


@pytest.mark.slow
def test_live_touches_and_a_live_leap_become_a_capture_of_the_same_fingers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    s = simulate_paired(3, 1, "v3", "right", QUICK)
    write_simulated(s, tmp_path / "day", "P1")
    messages = read_leap(tmp_path / "day" / HANDS).messages
    leapd = FakeLeapd(messages, port=0, rate=QUICK.leap_rate)
    port = free_port()
    touching = Touching(s, leapd, port)
    touching.start()
    try:
        devices = f"--touches tuio --port {port} --leap {leapd.address}".split()
        size = f"{s.surface.width_in}x{s.surface.height_in}in"
        long = f"{s.leap_arrived[-1] - s.leap_arrived[0] + 0.5:.2f}"
        how = ["--surface", size, "--free", "--seconds", long, "--out", str(tmp_path / "live")]
        status = main(["capture", "record", *devices, *how])
    finally:
        touching.stop.set()
        touching.join()
        leapd.close()
    assert status == 0, capsys.readouterr().err
    about = json.loads((tmp_path / "live" / "about.json").read_text())
    assert about["simulated"] is True, "its service is a fake one, and says so"
    # Both live streams have this machine's clock, and the devices' delays are 20 ms apart. Finding
    # that by taps, as in the files, would need a machine that is never late.
    for folder, sync in (("day", []), ("live", ["--sync", "clock", "--offset", "0.02"])):
        out = tmp_path / f"{folder}.npz"
        words = ["capture", "--recorded", str(tmp_path / folder), "--out", str(out), *sync]
        assert main(words) == 0
    filed, live = (load_capture(tmp_path / f"{name}.npz") for name in ("day", "live"))
    # Both are made of the same touches: the same sets of fingers, each finger as often. How many
    # frames there are live depends on the machine.
    sets = [{tuple(row) for row in c.down.tolist()} for c in (filed, live)]
    assert sets[0] == sets[1]
    seconds = [np.array([c.down[:, f].mean() for f in range(5)]) for c in (filed, live)]
    np.testing.assert_allclose(seconds[1], seconds[0], atol=0.05)
    notes = [c.meta["conversion"] for c in (filed, live)]
    place = [np.array(n["device_at_m"]) for n in notes]
    assert np.linalg.norm(place[0] - place[1]) < 0.004


def test_frames_that_came_before_the_recording_are_not_part_of_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    s = simulate_paired(3, 1, "v3", "right", QUICK)
    write_simulated(s, tmp_path / "day", "P1")
    leapd = FakeLeapd(read_leap(tmp_path / "day" / HANDS).messages, port=0, rate=100.0)
    opened = record._touches

    def late(options: record.RecordOptions) -> object:
        # As long as a person needs to open the page on a tablet.
        time.sleep(1.5)
        return opened(options)

    monkeypatch.setattr(record, "_touches", late)
    touches = str(tmp_path / "day" / TOUCHES)
    line = ["--touches", touches, "--leap", leapd.address, "--free", "--seconds", "1"]
    try:
        assert main(["capture", "record", *line, "--out", str(tmp_path / "live")]) == 0
    finally:
        leapd.close()
    lines = (tmp_path / "live" / HANDS).read_text().splitlines()
    hosts = [json.loads(line)["host"] for line in lines]
    assert sum(host < 0.05 for host in hosts) < 20 < len(hosts)
