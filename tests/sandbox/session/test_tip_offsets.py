"""Fingers at an object are led out of it, keep their grip while they tremble, and release."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arithmetic import Array
from models.frames import Contact
from models.mjcf_object import MjcfObject
from models.objects import Box
from models.scene import CONTROL_PERIOD
from models.surface import Surface
from sandbox.session.collision_gating import CLEARANCE, STUCK
from sandbox.session.messages import MOVE_APART
from sandbox.session.session import Session
from sandbox.session.tip_offsets import OPENED, REACH, RELEASED_FADING, Grip
from sandbox.trial.settings import SOLID as SOLIDS
from sandbox.trial.settings import HandSettings
from tasks import CustomTask, Goal, Measure, Sensing, judge
from tasks.user import UserConfiguration
from tests.support.scripted import box_xy, pinch, run, scripted

HAND = np.array([[-0.03, 0.01], [0.03, -0.01], [0.025, 0.012]])
"""m, touches of thumb, index and middle finger."""
SOLID = frozenset({0, 1, 2})


def held(grip: Grip, places: Array) -> tuple[bool, Array]:
    """Whether fingers let go in a step, and where their tips (3, 2) m are kept."""
    touches = {finger: (float(x), float(y)) for finger, (x, y) in enumerate(places)}
    releases = grip.step(touches, SOLID)
    return releases, places if grip.offsets is None else places + grip.offsets[:3]


def opened(by: float) -> Array:
    """Touches (3, 2) m, each farther from the middle of all."""
    away = HAND - HAND.mean(axis=0)
    return HAND + by * away / np.linalg.norm(away, axis=1)[:, None]


def widths(places: Array) -> Array:
    """(3, 3) m from each finger to the others."""
    return np.linalg.norm(places[:, None] - places[None], axis=-1)


def test_fingers_that_open_a_little_keep_the_width_of_their_grip() -> None:
    grip = Grip()
    for by in np.linspace(0.0, 0.003, 31):
        releases, tips = held(grip, opened(by))
        assert not releases
        # Within half a second little of it is forgotten.
        touched, kept = widths(opened(by)) - widths(HAND), widths(tips) - widths(HAND)
        assert np.abs(kept).max() <= 0.2 * np.abs(touched).max()


def test_fingers_that_close_are_followed_at_once() -> None:
    grip = Grip()
    for by in (0.0, -0.002, -0.004, -0.01):
        np.testing.assert_array_equal(held(grip, opened(by))[1], opened(by))


def test_a_single_finger_holds_nothing() -> None:
    grip = Grip()
    for x in (0.0, 0.1, 0.2):
        assert not grip.step({1: (x, 0.0)}, SOLID) and grip.offsets is None


def test_fingers_that_spread_let_go_once() -> None:
    grip, times = Grip(), []
    for step in range(40):
        releases, _ = held(grip, opened(min(0.0005 * step, 0.010)))
        if releases:
            times.append(step)
    assert times[0] <= 2 * OPENED / 0.0005 and len(times) <= 2


def test_tips_return_to_their_touches_in_small_steps_once_the_grip_is_gone() -> None:
    grip, steps = Grip(), []
    for by in (0.0, 0.001, 0.002, 0.003):
        _, before = held(grip, opened(by))
    open_now = opened(0.003)
    for _ in range(10):
        grip.step(dict.fromkeys((0, 1, 2), (0.0, 0.0)), frozenset())
        tips = open_now if grip.offsets is None else open_now + grip.offsets[:3]
        steps.append(np.linalg.norm(tips - before, axis=1).max())
        before = tips
    np.testing.assert_array_equal(before, open_now)
    assert max(steps) <= RELEASED_FADING * CONTROL_PERIOD + 1e-9


@given(
    turn=st.floats(-0.02, 0.02),
    right=st.floats(-0.005, 0.005),
    down=st.floats(-0.005, 0.005),
)
def test_fingers_that_drag_and_turn_a_thing_are_followed(
    turn: float, right: float, down: float
) -> None:
    grip, places = Grip(), HAND
    c, s = np.cos(turn), np.sin(turn)
    for _ in range(50):
        releases, tips = held(grip, places)
        assert not releases
        np.testing.assert_allclose(tips, places, atol=1e-9)
        places = places @ np.array([[c, s], [-s, c]]) + [right, down]


def test_trembling_fingers_hold_on() -> None:
    rng, grip, off = np.random.default_rng(5), Grip(), np.zeros((3, 2))
    # Slow tremor, as of the simulated user, for a minute.
    keep = np.exp(-CONTROL_PERIOD / 0.15)
    for _ in range(round(60 / CONTROL_PERIOD)):
        off = keep * off + np.sqrt(1 - keep**2) * rng.normal(0.0, 0.00095, (3, 2))
        assert not held(grip, HAND + off)[0]


@pytest.mark.parametrize("lift", [True, False])
def test_a_box_stays_where_it_was_let_go_of_by_lifting_or_spreading(lift: bool) -> None:
    empty = scripted(lambda now: (), seed=1)
    at = box_xy(empty)
    empty.close()

    def gap(now: float) -> float:
        if now < 1.0:
            return 0.074
        return 0.056 if now < 2.0 or lift else min(0.056 + 0.3 * (now - 2.0), 0.09)

    touch = pinch(at, gap, yaw=0.7117)
    session = scripted(lambda now: () if now > 2.5 and lift else touch(now), seed=1)
    run(session, 2.0)
    assert len(session.solid(0)) == 2 and session.loads()[0].fingers[0].pressing > 1.0
    held_at, _ = session.scene.object_pose(session.data, "box")
    run(session, 1.0)
    left_at, _ = session.scene.object_pose(session.data, "box")
    assert session.loads()[0].fingers[0].force == 0.0
    assert np.linalg.norm(left_at - held_at) < 0.002


SETTLED = 0.8
"""s after which a hand that can become solid is."""


def box_of(session: Session) -> tuple[Array, Array]:
    return session.scene.object_pose(session.data, "box")


def half_width(session: Session) -> float:
    """m from the middle of the box to its faces."""
    box = session.task.objects[0]
    assert isinstance(box, Box)
    return box.half_size[0]


def pinched(
    beside: float,
    squeeze: Callable[[float], float] = lambda now: 0.0,
    face: int = 0,
    **settings: Any,
) -> Session:
    """Thumb and index at two faces of the box, their touches so far outside of them, m.

    Args:
        beside: m from the faces to the touches.
        squeeze: Function from s to m, by which each finger closes.
        face: Axis of the box across the faces, x or y, away from the thumb.
        settings: Of the run.
    """
    empty = scripted(lambda now: (), seed=1, **settings)
    position, rotation = box_of(empty)
    surface = empty.rigs[0].reconstructor.surface
    half = half_width(empty)
    empty.close()

    def touch(now: float) -> list[Contact]:
        far = (half + beside - squeeze(now)) * rotation[:, face]
        xy = surface.to_surface(np.stack([position - far, position + far])).tolist()
        return [Contact(i, x, y, label=i) for i, (x, y) in enumerate(xy)]

    return scripted(touch, seed=1, labels="device", **settings)


def clearances(session: Session) -> Array:
    """(2,) m of the flesh of thumb and index from the box."""
    gate = session._gates[0]
    tips = gate.tips(session.data)[:2]
    radius = session.scene.spec.hands[0].skeleton.tip_radius[:2]
    return session.task.objects[0].clearance(tips, *box_of(session)) - radius


@pytest.mark.parametrize("beside", [0.0, 0.003, 0.006, 0.009, 0.015])
def test_fingers_at_the_faces_become_solid_beside_them_and_move_nothing(beside: float) -> None:
    session = pinched(beside)
    before, _ = box_of(session)
    run(session, SETTLED)
    assert session.solid(0) == {0, 1}
    assert clearances(session).min() > CLEARANCE
    after, _ = box_of(session)
    assert np.linalg.norm(after - before) < 0.0005
    hand = session.snapshot().hands[0]
    touches = hand.places[:, :2]
    off = np.linalg.norm(hand.tips[:2, :2] - touches, axis=1)
    radius = session.scene.spec.hands[0].skeleton.tip_radius[:2]
    assert np.all(off < radius + REACH)


@pytest.mark.parametrize(
    ("hand", "face"),
    [
        (HandSettings("left"), 1),
        (HandSettings(size=1.12), 0),
        (HandSettings(turn=90), 1),
        (HandSettings("left", 0.9, 270), 0),
    ],
    ids=["left", "larger", "from the right", "left, smaller, from the left"],
)
def test_it_is_so_for_every_hand_and_seat(hand: HandSettings, face: int) -> None:
    session = pinched(0.003, face=face, hands=(hand,))
    run(session, SETTLED)
    assert session.solid(0) == {0, 1}
    assert clearances(session).min() > CLEARANCE


def test_a_solid_finger_that_leaves_the_thing_comes_back_to_its_touch() -> None:
    def away(now: float) -> float:
        return -0.05 * min(max(now - 1.0, 0.0), 1.0)

    session = pinched(0.002, away)
    run(session, 1.0)
    assert np.abs(session._tip_offsets[0]._out).max() > 0.003
    run(session, 1.8)
    assert session._tip_offsets[0]._out is None
    hand = session.snapshot().hands[0]
    touches = hand.places[:, :2]
    assert np.linalg.norm(hand.tips[:2, :2] - touches, axis=1).max() < 0.001


def test_a_hand_that_is_a_ghost_on_purpose_is_led_out_of_nothing() -> None:
    poses = []
    for solid in SOLIDS:
        session = pinched(0.002, contact="none", solid=solid)
        run(session, SETTLED)
        hand = session.snapshot().hands[0]
        assert not hand.solid and not hand.inside
        assert np.linalg.norm(hand.tips[:2, :2] - hand.places[:, :2], axis=1).max() < 0.001
        poses.append(session.reconstructions[0].q)
    np.testing.assert_array_equal(poses[0], poses[1])


@pytest.mark.parametrize("inside", [0.018, 0.005])
def test_a_finger_in_a_thing_is_told_so_at_once_where_it_is(inside: float) -> None:
    session = pinched(-inside)
    run(session, SETTLED)
    now = session.snapshot()
    assert not now.hands[0].solid and now.hands[0].inside == {0, 1}
    assert now.notice == STUCK and now.notice.startswith(MOVE_APART)


def beside_one_face(*places: tuple[float, float]) -> Session:
    """Fingers beside one face of the box: m along the face from its middle, m outside of it."""
    empty = scripted(lambda now: (), seed=1)
    position, rotation = box_of(empty)
    surface = empty.rigs[0].reconstructor.surface
    half = half_width(empty)
    empty.close()
    points = [
        position + along * rotation[:, 1] + (half + out) * rotation[:, 0] for along, out in places
    ]
    touches = [
        Contact(i, x, y, label=i)
        for i, (x, y) in enumerate(surface.to_surface(np.stack(points)).tolist())
    ]
    return scripted(lambda now: touches, seed=1, labels="device")


def test_fingers_side_by_side_at_one_face_are_led_as_well_so_that_they_can_push() -> None:
    session = beside_one_face((-0.012, 0.004), (0.012, 0.002))
    run(session, SETTLED)
    assert session.solid(0) == {0, 1}


def test_a_finger_is_not_led_towards_the_others_as_no_thing_is_between_them() -> None:
    session = beside_one_face((0.0, 0.06), (0.0, 0.003))
    before, _ = box_of(session)
    run(session, SETTLED)
    now = session.snapshot()
    assert not now.hands[0].solid and now.hands[0].inside == {1}
    assert STUCK in now.notice
    np.testing.assert_allclose(box_of(session)[0], before, atol=1e-5)


CORNERS = [(0.028 * x, 0.030 * y, 0.025 * z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
POINTS = [*CORNERS, (-0.034, 0.0, 0.0), (0.034, 0.0, 0.0)]
MESH = f"""<mujoco>
  <asset><mesh name="m" vertex="{" ".join(str(x) for point in POINTS for x in point)}"/></asset>
  <worldbody><body><geom type="mesh" mesh="m"/></body></worldbody>
</mujoco>"""


HALF_WIDTH = 0.034
"""m, from the middle of the block to its ridges, where it is held."""
GRIP_AXIS = UserConfiguration().natural_axis
"""rad, direction from the thumb to the index finger."""


class RidgedBlock(CustomTask):
    """A mesh: a block with a ridge on either of its held faces; there is no goal."""

    name = "ridged-block"

    @classmethod
    def place(
        cls, rng: np.random.Generator, surface: Surface
    ) -> tuple[list[MjcfObject], list[Goal]]:
        middle = surface.to_world(surface.size / 2)
        return [MjcfObject.on_table("thing", MESH, 0.1, middle, GRIP_AXIS)], []

    def measure(self, sensing: Sensing) -> Measure:
        return judge(0.0, (True, "never"))


def test_fingers_are_led_out_of_a_mesh() -> None:
    place = f"{RidgedBlock.__module__}:{RidgedBlock.__name__}"
    away = (HALF_WIDTH + 0.003) * np.array([np.cos(GRIP_AXIS), np.sin(GRIP_AXIS), 0.0])

    def touch(now: float) -> list[Contact]:
        xy = surface.to_surface(before + np.array([-away, away])).tolist()
        return [Contact(i, x, y, label=i) for i, (x, y) in enumerate(xy)]

    session = scripted(touch, task=place, seed=0, labels="device")
    surface = session.rigs[0].reconstructor.surface
    before, _ = session.scene.object_pose(session.data, "thing")
    run(session, SETTLED)
    after, _ = session.scene.object_pose(session.data, "thing")
    assert session.solid(0) == {0, 1}
    assert np.linalg.norm(after - before) < 0.0005
