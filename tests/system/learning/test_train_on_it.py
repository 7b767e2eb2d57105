"""The page `Train on it` does what it prints, in an environment with PyTorch.

PyTorch is large, so this is no quick check: it runs with `.ci/run --full`.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
FENCED = re.compile(r"^```(python)?\n(.*?)^```", re.M | re.S)


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A Python with this program and PyTorch, as the page's first line makes it.

    `HAND_SANDBOX_LEARN` names one that is there already.
    """
    if there := os.environ.get("HAND_SANDBOX_LEARN"):
        return Path(there)
    folder = tmp_path_factory.mktemp("learning") / "environment"
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    own = folder / "bin" / "python"
    words = installing()
    subprocess.run([own, "-m", "pip", "install", "-q", *words], cwd=ROOT, check=True)
    return own


def blocks() -> list[tuple[str, str]]:
    """Kind and text of every block of the page, in order."""
    return FENCED.findall((ROOT / "docs" / "learning.md").read_text(encoding="utf-8"))


def installing() -> list[str]:
    """What the page's first line asks pip for."""
    line = blocks()[0][1].splitlines()[0].partition("#")[0]
    start = ".venv/bin/pip install "
    assert line.startswith(start)
    return line.removeprefix(start).replace("'", "").split()


@pytest.mark.full
def test_train_on_it_as_printed(python: Path, tmp_path: Path) -> None:
    shell, program = blocks()
    assert (shell[0], program[0]) == ("", "python")
    path = os.environ | {"PATH": f"{python.parent}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
    for line in shell[1].splitlines()[1:]:
        subprocess.run(["bash", "-euc", line], cwd=tmp_path, env=path, check=True)
    done = subprocess.run(
        [python, "-c", program[1]],
        cwd=tmp_path,
        env=path,
        capture_output=True,
        text=True,
        check=True,
    )
    played = done.stdout.splitlines()
    assert [line.split()[0] for line in played] == ["30000", "30001"]
    assert all(re.search(r" (succeeded|failed) after \d+\.\d s$", line) for line in played)
    assert (tmp_path / "policy.npz").stat().st_size > 1000
