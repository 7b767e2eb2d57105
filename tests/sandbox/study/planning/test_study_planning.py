"""A plan takes spread and success rates from a pilot, and its preregistration is of the lock."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt
from pathlib import Path

import pytest

from models.errors import InputError, StudyError
from sandbox.cli.main import main
from sandbox.study.design.design import Design
from sandbox.study.design.design_file import parse_design
from sandbox.study.design.planned import family_size, planned_tests
from sandbox.study.design.power import people_needed, power
from sandbox.study.planning.needed import NO_PEOPLE, change_of, needs, power_lines
from sandbox.study.planning.pilot import Pilot, Spread, read_pilot
from sandbox.study.planning.preregistration import lock_of, preregistration
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.report.models.analysis import analyse
from sandbox.study.report.models.data import load_study
from sandbox.study.report.models.quantities import LOG
from sandbox.study.run.simulate import simulate
from tests.sandbox.study.report.study_reports import planted, put
from tests.support.planted_study import Truth
from tests.support.study_files import DESIGN, design

PLANNED = """
name = "planned"
participants = 24
[settings]
task = "box-to-goal"
[[factors]]
name = "encoder"
order = "latin"
levels = ["paper", "best"]
[[factors]]
name = "task"
order = "latin"
levels = ["box-to-goal", "wrench-turn"]
[trials]
repetitions = 3
[[questionnaires]]
use = "nasa-tlx-raw"
at = "encoder"
[[exclusions]]
name = "too-fast"
measure = "time_s"
below = 0.5
[analysis]
primary = ["time_s", "success"]
"""
EVERY = Truth(people=12, times=(10.0, 8.5), repetitions=3, losses=(1e-9, 1e-9), limit=3600.0)

THREE = replace(EVERY, people=3)


def plan(text: str = PLANNED) -> Design:
    return parse_design(text, Path("design.toml"), try_out=False)


def pilot(folder: Path, truth: Truth = EVERY, seed: int = 1) -> Pilot:
    planted(folder, truth, seed)
    return read_pilot(folder, planned_tests(plan()))


def spread(found: Pilot, outcome: str = "time_s") -> Spread:
    one = found.spreads[outcome, "encoder"]
    assert isinstance(one, Spread)
    return one


def test_the_spread_of_a_pilot_is_that_of_its_people(tmp_path: Path) -> None:
    truth = replace(EVERY, people=150)
    one = spread(pilot(tmp_path, truth, 2))
    for trials in (2, 6, 40):
        expected = sqrt(2 * truth.person_level**2 + 2 * truth.residual**2 / trials)
        assert one.deviation(trials) == pytest.approx(expected, rel=0.15)


def test_the_effect_of_a_pilot_changes_nothing(tmp_path: Path) -> None:
    rows = planted(tmp_path, EVERY)
    lines = []
    for factor in (1.0, 3.0):
        # Times in the table have six decimals.
        slower = [
            {**r, "time_s": float(r["time_s"]) * (factor if r["factor_encoder"] == "b" else 1.0)}
            for r in rows
        ]
        put(tmp_path, slower)
        found = read_pilot(tmp_path, planned_tests(plan()))
        lines.append(list(power_lines(plan(), 24, found, change=0.15)))
    assert lines[0] == lines[1]


def test_repetitions_and_success_rates_count(tmp_path: Path) -> None:
    one = needs(plan(), pilot(tmp_path), 0.3)[0]
    people = [one.participants(0.15, trials) for trials in (1, 3, 9, 100)]
    assert people == sorted(people, reverse=True) and people[0] != people[-1]
    assert isinstance(one.spread, Spread)
    half = replace(one, spread=replace(one.spread, success=0.5))
    assert half.participants(0.15, 6) == one.participants(0.15, 3)
    assert (half.participants(0.15) or 0) > (one.participants(0.15) or 0)


def test_so_many_people_as_are_needed_find_the_effect_and_one_less_does_not() -> None:
    for effect, tests, between in ((0.4, 1, False), (0.8, 6, False), (0.8, 3, True)):
        people = people_needed(effect, tests, between)
        assert people is not None
        less = people - (2 if between else 1)
        assert power(effect, people, 0.05 / tests, between) >= 0.8
        assert power(effect, less, 0.05 / tests, between) < 0.8
    assert people_needed(1e-4) is None


def test_what_is_needed_and_what_is_detected_agree(tmp_path: Path) -> None:
    one = needs(plan(), pilot(tmp_path), 0.3)[0]
    people = one.participants(0.15)
    assert people is not None
    assert one.smallest(people) <= 0.15 < one.smallest(people - 1)
    assert one.smallest(people, cautious=True) > one.smallest(people)


def test_a_pilot_in_which_everybody_succeeds_does_not_promise_that(tmp_path: Path) -> None:
    one = spread(pilot(tmp_path), "success")
    assert 0.0 < one.deviation(6) < 0.2


def test_levels_that_a_pilot_does_not_compare_are_said_to_be_unknown(tmp_path: Path) -> None:
    planted(tmp_path, EVERY)
    text = PLANNED.replace('name = "encoder"', 'name = "feel"\nsetting = "encoder"', 1)
    other = plan(text.replace('at = "encoder"', 'at = "feel"'))
    lines = list(power_lines(other, 24, read_pilot(tmp_path, planned_tests(other))))
    assert any("time_s by feel: the pilot does not compare these levels" in x for x in lines)


@pytest.mark.parametrize(("people", "had"), [(1, "1 person"), (2, "2 people")])
def test_a_pilot_of_too_few_people_says_how_many_it_has_and_how_many_are_needed(
    tmp_path: Path, people: int, had: str
) -> None:
    found = pilot(tmp_path, replace(EVERY, people=people))
    assert set(found.spreads.values()) == {f"the pilot has {had} and at least 3 are needed"}
    assert all(isinstance(one, Spread) for one in pilot(tmp_path / "3", THREE).spreads.values())


def test_a_pilot_with_too_few_successes_says_with_what_and_how_many_are_needed(
    tmp_path: Path,
) -> None:
    rows = planted(tmp_path, THREE)
    lost = {"success": 0, "held": 0, "status": "timeout", "time_s": 20.0}
    with_b = [r for r in rows if r["factor_encoder"] == "b" and r["factor_task"] == "task1"]
    slow = [r for r in with_b if r["ppid"] != "P001"]
    put(tmp_path, [{**r, **lost} if r in slow else r for r in rows])
    found = read_pilot(tmp_path, planned_tests(plan()))
    assert found.spreads["time_s", "encoder"] == (
        "too few people of the pilot succeeded (1 with b / task1) and at least 2 are needed with "
        "each"
    )
    assert isinstance(found.spreads["success", "encoder"], Spread)
    put(tmp_path, [{**r, **lost} for r in rows])
    found = read_pilot(tmp_path, planned_tests(plan()))
    assert found.spreads["time_s", "encoder"] == "the pilot has no successes"


def test_a_preregistration_marks_what_has_no_power_and_a_plan_says_why(tmp_path: Path) -> None:
    found = pilot(tmp_path, replace(EVERY, people=1))
    assert (
        "TO BE WRITTEN: power of time_s by encoder, because the pilot has 1 person and at least 3 "
        "are needed"
    ) in power_lines(plan(), 24, found, marked=True)
    told = list(power_lines(plan(), 24, found))
    assert "time_s by encoder: the pilot has 1 person and at least 3 are needed" in told
    enough = power_lines(plan(), 24, pilot(tmp_path / "3", THREE), marked=True)
    assert not any("TO BE WRITTEN" in line for line in enough)


def test_too_few_participants_are_said_to_detect_no_difference(tmp_path: Path) -> None:
    lines = list(power_lines(plan(), 2, pilot(tmp_path, THREE)))
    assert any("success by encoder: 2 participants detect no difference" in x for x in lines)
    assert any("time_s by encoder: 2 participants detect no change" in x for x in lines)


def test_a_simulated_pilot_is_called_one_in_the_terminal_and_in_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = StudyFolder(tmp_path, design(), SIMULATED)
    simulate(study, 1, False, lambda text: None)
    out = tmp_path / "prereg.md"
    command = ["study", "plan", str(study.path / "design.toml"), "--from", str(study.path)]
    assert main([*command, "--preregistration", str(out)]) == 0
    told = capsys.readouterr().out
    assert NO_PEOPLE in told and NO_PEOPLE in out.read_text()
    marked = "TO BE WRITTEN: power of time_s by contact, because the pilot has 1 person"
    assert marked in told and marked in out.read_text()
    assert main([*command, "--power"]) == 0
    assert NO_PEOPLE in capsys.readouterr().out


def test_a_rehearsal_that_a_simulated_user_played_is_never_taken_for_people(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # As `study run --pilot --device simulated` writes it: data of a pilot.
    rows = [{**row, "mode": "pilot"} for row in planted(tmp_path)]
    nobody = "No person took part: a simulated user played all trials."
    for name, source, telling in (
        ("played", "simulated user", nobody),
        ("some", "", "A simulated user, and no person, played 1 of"),
        ("device", "device", ""),
    ):
        told = [{**row, "label_truth": source} for row in rows]
        if name == "some":
            counted = [row for row in told if row["counted"] == "1" and row["practice"] == "0"]
            counted[0]["label_truth"] = "simulated user"
            counted[1]["label_truth"] = "device"
        folder = tmp_path / name
        put(folder, told, tuple(told[0]))
        data = load_study(folder)
        assert data.rehearsed.startswith(telling) and bool(data.rehearsed) == bool(telling), name
        assert main(["study", "report", str(folder)]) == 0
        said = " ".join(capsys.readouterr().out.split())
        page = (folder / "report" / "report.html").read_text(encoding="utf-8")
        assert (data.rehearsed in said) and (data.rehearsed in page)
        lines = list(power_lines(plan(), 20, read_pilot(folder, planned_tests(plan()))))
        assert (nobody in lines) == (telling == nobody)


def test_the_planned_tests_are_those_of_the_report(tmp_path: Path) -> None:
    study = StudyFolder(tmp_path, design(), SIMULATED)
    simulate(study, 3, False, lambda text: None)
    found = analyse(load_study(study.path)).family
    assert len(found.tests) == family_size(planned_tests(design())) == 2


def test_primary_outcomes_share_alpha_among_themselves_only() -> None:
    assert family_size(planned_tests(plan())) == 4
    every = plan(PLANNED.replace('[analysis]\nprimary = ["time_s", "success"]\n', ""))
    assert family_size(planned_tests(every)) == 5
    one = plan(PLANNED.replace('["time_s", "success"]', '["time_s"]'))
    assert family_size(planned_tests(one)) == 2


def test_a_guess_is_called_one() -> None:
    lines = list(power_lines(plan(), 24, guess=0.2, change=0.15))
    assert any("0.2 of log time, a guess" in line for line in lines)
    assert any("success by task: a pilot must tell its spread" in line for line in lines)
    assert needs(plan(), None, 0.2)[0].spread == Spread(LOG, 0, 0.2**2, 0.0, False, 1.0)


@pytest.mark.parametrize(("text", "value"), [("15%", 0.15), ("0.15", 0.15), ("7.5%", 0.075)])
def test_a_change_is_given_in_per_cent_or_as_a_share(text: str, value: float) -> None:
    assert change_of(text) == pytest.approx(value)


@pytest.mark.parametrize("text", ["", "much", "-15%", "0", "nan%"])
def test_what_is_no_change_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="--detect"):
        change_of(text)


def test_a_preregistration_says_design_number_power_exclusions_analysis_and_lock() -> None:
    text = preregistration(plan(), 24, ["24 participants detect 20 %"], {"mujoco": "4.0.0"})
    for part in (
        "Factor encoder: paper, best; within participants, order latin",
        "24 participants finish all sessions",
        "24 participants detect 20 %",
        "too-fast: a trial with time_s below 0.5 is excluded",
        "time_s by encoder: 1 comparison",
        "P values of all 4 tests are adjusted together (Holm 1979)",
        "Everything else is exploratory",
        "mujoco: 4.0.0",
    ):
        assert part in text
    assert "nasa-tlx-raw by" not in text, "it is not primary"


def test_a_preregistration_leaves_out_the_labels_of_an_encoder_without_any() -> None:
    lock = {"encoders": {"paper": {"encoder": "3575d95f", "labels": ""}}}
    assert "- encoders: paper encoder 3575d95f\n" in preregistration(plan(), 24, [], lock)


def test_a_preregistration_says_the_limit_of_a_task_that_is_shorter_than_the_designs() -> None:
    asked = "[trials]\nrepetitions = 3\n"
    text = preregistration(plan(PLANNED.replace(asked, asked + "time_limit_s = 25\n")), 24, [], {})
    assert "after 25 s at the latest, of wrench-turn after 20 s, which is the task's own" in text
    text = preregistration(plan(PLANNED.replace(asked, asked + "time_limit_s = 15\n")), 24, [], {})
    assert "after 15 s at the latest.\n" in text


def test_a_preregistration_of_a_begun_study_is_of_its_lock(tmp_path: Path) -> None:
    study = StudyFolder(tmp_path, design(), SIMULATED)
    path = study.path / "design.toml"
    begun = parse_design(path.read_text(), path, try_out=False)
    assert lock_of(begun) == study.build
    path.write_text(DESIGN.replace("repetitions = 2", "repetitions = 3"))
    with pytest.raises(StudyError, match="locked to another design"):
        lock_of(parse_design(path.read_text(), path, try_out=False))


def test_the_command_plans_from_a_pilot_and_writes_the_preregistration(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    planted(tmp_path / "pilot", EVERY)
    file, out = tmp_path / "design.toml", tmp_path / "prereg.md"
    file.write_text(PLANNED)
    command = ["study", "plan", str(file), "--power", "--from", str(tmp_path / "pilot")]
    assert main([*command, "--detect", "15%", "--preregistration", str(out)]) == 0
    told = capsys.readouterr().out
    assert "a change of 15 % needs" in told and "its effects are not" in told
    assert "a change of 15 % needs" in out.read_text()
    assert main([*command, "--preregistration", str(out)]) == 2
    assert main([*command, "--detect", "much"]) == 2
    assert main([*command[:3], "--from", str(tmp_path / "pilot")]) == 2
    assert main([*command[:4], "--from", str(tmp_path / "nowhere")]) == 2
    errors = capsys.readouterr().err
    assert "exists already" in errors and "--detect" in errors and "--power" in errors


def test_of_a_factor_inside_of_groups_only_one_group_counts() -> None:
    nested = (
        PLANNED[: PLANNED.index("[[factors]]")]
        + """[[factors]]
name = "task"
order = "between"
levels = ["box-to-goal", "wrench-turn"]
[[factors]]
name = "encoder"
order = "latin"
inside = "task"
levels = { box-to-goal = ["paper", "best"], wrench-turn = ["linear", "quadratic"] }
[trials]
repetitions = 3
[analysis]
primary = ["time_s"]
"""
    )
    tests = {test.factor.name: test for test in planned_tests(plan(nested))}
    assert tests["encoder"].pairs == 2
    assert tests["encoder"].people_in(24) == 12 and tests["encoder"].participants_for(39) == 78
    assert tests["task"].people_in(24) == 24
    # The same pair in both groups is everybody's.
    shared = nested.replace('["linear", "quadratic"]', '["paper", "best"]')
    (one,) = [test for test in planned_tests(plan(shared)) if test.factor.name == "encoder"]
    assert one.pairs == 1 and one.people_in(24) == 24 and one.participants_for(39) == 39
