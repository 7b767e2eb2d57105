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
from tests.sandbox.study.report.study_reports import (
    FILES,
    Rows,
    hostile_names,
    planted,
    put,
    report,
    write,
)
from tests.support.study_files import rows_of

LOST = {"success": 0, "held": 0, "status": "timeout", "time_s": 20.0}
CHANGES: dict[str, Callable[[Rows], Rows]] = {
    "nobody succeeds": lambda rows: [{**r, **LOST} for r in rows],
    "everybody succeeds": lambda rows: [{**r, "success": 1, "held": 1} for r in rows],
    "all are excluded": lambda rows: [
        {**r, "excluded": 1, "exclusion_reason": "participant: rule x"} for r in rows
    ],
    "one person": lambda rows: [r for r in rows if r["ppid"] == "P001"],
    "one trial": lambda rows: rows[:1],
    "half finished, and one person without success": lambda rows: [
        {**r, **(LOST if r["ppid"] == "P002" else {})} for r in rows[: len(rows) // 2 + 3]
    ],
    "only practice": lambda rows: [{**r, "practice": 1} for r in rows],
    "nothing": lambda rows: [],
    "equal times": lambda rows: [{**r, "time_s": 5.0, "success": 1} for r in rows],
    "no time": lambda rows: [{**r, "time_s": 0.0} for r in rows],
    "times are missing": lambda rows: [{**r, "time_s": ""} for r in rows],
    "nobody succeeds at a level": lambda rows: [
        {**r, **(LOST if r["factor_encoder"] == "b" else {})} for r in rows
    ],
    "levels between people": lambda rows: [
        {**r, "factor_encoder": "abc"[int(r["ppid"][1:]) % 3]} for r in rows
    ],
    "one level": lambda rows: [{**r, "factor_encoder": "a", "factor_task": "x"} for r in rows],
    "one trial of each": lambda rows: [
        r for r in rows if r["repetition"] == "1" and r["factor_task"] == "task1"
    ],
    "nested with hostile names and a later attempt": lambda rows: a_later_attempt(
        [
            {**r, "factor_task": f"{r['factor_encoder']}-{r['factor_task']}"}
            for r in hostile_names(rows)
        ]
    ),
}


def a_later_attempt(rows: Rows) -> Rows:
    return [{**rows[0], "counted": 0}, {**rows[0], "attempt": 2}, *rows[1:]]


@pytest.mark.parametrize("name", CHANGES)
def test_of_any_study_there_is_a_report(tmp_path: Path, name: str) -> None:
    rows = CHANGES[name](planted(tmp_path))
    put(tmp_path, rows)
    page = report(tmp_path)
    used = [
        r
        for r in rows
        if str(r["counted"]) == "1" and str(r["practice"]) != "1" and str(r["excluded"]) != "1"
    ]
    assert f"Trials used {len(used)} " in page.text
    assert len(load_study(tmp_path).used) == len(used)
    for file in FILES:
        if file.endswith(".csv"):
            table = rows_of(tmp_path / "report" / file)
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
    fact = {"column": "conditions", "unit": "", "meaning": ", ".join(map(" / ".join, conditions))}
    rows = [
        r for r in rows if not all(r[c] == x for c, x in zip(LEVELS, is_left, strict=True) if x)
    ]
    put(tmp_path, rows)
    write(tmp_path, "codebook.csv", [{"table": "study", **fact}])
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
