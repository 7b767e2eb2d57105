"""Checks of Python packages: requirements and optional extras."""

from __future__ import annotations

import re
import sys
import tomllib
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, metadata, version
from pathlib import Path

from sandbox.doctor.check import Check

NAME = "hand-sandbox"
DEVELOPERS = ("test", "lint", "site", "release", "notebook", "training", "dev")
"""Extras for development only."""

USES = {
    "film": "films as mp4 (GIF and WebP need nothing)",
    "plots": "figures of evaluations and regression runs",
    "ray": "regression runs on a cluster",
    "gym": "tasks as Gymnasium environments",
    "datasets": "data sets of demonstrations for Minari and LeRobot",
    "robots": "hands of robots in the place of ours: Shadow, Adroit",
    "bullet": "comparison with Bullet",
    "evdev": "Linux touch screens and trackpads",
    "lsl": "streams to the Lab Streaming Layer",
    "study": "reports on user studies, and their tables for other programs",
}

_REQUIREMENT = re.compile(r"\s*([\w.-]+)\s*(?:\[[^\]]*\])?\s*\(?([^;)]*)\)?\s*(?:;(.*))?")
_BOUND = re.compile(r"\s*(>=|<=|==|<|>)\s*([\d.]+)\s*")


@dataclass(frozen=True)
class Requirement:
    """A package with its allowed versions.

    Attributes:
        package: Name in package indexes.
        bounds: Version bounds such as `>=4.0,<4.1`; empty allows any.
    """

    package: str
    bounds: str

    def unmet(self) -> str:
        """Reason why the requirement is not met; empty if it is met."""
        try:
            installed = version(self.package)
        except PackageNotFoundError:
            return f"{self.package} is not installed"
        return (
            ""
            if within(installed, self.bounds)
            else f"{self.package} {installed} is not {self.bounds}"
        )


def within(found: str, bounds: str) -> bool:
    """True if a version is within bounds; only its leading numbers count."""
    for sign, limit in _BOUND.findall(bounds):
        a, b = _numbers(found), _numbers(limit)
        length = max(len(a), len(b))
        a, b = a + (0,) * (length - len(a)), b + (0,) * (length - len(b))
        if not {">=": a >= b, "<=": a <= b, "==": a == b, "<": a < b, ">": a > b}[sign]:
            return False
    return True


def declared() -> dict[str, list[Requirement]]:
    """Declared requirements by extra; the key of mandatory ones is empty.

    A checkout's own file is preferred, since the metadata of an older installation may be outdated.
    """
    file = _checkout() / "pyproject.toml"
    if file.is_file():
        project = tomllib.loads(file.read_text(encoding="utf-8"))["project"]
        extras = {"": project["dependencies"], **project["optional-dependencies"]}
        return {extra: _parsed(lines) for extra, lines in extras.items()}
    declared_by_extra: dict[str, list[str]] = {"": []}
    about = metadata(NAME)
    for extra in about.get_all("Provides-Extra") or []:
        declared_by_extra[extra] = []
    for line in about.get_all("Requires-Dist") or []:
        named = re.search(r"""extra\s*==\s*["']([\w.-]+)["']""", line)
        declared_by_extra.setdefault(named[1] if named else "", []).append(line)
    return {extra: _parsed(lines) for extra, lines in declared_by_extra.items()}


def package_checks() -> list[Check]:
    """Checks of the mandatory packages and of each extra."""
    known = declared()
    wrong = list(filter(None, (r.unmet() for r in known[""])))
    line = _pip("")
    checks = [
        Check(
            "program",
            "packages",
            not wrong,
            "; ".join(wrong) or ", ".join(r.package for r in known[""]),
            "everything",
            line if wrong else "",
        )
    ]
    for extra, requirements in known.items():
        if not extra or extra in DEVELOPERS or not requirements:
            continue
        wrong = list(filter(None, (r.unmet() for r in requirements)))
        versions = ", ".join(f"{r.package} {version(r.package)}" for r in requirements if not wrong)
        checks.append(
            Check(
                "extras",
                extra,
                not wrong,
                "; ".join(wrong) or versions,
                USES.get(extra, ""),
                _pip(extra) if wrong else "",
            )
        )
    return checks


def _checkout() -> Path:
    return Path(__file__).resolve().parents[2]


def _pip(extra: str) -> str:
    """Returns the command that installs an extra into this Python."""
    brackets = f"[{extra}]" if extra else ""
    root = _checkout()
    if (root / "pyproject.toml").is_file():
        return f"{sys.executable} -m pip install -e '{root}{brackets}'"
    return f"{sys.executable} -m pip install '{NAME}{brackets}'"


def _parsed(lines: list[str]) -> list[Requirement]:
    requirements = []
    for line in lines:
        match = _REQUIREMENT.match(line)
        if match and _here(match[3] or "") and match[1] != NAME:
            requirements.append(Requirement(match[1], match[2].strip()))
    return requirements


def _here(marker: str) -> bool:
    """True if a requirement applies to this system."""
    named = re.search(r"""sys_platform\s*==\s*["'](\w+)["']""", marker)
    return named is None or named[1] == sys.platform


def _numbers(text: str) -> tuple[int, ...]:
    leading = re.match(r"\d+(\.\d+)*", text)
    return tuple(map(int, leading[0].split("."))) if leading else ()
