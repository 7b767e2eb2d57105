"""Pictures without a screen: what is seen, that nothing is changed by it, and who reads it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from models.hand import Hand
from models.scene import SceneSpec, scene_xml
from sandbox.session.messages import Snapshot
from sandbox.views import palette
from sandbox.views.cameras import Lens, camera_above, film_camera, window_camera
from sandbox.views.drawing import Drawing, Hidden
from sandbox.views.overlay import OverlayTexts, stickers
from sandbox.views.renderer import Renderer
from tasks.score import Score, Status
from tests.support.needs import require
from tests.support.viewed import Viewed, contact_at, model_bytes, viewed, with_contacts

SIZE = (480, 270)
BELOW = slice(110, None)
"""Rows below the status panel, which says `ghost` or `solid` and so is never the same."""

Picture = NDArray[np.float64]


@pytest.fixture(scope="module")
def v() -> Viewed:
    return viewed()


@pytest.fixture(scope="module")
def renderer(v: Viewed) -> Iterator[Renderer]:
    require("opengl")
    with Renderer(v.scene, v.surface, SIZE, camera=film_camera(v.solid, v.surface)) as r:
        yield r


def look(renderer: Renderer, snapshot: Snapshot) -> Picture:
    return np.asarray(renderer.frame(snapshot), float)


def changed(a: Picture, b: Picture) -> NDArray[np.bool_]:
    """Pixels that differ visibly."""
    return np.abs(a - b).max(axis=-1) > 12


def like(picture: Picture, colour: palette.Colour) -> NDArray[np.bool_]:
    """Pixels of a colour's hue, lit or shaded."""
    direction = picture / np.maximum(np.linalg.norm(picture, axis=-1, keepdims=True), 1.0)
    wanted = np.array(colour) / np.linalg.norm(colour)
    return (direction @ wanted > 0.995) & (picture.max(axis=-1) > 60)


def test_a_ghost_is_mixed_half_and_half_with_what_is_behind_it(
    v: Viewed, renderer: Renderer
) -> None:
    hand = replace(v.ghost.hands[0], contacts=())
    ghost = look(renderer, v.ghost.with_hands(hand))
    opaque = look(renderer, v.ghost.with_hands(replace(hand, solid=frozenset({0}))))
    # Far below the table a hand is not seen, and all else is as it was.
    qpos = v.ghost.qpos.copy()
    qpos[v.scene.qpos_slice(0)][2] = -2.0
    nothing = look(renderer, replace(v.ghost.with_hands(hand), qpos=qpos))
    assert changed(nothing[BELOW], opaque[BELOW]).sum() > 2000
    assert np.abs(ghost - (opaque + nothing) / 2)[BELOW].max() <= 1.0


def test_only_hands_that_are_to_be_hidden_are_left_out(v: Viewed) -> None:
    drawing = Drawing(v.scene, v.surface)
    camera = window_camera(v.surface)
    ghost = with_contacts(v.ghost)
    solid = ghost.with_hands(replace(ghost.hands[0], solid=frozenset({0})))

    def geoms(snapshot: Snapshot, hidden: Hidden | None) -> int:
        drawing.update(snapshot, camera, hidden)
        return int(drawing.view.ngeom)

    everything = geoms(ghost, None)
    assert geoms(ghost, "ghosts") < everything - 20
    assert geoms(solid, "ghosts") == geoms(solid, None) == everything
    assert geoms(solid, "hands") == geoms(ghost, "ghosts")


def test_looking_changes_neither_model_nor_snapshot(v: Viewed, renderer: Renderer) -> None:
    model, qpos = model_bytes(v.scene.model), v.solid.qpos.copy()
    places = v.solid.hands[0].places.copy()
    held = replace(v.solid, score=Score(True, True, True, Status.RUNNING, 1.0, "", 3.0))
    for snapshot in (v.ghost, v.solid, held):
        renderer.frame(snapshot)
    assert model_bytes(v.scene.model) == model
    assert np.array_equal(v.solid.qpos, qpos)
    assert np.array_equal(v.solid.hands[0].places, places)


def test_the_same_snapshot_gives_the_same_picture(v: Viewed, renderer: Renderer) -> None:
    first = look(renderer, v.solid)
    renderer.frame(v.ghost)
    assert np.array_equal(look(renderer, v.solid), first)


def test_the_look_of_the_palm_is_no_part_of_the_physics() -> None:
    root = ElementTree.fromstring(scene_xml(SceneSpec((Hand(),))))
    whole = mujoco.MjModel.from_xml_string(ElementTree.tostring(root, encoding="unicode"))
    seen = 0
    for body in root.iter("body"):
        for geom in [g for g in body.findall("geom") if g.get("group") == "1"]:
            body.remove(geom)
            seen += 1
    plain = mujoco.MjModel.from_xml_string(ElementTree.tostring(root, encoding="unicode"))
    assert seen > 10
    for name in ("body_mass", "body_inertia", "body_ipos", "body_iquat", "dof_armature"):
        assert np.array_equal(getattr(whole, name), getattr(plain, name)), name
    look_only = whole.geom_group == 1
    assert not whole.geom_contype[look_only].any() and not whole.geom_conaffinity[look_only].any()


@given(
    st.floats(-180, 180),
    st.floats(-88, -15),
    st.floats(0.15, 1.5),
    st.floats(-0.1, 0.3),
    st.floats(-0.1, 0.25),
)
@settings(max_examples=40)
def test_a_pixel_touches_the_surface_where_the_surface_is_drawn(
    azimuth: float, elevation: float, distance: float, x: float, y: float
) -> None:
    v = viewed()
    drawing = Drawing(v.scene, v.surface)
    camera = window_camera(v.surface)
    camera.azimuth, camera.elevation, camera.distance = azimuth, elevation, distance
    drawing.update(v.ghost, camera)
    lens = Lens.of(drawing.view, (640, 400))
    pixel, ahead = lens.project(v.surface.to_world([x, y]))
    picked = lens.pick(pixel, v.surface)
    assert not ahead or (picked is not None and np.allclose(picked, [x, y], atol=1e-6))


def test_a_line_of_sight_that_misses_the_surface_touches_nothing(v: Viewed) -> None:
    drawing = Drawing(v.scene, v.surface)
    camera = window_camera(v.surface)
    camera.elevation = -12.0
    drawing.update(v.ghost, camera)
    assert Lens.of(drawing.view, (640, 400)).pick((320.0, 0.0), v.surface) is None


@pytest.mark.needs("opengl")
@pytest.mark.parametrize("choose", ["film", "window", "above"])
@pytest.mark.parametrize("share", [(0.5, 0.5), (0.1, 0.15), (0.9, 0.8)])
def test_a_contact_is_drawn_where_the_lens_says(
    v: Viewed, choose: str, share: tuple[float, float]
) -> None:
    cameras = {
        "film": film_camera(v.ghost, v.surface),
        "window": window_camera(v.surface),
        "above": camera_above(v.surface),
    }
    place = v.surface.to_world(np.array(share) * v.surface.size)
    qpos = v.ghost.qpos.copy()
    qpos[int(v.scene.model.joint("box").qposadr[0]) + 2] = -1.0
    empty = with_contacts(replace(v.ghost, task_goals=(), qpos=qpos))
    marked = with_contacts(empty, contact_at(v.surface, 1, place, None, "active"))
    with Renderer(
        v.scene, v.surface, SIZE, camera=cameras[choose], rings_on_table=False
    ) as renderer:
        renderer.see_through = True
        before = look(renderer, empty)
        after = look(renderer, marked)
        lens = renderer.lens
    assert lens is not None
    (x, y), ahead = lens.project(place)
    assert ahead
    rows, columns = np.nonzero(changed(before, after))
    near = np.hypot(columns - x, rows - y) < 40
    assert near.any()
    # The ring's and the disc's pixels lie around the point; the name lies farther out.
    inner = np.hypot(columns - x, rows - y) < 8
    assert inner.sum() >= 5
    assert abs(columns[inner].mean() - x) < 3 and abs(rows[inner].mean() - y) < 3


def test_the_goal_is_green_and_turns_golden_when_it_was_held(v: Viewed, renderer: Renderer) -> None:
    running = look(renderer, with_contacts(v.ghost))[BELOW]
    score = Score(True, True, True, Status.RUNNING, 1.0, "", 3.0)
    held = look(renderer, replace(with_contacts(v.ghost), score=score))[BELOW]
    assert like(running, palette.GOAL).sum() > 150
    assert like(held, palette.HELD).sum() > 150
    assert like(running, palette.HELD).sum() < 20 and like(held, palette.GOAL).sum() < 20


def _drawn(v: Viewed) -> Drawing:
    drawing = Drawing(v.scene, v.surface)
    drawing.update(v.ghost, camera_above(v.surface))
    return drawing


@given(st.lists(st.tuples(st.floats(0, 0.19), st.floats(0, 0.14)), min_size=1, max_size=10))
@settings(max_examples=30)
def test_names_of_fingers_never_hide_each_other(places: list[tuple[float, float]]) -> None:
    v = viewed()
    contacts = [
        contact_at(v.surface, i, v.surface.to_world(xy), i % 5, "active")
        for i, xy in enumerate(places)
    ]
    drawing = _drawn(v)
    lens = Lens.of(drawing.view, (960, 540))
    snapshot = with_contacts(v.ghost, *contacts)
    names = stickers(snapshot, lens, v.surface, drawing.drop, OverlayTexts())[: len(contacts)]
    boxes = [(s.x, s.y, s.x + s.image.width, s.y + s.image.height) for s in names]
    for a, b in combinations(boxes, 2):
        assert a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
