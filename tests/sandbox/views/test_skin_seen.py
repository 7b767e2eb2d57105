"""The skin in pictures: no part of the physics, with a hint of where a hand should be."""

from __future__ import annotations

import hashlib
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from models.arithmetic.arrays import Array
from models.frames import FINGERS
from models.hand import Hand
from models.objects import Box
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from models.skin.skin import Skin
from sandbox.session.messages import ContactView, Snapshot
from sandbox.views import palette
from sandbox.views.cameras import window_camera
from sandbox.views.drawing import Drawing
from sandbox.views.hand_look import skinned_model
from sandbox.views.renderer import Renderer
from tests.support.viewed import Viewed, viewed
from tools.skin.weights import random_poses


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


# It is seen


def _solid(v: Viewed, target: Array) -> Snapshot:
    hand = replace(v.solid.hands[0], contacts=(), target=target)
    return replace(v.solid, hands=(hand,))


def _target(v: Viewed) -> Array:
    """The commanded pose that the hand has reached exactly, as far as its fingertips tell."""
    return v.solid.hands[0].target


@pytest.mark.needs("opengl")
def test_where_a_hand_should_be_is_shown_while_it_is_held_back(v: Viewed) -> None:
    moved = _target(v).copy()
    moved[0] += 0.03
    with Renderer(v.scene, v.surface, (480, 270), camera=window_camera(v.surface)) as renderer:
        there = np.asarray(renderer.frame(_solid(v, _target(v))), float)
        held = np.asarray(renderer.frame(_solid(v, moved)), float)
    bluer = (held - there)[..., 2] > 12
    assert bluer.sum() > 300
    # The hand itself stays as it is: most pixels do.
    assert (np.abs(held - there).max(axis=-1) > 12).mean() < 0.2


def test_only_solid_hands_that_are_held_back_show_where_they_should_be(v: Viewed) -> None:
    drawing = Drawing(v.scene, v.surface)
    moved = _target(v).copy()
    moved[:3] += 0.05
    assert drawing.held_back(_solid(v, moved)) == [0]
    assert drawing.held_back(_solid(v, _target(v))) == []
    ghost = replace(v.ghost, hands=(replace(v.ghost.hands[0], target=moved),))
    assert drawing.held_back(ghost) == []


def test_nails_have_the_colours_of_the_fingers_that_touch(v: Viewed) -> None:
    drawing = Drawing(v.scene, v.surface)
    contact = ContactView(1, np.zeros(3), 1, "active")
    hand = replace(v.solid.hands[0], contacts=(contact,))
    drawing.update(replace(v.solid, hands=(hand,)), window_camera(v.surface))
    numbers = drawing.looks[0].parts
    colours = {
        g.objid: tuple(g.rgba[:3])
        for g in drawing.view.geoms[: drawing.view.ngeom]
        if g.objtype == mujoco.mjtObj.mjOBJ_SKIN
    }
    for label, name in enumerate(FINGERS):
        matches = np.allclose(colours[numbers[f"nail_{name}"]], palette.finger_colour(label))
        assert matches == (label == 1)


def test_two_hands_have_two_skins() -> None:
    pair = (Hand("right"), Hand("left", ADULT.mirrored()))
    scene = Scene(SceneSpec(pair))
    model, looks = skinned_model(scene)
    assert model.nskin == 2 * (len(Skin.builtin().parts) + 1)
    numbers = [n for look in looks.values() for n in (*look.parts.values(), look.target)]
    assert sorted(numbers) == list(range(model.nskin))
