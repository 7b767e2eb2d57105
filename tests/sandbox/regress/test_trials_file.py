"""The trials of a run are in a file from which it goes on, whole, and never from another run's."""

from __future__ import annotations

import json
import resource
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import pytest

from models.errors import InputError
from sandbox.cli.main import main
from sandbox.recording.versions import versions
from sandbox.regress import trials_file
from sandbox.regress.execute import Serial, crashed
from sandbox.regress.run_plan import RegressionPlan, registered
from sandbox.regress.trials_file import TrialsFile, identity, trials_path
from tests.support.regress_tasks import Newer, Quick, StoppingOnce

PLAN = RegressionPlan((Quick,), (0, 1, 2))


@pytest.fixture(scope="module")
def run() -> dict[str, Any]:
    return identity(PLAN)


@pytest.fixture(scope="module")
def trials() -> list[dict[str, Any]]:
    return list(Serial().run(PLAN.jobs()))


def stopping() -> AbstractContextManager[None]:
    StoppingOnce.interrupts = 0
    return registered(StoppingOnce)


def regress(*words: str | Path) -> int:
    return main(["regress", "--seeds", "0:4", "--executor", "serial", *map(str, words)])


def table(path: Path) -> dict[str, Any]:
    report = json.loads(path.read_text())
    del report["wall_s"]
    return report


def seeds(path: Path) -> list[int]:
    """Seeds of the trials that a file has, in its order."""
    lines = [json.loads(line) for line in trials_path(path).read_text().splitlines()]
    return [line["trial"]["seed"] for line in lines if "trial" in line]


def refused(capsys: pytest.CaptureFixture[str], *words: str | Path) -> str:
    assert regress(*words) == 2
    shown = capsys.readouterr()
    assert shown.err.startswith("sandbox: ") and shown.err.count("\n") == 1
    return shown.err


def test_a_file_that_is_cut_anywhere_has_all_trials_before_the_cut_and_takes_more(
    run: dict[str, Any], trials: list[dict[str, Any]], tmp_path: Path
) -> None:
    path = tmp_path / "whole.trials.jsonl"
    with TrialsFile(path, run) as file:
        for trial in trials:
            file.append(PLAN, trial)
    data = path.read_bytes()
    ends = [i + 1 for i, byte in enumerate(data) if byte == ord("\n")]
    assert len(ends) == 4
    near = {end + by for end in ends for by in (-1, 0, 1)}
    for cut in sorted(near | set(range(0, len(data), 37))):
        path.write_bytes(data[:cut])
        there = sum(end <= cut for end in ends[1:])
        with TrialsFile(path, run, resume=True) as file:
            assert file.ended(PLAN) == trials[:there]
            for trial in trials[there:]:
                file.append(PLAN, trial)
        assert path.read_bytes() == data


def test_a_file_that_is_damaged_elsewhere_is_refused_and_stays_as_it_is(
    run: dict[str, Any], trials: list[dict[str, Any]], tmp_path: Path
) -> None:
    path = tmp_path / "out.trials.jsonl"
    with TrialsFile(path, run) as file:
        for trial in trials:
            file.append(PLAN, trial)
    head, first, *rest = path.read_bytes().splitlines(keepends=True)
    for bad in (b"{\n", b"\n", b'{"varied": ""}\n', first.replace(b'"seed": 0', b'"seed": "a"')):
        path.write_bytes(head + bad + b"".join(rest))
        before = path.read_bytes()
        with pytest.raises(InputError, match=r"line 2.*Start again without"):
            TrialsFile(path, run, resume=True)
        assert path.read_bytes() == before
    path.write_bytes(b'{"kind": "something else", "schema": 1}\n')
    with pytest.raises(InputError, match="not the trials of a run"):
        TrialsFile(path, run, resume=True)


def test_a_result_stays_and_a_crash_gives_way_to_a_result(
    run: dict[str, Any], trials: list[dict[str, Any]], tmp_path: Path
) -> None:
    path = tmp_path / "out.trials.jsonl"
    crash = crashed(PLAN.jobs()[1], "killed")
    with TrialsFile(path, run) as file:
        for trial in (trials[0], crash):
            file.append(PLAN, trial)
        assert file.has_crashes
    with TrialsFile(path, run, resume=True) as file:
        assert file.ended(PLAN) == trials[:1] and file.crashed_before == [crash]
        file.append(PLAN, trials[1])
        assert not file.has_crashes
    with TrialsFile(path, run, resume=True) as file:
        assert file.ended(PLAN) == trials[:2] and not file.crashed_before


def test_only_one_run_at_a_time_writes_a_file(run: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "out.trials.jsonl"
    with TrialsFile(path, run):
        for resume in (True, False):
            with pytest.raises(InputError, match="another run"):
                TrialsFile(path, run, resume)
    TrialsFile(path, run, resume=True).close()


def test_trials_of_an_unfinished_run_are_set_aside_and_those_of_a_finished_one_replaced(
    run: dict[str, Any], trials: list[dict[str, Any]], tmp_path: Path
) -> None:
    path = tmp_path / "out.trials.jsonl"
    for number in (1, 2):
        with TrialsFile(path, run) as file:
            file.append(PLAN, trials[0])
        before = path.read_bytes()
        with TrialsFile(path, run) as file:
            assert file.set_aside == tmp_path / f"out.unfinished-{number}.trials.jsonl"
            assert file.set_aside.read_bytes() == before and file.trials == {}
            file.finish()
    with TrialsFile(path, run) as file:
        assert file.set_aside is None and file.trials == {}


def test_a_disk_that_is_full_costs_one_clear_error_and_no_trial(
    run: dict[str, Any], trials: list[dict[str, Any]], tmp_path: Path
) -> None:
    path = tmp_path / "out.trials.jsonl"
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    with TrialsFile(path, run) as file:
        file.append(PLAN, trials[0])
        before = path.read_bytes()
        resource.setrlimit(resource.RLIMIT_FSIZE, (len(before) + 50, hard))
        try:
            with pytest.raises(
                InputError, match=r"out\.trials\.jsonl: the file of trials cannot be"
            ):
                file.append(PLAN, trials[1])
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert path.read_bytes() == before
    with TrialsFile(path, run, resume=True) as file:
        assert file.ended(PLAN) == trials[:1]


def test_a_device_is_no_file_of_trials(run: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "out.trials.jsonl"
    path.symlink_to("/dev/full")
    with pytest.raises(InputError, match="not a plain file"):
        TrialsFile(path, run)


def test_a_stopped_run_that_is_resumed_gives_the_report_of_one_that_was_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole, out = tmp_path / "whole.json", tmp_path / "out.json"
    words = ("--tasks", "stopping")
    with registered(Quick):
        assert regress("--tasks", "quick", "--json", whole) == 0
    with stopping():
        base = tmp_path / "base.json"
        more = ("--baseline", base, "--update-baseline")
        assert regress(*words, "--json", out, *more) == 130
        assert seeds(out) == [0, 1] and table(out)["complete"] is False
        assert table(out)["passed"] is None and not base.exists()
        capsys.readouterr()
        assert regress(*words, "--json", out, "--resume") == 0
    assert "2 trials of the earlier run" in capsys.readouterr().out
    assert seeds(out) == [0, 1, 2, 3]
    assert json.dumps(table(out)).replace("stopping", "quick") == json.dumps(table(whole))


def test_a_finished_run_that_is_resumed_runs_nothing_and_gives_the_same_report(
    tmp_path: Path,
) -> None:
    out = tmp_path / "out.json"
    with registered(Quick):
        assert regress("--tasks", "quick", "--json", out) == 0
        before = table(out)
        assert regress("--tasks", "quick", "--json", out, "--resume") == 0
    assert table(out) == before and seeds(out) == [0, 1, 2, 3]


def test_another_processor_or_library_that_no_state_depends_on_may_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out.json"
    with stopping():
        assert regress("--tasks", "stopping", "--json", out) == 130
        elsewhere = {**versions(), "processor": "another", "numpy": "1.0", "python": "3.14"}
        monkeypatch.setattr(trials_file, "versions", lambda: elsewhere)
        assert regress("--tasks", "stopping", "--json", out, "--resume") in (0, 130)


def test_trials_of_another_run_are_refused_in_one_line_and_stay(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out.json"
    with stopping():
        assert regress("--tasks", "stopping", "--json", out) == 130
        capsys.readouterr()
        before = trials_path(out).read_bytes()
        words = ("--tasks", "stopping", "--json", out, "--resume")
        for more, said in (
            (("--seeds", "0:5"), "seeds 0:4"),
            (("--fingers", "4"), "user.fingers 3"),
            (("--encoder", "cubic"), "digests.encoder"),
            (("--impulse", "safe"), "settings.physics.impulse"),
            (("--vary", "mass=2"), "vary"),
        ):
            error = refused(capsys, *words, *more)
            assert said in error and "from another run" in error and "--resume" in error
        other_libm = {**versions(), "libm": "glibc 2.0, 0"}
        for name, value in (("versions", other_libm), ("source_digest", "0")):
            with monkeypatch.context() as changed:
                changed.setattr(trials_file, name, lambda *_, value=value: value)
                assert "from another run" in refused(capsys, *words)
    with registered(Newer):
        assert "from another run" in refused(capsys, "--tasks", "quick", "--json", out, "--resume")
    assert trials_path(out).read_bytes() == before
    assert "--json FILE" in refused(capsys, "--tasks", "box-to-goal", "--resume")
    assert "--json FILE" in refused(capsys, "--tasks", "box-to-goal", "--json", "-", "--resume")


def test_a_resumed_run_keeps_recordings_and_makes_those_that_a_kill_cut(tmp_path: Path) -> None:
    out, folder = tmp_path / "out.json", tmp_path / "failed"
    words = ("--tasks", "stopping", "--json", out, "--record", folder)
    with stopping():
        assert regress(*words) == 130
        (folder / "stopping-3.jsonl").write_text("cut")
        assert regress(*words, "--resume") == 0
        assert sorted(p.name for p in folder.iterdir()) == ["stopping-0.jsonl", "stopping-3.jsonl"]
        assert main(["replay", str(folder / "stopping-3.jsonl")]) == 0


def test_a_varied_run_is_resumed_too(tmp_path: Path) -> None:
    whole, out = tmp_path / "whole.json", tmp_path / "out.json"
    vary = ("--vary", "mass=2")
    with registered(Quick):
        assert regress("--tasks", "quick", *vary, "--json", whole) == 0
    with stopping():
        words = ("--tasks", "stopping", *vary, "--json", out)
        assert regress(*words) == 130
        assert json.loads(out.read_text())["not_finished"][0]["ended"] == 2
        assert regress(*words, "--resume") == 0
    assert seeds(out) == [0, 1, 2, 3] * 2
    assert json.dumps(table(out)).replace("stopping", "quick") == json.dumps(table(whole))
