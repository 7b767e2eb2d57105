"""three.js and the glTF validator, fetched once a process; skips where node or its registry is not.

With CI=true a skip fails the run: `.ci/run` installs node.
"""

from __future__ import annotations

import atexit
import json
import shutil
import subprocess
from functools import cache
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import pytest

HERE = Path(__file__).parent / "readers"


def ask(*arguments: object) -> Any:
    """Output of `read.mjs`."""
    folder = _installed()
    if isinstance(folder, str):
        pytest.skip(folder)
    said = subprocess.run(
        ["node", "read.mjs", *map(str, arguments)],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert said.returncode == 0, said.stderr
    return json.loads(said.stdout)


@cache
def _installed() -> Path | str:
    """The folder with the readers, or why there is none."""
    if not (shutil.which("node") and shutil.which("npm")):
        return "node or npm is not installed"
    folder = Path(mkdtemp(prefix="hand-sandbox-readers-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    for name in ("package.json", "package-lock.json", "read.mjs"):
        shutil.copy(HERE / name, folder / name)
    line = ["npm", "ci", "--silent", "--ignore-scripts", "--no-audit", "--no-fund"]
    done = subprocess.run(
        line, cwd=folder, capture_output=True, text=True, timeout=300, check=False
    )
    if done.returncode:
        return f"npm could not fetch the readers: {done.stderr.strip()[-200:]}"
    return folder
