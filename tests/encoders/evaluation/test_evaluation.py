"""What `encoders.evaluation` measures is what it says."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.captures.subject.subject import first_subject
from encoders.correction import PAD_HEIGHT
from encoders.evaluation import EncoderMethod, evaluate_method
from encoders.evaluation.labels import own_labels
from encoders.evaluation.measure_method import OWN, TRUE, Tests
from encoders.evaluation.methods import NAMES, TRAINED, Training, check_names
from encoders.evaluation.pose_errors import (
    pose_errors,
    smoothness,
    tip_errors,
)
from encoders.evaluation.result_values import report
from encoders.labels.labelling import Labelling
from encoders.regression.trained import builtin_capture
from models.arithmetic import Array
from models.errors import EncoderError
from models.kinematics import Kinematics
from models.pose import JOINTS, POSE_SIZE
from models.rotations import exp, log
from models.skeleton import ADULT

Contacts = Mapping[int, tuple[float, float]]

RATE = 30.0
"""Hz of the captures made here."""
STAGES = ((0, 1), (0, 1, 2), (0, 1, 2, 3, 4), (1, 2, 3, 4))
"""Fingers that touch, stage by stage, in every take of the captures made here."""
STAGE_FRAMES = 6


def made_capture(takes: int = 3, seed: int = 0) -> Capture:
    """A capture in which fingers come and go; every contact's place tells which finger it is."""
    rng = np.random.default_rng(seed)
    parts = []
    frames = len(STAGES) * STAGE_FRAMES
    for take in range(takes):
        down = np.zeros((frames, 5), bool)
        for i, fingers in enumerate(STAGES):
            down[i * STAGE_FRAMES : (i + 1) * STAGE_FRAMES, list(fingers)] = True
        ids = np.where(down, 100 * take + np.arange(5), -1)
        xy = np.empty((frames, 5, 2))
        xy[..., 0] = 0.05 + 0.02 * np.arange(5)
        xy[..., 1] = 0.08 + 0.001 * np.cumsum(rng.normal(size=(frames, 5)), axis=0)
        xy[~down] = np.nan
        q = np.cumsum(rng.normal(0, 0.004, (frames, POSE_SIZE)), axis=0)
        parts.append((100.0 * take + np.arange(frames) / RATE, np.full(frames, take), ids, xy, q))
    time, trial, ids, xy, q = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Capture(time, trial, ids, xy, q, {"simulated": True, "rate_hz": RATE})


class Knowing:
    """A labeller that sees from a contact's place in `made_capture` which finger it is."""

    remembers = False

    def names(self, contacts: Contacts) -> Iterable[tuple[int, int]]:
        """Pairs of a contact's id and its label."""
        return [(i, round((x - 0.05) / 0.02)) for i, (x, _) in contacts.items()]

    def assign(self, contacts: Contacts, fixed: Mapping[int, int]) -> Labelling:
        return Labelling(dict(self.names(contacts)), 1.0)

    def reset(self) -> None:
        pass

    restart = reset


class ByOrder(Knowing):
    """A labeller that names contacts in the order in which it is given them."""

    def names(self, contacts: Contacts) -> Iterable[tuple[int, int]]:
        return ((i, place) for place, i in enumerate(contacts))


class ByNumber(Knowing):
    """A labeller that names contacts in the order of their ids."""

    def names(self, contacts: Contacts) -> Iterable[tuple[int, int]]:
        return ((i, place) for place, i in enumerate(sorted(contacts)))


class Given(EncoderMethod):
    """A method whose estimate is given."""

    def __init__(self, q: np.ndarray) -> None:
        super().__init__("given", None, Knowing, history=True)
        self.q = q

    def estimate(self, time: Array, trial: NDArray[np.int64], xy: Array) -> Array:
        return self.q


@pytest.fixture(scope="module")
def capture() -> Capture:
    return made_capture()


@pytest.fixture(scope="module")
def some() -> Capture:
    """A few takes of the built-in capture, thinned."""
    whole = builtin_capture()
    chosen = np.isin(whole.trial, np.unique(whole.trial)[::6])
    return whole.select(np.flatnonzero(chosen)[::4])


def test_a_perfect_estimate_has_no_error_at_all(capture: Capture) -> None:
    result = evaluate_method(Given(capture.q), Tests([capture]))
    for labels in (TRUE, OWN):
        for part in ("wrist", "joints", "components", "turn"):
            np.testing.assert_allclose(getattr(result.errors[labels], part), 0, atol=1e-5)
    assert result.right.all() and result.stayed.right.all() and result.first.right.all()


def test_a_wrist_one_centimetre_off_is_one_centimetre_off() -> None:
    q = made_capture().q
    moved = q.copy()
    moved[:, 1] += 0.01
    errors = pose_errors(moved, q)
    np.testing.assert_allclose(errors.wrist, 1.0)
    np.testing.assert_allclose(errors.angle, 0.0, atol=1e-5)


@given(angle=st.floats(0.5, 90), joint=st.integers(0, 13), axis=st.integers(0, 2))
def test_one_joint_turned_by_an_angle_counts_as_a_fourteenth_of_it(
    angle: float, joint: int, axis: int
) -> None:
    q = made_capture(1, seed=3).q[-1:]
    turned = q.copy()
    place = slice(6 + 3 * joint, 9 + 3 * joint)
    turn = np.zeros(3)
    turn[axis] = np.deg2rad(angle)
    turned[0, place] = log(exp(q[0, place]) @ exp(turn))
    assert pose_errors(turned, q).angle[0] == pytest.approx(angle / 14, abs=1e-6)


def test_a_touch_right_below_its_fingertip_has_no_tip_error() -> None:
    q = np.zeros((1, POSE_SIZE))
    kinematics = Kinematics(ADULT)
    q[0, 2] = PAD_HEIGHT - kinematics.tips(q)[0, 2, 2]
    tips = kinematics.tips(q)[0]
    xy = np.full((1, 5, 2), np.nan)
    xy[0, 2] = tips[2, 0], -tips[2, 1]
    np.testing.assert_allclose(tip_errors(q, xy), [0.0], atol=1e-9)
    xy[0, 2, 1] += 0.02
    np.testing.assert_allclose(tip_errors(q, xy), [2.0], atol=1e-9)


@pytest.mark.parametrize("history", (False, True))
def test_labels_bring_touches_to_the_fingers_that_they_name_and_lose_none(
    capture: Capture, history: bool
) -> None:
    found = own_labels(capture, Knowing, history)
    assert found.right.all() and found.stayed.right.all() and found.first.right.all()
    np.testing.assert_array_equal(found.xy, capture.xy)
    wrong = own_labels(capture, ByOrder, history)
    assert not wrong.right.all()
    np.testing.assert_array_equal(np.sort(wrong.xy, axis=1), np.sort(capture.xy, axis=1))


@pytest.mark.parametrize("cheat", (ByOrder, ByNumber))
def test_neither_order_nor_numbers_of_contacts_tell_their_fingers(cheat: type[Knowing]) -> None:
    """In `made_capture` ids are in the order of the fingers; a take's ids are drawn once."""
    found = own_labels(made_capture(takes=40), cheat, history=True)
    five = np.tile(np.repeat([len(f) == 5 for f in STAGES], STAGE_FRAMES), 40)
    assert found.right[five].mean() < 0.1


def test_a_jump_at_a_change_of_contacts_is_a_jump_and_no_acceleration(capture: Capture) -> None:
    q = np.zeros((len(capture), POSE_SIZE))
    late = np.tile(np.arange(len(STAGES) * STAGE_FRAMES) >= STAGE_FRAMES, 3)
    q[late, 6] = np.deg2rad(4.2)
    q[late, 0] = 0.01
    found = smoothness(q, capture)
    np.testing.assert_allclose(found.acceleration, 0, atol=1e-9)
    np.testing.assert_allclose(np.sort(found.jump)[-3:], 0.1)
    np.testing.assert_allclose(np.sort(found.largest_joint)[-3:], 4.2)
    np.testing.assert_allclose(np.sort(found.wrist_jump)[-3:], 1.0)
    assert np.count_nonzero(found.jump > 1e-9) == 3
    assert len(found.jump) == 3 * (len(STAGES) - 1)
    assert len(found.acceleration) == 3 * len(STAGES) * (STAGE_FRAMES - 2)


def test_acceleration_is_the_second_derivative(capture: Capture) -> None:
    q = np.zeros((len(capture), POSE_SIZE))
    q[:, JOINTS] = (np.deg2rad(0.5 * 7.0) * (capture.time % 100) ** 2)[:, None]
    np.testing.assert_allclose(smoothness(q, capture).acceleration, 7.0, rtol=1e-6)


def test_judged_days_follow_from_the_subject_and_the_seed_alone() -> None:
    person = first_subject()
    days = person.judged_days(6, 0)
    assert days == person.judged_days(6, 0) and days[:3] == person.judged_days(3, 0)
    assert len(set(days) | set(person.judged_days(6, 1))) == 12
    assert min(days) > 0
    changed = type(person)(person.name, person.seed, {"other": 1}, person.day)
    assert not set(days) & set(changed.judged_days(6, 0))


@pytest.mark.parametrize("names", [("nobody",), ("linear", "linear"), (), ("missing.npz",)])
def test_names_that_mean_no_method_are_refused_before_anything_is_computed(
    names: tuple[str, ...],
) -> None:
    with pytest.raises(EncoderError):
        check_names(names)


@pytest.mark.parametrize("name", [n for n in NAMES if n != TRAINED])
def test_every_method_gives_a_pose_and_labels_for_every_frame(name: str, some: Capture) -> None:
    method = Training(some).method(name)
    few = some.select(np.arange(0, len(some), 25))
    q = method.estimate(few.time, few.trial, few.xy)
    assert q.shape == (len(few), POSE_SIZE) and np.isfinite(q).all()
    found = own_labels(few, method.labeller, method.history)
    assert (np.isfinite(found.xy[..., 0]).sum(axis=1) == few.down.sum(axis=1)).all()


def test_the_report_of_a_perfect_method_repeats_the_captured_motion(capture: Capture) -> None:
    tests = Tests([capture])
    found = report({"given": evaluate_method(Given(capture.q), tests)}, tests, capture, {})
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    e = found["encoders"]["given"]
    for key in ("jump_deg", "acceleration_deg_s2", "tip_cm", "limit_violations"):
        assert e[key] == pytest.approx(found["truth"][key])
    assert e["labels_percent"]["all"] == 100 and e["overfitted_joints"] is None


def test_a_capture_of_lone_contacts_leaves_gaps_and_no_error(capture: Capture) -> None:
    ids, xy = capture.ids.copy(), capture.xy.copy()
    ids[:, 2:], xy[:, 2:] = -1, np.nan
    ids[:, 0], xy[:, 0] = -1, np.nan
    keep = ids[:, 1] >= 0
    lone = Capture(capture.time, capture.trial, ids, xy, capture.q, {}).select(keep)
    tests = Tests([lone])
    found = report({"given": evaluate_method(Given(lone.q), tests)}, tests, lone, {})
    e = found["encoders"]["given"]
    assert e["labels_percent"]["1"] == 100 and e["labels_percent"]["all"] is None
    assert e["labels_percent_interval"]["all"] == [None, None]
    assert found["simulated"] is False
