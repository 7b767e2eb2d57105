"""PCA-IK: its components, what is free beside them, where it begins and ends, what it refuses."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders import PcaIkEncoder, contact_vector
from models.errors import EncoderError
from models.kinematics import Kinematics
from models.pose import JOINTS, relative_pose
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH
from tests.encoders.regression.ik_frames import new_touches, poses, touches

# Few iterations where a truth does not depend on their number.
ENCODERS: dict[str, Callable[[], PcaIkEncoder]] = {
    "pca": lambda: PcaIkEncoder(iterations=10),
    "pca, root free": lambda: PcaIkEncoder(iterations=10, free="root", start="projected"),
    "pca, components only": lambda: PcaIkEncoder(iterations=10, free="nothing", start="mean"),
}
every_encoder = pytest.mark.parametrize("name", ENCODERS)
undamped = partial(PcaIkEncoder, compliance_translation=0.0, compliance_rotation=0.0)


@cache
def fitted(name: str) -> PcaIkEncoder:
    """One of `ENCODERS`, which has learned from `touches` and `poses`."""
    return ENCODERS[name]().fit(touches(), poses())


def row(*fingers: int) -> np.ndarray:
    """A contact vector of these fingers, spread as fingers are."""
    places = [(0.0, 2.6), (1.4, 0.5), (2.3, 0.2), (3.1, 0.5), (3.8, 1.2)]
    return contact_vector({f: places[f] for f in fingers})


def misses(encoder: PcaIkEncoder, contacts: np.ndarray, q: np.ndarray) -> np.ndarray:
    """(T,) m, farthest touching fingertip of poses from its target."""
    x, y = contacts[:, 0:10:2] * METRES_PER_INCH, contacts[:, 1:10:2] * METRES_PER_INCH
    targets = np.stack([x, -y, np.full_like(x, encoder.pad_height_)], axis=-1)
    off = np.linalg.norm(Kinematics(encoder.skeleton).tips(q) - targets, axis=2)
    return np.where(contacts[:, 10:] == 1, off, 0.0).max(axis=1)


@every_encoder
@given(
    shift=st.tuples(st.floats(-20, 20), st.floats(-20, 20)),
    at=st.deferred(lambda: st.integers(0, len(new_touches()) - 1)),
)
@settings(max_examples=10, deadline=None)
def test_touches_moved_alike_give_the_same_relative_pose_wherever_lifted_fingers_are(
    name: str, shift: tuple[float, float], at: int
) -> None:
    encoder, contacts = fitted(name), new_touches()[at]
    moved = contacts.copy()
    moved[:10] += np.tile(shift, 5)
    np.testing.assert_allclose(encoder.predict(moved), encoder.predict(contacts), atol=1e-7)
    other = contacts.copy()
    other[:10][np.repeat(contacts[10:] == 0, 2)] = shift[0]
    np.testing.assert_array_equal(encoder.predict(other), encoder.predict(contacts))


@every_encoder
@pytest.mark.parametrize("size", (1.0, 0.9))
def test_the_residual_is_that_of_the_pose_of_the_skeleton_given(name: str, size: float) -> None:
    encoder = ENCODERS[name]()
    encoder.skeleton = ADULT.scaled(size)
    solution = encoder.fit(touches(), poses()).solve(new_touches())
    expected = misses(encoder, new_touches(), solution.q)
    np.testing.assert_allclose(solution.residual, expected, rtol=1e-9, atol=1e-12)
    assert ((solution.iterations >= 0) & (solution.iterations <= encoder.iterations)).all()


def test_damped_steps_go_on_where_the_paper_stops_counting() -> None:
    found = {
        n: PcaIkEncoder(iterations=n).fit(touches(), poses()).solve(new_touches()).residual
        for n in (0, 4, 20, 100)
    }
    assert found[0].mean() > found[4].mean() > found[20].mean() > found[100].mean()
    assert (found[100] < found[0] + 1e-3).all()
    assert np.median(found[100]) < 0.003


@pytest.mark.parametrize(
    ("free", "components"), [("translation", 30), ("root", 30), ("nothing", 48)]
)
def test_without_compliance_and_with_enough_components_fingertips_are_met(
    free: str, components: int
) -> None:
    stiff = undamped(components=components, free=free).fit(touches(), poses())
    assert stiff.solve(new_touches()[::4]).residual.max() < 1e-6


def test_a_settled_row_stops_without_loss_of_accuracy() -> None:
    stopped = undamped().fit(touches(), poses()).solve(new_touches()[::2])
    all_steps = undamped(settled=0.0).fit(touches(), poses()).solve(new_touches()[::2])
    assert stopped.iterations.min() < 100
    np.testing.assert_allclose(stopped.q, all_steps.q, atol=1e-6)


@pytest.mark.parametrize("free", ["translation", "root"])
def test_training_frames_that_meet_their_touches_exactly_are_given_back(free: str) -> None:
    touched = undamped(components=45).fit(touches(), poses()).solve(touches())
    exact = touched.residual < 1e-7
    assert exact.mean() > 0.9
    encoder = PcaIkEncoder(free=free).fit(touches()[exact], touched.q[exact])
    np.testing.assert_allclose(encoder.predict(touches()[exact]), touched.q[exact], atol=1e-4)


@pytest.mark.parametrize("contacts", range(1, 6))
@pytest.mark.parametrize(("free", "root"), [("translation", 3), ("root", 6), ("nothing", 0)])
def test_poses_change_in_three_k_minus_three_components_and_in_what_is_free(
    contacts: int, free: str, root: int
) -> None:
    rng = np.random.default_rng(contacts)
    fingers = sorted(rng.permutation(5)[:contacts])
    inputs = np.array([row(*fingers)] * 60)
    inputs[:, :10] += rng.normal(0, 0.3, (60, 10))
    encoder = PcaIkEncoder(iterations=1, free=free).fit(touches(), poses())
    assert encoder.n_components(contacts) == 3 * contacts - 3
    encoder.iterations = 0
    start = encoder.predict(inputs)
    encoder.iterations = 2
    change = encoder.predict(inputs) - start
    basis = encoder.basis(contacts)
    assert basis.shape == (48, root + 3 * contacts - 3)
    unexplained = change - change @ np.linalg.pinv(basis).T @ basis.T
    np.testing.assert_allclose(unexplained, 0.0, atol=1e-12)
    assert np.linalg.matrix_rank(change, tol=1e-9) == root + 3 * contacts - 3 or contacts == 1


def test_components_are_those_of_the_training_poses() -> None:
    joints = PcaIkEncoder(free="root").fit(touches(), poses())
    away = (poses() - poses().mean(axis=0))[:, JOINTS]
    _, singular, directions = np.linalg.svd(away, full_matrices=False)
    share = np.cumsum(singular**2) / np.sum(singular**2)
    np.testing.assert_allclose(joints.explained_, share, rtol=1e-9)
    found = joints.components_[JOINTS, :12]
    found = found / np.linalg.norm(found, axis=0)
    overlap = np.abs(np.sum(found * directions[:12].T, axis=0))
    np.testing.assert_allclose(overlap, 1.0, atol=1e-6)
    assert not joints.components_[:6].any()


@pytest.mark.parametrize("finger", range(5))
def test_one_contact_only_moves_the_mean_pose_over_it(finger: int) -> None:
    encoder = PcaIkEncoder().fit(touches(), poses())
    solution = encoder.solve(row(finger)[None])
    assert encoder.n_components(1) == 0
    assert solution.residual[0] < 1e-6
    touching = touches()[:, 10 + finger] == 1
    np.testing.assert_allclose(solution.q[0, 3:], poses()[touching, 3:].mean(axis=0), atol=1e-12)


def test_softness_is_damping_by_the_inverse() -> None:
    soft = PcaIkEncoder(
        iterations=10, reading="softness", compliance_translation=10, compliance_rotation=0.04
    ).fit(touches(), poses())
    stiff = fitted("pca").predict(new_touches())
    np.testing.assert_allclose(soft.predict(new_touches()), stiff, atol=1e-9)


def test_the_start_is_the_training_frame_with_the_nearest_touches() -> None:
    options: dict[str, Any] = {"iterations": 0, "components": 45}
    start = PcaIkEncoder(**options).fit(touches(), poses()).predict(new_touches())
    for contacts, pose in zip(new_touches(), start, strict=True):
        same = np.flatnonzero((touches()[:, 10:] == contacts[10:]).all(axis=1))
        distance = np.sum((touches()[same] - contacts) ** 2, axis=1)
        np.testing.assert_allclose(pose, poses()[same[np.argmin(distance)]], atol=1e-12)
    projected = PcaIkEncoder(**options, start="projected").fit(touches(), poses())
    np.testing.assert_allclose(projected.predict(new_touches()), start, atol=1e-9)


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


@pytest.mark.parametrize(
    "inputs",
    [
        lambda u: u[None],
        lambda u: np.where(u > 1, np.nan, u),
        lambda u: u + 0.5,
        lambda u: u[:1] * np.r_[1.0, [0] * 14],
    ],
)
def test_unusable_contact_vectors_are_refused(inputs: Callable[[np.ndarray], np.ndarray]) -> None:
    unusable = inputs(touches())
    with pytest.raises(EncoderError):
        fitted("pca").predict(unusable)
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
