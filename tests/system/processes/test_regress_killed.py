"""A run that is killed in any way loses no trial that has ended, and can be resumed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from sandbox.cli.main import main
from tests.support.processes import PATIENCE, ROOT, until
from tests.support.regress_tasks import HELD

HAS_RAY = find_spec("ray") is not None
WORDS = ["--tasks", "tests.support.regress_tasks:Held", "--seeds", "0:8"]
EXECUTORS = ["processes", *(["ray"] if HAS_RAY else [])]


def table(folder: Path) -> dict[str, Any]:
    """The report besides how it was run."""
    report = json.loads((folder / "out.json").read_text())
    return {k: v for k, v in report.items() if k not in ("executor", "workers", "wall_s")}


def lines(folder: Path) -> list[str]:
    path = folder / "out.trials.jsonl"
    return path.read_text().splitlines() if path.exists() else []


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp("uninterrupted")
    out = folder / "out.json"
    assert main(["regress", *WORDS, "--executor", "serial", "--json", str(out)]) == 0
    return table(folder)


class Run:
    """A run with two workers, held after four of eight trials; see `Held`."""

    def __init__(self, folder: Path, executor: str, *more: str) -> None:
        self.folder, self.executor, self.more = folder, executor, more
        self.hold = folder / "hold"
        self.hold.touch()
        self.started = self._start(HELD, str(folder))
        # Two trials run, and those before them are written.
        until(lambda: len(lines(folder)) == 5 and len(self.workers()) == 2)

    def workers(self) -> list[int]:
        """Processes that run trials 4 and 5."""
        texts = [path.read_text() for path in sorted(self.folder.glob("*.pid"))]
        return [int(text) for text in texts if text]

    def end(self) -> tuple[int, str, str]:
        """Exit status, output and errors."""
        shown, errors = self.started.communicate(timeout=PATIENCE)
        return self.started.returncode, shown, errors

    def resumed(self, *more: str) -> tuple[int, str, str]:
        """The same of the same command with --resume."""
        self.hold.unlink(missing_ok=True)
        self.started = self._start("", "", "--resume", *more)
        return self.end()

    def _start(self, name: str, value: str, *more: str) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", "sandbox.cli.main", "regress", *WORDS, "--workers", "2"]
        out = ["--json", f"{self.folder}/out.json", "--junit", f"{self.folder}/out.xml"]
        return subprocess.Popen(
            [*command, "--executor", self.executor, *self.more, *out, *more],
            cwd=ROOT,
            env={**os.environ, "PYTHONPATH": str(ROOT), **({name: value} if name else {})},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )


@pytest.fixture(params=EXECUTORS)
def run(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Run]:
    run = Run(tmp_path, request.param)
    yield run
    run.hold.unlink(missing_ok=True)
    if run.started.poll() is None:
        run.started.kill()
        run.started.communicate()


@pytest.mark.slow
def test_a_killed_worker_fails_the_run_and_its_trial_is_run_when_it_is_resumed(
    run: Run, uninterrupted: dict[str, Any]
) -> None:
    os.kill(run.workers()[0], signal.SIGKILL)
    until(lambda: len(lines(run.folder)) == 6)
    run.hold.unlink()
    status, shown, _ = run.end()
    assert status == 1
    found = table(run.folder)
    assert [t["seed"] for t in found["trials"]] == list(range(8))
    assert found["crashes"]["count"] == 1 and not found["passed"] and found["complete"]
    crash = found["crashes"]["trials"][0]
    assert f"crashed held seed {crash['seed']}: {crash['reason']}" in shown.splitlines()
    suite = ElementTree.parse(run.folder / "out.xml").getroot()[0]
    assert suite.get("errors") == "1" and len(suite.findall("testcase/error")) == 1
    before = lines(run.folder)
    status, shown, errors = run.resumed()
    assert status == 0, errors
    assert "7 trials of the earlier run" in shown and "1 crashed trial will" in shown
    assert table(run.folder) == uninterrupted
    assert lines(run.folder)[: len(before)] == before and len(lines(run.folder)) == len(before) + 2


@pytest.mark.slow
@pytest.mark.parametrize("kill", [os.kill, os.killpg])
def test_sigterm_keeps_what_is_done_and_the_rest_is_run_when_it_is_resumed(
    run: Run, uninterrupted: dict[str, Any], kill: Callable[[int, int], None]
) -> None:
    """Some schedulers send it to all processes; Ray's own ones must not end by it."""
    kill(run.started.pid, signal.SIGTERM)
    status, _, errors = run.end()
    assert status == 143
    assert "Traceback" not in errors and "stopped after 4 of 8 trials by SIGTERM" in errors
    assert "--resume runs the rest" in errors
    found = table(run.folder)
    assert [t["seed"] for t in found["trials"]] == [0, 1, 2, 3]
    assert found["complete"] is False and found["passed"] is None
    assert (run.folder / "out.xml").exists()
    status, shown, errors = run.resumed()
    assert status == 0, errors
    assert "4 trials of the earlier run" in shown
    assert table(run.folder) == uninterrupted


def test_a_run_whose_main_process_is_killed_is_resumed_with_every_seed_once(
    run: Run, uninterrupted: dict[str, Any]
) -> None:
    workers = run.workers()
    run.started.kill()
    run.started.wait()
    assert not (run.folder / "out.json").exists() and len(lines(run.folder)) == 5
    run.hold.unlink()
    # Nobody waits for them, and they leave without a word.
    until(lambda: not any(map(alive, workers)))
    _, _, errors = run.end()
    assert "Traceback" not in errors
    before = lines(run.folder)
    status, _, errors = run.resumed()
    assert status == 0, errors
    assert table(run.folder) == uninterrupted
    kept = [json.loads(line) for line in lines(run.folder)]
    assert sorted(k["trial"]["seed"] for k in kept if "trial" in k) == list(range(8))
    assert lines(run.folder)[:5] == before


@pytest.mark.slow
def test_two_runs_never_write_the_same_file_of_trials(run: Run) -> None:
    before = lines(run.folder)
    other = Run.__new__(Run)
    other.folder, other.executor, other.more = run.folder, "serial", ()
    other.started = other._start("", "", "--resume")
    status, _, errors = other.end()
    assert status == 2 and "another run writes its trials here" in errors
    assert errors.count("\n") == 1 and lines(run.folder) == before


if HAS_RAY:

    def test_trials_of_a_lost_node_crash_and_are_run_when_it_is_resumed(
        tmp_path: Path, uninterrupted: dict[str, Any]
    ) -> None:
        from ray.cluster_utils import Cluster

        os.environ[HELD] = str(tmp_path)
        cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
        try:
            node = cluster.add_node(num_cpus=1)
            run = Run(tmp_path, "ray", "--address", cluster.address)
            try:
                cluster.remove_node(node, allow_graceful=False)
                until(lambda: len(lines(tmp_path)) == 6)
                run.hold.unlink()
                assert run.end()[0] == 1
                assert table(tmp_path)["crashes"]["count"] == 1
                status, _, errors = run.resumed()
                assert status == 0, errors
                assert table(tmp_path) == uninterrupted
            finally:
                run.started.kill()
                run.started.communicate()
        finally:
            del os.environ[HELD]
            cluster.shutdown()
