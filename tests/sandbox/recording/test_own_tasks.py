"""A task of one's own is known by its code and by the things that it places."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from sandbox.recording.recorded_task import own_tasks
from tests.support.processes import printed

TASK = """
from pathlib import Path

from limits import FAR
from models import MjcfObject
from tasks import CustomTask, Goal, judge


class Push(CustomTask):
    name = "lab-push"

    @classmethod
    def place(cls, rng, surface):
        mug = MjcfObject.on_table("mug", Path(__file__).parent / "mug.xml", 0.2, (0.0, 0.0))
        return [mug], [Goal("mug", (FAR, 0.0, mug.height), 0.0)]

    def measure(self, sensing):
        return judge(0.0, (True, "never"))
"""
MUG = """<mujoco><worldbody><body>
  <geom type="cylinder" size=".02 .03"/></body></worldbody></mujoco>"""


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    (tmp_path / "push.py").write_text(TASK)
    (tmp_path / "limits.py").write_text("FAR = 0.05\n")
    (tmp_path / "mug.xml").write_text(MUG)
    return tmp_path


def known(lab: Path) -> str:
    """What a fresh program says of the task: it loads a file once."""
    line = (
        "import sys; from sandbox.recording.recorded_task import own_tasks;"
        "print(own_tasks(sys.argv[1:]))"
    )
    return printed("-c", line, lab / "push.py", "box-to-goal")


def test_a_built_in_task_is_not_listed_and_one_of_ones_own_is() -> None:
    assert own_tasks(["box-to-goal", "dial"]) == {}


@pytest.mark.parametrize(
    ("file", "before", "after"),
    [
        ("push.py", "0.2, (0.0", "0.3, (0.0"),
        ("limits.py", "0.05", "0.06"),
        ("mug.xml", ".02 .03", ".02 .04"),
    ],
)
def test_a_change_of_its_file_of_a_module_beside_it_and_of_its_description_is_noticed(
    lab: Path, file: str, before: str, after: str
) -> None:
    first = known(lab)
    assert "lab-push" in first and known(lab) == first
    text = (lab / file).read_text()
    assert before in text
    (lab / file).write_text(text.replace(before, after))
    written = (lab / file).stat()
    assert known(lab) != first
    (lab / file).write_text(text)
    # Undone at once: within the same second, and the file is as long.
    os.utime(lab / file, ns=(written.st_atime_ns, written.st_mtime_ns))
    assert (lab / file).stat().st_size == written.st_size
    assert known(lab) == first


def test_what_lies_beside_it_and_takes_no_part_is_not_noticed(lab: Path) -> None:
    first = known(lab)
    (lab / "results.csv").write_text("a\n")
    (lab / "another_task.py").write_text("x = 1\n")
    assert known(lab) == first


def test_a_task_that_was_moved_is_the_same(
    lab: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    first = known(lab)
    moved = lab.rename(tmp_path_factory.mktemp("elsewhere") / "lab")
    assert known(moved) == first
