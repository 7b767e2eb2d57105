"""What a study tests is one family, and what is exploratory has no p value."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sandbox.study.design.design_file import parse_design
from sandbox.study.design.questionnaires import score
from sandbox.study.report.data import load_study
from sandbox.study.report.numbers import CONFIRMATORY, EXPLORATORY, Pair, holm, results
from sandbox.study.tables.codebook import codebook, columns_by_table
from tests.sandbox.study.report.study_reports import planted, put, report, write
from tests.support.study_files import DESIGN, rows_of

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
    write(folder, "scores.csv", rows)
    write(folder, "answers.csv", items)
    made = parse_design(design, Path("design.toml"), try_out=False)
    book = codebook(made, columns_by_table(made))
    (folder / "tables/codebook.csv").write_bytes(book)


def confirmed(folder: Path) -> dict[str, list[Pair]]:
    """The pairs that are tested, by outcome."""
    found = results(load_study(folder)).compared
    return {c.what.name: list(c.pairs) for c in found if c.role == CONFIRMATORY and c.pairs}


def test_all_that_is_tested_is_one_family(tmp_path: Path) -> None:
    answered(tmp_path)
    found = confirmed(tmp_path)
    # Three pairs of encoders and one of tasks; questionnaires are about encoders.
    assert {name: len(some) for name, some in found.items()} == {
        "time_s": 4,
        "success": 4,
        "effort": 3,
    }
    pairs = [pair for some in found.values() for pair in some]
    known = sum(p.p == p.p for p in pairs)
    untested = sum(p.p != p.p and not p.why for p in pairs)
    assert [p.p_holm for p in pairs] == holm([p.p for p in pairs], untested)
    assert f"{known} tests" in report(tmp_path).text


def test_scores_that_are_lost_make_no_other_difference_more_certain(tmp_path: Path) -> None:
    answered(tmp_path)
    before = confirmed(tmp_path)
    # Five people are left with a score, too few for its test.
    rows = rows_of(tmp_path / "tables/scores.csv")
    write(tmp_path, "scores.csv", [row for row in rows if row["ppid"] != "P001"])
    after = confirmed(tmp_path)
    assert all(p.p != p.p for p in after["effort"])
    for old, new in zip(before["time_s"], after["time_s"], strict=True):
        assert new.p == old.p
        assert new.p_holm >= old.p_holm


def test_of_a_questionnaire_its_score_is_tested_and_neither_other_scales_nor_questions(
    tmp_path: Path,
) -> None:
    answered(tmp_path)
    assert "mental" in report(tmp_path).text
    rows = rows_of(tmp_path / "report" / "results.csv")
    assert {r["outcome"] for r in rows if r["row"] == "pair"} == {"time_s", "success", "effort"}
    # Although every answer differs.
    assert {r["row"] for r in rows if r["outcome"] == "effort: mental"} == {"further"}


def test_a_score_that_nobody_has_is_not_replaced_by_the_next_scale(tmp_path: Path) -> None:
    answered(tmp_path)
    rows = rows_of(tmp_path / "tables/scores.csv")
    for row in rows:
        row["score"] = "" if row["scale"] == "effort" else row["score"]
    write(tmp_path, "scores.csv", rows)
    assert set(confirmed(tmp_path)) == {"time_s", "success"}


def test_of_whom_the_experimenter_excluded_no_answer_is_described(tmp_path: Path) -> None:
    answered(tmp_path)
    about = [{"ppid": f"P{i:03d}", "excluded": int(i == 2)} for i in range(1, 7)]
    write(tmp_path, "participants.csv", about)
    # The person had begun, and had no trial yet that counts.
    rows = [row for row in rows_of(tmp_path / "tables/trials.csv") if row["ppid"] != "P002"]
    put(tmp_path, rows)
    (pair, *_) = confirmed(tmp_path)["effort"]
    assert pair.people == 5


def test_with_primary_outcomes_only_these_are_tested(tmp_path: Path) -> None:
    answered(tmp_path, 20.0, with_primary("effort"))
    page = report(tmp_path)
    assert set(confirmed(tmp_path)) == {"effort"}
    rows = rows_of(tmp_path / "report" / "results.csv")
    times = [r for r in rows if r["outcome"] == "time_s" and r["row"] == "pair"]
    assert {r["role"] for r in times} == {EXPLORATORY} and all(r["low"] for r in times)
    assert not any(r["p"] or r["p_holm"] for r in times)
    assert "Effort, b against a" in page.text or "effort, b against a" in page.text
    assert "Time to success, b against a:" not in page.text
    assert "The design names effort as primary; only these are tested: 3 tests" in page.text


def test_a_questionnaire_of_one_question_that_is_primary_has_its_answer_as_its_score() -> None:
    design = parse_design(with_primary("calm"), Path("design.toml"), try_out=False)
    (form,) = [form for form in design.questionnaires if form.name == "calm"]
    assert [score(scale, {"calm": 63.0}).value for scale in form.scales] == [63.0]
    plain = parse_design(SCALED, Path("design.toml"), try_out=False)
    assert not next(form for form in plain.questionnaires if form.name == "calm").scales


def test_scores_about_a_factor_that_was_renamed_in_the_middle_are_compared_by_either_name(
    tmp_path: Path,
) -> None:
    """They were averaged over all levels, as if they were about the whole session."""
    answered(tmp_path, 20.0)
    for name in ("trials.csv", "scores.csv", "answers.csv"):
        rows = rows_of(tmp_path / "tables" / name)
        for row in rows:
            late = row["ppid"] > "P003"
            row["factor_method"] = row["factor_encoder"] if late else ""
            row["factor_encoder"] = "" if late else row["factor_encoder"]
        write(tmp_path, name, rows)
    pairs = confirmed(tmp_path)["effort"]
    named = {p.factor: p.people for p in pairs if {p.first, p.second} == {"a", "b"}}
    assert named == {"encoder": 3, "method": 3}
