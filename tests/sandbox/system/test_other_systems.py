"""Studies and regression runs need no module that only one operating system has."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from sandbox.system import files as durable_files
from sandbox.system.files import lock
from tests.support.processes import printed
from tests.support.study_files import DESIGN, in_child, killed_after

ROOT = Path(__file__).resolve().parents[3]
MISSING = ("fcntl", "resource", "termios", "pwd", "grp")

WORK = """
import os, sys
for name in {missing!r}:
    sys.modules[name] = None
for name in ("fdatasync", "pread", "pwrite", "O_CLOEXEC"):
    vars(os).pop(name, None)
from sandbox.cli.main import main
status = main(["study", "simulate", "design.toml", "--out", "out", "--participants", "1"])
status += main(["replay", "out/quick-simulated", "--verify"])
status += main(["regress", "--tasks", "{task}", "--encoder", "linear", "--seeds", "1:3",
                "--executor", "serial", "--json", "report.json"])
status += main(["run", "box-to-goal", "--encoder", "linear", "--record", "r.jsonl"])
sys.exit(status)
"""


def test_a_study_and_a_regression_run_are_played_without_them(tmp_path: Path) -> None:
    task = (ROOT / "tests/support/regress_tasks.py:Quick").as_posix()
    text = DESIGN.replace("tests/support/regress_tasks.py:Quick", task)
    (tmp_path / "design.toml").write_text(text)
    work = WORK.format(missing=MISSING, task=task)
    assert "all is as it was written" in printed("-c", work, cwd=tmp_path)


@pytest.mark.parametrize("has_fcntl", [True, False])
def test_a_lock_holds_until_it_is_ended_or_its_program_is_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, has_fcntl: bool
) -> None:
    if not has_fcntl:
        monkeypatch.setattr(durable_files, "_FCNTL", None)
    path = tmp_path / "file"
    path.touch()

    def taken() -> bool:
        fd = os.open(path, os.O_RDWR)
        release = lock(fd, path, wait=False)
        if release is not None:
            release()
        os.close(fd)
        return release is None

    def hold(say: object) -> None:
        held = os.open(path, os.O_RDWR)
        assert lock(held, path, wait=True) is not None
        (tmp_path / "held").touch()
        while True:
            pass

    assert not taken()
    fd = os.open(path, os.O_RDWR)
    release = lock(fd, path, wait=False)
    assert release is not None and taken()
    release()
    os.close(fd)
    assert not taken()
    seen = []

    def is_held() -> bool:
        if (tmp_path / "held").exists():
            seen.append(taken())
        return bool(seen)

    killed, _ = killed_after(in_child(hold), 60.0, is_held)
    assert killed and seen == [True] and not taken()
