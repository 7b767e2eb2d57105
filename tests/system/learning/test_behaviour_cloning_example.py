"""The example of behaviour cloning trains on three demonstrations, as docs/data-sets.md prints.

PyTorch is large, so this is no quick check: it runs with `.ci/run --full`.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.processes import printed

ROOT = Path(__file__).resolve().parents[3]
EXAMPLE = "examples/behaviour_cloning.py"


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
    line = commands()[0].partition("#")[0].replace("'", "")
    words = line.removeprefix(".venv/bin/pip install ").split()
    subprocess.run([own, "-m", "pip", "install", "-q", *words], cwd=ROOT, check=True)
    return own


def commands() -> list[str]:
    """The lines of the section `Train on it`."""
    page = (ROOT / "docs" / "data-sets.md").read_text(encoding="utf-8")
    section = page.partition("## Train on it\n")[2].partition("\n## ")[0]
    (block,) = re.findall(r"^```\n(.*?)^```", section, re.M | re.S)
    return block.splitlines()


@pytest.mark.full
def test_it_trains_on_three_demonstrations_and_plays(python: Path, tmp_path: Path) -> None:
    path = os.environ | {"PATH": f"{python.parent}:{os.environ['PATH']}", "PYTHONPATH": str(ROOT)}
    *makes, trains = (line.replace(EXAMPLE, str(ROOT / EXAMPLE)) for line in commands()[1:])
    for line in makes:
        subprocess.run(["bash", "-euc", line], cwd=tmp_path, env=path, check=True)
    # The policy that was saved plays the same.
    again = trains.replace("--save", "--load")
    trained, loaded = (
        subprocess.run(
            ["bash", "-euc", line],
            cwd=tmp_path,
            env=path,
            capture_output=True,
            text=True,
            check=True,
        ).stdout.splitlines()
        for line in (trains, again)
    )
    assert trained[0] == "trains on 3 demonstrations"
    assert trained[1:] == loaded
    assert [line.split()[0] for line in loaded[:2]] == ["30000", "30001"]
    assert all(re.search(r" (succeeded|failed) after \d+\.\d s$", line) for line in loaded[:2])
    assert re.match(r"\d of 2 succeeded, 95 % interval ", loaded[2])


def test_without_pytorch_the_refusal_has_the_command_that_installs_it() -> None:
    program = (
        "import sys\n"
        f"sys.path.insert(0, {str(ROOT / 'examples')!r})\n"
        "import behaviour_cloning, models\n"
        "sys.modules['torch'] = None\n"
        "try:\n    behaviour_cloning.clone([], models.Surface())\n"
        "except models.InputError as error:\n    print(error)\n"
    )
    told = printed("-c", program)
    assert "PyTorch is not installed" in told and "pip install torch" in told
