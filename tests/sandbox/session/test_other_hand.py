"""Another hand than ours follows the same poses, by the contract of a hand alone."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np

from models.hand import Hand, SceneHand
from models.scene import Scene, SceneSpec
from sandbox.server.page_frames import pack_skin
from sandbox.session.session import Session
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings
from sandbox.views.hand_appearance import skinned_model
from tests.sandbox.session.pin_hand import PinHand
from tests.support.simulation import no_warning, random_pose


def other_session(seed: int) -> Session:
    """A session of box-to-goal by the simulated user, played by the hand of pins."""
    chosen = trial_settings(TrialOptions(task="box-to-goal", seed=seed))
    ours = build(chosen, device_makers(chosen))
    return Session(ours.task, [replace(rig, hand=PinHand()) for rig in ours.rigs])


def test_its_fingertips_go_where_the_pose_has_them() -> None:
    hand = PinHand()
    scene = Scene(SceneSpec((hand,)))
    data = mujoco.MjData(scene.model)
    for seed in range(5):
        q = random_pose(np.random.default_rng(seed))
        data.ctrl[scene.control_slice(0)] = hand.controls(q)
        mujoco.mj_step(scene.model, data, 500)
        lower = [link for link in hand.links if link.body.endswith("lower")]
        ends = [data.body(k.body).xpos + k.length * data.body(k.body).xmat[1::3] for k in lower]
        assert np.allclose(ends, hand.tips_of()(q), atol=1e-3)
    no_warning(data)


def test_two_kinds_of_hand_share_a_scene_and_each_has_its_own_controls() -> None:
    hands: tuple[SceneHand, ...] = (Hand("right"), PinHand())
    scene = Scene(SceneSpec(hands))
    data = mujoco.MjData(scene.model)
    assert scene.control_slice(0) == slice(0, 48) and scene.control_slice(1) == slice(48, 63)
    q = random_pose(np.random.default_rng(0))
    for i, hand in enumerate(hands):
        data.qpos[scene.qpos_slice(i)] = scene.pose_to_qpos(i, q)
        data.ctrl[scene.control_slice(i)] = hand.controls(q)
    mujoco.mj_forward(scene.model, data)
    still = data.qpos.copy()
    mujoco.mj_step(scene.model, data, 50)
    assert np.allclose(data.qpos, still, atol=1e-3)


def test_it_brings_a_box_to_its_goal_for_the_simulated_user() -> None:
    session = other_session(seed=3)
    while not session.over:
        snapshot = session.advance()
        for rig in session.rigs:
            rig.device.show(snapshot)
    assert session.scorer.score.success, session.scorer.score.reason
    session.close()


def test_without_a_skeleton_it_has_no_skin_and_is_seen_as_its_own_geoms() -> None:
    scene = Scene(SceneSpec((PinHand(), Hand("right"))))
    model, looks = skinned_model(scene)
    assert set(looks) == {1}
    assert pack_skin(scene.spec.hands[0]) == b""
    pins = [model.geom(link.geom).id for link in scene.spec.hands[0].links]
    assert set(model.geom_group[pins]) == {0}
