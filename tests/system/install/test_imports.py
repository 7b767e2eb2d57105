"""What a new process imports, and what it says where something is missing."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sandbox.cli.main import COMMANDS
from tests.support.processes import ROOT, printed, python

Picture = NDArray[np.float64]


_DRAW = """
import json, sys
import numpy as np
from sandbox.views.display import GraphicsError
from sandbox.views.graphics import choose_backend
from sandbox.views.renderer import Renderer
from tests.support.viewed import viewed
import os
v = viewed()
try:
    with Renderer(v.scene, v.surface, (160, 90)) as r:
        picture = np.asarray(r.frame(v.solid))
except GraphicsError as error:
    print(json.dumps({"error": str(error)}))
else:
    told = {"backend": choose_backend(), "leaked": os.environ.get("MUJOCO_GL", "")}
    np.save(sys.argv[1], picture)
    print(json.dumps(told))
"""


def _draw_elsewhere(folder: Path, **environment: str) -> tuple[str, Picture | None]:
    """A picture drawn by a process with another environment."""
    target = folder / "picture.npy"
    clean = {"MUJOCO_GL": None, "PYOPENGL_PLATFORM": None}
    told = printed("-c", _DRAW, target, **clean | environment)
    return told.strip(), np.load(target).astype(float) if target.exists() else None


@pytest.mark.needs("egl", "osmesa")
@pytest.mark.skipif(sys.platform != "linux", reason="EGL and OSMesa are Linux's")
def test_without_a_driver_for_egl_osmesa_draws_the_same_picture(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    egl, one = _draw_elsewhere(tmp_path / "a")
    # No vendor's library is found there, so libEGL is present but can do nothing.
    nothing = str(tmp_path)
    osmesa, other = _draw_elsewhere(tmp_path / "b", __EGL_VENDOR_LIBRARY_DIRS=nothing)
    assert '"backend": "egl", "leaked": ""' in egl
    assert '"backend": "osmesa", "leaked": ""' in osmesa
    assert one is not None and other is not None
    assert np.abs(one - other).mean() < 4.0


@pytest.mark.needs("egl")
@pytest.mark.skipif(sys.platform != "linux", reason="EGL and OSMesa are Linux's")
def test_where_there_is_no_opengl_one_error_says_what_to_install(tmp_path: Path) -> None:
    told, picture = _draw_elsewhere(
        tmp_path, MUJOCO_GL="egl", __EGL_VENDOR_LIBRARY_DIRS=str(tmp_path)
    )
    assert picture is None
    assert "no OpenGL" in told and "apt-get install" in told and "libegl1" in told
    told, picture = _draw_elsewhere(tmp_path, MUJOCO_GL="off")
    assert picture is None and "MUJOCO_GL" in told


def test_nothing_of_opengl_is_loaded_until_something_is_drawn() -> None:
    code = (
        "import sys, sandbox.views.film, sandbox.views.renderer, sandbox.session.session\n"
        "print([m for m in ('OpenGL', 'mujoco.egl', 'mujoco.osmesa') if m in sys.modules])"
    )
    assert printed("-c", code).strip() == "[]"


PACKAGES = ("models", "encoders", "tasks", "sandbox")


@pytest.mark.parametrize("package", PACKAGES)
def test_importing_a_package_loads_no_numpy_until_a_name_is_used(package: str) -> None:
    question = f"import sys, {package}; print('numpy' in sys.modules)"
    assert printed("-c", question).split() == ["False"]


HEAVY = ("mujoco", "glfw", "scipy", "OpenGL", "websockets", "matplotlib")


@pytest.mark.parametrize("module", ["sandbox", "sandbox.cli.main"])
def test_starting_the_program_loads_nothing_heavy(module: str) -> None:
    question = f"import sys, {module}; print(*(set({HEAVY}) & set(sys.modules)))"
    assert printed("-c", question).split() == []


OPTIONAL = (
    "gymnasium", "h5py", "imageio_ffmpeg", "jinja2", "matplotlib", "minari", "pandas", "pyarrow",
    "pylsl", "ray", "sklearn",
)  # fmt: skip
"""Packages of extras, which a plain installation lacks."""

_WITHOUT_EXTRAS = f"""
import importlib.abc, sys
class Missing(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {OPTIONAL}:
            raise ModuleNotFoundError(f"no {{name}}", name=name)
sys.meta_path.insert(0, Missing())
from sandbox.cli.main import main
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_its_help_where_no_extra_is_installed(command: str) -> None:
    assert f"sandbox {command}" in printed("-c", _WITHOUT_EXTRAS, command, "--help")


def test_a_data_set_without_its_extra_is_one_line_with_the_remedy(tmp_path: Path) -> None:
    demo = ROOT / "sandbox" / "data" / "demo.jsonl"
    ended = python("-c", _WITHOUT_EXTRAS, "export", demo, "--to", tmp_path / "set.npz")
    assert ended.returncode == 2
    assert ended.stderr.count("\n") == 1 and "hand-sandbox[gym]" in ended.stderr
