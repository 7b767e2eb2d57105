"""`study plan --power`: the planned tests, the people that they need, and the effects found."""

from __future__ import annotations

from pathlib import Path

import pytest

from models.errors import InputError
from sandbox.cli.main import main
from sandbox.study.design.design import Design
from sandbox.study.design.design_file import parse_design
from sandbox.study.design.needed import change_of, needs, power_lines
from sandbox.study.design.planned import family_size, planned_tests
from sandbox.study.design.power import people_needed, power
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.report.models.analysis import analyse
from sandbox.study.report.models.data import load_study
from sandbox.study.run.simulate import simulate
from tests.support.study_files import design

PLANNED = """
name = "planned"
participants = 24
[settings]
task = "box-to-goal"
[[factors]]
name = "encoder"
order = "latin"
levels = ["paper", "population"]
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


def plan(text: str = PLANNED) -> Design:
    return parse_design(text, Path("design.toml"), try_out=False)


def test_so_many_people_as_are_needed_find_the_effect_and_one_less_does_not() -> None:
    for effect, tests, between in ((0.4, 1, False), (0.8, 6, False), (0.8, 3, True)):
        people = people_needed(effect, tests, between)
        assert people is not None
        less = people - (2 if between else 1)
        assert power(effect, people, 0.05 / tests, between) >= 0.8
        assert power(effect, less, 0.05 / tests, between) < 0.8
    assert people_needed(1e-4) is None


def test_what_is_needed_and_what_is_detected_agree() -> None:
    one = needs(plan(), 0.3)[0]
    people = one.participants(0.15)
    assert people is not None
    assert one.smallest(people) <= 0.15 < one.smallest(people - 1)


def test_too_few_participants_are_said_to_detect_no_change() -> None:
    lines = list(power_lines(plan(), 2))
    assert any("time_s by encoder: 2 participants detect no change" in x for x in lines)


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
    assert any("success by task: its spread between people is unknown" in line for line in lines)
    assert [one.spread for one in needs(plan(), 0.2)] == [0.2, 0.2, None, None]


def test_the_command_plans_for_an_effect_and_refuses_what_is_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "design.toml"
    file.write_text(PLANNED)
    command = ["study", "plan", str(file)]
    assert main([*command, "--power", "--detect", "15%"]) == 0
    assert "a change of 15 % needs" in capsys.readouterr().out
    assert main([*command, "--power", "--detect", "much"]) == 2
    assert main([*command, "--detect", "15%"]) == 2
    errors = capsys.readouterr().err
    assert "--detect" in errors and "--power" in errors


@pytest.mark.parametrize(("text", "value"), [("15%", 0.15), ("0.15", 0.15), ("7.5%", 0.075)])
def test_a_change_is_given_in_per_cent_or_as_a_share(text: str, value: float) -> None:
    assert change_of(text) == pytest.approx(value)


@pytest.mark.parametrize("text", ["", "much", "-15%", "0", "nan%"])
def test_what_is_no_change_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="--detect"):
        change_of(text)


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
levels = { box-to-goal = ["paper", "population"], wrench-turn = ["linear", "quadratic"] }
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
    shared = nested.replace('["linear", "quadratic"]', '["paper", "population"]')
    (one,) = [test for test in planned_tests(plan(shared)) if test.factor.name == "encoder"]
    assert one.pairs == 1 and one.people_in(24) == 24 and one.participants_for(39) == 39
