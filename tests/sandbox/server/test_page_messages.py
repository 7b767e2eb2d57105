"""What a page is told beside poses, and what its touches become: forces, skins, tokens, pixels."""

from __future__ import annotations

import json
import resource
import threading
from pathlib import Path
from typing import Any

import pytest

from models.errors import InputError
from models.surface import Surface
from sandbox.server.access import stored_token
from sandbox.server.page_frames import describe_scene, pack_skin, state_of
from sandbox.server.protocol import PageScreen, PageTouches, decode, encode
from sandbox.server.web import WebDevice
from sandbox.trial.settings import Settings
from tests.sandbox.server.test_page_server import Stage
from tests.sandbox.session.test_contact_modes import BESIDE_IT, INTO_THE_BOX, grip
from tests.support.page_client import Page
from tests.support.scripted import run
from tests.support.viewed import with_load


def test_a_kept_token_is_the_same_and_for_this_user_alone(tmp_path: Path) -> None:
    path = tmp_path / "new" / "page-token"
    token = stored_token(path)
    assert len(token) >= 20
    assert stored_token(path) == token
    assert path.stat().st_mode & 0o077 == 0
    path.chmod(0o644)
    with pytest.raises(InputError, match="other users can read"):
        stored_token(path)
    path.chmod(0o600)
    path.write_text("short")
    with pytest.raises(InputError, match="has no valid token"):
        stored_token(path)


def test_a_token_that_cannot_be_written_leaves_no_file(tmp_path: Path) -> None:
    path = tmp_path / "page-token"
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
    try:
        with pytest.raises(InputError, match="cannot be stored"):
            stored_token(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert not path.exists() and len(stored_token(path)) >= 20


def test_a_page_gets_the_grip_of_each_finger() -> None:
    session = grip(BESIDE_IT)
    run(session, 1.0)
    used = (0.0, 1.0, 0.0, 0.0, 0.0)
    stored = (3.0, 4.0, 0.0, 0.0, 0.0)
    (hand,) = state_of(with_load(session.snapshot(), stored, stored, used), "").hands
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


def _touches(*contacts: tuple[int, Any, Any, Any, Any], **more: Any) -> PageTouches:
    return PageTouches(1, 0.0, list(contacts), **more)


SCREEN = PageScreen(100.0, 1000.0, 800.0, True)


@pytest.fixture
def device() -> WebDevice:
    """The device of a page with the usual touch rectangle."""
    return WebDevice(Settings().surface.rectangle)


def test_a_touch_beside_the_rectangle_is_none_and_a_dragged_one_stays_at_its_border(
    device: WebDevice,
) -> None:
    width = device._size[0] / 0.0254 * 100
    device.receive(_touches((1, -5.0, 10.0, 0.0, 0.0)), SCREEN)
    device.receive(_touches((1, -5.0, 10.0, 0.0, 0.0), (2, 50.0, 10.0, 30.0, 20.0)), SCREEN)
    device.receive(_touches((2, width + 80, 10.0, 30.0, 20.0)), SCREEN)
    first, second, third = device.poll()
    assert first.contacts == ()
    assert [c.id for c in second.contacts] == [2]
    assert second.contacts[0].size == pytest.approx(30.0 / 100 * 0.0254)
    assert second.contacts[0].extent == pytest.approx((0.3 * 0.0254, 0.2 * 0.0254))
    assert third.contacts[0].x == pytest.approx(device._size[0])


@pytest.mark.parametrize("x", [None, 1e9, -1e300, 2001.0])
def test_a_finger_without_a_place_stays_where_it_was_and_costs_no_other(
    device: WebDevice, x: float | None
) -> None:
    device.receive(_touches((1, 50, 50, 0, 0), (2, 90, 50, 0, 0)), SCREEN)
    text = encode(_touches((1, x, 50, 0, 0), (2, 60, 50, 0, 0), (3, 50, x, 0, 0)))
    message = decode(text)
    assert isinstance(message, PageTouches)
    device.receive(message, SCREEN)
    first, second = device.poll()
    assert [c.id for c in second.contacts] == [1, 2]
    assert second.contacts[0].x == first.contacts[0].x
    assert second.contacts[1].x < first.contacts[1].x
    assert device.report.left_out == {"positions beyond the screen": 2}


@pytest.mark.parametrize(
    ("width", "height", "known"),
    [
        *((30.0, 20.0, True), (400.0, 300.0, True), (30.0, 2000.0, False), (2000.0, 30.0, False)),
        *((1e9, 1e9, False), (40.0, 401.0, False), (None, None, False), (-30.0, 20.0, False)),
        *((1.0, 1.0, False), (2.0, 2.0, False), (0.0, 50.0, False)),
    ],
)
def test_a_size_that_no_finger_has_is_an_unknown_one(
    device: WebDevice, width: float | None, height: float | None, known: bool
) -> None:
    device.receive(_touches((1, 50, 50, width, height)), SCREEN)
    (frame,) = device.poll()
    (contact,) = frame.contacts
    assert (contact.size is not None, contact.extent is not None) == (known, known)


def test_more_touches_than_a_page_has_cost_those_beyond(device: WebDevice) -> None:
    device.receive(_touches(*((n, 50.0 + n, 50.0, 0.0, 0.0) for n in range(100))), SCREEN)
    (frame,) = device.poll()
    assert [c.id for c in frame.contacts] == list(range(20))
    assert device.report.left_out == {"touches beyond 20": 80}


@pytest.mark.parametrize(("lift", "shown"), [(None, 0.4), (1.2, 1.0), (-0.1, 0.0)])
def test_a_lift_control_beyond_its_ends_is_at_its_end(
    device: WebDevice, lift: float | None, shown: float
) -> None:
    device.receive(_touches(lift=0.4), SCREEN)
    device.receive(_touches(lift=lift), SCREEN)
    assert device.poll()[-1].lift == shown


def test_of_two_contacts_with_one_id_the_first_counts(device: WebDevice) -> None:
    device.receive(_touches((1, 50, 50, 0, 0), (1, 90, 50, 0, 0)), SCREEN)
    (frame,) = device.poll()
    assert len(frame.contacts) == 1


def test_a_page_that_begins_during_a_poll_does_not_get_the_number_of_the_one_before() -> None:
    class Reloading(threading.Event):
        """An event that a poll clears, while the server's thread receives a reload."""

        def clear(self) -> None:
            super().clear()
            if not reloads:
                reloads.append(threading.Thread(target=device.begin_page))
                reloads[0].start()

    reloads: list[threading.Thread] = []
    device = WebDevice(Surface())
    device.frame_ready = Reloading()
    for seq in (499, 500):
        device.receive(PageTouches(seq, 0.0, []), SCREEN)
    device.poll()
    reloads[0].join()
    assert device.applied == 0
    device.receive(PageTouches(1, 0.0, []), SCREEN)
    device.poll()
    assert device.applied == 1
