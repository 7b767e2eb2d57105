"""What every encoder by inverse kinematics keeps to, and what it refuses."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders import PcaIkEncoder, contact_vector
from encoders.regression.pca_ik import TouchNeighbours, touches_of
from models.errors import EncoderError
from models.pose import relative_pose
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH
from tests.encoders.regression.ik_frames import (
    KINEMATICS,
    every_encoder,
    fitted,
    misses,
    new_touches,
    pca,
    poses,
    row,
    touches,
)


@every_encoder
@given(
    shift=st.tuples(st.floats(-20, 20), st.floats(-20, 20)),
    at=st.deferred(lambda: st.integers(0, len(new_touches()) - 1)),
)
@settings(max_examples=10, deadline=None)
def test_touches_moved_alike_give_the_same_relative_pose(
    name: str, shift: tuple[float, float], at: int
) -> None:
    encoder = fitted(name)
    moved = new_touches()[at].copy()
    moved[:10] += np.tile(shift, 5)
    np.testing.assert_allclose(
        encoder.predict(moved), encoder.predict(new_touches()[at]), atol=1e-7
    )


@every_encoder
def test_where_a_lifted_finger_is_said_to_be_does_not_matter(name: str) -> None:
    encoder = fitted(name)
    other = new_touches().copy()
    other[:, :10][np.repeat(new_touches()[:, 10:] == 0, 2, axis=1)] = 31.4
    np.testing.assert_array_equal(encoder.predict(other), encoder.predict(new_touches()))


@every_encoder
def test_a_row_gives_the_same_result_in_a_batch_and_alone(name: str) -> None:
    encoder = fitted(name)
    together = encoder.predict(new_touches())
    for i in range(0, len(new_touches()), 7):
        np.testing.assert_array_equal(encoder.predict(new_touches()[i]), together[i])
    np.testing.assert_array_equal(encoder.predict(new_touches()[::-1])[::-1], together)
    assert encoder.predict(new_touches()[:0]).shape == (0, 48)


@every_encoder
def test_the_residual_is_that_of_the_pose(name: str) -> None:
    encoder = fitted(name)
    solution = encoder.solve(new_touches())
    np.testing.assert_allclose(
        solution.residual, misses(encoder, new_touches(), solution.q), rtol=1e-9, atol=1e-12
    )
    assert ((solution.iterations >= 0) & (solution.iterations <= encoder.iterations)).all()


def test_fingertips_come_closer_from_iteration_to_iteration() -> None:
    mean = [
        PcaIkEncoder(iterations=n).fit(touches(), poses()).solve(new_touches()).residual.mean()
        for n in (0, 1, 2)
    ]
    assert mean[0] > mean[1] > mean[2]


def test_a_settled_row_stops_without_loss_of_accuracy() -> None:
    undamped = partial(PcaIkEncoder, compliance_translation=0.0, compliance_rotation=0.0)
    stopped = undamped().fit(touches(), poses()).solve(new_touches()[::2])
    all_steps = undamped(settled=0.0).fit(touches(), poses()).solve(new_touches()[::2])
    assert stopped.iterations.min() < 100
    np.testing.assert_allclose(stopped.q, all_steps.q, atol=1e-6)


@pytest.mark.parametrize("kind", ["pca", "pca, root free"])
def test_training_frames_that_meet_their_touches_exactly_are_given_back(kind: str) -> None:
    undamped = PcaIkEncoder(compliance_translation=0.0, compliance_rotation=0.0, components=45)
    touched = undamped.fit(touches(), poses()).solve(touches())
    exact = touched.residual < 1e-7
    assert exact.mean() > 0.9
    encoder = {
        "pca": PcaIkEncoder(),
        "pca, root free": PcaIkEncoder(free="root"),
    }[kind].fit(touches()[exact], touched.q[exact])
    np.testing.assert_allclose(encoder.predict(touches()[exact]), touched.q[exact], atol=1e-4)


def test_the_start_is_the_training_frame_with_the_nearest_touches() -> None:
    start = PcaIkEncoder(iterations=0).fit(touches(), poses()).predict(new_touches())
    for contacts, pose in zip(new_touches(), start, strict=True):
        same = np.flatnonzero((touches()[:, 10:] == contacts[10:]).all(axis=1))
        distance = np.sum((touches()[same] - contacts) ** 2, axis=1)
        np.testing.assert_allclose(pose, poses()[same[np.argmin(distance)]], atol=1e-12)


def test_one_undamped_step_misses_by_the_square_of_its_length() -> None:
    # Only a step along a right Jacobian does; a wrong one misses by its length.
    rng = np.random.default_rng(3)
    q = pca().predict(row(0, 1, 2, 3))[None]
    tips, jacobian = KINEMATICS.tips_and_jacobian(q)
    J = jacobian[:, :4].reshape(1, 12, 48)
    undamped = PcaIkEncoder(compliance_translation=0.0, compliance_rotation=0.0, components=30)
    encoder = undamped.fit(touches(), poses())
    wish = rng.normal(0, 1, (1, 12))
    missed = []
    for length in (1e-3, 1e-4):
        off = length * wish
        step = encoder._step(off, J)
        missed.append(np.abs((KINEMATICS.tips(q + step) - tips)[0, :4].ravel() - off).max())
    assert missed[1] < 0.02 * missed[0] + 1e-9


@every_encoder
def test_one_contact_has_an_answer_everywhere(name: str) -> None:
    encoder = fitted(name)
    found = encoder.solve(np.array([row(finger) for finger in range(5)]))
    assert np.isfinite(found.q).all() and np.isfinite(found.residual).all()


def test_fingers_never_seen_by_themselves_start_from_a_frame_with_more_fingers() -> None:
    seen = ~(touches()[:, 10:] == [0, 1, 0, 1, 0]).all(axis=1)
    encoder = PcaIkEncoder(iterations=0).fit(touches()[seen], poses()[seen])
    frame = np.flatnonzero((touches()[:, 10:] == 1).all(axis=1))[3]
    places = touches()[frame, :10].reshape(5, 2)
    two = contact_vector({f: (places[f, 0], places[f, 1]) for f in (1, 3)})
    origin = places[[1, 3]][np.argmin(places[[1, 3], 0])] * METRES_PER_INCH
    np.testing.assert_allclose(
        encoder.predict(two), relative_pose(poses()[frame], origin), atol=1e-12
    )


def test_fingers_that_no_training_frame_has_are_reported_by_name() -> None:
    seen = (touches()[:, 10:] == [1, 1, 0, 0, 0]).all(axis=1)
    encoder = PcaIkEncoder().fit(touches()[seen], poses()[seen])
    assert np.isfinite(encoder.predict(row(1))).all()
    with pytest.raises(EncoderError, match="index, ring"):
        encoder.predict(row(1, 3))


def test_the_fingertips_are_those_of_the_skeleton_given() -> None:
    small = ADULT.scaled(0.9)
    encoder = PcaIkEncoder(small).fit(touches(), poses())
    found = encoder.solve(new_touches()[::4])
    np.testing.assert_allclose(
        found.residual, misses(encoder, new_touches()[::4], found.q), rtol=1e-9, atol=1e-12
    )
    assert encoder.tip_misfit_ > 2 * PcaIkEncoder().fit(touches(), poses()).tip_misfit_


def test_the_pad_height_is_learned_unless_it_is_given() -> None:
    down = touches()[:, 10:] == 1
    assert pca().pad_height_ == pytest.approx(np.median(KINEMATICS.tips(poses())[down][:, 2]))
    assert PcaIkEncoder(pad_height=0.004).fit(touches(), poses()).pad_height_ == 0.004


def test_one_training_frame_is_enough_for_an_answer() -> None:
    found = PcaIkEncoder().fit(touches()[:1], poses()[:1]).solve(touches()[:1])
    assert np.isfinite(found.q).all()


def nan_at(array: np.ndarray, place: tuple[int, int]) -> np.ndarray:
    array = array.copy()
    array[place] = np.nan
    return array


Unusable = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (lambda u, q: (u[:, :14], q), "wrong number of inputs"),
        (lambda u, q: (u[0], q), "wrong number of inputs"),
        (lambda u, q: (u, q[:, :42]), "do not have matching shapes"),
        (lambda u, q: (u, q[:-1]), "do not have matching shapes"),
        (lambda u, q: (u, q[0]), "do not have matching shapes"),
        (lambda u, q: (u[:0], q[:0]), "do not have matching shapes"),
        (lambda u, q: (nan_at(u, (3, 2)), q), "row 3: contact vectors must be finite"),
        (lambda u, q: (u, nan_at(q, (5, 7))), "poses must be finite"),
        (lambda u, q: (u + 0.5, q), "row 0: a contact flag is neither 0 nor 1"),
        (
            lambda u, q: (u * np.r_[np.ones(10), np.zeros(5)], q),
            "row 0: a contact vector has no contact",
        ),
    ],
)
def test_unusable_training_data_are_refused(data: Unusable, message: str) -> None:
    inputs, outputs = data(touches(), poses())
    with pytest.raises(EncoderError, match=message):
        PcaIkEncoder().fit(inputs, outputs)


@every_encoder
@pytest.mark.parametrize(
    "inputs",
    [
        lambda u: u[0, :14],
        lambda u: u[:, :14],
        lambda u: u[None],
        lambda u: nan_at(u, (0, 0)),
        lambda u: np.where(u > 1, np.inf, u),
        lambda u: u[:1] * np.r_[1.0, [0] * 14],
    ],
)
def test_unusable_contact_vectors_are_refused(
    name: str, inputs: Callable[[np.ndarray], np.ndarray]
) -> None:
    encoder = fitted(name)
    unusable = inputs(touches())
    with pytest.raises(EncoderError):
        encoder.predict(unusable)


def test_an_encoder_that_has_learned_nothing_says_so() -> None:
    with pytest.raises(EncoderError, match="learned nothing"):
        PcaIkEncoder().predict(new_touches())


def test_a_tie_is_decided_by_the_first_frame() -> None:
    down, places = touches_of(np.repeat(touches()[:1], 3, axis=0))
    poses = np.arange(3.0)[:, None] * np.ones(48)
    found = TouchNeighbours(down, places, poses).nearest(down[0], places[:1])
    np.testing.assert_array_equal(found[0, 3:], poses[0, 3:])


@pytest.mark.parametrize(
    "encoder",
    [
        PcaIkEncoder(iterations=-1),
        PcaIkEncoder(settled=-1.0),
        PcaIkEncoder(pad_height=np.nan),
        PcaIkEncoder(compliance_translation=-0.1),
        PcaIkEncoder(compliance_rotation=np.inf),
        PcaIkEncoder(compliance_rotation=0.0, reading="softness"),
        PcaIkEncoder(reading="stiffness"),
        PcaIkEncoder(free="all"),
        PcaIkEncoder(start="zero"),
        PcaIkEncoder(components=-1),
    ],
)
def test_options_out_of_their_range_are_refused(encoder: PcaIkEncoder) -> None:
    with pytest.raises(EncoderError):
        encoder.fit(touches(), poses())
