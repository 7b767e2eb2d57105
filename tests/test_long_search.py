"""The profile `long` gives every hypothesis test more examples, from the seed that is asked for."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
COUNTED = """
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st


@pytest.mark.parametrize("twice", range(2))
@settings(max_examples=3)
@given(number=st.integers())
def test_few(number, twice):
    print("few", twice, number)


@given(number=st.integers())
def test_usual(number):
    print("usual", number)
"""


def counted(tmp_path: Path, *options: str) -> list[str]:
    """What the two tests print, in CI's environment, under this project's tests/conftest.py."""
    test = tmp_path / "test_counted.py"
    test.write_text(COUNTED)
    command = [sys.executable, "-m", "pytest", "-q", "-s", "-n", "0", "-p", "no:cacheprovider"]
    command += ["-c", str(ROOT / "pyproject.toml"), "-p", "tests.conftest", *options, str(test)]
    done = subprocess.run(
        command,
        cwd=ROOT,
        env={**os.environ, "CI": "true"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return [line.lstrip(".") for line in done.stdout.splitlines() if " " in line]


def number_of(lines: list[str], what: str) -> int:
    return sum(line.startswith(what) for line in lines)


def test_a_long_search_has_ten_times_the_examples_of_a_quick_one_or_more(tmp_path: Path) -> None:
    quick = counted(tmp_path)
    long = counted(tmp_path, "--hypothesis-profile=long", "--hypothesis-seed=1")
    for what, few, many in (("few 0", 3, 30), ("few 1", 3, 30), ("usual", 25, 1_000)):
        assert number_of(quick, what) == few
        assert number_of(long, what) == many


@pytest.mark.parametrize("profile", ("hand-sandbox", "long"))
def test_only_a_long_search_in_ci_depends_on_the_seed(tmp_path: Path, profile: str) -> None:
    seeds = (1, 1, 2)
    one, again, other = (
        counted(tmp_path, f"--hypothesis-profile={profile}", f"--hypothesis-seed={seed}")
        for seed in seeds
    )
    kept = [[line for line in run if line.startswith(("few", "usual"))] for run in (one, again)]
    assert kept[0] == kept[1]
    changed = kept[0] != [line for line in other if line.startswith(("few", "usual"))]
    assert changed == (profile == "long")
