"""What is left to be done before a version is out."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from tools.docs.owner import to_fill_in
from tools.release.keep import missing
from tools.release.plan import not_covered
from tools.release.released import releases

ROOT = Path(__file__).resolve().parents[2]


def version_of(root: Path = ROOT) -> str:
    """The version in pyproject.toml."""
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    return str(project["project"]["version"])


def to_do(root: Path = ROOT) -> list[str]:
    """A line for each thing that is left; empty if the version can be tagged."""
    version = version_of(root)
    left = []
    citation = (root / "CITATION.cff").read_text(encoding="utf-8")
    if f"\nversion: {version}\n" not in citation:
        left.append(f"CITATION.cff: version is not {version}")
    changelog = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    heading = re.search(rf"^## \[{re.escape(version)}\] - (.*)$", changelog, re.MULTILINE)
    if heading is None:
        left.append(f"CHANGELOG.md: no section of {version}")
    elif heading[1] == "unreleased":
        left.append(f"CHANGELOG.md: the date of {version} is to be filled in")
    left += to_fill_in()
    kept = {release.version: release for release in releases()}
    if version not in kept:
        left.append(f"no recordings: python -m tools.release record {version}")
    else:
        lacking = not_covered(list(kept[version].recordings))
        left += [f"{version} has no recording {name}" for name in lacking]
        if kept[version].candidate:
            left.append(f"{version} is a candidate: python -m tools.release out {version}")
    left += [f"{old} names a model that is not kept: {d}" for d, old in missing().items()]
    return left
