"""Several devices as one: nothing is lost or mixed up, and time begins with the first touch."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.devices.wrappers.playing import SPEED, FirstTouch, LiftKeys, MergedDevice
from sandbox.play.window_play import _from_first_touch, _waiting
from sandbox.server.protocol import PageScreen, PageTouches
from sandbox.server.web import WebDevice
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.processes import PATIENCE, Sender
from tests.support.scripted import Played
from tests.support.tuio_packets import frame

SCREEN = PageScreen(100.0, 1000.0, 800.0, True)


def contact(i: int, x: float = 0.0) -> Contact:
    return Contact(i, x, 0.01 * i)


frames_of_one = st.lists(
    st.tuples(st.floats(0.0, 1.0), st.sets(st.integers(-3, 6), max_size=5)), max_size=12
).map(
    lambda found: [
        TouchFrame(t, tuple(contact(i, t) for i in sorted(ids)))
        for t, ids in sorted(found, key=lambda entry: entry[0])
    ]
)


@given(st.lists(frames_of_one, min_size=1, max_size=3), st.lists(st.floats(0.0, 1.0), max_size=4))
def test_the_merged_frame_is_what_all_of_them_hold_down(
    scripts: list[list[TouchFrame]], polls: list[float]
) -> None:
    merged = MergedDevice([Played(script) for script in scripts])
    found = [f for now in [*sorted(polls), 1.0] for f in merged.poll(now)]
    assert len(found) == sum(map(len, scripts)) and merged.finished
    if found:
        last = {(c.x, c.y) for script in scripts if script for c in script[-1].contacts}
        assert {(c.x, c.y) for c in found[-1].contacts} == last
    count = [len(f.contacts) for script in scripts for f in script]
    assert not count or max(len(f.contacts) for f in found) >= max(count)


@given(frames_of_one)
def test_of_one_device_only_the_ids_differ_and_an_id_means_one_press(
    script: list[TouchFrame],
) -> None:
    found = MergedDevice([Played(script)]).poll(1.0)
    names: dict[int, int] = {}
    used: set[int] = set()
    for before, after in zip(script, found, strict=True):
        assert [(c.x, c.y) for c in before.contacts] == [(c.x, c.y) for c in after.contacts]
        assert after.time == before.time
        now = {b.id: a.id for b, a in zip(before.contacts, after.contacts, strict=True)}
        for own, given_id in now.items():
            if own in names:
                assert names[own] == given_id
            else:
                assert given_id not in used
            used.add(given_id)
        names = now


def test_touches_that_were_cancelled_stay_cancelled_under_their_new_ids() -> None:
    one = Played([TouchFrame(0.0, (contact(4),)), TouchFrame(0.2, (), None, frozenset({4, 9}))])
    other = Played([TouchFrame(0.1, (contact(4),))])
    first, second, third = MergedDevice([one, other]).poll(1.0)
    (gone,) = {c.id for c in second.contacts} - {c.id for c in third.contacts}
    assert {c.id for c in first.contacts} == {gone} == third.cancelled


@given(st.lists(frames_of_one, min_size=2, max_size=3), st.integers(0, 1))
def test_ids_of_a_device_stay_where_asked_and_no_two_touches_share_one(
    scripts: list[list[TouchFrame]], kept: int
) -> None:
    merged = MergedDevice([Played(script) for script in scripts], kept)
    for shown in merged.poll(1.0):
        ids = [c.id for c in shown.contacts]
        assert len(set(ids)) == len(ids)
    last = scripts[kept][-1].contacts if scripts[kept] else ()
    found = merged.poll(2.0) or [TouchFrame(2.0, merged._contacts[kept])]
    assert {c.id for c in found[-1].contacts} >= {c.id for c in last}


def touch(
    web: WebDevice, seq: int, *contacts: tuple[int, float, float], lift: float | None = None
) -> None:
    px = [(i, 100.0 * x, 100.0 * y, 1.0, 1.0) for i, x, y in contacts]
    web.receive(PageTouches(seq, 1.0, px, [], lift), SCREEN)


def test_fingers_on_the_page_and_pins_of_the_mouse_are_one_hand() -> None:
    surface = Surface()
    mouse, web = MouseDevice(surface), WebDevice(surface)
    both = MergedDevice([mouse, web])
    mouse.press([0.05, 0.05], pin=True)
    assert both.frame_ready.is_set()
    touch(web, 1, (0, 3.0, 2.0))
    held = both.poll(0.0)[-1]
    assert not both.frame_ready.is_set()
    assert np.allclose([[c.x, c.y] for c in held.contacts], [[0.05, 0.05], [0.0762, 0.0508]])
    assert len({c.id for c in held.contacts}) == 2
    mouse.lift_fingers()
    (left,) = both.poll(0.0)[-1].contacts
    assert left.id == held.contacts[1].id
    web.cancel_all()
    last = both.poll(0.0)[-1]
    assert not last.contacts and last.cancelled == {left.id}


def test_of_two_lift_controls_the_one_that_was_moved_last_counts() -> None:
    surface = Surface()
    keys, web = LiftKeys(MouseDevice(surface)), WebDevice(surface)
    both = MergedDevice([keys, web])
    assert both.lift and both.lifted is None
    keys.hold(1.0)
    both.poll(0.0)
    both.poll(1.0)
    keys.hold(0.0)
    both.poll(1.0)
    assert both.lifted == pytest.approx(SPEED)
    touch(web, 1, lift=0.0)
    assert both.poll(1.0)[-1].lift == pytest.approx(SPEED)
    touch(web, 2, lift=0.8)
    assert both.poll(1.0)[-1].lift == 0.8
    # The keys go on from where the page's control has left the hand.
    keys.hold(-1.0)
    both.poll(1.0)
    assert both.poll(1.5)[-1].lift == pytest.approx(0.8 - 0.5 * SPEED)
    keys.hold(0.0)
    touch(web, 3, (1, 1.0, 1.0), lift=0.8)
    assert both.poll(1.5)[-1].lift == pytest.approx(0.8 - 0.5 * SPEED)


def test_nothing_has_come_before_a_finger_is_down_and_then_all_of_it_is_there() -> None:
    mouse = MouseDevice(Surface())
    device = FirstTouch(mouse)
    assert not device.came()
    mouse.move((0.05, 0.05))
    assert not device.came()
    mouse.press((0.05, 0.05), pin=True)
    mouse.move((0.06, 0.05))
    assert device.came() and device.came()
    mouse.release()
    mouse.lift_fingers()
    frames = device.poll(0.0)
    assert [len(frame.contacts) for frame in frames] == [1, 1, 0]
    np.testing.assert_allclose([frames[0].contacts[0].x, frames[1].contacts[0].x], [0.05, 0.06])
    assert device.poll(0.0) == []
    assert device.came(), "a hand that was lifted has been there"


def test_what_a_device_said_before_the_first_touch_is_forgotten() -> None:
    finger = (Contact(1, 0.05, 0.05),)
    said = [TouchFrame(0.0, ()), TouchFrame(0.0, finger), TouchFrame(0.0, ())]
    device = FirstTouch(Played(said))
    assert device.came()
    assert list(device.poll(0.0)) == said[1:]


@pytest.mark.parametrize(
    "more", [{"vary": "latency=50"}, {"task": "carry-together", "surface": "400x200mm"}]
)
def test_time_begins_where_touches_come_late_or_two_hands_share_the_surface(
    more: dict[str, Any],
) -> None:
    chosen = trial_settings(TrialOptions(device="tuio", device_options={"port": 0}, **more))
    session = build(chosen, device_makers(chosen, _from_first_touch))
    tuio = session.first_rig.device.find(TuioDevice)
    assert tuio is not None
    with Sender(tuio.port) as send:
        assert _waiting(session) and _waiting(session)
        send(frame(1, {0: (0.5, 0.5)}))
        assert tuio.wait(PATIENCE)
        assert not _waiting(session)
        for _ in range(10):
            session.advance()
    seen = [contact for hand in session.snapshot().hands for contact in hand.contacts]
    assert len(seen) == 1
    session.close()
