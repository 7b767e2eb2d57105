"""Every file of the four packages is in the wheel, save the page's source and Python's caches.

python3 tools/check_wheel.py WHEEL     # exit status 1 names what the wheel lacks
"""

from __future__ import annotations

import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("models", "encoders", "tasks", "sandbox")
NOT_SHIPPED = {"page", "node_modules", "__pycache__"}
"""Folders inside the packages whose files stay out of the wheel."""


def missing(wheel: Path) -> list[str]:
    """Files of the packages that a wheel lacks, sorted."""
    sources = {
        path.relative_to(ROOT).as_posix()
        for name in PACKAGES
        for path in (ROOT / name).rglob("*")
        if path.is_file() and not NOT_SHIPPED & set(path.relative_to(ROOT).parts)
    }
    with zipfile.ZipFile(wheel) as archive:
        return sorted(sources - set(archive.namelist()))


if __name__ == "__main__":
    if lacking := missing(Path(sys.argv[1])):
        sys.exit("the wheel lacks " + ", ".join(lacking))
