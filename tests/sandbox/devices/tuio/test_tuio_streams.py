"""TUIO over TCP and WebSockets: the same frames come out, and who hangs up takes nothing along."""

from __future__ import annotations

import asyncio
import contextlib
import random
import socket
import struct
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect
from websockets.sync.server import ServerConnection, serve

from models.errors import DeviceError, RecordingError
from models.surface import Surface
from sandbox.devices.tuio import tuio_streams
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.devices.tuio.tuio_streams import MAX_CONNECTIONS, parse_target, refusal
from tests.support.processes import PATIENCE, Sender, until
from tests.support.tuio_packets import NO_OSC, frame, frame20
from tests.support.tuio_table import A, B, next_frames


def framed(*packets: bytes) -> bytes:
    """As TCP carries them: a length before each."""
    return b"".join(struct.pack(">I", len(packet)) + packet for packet in packets)


@pytest.fixture
def device() -> Iterator[TuioDevice]:
    with TuioDevice(
        Surface(), port=0, transport="all", websocket_port=0, stale_after=1e6
    ) as opened:
        yield opened


def tcp(device: TuioDevice) -> socket.socket:
    return socket.create_connection(("127.0.0.1", device.port), PATIENCE)


def web(device: TuioDevice, **settings: Any) -> ClientConnection:
    url = f"ws://127.0.0.1:{device.websocket_port}"
    return connect(url, proxy=None, **settings)


def test_all_transports_at_once_share_the_surface(device: TuioDevice) -> None:
    with Sender(device.port) as udp, tcp(device) as stream, web(device) as page:
        udp(frame(1, {1: A}, source="s"))
        next_frames(device, 1)
        stream.sendall(framed(frame(1, {1: B}, source="s")))
        next_frames(device, 1)
        page.send(frame20(1, {1: (0.5, 0.5)}))
        (all_of_them,) = next_frames(device, 1)
        assert len(all_of_them.contacts) == 3
        kinds = [source.peer.split()[0] for source in device.sources]
        assert kinds[1:] == ["tcp", "ws"]


def test_packets_in_a_stream_may_be_cut_anywhere(device: TuioDevice) -> None:
    packets = [frame(n, {1: (n / 64, 0.5)}) for n in range(1, 21)]
    stream_of_bytes = framed(*packets)
    with tcp(device) as stream:
        stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for n in range(0, len(stream_of_bytes), 7):
            stream.sendall(stream_of_bytes[n : n + 7])
        frames = next_frames(device, 20)
    width = float(Surface().size[0])
    assert [f.contacts[0].x / width for f in frames] == pytest.approx(
        [n / 64 for n in range(1, 21)]
    )


Speak = Callable[[bytes], None]
Hang = Callable[[], None]


@contextlib.contextmanager
def caller(device: TuioDevice, kind: str) -> Iterator[tuple[Speak, Hang]]:
    """How a sender of a kind sends a packet, and how it hangs up."""
    if kind == "udp":
        with Sender(device.port) as udp:
            yield udp, lambda: None
    elif kind == "tcp":
        with tcp(device) as stream:
            yield lambda data: stream.sendall(framed(data)), stream.close
    else:
        with web(device) as page:
            yield page.send, page.close


@pytest.mark.parametrize("kind", ["udp", "tcp", "websocket"])
def test_a_recorder_whose_disk_is_full_is_heard_of_at_once(kind: str) -> None:
    full = RecordingError("the capture cannot be written", got="No space left on device")
    kept: list[bytes | None] = []

    def tap(now: float, peer: str, data: bytes | None) -> None:
        if len(kept) == 2:
            raise full
        kept.append(data)

    def disk_is_full() -> bool:
        """Polls as a recording does, while packets go on to come."""
        speak(frame(len(kept) + 1, {1: A}))
        try:
            device.poll()
        except RecordingError as error:
            return error is full
        return False

    with (
        TuioDevice(Surface(), port=0, transport="all", websocket_port=0, tap=tap) as device,
        caller(device, kind) as (speak, _),
    ):
        until(disk_is_full)
        assert len(kept) == 2


@pytest.mark.parametrize("kind", ["tcp", "websocket"])
def test_who_hangs_up_has_his_touches_cancelled_and_nobody_elses(
    device: TuioDevice, kind: str
) -> None:
    with Sender(device.port) as udp, caller(device, kind) as (speak, hang_up):
        udp(frame(1, {1: A}, source="stays"))
        next_frames(device, 1)
        speak(frame(1, {1: B, 2: (0.5, 0.5)}, source="goes"))
        (three,) = next_frames(device, 1)
        hang_up()
        (left,) = next_frames(device, 1)
        assert [c.id for c in left.contacts] == [1]
        assert left.cancelled == {c.id for c in three.contacts} - {1}
        assert len(left.cancelled) == 2
        assert [source.name for source in device.sources] == ["stays"]


@pytest.mark.parametrize("kind", ["udp", "tcp", "websocket"])
def test_malformed_packets_are_counted_and_the_connection_lives(
    device: TuioDevice, kind: str
) -> None:
    odd = [data for data in NO_OSC.values() if data]
    with caller(device, kind) as (speak, _):
        for data in odd:
            speak(data)
        speak(frame(1, {1: A}))
        (shown,) = next_frames(device, 1)
        assert len(shown.contacts) == 1
    assert device.statistics.malformed == len(odd)


@pytest.mark.parametrize("length", [0, 65_508, 2**32 - 1])
def test_a_stream_with_an_impossible_length_is_ended(device: TuioDevice, length: int) -> None:
    with tcp(device) as stream:
        stream.sendall(framed(frame(1, {1: A})) + struct.pack(">I", length))
        assert stream.recv(1) == b""
        down, up = next_frames(device, 2)
        assert up.cancelled == {c.id for c in down.contacts}
    assert device.statistics.malformed == 1
    assert str(length) in device.statistics.malformed_reason


def test_a_text_or_a_huge_message_on_a_websocket_is_counted(device: TuioDevice) -> None:
    with web(device) as page:
        page.send("hello")
        page.send(frame(1, {1: A}))
        next_frames(device, 1)
        with contextlib.suppress(ConnectionClosed):
            page.send(b"\x00" * 70_000)
            page.recv(PATIENCE)
    until(lambda: device.statistics.malformed == 2)
    assert "too large" in device.statistics.malformed_reason


@pytest.mark.parametrize(
    ("hosts", "origins", "reason"),
    [
        (["127.0.0.1:8080"], [], ""),
        (["localhost:8080"], ["http://localhost:5173"], ""),
        (["192.168.1.20:8080"], ["http://192.168.1.20"], ""),
        (["rebound.example:8080"], [], "host"),
        ([], [], "host"),
        (["[:8080"], [], "host"),
        (["127.0.0.1:8080"], ["https://example.com"], "origin"),
        (["127.0.0.1:8080"], ["null"], "origin"),
        (["127.0.0.1:8080"], ["http://127.0.0.1", "http://127.0.0.1"], "origin"),
        (["192.168.1.20:8080"], ["http://192.168.1.21"], "origin"),
    ],
)
def test_only_programs_and_pages_of_this_machine_may_open_a_websocket(
    hosts: list[str], origins: list[str], reason: str
) -> None:
    assert reason in refusal(hosts, origins)
    assert bool(refusal(hosts, origins)) == bool(reason)


def test_a_foreign_page_is_refused_and_counted(device: TuioDevice) -> None:
    with pytest.raises(InvalidStatus):
        web(device, origin="https://example.com")
    assert device.statistics.refused == 1
    assert "origin" in device.statistics.refused_reason
    with web(device, origin=f"http://127.0.0.1:{device.websocket_port}") as page:
        page.send(frame(1, {1: A}))
        next_frames(device, 1)


def test_connections_that_fell_asleep_make_room_for_a_new_one(
    device: TuioDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    with contextlib.ExitStack() as stack:
        asleep = [stack.enter_context(tcp(device)) for _ in range(MAX_CONNECTIONS)]
        for n, stream in enumerate(asleep):
            stream.sendall(framed(frame(1, {}, source=str(n))))
        next_frames(device, MAX_CONNECTIONS)
        monkeypatch.setattr(tuio_streams, "SILENT", 0.0)
        newcomer = stack.enter_context(tcp(device))
        newcomer.sendall(framed(frame(1, {1: A}, source="new")))
        assert next_frames(device, 1)[-1].contacts
        assert asleep[0].recv(1) == b"" and not device.statistics.refused


def test_connections_beyond_the_limit_are_refused_and_the_others_go_on(device: TuioDevice) -> None:
    with contextlib.ExitStack() as stack:
        streams = [stack.enter_context(tcp(device)) for _ in range(MAX_CONNECTIONS)]
        for n, stream in enumerate(streams):
            stream.sendall(framed(frame(1, {1: A}, source=f"s{n}")))
        next_frames(device, MAX_CONNECTIONS)
        surplus = stack.enter_context(tcp(device))
        assert surplus.recv(1) == b""
        with pytest.raises(InvalidStatus):
            web(device)
        assert device.statistics.refused == 2
        streams[0].sendall(framed(frame(2, {}, source="s0")))
        next_frames(device, 1)


def test_a_tcp_sender_that_waits_is_called_and_called_again() -> None:
    with socket.create_server(("127.0.0.1", 0)) as waiting:
        waiting.settimeout(PATIENCE)
        port = waiting.getsockname()[1]
        with TuioDevice(Surface(), connect=f"tcp://127.0.0.1:{port}") as device:
            for n in range(2):
                line, _ = waiting.accept()
                with line:
                    line.sendall(framed(frame(1 + n, {1: A})))
                    assert len(next_frames(device, 1)[0].contacts) == 1
                assert next_frames(device, 1)[0].cancelled
            assert device.address == f"tcp://127.0.0.1:{port}"


def test_a_websocket_sender_that_waits_is_called() -> None:
    def answer(connection: ServerConnection) -> None:
        connection.send(frame20(7, {1: A}))
        with contextlib.suppress(ConnectionClosed):
            connection.recv()

    with serve(answer, "127.0.0.1", 0) as waiting:
        thread = threading.Thread(target=waiting.serve_forever)
        thread.start()
        port = waiting.socket.getsockname()[1]
        with TuioDevice(Surface(), connect=f"ws://127.0.0.1:{port}") as device:
            assert len(next_frames(device, 1)[0].contacts) == 1
        waiting.shutdown()
        thread.join()


@pytest.mark.parametrize(
    "text", ["", "127.0.0.1:3333", "udp://127.0.0.1:3333", "tcp://", "tcp://h:0", "ws://h:99999"]
)
def test_what_cannot_be_called_is_refused_at_once(text: str) -> None:
    with pytest.raises(DeviceError, match="HOST:PORT"):
        parse_target(text)


def test_a_port_that_is_taken_is_refused_and_gives_back_the_others() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        for transport, ports in (("tcp", (port, 0)), ("all", (0, port)), ("websocket", (0, port))):
            with pytest.raises(DeviceError, match="cannot be listened on"):
                TuioDevice(
                    Surface(),
                    transport=transport,  # type: ignore[arg-type]
                    port=ports[0],
                    websocket_port=ports[1],
                )
    threads = [t for t in threading.enumerate() if t.name.startswith("tuio")]
    assert not threads


CROWDED = """
import resource, socket, sys

sys.path[:0] = {path!r}
from models.surface import Surface
from sandbox.devices.tuio import tuio_streams
from sandbox.devices.tuio.tuio import TuioDevice

most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
resource.setrlimit(resource.RLIMIT_NOFILE, (min(most, 30_000), most))
taken = []
for port in range(32769, 61000, 2):
    try:
        taken.append(socket.socket())
        taken[-1].bind(("127.0.77.1", port))
    except OSError:
        break
for _ in range(30):
    with TuioDevice(
        Surface(), bind="127.0.77.1", port=0, transport="all", websocket_port=0
    ) as device:
        assert device.transports.startswith("UDP, TCP, WebSocket")
print("always found")
"""
"""At an address that nobody else uses, up to half of all ports are taken for TCP, not for UDP."""


def test_a_port_that_the_system_chooses_is_free_for_udp_and_tcp() -> None:
    run = [sys.executable, "-c", CROWDED.format(path=sys.path)]
    done = subprocess.run(run, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("always found\n", "")


def test_a_closed_device_leaves_nothing_behind() -> None:
    device = TuioDevice(Surface(), port=0, transport="all", websocket_port=0)
    with tcp(device) as stream:
        stream.sendall(framed(frame(1, {1: A})))
        until(lambda: device.statistics.frames == 1)
        device.close()
        device.close()
        assert stream.recv(1) == b""
    while device.poll():
        pass
    assert device.finished
    assert not [t for t in threading.enumerate() if t.name.startswith("tuio")]
    with contextlib.suppress(RuntimeError):
        assert not asyncio.all_tasks()


def test_noise_on_connections_does_no_harm_to_those_who_speak(device: TuioDevice) -> None:
    rng = random.Random(12)
    with tcp(device) as good:
        for n in range(150):
            with tcp(device) as bad:
                match n % 4:
                    case 0:
                        bad.sendall(rng.randbytes(rng.randrange(200)))
                    case 1:  # a packet that never ends
                        bad.sendall(struct.pack(">I", 400) + rng.randbytes(rng.randrange(400)))
                    case 2:
                        bad.sendall(framed(rng.randbytes(4 * rng.randrange(1, 40))))
                    case _:
                        pass  # comes and goes
            with socket.create_connection(("127.0.0.1", device.websocket_port), PATIENCE) as odd:
                odd.sendall(rng.choice((b"", b"GET / HTTP/1.1\r\n\r\n", rng.randbytes(60))))
            good.sendall(framed(frame(n + 1, {1: (n / 256, 0.5)}, source="good")))
            until(lambda n=n: seen(device, n / 256 * float(Surface().size[0])))  # type: ignore[misc]
    until(lambda: not device.sources)
    assert not device.finished


def seen(device: TuioDevice, x: float) -> bool:
    return any(abs(c.x - x) < 1e-9 for f in device.poll() for c in f.contacts)
