"""Hands of any size: what scales with them, and how a size is told from touches."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.capture import Capture
from encoders.captures.subject import FROZEN, SEED, simulate
from encoders.input_vector import contact_vectors
from encoders.person.hand_size import SPREADS, HandSizes, builtin_sizes
from encoders.person.natural_layout import of_capture
from encoders.reconstruction.reconstructor import Reconstruction
from encoders.regression.trained import builtin, builtin_capture
from models.errors import CaptureError, InputError
from models.frames import Contact, TouchFrame
from models.hand import Hand
from models.kinematics import Kinematics
from models.person import Person
from models.pose import absolute_pose
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT, Skeleton
from models.surface import Surface
from sandbox.devices.simulated.spreads import _SPREADS, spread_layout
from sandbox.trial.assembly import build
from sandbox.trial.settings import HandSettings, Settings
from tests.support.scripted import Script

GRASP = np.array([(-0.03, 0.03), (0.0, -0.03), (0.025, -0.035), (0.045, -0.025), (0.055, 0.0)])

CROSS = 0.02 * np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)])
"""m; five touches, but no hand's."""


def someone(size: float = 1.0) -> list[np.ndarray]:
    """Three spreads (5, 2) m of a person who is not the trained subject, thumb first."""
    return [size * spread_layout(ADULT, *np.deg2rad(spread)) * [1.0, -1.0] for spread in _SPREADS]


def turned(xy: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return xy @ np.array([[c, s], [-s, c]])


def reconstructed(size: float, touched: float) -> tuple[Surface, list[Reconstruction]]:
    """What the default settings make of touches `touched` times as far apart, on such a screen."""
    screen = (7.76 * touched, 5.82 * touched)
    settings = Settings(hands=(HandSettings(size=size),)).changed(size_in=screen)
    made = build(settings, (lambda task, surface: Script(),))
    reconstructor: Any = made.rigs[0].reconstructor
    found = []
    for now in np.arange(110) * 0.016:
        xy = touched * (GRASP + np.array([0.09 + 0.01 * np.sin(2 * now), 0.075]))
        contacts = tuple(Contact(i, float(x), float(y)) for i, (x, y) in enumerate(xy))
        found.append(reconstructor.step(TouchFrame(now, contacts)))
    return reconstructor.surface, found


@pytest.mark.parametrize("size", [0.85, 1.15])
def test_a_larger_hand_on_a_larger_screen_takes_the_same_pose_larger(size: float) -> None:
    _, plain = reconstructed(1.0, 1.0)
    _, sized = reconstructed(size, size)
    assert plain[-1].down and len(plain[-1].fingers) == 5
    for a, b in zip(plain, sized, strict=True):
        np.testing.assert_allclose(b.q[3:], a.q[3:], atol=1e-9)
        np.testing.assert_allclose(b.q[:2], size * a.q[:2], atol=1e-9)
        assert a.phase == b.phase and a.fingers == b.fingers


@pytest.mark.parametrize("size", [0.85, 0.93, 1.15])
def test_fingertips_of_a_hand_of_any_size_are_on_the_real_touches(size: float) -> None:
    surface, found = reconstructed(size, 1.0)
    last = found[-1]
    assert last.down and last.tip_error < 1e-3
    tips = Kinematics(Person(hand_size=size).skeleton(ADULT)).tips(last.q)
    for contact in last.contacts:
        off = np.linalg.norm(surface.to_surface(tips[contact.label]) - [contact.x, contact.y])
        assert off < 1e-3


def test_flesh_grows_with_the_third_power_of_the_size() -> None:
    def mass(skeleton: Skeleton) -> np.ndarray:
        return Scene(SceneSpec((Hand(skeleton=skeleton),))).model.body_mass[1:]

    np.testing.assert_allclose(mass(ADULT.scaled(1.2)), 1.2**3 * mass(ADULT), rtol=1e-6)


sizes = st.floats(0.8, 1.25)
angles = st.floats(-1.5, 1.5)


@given(size=sizes, angle=angles, order=st.permutations(range(5)), x=st.floats(-1, 1))
@settings(max_examples=30)
def test_the_size_does_not_depend_on_place_turn_or_order_and_grows_with_the_touches(
    size: float, angle: float, order: list[int], x: float
) -> None:
    plain = builtin_sizes().estimate(someone())
    moved = [turned(size * xy, angle)[list(order)] + [x, 2 * x] for xy in someone()]
    found = builtin_sizes().estimate([moved[2], moved[0], moved[1]])
    assert found.ratio == pytest.approx(size * plain.ratio, rel=1.5e-3)
    assert found.low == pytest.approx(size * plain.low, rel=1.5e-3)
    assert found.high == pytest.approx(size * plain.high, rel=1.5e-3)
    assert found.low < found.ratio < found.high


def own_spreads(capture: Capture, seed: int) -> list[np.ndarray]:
    """A relaxed, a closed and a wide layout of the trained subject, by the size of all it did."""
    xy = capture.xy[capture.down.all(axis=1)]
    size = np.linalg.norm(xy - xy.mean(axis=1, keepdims=True), axis=(1, 2))
    order = np.argsort(size)
    pick = np.random.default_rng(seed)
    ranks = [rank + pick.uniform(-0.04, 0.04) for rank in (0.5, 0.06, 0.94)]
    return [xy[order[round(rank * (len(order) - 1))]] for rank in ranks]


def test_the_trained_subjects_own_spreads_say_that_its_hand_is_its_hand() -> None:
    found = []
    for seed in range(12):
        # A single one may be an odd moment of the subject's, and is then refused.
        try:
            size = builtin_sizes().estimate(own_spreads(builtin_capture(), seed))
        except InputError:
            continue
        found.append(size.ratio)
        assert size.low < 1.0 < size.high
    assert len(found) >= 9
    assert np.mean(found) == pytest.approx(1.0, abs=0.04)


@pytest.mark.parametrize("size", [0.85, 0.9, 1.0, 1.1, 1.15])
def test_the_interval_holds_the_size_of_somebody_whose_habits_are_others(size: float) -> None:
    found = builtin_sizes().estimate(someone(size))
    assert found.low < size < found.high
    assert found.ratio == pytest.approx(size, rel=0.12)


def test_one_misunderstood_spread_does_not_decide_alone() -> None:
    natural, closed, wide = someone()
    plain = builtin_sizes().estimate([natural, closed, wide])
    # Hardly closed at all: by itself, this spread would say a hand half as large again.
    odd = builtin_sizes().estimate([natural, 0.8 * natural, wide])
    assert odd.alone[SPREADS.index("closed")] > 1.3 * plain.alone[SPREADS.index("natural")]
    assert odd.ratio < 1.15 * plain.ratio


@pytest.mark.parametrize(
    ("layouts_of", "says"),
    [
        (lambda spreads: [], "three spreads"),
        (lambda spreads: spreads[:2], "three spreads"),
        (lambda spreads: [xy[:4] for xy in spreads], "three spreads"),
        (lambda spreads: [*spreads[:2], np.full((5, 2), np.nan)], "three spreads"),
        (lambda spreads: [spreads[0]] * 3, "hardly different"),
        (lambda spreads: [spreads[0] * 1.02**i for i in range(3)], "hardly different"),
        (lambda spreads: [s * CROSS for s in (1.0, 1.7, 2.5)], "like those of a hand"),
        (lambda spreads: [3 * xy for xy in spreads], "do not determine"),
    ],
)
def test_layouts_that_do_not_determine_the_size_are_refused_with_the_reason(
    layouts_of: Callable[[list[np.ndarray]], list[np.ndarray]], says: str
) -> None:
    layouts = layouts_of(someone())
    with pytest.raises(InputError, match=says):
        builtin_sizes().estimate(layouts)


def test_scattered_touches_are_not_accepted_as_a_hand() -> None:
    rng = np.random.default_rng(4)
    refused = 0
    for _ in range(50):
        try:
            builtin_sizes().estimate([rng.uniform(0, a, (5, 2)) for a in (0.06, 0.1, 0.18)])
        except InputError:
            refused += 1
    assert refused >= 48


def test_a_capture_without_five_fingers_has_no_hand_to_compare_with() -> None:
    capture = builtin_capture()
    few = capture.select(capture.down.sum(axis=1) < 5)
    with pytest.raises(CaptureError, match="five"):
        HandSizes(few)


@given(angle=st.floats(-3.1, 3.1), size=st.floats(0.5, 2.0), order=st.permutations(range(5)))
def test_five_fingers_are_told_apart_however_the_hand_is_turned(
    angle: float, size: float, order: list[int]
) -> None:
    # A turn of the surface's frame, whose y points down, is clockwise seen from above.
    xy = turned(size * someone()[0], -angle)[list(order)] + [0.1, 0.2]
    layout = of_capture(builtin_capture())
    match = layout.match(xy)
    assert match.labels.tolist() == list(order)
    straight = layout.match(someone()[0]).turn
    assert np.cos(match.turn - straight - angle) > 1 - 1e-9


def test_most_frames_of_the_trained_subject_are_told_apart_whatever_their_turn() -> None:
    capture = builtin_capture()
    layout = of_capture(capture)
    right = total = 0
    for k, least in ((5, 0.95), (4, 0.80)):
        frames = np.flatnonzero(capture.down.sum(axis=1) == k)[::15]
        for frame in frames:
            fingers = np.flatnonzero(capture.down[frame])
            xy = turned(capture.xy[frame, fingers], 2.0)
            right += layout.match(xy).labels.tolist() == fingers.tolist()
            total += 1
        assert right / total > least


QUICK = replace(FROZEN, test_frames=(60, 60, 60, 60))


def small_hand(size: float) -> Capture:
    return simulate(QUICK, SEED, 4, skeleton=ADULT.scaled(size))


def test_a_subject_with_a_smaller_hand_touches_closer_together_and_with_its_own_fingertips() -> (
    None
):
    plain, small = simulate(QUICK, SEED, 4), small_hand(0.85)
    assert small.meta["skeleton"] == ADULT.scaled(0.85).name != plain.meta["skeleton"]

    def spread(capture: Capture) -> float:
        xy = capture.xy[capture.down.all(axis=1)]
        return float(np.linalg.norm(xy - xy.mean(axis=1, keepdims=True), axis=(1, 2)).mean())

    assert spread(small) / spread(plain) == pytest.approx(0.85, abs=0.05)

    def off(skeleton: Skeleton) -> float:
        """m, mean distance seen from above between fingertips and touches."""
        tips = Kinematics(skeleton).tips(small.q)[..., :2] * [1.0, -1.0]
        return float(np.linalg.norm(tips - small.xy, axis=2)[small.down].mean())

    assert off(ADULT.scaled(0.85)) < 0.006 < off(ADULT)


@pytest.mark.parametrize("size", [0.85, 1.15])
def test_touches_scaled_to_the_trained_hand_bring_the_wrist_nearer(size: float) -> None:
    capture, encoder = small_hand(size), builtin("quadratic").encoder

    def error(used: float) -> float:
        u, leftmost = contact_vectors(capture.xy / used)
        q = absolute_pose(encoder.predict(u), leftmost)
        return float(np.linalg.norm(used * q[:, :3] - capture.q[:, :3], axis=1).mean())

    assert error(size) < 0.95 * error(1.0)


def test_a_surface_of_another_size_changes_nothing_but_its_middle() -> None:
    # The wrapper's surface is in the trained hand's metres; what leaves it is in real ones.
    settings = Settings(hands=(HandSettings(size=0.9),)).changed(size_in=(9.0, 7.0))
    session = build(settings, (lambda task, surface: None,))
    reconstructor = session.rigs[0].reconstructor
    assert reconstructor.surface.size == pytest.approx(Surface(9.0, 7.0).size)
    tips = Kinematics(session.rigs[0].hand.skeleton).tips(reconstructor.commanded)
    middle = reconstructor.surface.to_world(reconstructor.surface.size / 2)
    np.testing.assert_allclose(tips.mean(axis=0)[:2], middle[:2], atol=0.02)
