"""What reports find in studies whose truth is known."""

from __future__ import annotations

import pytest

from sandbox.study.design.design_file import load_design
from sandbox.study.design.planned import family_size, planned_tests
from sandbox.study.design.power import power
from tests.support.study_findings import DESIGN, PRIMARY, nothing, planted


def findings(count: int) -> tuple[list[int], list[int]]:
    """Tests of both kinds of study, and numbers of studies with a finding."""
    design = load_design(DESIGN, try_out=False)
    some = list(nothing(design, count, ((), PRIMARY)))
    tests = [kind[0] for kind in some[0]]
    # The plan counts the tests that the report makes.
    assert tests[0] == family_size(planned_tests(design))
    return tests, [sum(study[kind][1] > 0 for study in some) for kind in range(2)]


def test_equal_levels_and_answers_by_chance_have_few_findings() -> None:
    tests, wrong = findings(25)
    assert tests[1] < tests[0]
    assert max(wrong) <= 5


def test_a_planted_effect_is_found_about_as_often_as_planned() -> None:
    told = list(planted(0.8, 12, 60))
    assert sum(t.found for t in told) / 60 == pytest.approx(power(0.8, 12), abs=0.2)
    assert sum(t.covers for t in told) >= 52


@pytest.mark.full
def test_of_three_hundred_studies_without_differences_one_in_twenty_finds_one_at_most() -> None:
    # 24 of 300 or fewer, with probability 0.99, if it is one in twenty.
    assert max(findings(300)[1]) <= 24
