"""What every encoder by inverse kinematics keeps to, and what it refuses."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders import PcaIkEncoder, contact_vector
from models.errors import EncoderError
from models.pose import relative_pose
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH
from tests.encoders.regression.ik_frames import (
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
def test_the_residual_is_that_of_the_pose(name: str) -> None:
    encoder = fitted(name)
    solution = encoder.solve(new_touches())
    np.testing.assert_allclose(
        solution.residual, misses(encoder, new_touches(), solution.q), rtol=1e-9, atol=1e-12
    )
    assert ((solution.iterations >= 0) & (solution.iterations <= encoder.iterations)).all()


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


@pytest.mark.parametrize(
    "inputs",
    [
        lambda u: u[None],
        lambda u: np.where(u > 1, np.nan, u),
        lambda u: np.where(u > 1, np.inf, u),
        lambda u: u + 0.5,
        lambda u: u[:1] * np.r_[1.0, [0] * 14],
    ],
)
def test_unusable_contact_vectors_are_refused(
    inputs: Callable[[np.ndarray], np.ndarray],
) -> None:
    unusable = inputs(touches())
    with pytest.raises(EncoderError):
        pca().predict(unusable)
    with pytest.raises(EncoderError):
        PcaIkEncoder().fit(unusable, poses())


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
