"""The simulated user's hand is one that people have: distances, arc, openings and room."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arithmetic import Array
from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.device import Device, DeviceWrapper
from sandbox.trial.assembly import DeviceMaker, device_makers
from sandbox.trial.driver import open_trial
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.registry import TASKS
from tasks.simulated_user.grasp import grasp_across
from tasks.simulated_user.user_hand import NARROWEST, Hand
from tasks.task import Task
from tasks.user import UserConfiguration

people = st.integers(0, 100_000)
LONGEST = 0.110
"""m, the widest opening of a middling hand."""
STRAY = 0.008
"""m by which touches may be off where they should be: aim, tremor and noise of two fingers."""


def hand_of(seed: int, fingers: int = 5, size: float = 1.0) -> Hand:
    return Hand.draw(UserConfiguration(fingers=fingers, hand_size=size), seed)


def test_neighbours_are_as_far_apart_as_those_of_147_real_layouts() -> None:
    tips = np.array([hand_of(seed).tips for seed in range(4_000)])
    apart = np.linalg.norm(np.diff(tips, axis=1), axis=2)
    real = [[25, 19, 25], [29, 23, 31], [34, 26, 36]]
    found = 1000 * np.percentile(apart, [10, 50, 90], axis=0)
    np.testing.assert_allclose(found, real, atol=0.5)


@given(seed=people, size=st.floats(0.6, 1.6))
def test_a_hand_of_any_size_has_its_fingers_on_an_arc_and_beside_each_other(
    seed: int, size: float
) -> None:
    tips = np.array(hand_of(seed, size=size).tips)
    ways = np.diff(tips, axis=0)
    turns = ways[:-1, 0] * ways[1:, 1] - ways[:-1, 1] * ways[1:, 0]
    assert np.all(turns < 0.0)
    assert tips[:, 1].argmax() == 1, "the middle finger reaches farthest"
    assert tips[:, 1].argmin() == 3, "the little finger reaches least"
    assert min(np.hypot(*(a - b)) for a, b in combinations(tips, 2)) > NARROWEST


@given(seed=people, size=st.floats(0.9, 1.6))
def test_distances_of_fingers_grow_with_the_hand(seed: int, size: float) -> None:
    one, other = np.array(hand_of(seed).tips), np.array(hand_of(seed, size=size).tips)
    np.testing.assert_allclose(other, size * one)


@given(seed=people, n=st.integers(2, 5), face=st.floats(0.005, 0.15))
def test_as_many_fingers_touch_as_are_wanted_and_have_room(seed: int, n: int, face: float) -> None:
    hand = hand_of(seed, n)
    touching = hand.fitting(face)
    assert 2 <= touching <= n
    assert touching == 2 or hand.length(touching) < face
    assert touching == n or hand.length(touching + 1) > face - 0.005
    row = hand.row(touching)
    assert row.shape == (touching - 1, 2)
    assert np.all(row[1:-1, 1] > 0.0), "the row is an arc"
    np.testing.assert_allclose(row[[0, -1], 1], 0.0, atol=1e-12)


@given(
    seed=people,
    n=st.integers(2, 5),
    width=st.floats(0.02, 0.06),
    face=st.floats(0.04, 0.06),
    yaw=st.floats(-0.78, 0.78),
)
def test_the_hand_opens_as_far_as_people_do(
    seed: int, n: int, width: float, face: float, yaw: float
) -> None:
    hand = hand_of(seed, n)
    grasp = grasp_across(hand.natural_axis + yaw, width, face, hand)
    opening = width + 2 * (0.007 + grasp.opening(hand))
    assert 0.045 <= opening <= 0.0851
    places = grasp.places(np.zeros(2), grasp.opening(hand), hand)
    assert np.hypot(*(places[1:] - places[0]).T).max() <= LONGEST
    along = np.array([np.cos(grasp.axis), np.sin(grasp.axis)])
    np.testing.assert_allclose((places[[1, -1]] - places[0]) @ along, opening)
    beside = (places @ np.array([along[1], -along[0]]))[[0, 1, -1]]
    assert np.all(np.abs(beside) <= face / 2), "thumb and fingers are on the face"


@given(seed=people, yaw=st.floats(-0.785, 0.785))
def test_thumb_and_index_lie_as_those_of_people_who_pinch(seed: int, yaw: float) -> None:
    hand = hand_of(seed, 2)
    grasp = grasp_across(hand.natural_axis + yaw, 0.05, 0.05, hand)
    thumb, index = grasp.places(np.zeros(2), grasp.opening(hand), hand)
    direction = np.rad2deg(np.arctan2(*(index - thumb)[::-1]))
    assert 10.0 < direction < 80.0


class Watched(DeviceWrapper):
    """Keeps the simulated user's frames."""

    def __init__(self, device: Device) -> None:
        super().__init__(device)
        self.frames: list[TouchFrame] = []

    def poll(self, now: float) -> Sequence[TouchFrame]:
        frames = super().poll(now)
        self.frames += frames
        return frames

    def hands(self) -> list[Array]:
        """Touches (n, 2) m of every frame, thumb first."""
        truth = self.true_labels
        found = []
        for frame in self.frames:
            own = sorted(frame.contacts, key=lambda c: truth[c.id])
            found.append(np.array([(c.x, c.y) for c in own]).reshape(-1, 2))
        return found


def played(
    task: str, seed: int, fingers: int, seconds: float = 5.0, **options: Any
) -> list[Watched]:
    """The first seconds of a trial."""
    chosen = trial_settings(TrialOptions(task=task, seed=seed, fingers=fingers, **options))
    opened: list[Watched] = []

    def watched(make: DeviceMaker) -> DeviceMaker:
        def open_device(task: Task, surface: Surface) -> Watched:
            opened.append(Watched(make(task, surface)))
            return opened[-1]

        return open_device

    makers = tuple(watched(make) for make in device_makers(chosen))
    with open_trial(chosen, makers) as trial:
        trial.run(stop=lambda: trial.session.time > seconds)
    return opened


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("fingers", [2, 3, 5])
def test_no_two_fingers_are_ever_nearer_than_real_ones_nor_wider_apart(
    task: str, fingers: int
) -> None:
    # Every combination has a person of its own.
    seed = 8_000 + 10 * list(TASKS).index(task) + fingers
    for device in played(task, seed, fingers, seconds=3.0):
        hands = [hand for hand in device.hands() if len(hand) > 1]
        assert hands, "the user touches"
        for hand in hands:
            apart = [float(np.hypot(*(a - b))) for a, b in combinations(hand, 2)]
            assert min(apart) >= NARROWEST and max(apart) < LONGEST + STRAY


def test_a_hand_at_the_border_of_the_screen_stops_as_a_whole() -> None:
    size = np.array(Settings().surface.size_in) * 0.0254
    at_border = 0
    for seed in range(8_000, 8_005):
        (device,) = played("wrench-slide", seed, 5)
        for hand in device.hands():
            if len(hand) < 2:
                continue
            at_border += bool(np.isclose(hand, 0.001).any() or np.isclose(hand, size - 0.001).any())
            assert min(np.hypot(*(a - b)) for a, b in combinations(hand, 2)) >= NARROWEST
            assert np.all((hand >= 0.001 - 1e-9) & (hand <= size - 0.001 + 1e-9))
    assert at_border > 20
