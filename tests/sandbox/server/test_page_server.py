"""The page's server: who may come, what counts, what is refused, and that a session goes on."""

from __future__ import annotations

import base64
import hashlib
import http.client
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from urllib.parse import urlsplit

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from models.errors import DeviceError
from models.frames import TouchFrame
from sandbox.server import clients
from sandbox.server.clients import MOST_QUEUED
from sandbox.server.page_frames import describe_scene
from sandbox.server.page_options import checked_address
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import CREDIT
from sandbox.server.server_thread import GREETING
from sandbox.server.web import WebDevice
from sandbox.session.session import Session
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings
from tests.support.page_client import Page, open_socket
from tests.support.processes import PATIENCE
from tools.page_types import FILE, typescript


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


def wait_for(truth: Callable[[], object], seconds: float = PATIENCE) -> bool:
    end = time.monotonic() + seconds
    while not (found := truth()) and time.monotonic() < end:
        time.sleep(0.005)
    return bool(found)


def opened(server: PageServer) -> Stage:
    """A stage with its first scene."""
    session = build(Settings(), (lambda task, surface: WebDevice(surface),))
    device = session.rigs[0].device
    assert isinstance(device, WebDevice)
    stage = Stage(server, session, device)
    stage.open_scene(1)
    return stage


def code_of_end(page: Page) -> int:
    """How the server ends the connection of a page: the close code."""
    with pytest.raises(ConnectionClosed) as closed:
        for _ in range(10):
            page.next()
    assert closed.value.rcvd is not None
    return closed.value.rcvd.code


def get(url: str, path: str | None = None, **headers: str) -> http.client.HTTPResponse:
    parts = urlsplit(url)
    connection = http.client.HTTPConnection(parts.hostname or "", parts.port or 0, timeout=PATIENCE)
    target = path if path is not None else f"{parts.path}?{parts.query}"
    connection.request("GET", target, headers=headers)
    return connection.getresponse()


def test_the_page_comes_with_the_token_and_may_load_nothing_from_elsewhere(
    server: PageServer,
) -> None:
    answer = get(server.url)
    assert answer.status == 200
    assert b"<title>Hand Sandbox" in answer.read()
    assert "default-src 'self'" in answer.headers["Content-Security-Policy"]
    assert answer.headers["Referrer-Policy"] == "no-referrer"


@pytest.mark.parametrize(
    "path",
    [
        "/index.html",
        "/app.js",
        "/app.css",
        "/return.html",
        "/?",
        "/?role=player",
        "/?role=spectator&token=",
        "/?role=spectator#",
        "/?token=wrong",
        "/?token=",
        "/../pyproject.toml",
        "//",
        "/?token",
        "/?token=TOKEN&token=x",
        "/?token=x&token=TOKEN",
    ],
)
def test_without_the_token_there_is_nothing(server: PageServer, path: str) -> None:
    answer = get(server.url, path.replace("TOKEN", server.access.token))
    assert answer.status == 403
    assert b"<" not in answer.read()
    assert server.counters["wrong token"] == 1


@pytest.mark.parametrize("path", ["/", "/?role=spectator"])
def test_without_a_token_there_is_only_a_page_that_knows_nothing(
    server: PageServer, path: str
) -> None:
    before = get(server.url, path)
    body = before.read()
    assert before.status == 200
    assert server.access.token.encode() not in body
    # It may run its own script alone, and neither load nor send anything.
    policy = before.headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    script = body.partition(b"<script>")[2].partition(b"</script>")[0]
    digest = base64.b64encode(hashlib.sha256(script).digest()).decode()
    assert f"script-src 'sha256-{digest}';" in policy
    assert before.headers["Cache-Control"] == "no-store"
    assert before.headers["Referrer-Policy"] == "no-referrer"
    # It says nothing about the session: it is the same while somebody plays, and elsewhere.
    opened(server)
    with Page(server.url) as page:
        page.until("scene")
        assert get(server.url, path).read() == body
    other = PageServer()
    try:
        assert get(other.url, path).read() == body
    finally:
        other.close()
    assert server.counters.as_dict() == {"request without a token": 2}


def test_with_the_token_there_is_still_nothing_outside_of_the_page(server: PageServer) -> None:
    token = urlsplit(server.url).query
    for path in ("/../server/access.py", "/%2e%2e/server/access.py", "/etc/passwd"):
        assert get(server.url, f"{path}?{token}").status == 404


def test_a_rebound_name_and_a_foreign_page_are_refused(server: PageServer) -> None:
    assert get(server.url, Host="evil.example:80").status == 403
    assert server.counters["wrong host"] == 1
    for origin in ("http://evil.example", "null", None):
        with pytest.raises(InvalidStatus) as refused, open_socket(server.url, origin):
            pass
        assert refused.value.response.status_code == 403
    assert server.counters["wrong origin"] == 3


def test_a_touch_takes_effect_at_its_place_in_metres_and_the_frame_says_so(stage: Stage) -> None:
    with Page(stage.server.url) as page:
        page.until("scene")
        assert stage.server.wait_for_player(5.0)
        seq = page.touch((7, 2.0, 1.0))
        assert wait_for(lambda: stage.device.touched)
        stage.advance()
        frame = page.until("frame", touch=seq)
        contact = frame["state"]["hands"][0]["contacts"][0]
        assert contact["id"] == 7
        seen = stage.session.reconstructions[0].contacts[0]
        np.testing.assert_allclose([seen.x, seen.y], [2.0 * 0.0254, 1.0 * 0.0254], atol=1e-9)


def test_a_frame_has_every_body_where_the_simulation_has_it(stage: Stage) -> None:
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


def test_a_page_that_stops_reading_gets_no_stale_frames_afterwards(stage: Stage) -> None:
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


def test_a_lost_socket_takes_the_fingers_away_without_lifting_them(stage: Stage) -> None:
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


def test_the_second_page_looks_on_and_plays_once_the_first_ones_seat_is_free(
    stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clients, "SEAT_TIMEOUT", 0.5)
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


def test_a_reloaded_page_takes_its_own_seat_back_at_once(stage: Stage) -> None:
    old = Page(stage.server.url, "same")
    old.until("welcome", role="player")
    new = Page(stage.server.url, "same")
    assert new.until("welcome")["role"] == "player"
    assert code_of_end(old) == 4003
    new.close()


def test_a_page_of_another_version_is_told_so(stage: Stage) -> None:
    assert code_of_end(Page(stage.server.url, protocol=99)) == 4001
    assert stage.server.counters["wrong version"] == 1


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "null",
        "[]",
        '{"type":"touches"}',
        '{"type":"touches","seq":1,"t":0,"contacts":[[1,NaN,0,0,0]]}',
        '{"type":"touches","seq":1,"t":0,"contacts":[[1,1e999,0,0,0]]}',
        '{"type":"touches","seq":1,"t":0,"contacts":[[1.5,0,0,0,0]]}',
        '{"type":"touches","seq":-1,"t":0,"contacts":[]}',
        '{"type":"touches","seq":1,"t":0,"contacts":[],"lift":"up"}',
        '{"type":"touches","seq":1,"t":0,"contacts":[],"surprise":1}',
        '{"type":"touches","seq":1,"t":0,"contacts":'
        + str([[i, 0, 0, 0] for i in range(21)])
        + "}",
        '{"type":"ask","what":"shutdown"}',
        "[" * 3000,
    ],
)
def test_a_malformed_message_is_counted_and_changes_nothing(stage: Stage, text: str) -> None:
    with Page(stage.server.url) as page:
        page.until("scene")
        page.socket.send(text)
        assert wait_for(lambda: stage.server.counters["malformed message"] == 1)
        seq = page.touch((1, 2.0, 2.0))
        assert wait_for(lambda: stage.device.touched)
        stage.advance()
        assert page.until("frame", touch=seq)


def test_an_oversized_message_ends_its_connection_and_no_other(stage: Stage) -> None:
    with Page(stage.server.url, "good") as page:
        page.until("scene")
        bad = Page(stage.server.url, "bad", role="spectator")
        bad.until("scene")
        bad.socket.send("x" * 20_000)
        assert code_of_end(bad) == 1009
        seq = page.touch((1, 2.0, 2.0))
        assert wait_for(lambda: stage.device.touched)
        stage.advance()
        assert page.until("frame", touch=seq)


def test_a_flood_is_refused_counted_and_ended(stage: Stage) -> None:
    with Page(stage.server.url, "flood") as page:
        page.until("scene")
        with pytest.raises(ConnectionClosed):
            for _ in range(5000):
                page.say(type="beat", t=0)
            for _ in range(5000):
                page.next()
        assert stage.server.counters["too many messages"] > 100
    assert wait_for(lambda: stage.server.clients == 0)


def test_all_that_a_page_said_during_stalls_of_its_network_is_heard(stage: Stage) -> None:
    with Page(stage.server.url) as page:
        page.until("scene")
        # Two stalls of 3.5 s: what an eager tablet at 120 Hz has said meanwhile comes at once.
        for _ in range(2):
            for _ in range(420):
                page.touch((1, 2.0, 2.0))
        page.touch()
        page.answered()
        assert not stage.device.touched and not stage.server.counters["too many messages"]


def test_a_finger_whose_lift_was_among_too_many_messages_does_not_stay_down(
    stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    # So that the result does not depend on how fast this machine sends.
    monkeypatch.setattr(clients, "MESSAGES_PER_SECOND", 1.0)
    with Page(stage.server.url) as page:
        page.until("scene")
        for _ in range(int(clients.BURST) + 50):
            page.touch((1, 2.0, 2.0))
        page.touch()
        assert wait_for(lambda: stage.server.counters["too many messages"] > 20)
        # Beats say that the page is there, so that its fingers are not taken for gone.
        for _ in range(10):
            time.sleep(0.1)
            page.say(type="beat", t=1)
        assert not stage.device.touched and not stage.server.counters["silent page"]
        time.sleep(1.5)
        page.touch((2, 2.0, 2.0))
        assert wait_for(lambda: stage.device.touched)


def test_requests_that_nobody_reads_do_not_fill_the_memory(stage: Stage) -> None:
    with Page(stage.server.url) as page:
        page.until("scene")
        for _ in range(MOST_QUEUED + 50):
            page.say(type="ask", what="retry")
        page.answered()
        assert len(stage.server.take_requests()) == MOST_QUEUED
        assert stage.server.counters["input to a full queue"] == 50
        page.say(type="ask", what="retry")
        page.answered()
        assert len(stage.server.take_requests()) == 1


def test_seven_spectators_leave_room_for_the_player_who_comes_and_comes_back(stage: Stage) -> None:
    pages = [Page(stage.server.url, str(i), role="spectator") for i in range(7)]
    for page in pages:
        page.until("welcome", role="spectator")
    # The second time, nobody has noticed yet that the first socket is dead.
    for player in (Page(stage.server.url, "tablet"), Page(stage.server.url, "tablet")):
        assert player.until("welcome")["role"] == "player"
        pages.append(player)
        for role in ("player", "spectator"):
            with Page(stage.server.url, "x", role) as x:
                assert code_of_end(x) == 4002
    player.close()
    assert wait_for(lambda: stage.server.clients == 7)
    # Nor does anybody take the seat while it is empty.
    with pytest.raises(ConnectionClosed), Page(stage.server.url, "other") as other:
        other.next()
    with Page(stage.server.url, "tablet") as back:
        assert back.until("welcome")["role"] == "player"
    for page in pages:
        page.close()


def test_a_hidden_page_is_away_at_once_and_gives_up_its_seat_to_who_waits(
    stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Page(stage.server.url, "first") as first:
        first.until("welcome", role="player")
        assert not stage.server.away
        first.say(type="presence", here=False)
        assert wait_for(lambda: stage.server.away)
        first.say(type="presence", here=True)
        assert wait_for(lambda: not stage.server.away)
        first.say(type="presence", here=False)
        with Page(stage.server.url, "second") as second:
            assert second.until("welcome")["role"] == "spectator"
            monkeypatch.setattr(clients, "SEAT_TIMEOUT", 0.3)
            assert second.until("welcome")["role"] == "player"
            assert first.until("welcome")["role"] == "spectator"
            assert not stage.server.away


def test_fingers_that_rest_through_a_lost_connection_are_the_same_contacts_afterwards(
    stage: Stage,
) -> None:
    """While time stands still, the loss and the return reach the session as one frame."""
    with Page(stage.server.url, "same") as page:
        page.until("scene")
        page.touch((1, 2.0, 2.0), (2, 3.0, 2.0))
        assert wait_for(lambda: stage.device.touched)
        stage.advance(20)
    assert wait_for(lambda: stage.server.away and not stage.device.touched)
    with Page(stage.server.url, "same") as page:
        page.until("welcome", role="player")
        page.touch((1, 2.0, 2.1), (2, 3.0, 2.1))
        assert wait_for(lambda: stage.device.touched)
        stage.advance()
        heard = stage.session.latest_frame(0)
        assert isinstance(heard, TouchFrame)
        assert [c.id for c in heard.contacts] == [1, 2]
        assert heard.cancelled == frozenset()


def test_bytes_that_are_no_handshake_are_counted_and_hurt_nobody(stage: Stage) -> None:
    for garbage in (b"\x00" * 64, b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 400 + b"\r\n", b"\r\n\r\n"):
        with socket.create_connection((stage.server.access.host, stage.server.access.port)) as raw:
            raw.sendall(garbage)
            # The server waits for the rest of a handshake as long as for a greeting.
            raw.settimeout(GREETING + PATIENCE)
            assert b"200" not in raw.recv(200)
    assert wait_for(lambda: stage.server.counters["failed handshake"] >= 2)
    with Page(stage.server.url) as page:
        page.until("welcome")


def test_a_port_that_is_taken_is_one_clear_error(server: PageServer) -> None:
    with pytest.raises(DeviceError, match="cannot be served"):
        PageServer(port=server.access.port)


@pytest.mark.parametrize("text", ["0.0.0.0", "::", "tablet", "1.2.3", ""])
def test_no_address_means_all_of_them(text: str) -> None:
    with pytest.raises(DeviceError):
        checked_address(text)


def test_the_pages_types_are_those_of_the_server() -> None:
    assert FILE.read_text() == typescript()


def test_a_page_that_goes_takes_the_menu_that_was_open_on_it_with_it(stage: Stage) -> None:
    for rejoins in (False, True):
        page = Page(stage.server.url)
        page.until("scene")
        page.say(type="ask", what="pause")
        page.answered()
        if rejoins:
            # Its old socket is still open when it is there again.
            again = Page(stage.server.url)
            assert again.until("welcome")["role"] == "player"
            again.close()
        page.close()
        assert wait_for(lambda: stage.server.clients == 0)
        assert [ask.what for ask in stage.server.take_requests()] == ["pause", "resume"]
    with Page(stage.server.url) as page:
        page.until("scene")
        for what in ("pause", "resume"):
            page.say(type="ask", what=what)
        page.answered()
    assert wait_for(lambda: stage.server.clients == 0)
    assert [ask.what for ask in stage.server.take_requests()] == ["pause", "resume"]


def test_who_waits_for_the_seat_learns_when_it_is_free_and_may_ask_for_it(
    server: PageServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clients, "REQUESTED_SEAT_TIMEOUT", 1.0)
    first, second = (Page(server.url, name, beats=True) for name in ("first", "second"))
    with first, second:
        assert first.until("welcome")["role"] == "player"
        assert second.until("welcome")["role"] == "spectator"
        assert second.until("seat")["wait_s"] is None
        second.say(type="ask", what="seat", value="")
        assert first.until("seat")["requested"] is False
        assert first.until("seat")["requested"] is True
        # One who goes loses it sooner than without asking.
        first.close()
        assert second.until("seat")["wait_s"] == 1
        assert second.until("welcome")["role"] == "player"


def until_taken_away(stage: Stage) -> list[TouchFrame]:
    """Touch frames up to one that cancels."""
    frames: list[TouchFrame] = []

    def taken_away() -> bool:
        frames.extend(stage.device.poll())
        return bool(frames and frames[-1].cancelled)

    assert wait_for(taken_away), frames
    return frames


def test_a_page_that_falls_silent_loses_its_fingers(stage: Stage) -> None:
    with Page(stage.server.url) as page:
        page.until("scene")
        for silences in (1, 2):
            page.touch((1, 2.0, 2.0))
            frames = until_taken_away(stage)
            assert [c.id for frame in frames for c in frame.contacts] == [1]
            assert frames[-1].cancelled == {1}
            assert not stage.device.touched
            assert stage.server.counters["silent page"] == silences
