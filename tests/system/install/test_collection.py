"""Tests are found without the work that they do."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


def collected(place: Path) -> subprocess.CompletedProcess[str]:
    """The outcome of a collection during which work is refused."""
    plugins = ("-p", "tests.system.install.refuse_work", "-p", "no:cacheprovider")
    return subprocess.run(
        [sys.executable, "-m", "pytest", "--collect-only", "-qq", "-n", "0", *plugins, str(place)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )


def test_no_test_file_trains_loads_or_builds_a_model_when_it_is_imported() -> None:
    outcome = collected(ROOT / "tests")
    assert outcome.returncode == 0, outcome.stdout[-3000:]


def test_a_test_file_that_loads_a_model_when_it_is_imported_is_noticed(tmp_path: Path) -> None:
    file = tmp_path / "test_loading.py"
    file.write_text(
        "from encoders.regression.trained import builtin_capture\n"
        "CAPTURE = builtin_capture()\n"
        "def test() -> None: pass\n",
        encoding="utf-8",
    )
    outcome = collected(file)
    assert outcome.returncode != 0
    assert "load was called while tests were collected" in outcome.stdout
