"""The README's commands, what CI runs and what is shipped."""

from __future__ import annotations

import re
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import Any

import pytest

from tests.support.import_graph import imported_names, modules

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("models", "encoders", "tasks", "sandbox")
NOT_SHIPPED = {"__pycache__", "page", "node_modules"}
"""Folders inside the packages whose files stay out of the wheel."""
GUESTS = {
    "sandbox.stream.maya_side": {"maya", "__main__"},
    "sandbox.stream.blender_rigs": {"bpy", "mathutils"},
    "sandbox.stream.blender_side": {"bpy"},
}
"""Modules that run inside other programs, and what these bring along."""


@pytest.fixture(scope="module")
def project() -> dict[str, Any]:
    """pyproject.toml."""
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def test_ci_runs_the_readme_command_to_the_letter() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    ci_run = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    (command,) = re.findall(r"^readme_tests='(.*)'$", ci_run, re.MULTILINE)
    assert f"\n{command}\n" in readme and command.endswith("pytest")
    assert re.search(r'^[^#]*bash -euc "\$readme_tests"', ci_run, re.MULTILINE)


def test_every_folder_of_modules_is_a_package() -> None:
    """setuptools leaves a folder without __init__.py out of the wheel without a word."""
    folders = {path.parent for name in PACKAGES for path in (ROOT / name).rglob("*.py")}
    assert not [folder for folder in sorted(folders) if not (folder / "__init__.py").is_file()]


def canonical(name: str) -> str:
    """A distribution's name as package indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def test_every_library_that_is_imported_is_declared(project: dict[str, Any]) -> None:
    """Whatever another package happens to bring along may be gone with its next release."""
    extras = project["project"]["optional-dependencies"].values()
    needed = [*project["project"]["dependencies"], *(r for extra in extras for r in extra)]
    declared = {canonical(re.split(r"[^\w.-]", requirement)[0]) for requirement in needed}
    providers = packages_distributions()
    wrong = []
    for module, path in modules().items():
        own = {*PACKAGES, *sys.stdlib_module_names, *GUESTS.get(module, ())}
        for top in {name.partition(".")[0] for name in imported_names(module, path)} - own:
            if not {canonical(name) for name in providers.get(top, [top])} & declared:
                wrong.append(f"{module} imports {top}")
    assert not wrong


def test_every_data_file_is_shipped(project: dict[str, Any]) -> None:
    patterns = project["tool"]["setuptools"]["package-data"]["*"]
    packages = [init.parent for name in PACKAGES for init in (ROOT / name).rglob("__init__.py")]
    shipped = {file for folder in packages for glob in patterns for file in folder.glob(glob)}
    data = {
        path
        for name in PACKAGES
        for path in (ROOT / name).rglob("*")
        if path.is_file()
        and path.suffix != ".py"
        and not NOT_SHIPPED & set(path.relative_to(ROOT).parts)
    }
    assert {ROOT / name / "py.typed" for name in PACKAGES} <= data
    assert not sorted(data - shipped), "add their suffix to package-data in pyproject.toml"


def test_the_wheel_has_the_four_packages_and_no_other(project: dict[str, Any]) -> None:
    patterns = project["tool"]["setuptools"]["packages"]["find"]["include"]
    assert sorted(patterns) == sorted([*PACKAGES, *(f"{name}.*" for name in PACKAGES)])


def test_the_changelog_tells_of_this_version(project: dict[str, Any]) -> None:
    version = re.escape(project["project"]["version"])
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(rf"^## \[{version}\]", changelog, re.MULTILINE)


def test_the_citation_and_the_licences_are_of_what_is_shipped(project: dict[str, Any]) -> None:
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {project['project']['version']}\n" in citation
    page = (ROOT / "docs" / "comparison.md").read_text(encoding="utf-8")
    assert f"version = {{{project['project']['version']}}}" in page
    files = project["project"]["license-files"]
    assert all((ROOT / file).is_file() for file in files)
    bundled = ROOT / "sandbox" / "views" / "static" / "licences.txt"
    assert bundled.relative_to(ROOT).as_posix() in files


def test_the_source_archive_has_what_the_tests_need() -> None:
    manifest = (ROOT / "MANIFEST.in").read_text(encoding="utf-8")
    grafted = set(re.findall(r"^graft (.*)$", manifest, re.MULTILINE))
    folders = {path.name for path in ROOT.iterdir() if path.is_dir()}
    made = {".git", "out", "build", "dist", "sandbox-demo", "node_modules"}
    kept = {name for name in folders - made if not re.search(r"^\.(?!ci$|github$)|egg-info$", name)}
    assert kept <= grafted
