"""Of any study there is a report: nobody, one person, no success, all excluded, hostile names."""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import product
from pathlib import Path

import pytest

from sandbox.study.report.data import load_study
from sandbox.study.report.exclusions import endings
from sandbox.study.report.make import make_report
from sandbox.study.report.numbers import results
from sandbox.study.report.page import Paragraph, Picture, sections
from sandbox.study.tables.column import csv_bytes
from tests.sandbox.study.report.study_reports import (
    FILES,
    Rows,
    hostile_names,
    planted,
    put,
    report,
    rows_of,
)


def nobody_succeeds(rows: Rows) -> Rows:
    return [{**r, "success": 0, "held": 0, "status": "timeout", "time_s": 20.0} for r in rows]


def everybody_succeeds(rows: Rows) -> Rows:
    return [{**r, "success": 1, "held": 1, "status": "held"} for r in rows]


def all_excluded(rows: Rows) -> Rows:
    return [{**r, "excluded": 1, "exclusion_reason": "participant: rule x"} for r in rows]


def one_person(rows: Rows) -> Rows:
    return [r for r in rows if r["ppid"] == "P001"]


def one_trial(rows: Rows) -> Rows:
    return rows[:1]


def half_finished(rows: Rows) -> Rows:
    return rows[: len(rows) // 2 + 3]


def half_finished_with_a_person_without_success(rows: Rows) -> Rows:
    return a_person_without_success(half_finished(rows))


def nested_with_hostile_names_and_a_later_attempt(rows: Rows) -> Rows:
    return a_later_attempt(nested(hostile_names(rows)))


def only_practice(rows: Rows) -> Rows:
    return [{**r, "practice": 1} for r in rows]


def nothing(rows: Rows) -> Rows:
    return []


def equal_times(rows: Rows) -> Rows:
    return [{**r, "time_s": 5.0, "success": 1} for r in rows]


def time_zero(rows: Rows) -> Rows:
    return [{**r, "time_s": 0.0} for r in rows]


def times_missing(rows: Rows) -> Rows:
    return [{**r, "time_s": ""} for r in rows]


def a_level_nobody_succeeds_with(rows: Rows) -> Rows:
    lost = {"success": 0, "status": "timeout", "time_s": 20.0}
    return [{**r, **(lost if r["factor_encoder"] == "b" else {})} for r in rows]


def a_person_without_success(rows: Rows) -> Rows:
    return [
        {**r, **({"success": 0, "status": "failed"} if r["ppid"] == "P002" else {})} for r in rows
    ]


def between_people(rows: Rows) -> Rows:
    return [{**r, "factor_encoder": "abc"[int(r["ppid"][1:]) % 3]} for r in rows]


def one_level_only(rows: Rows) -> Rows:
    return [{**r, "factor_encoder": "a", "factor_task": "x"} for r in rows]


def one_trial_of_each(rows: Rows) -> Rows:
    return [r for r in rows if r["repetition"] == "1" and r["factor_task"] == "task1"]


def nested(rows: Rows) -> Rows:
    return [{**r, "factor_task": f"{r['factor_encoder']}-{r['factor_task']}"} for r in rows]


def a_later_attempt(rows: Rows) -> Rows:
    return [{**rows[0], "counted": 0}, {**rows[0], "attempt": 2}, *rows[1:]]


@pytest.mark.parametrize(
    "change",
    [
        nobody_succeeds,
        everybody_succeeds,
        all_excluded,
        one_person,
        one_trial,
        half_finished_with_a_person_without_success,
        only_practice,
        nothing,
        equal_times,
        time_zero,
        times_missing,
        a_level_nobody_succeeds_with,
        between_people,
        one_level_only,
        one_trial_of_each,
        nested_with_hostile_names_and_a_later_attempt,
    ],
)
def test_of_any_study_there_is_a_report(tmp_path: Path, change: Callable[[Rows], Rows]) -> None:
    rows = change(planted(tmp_path))
    put(tmp_path, rows)
    page = report(tmp_path)
    used = [
        r
        for r in rows
        if str(r["counted"]) == "1" and str(r["practice"]) != "1" and str(r["excluded"]) != "1"
    ]
    assert f"Trials used {len(used)} " in page.text
    assert len(load_study(tmp_path).used) == len(used)
    for name in FILES:
        if name.endswith(".csv"):
            table = rows_of(tmp_path / "report" / name)
            assert not any(v.lower() in ("nan", "inf", "-inf") for r in table for v in r.values())


LEVELS = {"factor_encoder": ["a", "b", "c"], "factor_task": ["task1", "task2"]}


@pytest.mark.parametrize(
    "is_left", [("b", "task1"), ("b", ""), ("", "task2"), ("a", "task2")], ids=" ".join
)
def test_a_condition_or_level_without_a_trial_is_a_row_with_none(
    tmp_path: Path, is_left: tuple[str, str]
) -> None:
    rows = planted(tmp_path)
    for column, names in LEVELS.items():
        assert sorted({r[column] for r in rows}) == names
    conditions = list(product(*LEVELS.values()))
    facts = [
        {
            "table": "study",
            "column": "conditions",
            "unit": "",
            "meaning": ", ".join(map(" / ".join, conditions)),
        }
    ]
    rows = [
        r for r in rows if not all(r[c] == x for c, x in zip(LEVELS, is_left, strict=True) if x)
    ]
    put(tmp_path, rows)
    (tmp_path / "tables/codebook.csv").write_bytes(csv_bytes(facts, list(facts[0])))
    data = load_study(tmp_path)
    left = [c for c in conditions if all(x in ("", y) for x, y in zip(is_left, c, strict=True))]
    assert sorted(data.unused) == sorted(left)
    counts = endings(data)
    assert len(counts) == len(conditions)
    assert sum(sum(n.values()) for n in counts.values()) == len(data.used)
    assert sum(not any(n.values()) for n in counts.values()) == len(left)
    page = make_report(tmp_path, tmp_path / "report").read_text(encoding="utf-8")
    for name in counts:
        assert f'<th scope="row">{name}</th>' in page
    empty = r'<th scope="row">([^<]+)</th><td class="number">0</td><td class="number">0</td>'
    told = set(re.findall(empty, page))
    assert {n for n, some in counts.items() if not any(some.values())} <= told
    assert ({x for x in is_left if x} if is_left[1] == "" else set()) <= told


@pytest.mark.parametrize("people", [1, 2, 5, 6])
@pytest.mark.parametrize("apart", [False, True], ids=["all conditions", "tasks between people"])
def test_every_outcome_with_two_factors_has_an_interaction_or_says_why_not(
    tmp_path: Path, people: int, apart: bool
) -> None:
    rows = [r for r in planted(tmp_path) if r["ppid"] <= f"P{people:03d}"]
    if apart:
        rows = [r for r in rows if int(r["ppid"][1:]) % 2 == (r["factor_task"] == "task1")]
    put(tmp_path, rows)
    both = [
        section
        for section in sections(results(load_study(tmp_path)))
        if any(
            {"encoder", "task"} <= {table.caption for table in part.tables}
            for part in section.parts
            if isinstance(part, Picture)
        )
    ]
    assert len(both) >= 2 or (apart and people == 1)
    for section in both:
        has = any(
            table.caption.startswith("Interaction")
            for part in section.parts
            if isinstance(part, Picture)
            for table in part.tables
        )
        why = [p.text for p in section.parts if isinstance(p, Paragraph) and p.tone == "note"]
        assert has is (people >= 6 and not apart)
        assert has is not any("interaction of encoder and task" in text for text in why)


@pytest.mark.parametrize("success", ["0", "1"])
def test_an_axis_of_success_is_from_0_to_100_percent_where_all_are_equal(
    tmp_path: Path, success: str
) -> None:
    put(tmp_path, [{**r, "success": success} for r in planted(tmp_path)])
    text = make_report(tmp_path, tmp_path / "report").read_text(encoding="utf-8")
    svg = text[text.index('aria-label="Success of every person"') :].partition("</svg>")[0]
    ticks = re.findall(r">(\u2212?[\d.e]+)</text>", svg)
    assert [float(tick) for tick in ticks] == [0, 20, 40, 60, 80, 100]
