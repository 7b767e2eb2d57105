"""What a page is told beside poses, and what its touches become: forces, skins, tokens, pixels."""

from __future__ import annotations

import json
import resource
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from models.errors import InputError
from models.surface import Surface
from sandbox.server.access import kept_token
from sandbox.server.frames import HandFeedback, describe_scene, pack_skin, state_of
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import PageScreen, PageTouches
from sandbox.server.web import WebDevice
from sandbox.trial.latency import LatencyLog
from sandbox.trial.settings import Settings
from tests.sandbox.server.test_page_server import Stage, opened
from tests.sandbox.session.test_collision_gating import BESIDE_IT, INTO_THE_BOX, grip
from tests.support.page_client import Page
from tests.support.scripted import run


@pytest.fixture
def stage() -> Iterator[Stage]:
    server = PageServer()
    yield opened(server)
    server.close()


def test_a_kept_token_is_the_same_and_for_this_user_alone(tmp_path: Path) -> None:
    path = tmp_path / "new" / "page-token"
    token = kept_token(path)
    assert len(token) >= 20
    assert kept_token(path) == token
    assert path.stat().st_mode & 0o077 == 0
    path.chmod(0o644)
    with pytest.raises(InputError, match="other users can read"):
        kept_token(path)
    path.chmod(0o600)
    path.write_text("short")
    with pytest.raises(InputError, match="does not hold a token"):
        kept_token(path)


def test_a_token_that_cannot_be_written_leaves_no_file(tmp_path: Path) -> None:
    path = tmp_path / "page-token"
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
    try:
        with pytest.raises(InputError, match="cannot be stored"):
            kept_token(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert not path.exists() and len(kept_token(path)) >= 20


def test_what_a_hand_presses_with_and_how_sure_its_labels_are_is_told(stage: Stage) -> None:
    with Page(stage.server.url) as page:
        page.until("scene")
        snapshot = stage.session.advance()
        stage.server.publish(snapshot)
        assert page.until("frame")["state"]["hands"][0]["probability"] == 1.0
        stage.server.publish(snapshot, feedback=[HandFeedback((0.0, 1.5, 0.0, 0.0, 0.0), 0.25)])
        assert page.until("frame")["state"]["hands"][0]["probability"] == 0.25


def test_a_page_gets_the_grip_of_each_finger() -> None:
    session = grip(BESIDE_IT)
    run(session, 1.0)
    felt = HandFeedback(stored=(3.0, 4.0, 0.0, 0.0, 0.0), full=frozenset({1}))
    (hand,) = state_of(session.snapshot(), "", [felt]).hands
    told = {c.label: (c.stored, c.full) for c in hand.contacts}
    assert told == {0: (3.0, False), 1: (4.0, True)}


@pytest.mark.parametrize(("gap", "inside"), [(INTO_THE_BOX, True), (BESIDE_IT, False)])
def test_a_page_knows_which_finger_is_inside_a_thing(gap: float, inside: bool) -> None:
    session = grip(gap)
    run(session, 1.0)
    (hand,) = state_of(session.snapshot(), "").hands
    assert [c.inside for c in hand.contacts] == [inside, inside]


def test_a_skin_comes_once_and_again_only_when_it_is_another(stage: Stage) -> None:
    skins = [pack_skin(hand) for hand in stage.session.scene.spec.hands]
    surface = stage.session.rigs[0].reconstructor.surface

    def show(number: int, skins: list[bytes]) -> None:
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


def _touches(*contacts: tuple[int, float, float, float, float], **more: Any) -> PageTouches:
    return PageTouches(1, 0.0, list(contacts), **more)


SCREEN = PageScreen(100.0, 1000.0, 800.0, True)


def test_a_touch_beside_the_rectangle_is_none_and_a_dragged_one_stays_at_its_border() -> None:
    device = WebDevice(Settings().surface.rectangle)
    width = device._size[0] / 0.0254 * 100
    device.push(_touches((1, -5.0, 10.0, 0.0, 0.0)), SCREEN)
    device.push(_touches((1, -5.0, 10.0, 0.0, 0.0), (2, 50.0, 10.0, 30.0, 20.0)), SCREEN)
    device.push(_touches((2, width + 80, 10.0, 30.0, 20.0)), SCREEN)
    first, second, third = device.poll()
    assert first.contacts == ()
    assert [c.id for c in second.contacts] == [2]
    assert second.contacts[0].size == pytest.approx(30.0 / 100 * 0.0254)
    assert second.contacts[0].extent == pytest.approx((0.3 * 0.0254, 0.2 * 0.0254))
    assert third.contacts[0].x == pytest.approx(device._size[0])


def test_a_cancelled_finger_is_told_apart_from_a_lifted_one() -> None:
    device = WebDevice(Settings().surface.rectangle)
    device.push(_touches((1, 50, 50, 0, 0), (2, 90, 50, 0, 0)), SCREEN)
    device.push(_touches(cancelled=[1, 99]), SCREEN)
    assert device.poll()[-1].cancelled == {1}


def test_the_lift_control_stays_where_it_was_while_a_message_does_not_tell() -> None:
    device = WebDevice(Settings().surface.rectangle)
    device.push(_touches(lift=0.4), SCREEN)
    device.push(_touches(), SCREEN)
    assert [frame.lift for frame in device.poll()] == [0.4, 0.4]


def test_of_two_contacts_with_one_id_the_first_counts() -> None:
    device = WebDevice(Settings().surface.rectangle)
    device.push(_touches((1, 50, 50, 0, 0), (1, 90, 50, 0, 0)), SCREEN)
    (frame,) = device.poll()
    assert len(frame.contacts) == 1


def test_a_page_that_begins_during_a_poll_does_not_get_the_number_of_the_one_before() -> None:
    class Reloading(LatencyLog):
        """A log in whose midst the server's thread hears of a reload."""

        def take_in(self, arrived: float, now: float) -> None:
            if not reloads:
                reloads.append(True)
                device.begin_page()

    reloads: list[bool] = []
    device = WebDevice(Surface(), Reloading())
    for seq in (499, 500):
        device.push(PageTouches(seq, 0.0, []), SCREEN)
    device.poll()
    assert device.applied == 0
    device.push(PageTouches(1, 0.0, []), SCREEN)
    device.poll()
    assert device.applied == 1
