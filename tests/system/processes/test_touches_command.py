"""`sandbox touches` as real processes that send to each other."""

from __future__ import annotations

import contextlib
import errno
import gzip
import json
import os
import pty
import re
import resource
import signal
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from pythonosc.osc_packet import OscPacket

from models.errors import DeviceError
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.devices.tuio.tuio_output import send_packet
from tests.support.processes import (
    PATIENCE,
    ROOT,
    Sender,
    free_port,
    program,
    receiver,
    run,
    until,
)
from tests.support.tuio_packets import MALFORMED, frame, reference_frames


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
        # However long the sender waits for a processor between two packets.
        *("--stale-after", str(PATIENCE)),
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
    # Where the sender takes long to start, there is a warning that nothing comes.
    events = [e for e in map(json.loads, errors) if e["event"] != "warning"]
    assert [event["event"] for event in events] == ["listening", "end"]
    assert set(events[0]) == {"event", "address"}
    assert (events[1]["frames"], events[1]["malformed"]) == (len(SCENES), 0)


def test_a_capture_played_as_a_device_shows_the_same_frames(tmp_path: Path) -> None:
    capture = capture_file(tmp_path / "touches.jsonl", SCENES)
    status, lines, _ = run(
        "touches", "show", "--device", capture, "--json", "--surface", "7.76x5.82in"
    )
    assert status == 0
    assert_same(inches(lines), expected_inches(SCENES))
    times = [json.loads(line)["time"] for line in lines]
    assert times == pytest.approx([0.01 * n for n in range(len(SCENES))])


def test_a_compressed_recording_is_shown_as_the_plain_one(tmp_path: Path) -> None:
    recording = ROOT / "sandbox" / "data" / "demo.jsonl"
    packed = tmp_path / "demo.jsonl.gz"
    packed.write_bytes(gzip.compress(recording.read_bytes()))
    shown = [run("touches", "show", "--device", str(x), "--json") for x in (recording, packed)]
    assert shown[0] == shown[1] and shown[0][0] == 0 and len(shown[0][1]) > 10


def test_sending_keeps_bytes_order_and_pauses(tmp_path: Path) -> None:
    packets = [b"abcd", *MALFORMED.values(), b"", b"\x00" * 60_000, SCENES[0]]
    capture = capture_file(tmp_path / "odd.jsonl", packets)
    with receiver() as there:
        port = there.getsockname()[1]
        with program("touches", "send", capture, "--to", f"localhost:{port}", "--speed", "2") as it:
            assert [there.recv(65_536) for _ in packets] == packets
            assert it.end()[0] == 0
            took = it.error_line(r"sent (\d+) packets in ([\d.]+) s")
    assert int(took[1]) == len(packets)
    assert float(took[2]) >= round(0.01 * (len(packets) - 1) / 2, 1)  # it never runs ahead


def test_a_capture_of_more_connections_than_a_process_may_open_is_sent(tmp_path: Path) -> None:
    lines: list[dict[str, Any]] = []
    for n in range(300):
        lines.append({"t": n / 200, "hex": SCENES[n % 40].hex(), "from": f"tablet:{n}"})
        if n % 2:
            lines.append({"t": n / 200, "closed": f"tablet:{n}"})
    capture = tmp_path / "many.jsonl"
    capture.write_text("".join(json.dumps(line) + "\n" for line in lines))
    with TuioDevice(Surface(), port=0) as device:
        done = subprocess.run(
            [sys.executable, "-m", "sandbox", "touches", "send", capture, "--to", device.address],
            cwd=ROOT,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (96, 96)),
        )
    assert done.returncode == 0, done.stderr
    assert "sent 300 packets" in done.stderr


def test_the_packet_that_meets_the_news_of_a_refusal_is_not_lost() -> None:
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver,
        Sender(free_port()) as send,
    ):
        to = send.socket.getpeername()
        send(b"to nobody")
        receiver.bind(to)
        receiver.settimeout(PATIENCE)
        assert send_packet(send.socket, b"heard", "there")
        assert receiver.recv(100) == b"heard"
        assert not send_packet(send.socket, b"again", "there")


def test_a_damaged_capture_is_used_up_to_the_line_that_is_named(tmp_path: Path) -> None:
    capture = capture_file(tmp_path / "touches.jsonl", SCENES)
    whole = capture.read_text().splitlines(keepends=True)
    capture.write_text("".join(whole[:25]) + whole[25][:40])
    with TuioDevice(Surface(), port=0, stale_after=PATIENCE) as device:
        status, _, errors = run("touches", "send", capture, "--to", device.address)
        until(lambda: device.statistics.frames == 25)
    shown, lines, more_errors = run("touches", "show", "--device", capture, "--json")
    assert len(lines) == 25
    assert (status, shown) == (2, 2)
    before, _, _ = run("touches", "show", "--device", capture, "--json", "--frames", "10")
    assert before == 0, "what was asked for was there"
    for said in (errors, more_errors):
        assert "touches.jsonl, line 26" in said
        assert "Traceback" not in said


def test_control_c_ends_cleanly() -> None:
    longest = ("--seconds", str(PATIENCE), "--stale-after", str(PATIENCE))
    with program("touches", "show", "--port", "0", "--json", *longest) as show:
        with Sender(show.port()) as send:
            send(SCENES[0])
            assert show.process.stdout is not None
            assert json.loads(show.process.stdout.readline())["contacts"], "flushed at once"
        show.process.send_signal(signal.SIGINT)
        status, lines = show.end()
        assert (status, lines) == (0, [])
        assert json.loads(show.errors[-1])["event"] == "end"
        assert len([line for line in show.errors if json.loads(line)["event"] != "warning"]) == 2


def test_a_terminal_shows_a_table_that_follows_the_touches() -> None:
    ours, theirs = pty.openpty()
    show = subprocess.Popen(
        [sys.executable, "-m", "sandbox.cli.main", "touches", "show", "--port", "0"],
        stdout=theirs,
        stderr=theirs,
        cwd=ROOT,
        env=os.environ | {"TERM": "xterm", "COLUMNS": "100"},
    )
    os.close(theirs)
    said = ""

    def read_until(pattern: str) -> re.Match[str]:
        nonlocal said
        while not (found := re.search(pattern, said)):
            said += os.read(ours, 65_536).decode()
        return found

    try:
        port = int(read_until(r"listening on 127\.0\.0\.1:(\d+)")[1])
        with Sender(port) as send:
            send(frame(1, {7: (0.5, 0.5)}, source="table"))
            read_until(r"7 +│ 3\.88 +│ 2\.91")
            read_until(r"table at 127\.0\.0\.1:\d+: 1 touch\b")
        show.send_signal(signal.SIGINT)
        assert show.wait(PATIENCE) == 0
    finally:
        show.kill()
        show.wait()
        os.close(ours)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["show", "--surface", "big"], "WIDTHxHEIGHT"),
        (["show", "--device", "no/such/file"], "no/such/file"),
        (["show", "--device", "pyproject.toml"], "pyproject.toml, line 1"),
        (["send", "pyproject.toml", "--to", "127.0.0.1:1"], "pyproject.toml, line 1"),
        (["send", "x"], "--tuio"),
        (["send", "--to", "127.0.0.1:1"], "no file"),
        (["send", "--to", "127.0.0.1:1", "--tuio", "127.0.0.1:1"], "--tuio HOST:PORT"),
        (["show", "--tuio-connect", "udp://127.0.0.1"], "tcp://HOST:PORT"),
        (["record", "pyproject.toml"], "not overwritten"),
    ],
    ids=str,
)
def test_bad_input_is_one_clear_message_and_status_2(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    status = main(["touches", *arguments])
    lines, errors = capsys.readouterr()
    assert status == 2
    assert lines == ""
    assert said in errors
    assert "Traceback" not in errors


@pytest.mark.parametrize("request_to_end", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_however_sending_is_ended_no_finger_stays_down_at_the_receiver(
    request_to_end: signal.Signals, as_without_nohup: None
) -> None:
    with receiver() as there:
        to, port = f"127.0.0.1:{there.getsockname()[1]}", free_port()
        with program(
            *("touches", "send", "--device", "tuio", "--port", str(port), "--tuio", to),
            *("--surface", "7.76x5.82in", "--stale-after", str(PATIENCE)),
        ) as it:
            it.error_line("sending TUIO")
            with Sender(port) as finger:
                alive: list[tuple[int, ...]] = [()]
                while not alive[-1]:
                    finger(frame(1, {1: (0.5, 0.5)}))
                    alive.append(alive_in(there))
            it.process.send_signal(request_to_end)
            status, _ = it.end()
            assert status == 0, it.errors
        there.settimeout(0.5)
        with contextlib.suppress(TimeoutError):
            while True:
                alive.append(alive_in(there))
    assert alive[-1] == ()


class Network(socket.socket):
    """A socket on a network that is away for one packet, or for good."""

    trouble = errno.ENETUNREACH

    def send(self, data: Any, flags: int = 0, /) -> int:
        if self.trouble:
            raise OSError(self.trouble, os.strerror(self.trouble))
        return super().send(data, flags)


def test_a_network_that_is_away_for_a_moment_does_not_end_the_sending() -> None:
    with receiver() as there, Network(socket.AF_INET, socket.SOCK_DGRAM) as channel:
        channel.connect(there.getsockname())
        assert send_packet(channel, b"lost", "it")
        channel.trouble = errno.EACCES
        with pytest.raises(DeviceError, match="cannot be sent"):
            send_packet(channel, b"refused", "it")
        channel.trouble = 0
        assert not send_packet(channel, b"heard", "it")
        assert there.recv(99) == b"heard"


def alive_in(there: socket.socket) -> tuple[int, ...]:
    """Fingers that are down according to the next packet, by python-osc's own reader."""
    for timed in OscPacket(there.recv(65_536)).messages:
        if timed.message.params[:1] == ["alive"]:
            return tuple(timed.message.params[1:])
    return ()
