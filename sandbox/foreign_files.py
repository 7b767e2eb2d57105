"""Finds files of another package among ours in site-packages.

`models` and `tasks` are common names. Two packages that both bring a folder of such a name are
installed into one folder, and pip says nothing: what came last has replaced files of the same name.
The installed package's list of files (RECORD, PEP 376 and 627) tells which are ours. A checkout and
an editable install have no such list beside them, and share no folder with anybody.

Nothing is imported here but the standard library's plainest modules, since every import of
`sandbox` runs it.
"""

from __future__ import annotations

import os

_OURS = "hand_sandbox-"
_NO_PYTHON = {"__pycache__"}


def mixed_up(home: str, packages: tuple[str, ...]) -> dict[str, tuple[list[str], list[str]]]:
    """Files in the top folders of packages that are not as they were installed.

    Args:
        home: The folder of the packages.
        packages: Their names.

    Returns:
        Package -> files or folders that are not ours, and files of ours that were replaced or are
        gone; without packages that are whole. Empty where no list of files is.
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
    """Package -> name in its top folder -> bytes of a file, None for a folder or where unknown;
    None without a list of files."""
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
        # PATH,HASH,SIZE; a path with a comma is in quotes, and none of ours has one.
        before, _, size = line.rpartition(",")
        path = before.rpartition(",")[0]
        package, _, inner = path.partition("/")
        if package in names and inner:
            name, _, below = inner.partition("/")
            names[package][name] = int(size) if size.isdigit() and not below else None
    # An editable install lists none of its files here.
    return names if all(names.values()) else None
