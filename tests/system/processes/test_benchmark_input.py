"""Benchmarks that take a file say in one line that it cannot be used."""

from __future__ import annotations

import pytest

from tests.support.processes import python


@pytest.mark.parametrize(
    "command",
    [
        "strangers --population none.npz",
        "other_machines none",
    ],
)
def test_a_file_that_is_not_there_is_told_in_one_line(command: str) -> None:
    name, *arguments = command.split()
    done = python("-m", f"benchmarks.{name}", *arguments)
    assert done.returncode == 2
    assert not done.stdout
    (line,) = done.stderr.splitlines()
    assert arguments[-1] in line
