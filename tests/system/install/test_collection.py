"""Tests are found without the work that they do."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.support.processes import ROOT, python

LOADING = """
from encoders.regression.trained import builtin_capture
CAPTURE = builtin_capture()
def test() -> None: pass
"""
"""A test file that loads a capture when it is imported."""


@pytest.mark.slow
def test_no_test_file_trains_loads_or_builds_a_model_when_it_is_imported(tmp_path: Path) -> None:
    """Collects all of them and one that does, in a process in which such work is refused."""
    loading = tmp_path / "test_loading.py"
    loading.write_text(LOADING, encoding="utf-8")
    collect = "--collect-only --assert=plain -qq -n 0 --continue-on-collection-errors"
    plugins = "-p tests.system.install.refuse_work -p no:cacheprovider"
    words = ("-m", "pytest", *collect.split(), *plugins.split())
    outcome = python(*words, ROOT / "tests", loading)
    wrong = re.findall("^ERROR .*", outcome.stdout, re.MULTILINE)
    assert len(wrong) == 1, outcome.stdout[-3000:]
    assert f"{loading.name}:3: in <module>" in outcome.stdout
    assert "load was called while tests were collected" in outcome.stdout
