"""Tasks of an installed package."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.support.lab_package import install_lab, sandbox_with

LAB = """
from tests.tasks.test_custom_task import Slide
from tasks.simulated_user.user import IdleUser
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


ENTRY_POINTS = """[hand_sandbox.tasks]
tiny-lab-timed = tiny_lab:Timed
tiny-lab-renamed = tiny_lab:Renamed
tiny-lab-missing = tiny_lab_nowhere:Gone
box-to-goal = tiny_lab:Timed
"""


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a package of a lab."""
    return install_lab(tmp_path_factory.mktemp("lab"), LAB, ENTRY_POINTS)


def test_an_installed_package_s_task_is_listed_run_recorded_and_replayed(
    installed: Path, tmp_path: Path
) -> None:
    record = str(tmp_path / "run.jsonl")
    listed = sandbox_with(installed).stdout
    assert "  tiny-lab-timed\n" in listed
    assert "tiny-lab-missing: " in listed and "No module named 'tiny_lab_nowhere'" in listed
    assert "tiny-lab-renamed: " in listed and "different names" in listed
    assert "box-to-goal: the task from tiny-lab 0.3 is left out" in listed
    ran = sandbox_with(installed, "run", "tiny-lab-timed", "--record", record)
    assert ran.returncode == 0, ran.stderr
    assert "done" in ran.stdout
    again = sandbox_with(installed, "replay", record)
    assert again.returncode == 0 and "exact" in again.stdout
    without = sandbox_with(None, "replay", record)
    assert without.returncode == 2
    assert "pip install 'tiny-lab==0.3'" in without.stderr and without.stderr.count("\n") == 1


@pytest.mark.slow
def test_an_installed_task_that_is_broken_is_refused_alone(installed: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.json"
    ran = sandbox_with(
        installed, "regress", "--tasks", "tiny-lab-timed", "--seeds", "0:2", "--json", str(out)
    )
    assert ran.returncode == 0, ran.stderr
    found = json.loads(out.read_text())["tasks"]["tiny-lab-timed"]
    assert (found["n"], found["successes"]) == (2, 1)
    refused = sandbox_with(installed, "regress", "--tasks", "all", "--seeds", "0:1")
    assert refused.returncode == 2 and refused.stderr.count("\n") == 1
    assert "entry point tiny-lab-" in refused.stderr
