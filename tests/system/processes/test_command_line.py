"""The command line as a program of its own."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

SCRIPT = "sandbox.cli.main"


def test_the_program_is_a_module_too_and_tells_its_version() -> None:
    found = [
        subprocess.run([*program, "--version"], capture_output=True, text=True, check=True).stdout
        for program in ([sys.executable, "-m", "sandbox"], [sys.executable, "-m", SCRIPT])
    ]
    assert found[0] == found[1]
    assert re.fullmatch(r"hand-sandbox \S+( \(commit [^)]+\))?, mujoco \S+, python \S+\n", found[0])


def test_the_command_line_knows_the_hand(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "sandbox.cli.main", "run", "--hand", "left", "--hand-size", "9"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
        env={"PYTHONPATH": str(Path(__file__).parents[3]), "PATH": "/usr/bin:/bin"},
    )
    assert done.returncode == 2 and "--hand-size" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_standard_output_of_a_run_begins_with_its_result_whatever_was_noticed() -> None:
    """The knob of this trial is turned farther than hands that were trained on."""
    done = subprocess.run(
        [sys.executable, "-m", SCRIPT, "run", "dial", "--seed", "3", "--solid", "hand"],
        capture_output=True,
        text=True,
        timeout=240,
        check=True,
    )
    assert done.stdout.startswith("dial: done after ")
    assert "the hand seems turned" in done.stderr
