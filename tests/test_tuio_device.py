"""The TUIO device over real sockets, and `sandbox touches` as a real process."""

from __future__ import annotations

import json
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from models.errors import DeviceError
from models.frames import TouchFrame
from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.tuio import TuioDevice
from tests.tuio_packets import MALFORMED, frame, reference_frames

ROOT = Path(__file__).resolve().parent.parent
PATIENCE = 60.0
"""Seconds after which something that should happen is given up; nothing is judged by it."""

A, B = (0.25, 0.5), (0.75, 0.125)


class Sender:
    """A UDP socket of its own, as every sender has one."""

    def __init__(self, port: int) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))

    def __call__(self, *packets: bytes) -> None:
        for packet in packets:
            self.socket.send(packet)

    def __enter__(self) -> Sender:
        return self

    def __exit__(self, *error: object) -> None:
        self.socket.close()


def until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end, "this should have happened by now"
        time.sleep(0.002)


def collect(device: TuioDevice, count: int) -> list[TouchFrame]:
    """Polls until so many frames have come."""
    frames: list[TouchFrame] = []
    end = time.monotonic() + PATIENCE
    while len(frames) < count and time.monotonic() < end:
        device.wait(0.1)
        frames += device.poll()
    assert len(frames) >= count, f"{len(frames)} of {count} frames came: {device.statistics}"
    return frames


def places(touch_frame: TouchFrame, surface: Surface) -> list[tuple[float, float]]:
    """Contacts as fractions of the surface to nine digits, in order of id."""
    width, height = (float(length) for length in surface.size)
    contacts = sorted(touch_frame.contacts, key=lambda contact: contact.id)
    return [(round(contact.x / width, 9), round(contact.y / height, 9)) for contact in contacts]


@pytest.fixture(scope="module")
def listener() -> Iterator[TuioDevice]:
    """One device for many hostile packets, which is harder for it than a new one for each."""
    with TuioDevice(Surface(), port=0, stale_after=1e6) as device:
        yield device


def test_every_frame_comes_out_once_in_order_and_in_metres() -> None:
    surface = Surface(10.0, 5.0)
    with TuioDevice(surface, port=0) as device, Sender(device.port) as send:
        frames: list[TouchFrame] = []
        for n in range(300):
            send(frame(n + 1, {5: (n / 512, 0.5)}, source="table"))
            frames += device.poll()
        frames += collect(device, 300 - len(frames))
        assert [f.contacts[0].x for f in frames] == pytest.approx(
            [n / 512 * 10.0 * METRES_PER_INCH for n in range(300)], abs=1e-12
        )
        assert {(f.contacts[0].id, f.contacts[0].y) for f in frames} == {(5, 2.5 * METRES_PER_INCH)}
        assert {f.source for f in frames} == {"table"}
        assert all(c.label is None and c.size is None for f in frames for c in f.contacts)
        times = [f.time for f in frames]
        assert times == sorted(times)
        assert device.statistics.packets == device.statistics.frames == 300
        assert not device.finished


def test_a_full_queue_keeps_the_newest_frames_and_counts_the_others() -> None:
    with TuioDevice(Surface(), port=0, queue_frames=10) as device, Sender(device.port) as send:
        send(*[frame(n, {n: A}) for n in range(1, 26)])
        until(lambda: device.statistics.frames == 25)
        assert [f.contacts[0].id for f in device.poll()] == list(range(16, 26))
        assert device.statistics.dropped == 15
        assert device.poll() == []


def test_two_senders_share_the_surface_and_no_ids() -> None:
    surface = Surface()
    with (
        TuioDevice(surface, port=0) as device,
        Sender(device.port) as left,
        Sender(device.port) as right,
    ):
        left(frame(400, {0: A}, source="app"))
        collect(device, 1)
        right(frame(390, {0: B}, source="app"))
        (both,) = collect(device, 1)
        assert places(both, surface) == [A, B]
        right(frame(391, {}, source="app"))
        (rest,) = collect(device, 1)
        assert [c.id for c in rest.contacts] == [0]
        assert len({source.peer for source in device.sources}) == 2


def test_the_touches_of_a_silent_sender_are_lifted_and_it_is_marked() -> None:
    with TuioDevice(Surface(), port=0, stale_after=0.2) as device, Sender(device.port) as send:
        send(frame(1, {1: A}, source="app"))
        down, up = collect(device, 2)
        assert (len(down.contacts), len(up.contacts)) == (1, 0)
        assert up.time - down.time >= 0.2
        assert up.cancelled == frozenset(), "they count as lifted, not as taken away"
        assert [(source.name, source.stale) for source in device.sources] == [("app", True)]
        send(frame(2, {}, alive=[1]))
        assert [c.id for c in collect(device, 1)[0].contacts] == [1]


@pytest.mark.parametrize("data", MALFORMED.values(), ids=MALFORMED.keys())
def test_a_malformed_packet_is_counted_and_the_next_one_still_works(
    listener: TuioDevice, data: bytes
) -> None:
    before = listener.statistics
    with Sender(listener.port) as send:
        # The system may give this sender the port of an earlier one, so its counter goes on.
        n = before.packets
        send(frame(n + 1, {1: A}), data, frame(n + 2, {1: B}), frame(n + 3, {}))
        first, second, _ = collect(listener, 3)
    assert places(first, Surface()) == [A]
    assert places(second, Surface()) == [B]
    after = listener.statistics
    assert after.packets - before.packets == 4
    assert after.malformed - before.malformed == 1
    assert after.frames - before.frames == 3
    assert after.malformed_reason


def test_the_real_port_is_told_and_nobody_else_can_have_it() -> None:
    with TuioDevice(Surface(), port=0) as device:
        assert device.address == f"127.0.0.1:{device.port}"
        assert device.port > 0
        with pytest.raises(DeviceError, match="--port"):
            TuioDevice(Surface(), port=device.port)


@pytest.mark.parametrize(
    "settings",
    [
        {"port": 70_000},
        {"port": -1},
        {"bind": "203.0.113.9"},
        {"bind": "no such name."},
        {"bind": "a" * 300},
        {"stale_after": 0.0},
        {"stale_after": float("nan")},
        {"queue_frames": 0},
    ],
    ids=str,
)
def test_settings_that_cannot_work_are_refused_at_once(settings: dict[str, Any]) -> None:
    with pytest.raises(DeviceError):
        TuioDevice(Surface(), **({"port": 0} | settings))


def test_a_closed_device_gives_what_it_has_and_its_port_back() -> None:
    device = TuioDevice(Surface(), port=0)
    with Sender(device.port) as send:
        send(frame(1, {1: A}))
        until(lambda: device.statistics.frames == 1)
    device.close()
    device.close()
    assert not device.finished
    assert len(device.poll()) == 1
    assert device.finished
    assert device.poll() == []
    TuioDevice(Surface(), port=device.port).close()


def test_a_socket_that_breaks_is_reported_by_the_next_poll() -> None:
    device = TuioDevice(Surface(), port=0)
    with Sender(device.port) as send:
        send(frame(1, {1: A}))
        until(lambda: device.statistics.frames == 1)
    device._socket.close()  # as when the system takes the network away
    assert len(device.poll()) == 1, "what came before is not lost"
    assert device.wait(PATIENCE)
    with pytest.raises(DeviceError, match="listening to touches has failed"):
        device.poll()
    assert device.finished
    device.close()


class Program:
    """A running `sandbox` command; its standard error is read along."""

    def __init__(self, *arguments: str | Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "sandbox.cli.main", *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=ROOT,
        )
        self.errors: list[str] = []
        self._reader = threading.Thread(target=self._read_errors)
        self._reader.start()

    def _read_errors(self) -> None:
        assert self.process.stderr is not None
        self.errors.extend(iter(self.process.stderr.readline, ""))

    def error_line(self, pattern: str) -> re.Match[str]:
        """Waits for a line on standard error."""
        found: list[re.Match[str]] = []

        def look() -> bool:
            found.extend(m for line in list(self.errors) if (m := re.search(pattern, line)))
            assert found or self._reader.is_alive(), f"it ended saying only {self.errors}"
            return bool(found)

        until(look)
        return found[0]

    def port(self) -> int:
        return int(self.error_line(r"listening.*127\.0\.0\.1:(\d+)")[1])

    def end(self) -> tuple[int, list[str]]:
        """Its exit status and what is left of its standard output, once it ends by itself."""
        assert self.process.stdout is not None
        lines = self.process.stdout.read().splitlines()
        status = self.process.wait(PATIENCE)
        self._reader.join(PATIENCE)
        return status, lines


@contextmanager
def program(*arguments: str | Path) -> Iterator[Program]:
    started = Program(*arguments)
    try:
        yield started
    finally:
        started.process.kill()
        started.process.wait()
        assert started.process.stdout is not None
        assert started.process.stderr is not None
        started.process.stdout.close()
        started._reader.join(PATIENCE)
        started.process.stderr.close()


def run(*arguments: str | Path) -> tuple[int, list[str], str]:
    with program(*arguments) as started:
        status, lines = started.end()
        return status, lines, "".join(started.errors)


def capture_file(path: Path, packets: list[bytes], step: float = 0.01) -> Path:
    records = [{"t": 5.0 + n * step, "hex": data.hex()} for n, data in enumerate(packets)]
    path.write_text("".join(json.dumps(record) + "\n" for record in records))
    return path


SCENES = [frame(n, {1: (n / 64, 0.5), 2: (0.5, n / 64)}, source="s") for n in range(1, 41)]


def shown_and_sent(capture: Path, wanted: int, speed: float) -> tuple[list[str], list[str]]:
    """Frames shown by one process while another sends a capture; and the former's errors."""
    with program(
        *("touches", "show", "--device", "tuio", "--port", "0", "--json"),
        *("--surface", "7.76x5.82in", "--frames", str(wanted), "--seconds", str(PATIENCE)),
    ) as show:
        port = show.port()
        status, _, errors = run(
            "touches", "send", capture, "--to", f"127.0.0.1:{port}", "--speed", str(speed)
        )
        assert status == 0, errors
        status, lines = show.end()
        assert status == 0
        return lines, show.errors


def inches(lines: list[str]) -> list[dict[int, tuple[float, float]]]:
    """Positions by id from JSON lines; checks their form."""
    frames = []
    for line in lines:
        record = json.loads(line)
        assert record.keys() == {"time", "contacts"}
        assert all(c.keys() == {"id", "x", "y", "finger"} for c in record["contacts"])
        assert all(c["finger"] is None for c in record["contacts"])
        frames.append({c["id"]: (c["x"], c["y"]) for c in record["contacts"]})
    times = [json.loads(line)["time"] for line in lines]
    assert times == sorted(times)
    return frames


def expected_inches(packets: list[bytes]) -> list[dict[int, tuple[float, float]]]:
    return [
        {touch: (7.76 * x, 5.82 * y) for touch, (x, y) in touches.items()}
        for touches in reference_frames(packets)
    ]


def assert_same(
    shown: list[dict[int, tuple[float, float]]], expected: list[dict[int, tuple[float, float]]]
) -> None:
    assert [set(f) for f in shown] == [set(f) for f in expected]
    for got, wanted in zip(shown, expected, strict=True):
        for touch in wanted:
            assert got[touch] == pytest.approx(wanted[touch], abs=1e-9)


def test_what_one_process_sends_another_shows_line_by_line_in_inches(tmp_path: Path) -> None:
    capture = capture_file(tmp_path / "touches.jsonl", SCENES)
    lines, errors = shown_and_sent(capture, len(SCENES), 1.0)
    assert_same(inches(lines), expected_inches(SCENES))
    events = [json.loads(line) for line in errors]
    assert [event["event"] for event in events] == ["listening", "end"]
    assert set(events[0]) == {"event", "address"}
    assert (events[1]["frames"], events[1]["malformed"]) == (len(SCENES), 0)


def test_the_recorded_session_is_shown_as_a_second_decoder_reads_it(shared_data: Path) -> None:
    capture = shared_data / "tuio" / "tuio11_capture.jsonl"
    packets = [bytes.fromhex(json.loads(line)["hex"]) for line in capture.open()]
    expected = expected_inches(packets)
    lines, _ = shown_and_sent(capture, len(expected), 10.0)
    assert_same(inches(lines), expected)


def test_a_capture_played_as_a_device_shows_the_same_frames(tmp_path: Path) -> None:
    capture = capture_file(tmp_path / "touches.jsonl", SCENES)
    status, lines, _ = run(
        "touches", "show", "--device", capture, "--json", "--surface", "7.76x5.82in"
    )
    assert status == 0
    assert_same(inches(lines), expected_inches(SCENES))
    times = [json.loads(line)["time"] for line in lines]
    assert times == pytest.approx([0.01 * n for n in range(len(SCENES))])


def test_sending_keeps_bytes_order_and_pauses(tmp_path: Path) -> None:
    packets = [b"abcd", *MALFORMED.values(), b"", b"\x00" * 60_000, SCENES[0]]
    capture = capture_file(tmp_path / "odd.jsonl", packets)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(PATIENCE)
        port = receiver.getsockname()[1]
        with program("touches", "send", capture, "--to", f"localhost:{port}", "--speed", "2") as it:
            assert [receiver.recv(65_536) for _ in packets] == packets
            assert it.end()[0] == 0
            took = it.error_line(r"sent (\d+) packets in ([\d.]+) s")
    assert int(took[1]) == len(packets)
    assert float(took[2]) >= round(0.01 * (len(packets) - 1) / 2, 1)  # it never runs ahead


def test_sending_to_nobody_says_so(tmp_path: Path) -> None:
    capture = capture_file(tmp_path / "touches.jsonl", SCENES)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
    status, _, errors = run("touches", "send", capture, "--to", f"127.0.0.1:{port}")
    assert status == 0
    assert "nobody listens" in errors


def test_a_damaged_capture_is_sent_up_to_the_damage_and_the_line_is_named(tmp_path: Path) -> None:
    capture = capture_file(tmp_path / "touches.jsonl", SCENES)
    whole = capture.read_text().splitlines(keepends=True)
    capture.write_text("".join(whole[:25]) + whole[25][:40])
    with TuioDevice(Surface(), port=0) as device:
        status, _, errors = run("touches", "send", capture, "--to", device.address)
        assert status == 2
        assert "touches.jsonl, line 26" in errors
        assert "Traceback" not in errors
        assert len(collect(device, 25)) == 25


def test_control_c_ends_cleanly() -> None:
    with program("touches", "show", "--port", "0", "--json") as show:
        with Sender(show.port()) as send:
            send(SCENES[0])
            assert show.process.stdout is not None
            assert json.loads(show.process.stdout.readline())["contacts"], "flushed at once"
        show.process.send_signal(signal.SIGINT)
        status, lines = show.end()
        assert (status, lines) == (0, [])
        assert json.loads(show.errors[-1])["event"] == "end"
        assert len(show.errors) == 2


def test_it_stops_after_the_time_given() -> None:
    status, lines, errors = run("touches", "show", "--port", "0", "--json", "--seconds", "0.2")
    assert (status, lines) == (0, [])
    assert [json.loads(line)["event"] for line in errors.splitlines()] == [
        "listening",
        "warning",
        "end",
    ]
    assert "--bind 0.0.0.0" in errors, "it says what to check where nothing came"


def test_people_are_told_the_address_and_what_touches_there_are() -> None:
    with program("touches", "show", "--port", "0", "--frames", "2") as show:
        with Sender(show.port()) as send:
            send(b"nonsense", frame(1, {7: (0.5, 0.5)}), frame(2, {}))
        status, lines = show.end()
        assert status == 0
        assert "7: 3.88, 2.91" in lines[0]
        assert "no touch" in lines[1]
        assert "a guess" in show.errors[0], "TUIO has no sizes; without --surface inches are none"
        assert "1 malformed" in show.errors[-1]


def test_packets_of_tuio_2_are_named_as_what_is_wrong(shared_data: Path) -> None:
    status, _, errors = run(
        "touches", "show", "--device", shared_data / "tuio" / "tuio20_capture.jsonl"
    )
    assert status == 0
    assert "/tuio2/" in errors
    assert "version 1.1" in errors


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["show", "--surface", "big"], "WIDTHxHEIGHT"),
        (["show", "--frames", "0"], "--frames"),
        (["show", "--seconds", "nan"], "--seconds"),
        (["show", "--device", "no/such/file"], "no/such/file"),
        (["show", "--port", "999999"], "0 to 65535"),
        (["show", "--device", "pyproject.toml"], "pyproject.toml, line 1"),
        (["send", "pyproject.toml", "--to", "127.0.0.1:1"], "pyproject.toml, line 1"),
        (["send", "x", "--to", "127.0.0.1:1", "--speed", "0"], "--speed"),
        (["show", "--nonsense"], "nonsense"),
        ([], "show"),
    ],
    ids=str,
)
def test_bad_input_is_one_clear_message_and_status_2(arguments: list[str], said: str) -> None:
    status, lines, errors = run("touches", *arguments)
    assert status == 2
    assert lines == []
    assert said in errors
    assert "Traceback" not in errors


@pytest.mark.parametrize("to", ["3333", "127.0.0.1", "127.0.0.1:x", "127.0.0.1:70000", ":"])
def test_an_address_that_is_none_is_refused(tmp_path: Path, to: str) -> None:
    status, _, errors = run("touches", "send", capture_file(tmp_path / "c", SCENES), "--to", to)
    assert status == 2
    assert "HOST:PORT" in errors


def test_help_and_formats_teach() -> None:
    for command, words in (
        (["--help"], ["show", "send", "formats"]),
        (["show", "--help"], ["--bind 0.0.0.0", "touches send CAPTURE", "--surface", "inches"]),
        (["send", "--help"], ["--to", "--speed"]),
        (["formats"], ["TUIO 1.1", "2Dcur", "hex"]),
    ):
        status, lines, _ = run("touches", *command)
        text = " ".join(lines)
        assert status == 0
        assert all(word in text for word in words), text
