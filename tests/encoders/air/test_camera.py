"""Cameras: what they see, and where their frame lies in the world."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.air.camera import Camera
from models.errors import InputError

ANGLE = st.floats(-180.0, 180.0)


@given(st.floats(30.0, 120.0), ANGLE, ANGLE, ANGLE)
def test_a_camera_has_three_axes_at_right_angles_and_sees_what_it_unsees(
    view: float, tilt: float, roll: float, pan: float
) -> None:
    camera = Camera(view, (0.1, 0.4, 0.2), tilt, roll, pan)
    assert camera.axes @ camera.axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(camera.axes) == pytest.approx(1.0)
    points = np.array([[0.0, 0.0, 0.0], [0.3, -0.2, 0.5]])
    assert camera.unseen(camera.seen(points)) == pytest.approx(points, abs=1e-12)


@given(st.floats(30.0, 120.0), st.integers(160, 2000))
def test_rays_of_pixels_are_those_of_the_points(view: float, width: int) -> None:
    camera, size = Camera(view), (width, 480)
    points = np.array([[0.02, -0.03, 0.4], [-0.1, 0.05, 0.6]])
    rays = camera.rays(camera.pixels(points, size), size)
    assert rays == pytest.approx(points[:, :2] / points[:, 2:])


def test_the_edges_of_the_picture_are_the_field_of_view_apart() -> None:
    rays = Camera(90.0).rays(np.array([[0.0, 240.0], [640.0, 240.0]]), (640, 480))
    assert rays == pytest.approx(np.array([[-1.0, 0.0], [1.0, 0.0]]))


@pytest.mark.parametrize(
    ("camera", "point", "seen"),
    [
        # It faces the person, and sees their right on its left.
        (Camera(at=(0.0, 0.45, 0.10)), (0.1, 0.0, 0.2), (-0.1, -0.1, 0.45)),
        # From over the table it sees as the person does.
        (Camera(at=(0.0, 0.0, 0.5), tilt=90.0, roll=180.0), (0.1, 0.2, 0.0), (0.1, -0.2, 0.5)),
        # At the left it looks to the right.
        (Camera(at=(-0.5, 0.0, 0.0), pan=90.0), (0.0, 0.1, 0.0), (-0.1, 0.0, 0.5)),
    ],
    ids=["in front", "above", "at the left"],
)
def test_right_is_x_down_is_y_and_away_is_z_wherever_a_camera_stands(
    camera: Camera, point: tuple[float, ...], seen: tuple[float, ...]
) -> None:
    assert camera.seen(np.array([point]))[0] == pytest.approx(seen)


@pytest.mark.parametrize(
    ("values", "part"),
    [
        ({"view": 10.0}, "field of view"),
        ({"view": float("nan")}, "field of view"),
        ({"at": (0.0, 9.0, 0.0)}, "too far away"),
        ({"tilt": float("inf")}, "angle"),
    ],
)
def test_an_impossible_camera_is_refused(values: dict[str, Any], part: str) -> None:
    with pytest.raises(InputError, match=part):
        Camera(**values)
