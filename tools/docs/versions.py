"""Sites of released versions, beside the site of the newest state.

The site of a version is built from its tag, with the tools of this version. Its folder has the name
of the version.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parents[2]
_TAG = re.compile(r"v(\d+)\.(\d+)\.(\d+)")


def released(repository: Path = ROOT) -> list[str]:
    """Versions with a tag such as v0.2.0, newest first; empty outside of a repository."""
    asked = ["git", "tag", "--list", "v*"]
    tags = subprocess.run(asked, cwd=repository, capture_output=True, text=True, check=False).stdout
    versions = [match for line in tags.splitlines() if (match := _TAG.fullmatch(line))]
    versions.sort(key=lambda match: tuple(map(int, match.groups())), reverse=True)
    return [match[0].removeprefix("v") for match in versions]


def build_released(out: Path, versions: list[str], repository: Path = ROOT) -> int:
    """Builds the sites of versions; returns the exit status of the first failed build, or 0.

    Args:
        out: Folder of the whole site; each version gets a folder in it.
        versions: Versions that have a tag.
        repository: Repository with the tags.
    """
    for version in versions:
        with TemporaryDirectory() as folder:
            archive = subprocess.run(
                ["git", "archive", f"v{version}"], cwd=repository, capture_output=True, check=True
            )
            subprocess.run(["tar", "-x", "-C", folder], input=archive.stdout, check=True)
            built = subprocess.run(
                [
                    *(sys.executable, "-m", "tools.docs.site"),
                    *("--out", str((out / version).resolve())),
                    *("--newest", "../", "--versions", *versions),
                ],
                cwd=folder,
                env={**os.environ, "PYTHONPATH": folder},
                check=False,
            )
        if built.returncode:
            return built.returncode
    return 0
