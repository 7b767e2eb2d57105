"""Trials are the same wherever they run, none gets lost, and only a loss beyond chance fails."""

from __future__ import annotations

import json
import re
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.regression.model_registry import DEFAULT_MODEL
from models.errors import InputError
from sandbox.cli.common.command_line import parse
from sandbox.cli.main import main
from sandbox.cli.regress import RegressOptions
from sandbox.recording.recording import load_recording
from sandbox.recording.versions import DECISIVE
from sandbox.regress.baseline import load_baseline
from sandbox.regress.execute import Executor, Processes, Serial, run_job
from sandbox.regress.run_plan import RegressionPlan, TrialJob, options, parse_seeds, registered
from sandbox.trial.driver import play_trial
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.processes import ROOT
from tests.support.regress_tasks import Quick, Worse


def regress(*words: str | Path) -> int:
    return main(["regress", *map(str, words)])


def refused(capsys: pytest.CaptureFixture[str], *words: str | Path) -> str:
    """The one line with which the command is refused."""
    assert regress(*words) == 2
    shown = capsys.readouterr()
    assert shown.err.startswith("sandbox: ") and shown.err.count("\n") == 1
    assert shown.out == ""
    return shown.err


@pytest.fixture(scope="module")
def quick(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A baseline of twelve quick trials, eight of which succeed."""
    path = tmp_path_factory.mktemp("baseline") / "base.json"
    with registered(Quick):
        assert quick_run("--baseline", path, "--update-baseline") == 0
    return path


def quick_run(*words: str | Path, seeds: str = "0:12") -> int:
    return regress("--tasks", "quick", "--seeds", seeds, "--executor", "serial", *words)


def test_a_trial_is_that_of_the_run_command_to_the_bit() -> None:
    chosen = trial_settings(TrialOptions(task="box-to-goal", seed=4, fingers=5))
    alone = play_trial(chosen)
    trial = run_job(TrialJob(chosen))
    fingerprint, parts = trial.pop("fingerprint"), trial.pop("depends_on")
    assert trial.pop("measures")
    assert trial == {name: alone.as_json()[name] for name in trial}
    assert fingerprint == alone.fingerprint
    assert parts.keys() == DECISIVE.keys() and all(parts.values())


@pytest.mark.parametrize("executor", [Serial(), Processes(2)])
def test_what_cannot_be_run_at_all_ends_the_run(executor: Executor) -> None:
    jobs = RegressionPlan((Quick,), (1, 2), {"encoder": "no-such-encoder"}).jobs()
    with pytest.raises(InputError, match="no such encoder"):
        list(executor.run(jobs))


def test_the_json_has_every_task_and_every_trial(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "out.json"
    with registered(Quick):
        assert quick_run("--json", path) == 0
    found = json.loads(path.read_text())
    task = found["tasks"]["quick"]
    assert (task["n"], task["successes"]) == (12, 8)
    assert task["wilson_low"] < 8 / 12 < task["wilson_high"]
    assert task["progress"] == pytest.approx((8 * 1 + 4 * 0.25) / 12)
    assert task["time_s"] == 0.128
    assert [t["seed"] for t in found["trials"]] == list(range(12))
    assert [f["seed"] for f in task["failed"]] == [0, 3, 6, 9]
    assert found["schema"] == 1 and found["complete"] and found["passed"]
    assert found["configuration"]["settings"]["pipeline"]["encoder"] == DEFAULT_MODEL
    assert found["noise_floor"]["pairs"] == 12 and found["noise_floor"]["fewest_losses"] == 7
    assert "8/12" in capsys.readouterr().out


def test_an_unchanged_program_passes_even_exactly(
    quick: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "out.json"
    with registered(Quick):
        assert quick_run("--baseline", quick, "--exact", "--json", path) == 0
    found = json.loads(path.read_text())["tasks"]["quick"]["baseline"]
    assert (found["pairs"], found["both"], found["neither"]) == (12, 8, 4)
    assert found["lost"] == found["won"] == found["changed_states"] == []
    assert "12 trials equal to the bit" in capsys.readouterr().out


def test_a_loss_beyond_chance_fails_and_is_named(
    quick: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, xml = tmp_path / "out.json", tmp_path / "out.xml"
    with registered(Worse):
        assert quick_run("--baseline", quick, "--json", path, "--junit", xml) == 1
    found = json.loads(path.read_text())
    compared = found["tasks"]["quick"]["baseline"]
    assert compared["lost"] == [1, 2, 4, 5, 7, 8, 10, 11]
    assert compared["measures"]["success"]["p_loss"] == pytest.approx(2 * 0.5**8)
    assert not found["passed"] and "66.7 points fewer succeed" in found["reasons"][0]
    assert "loss beyond chance" in capsys.readouterr().out
    assert ElementTree.parse(xml).find(".//testcase/failure") is not None


def test_an_update_judges_nothing_and_what_comes_next_is_judged_by_it(
    quick: Path, tmp_path: Path
) -> None:
    path = tmp_path / "base.json"
    path.write_bytes(quick.read_bytes())
    with registered(Worse):
        assert quick_run("--baseline", path, "--update-baseline") == 0
        assert quick_run("--baseline", path, "--exact", seeds="0:2") == 0


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--seeds", "9:3"), "--seeds"),
        (("--tasks", "no-such-task"), "no such task"),
        (("--workers", "0"), "1 or more"),
        (("--update-baseline",), "no baseline"),
        (("--exact",), "no baseline"),
        (("--baseline", "no-such-file.json"), "no such baseline"),
        (("--json", "no-such-folder/out.json"), "no such folder"),
        (("--json", "x" * 300), "cannot be written"),
        (("--baseline", "x" * 300, "--update-baseline"), "cannot be written"),
        (("--address", "auto"), "only --executor ray"),
        (("--fingers", "7"), "--fingers"),
        (("--device", "mouse"), "not apply to regression runs"),
        (("--seed=3",), "not apply to regression runs"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(
    capsys: pytest.CaptureFixture[str], words: tuple[str, ...], said: str
) -> None:
    assert said in refused(capsys, *words)


def test_recordings_of_failed_trials_are_kept_and_replay(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "failed"
    with registered(Quick):
        assert quick_run("--record", folder, seeds="2:4") == 0
        assert f"sandbox replay {folder / 'quick-3.jsonl'}" in capsys.readouterr().out.replace(
            "\n", ""
        )
        assert [p.name for p in folder.iterdir()] == ["quick-3.jsonl"]
        assert load_recording(folder / "quick-3.jsonl").end["result"]["success"] is False
        assert main(["replay", str(folder / "quick-3.jsonl")]) == 0
        capsys.readouterr()
        assert "new or empty folder" in refused(capsys, "--tasks", "quick", "--record", folder)


def test_the_line_that_runs_a_trial_again_gives_its_state(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with registered(Quick):
        scene = {"fingers": 5, "stitch": False}
        run = RegressionPlan(("quick",), (3,), scene)
        again, replay = (shlex.split(c)[1:] for c in run.command("quick", 3).split(" && "))
        assert main([*again, "--json", "out.json"]) == 0 and main(replay) == 0
        found = json.loads(Path("out.json").read_text())
        assert found["state_hash"] == run_job(run.jobs()[0])["state_hash"]


scenes = st.fixed_dictionaries(
    {},
    optional={
        "encoder": st.sampled_from(("paper", "cubic", "a file.npz")),
        "bare": st.booleans(),
        "labels": st.sampled_from(("population", "paper", "device")),
        "stitch": st.booleans(),
        "distal_only": st.booleans(),
        "drop_outs": st.floats(0, 10),
        "fingers": st.integers(2, 5),
        "impulse": st.sampled_from(("paper", "safe", "7.5")),
        "turn": st.sampled_from((0, 90)),
    },
)


@given(scenes)
def test_a_scene_in_words_is_read_back_as_it_was(scene: dict[str, Any]) -> None:
    found = parse(TrialOptions, "test", ["box-to-goal", *options(scene)])
    assert replace(found, given=frozenset()) == TrialOptions(**{"task": "box-to-goal", **scene})
    # A flag that is off by default cannot be given as off.
    assert found.given - {"task"} == {name for name in scene if name != "bare" or scene[name]}


@given(st.lists(st.tuples(st.integers(0, 50), st.integers(1, 20)), min_size=1, max_size=5))
def test_seeds_are_ranges_as_python_counts_each_seed_once(parts: list[tuple[int, int]]) -> None:
    text = ",".join(f"{a}" if n == 1 else f"{a}:{a + n}" for a, n in parts)
    wanted = [s for a, n in parts for s in range(a, a + n)]
    assert parse_seeds(text) == tuple(dict.fromkeys(wanted))


@pytest.mark.parametrize("text", ["", ":", "3:", "a", "5:5", "9:3", "-1:3", "1:2:3", "0:9999999"])
def test_what_is_no_range_of_seeds_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="seeds"):
        parse_seeds(text)


def test_two_files_whose_tasks_have_one_name_are_refused_as_their_trials_would_be_mixed(
    tmp_path: Path,
) -> None:
    for file in ("one.py", "two.py"):
        text = "from tests.support.regress_tasks import Quick\nclass A(Quick): name = 'lab-a'\n"
        (tmp_path / file).write_text(text)
    one, two = f"{tmp_path}/one.py", f"{tmp_path}/two.py"
    with pytest.raises(
        InputError, match=r"two\.py: another of the tasks has .*leave out .*one\.py"
    ):
        RegressionPlan((one, two), (0,))
    # The same one by two names is no other.
    assert RegressionPlan((one, f"{one}:A"), (0,)).names


@pytest.mark.needs("opengl")
def test_lost_trials_are_filmed_with_the_lines_that_film_them_before(
    quick: Path, tmp_path: Path
) -> None:
    with registered(Worse):
        assert quick_run("--baseline", quick, "--film-lost", tmp_path / "films") == 1
    films = sorted((tmp_path / "films").glob("*.webp"))
    assert [film.name for film in films] == [f"quick-{seed}.webp" for seed in (1, 2, 4, 5, 7)]
    page = (tmp_path / "films" / "films.md").read_text()
    assert str(load_baseline(quick).origin) in page
    for film in films:
        seed = film.stem.removeprefix("quick-")
        assert f"| ![](before-{film.name}) | ![]({film.name}) |" in page
        assert f"sandbox run quick --seed {seed} --film before-{film.name}" in page


def test_the_workflow_to_copy_gives_options_that_there_are() -> None:
    text = (ROOT / "examples" / "ci" / "regression.yml").read_text()
    lines = re.findall(r"^ {10}(sandbox regress.*(?:\n {10}\S.*)*)", text, re.M)
    made, found = (
        parse(RegressOptions, "sandbox regress", shlex.split(line)[2:]) for line in lines
    )
    assert found.baseline and found.junit and found.json and made.update_baseline
    # What makes the baseline runs what the job compares with it.
    made = replace(made, update_baseline=False)
    names = ("json", "junit", "markdown", "record", "given")
    assert replace(made, **{name: getattr(found, name) for name in names}) == found
