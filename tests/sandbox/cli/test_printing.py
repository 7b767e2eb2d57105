"""Results, reports and exit status do not depend on who reads the output or on the disk."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from models.errors import InputError
from sandbox.cli.common.json_out import check_output, refuse_same
from sandbox.cli.main import main

COMMAND = [sys.executable, "-m", "sandbox"]
REGRESS = [*COMMAND, "regress", "--tasks", "box-to-goal", "--seeds", "0:1", "--json", "r.json"]
FULL = Path("/dev/full")


def run(*command: str, **options: Any) -> subprocess.CompletedProcess[str]:
    """Runs a command; its output is what the test says, and its errors are read."""
    options = {"stdout": subprocess.PIPE} | options
    return subprocess.run(command, stderr=subprocess.PIPE, text=True, check=False, **options)


def test_a_full_disk_behind_the_output_costs_no_report(tmp_path: Path) -> None:
    if not FULL.exists():
        pytest.skip("this system has no /dev/full")
    with FULL.open("wb") as full:
        done = run(*REGRESS, cwd=tmp_path, stdout=full)
    assert done.returncode == 0
    assert "standard output: No space left on device" in done.stderr
    assert "Traceback" not in done.stderr
    assert json.loads((tmp_path / "r.json").read_text())["passed"] is True


def test_a_reader_that_leaves_changes_neither_the_report_nor_the_exit_status(
    tmp_path: Path,
) -> None:
    read, write = os.pipe()
    os.close(read)
    done = run(*REGRESS, cwd=tmp_path, stdout=write)
    os.close(write)
    assert (done.returncode, "Traceback" in done.stderr) == (0, False)
    assert json.loads((tmp_path / "r.json").read_text())["passed"] is True


@pytest.mark.parametrize("words", [["--version"], ["run", "--help"], ["--help"]])
def test_help_on_a_full_disk_is_one_line(words: list[str]) -> None:
    if not FULL.exists():
        pytest.skip("this system has no /dev/full")
    with FULL.open("wb") as full:
        done = run(*COMMAND, *words, stdout=full)
    assert done.returncode == 1
    assert done.stderr == "sandbox: standard output: No space left on device\n"


@pytest.mark.parametrize(
    "words",
    [
        ["run", "box-to-goal", "--json", "loop"],
        ["run", "box-to-goal", "--record", "loop"],
        ["regress", "--tasks", "box-to-goal", "--seeds", "0:1", "--baseline", "loop"],
        ["export", "run.jsonl", "--to", "loop/x.bvh"],
    ],
)
def test_links_in_a_circle_are_one_line(tmp_path: Path, words: list[str]) -> None:
    (tmp_path / "loop").symlink_to("loop")
    (tmp_path / "run.jsonl").write_text("")
    done = run(*COMMAND, *words, cwd=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr and len(done.stderr.splitlines()) == 1


HALF = '''
from models import Box
from tasks import CustomTask, Goal, judge


class Odd(CustomTask):
    """A box that is never there."""

    name = "half-emoji"
    time_limit = 0.6

    @classmethod
    def place(cls, rng, surface):
        goal = Goal("b", (0.05, 0.0, 0.02), 0.0)
        return [Box("b", (0.02, 0.02, 0.02), 0.1, (0.0, 0.0, 0.02))], [goal]

    def measure(self, sensing):
        return judge(0.0, (True, "half of a sign: \\ud83d"))
'''


@pytest.mark.parametrize("encoding", ("utf-8", "ascii", "latin-1"))
def test_text_that_no_encoding_has_costs_no_report(encoding: str, tmp_path: Path) -> None:
    (tmp_path / "task.py").write_text(HALF)
    words = ["--tasks", "task.py", "--seeds", "0:2", "--json", "r.json", "--junit", "j.xml"]
    command = [*COMMAND, "regress", *words, "--executor", "serial"]
    done = run(*command, cwd=tmp_path, env={**os.environ, "PYTHONIOENCODING": encoding})
    assert done.returncode == 0 and "Traceback" not in done.stderr
    assert "half of a sign: \\ud83d" in done.stdout
    trials = json.loads((tmp_path / "r.json").read_text())["trials"]
    assert [trial["reason"] for trial in trials] == ["half of a sign: \ud83d"] * 2
    assert ElementTree.parse(tmp_path / "j.xml").find(".//testcase") is not None


def test_trying_a_file_leaves_files_and_links_as_they_were(tmp_path: Path) -> None:
    new, old, link = tmp_path / "new.json", tmp_path / "old.json", tmp_path / "link.json"
    old.write_text("kept")
    link.symlink_to(tmp_path / "later.json")
    for path in (new, old, link, Path("-"), None):
        check_output(path)
    assert not new.exists() and old.read_text() == "kept"
    assert link.is_symlink() and not link.exists()
    assert sorted(tmp_path.iterdir()) == [link, old]


@pytest.mark.parametrize("name", ["none/out.json", "", "x" * 300])
def test_what_cannot_be_written_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match="--json"):
        check_output(tmp_path / name)


def test_two_results_in_one_file_are_refused(tmp_path: Path) -> None:
    one, link = tmp_path / "one.json", tmp_path / "link.json"
    link.symlink_to(one)
    refuse_same({"--json": one, "--record": None, "--film": Path("-"), "--events": Path("-")})
    for other in (one, link, tmp_path / "x" / ".." / "one.json"):
        with pytest.raises(InputError, match=r"--record .*two results would be in one file"):
            refuse_same({"--json": one, "--record": other})


@pytest.mark.parametrize(
    "command",
    [
        "run box-to-goal --record one.jsonl --json one.jsonl",
        "run box-to-goal --film one.webp --motion one.webp",
        "regress --tasks box-to-goal --baseline kept.json --json kept.json",
        "evaluate --paalm . --json kept.json",
        "devices leap simulate --capture kept.json --out kept.json",
        "paalm calibrate kept.json --hands right --out kept.json",
        "devices robot fit kept.json --tips a,b,c --out kept.json",
    ],
)
def test_no_command_replaces_what_it_reads_or_another_of_its_results(
    command: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("kept.json").write_text("{}")
    assert main(command.split()) == 2
    assert "in one file" in (said := capsys.readouterr().err) or "would replace" in said
    assert Path("kept.json").read_text() == "{}" and not Path("one.jsonl").exists()
