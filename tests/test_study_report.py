"""The report on a study: what it says of odd studies, and what its files are to others."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.study.folder import REAL, SIMULATED, StudyFolder
from sandbox.study.report.censored import Censored, censored_differences, fit_censored
from sandbox.study.report.data import load_study
from sandbox.study.report.make import make_report
from sandbox.study.report.planted import COLUMNS, Truth, write_study
from sandbox.study.simulate import simulate
from sandbox.study.tables import csv_bytes
from tests.study_files import design

SMALL = Truth(people=6, repetitions=2)
FILES = {"report.html", "analysis.R", "trials.csv", "means.csv", "comparisons.csv", "models.csv",
         "contrasts.csv", "people.csv", "order.csv", "learning.csv", "scores.csv",
         "score_comparisons.csv", "exclusions.csv", "endings.csv", "codebook.csv"}  # fmt: skip

Rows = list[dict[str, Any]]


def planted(folder: Path, truth: Truth = SMALL, seed: int = 1) -> Rows:
    """A study's rows, as text, after it was written."""
    write_study(folder, truth, seed)
    return rows_of(folder / "trial_results.csv")


def rows_of(path: Path) -> Rows:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


LEAN = tuple(c for c in COLUMNS if c not in ("instant", "held", "final", "progress"))
"""Every further measure is a picture more."""


def put(folder: Path, rows: Rows, columns: tuple[str, ...] = LEAN) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "trial_results.csv").write_bytes(csv_bytes(rows, columns))


class Page(HTMLParser):
    """What is in a page: its words, ids, and everything that would fetch something."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.words: list[str] = []
        self.ids: list[str] = []
        self.fetches: list[str] = []
        self.open: list[str] = []
        self.tables = self.pictures = 0
        self._in: str = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._in = tag
        self.tables += tag == "table"
        self.pictures += tag == "svg"
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            if name in ("src", "href", "data", "action") and not (value or "").startswith("#"):
                self.fetches.append(f"{tag} {value}")
        if tag in ("script", "link", "iframe", "object", "embed", "img"):
            self.fetches.append(tag)

    def handle_data(self, data: str) -> None:
        if self._in != "style":
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def report(folder: Path) -> Page:
    text = make_report(folder, folder / "report").read_text(encoding="utf-8")
    assert "nan" not in Page(text).text.lower().split(), "what is not known is not called nan"
    return Page(text)


def test_a_page_fetches_nothing_and_has_a_table_beside_every_picture(tmp_path: Path) -> None:
    planted(tmp_path)
    path = make_report(tmp_path, tmp_path / "report")
    text = path.read_text(encoding="utf-8")
    page = Page(text)
    assert not page.fetches
    assert not re.findall(r"url\((?!#)|@import|https?://(?!www\.w3\.org)", text)
    assert page.pictures >= 8
    assert page.tables >= page.pictures
    assert len(page.ids) == len(set(page.ids)), "every id is there once"
    used = set(re.findall(r'(?:url\(#|href="#)([^")]+)', text))
    assert used <= set(page.ids), "what is pointed to is there"
    assert "#0a0b" not in text, "every colour is one of the page's"
    assert {p.name for p in (tmp_path / "report").iterdir()} == FILES


def test_the_same_tables_make_the_same_report_to_the_byte(tmp_path: Path) -> None:
    planted(tmp_path)
    for name in ("a", "b"):
        make_report(tmp_path, tmp_path / name)
    for name in FILES:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


@pytest.mark.parametrize("mode", ["simulated", "pilot", "real", ""])
def test_the_title_says_whether_people_took_part(tmp_path: Path, mode: str) -> None:
    rows = planted(tmp_path)
    put(tmp_path, [{**row, "mode": mode} for row in rows])
    page = report(tmp_path)
    title = page.text[:80].lower()
    for kind in ("simulated", "pilot", "unknown kind"):
        assert (kind in title) == (kind == (mode or "unknown kind"))
    assert ("no person took part" in page.text.lower()) == (mode == "simulated")


def test_data_of_two_kinds_are_refused(tmp_path: Path) -> None:
    rows = planted(tmp_path)
    put(tmp_path, [*rows[:-1], {**rows[-1], "mode": "real"}])
    with pytest.raises(StudyError, match=r"mode: data of different kinds must not be mixed"):
        make_report(tmp_path, tmp_path / "report")


def nobody_succeeds(rows: Rows) -> Rows:
    return [{**r, "success": 0, "held": 0, "status": "timeout", "time_s": 20.0} for r in rows]


def everybody_succeeds(rows: Rows) -> Rows:
    return [{**r, "success": 1, "held": 1, "status": "held"} for r in rows]


def all_excluded(rows: Rows) -> Rows:
    return [{**r, "excluded": 1, "exclusion_reason": "participant: rule x"} for r in rows]


def one_person(rows: Rows) -> Rows:
    return [r for r in rows if r["ppid"] == "P001"]


def two_people(rows: Rows) -> Rows:
    return [r for r in rows if r["ppid"] in ("P001", "P002")]


def one_trial(rows: Rows) -> Rows:
    return rows[:1]


def half_finished(rows: Rows) -> Rows:
    return rows[: len(rows) // 2 + 3]


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
    return [{**r, **({"success": 0, "status": "failed"} if r["ppid"] == "P002" else {})}
            for r in rows]  # fmt: skip


def one_success_of_a_level(rows: Rows) -> Rows:
    kept = next(i for i, r in enumerate(rows) if r["factor_encoder"] == "b" and r["success"] == "1")
    return [{**r, **({"success": 0, "status": "timeout", "time_s": 20.0}
                     if r["factor_encoder"] == "b" and i != kept else {})}
            for i, r in enumerate(rows)]  # fmt: skip


def between_people(rows: Rows) -> Rows:
    return [{**r, "factor_encoder": "abc"[int(r["ppid"][1:]) % 3]} for r in rows]


def one_level_only(rows: Rows) -> Rows:
    return [{**r, "factor_encoder": "a", "factor_task": "x"} for r in rows]


def one_trial_of_each(rows: Rows) -> Rows:
    return [r for r in rows if r["repetition"] == "1" and r["factor_task"] == "task1"]


def nested(rows: Rows) -> Rows:
    return [{**r, "factor_task": f"{r['factor_encoder']}-{r['factor_task']}"} for r in rows]


def hostile_names(rows: Rows) -> Rows:
    names = {"a": '<script>alert("1")</script>', "b": "_$x^, 'ü' \"q\"", "c": "=1"}
    people = {"P001": "12E345", "P002": "000123", "P003": "1"}
    return [{**r, "factor_encoder": names[r["factor_encoder"]],
             "ppid": people.get(r["ppid"], r["ppid"]), "experiment": "<b>&amp;"}
            for r in rows]  # fmt: skip


def a_later_attempt(rows: Rows) -> Rows:
    return [{**rows[0], "counted": 0}, {**rows[0], "attempt": 2}, *rows[1:]]


@pytest.mark.parametrize("change", [
    nobody_succeeds, everybody_succeeds, all_excluded, one_person, two_people, one_trial,
    half_finished, only_practice, nothing, equal_times, time_zero, times_missing,
    a_level_nobody_succeeds_with, a_person_without_success, one_success_of_a_level, between_people,
    one_level_only, one_trial_of_each, nested, hostile_names, a_later_attempt,
])  # fmt: skip
def test_of_any_study_there_is_a_report(tmp_path: Path, change: Callable[[Rows], Rows]) -> None:
    rows = change(planted(tmp_path))
    put(tmp_path, rows)
    page = report(tmp_path)
    used = [r for r in rows if str(r["counted"]) == "1" and str(r["practice"]) != "1"
            and str(r["excluded"]) != "1"]  # fmt: skip
    assert f"Trials used {len(used)} " in page.text
    assert len(rows_of(tmp_path / "report" / "trials.csv")) == len(used)
    for name in FILES:
        if name.endswith(".csv"):
            table = rows_of(tmp_path / "report" / name)
            assert not any(v.lower() in ("nan", "inf", "-inf") for r in table for v in r.values())


def test_names_from_a_study_are_words_and_never_markup(tmp_path: Path) -> None:
    put(tmp_path, hostile_names(planted(tmp_path)))
    text = make_report(tmp_path, tmp_path / "report").read_text(encoding="utf-8")
    assert "<script" not in text
    assert '<script>alert("1")</script>' in Page(text).text
    assert text.count("_$x^") > 8, "legends have it, too"
    people = {r["ppid"] for r in rows_of(tmp_path / "report" / "trials.csv")}
    assert {"12E345", "000123", "1"} <= people


def test_every_exclusion_is_stated_and_sums_agree(tmp_path: Path) -> None:
    rows = planted(tmp_path)
    for r in rows:
        if r["ppid"] == "P004":
            r |= {"excluded": 1, "exclusion_reason": "participant: rule never"}
    rows[3] |= {"excluded": 1, "exclusion_reason": "the phone rang"}
    rows[5] |= {"practice": 1}
    rows.insert(0, {**rows[0], "counted": 0})
    put(tmp_path, rows)
    page = report(tmp_path)
    assert "excluded, the phone rang" in page.text
    assert "excluded, participant: rule never" in page.text
    steps = rows_of(tmp_path / "report" / "exclusions.csv")
    left = {s["step"]: int(s["trials"]) for s in steps if s["remains"] == "1"}
    gone = sum(int(s["trials"]) for s in steps if s["remains"] == "0")
    assert left["finished attempts"] == len(rows) == left["used here"] + gone
    assert [s["participants"] for s in steps if s["step"].endswith("never")] == ["1"]
    assert len(rows_of(tmp_path / "report" / "trials.csv")) == left["used here"]


def test_who_has_not_finished_is_named(tmp_path: Path) -> None:
    planted(tmp_path)
    people = [{"ppid": f"P{i:03d}", "complete": i != 2} for i in range(1, 7)]
    (tmp_path / "participants.csv").write_bytes(csv_bytes(people, ("ppid", "complete")))
    assert "Not finished yet: P002." in report(tmp_path).text


def test_a_column_that_the_codebook_explains_is_in_every_file(tmp_path: Path) -> None:
    planted(tmp_path)
    make_report(tmp_path, tmp_path / "report")
    told: dict[str, list[str]] = {}
    for row in rows_of(tmp_path / "report" / "codebook.csv"):
        told.setdefault(row["file"], []).append(row["column"])
    for name in FILES - {"codebook.csv", "report.html", "analysis.R"}:
        with (tmp_path / "report" / name).open(encoding="utf-8") as file:
            assert next(csv.reader(file)) == told[name]


def test_tables_open_in_pandas_as_they_are(tmp_path: Path) -> None:
    import pandas as pd

    planted(tmp_path)
    make_report(tmp_path, tmp_path / "report")
    trials = pd.read_csv(tmp_path / "report" / "trials.csv")
    assert trials["time_s"].dtype == float
    assert set(trials["success"]) == {0, 1}
    both = pd.read_csv(tmp_path / "report" / "comparisons.csv")
    assert (both["low"] <= both["estimate"]).all() and (both["estimate"] <= both["high"]).all()


def test_levels_stand_in_the_order_of_the_design(tmp_path: Path) -> None:
    planted(tmp_path)
    book = [{"table": "trial_results.csv", "column": "factor_encoder", "unit": "",
             "meaning": "level: c, a, b, never-used"}]  # fmt: skip
    (tmp_path / "codebook.csv").write_bytes(csv_bytes(book, tuple(book[0])))
    make_report(tmp_path, tmp_path / "report")
    means = rows_of(tmp_path / "report" / "means.csv")
    assert [r["name"] for r in means if r["by"] == "encoder" and r["measure"] == "time_s"] == [
        "c", "a", "b"]  # fmt: skip


def test_a_measure_that_was_asked_for_is_compared_and_others_are_not(tmp_path: Path) -> None:
    rows = planted(tmp_path)
    rng = np.random.default_rng(3)
    better = {"a": 0.0, "b": 0.5, "c": 1.0}
    for r in rows:
        r["object_path_m"] = float(np.exp(better[r["factor_encoder"]] + 0.1 * rng.normal()))
        r["drops"] = int(rng.integers(0, 3))
    put(tmp_path, rows, (*LEAN, "object_path_m", "drops"))
    make_report(tmp_path, tmp_path / "report", ["object_path_m"])
    some = rows_of(tmp_path / "report" / "comparisons.csv")
    assert not [r for r in some if r["measure"] == "drops"]
    found = {(r["first"], r["second"]): r for r in some if r["measure"] == "object_path_m"}
    assert float(found["a", "c"]["low"]) < np.e < float(found["a", "c"]["high"])
    assert "drops" in {r["measure"] for r in rows_of(tmp_path / "report" / "means.csv")}
    script = (tmp_path / "report" / "analysis.R").read_text()
    assert "log(rows$object_path_m)" in script


def test_scores_of_questionnaires_are_compared_within_people(tmp_path: Path) -> None:
    planted(tmp_path)
    rng = np.random.default_rng(5)
    rows = [
        {"ppid": f"P{i:03d}", "instrument": "nasa-tlx", "scale": "raw", "factor_encoder": level,
         "score": 50 + own + effect + rng.normal()}
        for i in range(1, 7)
        for own in [20 * rng.normal()]
        for level, effect in (("a", 0.0), ("b", -10.0))
    ]  # fmt: skip
    (tmp_path / "questionnaire_scores.csv").write_bytes(csv_bytes(rows, tuple(rows[0])))
    page = report(tmp_path)
    assert "nasa-tlx: raw" in page.text
    (pair,) = rows_of(tmp_path / "report" / "score_comparisons.csv")
    assert float(pair["low"]) < -10.0 < float(pair["high"]) < -5.0


@pytest.mark.parametrize(("text", "said"), [
    (b"ppid,time_s\nA,1\n", "columns are missing"),
    (b"", "no table"),
    (b"\xff\xfe\x00", "no table"),
    (b'a,b\n"', "no table|columns are missing"),
])  # fmt: skip
def test_what_is_no_table_of_trials_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: bytes, said: str
) -> None:
    (tmp_path / "trial_results.csv").write_bytes(text)
    assert main(["study", "report", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert re.search(said, error) and error.count("\n") == 1
    assert not (tmp_path / "report").exists()


def test_a_word_in_the_place_of_a_number_is_named_with_its_row(tmp_path: Path) -> None:
    rows = planted(tmp_path)
    rows[4]["time_s"] = "soon"
    put(tmp_path, rows)
    with pytest.raises(StudyError, match=r"time_s, row 6.*soon"):
        make_report(tmp_path, tmp_path / "report")


def test_the_command_makes_a_report_of_a_folder_and_refuses_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    planted(tmp_path / "s")
    assert main(["study", "report", str(tmp_path / "s"), "--out", str(tmp_path / "r")]) == 0
    assert str(tmp_path / "r" / "report.html") in capsys.readouterr().out.replace("\n", "")
    assert main(["study", "report", str(tmp_path / "nowhere")]) == 2
    assert main(["study", "report", str(tmp_path / "s"), "--measure", "beauty"]) == 2
    assert "no such measure" in capsys.readouterr().err


def test_a_study_as_it_was_simulated_has_a_report(tmp_path: Path) -> None:
    plan = design()
    study = StudyFolder(tmp_path, plan, SIMULATED)
    simulate(study, 2, False, lambda text: None)
    page = report(study.path)
    assert page.text.startswith("quick, simulated")
    assert "contact" in page.text and "effort" in page.text
    assert json.loads((study.path / "study.json").read_text())["mode"] == "simulated"


def test_a_study_that_nobody_has_begun_has_a_report_or_a_clear_line(tmp_path: Path) -> None:
    from sandbox.study.tables import rebuild_study

    study = StudyFolder(tmp_path, design(), REAL)
    rebuild_study(study)
    page = report(study.path)
    assert "Participants used 0" in page.text
    assert io.StringIO(page.text).read().startswith("quick")


def test_more_people_make_intervals_narrower(tmp_path: Path) -> None:
    widths = []
    for people in (6, 24):
        planted(tmp_path, replace(Truth(), people=people))
        data = load_study(tmp_path)
        found = fit_censored(data)
        assert isinstance(found, Censored)
        some = censored_differences(data, found)
        widths.append(np.mean([d.estimate.high - d.estimate.low for d in some]))
    assert widths[1] < 0.75 * widths[0]
