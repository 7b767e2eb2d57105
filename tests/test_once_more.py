"""Failed tests of browsers, windows and processes get one more run, and no others do."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tools.once_more import FAILED, MOST, refusal

ROOT = Path(__file__).resolve().parent.parent
PASSES_LATER = """
from pathlib import Path

def test_the_program_answers():
    known = Path("known")
    there = known.exists()
    known.touch()
    assert there
"""


def runs(folder: Path, name: str, text: str) -> tuple[int, int]:
    """Exit status of pytest on one test file, and of the run after it."""
    file = folder / name
    file.parent.mkdir(parents=True)
    file.write_text(text)
    (folder / "pytest.ini").write_text("[pytest]\n")
    environment = {"PYTHONPATH": str(ROOT), "PATH": ""}
    status = [
        subprocess.run(
            [sys.executable, "-m", *command],
            cwd=folder,
            env=environment,
            capture_output=True,
            check=False,
        ).returncode
        for command in (["pytest", "-p", "no:xdist", name], ["tools.once_more"])
    ]
    return status[0], status[1]


@pytest.mark.parametrize(
    ("failed", "reason"),
    [
        ([], "no failed test is known"),
        (["tests/system/a.py::test_a", "tests/models/b.py::test_b"], "tests/models/b.py::test_b"),
        ([f"tests/system/a.py::test_{i}" for i in range(MOST + 1)], f"at most {MOST}"),
        (["tests/system/a.py::test_a"], ""),
    ],
)
def test_only_a_few_tests_that_wait_are_run_once_more(failed: list[str], reason: str) -> None:
    assert reason in refusal(failed)
    assert bool(reason) == bool(refusal(failed))


def test_a_failure_that_stays_fails_and_nothing_known_fails(tmp_path: Path) -> None:
    first = runs(tmp_path / "stays", "tests/system/test_a.py", "def test_a():\n    assert False\n")
    assert first == (1, 1)
    nothing = subprocess.run(
        [sys.executable, "-m", "tools.once_more"],
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT), "PATH": ""},
        check=False,
    )
    assert nothing.returncode == 1


def test_a_test_that_waits_and_passes_later_passes(tmp_path: Path) -> None:
    assert runs(tmp_path / "it", "tests/system/test_a.py", PASSES_LATER) == (1, 0)


def test_what_only_computes_is_not_run_once_more(tmp_path: Path) -> None:
    assert runs(tmp_path / "it", "tests/models/test_a.py", PASSES_LATER) == (1, 1)
    assert json.loads((tmp_path / "it" / FAILED).read_text())
