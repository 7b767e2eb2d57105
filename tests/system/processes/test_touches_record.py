"""`sandbox touches record` and `send --tuio`: what was recorded plays, what was sent arrives."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from models.surface import Surface
from sandbox.devices.files.frame_file import read_frame_file
from sandbox.devices.files.touch_files import open_file
from sandbox.devices.tuio.touch_capture import read_capture
from sandbox.devices.tuio.tuio import TuioDevice
from tests.sandbox.devices.tuio.test_tuio_streams import framed
from tests.support.page_client import SCREEN, Page
from tests.support.processes import PATIENCE, ROOT, Sender, program, run, until
from tests.support.tuio_packets import MALFORMED, alv, bnd, bundle, frame, frame20, frm, ptr

CIRCLING = f"{ROOT / 'examples' / 'circling_finger.py'}:CirclingFinger:3"


def contacts(lines: list[str]) -> list[list[dict[str, object]]]:
    return [json.loads(line)["contacts"] for line in lines]


def test_packets_are_recorded_as_they_came_and_play_as_the_device(tmp_path: Path) -> None:
    file = tmp_path / "touches.jsonl"
    odd = list(MALFORMED.values())[5]
    with program(
        *("touches", "record", file, "--port", "0", "--tuio-transport", "all"),
        *("--websocket-port", "0", "--frames", "4"),
    ) as recorder:
        port = recorder.port()
        with Sender(port) as udp:
            udp(frame(1, {1: (0.5, 0.5)}, source="s"), odd)
            until(lambda: len(file.read_text().splitlines()) == 2)
            with socket.create_connection(("127.0.0.1", port)) as stream:
                stream.sendall(framed(frame20(1, {1: (0.25, 0.5)})))
                until(lambda: len(file.read_text().splitlines()) == 3)
            until(lambda: len(file.read_text().splitlines()) == 4)
            udp(frame(2, {}))
        assert recorder.end()[0] == 0
    packets = read_capture(file).packets
    assert [p.data for p in packets[:2]] == [frame(1, {1: (0.5, 0.5)}, source="s"), odd]
    assert packets[3].data is None
    assert packets[2].peer == packets[3].peer != packets[0].peer == packets[4].peer
    played = list(open_file(file, None).device.poll(1e6))
    assert [len(f.contacts) for f in played] == [1, 2, 1, 0]
    assert [len(f.cancelled) for f in played] == [0, 0, 0, 1]


def test_who_only_looks_at_the_first_lines_is_no_fault_of_the_file(tmp_path: Path) -> None:
    file = tmp_path / "frames.jsonl"
    line = [sys.executable, "-m", "sandbox.cli.main", "touches", "record", str(file)]
    with subprocess.Popen(
        [*line, "--device", CIRCLING, "--frames", "400"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    ) as recorder:
        assert recorder.stdout is not None and recorder.stderr is not None
        assert recorder.stdout.readline()
        recorder.stdout.close()
        assert recorder.wait(PATIENCE) == 0
        assert "written" not in recorder.stderr.read()
    assert len(read_frame_file(file).frames) >= 1


def test_frames_of_any_device_are_recorded_with_their_surface(tmp_path: Path) -> None:
    file = tmp_path / "frames.jsonl"
    size = ("--surface", "9x6in")
    status, _, errors = run(
        "touches", "record", file, "--device", CIRCLING, *size, "--frames", "30"
    )
    assert status == 0, errors
    opened = open_file(file, None)
    assert (opened.surface.width_in, opened.surface.height_in) == (9.0, 6.0)
    shown, lines, _ = run("touches", "show", "--device", file, "--json")
    assert shown == 0
    assert contacts(lines) == contacts(file.read_text().splitlines()[1:])
    assert {len(c) for c in contacts(lines)} == {3}
    whole = file.read_text()
    file.write_text(whole[: len(whole) // 2])
    status, lines, errors = run("touches", "show", "--device", file, "--json")
    assert status == 2
    assert 0 < len(lines) < 30
    assert f"line {len(lines) + 2}" in errors
    assert "Traceback" not in errors


def test_what_is_sent_as_tuio_arrives_like_the_device(tmp_path: Path) -> None:
    packets = [bundle(frm(n), ptr(1, n / 32, 0.5), bnd(1, 0.1, 0.1), alv(1)) for n in range(1, 21)]
    records = [{"t": n / 100, "hex": data.hex()} for n, data in enumerate(packets)]
    capture = tmp_path / "two.jsonl"
    capture.write_text("".join(json.dumps(record) + "\n" for record in records))
    surface = Surface(10.0, 5.0)
    with TuioDevice(surface, port=0) as device:
        status, _, errors = run(
            "touches", "send", capture, "--tuio", device.address, "--surface", "10x5in"
        )
        assert status == 0, errors
        assert "sent 20 frames" in errors
        until(lambda: device.statistics.frames >= 23)
        width = float(surface.size[0])
        places = [round(f.contacts[0].x / width * 32) for f in device.poll() if f.contacts]
    assert sorted(set(places)) == list(range(1, 21))
    assert places == sorted(places)


def test_a_live_device_is_sent_until_control_c_and_then_lifts() -> None:
    with (
        TuioDevice(Surface(), port=0) as device,
        program("touches", "send", "--device", CIRCLING, "--tuio", device.address) as sending,
    ):
        until(lambda: device.statistics.frames > 10)
        sending.process.send_signal(signal.SIGINT)
        assert sending.end()[0] == 0
        frames = device.poll()
        assert len(frames[5].contacts) == 3
        assert frames[-1].contacts == ()


def test_touches_of_the_page_are_recorded_however_the_page_was_asked_for(tmp_path: Path) -> None:
    file = tmp_path / "touches.jsonl"
    with program("touches", "record", file, "--lan", "127.0.0.1") as recorder:
        page = Page(recorder.error_line(r"open (http://\S+)")[1])
        try:
            page.until("scene")

            def arrived() -> bool:
                page.touch((5, 1.5, 2.25), (6, 4.0, 3.0))
                return len(read_lines(file)) > 2

            until(arrived)
        finally:
            page.close()
        recorder.process.send_signal(signal.SIGINT)
        assert recorder.end()[0] == 0
    recorded = read_frame_file(file)
    assert recorded.surface is not None
    assert max(len(frame.contacts) for frame in recorded.frames) == 2


def test_a_screen_that_is_too_small_for_a_hand_is_refused_without_a_word_of_a_task(
    tmp_path: Path,
) -> None:
    file = tmp_path / "touches.jsonl"
    small = {**SCREEN, "width_px": 390.0, "height_px": 844.0, "px_per_in": 155.0}
    with program("touches", "record", file, "--device", "web") as recorder:
        page = Page(recorder.error_line(r"open (http://\S+)")[1], screen=small)
        recorder.error_line("too small for a hand")
        page.close()
        assert recorder.end()[0] == 2
    assert not file.exists()


def read_lines(file: Path) -> list[str]:
    return file.read_text().splitlines() if file.exists() else []


def test_sending_a_capture_stops_after_the_time_given(tmp_path: Path) -> None:
    capture = tmp_path / "far.jsonl"
    lines = [{"t": t, "hex": frame(1, {1: (0.5, 0.5)}).hex()} for t in (0.0, 0.1, 1e300)]
    capture.write_text("".join(json.dumps(line) + "\n" for line in lines))
    status, _, errors = run("touches", "send", capture, "--to", "127.0.0.1:9", "--seconds", "0.5")
    assert status == 0, errors
    assert "sent 2 packets" in errors


def test_the_page_can_feed_other_programs() -> None:
    surface = Surface()
    with (
        TuioDevice(surface, port=0) as device,
        program("touches", "send", "--device", "web", "--tuio", device.address) as sending,
    ):
        page = Page(sending.error_line(r"open (http://\S+)")[1])
        try:
            page.until("scene")
            page.touch((5, 1.5, 2.25), (6, 4.0, 3.0))
            until(lambda: device.statistics.frames > 0 and bool(device.sources[0].touches))
            both = next(f for f in device.poll() if f.contacts)
            # The page of the test is 1024 x 768 pixels of 132 to the inch.
            wide, high = 1024 / 132 / surface.size[0], 768 / 132 / surface.size[1]
            places = sorted((c.x * wide, c.y * high) for c in both.contacts)
            assert places[0] == pytest.approx((1.5, 2.25), abs=1e-3)
            assert places[1] == pytest.approx((4.0, 3.0), abs=1e-3)
        finally:
            page.close()
        sending.process.send_signal(signal.SIGINT)
        assert sending.end()[0] == 0
