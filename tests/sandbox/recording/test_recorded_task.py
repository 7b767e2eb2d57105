"""A recording knows the files of its own task; whatever plays it again says what has changed."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from models.plugins import files_of, place_of
from models.surface import Surface
from sandbox import replay_recording
from sandbox.cli.main import main
from sandbox.recording.recorded_task import task_change, task_files, task_origin
from sandbox.recording.recording import load_recording
from sandbox.trial.driver import trial_header
from sandbox.trial.settings import Settings
from tasks.registry import find_task
from tests.support.processes import printed, python

SURFACE = Surface()
TASK = """
from pathlib import Path

from limits import FAR
from models import MjcfObject
from tasks import CustomTask, Goal, judge


class Push(CustomTask):
    name = "lab-push"
    time_limit = 1.0

    @classmethod
    def place(cls, rng, surface):
        mug = MjcfObject.on_table("mug", Path(__file__).parent / "mug.xml", 0.2, (0.0, 0.0))
        return [mug], [Goal("mug", (FAR, 0.0, mug.height), 0.0)]

    def measure(self, sensing):
        return judge(0.0, (True, "never"))
"""
MUG = """<mujoco><compiler meshdir="shapes"/><asset><mesh name="m" file="mug.obj"/></asset>
<worldbody><body><geom type="mesh" mesh="m"/><include file="handle.xml"/></body></worldbody>
</mujoco>"""
HANDLE = '<mujocoinclude><geom type="box" size=".01 .01 .01" pos=".02 0 0"/></mujocoinclude>'
SHAPE = """v -.02 -.02 0
v .02 -.02 0
v 0 .02 0
v 0 0 .06
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
"""


@pytest.fixture
def lab(tmp_path: Path) -> Path:
    """A folder with a task, a module beside it, and a description with an include and a mesh."""
    (tmp_path / "push.py").write_text(TASK)
    (tmp_path / "limits.py").write_text("FAR = 0.05\n")
    (tmp_path / "mug.xml").write_text(MUG)
    (tmp_path / "handle.xml").write_text(HANDLE)
    (tmp_path / "shapes").mkdir()
    (tmp_path / "shapes" / "mug.obj").write_text(SHAPE)
    return tmp_path


def fresh(*arguments: object) -> tuple[int, str]:
    """Exit status of a program that has loaded no task yet, and what it said."""
    done = python("-m", "sandbox", *arguments)
    return done.returncode, done.stdout + done.stderr


def known(task: Path) -> str:
    """What a fresh program says of the task: it loads a file once."""
    line = (
        "import sys; from sandbox.recording.recorded_task import own_tasks;"
        "print(own_tasks(sys.argv[1:]))"
    )
    return printed("-c", line, task, "box-to-goal")


def recorded(lab: Path) -> Path:
    """A recording of the lab's task."""
    record = lab / "run.jsonl"
    status, said = fresh("run", lab / "push.py", "--record", record)
    assert status == 0, said
    return record


def change(file: Path, before: str, after: str) -> None:
    text = file.read_text()
    assert before in text
    file.write_text(text.replace(before, after))


def with_header(record: Path, change: Callable[[dict[str, Any]], object]) -> None:
    """Changes the header of a recording."""
    first, rest = record.read_text().split("\n", 1)
    header = json.loads(first)
    change(header)
    record.write_text(f"{json.dumps(header)}\n{rest}")


def the_line(said: str) -> str:
    """The one line of what was said that tells of a change."""
    (line,) = [line for line in said.splitlines() if "has changed since" in line]
    return line


def test_a_header_has_digests_of_all_files_of_its_own_task_and_none_of_a_built_in_one(
    lab: Path,
) -> None:
    header = trial_header(Settings(task=str(lab / "push.py")))
    names = {"push.py", "limits.py", "mug.xml", "handle.xml", "shapes/mug.obj"}
    assert set(header["task_from"]["files"]) == names
    assert "task_from" not in trial_header(Settings(task="box-to-goal"))
    assert all(task_files(name, 0, SURFACE) == {} for name in ("dial", "box-to-goal"))


@pytest.mark.parametrize(
    ("file", "before", "after"),
    [
        ("push.py", "0.2, (0.0", "0.3, (0.0"),
        ("limits.py", "0.05", "0.06"),
        ("shapes/mug.obj", ".06", ".05"),
    ],
)
def test_a_task_is_known_by_its_files_however_short_the_change(
    lab: Path, file: str, before: str, after: str
) -> None:
    first = known(lab / "push.py")
    assert "lab-push" in first and "box-to-goal" not in first
    change(lab / file, before, after)
    written = (lab / file).stat()
    assert known(lab / "push.py") != first
    change(lab / file, after, before)
    # Undone at once: within the same second, and the file is as long.
    os.utime(lab / file, ns=(written.st_atime_ns, written.st_mtime_ns))
    assert (lab / file).stat().st_size == written.st_size
    assert known(lab / "push.py") == first


def test_neither_its_folder_nor_other_files_there_change_a_task(lab: Path) -> None:
    first = known(lab / "push.py")
    (lab / "results.csv").write_text("a\n")
    (lab / "another_task.py").write_text("x = 1\n")
    assert known(lab / "push.py") == first
    moved = lab.parent / f"{lab.name} moved"
    lab.rename(moved)
    assert known(moved / "push.py") == first


def test_a_replay_says_in_one_line_that_its_task_has_changed_and_what_to_put_back(
    lab: Path,
) -> None:
    record = recorded(lab)
    for file, before, after, differs in (
        ("push.py", "0.2, (0.0", "0.3, (0.0", True),
        ("limits.py", "0.05", "0.06", False),
        ("shapes/mug.obj", ".06", ".05", True),
    ):
        change(lab / file, before, after)
        status, said = fresh("replay", record, "--verify")
        line = the_line(said)
        says = f"the task lab-push has changed since it was recorded, in {file}. Put the old {file}"
        assert line.endswith(f"{says} back")
        # States that are equal are verified: what has changed takes no part in them.
        assert ("differs" in line, "exact" in line, status) == (differs, not differs, int(differs))
        change(lab / file, after, before)
    status, said = fresh("replay", record, "--verify")
    assert status == 0 and "exact" in said and "has changed" not in said


def test_a_changed_task_that_can_no_longer_be_played_is_refused_with_the_change_as_the_reason(
    lab: Path,
) -> None:
    record = recorded(lab)
    change(lab / "push.py", "return [mug]", "return 1 / 0, [mug]")
    status, said = fresh("replay", record)
    line = the_line(said)
    assert status == 2 and "Put the old push.py back" in line and "cannot be drawn" in line


def test_a_recording_without_digests_of_its_task_replays_as_before(
    lab: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = recorded(lab)
    with_header(record, lambda header: header["task_from"].pop("files"))
    assert main(["replay", str(record), "--verify"]) == 0
    assert "has changed" not in capsys.readouterr().out
    assert task_change(load_recording(record).header, str(lab / "push.py"), 0, SURFACE) == ""


def test_files_of_a_task_do_not_depend_on_what_else_was_loaded_from_its_folder(lab: Path) -> None:
    """A recording of one of two tasks in a regression would otherwise be told to have changed."""
    (lab / "parts").mkdir()
    (lab / "parts" / "__init__.py").touch()
    (lab / "parts" / "far.py").write_text("from . import near\n")
    (lab / "parts" / "near.py").write_text("NEAR = 0.01\n")
    (lab / "parts" / "other.py").write_text("x = 1\n")
    change(lab / "limits.py", "FAR", "import parts.far\nFAR")
    (lab / "first.py").write_text(
        TASK.replace("lab-push", "lab-first").replace(
            "import FAR", "import FAR\nimport parts.other"
        )
    )
    find_task(str(lab / "first.py"))
    find_task(str(lab / "push.py"))
    own = {"push.py", "limits.py", "parts/__init__.py", "parts/far.py", "parts/near.py"}
    names = {file.relative_to(lab).as_posix() for file in files_of(lab / "push.py")}
    assert names == own
    first = {file.relative_to(lab).as_posix() for file in files_of(lab / "first.py")}
    assert first == own - {"push.py"} | {"first.py", "parts/other.py"}


def test_a_class_that_a_file_imports_from_beside_itself_has_the_files_of_both(lab: Path) -> None:
    (lab / "both.py").write_text("from push import Push\nMade = type('Other', (Push,), {})\n")
    own = {"push.py", "limits.py", "mug.xml", "handle.xml", "shapes/mug.obj"}
    for member in ("Push", "Made"):
        source = task_origin(f"{lab / 'both.py'}:{member}", 0, SURFACE)
        assert set(source["files"]) == own | {"both.py"}
        # By this name it is found again, whatever the class calls itself.
        assert source["member"] == member and find_task(place_of(source)).name == "lab-push"


TWICE = """
from pathlib import Path

from models import MjcfObject
from tasks import CustomTask, Goal, judge


class Push(CustomTask):
    name = "lab-two"

    @classmethod
    def place(cls, rng, surface):
        there = Path(__file__).parent.parent
        things = [
            MjcfObject.on_table(name, there / name / "thing.xml", 0.2, (0.06 * i, 0.0))
            for i, name in enumerate(("a", "b"))
        ]
        return things, [Goal("a", (0.05, 0.05, things[0].height), 0.0)]

    def measure(self, sensing):
        return judge(0.0, (True, "never"))
"""


@pytest.mark.parametrize("changed", ["a", "b"])
def test_of_two_files_with_one_name_elsewhere_either_is_missed(
    changed: str, tmp_path: Path
) -> None:
    for name in ("a", "b", "task"):
        (tmp_path / name).mkdir()
    for name, size in (("a", ".02"), ("b", ".021")):
        (tmp_path / name / "thing.xml").write_text(
            f'<mujoco><worldbody><body><geom size="{size}"/></body></worldbody></mujoco>'
        )
    file = tmp_path / "task" / "two.py"
    file.write_text(TWICE)
    place = f"{file}:Push"
    before = task_files(place, 0, SURFACE)
    thing = tmp_path / changed / "thing.xml"
    thing.write_text(thing.read_text().replace("geom ", 'geom rgba="1 0 0 1" '))
    after = task_files(place, 0, SURFACE)
    assert before.keys() == after.keys() and before["thing.xml"] != after["thing.xml"]


def test_export_runs_and_python_say_that_the_task_of_a_recording_has_changed(
    lab: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record = lab / "run.jsonl"
    assert main(["run", str(lab / "push.py"), "--record", str(record)]) == 0
    with_header(record, lambda header: header["task_from"]["files"].update({"mug.xml": "0"}))
    capsys.readouterr()
    for arguments in (
        ["export", str(record), "--to", str(lab / "hand.bvh"), "--of", "commanded"],
        ["export", str(record), "--to", str(lab / "set.npz")],
        ["run", "--device", str(record)],
    ):
        assert main(arguments) == 0
        said = capsys.readouterr()
        assert "Put the old mug.xml back" in the_line(said.out + said.err)
    with pytest.warns(UserWarning, match="lab-push has changed since"):
        replay_recording(record)


def test_the_change_of_a_package_names_the_package_and_its_recorded_version() -> None:
    place = "tests.support.regress_tasks:Quick"
    source = task_origin(place, 0, SURFACE)
    assert set(source["files"]) == {"tests"}
    assert task_change({"task_from": source}, place, 0, SURFACE) == ""
    older = {**source, "files": {"tests": "0"}}
    assert task_change({"task_from": older}, place, 0, SURFACE).endswith("Put the old tests back")
    released = {**older, "package": "my-lab", "version": "1.2"}
    line = task_change({"task_from": released}, place, 0, SURFACE)
    assert line.endswith("Install it: pip install 'my-lab==1.2'")
