"""The skin in pictures: no part of the physics, with a hint of where a hand should be."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from models.arithmetic import Array
from models.frames import FINGERS
from models.hand import Hand
from models.objects import Box
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from sandbox.session.messages import Snapshot
from sandbox.views import palette
from sandbox.views.cameras import window_camera
from sandbox.views.drawing import Drawing
from sandbox.views.hand_appearance import skinned_model
from sandbox.views.renderer import Renderer
from tests.support.viewed import Viewed, contact_at, viewed
from training.skin.weights import random_poses


@pytest.fixture(scope="module")
def v() -> Viewed:
    return viewed()


def _hash_chain(scene: Scene, model: mujoco.MjModel, steps: int = 400) -> str:
    """Of the states of a hand that knocks a box about."""
    data = mujoco.MjData(model)
    chain, hits = hashlib.blake2b(), 0
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION)
    state = np.empty(size)
    box = model.body("box").id
    for step in range(steps):
        if step % 50 == 0:
            q = random_poses(ADULT, 1, step)[0]
            q[:3] = [0.0, -0.13, 0.10 - 0.0125 * (step // 50)]
            data.ctrl[:] = q
            if step == 0:
                data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, q)
        mujoco.mj_step(model, data)
        mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
        chain.update(state.tobytes())
        bodies = model.geom_bodyid[data.contact.geom[: data.ncon]]
        hits += int(((bodies == box).any(axis=1) & (bodies > 0).all(axis=1)).sum())
    assert hits > 20
    return chain.hexdigest()


def test_the_physics_is_the_same_to_the_bit_with_and_without_a_skin() -> None:
    scene = Scene(SceneSpec((Hand(),), (Box("box", (0.02, 0.02, 0.02), 0.1, (0.0, 0.0, 0.02)),)))
    skinned, _ = skinned_model(scene)
    assert scene.model.nskin == 0 and skinned.nskin > 0
    assert _hash_chain(scene, skinned) == _hash_chain(scene, scene.model)


def _solid(v: Viewed, target: Array) -> Snapshot:
    hand = replace(v.solid.hands[0], contacts=(), target=target)
    return v.solid.with_hands(hand)


def _posed(v: Viewed, q: Array) -> Snapshot:
    """The hand in a pose, and where it should be."""
    qpos = v.solid.qpos.copy()
    qpos[v.scene.qpos_slice(0)] = v.scene.pose_to_qpos(0, q)
    return replace(_solid(v, q), qpos=qpos)


def _target(v: Viewed) -> Array:
    """The commanded pose that the hand has reached exactly, as far as its fingertips tell."""
    return v.solid.hands[0].target


@pytest.mark.needs("opengl")
def test_a_hand_that_is_held_back_has_an_outline_beside_it_where_it_should_be(v: Viewed) -> None:
    moved = _target(v).copy()
    moved[0] += 0.03
    with Renderer(v.scene, v.surface, (480, 270), camera=window_camera(v.surface)) as renderer:
        posed = _posed(v, _target(v))
        there = np.asarray(renderer.frame(posed), int)
        held_back = posed.with_hands(replace(posed.hands[0], target=moved))
        held = np.asarray(renderer.frame(held_back), int)
        gone = np.asarray(renderer.frame(_posed(v, _target(v) + np.eye(48)[0])), int)
    line = (held != there).any(axis=-1)
    assert line.sum() > 100
    assert (held[line] == palette.bytes_of(palette.TARGET)[:3]).all()
    # A line, not an area, and none of it on the skin.
    assert line.mean() < 0.02
    skin = (np.abs(there - gone) > 24).any(axis=-1)
    assert skin.mean() > 0.03
    assert (line & skin).sum() < 0.1 * line.sum()


@pytest.mark.parametrize(("by", "shown"), [(0.0, False), (0.0035, False), (0.005, True)])
def test_only_what_is_more_than_4_mm_away_is_outlined(v: Viewed, by: float, shown: bool) -> None:
    drawing = Drawing(v.scene, v.surface)
    solid = _posed(v, _target(v))
    there = _target(v).copy()
    there[0] += by
    solid = solid.with_hands(replace(solid.hands[0], target=there))
    drawing.update(solid, window_camera(v.surface))
    away, here = drawing.held_back(solid)
    assert bool(away) is bool(here) is shown
    if shown:
        # A hand that is off as a whole is outlined as a whole.
        shift = np.broadcast_to([by, 0.0, 0.0], here[0].shape)
        np.testing.assert_allclose(away[0] - here[0], shift, atol=1e-6)
    ghost = solid.with_hands(replace(solid.hands[0], solid=frozenset()))
    assert drawing.held_back(ghost) == ([], [])


def test_nails_have_the_colours_of_the_fingers_that_touch(v: Viewed) -> None:
    drawing = Drawing(v.scene, v.surface)
    contact = contact_at(v.surface, 1, np.zeros(3), 1, "active")
    hand = replace(v.solid.hands[0], contacts=(contact,))
    drawing.update(v.solid.with_hands(hand), window_camera(v.surface))
    numbers = drawing.appearances[0].parts
    colours = {
        g.objid: tuple(g.rgba[:3])
        for g in drawing.view.geoms[: drawing.view.ngeom]
        if g.objtype == mujoco.mjtObj.mjOBJ_SKIN
    }
    for label, name in enumerate(FINGERS):
        matches = np.allclose(colours[numbers[f"nail_{name}"]], palette.finger_colour(label))
        assert matches == (label == 1)
