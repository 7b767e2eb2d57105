"""A skipped test is no passed test, and CI refuses what it does not know."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

import pytest

from tests.support.processes import ROOT, python

SKIPS = """
import pytest
def test_no_reason(): pytest.skip("no display")
@pytest.mark.skipif(True, reason="too slow")
def test_marked(): pass
def test_missing_library(): pytest.importorskip("a_library_nobody_has")
def test_expected_failure(request):
    request.applymarker(pytest.mark.xfail)
    assert False
def test_data(shared_data): assert shared_data.is_dir()
def test_data_elsewhere(): pytest.skip("shared data absent: so it says")
def test_node(device_node): device_node("/dev/no-such-node")
def test_usable_node(): pytest.skip("device node absent: /dev/null")
def test_no_node(): pytest.skip("device node absent: /etc/no-such-node")
@pytest.mark.slow
def test_slow(): pass
"""
"""Ways to be skipped; what becomes of each is in the tests below."""


def outcomes(folder: Path, **environment: str) -> dict[str, str]:
    """Test name -> PASSED, SKIPPED, ... for SKIPS run under the project's conftest."""
    shutil.copy(ROOT / "tests" / "conftest.py", folder)
    (folder / "test_skips.py").write_text(SKIPS, encoding="utf-8")
    run = ("-m", "pytest", "-v", "-p", "no:cacheprovider", "--rootdir", folder, folder)
    lines = re.findall(
        r"::(test_\w+) ([A-Z]+)", python(*run, cwd=folder, path=(ROOT,), **environment).stdout
    )
    assert lines
    return dict(lines)


def test_ci_fails_a_skip_unless_what_it_lacks_may_be_lacking(tmp_path: Path) -> None:
    absent = str(tmp_path / "absent")
    assert outcomes(tmp_path, CI="true", HAND_SANDBOX_DATA=absent) == {
        "test_no_reason": "FAILED",
        "test_marked": "ERROR",
        "test_missing_library": "FAILED",
        "test_expected_failure": "XFAIL",
        "test_data": "SKIPPED",
        "test_data_elsewhere": "SKIPPED",
        "test_node": "SKIPPED",
        "test_usable_node": "FAILED",
        "test_no_node": "FAILED",
        "test_slow": "PASSED",
    }


def test_ci_fails_a_skip_for_data_that_is_there(tmp_path: Path) -> None:
    found = outcomes(tmp_path, CI="true", HAND_SANDBOX_DATA=str(tmp_path))
    assert found["test_data"] == "PASSED"
    assert found["test_data_elsewhere"] == "FAILED"


def test_ci_fails_a_whole_file_that_is_skipped(tmp_path: Path) -> None:
    shutil.copy(ROOT / "tests" / "conftest.py", tmp_path)
    (tmp_path / "test_whole.py").write_text(
        "import pytest\npytest.skip('no display', allow_module_level=True)\n", encoding="utf-8"
    )
    run = ("-m", "pytest", "-p", "no:cacheprovider", "--rootdir", tmp_path, tmp_path)
    result = python(*run, cwd=tmp_path, CI="true")
    assert result.returncode not in (0, 5)
    assert "no display" in result.stdout


@pytest.mark.slow
def test_a_folder_is_tested_in_processes_where_a_skip_fails_too_and_a_file_in_one(
    tmp_path: Path,
) -> None:
    shutil.copy(ROOT / "tests" / "conftest.py", tmp_path)
    for name in ("test_a.py", "test_b.py"):
        (tmp_path / name).write_text(
            "import pytest\ndef test_no_reason(): pytest.skip('no display')\n", encoding="utf-8"
        )
    can_count = hasattr(os, "sched_getaffinity")
    processors = len(os.sched_getaffinity(0)) if can_count else os.cpu_count() or 1
    run = ("-m", "pytest", "-v", "-p", "no:cacheprovider", "-n", "auto", "--dist", "loadfile")
    for asked, failed in ((tmp_path, 2), (tmp_path / "test_a.py", 1)):
        said = python(*run, "--rootdir", tmp_path, asked, cwd=tmp_path, CI="true").stdout
        assert re.fullmatch(f"=+ {failed} failed in .*=+", said.splitlines()[-1]), said
        assert said.count("with CI=true a skipped test fails") >= failed
        assert ("[gw" in said) == (asked == tmp_path and processors > 1)
