"""Trials of a regression in several processes, and regressions in a process of their own."""

from __future__ import annotations

import json
import multiprocessing
import os
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from sandbox.regress.baseline import load_baseline
from sandbox.regress.execute import CRASHED, Processes, Serial, run_job
from sandbox.regress.run_plan import RegressionPlan
from tests.support.processes import PATIENCE, ROOT, printed, python, until
from tests.support.regress_tasks import Dying, Quick


def by_seed(trials: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    return sorted(trials, key=lambda t: t["seed"])


def test_trials_in_processes_are_those_in_series_to_the_bit() -> None:
    jobs = RegressionPlan((Quick,), (3, 4, 5, 6)).jobs()
    one, two = list(Serial().run(jobs)), by_seed(Processes(2).run(jobs))
    assert one == two
    assert len({t["state_hash"] for t in one}) == 4
    assert [t["success"] for t in one] == [False, True, True, False]


def test_a_worker_that_dies_is_reported_with_its_seed_and_the_others_are_run() -> None:
    trials = by_seed(Processes(2).run(RegressionPlan((Dying,), tuple(range(6))).jobs()))
    assert [t["seed"] for t in trials] == list(range(6))
    assert [t["status"] == CRASHED for t in trials] == [False, True, True, False, False, False]
    assert "SIGKILL" in trials[1]["reason"] and "status 7" in trials[2]["reason"]
    assert not any(t["success"] for t in trials[1:4]) and trials[4]["success"]


def test_whoever_stops_asking_leaves_no_process_behind() -> None:
    before = set(multiprocessing.active_children())
    trials: Any = Processes(2).run(RegressionPlan((Quick,), tuple(range(50))).jobs())
    next(trials)
    assert len(set(multiprocessing.active_children()) - before) == 2
    trials.close()
    assert set(multiprocessing.active_children()) <= before


def test_ctrl_c_in_a_terminal_keeps_what_is_done(tmp_path: Path) -> None:
    """All processes of a terminal get the signal, workers too; and they leave it to the first."""
    path, record = tmp_path / "out.json", tmp_path / "failed"
    line = f"regress --tasks box-to-goal --arm plain --seeds 0:500 --workers 1 --json {path}"
    started = subprocess.Popen(
        [sys.executable, "-m", "sandbox.cli.main", *line.split(), "--record", str(record)],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        # Its recording begins when a trial does.
        until((record / "box-to-goal-2.jsonl").exists)
        os.killpg(started.pid, signal.SIGINT)
        shown, errors = started.communicate(timeout=PATIENCE)
    finally:
        started.kill()
        started.wait()
    assert started.returncode == 130
    assert "Traceback" not in errors and "stopped after 2 of 500" in errors
    assert "box-to-goal" in shown
    assert [t["seed"] for t in json.loads(path.read_text())["trials"]] == [0, 1]


def test_the_line_of_a_task_of_ones_own_runs_in_python() -> None:
    run = RegressionPlan((Quick,), (4,), {"fingers": 2})
    _, *words = shlex.split(run.command("quick", 4))
    assert run_job(run.jobs()[0])["state_hash"] in printed(*words)


def failures(folder: Path, *more: str) -> str:
    """Runs a folder's tests as a lab would; what pytest prints if not all of them pass."""
    ran = python("-m", "pytest", "-q", "-p", "sandbox.regression", *more, ".", cwd=folder)
    return ran.stdout + ran.stderr if ran.returncode else ""


PLUGIN_TEST = """
pytest_plugins = ["sandbox.regression"]
from tests.support.regress_tasks import Quick
def test_ours(regression):
    regression(Quick, "1:3", baseline="base.json")
"""


def test_the_plugin_makes_a_baseline_and_then_compares_in_processes(tmp_path: Path) -> None:
    (tmp_path / "test_ours.py").write_text(PLUGIN_TEST)
    for more in (["--sandbox-update-baseline"], ["--sandbox-workers", "2"]):
        assert not failures(tmp_path, *more)
        assert load_baseline(tmp_path / "base.json").tasks["quick"].trials.keys() == {1, 2}


def test_a_test_that_fails_shows_its_own_line_and_none_of_the_plugin(tmp_path: Path) -> None:
    (tmp_path / "test_ours.py").write_text(
        PLUGIN_TEST
        + """
def test_idle(regression):
    regression(Quick, "1:7", at_least=1.0, user="idle")
"""
    )
    shown = failures(tmp_path)
    assert "2 failed" in shown
    assert "no such baseline" in shown and "significantly fewer than 100%" in shown
    assert "sandbox/regress" not in shown


@pytest.mark.full
def test_the_example_for_a_lab_makes_its_baseline_and_passes_it(tmp_path: Path) -> None:
    source = (ROOT / "examples" / "test_my_lab.py").read_text()
    (tmp_path / "test_my_lab.py").write_text(source)
    assert not failures(tmp_path, "--sandbox-update-baseline")
    assert load_baseline(tmp_path / "put-away.json").tasks["my-lab-put-away"].trials.keys() == {
        *range(8)
    }
    assert not failures(tmp_path)
