"""What every encoder by inverse kinematics keeps to, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders import PcaIkEncoder, contact_vector
from encoders.regression.regularised_ik import MapIkEncoder, NullSpaceIkEncoder
from encoders.regression.touch_neighbour import TouchNeighbours, touches_of
from models.errors import EncoderError
from models.pose import relative_pose
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH
from tests.encoders.regression.ik_frames import (
    KINEMATICS,
    NEW,
    PCA,
    Q,
    U,
    every_encoder,
    every_kind,
    misses,
    row,
)


@every_encoder
@given(
    shift=st.tuples(st.floats(-20, 20), st.floats(-20, 20)),
    at=st.integers(0, len(NEW) - 1),
)
@settings(max_examples=10, deadline=None)
def test_touches_moved_alike_give_the_same_relative_pose(encoder, shift, at):
    moved = NEW[at].copy()
    moved[:10] += np.tile(shift, 5)
    np.testing.assert_allclose(encoder.predict(moved), encoder.predict(NEW[at]), atol=1e-7)


@every_encoder
def test_where_a_lifted_finger_is_said_to_be_does_not_matter(encoder):
    other = NEW.copy()
    other[:, :10][np.repeat(NEW[:, 10:] == 0, 2, axis=1)] = 31.4
    np.testing.assert_array_equal(encoder.predict(other), encoder.predict(NEW))


@every_encoder
def test_a_row_is_solved_in_company_as_it_is_alone(encoder):
    together = encoder.predict(NEW)
    for i in range(0, len(NEW), 7):
        np.testing.assert_array_equal(encoder.predict(NEW[i]), together[i])
    np.testing.assert_array_equal(encoder.predict(NEW[::-1])[::-1], together)
    assert encoder.predict(NEW[:0]).shape == (0, 48)


@every_encoder
def test_the_residual_is_that_of_the_pose(encoder):
    solution = encoder.solve(NEW)
    np.testing.assert_allclose(
        solution.residual, misses(encoder, NEW, solution.q), rtol=1e-9, atol=1e-12
    )
    assert ((solution.iterations >= 0) & (solution.iterations <= encoder.iterations)).all()


@every_kind
def test_fingertips_come_closer_from_iteration_to_iteration(kind):
    mean = [kind(iterations=n).fit(U, Q).solve(NEW).residual.mean() for n in (0, 1, 2)]
    assert mean[0] > mean[1] > mean[2]


def test_a_settled_row_stops_and_nothing_is_lost_by_it():
    stopped = MapIkEncoder().fit(U, Q).solve(NEW[::2])
    all_steps = MapIkEncoder(settled=0.0).fit(U, Q).solve(NEW[::2])
    assert stopped.iterations.min() < 100
    np.testing.assert_allclose(stopped.q, all_steps.q, atol=1e-6)


@pytest.mark.parametrize("kind", ["pca", "pca, root free", "null space"])
def test_training_frames_that_meet_their_touches_exactly_are_given_back(kind):
    touched = MapIkEncoder(tip_sigma=1e-6).fit(U, Q).solve(U)
    exact = touched.residual < 1e-7
    assert exact.mean() > 0.9
    encoder = {
        "pca": PcaIkEncoder(),
        "pca, root free": PcaIkEncoder(free="root"),
        "null space": NullSpaceIkEncoder(desired="neighbour"),
    }[kind].fit(U[exact], touched.q[exact])
    np.testing.assert_allclose(encoder.predict(U[exact]), touched.q[exact], atol=1e-4)


def test_the_start_is_the_training_frame_with_the_nearest_touches():
    start = PcaIkEncoder(iterations=0).fit(U, Q).predict(NEW)
    for contacts, pose in zip(NEW, start, strict=True):
        same = np.flatnonzero((U[:, 10:] == contacts[10:]).all(axis=1))
        distance = np.sum((U[same] - contacts) ** 2, axis=1)
        np.testing.assert_allclose(pose, Q[same[np.argmin(distance)]], atol=1e-12)


@every_kind
def test_one_undamped_step_misses_by_the_square_of_its_length(kind):
    # Only a step along a right Jacobian does; a wrong one misses by its length.
    rng = np.random.default_rng(3)
    q = PCA.predict(row(0, 1, 2, 3))[None]
    tips, jacobian = KINEMATICS.tips_and_jacobian(q)
    J = jacobian[:, :4].reshape(1, 12, 48)
    options: dict = {"tip_sigma": 1e-6} if kind is MapIkEncoder else {"compliance_translation": 0}
    if kind is PcaIkEncoder:
        options |= {"compliance_rotation": 0, "components": 30}
    elif kind is NullSpaceIkEncoder:
        options |= {"compliance_rotation": 0}
    encoder = kind(**options).fit(U, Q)
    wish = rng.normal(0, 1, (1, 12))
    missed = []
    for length in (1e-3, 1e-4):
        off = length * wish
        step = encoder._step(q, q, off, J)
        missed.append(np.abs((KINEMATICS.tips(q + step) - tips)[0, :4].ravel() - off).max())
    assert missed[1] < 0.02 * missed[0] + 1e-9


@every_encoder
def test_one_contact_has_an_answer_everywhere(encoder):
    found = encoder.solve(np.array([row(finger) for finger in range(5)]))
    assert np.isfinite(found.q).all() and np.isfinite(found.residual).all()


def test_fingers_never_seen_by_themselves_start_from_a_frame_with_more_fingers():
    seen = ~(U[:, 10:] == [0, 1, 0, 1, 0]).all(axis=1)
    encoder = PcaIkEncoder(iterations=0).fit(U[seen], Q[seen])
    frame = np.flatnonzero((U[:, 10:] == 1).all(axis=1))[3]
    places = U[frame, :10].reshape(5, 2)
    two = contact_vector({f: (places[f, 0], places[f, 1]) for f in (1, 3)})
    origin = places[[1, 3]][np.argmin(places[[1, 3], 0])] * METRES_PER_INCH
    np.testing.assert_allclose(encoder.predict(two), relative_pose(Q[frame], origin), atol=1e-12)


def test_fingers_of_which_nothing_is_known_are_reported_by_name():
    seen = (U[:, 10:] == [1, 1, 0, 0, 0]).all(axis=1)
    for encoder in (PcaIkEncoder(), NullSpaceIkEncoder(desired="neighbour")):
        encoder.fit(U[seen], Q[seen]).predict(row(1))
        with pytest.raises(EncoderError, match="index, ring"):
            encoder.predict(row(1, 3))
    assert np.isfinite(MapIkEncoder().fit(U[seen], Q[seen]).predict(row(1, 3))).all()


@every_kind
def test_the_fingertips_are_those_of_the_skeleton_given(kind):
    small = ADULT.scaled(0.9)
    encoder = kind(small).fit(U, Q)
    found = encoder.solve(NEW[::4])
    np.testing.assert_allclose(
        found.residual, misses(encoder, NEW[::4], found.q), rtol=1e-9, atol=1e-12
    )
    assert encoder.tip_misfit_ > 2 * kind().fit(U, Q).tip_misfit_


def test_the_pad_height_is_learned_unless_it_is_given():
    down = U[:, 10:] == 1
    assert PCA.pad_height_ == pytest.approx(np.median(KINEMATICS.tips(Q)[down][:, 2]))
    assert PcaIkEncoder(pad_height=0.004).fit(U, Q).pad_height_ == 0.004


@every_kind
def test_one_training_frame_is_enough_for_an_answer(kind):
    found = kind().fit(U[:1], Q[:1]).solve(U[:1])
    assert np.isfinite(found.q).all()


def nan_at(array: np.ndarray, place: tuple[int, int]) -> np.ndarray:
    array = array.copy()
    array[place] = np.nan
    return array


@every_kind
@pytest.mark.parametrize(
    ("inputs", "outputs", "message"),
    [
        (U[:, :14], Q, "wrong number of inputs"),
        (U[0], Q, "wrong number of inputs"),
        (U, Q[:, :42], "do not belong together"),
        (U, Q[:-1], "do not belong together"),
        (U, Q[0], "do not belong together"),
        (U[:0], Q[:0], "do not belong together"),
        (nan_at(U, (3, 2)), Q, "row 3: contact vectors must be finite"),
        (U, nan_at(Q, (5, 7)), "poses must be finite"),
        (U + 0.5, Q, "row 0: a contact flag is neither 0 nor 1"),
        (U * np.r_[np.ones(10), np.zeros(5)], Q, "row 0: a contact vector without any contact"),
    ],
)
def test_unusable_training_data_are_refused(kind, inputs, outputs, message):
    with pytest.raises(EncoderError, match=message):
        kind().fit(inputs, outputs)


@every_encoder
@pytest.mark.parametrize(
    "inputs",
    [
        U[0, :14],
        U[:, :14],
        U[None],
        nan_at(U, (0, 0)),
        np.where(U > 1, np.inf, U),
        U[:1] * np.r_[1.0, [0] * 14],
    ],
)
def test_unusable_contact_vectors_are_refused(encoder, inputs):
    with pytest.raises(EncoderError):
        encoder.predict(inputs)


@every_kind
def test_an_encoder_that_has_learned_nothing_says_so(kind):
    with pytest.raises(EncoderError, match="learned nothing"):
        kind().predict(NEW)


def test_a_tie_is_decided_by_the_first_frame():
    down, places = touches_of(np.repeat(U[:1], 3, axis=0))
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
        NullSpaceIkEncoder(desired="zero"),
        NullSpaceIkEncoder(gain=1.5),
        NullSpaceIkEncoder(compliance_rotation=-1.0),
        MapIkEncoder(tip_sigma=0.0),
    ],
)
def test_options_out_of_their_range_are_refused(encoder):
    with pytest.raises(EncoderError):
        encoder.fit(U, Q)
