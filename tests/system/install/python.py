"""Runs Python as a person without this project's settings would."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from tests.support.processes import ROOT

UNWANTED = {"PYTHONPATH", "PYTHONSAFEPATH", "PYTEST_ADDOPTS", "CI"}
"""Variables that would change what a child process is asked."""


def python(
    *args: object, cwd: Path, path: tuple[Path, ...] = (ROOT,), **environment: Any
) -> subprocess.CompletedProcess[str]:
    """Runs this Python in `cwd` with `path` as PYTHONPATH; installed packages stay visible."""
    kept = {k: v for k, v in os.environ.items() if k not in UNWANTED}
    kept["PYTHONPATH"] = os.pathsep.join(map(str, path))
    return subprocess.run(
        [sys.executable, *map(str, args)],
        cwd=cwd,
        env=kept | environment,
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        check=False,
    )
