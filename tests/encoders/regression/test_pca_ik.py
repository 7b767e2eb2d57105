"""PCA-IK: its components, what is free beside them, and what its compliances do."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders import PcaIkEncoder
from models.pose import JOINTS
from tests.encoders.regression.ik_frames import KINEMATICS, new_touches, pca, poses, row, touches
from tests.support.simulation import random_pose


def test_damped_steps_go_on_where_the_paper_stops_counting() -> None:
    found = {
        n: PcaIkEncoder(iterations=n).fit(touches(), poses()).solve(new_touches()).residual
        for n in (0, 4, 20, 100)
    }
    assert found[0].mean() > found[4].mean() > found[20].mean() > found[100].mean()
    assert (found[100] < found[0] + 1e-3).all()
    assert np.median(found[100]) < 0.003


@pytest.mark.parametrize("free", ["translation", "root"])
def test_without_compliance_and_with_enough_components_fingertips_are_met(free: str) -> None:
    stiff = PcaIkEncoder(
        compliance_translation=0, compliance_rotation=0, components=30, free=free, iterations=30
    ).fit(touches(), poses())
    assert stiff.solve(new_touches()).residual.max() < 1e-6


def test_the_whole_pose_in_all_its_components_meets_fingertips_too() -> None:
    stiff = PcaIkEncoder(
        compliance_translation=0, compliance_rotation=0, components=48, free="nothing"
    ).fit(touches(), poses())
    assert stiff.solve(new_touches()[::4]).residual.max() < 1e-6


def test_a_training_frame_stays_nearer_to_itself_than_to_the_mean_pose() -> None:
    away = np.linalg.norm((pca().predict(touches()) - poses())[:, JOINTS], axis=1)
    spread = np.linalg.norm((pca().mean_ - poses())[:, JOINTS], axis=1)
    assert away.mean() < 0.25 * spread.mean()


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


def test_a_start_projected_on_all_components_is_the_neighbour_itself() -> None:
    options: dict[str, Any] = {"iterations": 0, "components": 45}
    neighbour = PcaIkEncoder(**options).fit(touches(), poses()).predict(new_touches())
    projected = (
        PcaIkEncoder(**options, start="projected").fit(touches(), poses()).predict(new_touches())
    )
    np.testing.assert_allclose(projected, neighbour, atol=1e-9)


@given(seed=st.integers(0, 2**32 - 1), contacts=st.integers(2, 5))
@settings(max_examples=25, deadline=None)
def test_fingertips_move_along_the_components_as_the_jacobian_says(
    seed: int, contacts: int
) -> None:
    rng = np.random.default_rng(seed)
    q, h = random_pose(rng), 1e-5
    _, J = KINEMATICS.tips_and_jacobian(q)
    basis = pca().basis(contacts)
    moved = [(KINEMATICS.tips(q + h * b) - KINEMATICS.tips(q - h * b)) / (2 * h) for b in basis.T]
    np.testing.assert_allclose(np.stack(moved, axis=-1), J @ basis, atol=1e-8)


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
        iterations=5, reading="softness", compliance_translation=10, compliance_rotation=0.04
    )
    np.testing.assert_allclose(
        soft.fit(touches(), poses()).predict(new_touches()),
        PcaIkEncoder(iterations=5).fit(touches(), poses()).predict(new_touches()),
        atol=1e-9,
    )
