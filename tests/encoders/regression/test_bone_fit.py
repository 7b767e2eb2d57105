"""Bones fitted to touches are the bones that made the touches."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.capture import Capture
from encoders.correction import PAD_HEIGHT
from encoders.regression.bone_fit import (
    KNUCKLE_SPREAD,
    fitted_skeleton,
    perturbed_skeleton,
    tip_misses,
)
from models.kinematics import Kinematics
from models.skeleton import ADULT, Skeleton
from tests.support.simulation import random_pose

seeds = st.integers(0, 2**16)


def another(seed: int, length: float = 0.06, knuckle: float = 0.004) -> Skeleton:
    return perturbed_skeleton(ADULT, np.random.default_rng(seed), length, knuckle)


def touched_by(skeleton: Skeleton, frames: int, fingers: tuple[int, ...], seed: int) -> Capture:
    """Any legal poses, one finger at a time on the surface: touches are exact."""
    rng = np.random.default_rng(seed)
    q = np.stack([random_pose(rng) for _ in range(frames)])
    chosen, every = np.resize(fingers, frames), np.arange(frames)
    q[:, 2] += PAD_HEIGHT - Kinematics(skeleton).tips(q)[every, chosen, 2]
    xy, ids = np.full((frames, 5, 2), np.nan), np.full((frames, 5), -1)
    xy[every, chosen] = Kinematics(skeleton).tips(q)[every, chosen, :2] * [1, -1]
    ids[every, chosen] = every
    return Capture(0.01 * every.astype(float), np.zeros(frames, int), ids, xy, q)


def tips_apart(a: Skeleton, b: Skeleton, q: np.ndarray) -> np.ndarray:
    """(T, 5) m between fingertips of two hands in the same poses."""
    return np.linalg.norm(Kinematics(a).tips(q) - Kinematics(b).tips(q), axis=-1)


UNSEEN = np.stack([random_pose(np.random.default_rng(i)) for i in range(200)])


@settings(max_examples=15)
@given(seed=seeds)
def test_exact_touches_give_back_the_bones_themselves(seed: int) -> None:
    person = another(seed)
    fitted = fitted_skeleton(touched_by(person, 1000, (0, 1, 2, 3, 4), seed + 1), ADULT)
    off = tips_apart(fitted, person, UNSEEN)
    assert off.mean() < 0.0002 and off.max() < 0.001
    for found, wanted in zip(fitted.bones, person.bones, strict=True):
        np.testing.assert_allclose(found.length, wanted.length, atol=0.001)
        np.testing.assert_allclose(found.anchor, wanted.anchor, atol=0.001)


@given(seed=seeds)
def test_one_touch_of_each_finger_is_missed_by_less_and_the_bones_stay_near_the_known_ones(
    seed: int,
) -> None:
    capture = touched_by(another(seed), 5, (0, 1, 2, 3, 4), seed)
    fitted = fitted_skeleton(capture, ADULT)
    after, before = (
        np.linalg.norm(tip_misses(Kinematics(skeleton), capture), axis=1)
        for skeleton in (fitted, ADULT)
    )
    assert (after <= before + 1e-12).all()
    for i in ADULT.first_bone:
        moved = np.subtract(fitted.bones[i].anchor, ADULT.bones[i].anchor)
        assert np.abs(moved).max() < 3 * KNUCKLE_SPREAD


@settings(max_examples=15)
@given(seed=seeds, finger=st.integers(0, 4))
def test_a_finger_that_never_touches_keeps_its_bones(seed: int, finger: int) -> None:
    others = tuple(f for f in range(5) if f != finger)
    fitted = fitted_skeleton(touched_by(another(seed), 80, others, seed), ADULT)
    for found, known in zip(fitted.bones, ADULT.bones, strict=True):
        same = (found.length, found.anchor) == (known.length, known.anchor)
        assert same == (known.finger == finger)


@settings(max_examples=15)
@given(seed=seeds, shift=st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)))
def test_the_order_of_frames_and_where_the_hand_was_do_not_matter(
    seed: int, shift: tuple[float, float]
) -> None:
    capture = touched_by(another(seed), 60, (0, 1, 2, 3, 4), seed)
    q = capture.q.copy()
    q[:, :2] += [shift[0], -shift[1]]
    order = np.random.default_rng(seed).permutation(len(capture))
    moved = replace(capture, q=q, xy=capture.xy + shift).select(order)
    once, other = fitted_skeleton(capture, ADULT), fitted_skeleton(moved, ADULT)
    assert tips_apart(once, other, UNSEEN).max() < 1e-9


def test_more_frames_of_the_same_touches_say_nothing_new_beyond_a_few_hundred() -> None:
    """Frames of a take nearly repeat each other; their number must not overrule what is known."""
    capture = touched_by(another(3), 1000, (0, 1, 2, 3, 4), 3)
    twice = capture.select(np.tile(np.arange(len(capture)), 2))
    once, other = fitted_skeleton(capture, ADULT), fitted_skeleton(twice, ADULT)
    assert tips_apart(once, other, UNSEEN).max() < 1e-9
