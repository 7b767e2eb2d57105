"""What a study tests is one family, and what is exploratory has no p value."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sandbox.study.design.design_file import parse_design
from sandbox.study.design.reading import DesignError
from sandbox.study.design.scoring import scores
from sandbox.study.report.models.analysis import analyse
from sandbox.study.report.models.answers import score_scales
from sandbox.study.report.models.data import load_study
from sandbox.study.report.models.family import CONFIRMATORY, EXPLORATORY
from sandbox.study.report.models.intervals import holm
from sandbox.study.report.page.page import head
from sandbox.study.tables.codebook import codebook
from sandbox.study.tables.column import csv_bytes
from tests.sandbox.study.report.study_reports import planted, put, report, rows_of
from tests.support.study_files import DESIGN

SCALED = (
    DESIGN.replace('name = "contact"\norder', 'name = "encoder"\nsetting = "contact"\norder')
    .replace('at = "contact"', 'at = "encoder"')
    .replace('practice_each = "contact"', 'practice_each = "encoder"')
    + """
[[questionnaires.scales]]
name = "effort"
rule = "mean"
items = ["effort"]
[[questionnaires]]
use = "sus"
at = "end"
[[questionnaires]]
name = "calm"
at = "encoder"
title = "And"
[[questionnaires.items]]
name = "calm"
kind = "scale"
ask = "How calm were you?"
[[questionnaires]]
name = "mood"
at = "encoder"
title = "Mood"
[[questionnaires.items]]
name = "glad"
kind = "scale"
ask = "How glad were you?"
[[questionnaires.items]]
name = "sad"
kind = "scale"
ask = "How sad were you?"
"""
)


def with_primary(*names: str) -> str:
    return f"{SCALED}[analysis]\nprimary = {list(names)!r}\n".replace("'", '"')


def answered(folder: Path, effect: float = 0.0, design: str = SCALED) -> None:
    """Scores and answers of the people of a planted study, and the codebook of a design."""
    rng = np.random.default_rng(5)
    planted(folder)
    rows, items = [], []
    for i in range(1, 7):
        for level in "abc":
            about = {"ppid": f"P{i:03d}", "instrument": "effort", "factor_encoder": level}
            value = 50 + effect * (level == "b") + rng.normal()
            rows += [
                {**about, "scale": "effort", "score": value},
                {**about, "scale": "mental", "score": 50 + 1000 * (level == "b")},
            ]
            items.append({**about, "item": "effort", "answer": value})
    (folder / "questionnaire_scores.csv").write_bytes(csv_bytes(rows, tuple(rows[0])))
    (folder / "questionnaires.csv").write_bytes(csv_bytes(items, tuple(items[0])))
    book = codebook(parse_design(design, Path("design.toml"), try_out=False))
    (folder / "codebook.csv").write_bytes(book)


def test_all_that_is_tested_is_one_family(tmp_path: Path) -> None:
    answered(tmp_path)
    family = analyse(load_study(tmp_path)).family
    counts = {name: sum(t.outcome == name for t in family.tests) for name in family_names(tmp_path)}
    # Three pairs of encoders and one of tasks; questionnaires are about encoders.
    assert counts == {"time_s": 4, "success": 4, "effort": 3}
    assert [t.p_holm for t in family.tests] == holm([t.p for t in family.tests])


def test_it_is_said_how_many_tests_p_values_are_adjusted_for(tmp_path: Path) -> None:
    answered(tmp_path)
    # Where all trials of everybody succeed, no p value of times changes, and success has p = 1;
    # of two people alone, times have none.
    rows = rows_of(tmp_path / "trial_results.csv")
    put(tmp_path, [r for r in rows if r["factor_encoder"] == "a" or r["ppid"] in ("P001",)])
    family = analyse(load_study(tmp_path)).family
    known = sum(np.isfinite(t.p) for t in family.tests)
    assert 0 < known < len(family.tests)
    text = report(tmp_path).text
    assert f"adjusted for all {known} test" in text and "that can be computed" in text
    assert f"Of these, {len(family.tests) - known} cannot be computed" in text


def family_names(folder: Path) -> list[str]:
    tests = analyse(load_study(folder)).family.tests
    return list(dict.fromkeys(test.outcome for test in tests))


def test_of_a_questionnaire_its_score_is_tested_and_neither_other_scales_nor_questions(
    tmp_path: Path,
) -> None:
    answered(tmp_path)
    page = report(tmp_path)
    rows = rows_of(tmp_path / "report" / "score_comparisons.csv")
    told = {r["scale"]: r for r in rows if r["second"] == "b"}
    assert set(told) == {"effort", "mental"}, "questions are described"
    assert told["effort"]["role"] == CONFIRMATORY and told["effort"]["p_holm"]
    # Although every answer differs.
    assert told["mental"]["role"] == EXPLORATORY
    assert not told["mental"]["p"] + told["mental"]["p_holm"]
    assert "mental differs" not in page.text


def test_a_score_that_nobody_has_is_not_replaced_by_the_next_scale(tmp_path: Path) -> None:
    answered(tmp_path)
    path = tmp_path / "questionnaire_scores.csv"
    rows = [
        {**row, "score": "" if row["scale"] == "effort" else row["score"]} for row in rows_of(path)
    ]
    path.write_bytes(csv_bytes(rows, tuple(rows[0])))
    assert "effort" not in family_names(tmp_path)
    assert not any(scale.main for scale in score_scales(load_study(tmp_path)))


def test_of_whom_the_experimenter_excluded_no_answer_is_described(tmp_path: Path) -> None:
    answered(tmp_path)
    whole = [len(scale.values) for scale in score_scales(load_study(tmp_path))]
    about = [{"ppid": f"P{i:03d}", "excluded": int(i == 2)} for i in range(1, 7)]
    (tmp_path / "participants.csv").write_bytes(csv_bytes(about, tuple(about[0])))
    # The person had begun, and had no trial yet that counts.
    rows = [row for row in rows_of(tmp_path / "trial_results.csv") if row["ppid"] != "P002"]
    put(tmp_path, rows)
    assert [len(scale.values) for scale in score_scales(load_study(tmp_path))] == [
        n - 1 for n in whole
    ]


def test_with_primary_outcomes_only_these_are_tested(tmp_path: Path) -> None:
    answered(tmp_path, 20.0, with_primary("effort"))
    page = report(tmp_path)
    rows = rows_of(tmp_path / "report" / "comparisons.csv")
    assert {r["role"] for r in rows} == {EXPLORATORY}
    assert not any(r["p"] or r["p_holm"] for r in rows)
    assert all(r["low"] and r["high"] for r in rows if r["measure"] == "time_s")
    found = head(analyse(load_study(tmp_path)))["findings"]
    assert [line for line in found if "exploratory" in line and "time" in line]
    assert "b against a: effort differs (p, Holm < 0.001)." in found
    assert "The design names effort as primary. Only these are tested: 3 comparisons." in page.text


def test_a_primary_outcome_without_data_is_named(tmp_path: Path) -> None:
    answered(tmp_path, design=with_primary("time_s", "regrasps"))
    assert "Without data to compare: regrasps." in report(tmp_path).text


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("beauty", "unknown outcome 'beauty'"),
        ("time", "Did you mean time_s?"),
        ("sus", "sus is asked once"),
        ("sus", "Ask sus at a factor, after each of its levels"),
        ("mood", "mood has several questions and no score"),
        ("mood", "Give mood a scale, [[questionnaires.scales]] (docs/questionnaires.md)"),
    ],
)
def test_the_check_refuses_outcomes_that_cannot_be_compared(name: str, said: str) -> None:
    with pytest.raises(DesignError) as error:
        parse_design(with_primary("success", name), Path("design.toml"), try_out=False)
    assert said in str(error.value) and "analysis.primary" in str(error.value)


def test_a_questionnaire_of_one_question_that_is_primary_has_its_answer_as_its_score() -> None:
    design = parse_design(with_primary("calm"), Path("design.toml"), try_out=False)
    (form,) = [form for form in design.questionnaires if form.name == "calm"]
    assert [s.value for s in scores(form.scales, {"calm": 63.0})] == [63.0]
    plain = parse_design(SCALED, Path("design.toml"), try_out=False)
    assert not next(form for form in plain.questionnaires if form.name == "calm").scales


def test_primary_outcomes_are_part_of_the_lock() -> None:
    digests = {
        parse_design(text, Path("design.toml"), try_out=False).digest
        for text in (SCALED, with_primary("time_s"), with_primary("effort"))
    }
    assert len(digests) == 3


def test_scores_about_a_factor_that_was_renamed_in_the_middle_are_compared_by_either_name(
    tmp_path: Path,
) -> None:
    """They were averaged over all levels, as if they were about the whole session."""
    answered(tmp_path, 20.0)
    for name in ("trial_results.csv", "questionnaire_scores.csv", "questionnaires.csv"):
        rows = rows_of(tmp_path / name)
        for row in rows:
            late = row["ppid"] > "P003"
            row["factor_method"] = row["factor_encoder"] if late else ""
            row["factor_encoder"] = "" if late else row["factor_encoder"]
        (tmp_path / name).write_bytes(csv_bytes(rows, tuple(rows[0])))
    page = report(tmp_path)
    told = rows_of(tmp_path / "report" / "scores.csv")
    assert {(r["factor"], r["level"], r["people"]) for r in told if r["scale"] == "effort"} == {
        (factor, level, "3") for factor in ("encoder", "method") for level in "abc"
    }
    rows = rows_of(tmp_path / "report" / "score_comparisons.csv")
    effort = [r for r in rows if r["scale"] == "effort"]
    assert len(effort) == 6 and all(r["role"] == CONFIRMATORY and r["p_holm"] for r in effort)
    assert {r["factor"] for r in effort} == {"encoder", "method"}
    assert "effort, by encoder" in page.text and "effort, by method" in page.text
