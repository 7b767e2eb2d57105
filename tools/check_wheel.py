"""Checks that a wheel contains every file of the four packages and no other file.

The source of the web page and Python's caches are not part of the wheel.

    python3 tools/check_wheel.py WHEEL     # exit status 1 if files are missing or superfluous
"""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("models", "encoders", "tasks", "sandbox")
NOT_SHIPPED = {"page", "node_modules", "__pycache__"}
"""Folders inside the packages whose files stay out of the wheel."""


def differences(wheel: Path) -> tuple[list[str], list[str]]:
    """Files of the packages that are not in the wheel, and files of the wheel that are in no
    package, both sorted."""
    sources = {
        path.relative_to(ROOT).as_posix()
        for name in PACKAGES
        for path in (ROOT / name).rglob("*")
        if path.is_file() and not NOT_SHIPPED & set(path.relative_to(ROOT).parts)
    }
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
    foreign = {
        name
        for name in names
        if (top := name.partition("/")[0]) not in PACKAGES and not top.endswith(".dist-info")
    }
    return sorted(sources - names), sorted(foreign)


if __name__ == "__main__":
    lacking, foreign = differences(Path(sys.argv[1]))
    if lacking:
        sys.exit("the wheel lacks " + ", ".join(lacking))
    if foreign:
        sys.exit("the wheel has files of no package: " + ", ".join(foreign))
