"""Finds files of other packages in the folders of this program in site-packages.

`models` and `tasks` are common names. If two packages have a folder with such a name, pip installs
both into one folder without a warning, and the later package replaces files of the same name. The
installed package's list of files (RECORD, PEP 376 and 627) tells which files belong to this
program. A checkout and an editable install have no such list, and share no folder with other
packages.

Every import of `sandbox` runs this module, so that it imports only `os`.
"""

from __future__ import annotations

import os

_OURS = "hand_sandbox-"
_NO_PYTHON = {"__pycache__"}


def mixed_up(home: str, packages: tuple[str, ...]) -> dict[str, tuple[list[str], list[str]]]:
    """Finds foreign and changed files in the top folders of packages.

    Args:
        home: The folder of the packages.
        packages: Names of the packages.

    Returns:
        For each affected package: names of files and folders that do not belong to it, and names of
        its files that were replaced or are missing. Empty without a list of installed files.
    """
    recorded = _recorded(home, packages)
    if recorded is None:
        return {}
    found = {}
    for package in packages:
        ours = recorded[package]
        with os.scandir(os.path.join(home, package)) as entries:
            sizes = {
                entry.name: -1 if entry.is_dir() else entry.stat().st_size for entry in entries
            }
        strange = sorted(set(sizes) - set(ours) - _NO_PYTHON)
        changed = sorted(
            name for name, size in ours.items() if size is not None and sizes.get(name) != size
        )
        if strange or changed:
            found[package] = strange, changed
    return found


def _recorded(home: str, packages: tuple[str, ...]) -> dict[str, dict[str, int | None]] | None:
    """The installed files: package -> name in its top folder -> size in bytes.

    A size is None for a folder, or if it is unknown. Returns None without a list of files.
    """
    try:
        [folder] = [
            name
            for name in os.listdir(home)
            if name.startswith(_OURS) and name.endswith(".dist-info")
        ]
        with open(os.path.join(home, folder, "RECORD"), encoding="utf-8") as file:
            lines = file.read().splitlines()
    except (OSError, ValueError):
        return None
    names: dict[str, dict[str, int | None]] = {package: {} for package in packages}
    for line in lines:
        # PATH,HASH,SIZE. A path with a comma would be in quotes; this program has no such path.
        before, _, size = line.rpartition(",")
        path = before.rpartition(",")[0]
        package, _, inner = path.partition("/")
        if package in names and inner:
            name, _, below = inner.partition("/")
            names[package][name] = int(size) if size.isdigit() and not below else None
    # An editable install lists none of its files here.
    return names if all(names.values()) else None
