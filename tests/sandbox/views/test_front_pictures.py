"""Before an upright surface: cameras that show it from the front, a table that hides no hand."""

from __future__ import annotations

import numpy as np
import pytest

from models.arithmetic import Array
from models.scene import TABLE
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.views.cameras import Lens, camera_above, film_camera, window_camera
from sandbox.views.drawing import Drawing
from tests.support.scripted import scripted

SIZE = (480, 270)


def seen(name: str, session: Session, snapshot: Snapshot) -> tuple[Lens | None, Array, Drawing]:
    """A picture's lens, its pixels and its drawing list's model."""
    from sandbox.views.renderer import Renderer

    surface = session.rigs[0].reconstructor.surface
    cameras = {
        "film": film_camera(snapshot, surface),
        "window": window_camera(surface),
        "straight": camera_above(surface),
    }
    with Renderer(session.scene, surface, SIZE, camera=cameras[name]) as renderer:
        picture = np.asarray(renderer.frame(snapshot), float)
        return renderer.lens, picture, renderer._drawing


@pytest.fixture(scope="module")
def scene() -> tuple[Session, Snapshot]:
    session = scripted(lambda now: (), task="stack-vertical", seed=3)
    return session, session.advance()


@pytest.mark.needs("opengl")
@pytest.mark.parametrize("name", ["film", "window", "straight"])
def test_the_whole_surface_is_in_the_picture_and_up_is_up(
    scene: tuple[Session, Snapshot], name: str
) -> None:
    session, snapshot = scene
    surface = session.rigs[0].reconstructor.surface
    lens, _, _ = seen(name, session, snapshot)
    width, height = surface.size
    corners = [[0, 0], [width, 0], [width, height], [0, height]]
    pixels, ahead = lens.project(surface.to_world(corners))
    assert ahead.all()
    assert np.all(pixels > 0) and np.all(pixels < SIZE)
    top_left, top_right, low_right, low_left = pixels
    assert top_left[1] < low_left[1] - 80 and top_right[1] < low_right[1] - 80
    assert top_right[0] > top_left[0] + 80 and low_right[0] > low_left[0] + 80
    assert abs(top_left[0] - low_left[0]) < 25, "up is up"
    middle = surface.size / 2
    pixel, _ = lens.project(surface.to_world(middle))
    assert np.allclose(lens.pick(pixel, surface), middle, atol=1e-6)


@pytest.mark.needs("opengl")
def test_a_shelf_is_drawn_in_place_of_the_endless_table_which_stays_solid(
    scene: tuple[Session, Snapshot],
) -> None:
    session, snapshot = scene
    model = session.scene.model
    before = model.geom_group.copy(), model.geom_contype.copy()
    lens, picture, drawing = seen("window", session, snapshot)
    assert drawing.model.geom(TABLE).group[0] > 2
    assert np.array_equal(model.geom_group, before[0])
    assert np.array_equal(model.geom_contype, before[1]) and model.geom(TABLE).contype[0] > 0
    # Below the shelf's edge one looks past the table, as into the sky.
    (x, y), _ = lens.project(np.array([0.12, 0.06, 0.0]))
    assert picture[int(y), int(x)].mean() < 150, "the shelf is dark"
    assert picture[-8:, :40].mean() > 180, "a hand that comes from below is seen"
