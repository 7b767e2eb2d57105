"""Workflows for CI that people copy: what they run exists, and they say what is to be filled in."""

from __future__ import annotations

import re
import shlex
from dataclasses import replace

from sandbox.cli.common.command_line import parse
from sandbox.cli.regress import RegressOptions
from tests.support.processes import ROOT


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
