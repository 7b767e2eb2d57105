"""The lift control: the hand rises by it, quietly, and everything else stays as it was."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.reconstruction.hand_motion import Lift, LiftSettings
from encoders.reconstruction.reconstructor import Reconstruction
from models.errors import InputError
from models.frames import Contact, TouchFrame
from models.kinematics import Kinematics
from sandbox.devices.wrappers.playing import SPEED, LiftKeys
from sandbox.trial.assembly import build, with_lift
from sandbox.trial.settings import HandSettings, Settings
from tasks.box_to_goal import BoxToGoal
from tasks.stack import Stack
from tests.support.scripted import Played, Script

PERIOD = 0.016


def touches(now: float) -> tuple[Contact, ...]:
    """Thumb and index, at rest, from 0.1 s on; far from both boxes of seed 1."""
    if now < 0.1:
        return ()
    return (Contact(1, 0.08, 0.13, label=0), Contact(2, 0.12, 0.13, label=1))


def poses(
    control: Callable[[float], float | None],
    seconds: float = 1.2,
    task: str = "stack",
    **settings: Any,
) -> list[Reconstruction]:
    """What is reconstructed with a lift control that is time -> its position."""
    options = Settings(task=task, seed=1, **settings)
    made = build(options, (lambda task, surface: Script(),))
    reconstructor: Any = made.rigs[0].reconstructor
    times = np.arange(round(seconds / PERIOD)) * PERIOD
    return [reconstructor.step(TouchFrame(t, touches(t), control(t))) for t in times]


def held(position: float) -> Callable[[float], float]:
    """A lift control that never moves."""
    return lambda t: position


def test_without_a_lift_control_the_hand_is_where_it_is_with_one_at_rest() -> None:
    for a, b in zip(poses(lambda t: None), poses(lambda t: 0.0), strict=True):
        np.testing.assert_array_equal(a.q, b.q)
        assert a.phase == b.phase


def test_tasks_without_a_lift_take_no_notice_of_it() -> None:
    still = poses(lambda t: None, task="box-to-goal")
    moved = poses(lambda t: 0.7, task="box-to-goal")
    for a, b in zip(still, moved, strict=True):
        np.testing.assert_array_equal(a.q, b.q)


@pytest.mark.parametrize(
    "hand", [HandSettings(), HandSettings(size=1.2), HandSettings("left", turn=90)]
)
def test_every_hand_rises_by_the_tasks_range_and_keeps_its_place_otherwise(
    hand: HandSettings,
) -> None:
    low, high = (poses(held(x), seconds=3.0, hands=(hand,))[-1] for x in (0.0, 0.5))
    assert low.down and high.down and low.fingers == high.fingers
    rise = high.q - low.q
    assert rise[2] == pytest.approx(0.5 * Stack.lift_range, abs=1e-4)
    np.testing.assert_allclose(np.delete(rise, 2), 0.0, atol=1e-9)


def test_a_hand_that_is_lifted_while_it_is_down_stays_down_and_keeps_its_fingers() -> None:
    found = poses(lambda t: 0.0 if t < 1.2 else 1.0, seconds=3.0)
    first = next(i for i, r in enumerate(found) if r.down)
    assert first * PERIOD < 1.2
    assert all(r.down and r.fingers == found[first].fingers for r in found[first:])
    assert found[-1].q[2] - found[first].q[2] > 0.9 * Stack.lift_range


def test_a_hand_that_comes_while_the_lift_is_up_comes_down_to_its_height() -> None:
    low, high = (poses(held(x), seconds=3.0) for x in (0.0, 0.8))
    when = [next(i for i, r in enumerate(found) if r.down) for found in (low, high)]
    assert when[0] == when[1]
    tips = Kinematics(build(Settings(), (lambda t, s: None,)).rigs[0].hand.skeleton).tips
    rise = tips(high[-1].q)[:2, 2] - tips(low[-1].q)[:2, 2]
    np.testing.assert_allclose(rise, 0.8 * Stack.lift_range, atol=1e-4)


def test_a_noisy_slider_hardly_shakes_the_hand() -> None:
    rng = np.random.default_rng(3)
    lift = Lift(LiftSettings(reach=0.18))
    heights, wanted = [], []
    for _ in range(3_000):
        control = float(np.clip(0.5 + 0.03 * rng.normal(), 0.0, 1.0))
        lift.step(control, PERIOD)
        heights.append(lift.height)
        wanted.append(0.18 * control)
    assert np.std(heights[500:]) < 0.3 * np.std(wanted)
    assert np.mean(heights[500:]) == pytest.approx(0.09, abs=3e-4)


@given(st.lists(st.floats(0.0, 1.0) | st.none(), min_size=1, max_size=60), st.floats(0.0, 0.3))
def test_no_lift_control_moves_the_hand_faster_than_it_may_or_out_of_its_range(
    controls: list[float], reach: float
) -> None:
    settings = LiftSettings(reach=reach)
    lift = Lift(settings)
    before = 0.0
    for control in controls:
        lift.step(control, PERIOD)
        assert abs(lift.height - before) <= settings.speed * PERIOD + 1e-12
        assert -1e-12 <= lift.height <= reach + 1e-12
        before = lift.height
    lift.reset()
    assert lift.height == 0.0


def still() -> Played:
    """A device that gives one frame, and no other for a long time."""
    return Played([TouchFrame(0.0, (Contact(4, 0.01, 0.02),)), TouchFrame(1e9)])


def polled(keys: LiftKeys, begin: float, seconds: float) -> list[TouchFrame]:
    times = begin + np.arange(1, round(seconds / PERIOD) + 1) * PERIOD
    return [frame for t in times for frame in keys.poll(float(t))]


def test_a_key_that_is_held_lifts_and_a_key_let_go_holds_still() -> None:
    keys = LiftKeys(still())
    (first,) = keys.poll(0.0)
    assert first.lift == 0.0
    keys.hold(1.0)
    up = polled(keys, 0.0, 0.8)
    assert up[-1].lift == pytest.approx(0.8 * SPEED, rel=0.03)
    assert all(b.lift > a.lift for a, b in pairwise(up))
    assert all(frame.contacts == first.contacts for frame in up), "the touches stay"
    keys.hold(0.0)
    assert polled(keys, 0.8, 0.3) == [], "nothing new is nothing to say"
    keys.hold(-1.0)
    assert polled(keys, 1.1, 3.0)[-1].lift == 0.0
    keys.hold(1.0)
    assert polled(keys, 4.1, 5.0)[-1].lift == 1.0


def test_a_key_tapped_between_two_polls_does_something() -> None:
    keys = LiftKeys(still())
    keys.poll(0.0)
    keys.hold(1.0)
    keys.hold(0.0)
    assert keys.poll(PERIOD)[0].lift > 0.0
    assert keys.poll(2 * PERIOD) == []


@pytest.mark.parametrize("keys", [True, False])
def test_a_task_that_needs_a_lift_control_gets_one_or_says_so(keys: bool) -> None:
    device = still()
    (make,) = with_lift((lambda task, surface: device,), keys)
    surface = Settings().surface.rectangle
    assert make(BoxToGoal.draw(1, surface), surface) is device
    task = Stack.draw(1, surface)
    if keys:
        lifted: Any = make(task, surface)
        assert lifted.device is device
        return
    with pytest.raises(InputError, match="needs a lift control") as error:
        make(task, surface)
    assert "sandbox play stack" in str(error.value)
    assert device.finished, "it is closed"
