"""The oldest libraries that tests are run with follow from the bounds in pyproject.toml."""

from __future__ import annotations

import tomllib

import pytest
from packaging.requirements import Requirement

from tools.python_versions import EXTRA, PYTHONS, ROOT, interpreters, lowest, requirements

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_every_requirement_of_the_program_and_of_its_tests_has_a_lower_bound() -> None:
    found = requirements(PROJECT, EXTRA)
    names = {requirement.name for requirement in found}
    # Of the program, of an extra that tests take in, and of the tests themselves.
    assert {"mujoco", "pandas", "pytest"} <= names and PROJECT["name"] not in names
    for requirement in found:
        bound = next(s.version for s in requirement.specifier if s.operator == ">=")
        assert lowest(requirement, [bound, "9999"]) == bound


@pytest.mark.parametrize(
    ("requirement", "versions", "found"),
    [
        ("a>=1.9", ["1.10", "1.9", "1.8"], "1.9"),
        ("a>=2.0", ["2.4", "2.1.0", "1.26"], "2.1.0"),
        ("a>=4.0,<4.1", ["4.1", "4.0.2", "4.0.1"], "4.0.1"),
        ("a>=1", ["2.0", "1.0rc1"], "2.0"),
    ],
)
def test_the_lowest_is_that_which_the_bound_allows_and_that_has_a_wheel(
    requirement: str, versions: list[str], found: str
) -> None:
    assert lowest(Requirement(requirement), versions) == found


@pytest.mark.parametrize(
    ("requirement", "told"), [("a", "no lower bound"), ("a<3", "no lower bound"), ("a>=3", "wheel")]
)
def test_what_gives_no_lowest_version_is_told(requirement: str, told: str) -> None:
    with pytest.raises(SystemExit, match=told):
        lowest(Requirement(requirement), ["2.0"])


def test_every_interpreter_that_is_found_is_a_supported_one_that_runs() -> None:
    assert set(interpreters()) <= set(PYTHONS)
