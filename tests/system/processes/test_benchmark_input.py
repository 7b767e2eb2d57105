"""Benchmarks that take a file say in one line that it cannot be used."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import benchmarks

REPOSITORY = Path(benchmarks.__file__).parent.parent


@pytest.mark.parametrize(
    "command",
    [
        "strangers --population none.npz",
        "other_machines none",
    ],
)
def test_a_file_that_is_not_there_is_told_in_one_line(command: str) -> None:
    name, *arguments = command.split()
    done = subprocess.run(
        [sys.executable, "-m", f"benchmarks.{name}", *arguments],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert not done.stdout
    (line,) = done.stderr.splitlines()
    assert arguments[-1] in line
