"""Hands of any size: what scales with them, and how a size is told from touches."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.person.hand_size import builtin_sizes
from encoders.person.natural_layout import of_capture
from encoders.reconstruction.reconstructor import Reconstruction
from encoders.regression.trained import builtin_capture
from models.errors import InputError
from models.frames import Contact, TouchFrame
from models.kinematics import Kinematics
from models.person import Person
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.devices.simulated.spreads import _SPREADS, spread_layout
from sandbox.trial.assembly import build
from sandbox.trial.settings import HandSettings, Settings
from tests.encoders.regression.turning import turned_places
from tests.support.scripted import Script

GRASP = np.array([(-0.03, 0.03), (0.0, -0.03), (0.025, -0.035), (0.045, -0.025), (0.055, 0.0)])

CROSS = 0.02 * np.array([(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)])
"""m; five touches, but no hand's."""


def someone(size: float = 1.0) -> list[np.ndarray]:
    """Three spreads (5, 2) m of a person who is not the trained subject, thumb first."""
    return [size * spread_layout(ADULT, *np.deg2rad(spread)) * [1.0, -1.0] for spread in _SPREADS]


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


sizes = st.floats(0.8, 1.25)
angles = st.floats(-1.5, 1.5)


@given(size=sizes, angle=angles, order=st.permutations(range(5)), x=st.floats(-1, 1))
@settings(max_examples=30)
def test_the_size_does_not_depend_on_place_turn_or_order_and_grows_with_the_touches(
    size: float, angle: float, order: list[int], x: float
) -> None:
    plain = builtin_sizes().estimate(someone())
    moved = [
        turned_places(size * xy, angle, (0.0, 0.0))[list(order)] + [x, 2 * x] for xy in someone()
    ]
    found = builtin_sizes().estimate([moved[2], moved[0], moved[1]])
    assert found.ratio == pytest.approx(size * plain.ratio, rel=1.5e-3)
    assert found.low == pytest.approx(size * plain.low, rel=1.5e-3)
    assert found.high == pytest.approx(size * plain.high, rel=1.5e-3)
    assert found.low < found.ratio < found.high


@pytest.mark.parametrize("size", [0.85, 0.9, 1.0, 1.1, 1.15])
def test_the_interval_holds_the_size_of_somebody_whose_habits_are_others(size: float) -> None:
    found = builtin_sizes().estimate(someone(size))
    assert found.low < size < found.high
    assert found.ratio == pytest.approx(size, rel=0.12)


@pytest.mark.parametrize(
    "layouts_of",
    [
        lambda spreads: [],
        lambda spreads: spreads[:2],
        lambda spreads: [xy[:4] for xy in spreads],
        lambda spreads: [*spreads[:2], np.full((5, 2), np.nan)],
        lambda spreads: [spreads[0] * 1.02**i for i in range(3)],
        lambda spreads: [s * CROSS for s in (1.0, 1.7, 2.5)],
        lambda spreads: [3 * xy for xy in spreads],
    ],
)
def test_layouts_that_do_not_determine_the_size_are_refused(
    layouts_of: Callable[[list[np.ndarray]], list[np.ndarray]],
) -> None:
    layouts = layouts_of(someone())
    with pytest.raises(InputError):
        builtin_sizes().estimate(layouts)


@given(angle=st.floats(-3.1, 3.1), size=st.floats(0.5, 2.0), order=st.permutations(range(5)))
def test_five_fingers_are_told_apart_however_the_hand_is_turned(
    angle: float, size: float, order: list[int]
) -> None:
    xy = turned_places(size * someone()[0], angle, (0.0, 0.0))[list(order)] + [0.1, 0.2]
    layout = of_capture(builtin_capture())
    match = layout.match(xy)
    assert match.labels.tolist() == list(order)
    straight = layout.match(someone()[0]).turn
    assert np.cos(match.turn - straight - angle) > 1 - 1e-9
