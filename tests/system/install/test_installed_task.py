"""Tasks of an installed package."""

from __future__ import annotations

import json
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.support.processes import ROOT

LAB = """
from tests.tasks.test_custom_task import Slide
from tasks.simulated_user.control_users import IdleUser
from tasks.custom_task import judge
class Timed(Slide):
    name = "tiny-lab-timed"
    time_limit = 0.2
    hold_time = 0.05
    user = lambda configuration, surface, seed: IdleUser(configuration, surface, seed)
    def measure(self, sensing):
        return judge(1.0, (self.seed == 1, "seed one fails"))
class Renamed(Timed):
    name = "tiny-lab-other"
"""


METADATA = {
    "METADATA": "Metadata-Version: 2.1\nName: tiny-lab\nVersion: 0.3\n",
    "WHEEL": "Wheel-Version: 1.0\nGenerator: a test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    "RECORD": "",
    "entry_points.txt": """[hand_sandbox.tasks]
tiny-lab-timed = tiny_lab:Timed
tiny-lab-renamed = tiny_lab:Renamed
tiny-lab-missing = tiny_lab_nowhere:Gone
box-to-goal = tiny_lab:Timed
""",
}


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a package of a lab, installed by pip from a wheel."""
    target = tmp_path_factory.mktemp("site")
    wheel = tmp_path_factory.mktemp("wheel") / "tiny_lab-0.3-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("tiny_lab.py", LAB)
        for name, text in METADATA.items():
            archive.writestr(f"tiny_lab-0.3.dist-info/{name}", text)
    subprocess.run(
        [
            sys.executable,
            "-m",
            "pip",
            "install",
            "--quiet",
            "--no-deps",
            "--no-index",
            "--disable-pip-version-check",
            "--target",
            str(target),
            str(wheel),
        ],
        check=True,
    )
    return target


def sandbox(site: Path | None, *arguments: str) -> subprocess.CompletedProcess[str]:
    path = [str(site)] if site else []
    return subprocess.run(
        [
            sys.executable,
            "-c",
            f"import sys; sys.path[:0] = {[str(ROOT), *path]!r}\n"
            f"from sandbox.cli.main import main; sys.exit(main({list(arguments)!r}))",
        ],
        capture_output=True,
        text=True,
        cwd=ROOT,
        check=False,
    )


def test_an_installed_package_s_task_is_listed_run_recorded_and_replayed(
    installed: Path, tmp_path: Path
) -> None:
    record = str(tmp_path / "run.jsonl")
    listed = sandbox(installed).stdout
    assert "  tiny-lab-timed\n" in listed
    assert "tiny-lab-missing: " in listed and "No module named 'tiny_lab_nowhere'" in listed
    assert "tiny-lab-renamed: " in listed and "different names" in listed
    assert "box-to-goal: tiny-lab 0.3 offers a task of the same name as ours" in listed
    ran = sandbox(installed, "run", "tiny-lab-timed", "--record", record)
    assert ran.returncode == 0, ran.stderr
    assert "done" in ran.stdout
    again = sandbox(installed, "replay", record)
    assert again.returncode == 0 and "exact" in again.stdout
    without = sandbox(None, "replay", record)
    assert without.returncode == 2
    assert "pip install 'tiny-lab==0.3'" in without.stderr and without.stderr.count("\n") == 1


@pytest.mark.slow
def test_an_installed_task_that_is_broken_is_refused_alone(installed: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.json"
    ran = sandbox(
        installed, "regress", "--tasks", "tiny-lab-timed", "--seeds", "0:2", "--json", str(out)
    )
    assert ran.returncode == 0, ran.stderr
    found = json.loads(out.read_text())["tasks"]["tiny-lab-timed"]
    assert (found["n"], found["successes"]) == (2, 1)
    refused = sandbox(installed, "regress", "--tasks", "all", "--seeds", "0:1")
    assert refused.returncode == 2 and refused.stderr.count("\n") == 1
    assert "entry point tiny-lab-" in refused.stderr
