"""The command line as a program of its own."""

from __future__ import annotations

import re

from tests.support.processes import printed, python

SCRIPT = "sandbox.cli.main"


def test_the_program_is_a_module_too_and_tells_its_version() -> None:
    found = [printed("-m", program, "--version") for program in ("sandbox", SCRIPT)]
    assert found[0] == found[1]
    assert re.fullmatch(r"hand-sandbox \S+( \(commit [^)]+\))?, mujoco \S+, python \S+\n", found[0])


def test_standard_output_of_a_run_begins_with_its_result_whatever_was_noticed() -> None:
    """The knob of this trial is turned farther than hands that were trained on."""
    done = python("-m", SCRIPT, "run", "dial", "--seed", "3", "--solid", "hand")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("dial: done after ")
    assert "the hand seems turned" in done.stderr
