"""A pytest plugin that refuses work: no model is loaded, trained or built while it is there.

python -m pytest --collect-only -p tests.system.install.refuse_work
"""

from __future__ import annotations

from typing import NoReturn

import models  # noqa: F401  (before NumPy: it pins the BLAS kernel)

# ruff: isort: split
import mujoco
import numpy as np
import scipy.linalg

REFUSED: tuple[tuple[object, str], ...] = (
    # Captures, trained models and skins are files of arrays.
    (np, "load"),
    # Training and inverse kinematics solve linear systems.
    (np.linalg, "eigh"),
    (np.linalg, "solve"),
    (np.linalg, "svd"),
    (scipy.linalg, "lstsq"),
    # Scenes, hands and things are compiled by MuJoCo.
    (mujoco.MjModel, "from_xml_path"),
    (mujoco.MjModel, "from_xml_string"),
    (mujoco.MjSpec, "compile"),
)


class WorkError(Exception):
    """Something was loaded, trained or built."""


def _refuse(name: str) -> staticmethod[..., NoReturn]:
    def refuse(*arguments: object, **options: object) -> NoReturn:
        raise WorkError(
            f"{name} was called while tests were collected: "
            "move the call into a test, a fixture or a function with functools.cache"
        )

    return staticmethod(refuse)


for _owner, _name in REFUSED:
    setattr(_owner, _name, _refuse(_name))
