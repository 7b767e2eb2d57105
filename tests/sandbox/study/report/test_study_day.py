"""What one reads after a day of sessions: who stopped where, every word, and what orders carry."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.study.report.data import load_study
from sandbox.study.report.numbers import paired_differences, results, welch
from sandbox.study.report.page import Table, sections
from tests.sandbox.study.report.study_reports import LEAN, planted, put, report, write
from tests.support.planted_study import Truth


def test_every_open_answer_and_every_note_stands_there_as_it_was_written(tmp_path: Path) -> None:
    planted(tmp_path, Truth(people=3, repetitions=1))
    words = ["<b>too soft</b> & slow", "nothing\nelse", "=1+1", "😀 zu weich", "NA"]
    answers = [
        {"ppid": f"P{i % 3 + 1:03d}", "instrument": "end", "item": f"q{i // 3}", "answer": text}
        for i, text in enumerate(words)
    ]
    notes = ["phone rang", "sat down again", "wiped the screen"]
    events = [
        {"ppid": "P001", "session_num": 1, "event": event, "text": text}
        for event, text in zip(("note", "exclude", "remark"), notes, strict=True)
    ]
    write(tmp_path, "answers.csv", answers)
    write(tmp_path, "events.csv", events)
    page = report(tmp_path).text
    for text in (*words, *notes):
        assert " ".join(text.split()) in page


def test_a_session_that_went_on_and_a_screen_that_was_guessed_are_marked(tmp_path: Path) -> None:
    rows = planted(tmp_path, Truth(people=3, repetitions=1))
    marked = [{**r, "screen_measured": int(r["ppid"] != "P002")} for r in rows]
    put(tmp_path, marked, (*LEAN, "screen_measured"))
    events = [{"ppid": "P001", "session_num": 1, "event": "session_resume", "text": ""}] * 2
    write(tmp_path, "events.csv", events)
    first = sections(results(load_study(tmp_path)))[0]
    table = next(part for part in first.parts if isinstance(part, Table))
    cells = {row[0]: dict(zip(table.head, row, strict=True)) for row in table.rows}
    assert {p: (c["Resumed"], c["Screen size"]) for p, c in cells.items()} == {
        "P001": ("2", ""),
        "P002": ("", "guessed"),
        "P003": ("", ""),
    }


@pytest.mark.parametrize("balanced", [True, False])
def test_conditions_of_two_programs_are_compared_with_a_warning_unless_balanced(
    tmp_path: Path, balanced: bool
) -> None:
    rows = planted(tmp_path, Truth(people=6, repetitions=1))
    for r in rows:
        half = int(r["ppid"][1:]) <= 3 if balanced else r["factor_encoder"] == "a"
        r["states"] = 1 + half
    put(tmp_path, rows, LEAN)
    assert ("may be one between programs" in report(tmp_path).text) is not balanced


def test_what_an_order_carries_over_is_welch_s_difference_of_its_groups(tmp_path: Path) -> None:
    planted(tmp_path, Truth(people=12, times=(9.0, 9.0), tasks=(1.0,), repetitions=2))
    found = results(load_study(tmp_path))
    one, data = found.compared[0], found.data
    (factor,) = [f for f in one.values.factors if len(f.levels) > 1]
    own = paired_differences(one.values, factor, *factor.levels)
    at_first = data.used.groupby("ppid", sort=False)[factor.column].first()
    group = at_first.loc[data.ppids].to_numpy() == factor.levels[0]
    apart, _ = welch(own[group], own[~group])
    assert group.sum() == 6
    ends = f"{apart.value:.3g} s ({apart.low:.3g} to {apart.high:.3g})".replace("-", "\u2212")
    assert ends in report(tmp_path).text
