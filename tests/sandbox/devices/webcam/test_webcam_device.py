"""The camera's page server, driven by a client in place of a browser."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from encoders.air.camera import Camera
from models.frames import LandmarkFrame
from models.plausible import JUMPED
from sandbox.devices.webcam.landmarks import message_of
from sandbox.devices.webcam.webcam import (
    CLOSED,
    ENDED,
    NOTICES,
    PATIENCE,
    REPLACED,
    WAITING,
    WebcamDevice,
)
from tests.encoders.air.seen_hands import film, held_up
from tests.support.processes import until


@cache
def picture() -> dict[str, Any]:
    """A message of the page."""
    return message_of(film([held_up()], Camera())[0])


@pytest.fixture
def engine(tmp_path: Path) -> Path:
    """A folder with a file in place of the engine, and one that is none of its kinds."""
    (tmp_path / "wasm").mkdir()
    (tmp_path / "wasm" / "engine.wasm").write_bytes(b"\0asm")
    (tmp_path / "secret.txt").write_text("not for pages")
    return tmp_path


@pytest.fixture
def device(engine: Path) -> Iterator[WebcamDevice]:
    device = WebcamDevice(engine, ("right",), mirrored=True)
    yield device
    device.close()


def page(device: WebcamDevice, **headers: str) -> ClientConnection:
    origin = device.address.partition("/?")[0]
    address = device.address.replace("http", "ws").replace("/?", "/landmarks?")
    return connect(address, additional_headers={"Origin": origin, **headers}, compression=None)


def test_a_page_is_told_what_is_wanted_and_its_pictures_come(device: WebcamDevice) -> None:
    assert device.notices == (WAITING,)
    with page(device) as socket:
        wanted = json.loads(socket.recv(timeout=5))
        assert wanted == {
            "what": "wanted",
            "sides": ["right"],
            "most": 2,
            "hands": 3,
            "mirrored": True,
            "marks": False,
        }
        socket.send(json.dumps(picture()))
        assert device.wait(5.0)
        (frame,) = device.poll(0.0)
        assert message_of(frame) == picture()
        assert device.poll(0.0) == () and device.notices == ()


def test_hands_that_the_engine_cannot_place_cost_no_page_and_no_other_hand(
    device: WebcamDevice,
) -> None:
    shown = [message_of(frame) for frame in film([held_up(2.0 * i) for i in range(60)], Camera())]
    lost = {"side": "left", "score": 0.9, "image": shown[0]["seen"][0]["image"], "world": None}
    frames: list[LandmarkFrame] = []
    with page(device) as socket:
        for i, message in enumerate(shown):
            seen = [lost] if i % 3 == 2 else [*message["seen"], lost]
            if i == 51:
                far = [[320 + 0.1 * x, 240 + 0.1 * y] for x, y in message["seen"][0]["image"]]
                seen = [{**message["seen"][0], "image": far}]
            socket.send(json.dumps({**message, "seen": seen}))
        until(lambda: frames.extend(device.poll(0.0)) or len(frames) == 40)
    assert len(frames) == 40 and sum(not frame.hands for frame in frames) == 1
    until(lambda: device.counts["pages closed"])
    assert device.report.left_out == {
        "hands that cannot be read": 39,
        "pictures that are not valid": 20,
        JUMPED: 1,
        "pages closed": 1,
    }


def test_corners_that_are_marked_in_the_page_are_kept(engine: Path) -> None:
    device = WebcamDevice(engine, marks=True)
    try:
        with page(device) as socket:
            assert json.loads(socket.recv(timeout=5))["marks"] is True
            marked = [[100.0, 80.0], [500.0, 90.0], [510.0, 400.0], [90.0, 390.0]]
            socket.send(json.dumps({"corners": marked}))
            until(lambda: device.corners)
            assert [list(c) for c in device.corners] == marked
            assert device.poll(0.0) == ()
    finally:
        device.close()


@pytest.mark.parametrize("trouble", sorted(NOTICES))
def test_a_trouble_of_the_page_is_told_at_the_session(device: WebcamDevice, trouble: str) -> None:
    with page(device) as socket:
        socket.send(json.dumps({"trouble": trouble}))
        until(lambda: device.notices == (NOTICES[trouble],))
        socket.send(json.dumps(picture()))
        until(lambda: device.notices == ())


def test_times_go_on_when_the_page_is_opened_again(device: WebcamDevice) -> None:
    # The clock of a page begins when it is loaded.
    for ended in (50.0, 0.5, 0.7):
        with page(device) as socket:
            for time_, taken in ((ended, ended - 0.1), (ended + 0.03, ended - 0.07)):
                socket.send(json.dumps({**picture(), "time": time_, "taken": taken}))
            until(lambda n=device.counts["pages closed"]: device.counts["pictures"] == 2 * n + 2)  # type: ignore[misc]
        until(lambda: device.notices == (CLOSED,))
    frames = device.poll(0.0)
    assert (frames[0].time, frames[0].taken) == (50.0, 49.9)
    assert all(a.time < b.time and a.taken <= b.taken for a, b in pairwise(frames))
    assert frames[-1].time - frames[0].time < 30.0


def test_a_second_page_takes_the_place_of_the_first(device: WebcamDevice) -> None:
    with page(device) as first, page(device) as second:
        first.recv(timeout=5)
        assert json.loads(first.recv(timeout=5)) == {"what": "bye", "why": REPLACED}
        second.send(json.dumps(picture()))
        assert device.wait(5.0)
    until(lambda: device.counts["pages closed"] == 1)


def test_the_page_is_told_when_the_session_is_over(device: WebcamDevice) -> None:
    with page(device) as socket:
        socket.recv(timeout=5)
        device.close()
        assert json.loads(socket.recv(timeout=5)) == {"what": "bye", "why": ENDED}
        with pytest.raises(ConnectionClosed):
            socket.recv(timeout=5)


def test_what_is_no_picture_is_counted_and_too_much_of_it_ends_the_page(
    device: WebcamDevice,
) -> None:
    with page(device) as socket:
        socket.recv(timeout=5)
        socket.send("nonsense")
        socket.send(json.dumps(picture()))
        assert device.wait(5.0)
        for _ in range(PATIENCE):
            socket.send(b"\xff")
        with pytest.raises(ConnectionClosed):
            socket.recv(timeout=5)
    assert device.server.counters["malformed message"] == PATIENCE + 1


def test_pictures_that_nobody_fetches_are_dropped_and_counted(
    device: WebcamDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sandbox.devices.webcam.webcam.KEPT", 3)
    with page(device) as socket:
        for i in range(5):
            socket.send(json.dumps({**picture(), "time": float(i)}))
        until(lambda: device.counts["pictures"] == 5)
    assert [f.time for f in device.poll(0.0)] == [2.0, 3.0, 4.0]
    assert device.counts["pictures nobody fetched"] == 2


@pytest.mark.parametrize(
    "headers", [{"Origin": "http://evil.example"}, {"Host": "evil.example:80"}]
)
def test_a_foreign_page_is_refused(device: WebcamDevice, headers: dict[str, str]) -> None:
    with pytest.raises(InvalidStatus):
        page(device, **headers).close()


def get(device: WebcamDevice, path: str, token: bool = True) -> tuple[bytes, dict[str, str]]:
    base, _, query = device.address.partition("/?")
    address = f"{base}{path}" + (f"?{query}" if token else "")
    with urlopen(Request(address), timeout=5) as answer:
        return answer.read(), dict(answer.headers)


def test_the_page_and_the_engine_are_served_and_may_load_nothing_from_elsewhere(
    device: WebcamDevice,
) -> None:
    body, headers = get(device, "/")
    assert device.server.access.token.encode() in body and b"{{" not in body
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy and "http:" not in policy and "*" not in policy
    assert get(device, "/webcam.js")[1]["Content-Type"].startswith("text/javascript")
    engine, headers = get(device, "/engine/wasm/engine.wasm")
    assert engine == b"\0asm" and headers["Content-Type"] == "application/wasm"


@pytest.mark.parametrize(
    ("path", "token", "status"),
    [
        ("/", False, 403),
        ("/engine/secret.txt", True, 404),
        ("/../webcam.py", True, 404),
    ],
)
def test_nothing_else_is_served(device: WebcamDevice, path: str, token: bool, status: int) -> None:
    with pytest.raises(HTTPError) as refused:
        get(device, path, token)
    assert refused.value.code == status
