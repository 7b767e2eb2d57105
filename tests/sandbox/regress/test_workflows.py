"""Workflows for CI that people copy: what they run exists, and they say what is to be filled in."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
from dataclasses import replace
from textwrap import dedent

import pytest

from sandbox.cli.common.command_line import parse
from sandbox.cli.regress import RegressOptions
from tests.support.processes import ROOT


def workflows() -> list[str]:
    """The workflows that people copy, as YAML."""
    page = (ROOT / "docs" / "getting-started.md").read_text()
    return [
        (ROOT / "examples" / "ci" / "regression.yml").read_text(),
        *re.findall(r"^```yaml\n(.*?)^```", page, re.M | re.S),
    ]


@pytest.mark.skipif(shutil.which("sh") is None, reason="no shell")
@pytest.mark.parametrize("text", workflows(), ids=["example", "page"])
def test_a_workflow_without_the_sandbox_s_address_says_so_and_installs_nothing(text: str) -> None:
    (lines,) = re.findall(r"run: \|\n((?: {10}.*\n)+)", text)
    script = dedent(lines).replace("pip install", "echo pip install")
    for address, status in (("", False), ("https://git.example.org/sandbox.git", True)):
        env = {**os.environ, "HAND_SANDBOX": address}
        words = ["sh", "-e", "-c", script]
        ran = subprocess.run(words, check=False, env=env, capture_output=True, text=True)
        assert (ran.returncode == 0) == status
        assert ("HAND_SANDBOX: is empty. Set this variable" in ran.stderr) != status
        assert (f"hand-sandbox @ git+{address}" in ran.stdout) == status


@pytest.mark.parametrize("text", workflows(), ids=["example", "page"])
def test_a_workflow_keeps_the_results_that_it_writes(text: str) -> None:
    (written,) = re.findall(r"--junit(?:xml=| )(\S+)", text)
    assert written in text.partition("actions/upload-artifact")[2]


def test_the_workflow_to_copy_gives_options_that_there_are() -> None:
    text = (ROOT / "examples" / "ci" / "regression.yml").read_text()
    lines = re.findall(r"^ {10}(sandbox regress.*(?:\n {10}\S.*)*)", text, re.M)
    made, found = (
        parse(RegressOptions, "sandbox regress", shlex.split(line)[2:]) for line in lines
    )
    assert found.baseline and found.junit and found.json and made.update_baseline
    # What makes the baseline runs what the job compares with it.
    made = replace(made, update_baseline=False)
    names = ("json", "junit", "markdown", "record", "given")
    assert replace(made, **{name: getattr(found, name) for name in names}) == found
