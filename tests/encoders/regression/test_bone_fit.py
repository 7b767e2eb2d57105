"""Bones fitted to touches are the bones that made the touches."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.capture import Capture
from encoders.correction import PAD_HEIGHT, tip_targets
from encoders.regression.bone_fit import (
    KNUCKLE_SPREAD,
    fitted_skeleton,
    perturbed_skeleton,
    tip_misses,
)
from encoders.regression.trained import builtin_capture
from models.kinematics import Kinematics
from models.skeleton import ADULT, Skeleton
from tests.support.simulation import random_pose

seeds = st.integers(0, 2**16)
TABLE = Kinematics(ADULT)


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
def test_exact_touches_give_back_the_fingertips_of_the_hand_that_made_them(seed: int) -> None:
    person = another(seed)
    fitted = fitted_skeleton(touched_by(person, 1000, (0, 1, 2, 3, 4), seed + 1), ADULT)
    off = tips_apart(fitted, person, UNSEEN)
    assert off.mean() < 0.0002 and off.max() < 0.001
    assert off.mean() < 0.05 * tips_apart(ADULT, person, UNSEEN).mean()


@settings(max_examples=15)
@given(seed=seeds)
def test_exact_touches_give_back_the_bones_themselves(seed: int) -> None:
    person = another(seed)
    fitted = fitted_skeleton(touched_by(person, 1000, (0, 1, 2, 3, 4), seed + 1), ADULT)
    for found, wanted in zip(fitted.bones, person.bones, strict=True):
        np.testing.assert_allclose(found.length, wanted.length, atol=0.001)
        np.testing.assert_allclose(found.anchor, wanted.anchor, atol=0.001)


@settings(max_examples=15)
@given(seed=seeds, finger=st.integers(0, 4))
def test_a_finger_that_never_touches_keeps_its_bones(seed: int, finger: int) -> None:
    others = tuple(f for f in range(5) if f != finger)
    fitted = fitted_skeleton(touched_by(another(seed), 80, others, seed), ADULT)
    for found, known in zip(fitted.bones, ADULT.bones, strict=True):
        same = (found.length, found.anchor) == (known.length, known.anchor)
        assert same == (known.finger == finger)


@settings(max_examples=15)
@given(seed=seeds)
def test_touches_that_the_known_hand_explains_leave_it_as_it_is(seed: int) -> None:
    fitted = fitted_skeleton(touched_by(ADULT, 100, (0, 1, 2, 3, 4), seed), ADULT)
    assert tips_apart(fitted, ADULT, UNSEEN).max() < 1e-9


@given(seed=seeds)
def test_of_one_touch_the_bones_explain_more_than_before_and_stay_near_the_known_ones(
    seed: int,
) -> None:
    capture = touched_by(another(seed), 5, (0, 1, 2, 3, 4), seed)
    fitted = fitted_skeleton(capture, ADULT)
    before = np.linalg.norm(tip_misses(TABLE, capture), axis=1)
    after = np.linalg.norm(tip_misses(Kinematics(fitted), capture), axis=1)
    assert (after <= before + 1e-12).all()
    moved = [
        np.subtract(a.anchor, b.anchor) for a, b in zip(fitted.bones, ADULT.bones, strict=True)
    ]
    assert np.abs([moved[i] for i in ADULT.first_bone]).max() < 3 * KNUCKLE_SPREAD


@settings(max_examples=15)
@given(seed=seeds)
def test_the_order_of_frames_does_not_matter(seed: int) -> None:
    capture = touched_by(another(seed), 60, (0, 1, 2, 3, 4), seed)
    order = np.random.default_rng(seed).permutation(len(capture))
    once, other = fitted_skeleton(capture, ADULT), fitted_skeleton(capture.select(order), ADULT)
    assert tips_apart(once, other, UNSEEN).max() < 1e-9


@settings(max_examples=15)
@given(seed=seeds, shift=st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)))
def test_where_on_the_surface_the_hand_was_does_not_matter(
    seed: int, shift: tuple[float, float]
) -> None:
    capture = touched_by(another(seed), 60, (0, 1, 2, 3, 4), seed)
    q = capture.q.copy()
    q[:, :2] += [shift[0], -shift[1]]
    moved = replace(capture, q=q, xy=capture.xy + shift)
    once, other = fitted_skeleton(capture, ADULT), fitted_skeleton(moved, ADULT)
    assert tips_apart(once, other, UNSEEN).max() < 1e-9


def test_more_frames_of_the_same_touches_say_nothing_new_beyond_a_few_hundred() -> None:
    """Frames of a take nearly repeat each other; their number must not overrule what is known."""
    capture = touched_by(another(3), 1000, (0, 1, 2, 3, 4), 3)
    twice = capture.select(np.tile(np.arange(len(capture)), 2))
    once, other = fitted_skeleton(capture, ADULT), fitted_skeleton(twice, ADULT)
    assert tips_apart(once, other, UNSEEN).max() < 1e-9


def test_only_lengths_and_knuckles_are_fitted() -> None:
    person = another(4)
    fitted = fitted_skeleton(touched_by(person, 100, (0, 1, 2, 3, 4), 4), ADULT)
    for found, known in zip(fitted.bones, ADULT.bones, strict=True):
        kept = replace(found, length=known.length, anchor=known.anchor)
        assert kept.name == known.name and kept.radius == known.radius
        for part in ("rest", "lower", "upper"):
            np.testing.assert_array_equal(getattr(found, part), getattr(known, part))
    assert "fitted" in fitted.name and fitted.side == ADULT.side


@given(seed=seeds, length=st.floats(0.0, 0.08), knuckle=st.floats(0.0, 0.01))
def test_joints_of_another_hand_sit_at_the_ends_of_its_bones(
    seed: int, length: float, knuckle: float
) -> None:
    person = another(seed, length, knuckle)
    place = Kinematics(person).place(UNSEEN[:3])
    for i, bone in enumerate(person.bones):
        end = place.joints[:, i] + bone.length * place.rotations[:, i, :, 1]
        following = i + 1 < len(person.bones) and person.bones[i + 1].finger == bone.finger
        wanted = place.joints[:, i + 1] if following else place.tips[:, bone.finger]
        np.testing.assert_allclose(end, wanted, atol=1e-12)


def test_another_hand_differs_by_as_much_as_was_asked_for() -> None:
    people = [another(seed, 0.06, 0.004) for seed in range(300)]
    shares = [
        [a.length / b.length - 1 for a, b in zip(p.bones, ADULT.bones, strict=True)] for p in people
    ]
    first = ADULT.first_bone
    moved = [[np.subtract(p.bones[i].anchor, ADULT.bones[i].anchor) for i in first] for p in people]
    assert np.std(shares) == pytest.approx(0.06, rel=0.05)
    assert np.std(moved) == pytest.approx(0.004, rel=0.05)
    same = another(0, 0.0, 0.0)
    assert tips_apart(same, ADULT, UNSEEN).max() < 1e-12


def test_the_same_source_makes_the_same_hand_and_leaves_the_table_alone() -> None:
    before = [(b.length, b.anchor) for b in ADULT.bones]
    assert tips_apart(another(9), another(9), UNSEEN).max() == 0
    assert tips_apart(another(9), another(10), UNSEEN).max() > 0.001
    assert [(b.length, b.anchor) for b in ADULT.bones] == before


@given(seed=seeds)
def test_tips_of_touching_fingers_belong_one_pad_above_their_touches(seed: int) -> None:
    capture = touched_by(another(seed), 10, (0, 1, 2, 3, 4), seed)
    kinematics = Kinematics(another(seed))
    assert np.abs(tip_misses(kinematics, capture)).max() < 1e-12
    assert tip_misses(kinematics, capture).shape == (10, 3)
    np.testing.assert_array_equal(tip_targets(np.array([0.1, 0.2])), [0.1, -0.2, PAD_HEIGHT])


def test_fitted_bones_miss_less_on_takes_that_they_were_not_fitted_to() -> None:
    capture = builtin_capture().select(np.arange(0, len(builtin_capture()), 20))
    left, known = capture.trial % 4 == 0, another(1)
    fitted = fitted_skeleton(capture.select(~left), known)
    unseen = capture.select(left)
    miss, missed = (
        np.linalg.norm(tip_misses(Kinematics(bones), unseen), axis=1).mean()
        for bones in (fitted, known)
    )
    assert miss < 0.25 * missed
