"""What a command does and says with its exit status does not depend on who reads what it prints."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

COMMAND = [sys.executable, "-m", "sandbox"]
REGRESS = [*COMMAND, "regress", "--tasks", "box-to-goal", "--seeds", "0:1", "--json", "r.json"]
FULL = Path("/dev/full")


def run(*command: str, **options: Any) -> subprocess.CompletedProcess[str]:
    """Runs a command; its output is what the test says, and its errors are read."""
    options = {"stdout": subprocess.PIPE} | options
    return subprocess.run(command, stderr=subprocess.PIPE, text=True, check=False, **options)


def test_a_full_disk_behind_the_output_costs_no_report(tmp_path: Path) -> None:
    if not FULL.exists():
        pytest.skip("this system has no /dev/full")
    with FULL.open("wb") as full:
        done = run(*REGRESS, cwd=tmp_path, stdout=full)
    assert done.returncode == 0
    assert "standard output: No space left on device" in done.stderr
    assert "Traceback" not in done.stderr
    assert json.loads((tmp_path / "r.json").read_text())["passed"] is True


def test_a_reader_that_leaves_changes_neither_the_report_nor_the_exit_status(
    tmp_path: Path,
) -> None:
    read, write = os.pipe()
    os.close(read)
    done = run(*REGRESS, cwd=tmp_path, stdout=write)
    os.close(write)
    assert (done.returncode, "Traceback" in done.stderr) == (0, False)
    assert json.loads((tmp_path / "r.json").read_text())["passed"] is True


@pytest.mark.parametrize("words", [["--version"], ["run", "--help"], ["--help"]])
def test_help_on_a_full_disk_is_one_line(words: list[str]) -> None:
    if not FULL.exists():
        pytest.skip("this system has no /dev/full")
    with FULL.open("wb") as full:
        done = run(*COMMAND, *words, stdout=full)
    assert done.returncode == 1
    assert done.stderr == "sandbox: standard output: No space left on device\n"


@pytest.mark.parametrize("command", [["run", "ends.py"], ["regress", "--tasks", "ends.py"]])
def test_a_task_that_ends_the_program_when_it_is_read_passes_no_gate(
    tmp_path: Path, command: list[str]
) -> None:
    (tmp_path / "ends.py").write_text("import sys\nsys.exit()\n")
    done = run(*COMMAND, *command, cwd=tmp_path)
    assert done.returncode == 2
    assert "this task cannot be loaded" in done.stderr and "SystemExit" in done.stderr


@pytest.mark.parametrize(
    "words",
    [
        ["run", "box-to-goal", "--json", "loop"],
        ["run", "box-to-goal", "--record", "loop"],
        ["regress", "--tasks", "box-to-goal", "--seeds", "0:1", "--baseline", "loop"],
        ["export", "run.jsonl", "--to", "loop/x.bvh"],
    ],
)
def test_links_in_a_circle_are_one_line(tmp_path: Path, words: list[str]) -> None:
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "run.jsonl").write_text("")
    done = run(*COMMAND, *words, cwd=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr and len(done.stderr.splitlines()) == 1


HALF = '''
from models import Box
from tasks import CustomTask, Goal, judge


class Odd(CustomTask):
    """A box that is never there."""

    name = "half-emoji"
    time_limit = 0.6

    @classmethod
    def place(cls, rng, surface):
        goal = Goal("b", (0.05, 0.0, 0.02), 0.0)
        return [Box("b", (0.02, 0.02, 0.02), 0.1, (0.0, 0.0, 0.02))], [goal]

    def measure(self, sensing):
        return judge(0.0, (True, "half of a sign: \\ud83d"))
'''


@pytest.mark.parametrize("encoding", ("utf-8", "ascii", "latin-1"))
def test_text_that_no_encoding_has_costs_no_report(encoding: str, tmp_path: Path) -> None:
    (tmp_path / "task.py").write_text(HALF)
    words = ["--tasks", "task.py", "--seeds", "0:2", "--json", "r.json", "--junit", "j.xml"]
    command = [*COMMAND, "regress", *words, "--executor", "serial"]
    done = run(*command, cwd=tmp_path, env={**os.environ, "PYTHONIOENCODING": encoding})
    assert done.returncode == 0 and "Traceback" not in done.stderr
    assert "half of a sign: \\ud83d" in done.stdout
    trials = json.loads((tmp_path / "r.json").read_text())["trials"]
    assert [trial["reason"] for trial in trials] == ["half of a sign: \ud83d"] * 2
    assert ElementTree.parse(tmp_path / "j.xml").find(".//testcase") is not None
