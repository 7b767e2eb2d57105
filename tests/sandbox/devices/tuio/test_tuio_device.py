"""The TUIO device over real sockets: every frame comes out, and nothing from outside harms it."""

from __future__ import annotations

import socket

import pytest

from models.errors import DeviceError
from models.frames import TouchFrame
from models.surface import METRES_PER_INCH, Surface
from sandbox.cli.touches.command import missing_frames_hint
from sandbox.devices.tuio import Transport
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.trial.assembly import device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.registry import find_task
from tests.support.processes import Sender, until
from tests.support.tuio_packets import frame
from tests.support.tuio_table import A, next_frames


def test_every_frame_comes_out_once_in_order_and_in_metres() -> None:
    surface = Surface(10.0, 5.0)
    with TuioDevice(surface, port=0) as device, Sender(device.port) as send:
        frames: list[TouchFrame] = []
        for n in range(300):
            send(frame(n + 1, {5: (n / 512, 0.5)}, source="table"))
            frames += device.poll()
        frames += next_frames(device, 300 - len(frames))
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


def test_the_touches_of_a_silent_sender_are_lifted_and_it_is_marked() -> None:
    with TuioDevice(Surface(), port=0, stale_after=0.2) as device, Sender(device.port) as send:
        send(frame(1, {1: A}, source="app"))
        down, up = next_frames(device, 2)
        assert (len(down.contacts), len(up.contacts)) == (1, 0)
        assert up.time - down.time >= 0.2
        assert up.cancelled == frozenset(), "they count as lifted, not as taken away"
        assert [(source.name, source.stale) for source in device.sources] == [("app", True)]
        send(frame(2, {}, alive=[1]))
        assert [c.id for c in next_frames(device, 1)[0].contacts] == [1]


def test_the_real_port_is_told_and_nobody_else_can_have_it() -> None:
    with TuioDevice(Surface(), port=0) as device:
        assert device.address == f"127.0.0.1:{device.port}"
        assert device.port > 0
        with pytest.raises(DeviceError, match="--port"):
            TuioDevice(Surface(), port=device.port)


@pytest.mark.parametrize("transport", ["udp", "tcp", "websocket", "all"])
def test_every_port_that_people_are_told_is_one_at_which_it_listens(transport: Transport) -> None:
    ours = {"port": 0, "transport": transport, "websocket_port": 0}
    with TuioDevice(Surface(), bind="0.0.0.0", **ours) as device:  # type: ignore[arg-type]
        assert device.address == f"0.0.0.0:{device.announced_port}" and device.announced_port > 0
        assert f"port {device.announced_port}" in missing_frames_hint(device)
        kind = socket.SOCK_DGRAM if transport == "udp" else socket.SOCK_STREAM
        with socket.socket(socket.AF_INET, kind) as other, pytest.raises(OSError):
            other.bind(("0.0.0.0", device.announced_port))


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
    until(lambda: not device._thread.is_alive())
    assert len(device.poll()) == 1, "what came before is not lost"
    assert device.wait(0.0), "there is something to hear from poll"
    assert not device.finished, "what has failed has not ended before it said so"
    with pytest.raises(DeviceError, match="listening for touches has failed"):
        device.poll()
    assert device.finished
    device.close()


@pytest.mark.parametrize("transport", ["udp", "websocket"])
def test_two_hands_have_ports_one_after_the_other(transport: Transport) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        port = taken.getsockname()[1]
    ports = {"tuio_transport": transport, "port": port, "websocket_port": port}
    chosen = trial_settings(TrialOptions(device="tuio", second_device="tuio", device_options=ports))
    task = find_task("box-to-goal").draw(0, Surface())
    devices = [make(task, Surface()) for make in device_makers(chosen)]
    try:
        assert [d.address for d in devices] == [f"127.0.0.1:{port}", f"127.0.0.1:{port + 1}"]
    finally:
        for device in devices:
            device.close()
