"""The page's server: who may come, what counts, what is refused, and that a session goes on."""

from __future__ import annotations

import http.client
import json
import socket
import time
from collections.abc import Iterator
from dataclasses import dataclass
from urllib.parse import urlsplit

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from models.errors import DeviceError, InputError
from sandbox.assembly import build
from sandbox.devices.web import WebDevice
from sandbox.server.address import checked_address
from sandbox.server.describe import describe_scene
from sandbox.server.frames import unpack
from sandbox.server.kept_token import kept_token
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import CREDIT, Screen, Touches
from sandbox.server.senses import HandSense, press
from sandbox.server.skins import pack_skin
from sandbox.server.typescript import FILE, typescript
from sandbox.session import Session
from sandbox.settings import RunSettings
from tests.page_client import Page, open_socket
from tests.simulation import pinched


@dataclass
class Stage:
    """A server with a session on it that the test advances."""

    server: PageServer
    session: Session
    device: WebDevice

    def advance(self, steps: int = 1) -> None:
        for _ in range(steps):
            self.server.publish(self.session.advance())

    def open_scene(self, number: int) -> None:
        surface = self.session.rigs[0].reconstructor.surface
        message = describe_scene(
            number, self.session.scene, self.session.task, surface, "right", ""
        )
        self.server.show_scene(message, self.session.scene, self.device)


def wait_for(truth, seconds: float = 5.0) -> bool:
    end = time.monotonic() + seconds
    while not truth() and time.monotonic() < end:
        time.sleep(0.005)
    return bool(truth())


@pytest.fixture
def server() -> Iterator[PageServer]:
    server = PageServer()
    yield server
    server.close()


@pytest.fixture
def stage(server: PageServer) -> Stage:
    session = build(RunSettings(), lambda task, surface: WebDevice(surface, server.latency))
    device = session.rigs[0].device
    assert isinstance(device, WebDevice)
    stage = Stage(server, session, device)
    stage.open_scene(1)
    return stage


def get(url: str, path: str | None = None, **headers: str) -> http.client.HTTPResponse:
    parts = urlsplit(url)
    connection = http.client.HTTPConnection(parts.hostname or "", parts.port or 0, timeout=5)
    target = path if path is not None else f"{parts.path}?{parts.query}"
    connection.request("GET", target, headers=headers)
    return connection.getresponse()


def test_the_page_comes_with_the_token_and_may_load_nothing_from_elsewhere(server):
    answer = get(server.url)
    assert answer.status == 200
    assert b"<title>Hand Sandbox" in answer.read()
    assert "default-src 'self'" in answer.headers["Content-Security-Policy"]
    assert answer.headers["Referrer-Policy"] == "no-referrer"


@pytest.mark.parametrize(
    "path", ["/", "/index.html", "/?token=wrong", "/?token=", "/../pyproject.toml", "//", "/?token"]
)
def test_without_the_token_there_is_nothing(server, path):
    answer = get(server.url, path)
    assert answer.status == 403
    assert b"<" not in answer.read()
    assert server.counters["wrong token"] == 1


def test_with_the_token_there_is_still_nothing_outside_of_the_page(server):
    token = urlsplit(server.url).query
    for path in ("/../server/access.py", "/%2e%2e/server/access.py", "/etc/passwd"):
        assert get(server.url, f"{path}?{token}").status == 404


def test_a_rebound_name_and_a_foreign_page_are_refused(server):
    assert get(server.url, Host="evil.example:80").status == 403
    assert server.counters["wrong host"] == 1
    for origin in ("http://evil.example", "null", None):
        with pytest.raises(InvalidStatus) as refused, open_socket(server.url, origin):
            pass
        assert refused.value.response.status_code == 403
    assert server.counters["wrong origin"] == 3


def test_a_socket_with_a_wrong_token_is_refused(server):
    with pytest.raises(InvalidStatus), open_socket(server.url.replace("token=", "token=x")):
        pass
    assert server.counters["wrong token"] == 1


def test_tokens_of_two_servers_differ(server):
    other = PageServer()
    try:
        assert other.access.token != server.access.token
        assert len(other.access.token) >= 20
    finally:
        other.close()


def test_a_kept_token_is_the_same_and_for_this_user_alone(tmp_path):
    path = tmp_path / "new" / "page-token"
    token = kept_token(path)
    assert len(token) >= 20
    assert kept_token(path) == token
    assert path.stat().st_mode & 0o077 == 0
    path.chmod(0o644)
    with pytest.raises(InputError, match="others can read"):
        kept_token(path)
    path.chmod(0o600)
    path.write_text("short")
    with pytest.raises(InputError, match="no token"):
        kept_token(path)


def test_what_a_hand_presses_with_and_how_sure_its_labels_are_is_told(stage):
    with Page(stage.server.url) as page:
        page.until("scene")
        snapshot = stage.session.advance()
        stage.server.publish(snapshot)
        assert page.until("frame")["state"]["hands"][0]["probability"] == 1.0
        stage.server.publish(snapshot, senses=[HandSense((0.0, 1.5, 0.0, 0.0, 0.0), 0.25)])
        assert page.until("frame")["state"]["hands"][0]["probability"] == 0.25


def test_fingers_press_what_they_hold_and_nothing_else():
    scene, data, _ = pinched()
    forces = press(scene, data)[0]
    assert min(forces[:2]) > 0.1
    assert max(forces[2:]) == 0.0


def test_a_skin_comes_once_and_again_only_when_it_is_another(stage):
    skins = [pack_skin(hand) for hand in stage.session.scene.spec.hands]
    surface = stage.session.rigs[0].reconstructor.surface

    def show(number, skins):
        scene, task = stage.session.scene, stage.session.task
        message = describe_scene(number, scene, task, surface, "right", "")
        stage.server.show_scene(message, scene, stage.device, skins)

    with Page(stage.server.url) as page:
        for number, wanted in ((2, skins), (3, skins), (4, [b"\x01\x02other"])):
            show(number, wanted)
            page.until("scene", scene=number)
            stage.advance()
            page.until("frame")
    told = [m["bytes"] for m in page.skins]
    assert told == [skins[0], b"\x01\x02other"]
    names = json.loads(skins[0][16 : 16 + int.from_bytes(skins[0][2:4], "little")])
    bodies = [
        stage.session.scene.model.body(i).name for i in range(stage.session.scene.model.nbody)
    ]
    assert len(names) == 15
    assert set(names) <= set(bodies)


def test_a_touch_takes_effect_at_its_place_in_metres_and_the_frame_says_so(stage):
    with Page(stage.server.url) as page:
        page.until("scene")
        assert stage.server.wait_for_player(5.0)
        seq = page.touch((7, 2.0, 1.0))
        assert wait_for(lambda: stage.device.touched)
        stage.advance()
        frame = page.until("frame", touch=seq)
        contact = frame["state"]["hands"][0]["contacts"][0]
        assert contact["id"] == 7
        seen = stage.session.reconstructions[0].contacts[0].xy
        np.testing.assert_allclose(seen, [2.0 * 0.0254, 1.0 * 0.0254], atol=1e-9)


def test_a_frame_has_every_body_where_the_simulation_has_it(stage):
    with Page(stage.server.url) as page:
        scene = page.until("scene")
        stage.advance()
        frame = page.until("frame")
        assert len(scene["bodies"]) == stage.session.scene.model.nbody == len(frame["poses"])
        data, model = stage.session.data, stage.session.scene.model
        import mujoco

        mujoco.mj_kinematics(model, data)
        for i in range(model.nbody):
            np.testing.assert_allclose(frame["poses"][i][:3], data.xpos[i], atol=1e-6)
            np.testing.assert_allclose(frame["poses"][i][3:], data.xquat[i], atol=1e-6)


def test_both_readings_of_a_frame_agree(stage):
    with Page(stage.server.url) as page:
        page.until("scene")
        stage.advance()
        raw = page.socket.recv(timeout=5.0)
        assert isinstance(raw, bytes)
        frame = unpack(raw)
        assert (frame.scene, frame.number, frame.touch) == (1, 1, 0)
        assert frame.time == pytest.approx(stage.session.time)


def test_a_page_that_stops_reading_gets_no_stale_frames_afterwards(stage):
    with Page(stage.server.url) as page:
        page.until("scene")
        for _ in range(120):
            stage.advance()
            time.sleep(0.001)
        got = []
        while True:
            message = page.next()
            if message["type"] == "frame":
                got.append(message)
                page.say(type="got", frame=message["number"])
                if message["time"] == pytest.approx(stage.session.time):
                    break
        # What was on its way, and the present.
        assert len(got) <= CREDIT + 1


def test_a_lost_socket_takes_the_fingers_away_without_lifting_them(stage):
    page = Page(stage.server.url)
    page.until("scene")
    page.touch((1, 2.0, 2.0), (2, 3.0, 2.0))
    assert wait_for(lambda: stage.device.touched)
    stage.device.poll()
    page.close()
    assert wait_for(lambda: not stage.device.touched)
    frames = stage.device.poll()
    assert frames[-1].contacts == ()
    assert frames[-1].cancelled == {1, 2}


def test_a_page_that_falls_silent_loses_its_fingers(stage):
    with Page(stage.server.url) as page:
        page.until("scene")
        page.touch((1, 2.0, 2.0))
        assert wait_for(lambda: stage.device.touched)
        assert wait_for(lambda: not stage.device.touched)
        assert stage.server.counters["silent page"] == 1
        page.touch((1, 2.0, 2.0))
        assert wait_for(lambda: stage.device.touched)


def test_the_second_page_looks_on_and_plays_when_the_first_one_leaves(stage):
    first, second = Page(stage.server.url, "first"), Page(stage.server.url, "second")
    assert first.until("welcome")["role"] == "player"
    assert second.until("welcome")["role"] == "spectator"
    second.touch((1, 2.0, 2.0))
    assert wait_for(lambda: stage.server.counters["not the player"] == 1)
    assert not stage.device.touched
    first.close()
    assert second.until("welcome")["role"] == "player"
    second.touch((1, 2.0, 2.0))
    assert wait_for(lambda: stage.device.touched)
    second.close()


def test_a_reloaded_page_takes_its_own_seat_back_at_once(stage):
    old = Page(stage.server.url, "same")
    old.until("welcome", role="player")
    new = Page(stage.server.url, "same")
    assert new.until("welcome")["role"] == "player"
    with pytest.raises(ConnectionClosed) as closed:
        for _ in range(10):
            old.next()
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 4003
    new.close()


def test_a_page_of_another_version_is_told_so(stage):
    page = Page(stage.server.url, protocol=99)
    with pytest.raises(ConnectionClosed) as closed:
        page.next()
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 4001
    assert stage.server.counters["wrong version"] == 1


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "null",
        "[]",
        '{"type":"touches"}',
        '{"type":"touches","seq":1,"t":0,"contacts":[[1,NaN,0,0]]}',
        '{"type":"touches","seq":1,"t":0,"contacts":[[1,1e999,0,0]]}',
        '{"type":"touches","seq":1,"t":0,"contacts":[[1.5,0,0,0]]}',
        '{"type":"touches","seq":-1,"t":0,"contacts":[]}',
        '{"type":"touches","seq":1,"t":0,"contacts":[],"lift":2}',
        '{"type":"touches","seq":1,"t":0,"contacts":[],"surprise":1}',
        '{"type":"touches","seq":1,"t":0,"contacts":'
        + str([[i, 0, 0, 0] for i in range(21)])
        + "}",
        '{"type":"ask","what":"shutdown"}',
        "[" * 3000,
    ],
)
def test_a_malformed_message_is_counted_and_changes_nothing(stage, text):
    with Page(stage.server.url) as page:
        page.until("scene")
        page.socket.send(text)
        assert wait_for(lambda: stage.server.counters["malformed message"] == 1)
        seq = page.touch((1, 2.0, 2.0))
        assert wait_for(lambda: stage.device.touched)
        stage.advance()
        assert page.until("frame", touch=seq)


def test_an_oversized_message_ends_its_connection_and_no_other(stage):
    with Page(stage.server.url, "good") as page:
        page.until("scene")
        bad = Page(stage.server.url, "bad", role="spectator")
        bad.until("scene")
        bad.socket.send("x" * 20_000)
        with pytest.raises(ConnectionClosed) as closed:
            for _ in range(10):
                bad.next()
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 1009
        seq = page.touch((1, 2.0, 2.0))
        assert wait_for(lambda: stage.device.touched)
        stage.advance()
        assert page.until("frame", touch=seq)


def test_a_flood_is_refused_counted_and_ended(stage):
    with Page(stage.server.url, "flood") as page:
        page.until("scene")
        with pytest.raises(ConnectionClosed):
            for _ in range(5000):
                page.say(type="beat", t=0)
            for _ in range(5000):
                page.next()
        assert stage.server.counters["too many messages"] > 100
    assert wait_for(lambda: stage.server.clients == 0)


def test_more_pages_than_there_is_room_for_are_turned_away(stage):
    pages = [Page(stage.server.url, str(i)) for i in range(8)]
    for page in pages:
        page.until("welcome")
    with pytest.raises(ConnectionClosed) as closed, open_socket(stage.server.url) as late:
        late.recv(timeout=5.0)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 4002
    assert stage.server.counters["too many clients"] == 1
    for page in pages:
        page.close()


def test_bytes_that_are_no_handshake_are_counted_and_hurt_nobody(stage):
    for garbage in (b"\x00" * 64, b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 400 + b"\r\n", b"\r\n\r\n"):
        with socket.create_connection((stage.server.access.host, stage.server.access.port)) as raw:
            raw.sendall(garbage)
            raw.settimeout(5.0)
            assert b"200" not in raw.recv(200)
    assert wait_for(lambda: stage.server.counters["failed handshake"] >= 2)
    with Page(stage.server.url) as page:
        page.until("welcome")


def test_a_port_that_is_taken_is_one_clear_error(server):
    with pytest.raises(DeviceError, match="cannot be served"):
        PageServer(port=server.access.port)


@pytest.mark.parametrize("text", ["0.0.0.0", "::", "tablet", "1.2.3", ""])
def test_no_address_means_all_of_them(text):
    with pytest.raises(DeviceError):
        checked_address(text)


def test_the_pages_types_are_those_of_the_server():
    assert FILE.read_text() == typescript()


def _touches(*contacts: tuple[int, float, float, float], **more) -> Touches:
    return Touches(1, 0.0, list(contacts), **more)


SCREEN = Screen(100.0, 1000.0, 800.0, True)


def test_a_touch_beside_the_rectangle_is_none_and_a_dragged_one_stays_at_its_border():
    device = WebDevice(RunSettings().surface)
    width = device._size[0] / 0.0254 * 100
    device.push(_touches((1, -5.0, 10.0, 0.0)), SCREEN)
    device.push(_touches((1, -5.0, 10.0, 0.0), (2, 50.0, 10.0, 30.0)), SCREEN)
    device.push(_touches((2, width + 80, 10.0, 30.0)), SCREEN)
    first, second, third = device.poll()
    assert first.contacts == ()
    assert [c.id for c in second.contacts] == [2]
    assert second.contacts[0].size == pytest.approx(30.0 / 100 * 0.0254)
    assert third.contacts[0].x == pytest.approx(device._size[0])


def test_a_cancelled_finger_is_told_apart_from_a_lifted_one():
    device = WebDevice(RunSettings().surface)
    device.push(_touches((1, 50, 50, 0), (2, 90, 50, 0)), SCREEN)
    device.push(_touches(cancelled=[1, 99]), SCREEN)
    assert device.poll()[-1].cancelled == {1}


def test_the_lift_control_stays_where_it_was_while_a_message_does_not_tell():
    device = WebDevice(RunSettings().surface)
    device.push(_touches(lift=0.4), SCREEN)
    device.push(_touches(), SCREEN)
    assert [frame.lift for frame in device.poll()] == [0.4, 0.4]


def test_of_two_contacts_with_one_id_the_first_counts():
    device = WebDevice(RunSettings().surface)
    device.push(_touches((1, 50, 50, 0), (1, 90, 50, 0)), SCREEN)
    (frame,) = device.poll()
    assert len(frame.contacts) == 1
