"""Success against what gets worse: pairs of the same seeds, until it breaks."""

import errno
import json
from pathlib import Path
from typing import Any, ClassVar
from xml.etree import ElementTree

import pytest

from models.errors import InputError
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.cli.regress import main as regress_main
from sandbox.regress.baseline import Baseline, BaselineTask
from sandbox.regress.execute import Serial
from sandbox.regress.run_plan import RegressionPlan, registered
from sandbox.regress.sweep import Runner, Sweep, parse_variations, sweep, varied
from sandbox.regress.trials_file import TrialsFile
from sandbox.trial.trial_options import KINDS
from tasks.box_to_goal import BoxToGoal
from tasks.sensing import Sensing
from tasks.stack import Stack
from tasks.task import Measure, Task, place_surface
from tests.support.regress_tasks import NoPlace, Quick

SEEDS = tuple(range(8))


class Heavy(BoxToGoal):
    """Fails where the box was made heavier than three times what was drawn; over in a blink."""

    name: ClassVar[str] = "heavy"
    time_limit: ClassVar[float] = 0.15
    hold_time: ClassVar[float] = 0.05

    def measure(self, sensing: Sensing) -> Measure:
        drawn = BoxToGoal.draw(self.seed, place_surface(Surface(), BoxToGoal)).objects[0].mass
        light = self.objects[0].mass <= 3.0 * drawn
        return Measure(light, float(light), "" if light else "it is too heavy")


def run(plan: RegressionPlan) -> list[dict[str, Any]]:
    return list(Serial().run(plan.jobs()))


def limited(plan: RegressionPlan) -> list[dict[str, Any]]:
    """Trials that fail where masses are more than three times what was drawn; no physics."""
    trials = []
    for job in plan.jobs():
        mass = job.settings.variation.mass
        light = mass <= 3.0
        trials.append({"seed": job.seed, "success": light, "progress": 1.0, "time_s": 1.0})
    return trials


def found_by(
    task: str | type[Task], *words: str, seeds: tuple[int, ...] = SEEDS, runner: Runner = limited
) -> Sweep:
    return sweep(RegressionPlan((task,), seeds), parse_variations(words), runner)


def test_a_direction_ends_where_success_is_lower_beyond_chance_and_no_later() -> None:
    (curve,) = found_by(Heavy, "mass").curves
    kind = KINDS["mass"]
    assert [p.value for p in curve.points] == [*sorted(kind.down), 1.0, 2.0, 4.0]
    assert [p.breaks for p in curve.points] == [False] * 6 + [True]
    assert curve.breaks_above == 4.0 and curve.breaks_below is None
    assert curve.points[-1].lost == SEEDS and curve.points[-1].won == ()


def test_values_that_are_asked_for_are_all_run_even_where_it_breaks() -> None:
    (curve,) = found_by(Heavy, "mass=8,1,0.5,4,2,2").curves
    assert [(p.value, p.breaks) for p in curve.points] == [
        (0.5, False),
        (1.0, False),
        (2.0, False),
        (4.0, True),
        (8.0, True),
    ]
    assert curve.breaks_above == 4.0


@pytest.mark.parametrize(
    ("stops_in", "ended", "missing"),
    [
        (1, 0, ["heavy", "quick"]),
        (3, 5, ["heavy, mass=2 (5 of 8 trials)", "heavy, mass=8", "heavy, size", "quick"]),
        (99, 8, []),
    ],
)
def test_a_run_that_is_stopped_says_what_is_not_finished_and_counts_what_ended(
    stops_in: int, ended: int, missing: list[str]
) -> None:
    runs = 0

    def stopped(plan: RegressionPlan) -> list[dict[str, Any]]:
        nonlocal runs
        runs += 1
        # Whoever was asked to stop runs nothing any more.
        trials = [{**t, "status": "held", "reason": ""} for t in limited(plan)]
        return trials[: ended if runs == stops_in else None if runs < stops_in else 0]

    plan = RegressionPlan((Heavy, Quick), SEEDS)
    wanted = parse_variations(["mass=4,2,8", "size"])
    found = sweep(plan, wanted, stopped)
    assert [each.text(len(SEEDS)) for each in found.unfinished] == missing
    assert found.complete == (not missing)
    partial = [p for curve in found.curves for p in curve.points if p.partial]
    assert [p.result.n for p in partial] == ([ended] if missing and ended else [])
    # What was not finished breaks nothing.
    assert not any(p.breaks for p in partial)
    told = found.as_json()
    assert len(told["not_finished"]) == len(missing) and told["complete"] == (not missing)


def test_a_value_that_one_seed_cannot_have_is_refused_before_any_other_seed_is_played() -> None:
    plans = []

    def noted(plan: RegressionPlan) -> list[dict[str, Any]]:
        plans.append(plan)
        return limited(plan)

    # Boxes of seed 1 stay apart, those of seed 2 do not.
    (curve,) = found_by(Stack, "size=1.6", seeds=(1, 2), runner=noted).curves
    assert "stack, seed 2" in curve.points[1].refused and "overlap" in curve.points[1].refused
    assert len(plans) == 1


@pytest.mark.parametrize(
    ("task", "varied", "reason"),
    [
        ("box-to-goal", "room", "no room that can be varied"),
        ("box-to-goal", "resistance=2", "resistance"),
        ("dial", "start", "start of this object"),
        ("gather", "start=5,10", "dice already start anywhere"),
        ("stack", "size=3", "overlap"),
    ],
)
def test_what_no_task_can_have_is_refused_before_anything_is_played(
    task: str,
    varied: str,
    reason: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(Serial, "run", lambda *args: pytest.fail("a trial was played"))
    words = ["--tasks", task, "--seeds", "0:3", "--executor", "serial", "--vary", "mass=2", varied]
    assert main(["regress", *words, "--json", str(tmp_path / "out.json")]) == 2
    said = capsys.readouterr()
    assert not said.out and said.err.count("\n") == 1 and not list(tmp_path.iterdir())
    assert "no chosen task can be varied like that" in said.err and reason in said.err


def test_a_varied_run_is_never_compared_with_a_baseline_of_one_that_is_not() -> None:
    plan = RegressionPlan((Heavy,), SEEDS)
    kept = Baseline(plan.origin(), {"heavy": BaselineTask(1, "", {})})
    kept.check(plan.origin(), plan.versions())
    for kind in KINDS.values():
        other = varied(plan, kind, kind.up[0]).origin()
        with pytest.raises(InputError, match="other settings"):
            kept.check(other, plan.versions())
        with pytest.raises(InputError, match="other settings"):
            Baseline(other, kept.tasks).check(plan.origin(), plan.versions())


@pytest.mark.parametrize("word", ["weight", "mass=", "mass=a", "mass=2,,3", "mass=1000", "=2", ""])
def test_what_cannot_be_varied_is_one_clear_error(word: str) -> None:
    with pytest.raises(InputError, match="--vary"):
        parse_variations([word])
    with pytest.raises(InputError, match="twice"):
        parse_variations(["mass", "mass=2"])


def heavy_regress(*words: str | Path) -> int:
    with registered(Heavy):
        return regress_main(
            ["--tasks", "heavy", "--seeds", "0:5", "--executor", "serial", *map(str, words)]
        )


def test_the_command_prints_a_table_writes_a_report_and_draws_a_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    report, plot = tmp_path / "report.json", tmp_path / "plot.svg"
    assert heavy_regress("--vary", "mass=4", "start=20", "--json", report, "--plot", plot) == 0
    printed = capsys.readouterr().out
    assert "heavy breaks at mass 4" in printed
    assert "heavy: no break found from start 0 mm to 20 mm" in printed
    assert "sandbox run heavy --seed 0 --vary mass=4 --record" in printed
    read = json.loads(report.read_text())
    assert [(c["task"], c["varied"], c["breaks_above"]) for c in read["curves"]] == [
        ("heavy", "mass", 4.0),
        ("heavy", "start", None),
    ]
    assert [len(p["trials"]) for p in read["curves"][0]["points"]] == [5, 5]
    assert "variation" not in read["configuration"]
    ElementTree.fromstring(plot.read_text())


@pytest.mark.parametrize(
    "words",
    [
        ("--vary", "mass=2", "--baseline", "base.json"),
        ("--vary", "mass=2", "--record", "folder"),
        ("--vary", "mass=2", "--plot", "picture.txt"),
        ("--vary", "mass=2", "--plot", "no/such/folder.png"),
        ("--plot", "picture.png"),
        ("--vary",),
        ("--vary", "weight"),
    ],
)
def test_options_that_do_not_go_together_are_refused_before_anything_is_run(
    words: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError):
        heavy_regress(*words)
    assert not list(tmp_path.iterdir())


def test_a_full_disk_is_never_taken_for_a_value_that_a_task_cannot_have(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    write, full = TrialsFile._write, [b'"varied": "mass=4"']

    def full_once(file: TrialsFile, line: bytes) -> None:
        """The disk is full for one moment, while the first trial of mass 4 is written."""
        if full and full[0] in line:
            full.clear()
            raise OSError(errno.ENOSPC, "No space left on device")
        write(file, line)

    monkeypatch.setattr(TrialsFile, "_write", full_once)
    report = tmp_path / "report.json"
    words = ["--tasks", "heavy", "--seeds", "0:2", "--executor", "serial", "--json", str(report)]
    with registered(Heavy):
        assert main(["regress", *words, "--vary", "mass=4"]) == 2
        said = capsys.readouterr().err
        assert "No space left on device" in said and not report.exists()
        assert main(["regress", *words, "--vary", "mass=4", "--resume"]) == 0
    nominal, varied = json.loads(report.read_text())["curves"][0]["points"]
    assert nominal["n"] == varied["n"] == 2 and "refused" not in varied


def test_a_seed_that_a_task_s_own_code_cannot_draw_crashes_and_refuses_no_value() -> None:
    (curve,) = found_by(NoPlace, "mass=2", seeds=(1, 2, 3), runner=run).curves
    for point in curve.points:
        assert not point.refused and point.result.n == 3
        assert [t["seed"] for t in point.result.crashed] == [2]
