"""Baselines keep what they are given, refuse what does not compare, and judge as they say."""

from __future__ import annotations

import errno
import json
import os
import re
from collections.abc import Collection, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from pathlib import Path
from threading import Thread
from typing import Any
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from markdown_it import MarkdownIt

from encoders.regression.model_registry import find_model
from encoders.regression.training import save_model
from models.errors import InputError
from sandbox.cli.main import main
from sandbox.cli.regress import main as regress
from sandbox.regress.baseline import Baseline, load_baseline, update
from sandbox.regress.execute import Serial
from sandbox.regress.run_plan import RegressionPlan, registered
from sandbox.regress.run_report import Report, junit, make_report, markdown
from sandbox.regression import Regression
from sandbox.system.files import write_whole
from sandbox.trial.result import ResultRecord, record_fields
from tests.support.regress_tasks import Dying, Newer, Quick, Worse

PLAN = RegressionPlan((Quick,), tuple(range(10)))


BOTH = RegressionPlan((Quick, Dying), tuple(range(10)))


def trials(
    plan: RegressionPlan,
    failed: Collection[int] = (),
    state: str = "00",
    machine: str = "here",
    reason: str = "",
) -> list[dict[str, Any]]:
    """What a run would give, were these seeds to fail."""
    return [
        {
            **dict.fromkeys(record_fields(ResultRecord.REGRESS)),
            "task": job.name,
            "task_version": 1,
            "seed": job.seed,
            "success": job.seed not in failed,
            "status": "timeout" if job.seed in failed else "held",
            "progress": 0.5 if job.seed in failed else 1.0,
            "reason": reason,
            "time_s": 0.2,
            "state_hash": state,
            "fingerprint": machine,
            "depends_on": {"mujoco": "4.0.0", "machine": "Linux x86_64", "libm": machine},
        }
        for job in plan.jobs()
    ]


def baseline(plan: RegressionPlan = PLAN, path: Path = Path("base.json"), **made: Any) -> Baseline:
    nothing = Baseline(plan.origin(), {}, path)
    return nothing.updated(plan.origin(), plan.versions(), trials(plan, **made))


def judged(
    failed: Collection[int] = (),
    before: Collection[int] = (),
    exact: bool = False,
    plan: RegressionPlan = PLAN,
    state: str = "00",
    machine: str = "here",
) -> Report:
    run = trials(plan, failed, state, machine)
    return make_report(plan, run, baseline(plan, failed=before), exact)


@settings(deadline=None)
@given(failed=st.sets(st.integers(0, 9)), before=st.sets(st.integers(0, 9)))
def test_every_pair_is_counted_once_where_it_belongs(failed: set[int], before: set[int]) -> None:
    found = judged(failed, before).comparisons["quick"]
    assert set(found.lost) == failed - before
    assert set(found.won) == before - failed
    assert set(found.neither) == failed & before
    assert found.pairs == 10
    assert found.progress == pytest.approx((len(before) - len(failed)) * 0.5 / 10)


def test_the_gate_fails_from_seven_losses_on_and_wins_make_up_for_losses() -> None:
    """Of one task, success and time are tested: 2 / 2**7 is below 0.02."""
    assert judged(range(6)).passed
    assert not judged(range(7)).passed
    assert judged(range(7), before=[7, 8]).passed
    assert judged(before=range(10)).passed


def test_two_tasks_together_need_more_losses_each() -> None:
    """Four lost of each: 6 / 2**8 is above 0.02. Five of each are a loss of both together alone."""
    assert judged(range(4), plan=BOTH).passed
    together = judged(range(5), plan=BOTH)
    assert {reason.partition(":")[0] for reason in together.reasons} == {"all tasks"}
    each = judged(range(9), plan=BOTH)
    assert {reason.partition(":")[0] for reason in each.reasons} == {"quick", "dying", "all tasks"}


def test_other_states_fail_only_where_they_were_asked_for_and_are_owed() -> None:
    assert judged(state="11").passed
    found = judged(state="11", exact=True)
    assert not found.passed and "10 of 10 trials" in found.reasons[0]
    elsewhere = judged(state="11", machine="there", exact=True)
    assert elsewhere.passed
    (note,) = [n for n in elsewhere.notes if "are not compared" in n]
    assert note.endswith("the system's libm (here there, there here)")
    assert elsewhere.as_json()["tasks"]["quick"]["baseline"]["elsewhere"] == [
        "the system's libm (here there, there here)"
    ]
    assert not judged(range(7), machine="there", exact=True).passed


def test_a_run_that_broke_off_is_not_judged() -> None:
    run = trials(PLAN, failed=range(10))[:-1]
    found = make_report(PLAN, run, baseline())
    assert found.passed and not found.complete and "broke off" in found.notes[-1]
    assert found.as_json()["passed"] is None


@settings(deadline=None, max_examples=30)
@given(failed=st.sets(st.integers(0, 9)), machine=st.text(max_size=5))
def test_a_baseline_comes_back_from_its_file_as_it_was(
    tmp_path_factory: pytest.TempPathFactory, failed: set[int], machine: str
) -> None:
    path = tmp_path_factory.mktemp("base") / "base.json"
    made = baseline(BOTH, path, failed=failed, machine=machine)
    made.save()
    found = load_baseline(path)
    assert found.tasks == made.tasks
    assert found.tasks["quick"].depends_on["libm"] == machine
    found.check(BOTH.origin(), BOTH.versions())
    # One line for every trial, for whoever reviews a change of it.
    assert len(re.findall(r'^    "\d+": \[', path.read_text(), re.MULTILINE)) == 20


@pytest.mark.parametrize(
    ("other", "said"),
    [
        (replace(PLAN, scene={"encoder": "linear"}), "another encoder"),
        (replace(PLAN, scene={"correction": False}), "correction False"),
        (replace(PLAN, scene={"fingers": 2}), "fingers 2"),
        (replace(PLAN, scene={"drop_outs": 0.5}), "drop_outs"),
        (RegressionPlan((Newer,), (1,)), "another version of quick"),
        (RegressionPlan((Dying,), (1,)), "none of these tasks"),
    ],
)
def test_what_does_not_compare_is_refused(other: RegressionPlan, said: str) -> None:
    with pytest.raises(InputError, match=said):
        baseline().check(other.origin(), other.versions())


def test_across_encoders_nothing_but_the_encoder_may_differ() -> None:
    linear = replace(PLAN, scene={"encoder": "linear"})
    baseline().check(linear.origin(), PLAN.versions(), across_encoders=True)
    five = replace(PLAN, scene={"encoder": "linear", "fingers": 5})
    with pytest.raises(InputError, match="other settings"):
        baseline().check(five.origin(), PLAN.versions(), across_encoders=True)


def of_another_program(made: Baseline, **program: Any) -> Baseline:
    origin = replace(made.origin, program={**made.origin.program, **program})
    return replace(made, origin=origin)


@pytest.mark.parametrize(
    "program",
    [{"states": 1, "version": "0.1.0"}, {"models": {"encoder": "another", "labels": ""}}],
    ids=["states", "models"],
)
def test_a_baseline_of_another_program_is_compared_without_its_states(
    program: dict[str, Any],
) -> None:
    before = of_another_program(baseline(), **program)
    found = make_report(PLAN, trials(PLAN, failed=range(8), state="11"), before)
    compared = found.comparisons["quick"]
    assert not found.passed and not compared.changed and compared.same_machine == 0
    [note] = found.notes
    assert str(before.origin) in note and str(PLAN.origin()) in note
    with pytest.raises(InputError, match="--exact"):
        make_report(PLAN, trials(PLAN), before, exact=True)


def test_a_newer_version_with_equal_states_and_models_is_compared_to_the_bit() -> None:
    before = of_another_program(baseline(), version="0.1.0", commit="abc1234")
    assert make_report(PLAN, trials(PLAN), before, exact=True).passed
    assert not make_report(PLAN, trials(PLAN, state="11"), before, exact=True).passed


def test_an_update_keeps_other_tasks_of_the_same_configuration_and_no_others() -> None:
    both = baseline(BOTH, failed=[1])
    new = both.updated(PLAN.origin(), PLAN.versions(), trials(PLAN))
    assert new.tasks["dying"] == both.tasks["dying"]
    assert all(k.success for k in new.tasks["quick"].trials.values())
    linear = replace(PLAN, scene={"encoder": "linear"})
    other = both.updated(linear.origin(), PLAN.versions(), trials(PLAN))
    assert set(other.tasks) == {"quick"}


@pytest.mark.parametrize("value", ("other", "equal"))
def test_a_baseline_with_a_seed_twice_is_refused_where_its_trials_differ(
    value: str, tmp_path: Path
) -> None:
    path = tmp_path / "base.json"
    lines = whole_baseline().splitlines()
    at = next(i for i, line in enumerate(lines) if line.strip().startswith('"7":'))
    again = lines[at].replace("0.2", "0.3") if value == "other" else lines[at]
    path.write_text("\n".join([*lines[:at], again, *lines[at:]]))
    if value == "equal":
        assert 7 in load_baseline(path).tasks["quick"].trials
    else:
        with pytest.raises(InputError, match=r"twice, with different values .got '7'"):
            load_baseline(path)


@cache
def whole_baseline() -> str:
    return baseline().text()


@given(reason=st.text(max_size=30))
def test_junit_is_xml_whatever_a_reason_says(reason: str) -> None:
    run = trials(PLAN, failed=range(8), reason=reason)
    suite = ElementTree.fromstring(junit(make_report(PLAN, run, baseline())).encode())[0]
    case = suite.find("testcase")
    assert case.get("name") == "quick" and case.find("failure") is not None
    assert (suite.get("tests"), suite.get("failures")) == ("1", "1")
    assert "seed 5: timeout" in case.find("system-out").text


@pytest.mark.parametrize("lost", range(0, 11))
def test_junit_fails_wherever_the_gate_fails(lost: int) -> None:
    """Five lost of each of two tasks are a loss of both together alone."""
    report = judged(range(lost), plan=BOTH)
    suite = ElementTree.fromstring(junit(report).encode())[0]
    assert (int(suite.get("failures", "0")) > 0) == (not report.passed)


@given(reason=st.text(max_size=30), failed=st.sets(st.integers(0, 9)))
def test_the_summary_is_a_table_that_any_reader_of_markdown_reads(
    reason: str, failed: set[int]
) -> None:
    run = trials(BOTH, failed=failed, reason=reason)
    report = make_report(BOTH, run, baseline(BOTH))
    html = MarkdownIt("commonmark").enable("table").render(markdown(report))
    assert html.count("<table>") == 1 and html.count("<tr>") == 1 + 2 + 1
    assert ("a loss beyond chance" in html) == (not report.passed)
    assert ("Trials that moved most" in html) == (not report.passed)
    assert all(trial.seed in failed for trial in report.moved_most())


def test_the_fixture_asserts_that_nothing_was_lost(tmp_path: Path) -> None:
    """Made, compared with itself, and with what the task became."""
    making = Regression(tmp_path, tmp_path, update=True)
    making(Quick, "0:16", baseline="base.json")
    asking = Regression(tmp_path, tmp_path)
    report = asking(Quick, "0:16", baseline="base.json", exact=True)
    assert report.tasks[0].successes == 10
    with pytest.raises(AssertionError, match="beyond chance") as caught:
        asking(Worse, "0:16", baseline="base.json")
    assert "seed 1: it fails now" in str(caught.value) and "python -c" in str(caught.value)


MINE = """
from tests.support.regress_tasks import Quick


class Mine(Quick):
    name = "mine"
"""


def test_the_fixture_takes_files_from_the_tests_folder_wherever_pytest_is_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, elsewhere, other = (tmp_path / name for name in ("lab", "elsewhere", "other"))
    for each in (folder, elsewhere):
        each.mkdir()
    (folder / "mine.py").write_text(MINE)
    save_model(find_model("linear", print), folder / "ours.npz")
    monkeypatch.chdir(elsewhere)
    Regression(folder, tmp_path, update=True)("mine.py:Mine", "0:3", "ours.npz", "base.json")
    # A baseline does not know where it was made.
    folder.rename(other)
    report = Regression(other, tmp_path)("mine.py:Mine", "0:3", "ours.npz", "base.json", exact=True)
    assert report.tasks[0].name == "mine" and report.comparisons["mine"].pairs == 3
    with pytest.raises(InputError, match=r"none\.py"):
        Regression(other, tmp_path)("none.py:Mine", "0:3")


def test_the_fixture_asks_for_a_rate_only_beyond_chance(tmp_path: Path) -> None:
    asking = Regression(tmp_path, tmp_path)
    asking(Quick, "0:3", at_least=0.9)
    with pytest.raises(AssertionError, match="fewer than 90%"):
        asking(Quick, "0,3,1", at_least=0.9)
    with pytest.raises(InputError, match="no such baseline"):
        asking(Quick, "0:3", baseline="none.json")
    with pytest.raises(InputError, match="no such option"):
        asking(Quick, "0:3", finger=3)


def kept_seeds(path: Path) -> dict[str, list[int]]:
    return {name: list(task.trials) for name, task in load_baseline(path).tasks.items()}


@pytest.mark.parametrize("by_command", [True, False])
def test_a_run_that_ends_while_another_is_played_loses_no_trial_of_a_baseline_of_both(
    by_command: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, play = tmp_path / "base.json", Serial.run

    def meanwhile(*run: Any) -> Iterator[dict[str, Any]]:
        monkeypatch.setattr(Serial, "run", play)
        Regression(tmp_path, tmp_path, update=True)(Dying, "3:6", baseline="base.json")
        yield from play(*run)

    monkeypatch.setattr(Serial, "run", meanwhile)
    if by_command:
        words = ["--seeds", "4:7", "--executor", "serial", "--baseline", str(path)]
        with registered(Quick):
            assert main(["regress", "--tasks", "quick", *words, "--update-baseline"]) == 0
    else:
        Regression(tmp_path, tmp_path, update=True)(Quick, "4:7", baseline="base.json")
    assert kept_seeds(path) == {"dying": [3, 4, 5], "quick": [4, 5, 6]}


def test_runs_that_end_at_once_wait_for_each_other_and_leave_nothing_beside(
    tmp_path: Path,
) -> None:
    path = tmp_path / "base.json"
    kinds: list[Any] = [type(f"Lab{i}", (Quick,), {"name": f"lab-{i}"}) for i in range(6)]

    def end(kind: type[Quick]) -> None:
        plan = RegressionPlan((kind,), (1, 2))
        update(path, PLAN.origin(), plan.versions(), trials(plan))

    with ThreadPoolExecutor(len(kinds)) as pool:
        list(pool.map(end, kinds))
    assert kept_seeds(path).keys() == {kind.name for kind in kinds}
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("text", ['{"thesis": "my data"}', "[1, 2]", "not even JSON", "\x00"])
def test_an_update_leaves_a_file_that_is_no_baseline_as_it_is(
    tmp_path: Path, text: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "base.json"
    path.write_text(text)
    monkeypatch.setattr(Serial, "run", lambda *args: pytest.fail("a trial was played"))
    words = ["--seeds", "1:3", "--executor", "serial", "--baseline", str(path)]
    with registered(Quick):
        assert main(["regress", "--tasks", "quick", *words, "--update-baseline"]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "this file is no baseline" in line
    with pytest.raises(InputError, match="this file is no baseline"):
        Regression(tmp_path, tmp_path, update=True)(Quick, "1:3", baseline="base.json")
    with pytest.raises(InputError, match="this file is no baseline"):
        update(path, PLAN.origin(), PLAN.versions(), trials(PLAN))
    assert path.read_text() == text


@pytest.mark.parametrize("cut", [0, 120, -40])
def test_an_update_replaces_a_baseline_that_is_empty_damaged_or_older(
    tmp_path: Path, cut: int
) -> None:
    path = tmp_path / "base.json"
    for text in (whole_baseline()[:cut], whole_baseline().replace('"schema": 2', '"schema": 1')):
        path.write_text(text)
        update(path, PLAN.origin(), PLAN.versions(), trials(PLAN))
        assert kept_seeds(path) == {"quick": list(range(10))}


def test_what_is_written_to_a_link_arrives_at_its_target(tmp_path: Path) -> None:
    target, link = tmp_path / "real.json", tmp_path / "link.json"
    target.write_text("old")
    link.symlink_to(target)
    write_whole(link, "new", "--json")
    assert link.is_symlink() and target.read_text() == "new"
    assert sorted(tmp_path.iterdir()) == [link, target]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_report_to_a_pipe_arrives_at_its_reader(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.json"
    os.mkfifo(pipe)
    read: list[str] = []
    # On code that replaces the pipe it would wait for ever.
    reader = Thread(target=lambda: read.append(pipe.read_text()), daemon=True)
    reader.start()
    words = ["--tasks", "quick", "--seeds", "1:3", "--executor", "serial"]
    with registered(Quick):
        assert main(["regress", *words, "--json", str(pipe)]) == 0
    assert pipe.is_fifo()
    reader.join()
    assert json.loads(read[0])["complete"]


@pytest.mark.parametrize("option", ["--json", "--junit", "--baseline"])
def test_a_folder_in_which_nothing_can_be_made_is_refused_before_the_first_trial(
    option: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "out"
    path.write_text(whole_baseline())

    def refused(self: Path, *args: Any, **named: Any) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    # Root may write into any folder, so that its mode alone shows nothing.
    monkeypatch.setattr(Path, "touch", refused)
    monkeypatch.setattr(Serial, "run", lambda *args: pytest.fail("a trial was played"))
    words = ["--tasks", "quick", "--seeds", "1:3", option, str(path)]
    words += ["--update-baseline"] if option == "--baseline" else []
    with registered(Quick), pytest.raises(InputError, match=rf"{option}.*Permission denied"):
        regress(words)
