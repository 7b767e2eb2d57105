"""The mouse as fingers: what gestures make of touch frames."""

from __future__ import annotations

import threading
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.mouse.mouse import OPENING, MouseDevice, default_hand
from tests.support.viewed import advance, mouse_session

SURFACE = Surface()
MIDDLE = SURFACE.size / 2


def last(mouse: MouseDevice) -> TouchFrame:
    return mouse.poll(0.0)[-1]


def places(frame: TouchFrame) -> NDArray[np.float64]:
    return np.array([[c.x, c.y] for c in frame.contacts])


def gap(frame: TouchFrame) -> float:
    """m between the thumb and the middle of all other fingers."""
    xy = {c.label: np.array([c.x, c.y]) for c in frame.contacts}
    thumb = xy.pop(0)
    return float(np.linalg.norm(np.mean(list(xy.values()), axis=0) - thumb))


def test_a_press_beside_the_surface_is_no_touch_and_a_drag_over_the_border_stays_at_it() -> None:
    mouse = MouseDevice(SURFACE)
    mouse.press([-0.001, 0.05])
    mouse.move(MIDDLE)
    mouse.release()
    assert mouse.poll(0.0) == []
    mouse.press(MIDDLE)
    mouse.move([9.0, -9.0])
    assert np.allclose(places(last(mouse)), [[SURFACE.size[0], 0.0]])
    mouse.move(MIDDLE)
    assert np.allclose(places(last(mouse)), [MIDDLE])


def test_a_pin_stays_is_dragged_by_itself_and_goes_when_it_is_clicked_again() -> None:
    mouse = MouseDevice(SURFACE)
    mouse.press([0.05, 0.05], pin=True)
    mouse.release()
    mouse.press([0.15, 0.10], pin=True)
    mouse.release()
    assert len(last(mouse).contacts) == 2
    mouse.press([0.052, 0.051])
    mouse.move([0.062, 0.061])
    mouse.release()
    assert np.allclose(places(last(mouse)), [[0.06, 0.06], [0.15, 0.10]])
    mouse.press([0.15, 0.10], pin=True)
    mouse.release()
    assert np.allclose(places(last(mouse)), [[0.06, 0.06]])


@given(st.tuples(*[st.floats(-0.3, 0.3)] * 2))
def test_all_pins_move_together_and_keep_their_shape_even_at_the_border(
    step: tuple[float, float],
) -> None:
    mouse = MouseDevice(SURFACE)
    for xy in ([0.05, 0.05], [0.09, 0.07], [0.06, 0.10]):
        mouse.press(xy, pin=True)
        mouse.release()
    before = places(last(mouse))
    mouse.press([0.18, 0.02], together=True)
    mouse.move(np.array([0.18, 0.02]) + step)
    after = places(last(mouse))
    assert np.allclose(np.diff(after, axis=0), np.diff(before, axis=0), atol=1e-12)
    assert np.all(after >= -1e-12) and np.all(after <= SURFACE.size + 1e-12)
    room = np.clip(step, -before.min(axis=0), SURFACE.size - before.max(axis=0))
    assert np.allclose(after - before, room, atol=1e-12)


@pytest.mark.parametrize("fingers", [1, 2, 3, 4, 5])
def test_a_key_puts_down_a_hand_around_the_pointer_and_lifts_it_again(fingers: int) -> None:
    mouse = MouseDevice(SURFACE)
    mouse.hand(fingers, MIDDLE)
    frame = last(mouse)
    labels = [c.label for c in frame.contacts]
    assert labels == ([1] if fingers == 1 else list(range(fingers)))
    if fingers > 1:
        thumb, others = places(frame)[0], places(frame)[1:].mean(axis=0)
        assert np.allclose((thumb + others) / 2, MIDDLE)
        # y points down: the thumb is nearer to the person and on the left of a right hand.
        assert thumb[0] < others[0] and thumb[1] > others[1]
    mouse.hand(fingers, MIDDLE)
    assert last(mouse).contacts == ()


@given(st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5)), st.integers(2, 5))
def test_a_hand_put_down_anywhere_is_whole_and_on_the_surface(
    place: tuple[float, float], fingers: int
) -> None:
    mouse = MouseDevice(SURFACE)
    mouse.hand(fingers, place)
    xy = places(last(mouse))
    wanted = np.array(list(default_hand(fingers).values()))
    assert np.allclose(xy - xy[0], wanted - wanted[0], atol=1e-12)
    assert np.all(xy >= 0.0) and np.all(xy <= SURFACE.size)


def test_dragging_beside_a_hand_moves_all_of_it_and_dragging_a_finger_only_that_one() -> None:
    mouse = MouseDevice(SURFACE)
    mouse.hand(3, MIDDLE)
    before = places(last(mouse))
    mouse.press(MIDDLE)
    mouse.move(MIDDLE + np.array([0.01, -0.005]))
    mouse.release()
    moved = places(last(mouse))
    assert np.allclose(moved - before, [0.01, -0.005])
    mouse.press(moved[0])
    mouse.move(moved[0] + [-0.01, 0.0])
    mouse.release()
    assert np.allclose(places(last(mouse)) - moved, [[-0.01, 0.0], [0.0, 0.0], [0.0, 0.0]])


@given(st.integers(2, 5), st.floats(-8, 8))
def test_the_wheel_opens_and_closes_thumb_against_fingers_and_back_again(
    fingers: int, steps: float
) -> None:
    mouse = MouseDevice(Surface(30.0, 30.0))
    mouse.hand(fingers, [0.3, 0.3])
    before = last(mouse)
    assert gap(before) == pytest.approx(OPENING)
    mouse.wheel(steps)
    after = last(mouse)
    assert np.sign(gap(after) - gap(before)) == np.sign(steps) or abs(steps) < 1e-9
    # Fingers that close against the thumb stay side by side.
    assert np.allclose(np.diff(places(after)[1:], axis=0), np.diff(places(before)[1:], axis=0))
    mouse.wheel(-steps)
    assert np.allclose(places(last(mouse)), places(before), atol=1e-9)


@given(st.integers(2, 5), st.floats(-60, 60))
def test_turning_keeps_all_distances_and_the_middle_and_goes_the_way_it_looks(
    fingers: int, steps: float
) -> None:
    mouse = MouseDevice(Surface(30.0, 30.0))
    mouse.hand(fingers, [0.3, 0.3])
    before = places(last(mouse))
    mouse.wheel(steps, turn=True)
    after = places(last(mouse))

    def distances(xy: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.linalg.norm(xy[:, None] - xy[None], axis=-1)

    assert np.allclose(distances(after), distances(before), atol=1e-9)
    a, b = before[0] - [0.3, 0.3], after[0] - [0.3, 0.3]
    # Counterclockwise for the person, whose y axis points up while the surface's points down.
    turned = np.arctan2(-(a[0] * b[1] - a[1] * b[0]), a @ b)
    expected = np.deg2rad(3.0 * steps)
    assert np.cos(turned - expected) == pytest.approx(1.0, abs=1e-9)


def test_fingers_pinned_one_by_one_open_evenly_about_their_middle() -> None:
    mouse = MouseDevice(SURFACE)
    for xy in ([0.08, 0.06], [0.12, 0.06], [0.10, 0.09]):
        mouse.press(xy, pin=True)
        mouse.release()
    before = places(last(mouse))
    mouse.wheel(3)
    after = places(last(mouse))
    assert np.allclose(after.mean(axis=0), before.mean(axis=0))
    grown = (after[0] - after[1])[0] / (before[0] - before[1])[0]
    assert grown > 1.0
    assert np.allclose(after - after.mean(axis=0), grown * (before - before.mean(axis=0)))


_POINTS = st.tuples(st.floats(-0.3, 0.5), st.floats(-0.3, 0.5))
_GESTURES = st.one_of(
    st.tuples(st.just("press"), _POINTS, st.booleans(), st.booleans()),
    st.tuples(st.just("move"), _POINTS),
    st.tuples(st.just("release")),
    st.tuples(st.just("wheel"), st.floats(-50, 50), st.booleans()),
    st.tuples(st.just("hand"), st.integers(1, 5), _POINTS),
    st.tuples(st.just("lift_fingers")),
)


@given(st.lists(_GESTURES, max_size=40))
def test_whatever_is_done_frames_are_sound_on_the_surface_and_end_with_all_lifted(
    gestures: list[tuple[str, ...]],
) -> None:
    mouse = MouseDevice(SURFACE)
    for name, *arguments in gestures:
        getattr(mouse, name)(*arguments)
    mouse.close()
    frames = mouse.poll(0.0)
    assert not frames or frames[-1].contacts == ()
    gone: set[int] = set()
    for before, after in pairwise([TouchFrame(0.0), *frames]):
        for c in after.contacts:
            assert -1e-12 <= c.x <= SURFACE.size[0] + 1e-12
            assert -1e-12 <= c.y <= SURFACE.size[1] + 1e-12
        ids = {c.id for c in after.contacts}
        assert not ids & gone, "a lifted finger's id came back"
        gone |= {c.id for c in before.contacts} - ids
        assert before.time <= after.time


def test_frames_reach_another_thread_once_and_in_order() -> None:
    mouse = MouseDevice(SURFACE)
    taken: list[TouchFrame] = []

    def session() -> None:
        while not mouse.finished:
            taken.extend(mouse.poll(0.0))
        taken.extend(mouse.poll(0.0))

    thread = threading.Thread(target=session)
    thread.start()
    mouse.press([0.0, 0.05])
    xs = np.linspace(0.0, SURFACE.size[0], 500)
    for x in xs:
        mouse.move([x, 0.05])
    mouse.close()
    thread.join()
    assert [f.contacts[0].x for f in taken[:-1]] == pytest.approx([0.0, *xs])
    assert taken[-1].contacts == () and mouse.finished


def test_a_box_is_dragged_to_its_goal_and_let_go_by_mouse_gestures_alone() -> None:
    session, mouse, surface = mouse_session(seed=3)
    box, goal = session.task.objects[0], session.task.goals[0]
    start, end = surface.to_surface([box.position, goal.position])
    advance(session, 0.2)
    mouse.hand(3, start)
    # Thumb and fingers are to close on two faces of the box, whichever are nearest.
    layout = default_hand(3)
    across = np.mean([layout[1], layout[2]], axis=0) - layout[0]
    axis = np.arctan2(-across[1], across[0])
    quarter = np.pi / 2
    turn = (box.yaw - axis + quarter / 2) % quarter - quarter / 2
    mouse.wheel(np.rad2deg(turn) / 3.0, turn=True)
    advance(session, 1.5)
    for _ in range(9):
        mouse.wheel(-1.0)
        advance(session, 0.05)
    beside = np.array([0.0, 0.0])
    mouse.press(beside, together=True)
    for share in np.linspace(0.0, 1.0, 40):
        mouse.move(beside + share * (end - start))
        advance(session, 0.04)
    mouse.release()
    turn = (goal.yaw - box.yaw + quarter / 2) % quarter - quarter / 2
    for _ in range(10):
        mouse.wheel(np.rad2deg(turn) / 30.0, turn=True)
        advance(session, 0.05)
    for _ in range(12):
        mouse.wheel(0.5)
        advance(session, 0.03)
    mouse.lift_fingers()
    score = advance(session, 2.5).score
    assert score.success, score.reason
