"""`study plan --power`: the planned tests, the people that they need, and the effects found."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.study.design.design import Design
from sandbox.study.design.design_file import parse_design
from sandbox.study.design.power import detectable, family_size, people_needed, planned_tests, power
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.report.data import load_study
from sandbox.study.report.numbers import CONFIRMATORY, results
from sandbox.study.run.simulated_study import simulate
from tests.support.study_files import design, quiet

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


@pytest.mark.parametrize(("people", "found"), [(12, 1.127545), (24, 0.731917)])
def test_what_is_found_is_what_r_finds(people: int, found: float) -> None:
    # power.t.test(n, power = 0.8, sig.level = 0.05 / 4, type = "paired")
    assert detectable(people, 4) == pytest.approx(found, abs=1e-4)


def test_the_planned_tests_are_those_of_the_report(tmp_path: Path) -> None:
    study = StudyFolder(tmp_path, design(), SIMULATED)
    simulate(study, 3, False, quiet)
    found = results(load_study(study.path))
    tests = sum(len(one.pairs) for one in found.compared if one.role == CONFIRMATORY)
    assert tests == family_size(planned_tests(design())) == 2


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
