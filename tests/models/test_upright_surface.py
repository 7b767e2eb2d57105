"""A surface that stands upright before the person: what is up on it, is up in the world."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arithmetic import Array
from models.frames import FINGERS, Contact, TouchFrame
from models.hand import CONTACT_HAND, Hand
from models.kinematics import Kinematics
from models.objects import Box
from models.rotations import exp
from models.scene import CONTROL_PERIOD, TABLE, Scene, SceneSpec
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.trial.assembly import UPRIGHT_END, build
from sandbox.trial.settings import Settings
from tasks.simulated_user.stacker import in_picture, roll
from tasks.simulated_user.view import FrontView
from tasks.stack import StackVertical
from tasks.task import place_surface
from tasks.user import SeenObject
from tests.support.scripted import Script

places = st.floats(-0.5, 0.5)
points = st.tuples(places, places, places).map(np.array)
surfaces = st.builds(Surface, st.floats(4.0, 20.0), st.floats(4.0, 20.0))
UPRIGHT = place_surface(Surface(), StackVertical)


@given(surfaces, places, places, st.tuples(places, places), places)
def test_up_the_surface_is_up_in_the_world_and_out_of_it_is_towards_the_person(
    surface: Surface, depth: float, low: float, xy: tuple[float, float], step: float
) -> None:
    upright = surface.placed_upright(depth, low)
    assert upright.upright and not surface.upright
    here = upright.to_world(xy)
    x, y = xy
    assert np.allclose(upright.to_world((x, y - step)) - here, [0.0, 0.0, step])
    assert np.allclose(upright.to_world((x + step, y)) - here, [step, 0.0, 0.0])
    assert np.allclose(upright.to_world(xy, step) - here, [0.0, -step, 0.0])
    assert np.allclose(upright.to_surface(upright.to_world(xy, step)), xy)
    assert np.isclose(np.linalg.det(upright.rotation), 1.0)
    corners = upright.to_world(np.array([[0.0, 0.0], surface.size]))
    assert np.allclose(corners[:, 0], [-surface.size[0] / 2, surface.size[0] / 2])
    assert np.allclose(corners[:, 2], [low + surface.size[1], low])


def reconstructor(**options: Any) -> Any:
    """The reconstructor of a trial of `stack-vertical`."""
    settings = Settings().changed(task="stack-vertical", **options)
    return build(settings, (lambda task, surface: Script(),)).rigs[0].reconstructor


@pytest.mark.parametrize("up", [0.01, 0.04])
def test_touches_dragged_up_the_screen_lift_the_fingertips_as_far(up: float) -> None:
    hand, tips = reconstructor(smoothing=False), []
    for step in range(200):
        y = up * min(max(step - 100, 0) / 40, 1.0)
        spots = [(0.07, 0.09 - y), (0.13, 0.07 - y), (0.132, 0.085 - y)]
        contacts = tuple(Contact(i, *spot) for i, spot in enumerate(spots))
        found = hand.step(TouchFrame(step * CONTROL_PERIOD, contacts))
        tips.append(Kinematics(ADULT).tips(found.q)[[c.label or 0 for c in found.contacts]])
    assert found.down
    assert np.allclose(tips[-1] - tips[99], [0.0, 0.0, up], atol=1e-3)
    assert np.allclose(tips[99][:, 1], 0.0, atol=1e-3), "in the plane of the boxes' middles"


def test_the_surface_and_its_waiting_hand_are_in_front_of_the_boxes_and_reach_below_the_table() -> (
    None
):
    assert np.isclose(UPRIGHT.to_world((0.1, UPRIGHT.size[1]))[2], -0.015)
    # The pad of a touching finger is 6 mm out of the surface.
    assert np.isclose(UPRIGHT.to_world((0.1, 0.1), 0.006)[1], 0.0)
    tips = Kinematics(ADULT).tips(reconstructor().commanded)
    assert np.all(tips[:, 1] < -0.05)
    away = tips.mean(axis=0) - UPRIGHT.to_world(UPRIGHT.size / 2)
    assert np.linalg.norm(away[[0, 2]]) < 0.01


@given(points, points)
def test_who_looks_from_the_front_sees_right_as_right_and_up_as_up(
    point: Array, other: Array
) -> None:
    view = FrontView(UPRIGHT)
    assert not view.surface.upright
    seen = view.point(point)
    assert np.allclose(seen, [point[0], point[2], -point[1]])
    assert np.allclose(view.surface.to_surface(seen), UPRIGHT.to_surface(point))
    assert np.isclose(np.linalg.norm(seen - view.point(other)), np.linalg.norm(point - other))


@given(st.floats(-np.pi, np.pi), st.floats(-np.deg2rad(35), np.deg2rad(35)))
def test_a_box_is_seen_to_roll_and_its_turn_along_the_depth_is_not(
    angle: float, away: float
) -> None:
    view = FrontView(UPRIGHT)
    box = Box("box", (0.02, 0.02, 0.02), 0.1, (0.0, 0.0, 0.02))
    turned = exp([0.0, -angle, 0.0])
    seen = in_picture(
        SeenObject(box, np.zeros(3), view.surface.rotation @ UPRIGHT.rotation.T @ turned)
    )
    quarter = np.pi / 2
    off = (roll(seen) - angle + quarter / 2) % quarter - quarter / 2
    assert abs(off) < 1e-9
    assert np.allclose(seen.rotation[2], [0.0, 0.0, 1.0])
    aside = UPRIGHT.rotation.T @ exp([0.0, 0.0, away])
    assert abs(roll(in_picture(SeenObject(box, np.zeros(3), aside)))) < 1e-9


BOX = Box("box", (0.025, 0.025, 0.025), 0.1, (0.0, 0.0, 0.025))


def test_before_an_upright_surface_only_the_balls_of_fingertips_are_solid() -> None:
    hand = Hand(solid_end=UPRIGHT_END)
    scene = Scene(SceneSpec((hand,), (BOX,)))
    last_links = {link.finger: link for link in hand.links}
    for fingers in (frozenset(), frozenset({0, 2}), frozenset(range(len(FINGERS)))):
        scene.set_solid(0, fingers)
        solid = np.flatnonzero(scene.model.geom_contype == CONTACT_HAND)
        names = {scene.model.geom(g).name for g in solid}
        assert names == {last_links[f].tip_geom for f in fingers}
        # A capsule's second size is half its length without the round ends.
        assert np.all(scene.model.geom_size[solid, 1] < 1e-3)
    scene.set_solid(0, frozenset({0}), whole=True)
    solid = np.flatnonzero(scene.model.geom_contype == CONTACT_HAND)
    assert len(solid) == len(ADULT.bones), "all links, and no end a second time"
    data = mujoco.MjData(scene.model)
    mujoco.mj_forward(scene.model, data)
    for f, bone in ADULT.last_bones.items():
        body = scene.model.body(hand.element_name(bone.name)).id
        tip = data.xpos[body] + data.xmat[body].reshape(3, 3)[:, 1] * bone.length
        place = data.geom_xpos[scene.model.geom(last_links[f].tip_geom).id]
        assert np.linalg.norm(place - tip) < 1e-3, f


@pytest.mark.parametrize("end", [None, UPRIGHT_END])
def test_no_part_of_a_hand_ever_meets_the_table(end: float | None) -> None:
    scene = Scene(SceneSpec((Hand(solid_end=end, solid_palm=True),), (BOX,)))
    model, table, parts = scene.model, scene.model.geom(TABLE).id, scene.parts(0)
    scene.set_solid_geoms(0, parts)
    assert len(parts) > len(ADULT.bones) and np.all(model.geom_contype[parts])
    assert not np.any(model.geom_contype[parts] & model.geom_conaffinity[table])
    assert not np.any(model.geom_contype[table] & model.geom_conaffinity[parts])
