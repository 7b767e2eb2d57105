"""The conda recipe and the container file say what pyproject.toml says."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from tools.release.container import FILE, steps

ROOT = Path(__file__).parents[1]
OTHER_NAMES = {"mujoco": "mujoco-python", "glfw": "pyglfw"}
"""Name on the package index of Python -> name on conda-forge."""


@pytest.fixture(scope="module")
def project() -> dict[str, Any]:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    whole: dict[str, Any] = tomllib.loads(text)["project"]
    return whole


@pytest.fixture(scope="module")
def recipe() -> str:
    return (ROOT / "install" / "conda" / "recipe.yaml").read_text(encoding="utf-8")


def test_the_conda_package_needs_what_the_wheel_needs(project: dict[str, Any], recipe: str) -> None:
    run = recipe.split("\n  run:\n")[1].split("\n\n", maxsplit=1)[0]
    needed = {line.replace(" ", "") for line in re.findall(r"^    - (.*)$", run, re.M)}
    wanted = {"python>=${{python_min}}"}
    for requirement in project["dependencies"]:
        [(name, bounds)] = re.findall(r"^([\w-]+)(.*)$", requirement)
        wanted.add(OTHER_NAMES.get(name, name) + bounds)
    assert needed == wanted


def test_the_conda_package_has_the_version_and_the_command(
    project: dict[str, Any], recipe: str
) -> None:
    assert f'version: "{project["version"]}"' in recipe
    assert f'python_min: "{project["requires-python"].removeprefix(">=")}"' in recipe
    [(name, place)] = project["scripts"].items()
    assert f"- {name} = {place}" in recipe
    assert project["description"] in recipe
    assert all(f"- {file}" in recipe for file in project["license-files"])


def test_the_container_runs_the_command_with_extras_that_exist(project: dict[str, Any]) -> None:
    told = list(steps(FILE.read_text(encoding="utf-8")))
    words = dict(told)
    assert json.loads(words["ENTRYPOINT"]) == list(project["scripts"])
    assert words["USER"] != "root"
    [extras] = re.findall(r"hand-sandbox\[([\w,]+)\]", " ".join(rest for _, rest in told))
    assert set(extras.split(",")) <= set(project["optional-dependencies"])


def test_lines_of_a_container_file_that_go_on_are_one_instruction() -> None:
    text = "# a\nFROM debian:bookworm\n# b\nRUN one \\\n && two\n\nUSER 1000\n"
    assert list(steps(text)) == [
        ("FROM", "debian:bookworm"),
        ("RUN", "one && two"),
        ("USER", "1000"),
    ]
