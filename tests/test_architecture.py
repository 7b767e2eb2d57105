"""Arrows between the packages point down: what modules and registries really load, and import."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.support.import_graph import imported_names, modules
from tests.support.processes import printed

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("models", "encoders", "tasks", "sandbox")
CHECKOUT_ONLY = {"training", "tools", "benchmarks", "tests"}
"""Packages that are not in the wheel; nothing that is in it may import them."""
MAY_LOAD = {
    "models": {"models"},
    "encoders": {"models", "encoders"},
    "tasks": {"models", "tasks"},
}
"""The packages that each of the lower three may load."""
SHOWS_OR_SERVES = {"OpenGL", "glfw", "websockets", "matplotlib"}
"""Libraries of windows, sockets and plots; only `sandbox` may load them."""

LOAD_ALL = """
import importlib, json, pkgutil, sys

package = importlib.import_module(sys.argv[1])
for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
    importlib.import_module(module.name)
for name in package.__all__:
    getattr(package, name)
if package.__name__ == "models":
    from models.robot.mapping import ROBOTS, find_robot
    for name in ROBOTS:
        find_robot(name)
elif package.__name__ == "encoders":
    from encoders.regression.encoder_registry import ENCODERS, find_encoder
    for name in ENCODERS:
        find_encoder(name)
elif package.__name__ == "tasks":
    from tasks.registry import TASKS, find_task
    for name in TASKS:
        find_task(name)
print(json.dumps(sorted({name.partition(".")[0] for name in sys.modules})))
"""
"""Imports every module of a package and resolves every entry of its registries."""


@pytest.mark.parametrize("package", MAY_LOAD)
def test_a_package_loads_nothing_above_it_and_nothing_that_shows_or_serves(package: str) -> None:
    # MuJoCo itself would load glfw or OpenGL with its renderer.
    told = printed("-c", LOAD_ALL, package, MUJOCO_GL="disable")
    loaded = set(json.loads(told.splitlines()[-1]))
    above = loaded & {*PACKAGES, *CHECKOUT_ONLY} - MAY_LOAD[package]
    shows = loaded & SHOWS_OR_SERVES
    assert not above and not shows


def test_nothing_in_the_wheel_imports_what_is_in_the_checkout_only() -> None:
    # In functions, too, which no module runs when it is imported.
    wrong = {
        module: sorted(tops)
        for module, path in modules().items()
        if (tops := {name.partition(".")[0] for name in imported_names(module, path)})
        & CHECKOUT_ONLY
    }
    assert not wrong
