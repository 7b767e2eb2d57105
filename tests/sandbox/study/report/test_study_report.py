"""The report on a study: what it says of odd studies, and what its files are to others."""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.study.record.folder import REAL, SIMULATED, StudyFolder
from sandbox.study.record.journal import journal_bytes
from sandbox.study.report.make import make_report
from sandbox.study.report.models.analysis import analyse
from sandbox.study.report.models.censored import Censored, censored_differences, fit_censored
from sandbox.study.report.models.data import load_study
from sandbox.study.report.models.intervals import Estimate
from sandbox.study.report.page import plots
from sandbox.study.report.page.formats import UNKNOWN
from sandbox.study.report.page.page import head, page
from sandbox.study.report.page.plots import lines_by_person
from sandbox.study.report.page.section_results import means_picture
from sandbox.study.run.simulate import simulate
from sandbox.study.tables.column import csv_bytes
from tests.sandbox.study.report.study_reports import (
    FILES,
    LEAN,
    Page,
    Rows,
    hostile_names,
    planted,
    put,
    report,
    rows_of,
)
from tests.support.planted_study import Truth
from tests.support.study_files import design


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A planted study of which one participant has not finished, and its report."""
    folder = tmp_path_factory.mktemp("plain")
    planted(folder)
    people = [{"ppid": f"P{i:03d}", "complete": i != 2} for i in range(1, 7)]
    (folder / "participants.csv").write_bytes(csv_bytes(people, ("ppid", "complete")))
    make_report(folder, folder / "report")
    return folder


def test_a_page_fetches_nothing_and_has_a_table_beside_every_picture(plain: Path) -> None:
    text = (plain / "report" / "report.html").read_text(encoding="utf-8")
    page = Page(text)
    assert not page.fetches
    assert not re.findall(r"url\((?!#)|@import|https?://(?!www\.w3\.org)", text)
    assert page.pictures >= 8
    assert page.tables >= page.pictures
    assert len(page.ids) == len(set(page.ids)), "every id is there once"
    used = set(re.findall(r'(?:url\(#|href="#)([^")]+)', text))
    assert used <= set(page.ids), "what is pointed to is there"
    assert "#0a0b" not in text, "every colour is one of the page's"
    assert "Not finished yet: P002." in page.text
    assert {p.name for p in (plain / "report").iterdir()} == FILES


def test_the_same_tables_make_the_same_report_to_the_byte_by_the_command_too(
    plain: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["study", "report", str(plain), "--out", str(tmp_path / "r")]) == 0
    assert str(tmp_path / "r" / "report.html") in capsys.readouterr().out.replace("\n", "")
    for name in FILES:
        assert (plain / "report" / name).read_bytes() == (tmp_path / "r" / name).read_bytes()


def test_the_command_refuses_other_folders_and_measures_that_there_are_not(
    plain: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["study", "report", str(plain / "nowhere")]) == 2
    assert main(["study", "report", str(plain), "--measure", "beauty"]) == 2
    assert "no such measure" in capsys.readouterr().err
    # A column of the report's own is no measure.
    assert main(["study", "report", str(plain), "--measure", "place of encoder"]) == 2
    assert "no such measure" in capsys.readouterr().err
    assert main(["study", "report", str(plain), "--measure", "progres"]) == 2
    assert "Did you mean progress?" in " ".join(capsys.readouterr().err.split())


def test_the_title_says_whether_people_took_part(plain: Path) -> None:
    found = analyse(load_study(plain))
    for mode in ("simulated", "pilot", "real", ""):
        told = head(replace(found, data=replace(found.data, mode=mode)))
        for kind in ("simulated", "pilot", "unknown kind"):
            assert (kind in told["title"].lower()) == (kind == (mode or "unknown kind"))
        assert ("no person took part" in told["warning"].lower()) == (mode == "simulated")
    text = Page((plain / "report" / "report.html").read_text(encoding="utf-8")).text
    assert head(found)["title"] in text[:80] and head(found)["warning"] in text


def test_data_of_two_kinds_are_refused(tmp_path: Path) -> None:
    rows = planted(tmp_path)
    put(tmp_path, [*rows[:-1], {**rows[-1], "mode": "real"}])
    with pytest.raises(StudyError, match=r"mode: data of different kinds must not be mixed"):
        make_report(tmp_path, tmp_path / "report")


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


def test_people_who_withdrew_are_counted_where_the_journal_of_the_study_tells(
    tmp_path: Path,
) -> None:
    planted(tmp_path, Truth(people=3, repetitions=1))
    assert "withdrew" not in report(tmp_path).text
    head = {"time": "2026-11-26T00:00:00.000+00:00", "clock": 0.0, "kind": "withdrawn"}
    tombs = [{**head, "ppid": name} for name in ("ABCDEF", "GHJKMN")]
    (tmp_path / "study.jsonl").write_bytes(journal_bytes(tombs))
    page = report(tmp_path)
    assert "of 3 who began; 2 more withdrew" in page.text
    assert "2 people withdrew. All their data were deleted" in page.text
    assert "ABCDEF" not in page.text
    (tmp_path / "study.jsonl").write_bytes(b"no journal\n{}\n")
    assert "withdrew" not in report(tmp_path).text


def test_too_few_people_for_an_interval_are_said_to_be_so_and_show_nothing(
    tmp_path: Path,
) -> None:
    lost = {"success": 0, "held": 0, "status": "timeout", "time_s": 20.0}
    put(
        tmp_path,
        [
            {**r, **(lost if r["factor_encoder"] != "a" and r["ppid"] != "P001" else {})}
            for r in planted(tmp_path, Truth(people=3, repetitions=2))
        ],
    )
    said = head(analyse(load_study(tmp_path)))["findings"]
    times = [sentence for sentence in said if " time than " in sentence]
    assert times and all(
        "(no interval, as there are too few people or all of them differ alike, so that "
        "nothing follows for others)" in sentence
        for sentence in times
    )
    for sentence in said:
        assert UNKNOWN not in sentence
    planted(tmp_path / "6")
    enough = head(analyse(load_study(tmp_path / "6")))["findings"]
    assert enough and not any("too few people" in sentence for sentence in enough)


def test_a_column_that_the_codebook_explains_is_in_every_file(plain: Path) -> None:
    told: dict[str, list[str]] = {}
    for row in rows_of(plain / "report" / "codebook.csv"):
        told.setdefault(row["file"], []).append(row["column"])
    for name in FILES - {"codebook.csv", "report.html", "analysis.R"}:
        with (plain / "report" / name).open(encoding="utf-8") as file:
            assert next(csv.reader(file)) == told[name]


def test_tables_open_in_pandas_as_they_are(plain: Path) -> None:
    import pandas as pd

    trials = pd.read_csv(plain / "report" / "trials.csv")
    assert trials["time_s"].dtype == float
    assert set(trials["success"]) == {0, 1}
    both = pd.read_csv(plain / "report" / "comparisons.csv")
    assert (both["low"] <= both["estimate"]).all() and (both["estimate"] <= both["high"]).all()


def test_levels_stand_in_the_order_of_the_design(tmp_path: Path) -> None:
    planted(tmp_path)
    book = [
        {
            "table": "trial_results.csv",
            "column": "factor_encoder",
            "unit": "",
            "meaning": "level: c, a, b, never-used",
        }
    ]
    (tmp_path / "codebook.csv").write_bytes(csv_bytes(book, tuple(book[0])))
    assert load_study(tmp_path).factor("encoder").levels == ("c", "a", "b")


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


def test_a_failure_that_took_no_time_changes_no_comparison_of_completion_times(
    tmp_path: Path,
) -> None:
    rows = planted(tmp_path / "all", Truth(limit=3600.0, losses=(1e-9,) * 3))
    assert {r["success"] for r in rows} == {"1"}
    some = []
    # Its time says nothing: it is as if the trial had been left out.
    for name, change in (
        ("out", {"excluded": 1}),
        ("zero", {"success": 0, "held": 0, "status": "input_ended", "time_s": "0.0"}),
    ):
        put(tmp_path / name, [{**r, **(change if i == 5 else {})} for i, r in enumerate(rows)])
        some.append(analyse(load_study(tmp_path / name)))
    out, zero = some
    assert zero.time is not None and out.time is not None
    assert zero.time.described.what.scale == "log"
    for one, other in (
        (zero.leading, out.leading),
        (zero.unseen, out.unseen),
        (zero.time.differences, out.time.differences),
    ):
        pairs = [(a.estimate.value, a.estimate.low, a.estimate.high, a.p) for a in one]
        assert np.isfinite(pairs).all() and len(pairs) == 4
        assert pairs == [
            pytest.approx((b.estimate.value, b.estimate.low, b.estimate.high, b.p)) for b in other
        ]
    text = Page(page(zero)).text
    assert "b took" in text and "e+" not in " ".join(head(zero)["findings"])


def test_a_page_says_on_which_scale_a_measure_is_compared(tmp_path: Path) -> None:
    rows = planted(tmp_path)
    for i, r in enumerate(rows):
        r["object_path_m"], r["palm_path_m"] = 0.2 + 0.01 * (i % 7), 0.01 * (i % 7)
    put(tmp_path, rows, (*LEAN, "object_path_m", "palm_path_m"))
    make_report(tmp_path, tmp_path / "report", ["object_path_m", "palm_path_m"])
    text = Page((tmp_path / "report" / "report.html").read_text(encoding="utf-8")).text
    assert text.count("Compared by ratios, from logarithms.") == 1
    assert text.count("Compared by differences in m, as not all values are above 0.") == 1


def drawn(folder: Path, rows: Rows, name: str, factors: tuple[str, str]) -> list[list[Any]]:
    """Levels, directions and dots of a study in which a level has another name than `a`."""
    levels = {"c": "c", "a": name, "b": "b"}
    listed = {"factor_encoder": levels.values(), "factor_task": ("task2", "task1")}
    book = [
        {
            "table": "trial_results.csv",
            "column": column,
            "unit": "",
            "meaning": "level: " + ", ".join(names),
        }
        for column, names in listed.items()
    ]
    folder.mkdir()
    (folder / "codebook.csv").write_bytes(csv_bytes(book, tuple(book[0])))
    columns = [c for c in LEAN if c not in listed] + [f"factor_{factor}" for factor in factors]
    changed = [{**r, "factor_encoder": levels[r["factor_encoder"]]} for r in rows]
    put(folder, changed, tuple(columns))
    data = load_study(folder)
    time = analyse(data).time
    assert time is not None
    given: list[list[str]] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plots, "dots", lambda *a: given.extend([*a[3:5], list(a[5])]) or "")
        means_picture(data, time.described, "time")
    shown, series, dots = given
    plain = {name: "a"}
    return [
        [plain.get(x, x) for x in (*data.factor("encoder").levels, *shown, *series)],
        [tuple(plain.get(x, x) for x in dot) for dot in dots],
        [
            (plain.get(d.pair.first, d.pair.first), plain.get(d.pair.second, d.pair.second))
            for d in time.differences
        ],
    ]


@pytest.mark.parametrize("factors", [("encoder", "task"), ("task", "encoder")])
@pytest.mark.parametrize("name", ["fast / soft", "fast, soft", "x, y / z", "/", " , "])
def test_levels_directions_and_dots_do_not_depend_on_the_names_of_levels(
    tmp_path: Path, name: str, factors: tuple[str, str]
) -> None:
    rows = planted(tmp_path)
    some = drawn(tmp_path / "plain", rows, "a", factors)
    assert some[0][:3] == ["c", "a", "b"]
    assert drawn(tmp_path / "named", rows, name, factors) == some


def test_scores_of_questionnaires_are_compared_within_people(tmp_path: Path) -> None:
    planted(tmp_path)
    rng = np.random.default_rng(5)
    rows = [
        {
            "ppid": f"P{i:03d}",
            "instrument": "nasa-tlx",
            "scale": "raw",
            "factor_encoder": level,
            "score": 50 + own + effect + rng.normal(),
        }
        for i in range(1, 7)
        for own in [20 * rng.normal()]
        for level, effect in (("a", 0.0), ("b", -10.0))
    ]
    (tmp_path / "questionnaire_scores.csv").write_bytes(csv_bytes(rows, tuple(rows[0])))
    page = report(tmp_path)
    assert "nasa-tlx: raw" in page.text
    (pair,) = rows_of(tmp_path / "report" / "score_comparisons.csv")
    assert float(pair["low"]) < -10.0 < float(pair["high"]) < -5.0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (b"ppid,time_s\nA,1\n", "columns are missing"),
        (b"", "not a table"),
        (b"\xff\xfe\x00", "not a table"),
        (b'a,b\n"', "not a table|columns are missing"),
    ],
)
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


def test_a_study_as_it_was_simulated_has_a_report(tmp_path: Path) -> None:
    plan = design()
    study = StudyFolder(tmp_path, plan, SIMULATED)
    simulate(study, 2, False, lambda text: None)
    page = report(study.path)
    assert page.text.startswith("quick, simulated")
    assert "contact" in page.text and "effort" in page.text
    assert json.loads((study.path / "study.json").read_text())["mode"] == "simulated"


def test_a_study_that_nobody_has_begun_has_a_report_or_a_clear_line(tmp_path: Path) -> None:
    from sandbox.study.tables.tables import rebuild_study

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


def test_means_of_every_panel_are_inside_of_the_picture() -> None:
    values = [np.array([[10.0, 12.0], [11.0, 13.0]]), np.array([[1.0, 2.0], [40.0, 60.0]])]
    means = [[Estimate(v, 0.9 * v, 1.1 * v) for v in table.mean(axis=0)] for table in values]
    svg = lines_by_person("p", "p", "s", ["a", "b"], [["x", "y"]] * 2, values, means, True)
    # What is outside of an axis is not drawn at all.
    assert len(re.findall(r"<use [^>]*stroke: var\(--paper\)", svg)) == 4


def test_one_person_has_a_page_that_compares_nothing(tmp_path: Path) -> None:
    planted(tmp_path, Truth(people=1, repetitions=2))
    page = report(tmp_path)
    assert page.ids == ["trials", "exclusions", "methods"]
    assert "These are the results of one person." in page.text
    assert page.pictures == 0
    for claim in ("95 %", "interval", "no difference", "Holm", "exploratory", "model"):
        assert claim not in page.text
    used = rows_of(tmp_path / "report" / "trials.csv")
    cells = {row["condition"] for row in used}
    assert all(cell in page.text for cell in cells)


@pytest.mark.parametrize("people", [1, 4])
def test_trials_that_were_skipped_are_told_with_whose_they_were(
    tmp_path: Path, people: int
) -> None:
    planted(tmp_path, Truth(people=people, repetitions=2))
    names = sorted({row["ppid"] for row in rows_of(tmp_path / "trial_results.csv")})
    counts = [
        {"ppid": name, "complete": "1", "trials_done": str(9 - 3 * (not i)), "trials_planned": "9"}
        for i, name in enumerate(names)
    ]
    columns = ("ppid", "complete", "trials_done", "trials_planned")
    (tmp_path / "participants.csv").write_bytes(csv_bytes(counts, columns))
    told = f"Trials that were skipped, practice included: {names[0]} 3. They have no row"
    assert told in report(tmp_path).text


def test_one_of_two_people_who_is_excluded_leaves_the_other_s_page(tmp_path: Path) -> None:
    rows = planted(tmp_path, Truth(people=2, repetitions=1))
    for row in rows:
        if row["ppid"] == "P002":
            row |= {"excluded": "1", "exclusion_reason": "fell asleep"}
    put(tmp_path, rows)
    page = report(tmp_path)
    assert "2 people began." in page.text and "excluded, fell asleep: 6" in page.text
