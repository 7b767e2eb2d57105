"""Runs failed tests of browsers, windows and processes once more: `python -m tools.once_more`.

Such tests wait for other programs, and on a machine that is busy with something else one of these
may come too late. `.ci/run` calls this after a run of all tests that failed. The failed tests pass
if all of them are in tests/system, they are at most five, and each passes now. All others have
failed for good: a test that only computes gives the same every time. The names are printed, so
that a test that fails often is noticed and mended.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

FAILED = Path(".pytest_cache", "v", "cache", "lastfailed")
"""Where pytest keeps the names of the tests that failed in its last run."""
WAITING = "tests/system/"
MOST = 5
"""Failed tests that are run once more. A fault in what they share would fail more of them."""


def refusal(failed: Sequence[str]) -> str:
    """Reason why these tests are not run once more; empty if they are.

    Args:
        failed: Names of tests as pytest prints them, "tests/folder/file.py::test".
    """
    if not failed:
        return "no failed test is known, so something else went wrong"
    computing = [name for name in failed if not name.startswith(WAITING)]
    if computing:
        return f"not only tests of {WAITING} failed: {', '.join(computing)}"
    if len(failed) > MOST:
        return f"{len(failed)} tests failed; at most {MOST} are run once more"
    return ""


def main() -> int:
    """Runs them; the exit status is pytest's, or 1 where nothing is run."""
    failed = sorted(json.loads(FAILED.read_text(encoding="utf-8"))) if FAILED.exists() else []
    if reason := refusal(failed):
        print(f"not run once more: {reason}")
        return 1
    print("failed, and run once more alone:", *failed, sep="\n  ", flush=True)
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-n", "0", *failed], check=False
    ).returncode


if __name__ == "__main__":
    sys.exit(main())
