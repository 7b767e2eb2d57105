"""Fingertips are found at the ends of meshes, for models that do not name them."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from models.arithmetic import Array
from models.errors import InputError
from models.robot.mapping import load_mapping
from models.robot.mapping_fit import fit_mapping, tip_ends
from models.robot.robot_model import RobotModel
from tests.models.robot.hinge_hand import TIPS, edited, hinge_hand

LENGTH, RADIUS = 0.04, 0.006
"""m, from a link's joint to the middle of its round end, and the end's radius."""
ENDS = tuple(name.replace("_tip", "_far") for name in TIPS)


def link_points(along: Array) -> Array:
    """(n, 3) m, points of a link that begins at the origin, and has one round end."""
    rng = np.random.default_rng(3)
    ball = rng.normal(size=(4000, 3))
    ball *= RADIUS / np.linalg.norm(ball, axis=1)[:, None]
    return np.concatenate([ball + LENGTH * along, ball])


def meshed(folder: Path, along: Array) -> Path:
    """The hand of hinges without sites at its tips: its last links are meshes."""
    points = " ".join(f"{x:.6g}" for x in link_points(along).ravel())
    meshes = "".join(
        f'<mesh name="{name}" vertex="{points}" inertia="convex"/>' for name in ("last", "again")
    )
    return edited(
        hinge_hand(folder),
        (
            '<geom type="capsule" fromto="0 0 0 0 .022 0" size=".007" mass=".01"/>',
            '<geom type="mesh" mesh="last" mass=".01"/>'
            '<geom type="mesh" mesh="again" mass=".01" contype="0"/>',
        ),
        ("<worldbody>", f"<asset>{meshes}</asset><worldbody>"),
        *((f'<site name="{name}" pos="0 .022 0"/>', "") for name in TIPS),
    )


@pytest.mark.parametrize("along", [(0.0, 1.0, 0.0), (0.6, 0.0, -0.8), (-0.48, 0.6, 0.64)])
def test_the_middle_of_a_round_end_is_found(tmp_path: Path, along: tuple[float, ...]) -> None:
    model = mujoco.MjSpec.from_file(str(meshed(tmp_path, np.array(along)))).compile()
    for end in tip_ends(model, ENDS):
        assert np.allclose(end.place, LENGTH * np.array(along), atol=5e-4)
        assert end.radius == pytest.approx(RADIUS, abs=5e-4)


def test_a_hand_without_names_of_tips_is_fitted_by_the_ends(tmp_path: Path) -> None:
    path = meshed(tmp_path, np.array([0.0, 1.0, 0.0]))
    fitted = fit_mapping(path, ENDS, ends=True)
    assert fitted.mapping.side == "right" and len(fitted.mapping.places) == 5
    file = tmp_path / "meshed.toml"
    file.write_text(fitted.mapping.as_toml(), encoding="utf-8")
    mapping = load_mapping(file)
    assert mapping.places == fitted.mapping.places
    # A shape that is there twice is seen once.
    robot = RobotModel(path, mapping.palm, mapping.tips, mapping.places)
    assert len(robot.assets("right_")) == 1


def test_a_body_without_a_mesh_has_no_end(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no body of this name with a mesh") as error:
        fit_mapping(hinge_hand(tmp_path), ENDS, ends=True)
    assert "\n" not in str(error.value)
