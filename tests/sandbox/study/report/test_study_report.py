"""The report on a study: what it says of odd studies, and what its files are to others."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.errors import StudyError
from sandbox.cli.main import main
from sandbox.study.report.data import load_study
from sandbox.study.report.exclusions import flow
from sandbox.study.report.make import make_report
from sandbox.study.report.numbers import results
from sandbox.study.report.page import head
from tests.sandbox.study.report.study_reports import (
    FILES,
    LEAN,
    Page,
    hostile_names,
    planted,
    put,
    report,
    write,
)
from tests.support.study_files import rows_of


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A planted study of which one participant has not finished, and its report."""
    folder = tmp_path_factory.mktemp("plain")
    planted(folder)
    people = [{"ppid": f"P{i:03d}", "complete": i != 2} for i in range(1, 7)]
    write(folder, "participants.csv", people)
    make_report(folder, folder / "report")
    return folder


def test_a_page_fetches_nothing_and_has_a_table_beside_every_picture(plain: Path) -> None:
    text = (plain / "report" / "report.html").read_text(encoding="utf-8")
    page = Page(text)
    assert not page.fetches
    assert not re.findall(r"url\((?!#)|@import|https?://(?!www\.w3\.org)", text)
    assert page.pictures >= 4
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


def test_the_title_says_whether_people_took_part(plain: Path) -> None:
    found = results(load_study(plain))
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
    people = {r["ppid"] for r in rows_of(tmp_path / "report" / "people.csv")}
    assert {"12E345", "000123", "1"} <= people


def test_levels_stand_in_the_order_of_the_design(tmp_path: Path) -> None:
    planted(tmp_path)
    about = {"column": "factor_encoder", "unit": "", "meaning": "level: c, a, b, never-used"}
    write(tmp_path, "codebook.csv", [{"table": "trials.csv", **about}])
    assert load_study(tmp_path).factor("encoder").levels == ("c", "a", "b")


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
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables/trials.csv").write_bytes(text)
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
    steps = flow(load_study(tmp_path))
    left = {s.what: s.trials for s in steps if s.remains}
    gone = sum(s.trials for s in steps if not s.remains)
    assert left["finished attempts"] == len(rows) == left["used here"] + gone
    assert len(load_study(tmp_path).used) == left["used here"]


def test_a_measure_that_was_asked_for_is_compared_by_ratios_where_it_is_above_0(
    tmp_path: Path,
) -> None:
    rows = planted(tmp_path)
    rng = np.random.default_rng(3)
    better = {"a": 0.0, "b": 0.5, "c": 1.0}
    for r in rows:
        r["object_path_m"] = float(np.exp(better[r["factor_encoder"]] + 0.1 * rng.normal()))
        r["drops"] = int(rng.integers(0, 3))
    put(tmp_path, rows, (*LEAN, "object_path_m", "drops"))
    book = [
        {"table": "trials.csv", "column": name, "unit": unit, "title": name, "meaning": ""}
        for name, unit in (("object_path_m", "m"), ("drops", ""))
    ]
    write(tmp_path, "codebook.csv", book)
    make_report(tmp_path, tmp_path / "report", ["object_path_m"])
    some = rows_of(tmp_path / "report" / "results.csv")
    pairs = {(r["first"], r["second"]): r for r in some if r["outcome"] == "object_path_m"}
    assert float(pairs["a", "c"]["low"]) < np.e < float(pairs["a", "c"]["high"])
    assert pairs["a", "c"]["kind"] == "ratio"
    assert {r["row"] for r in some if r["outcome"] == "drops"} == {"further"}


def test_a_factor_whose_levels_have_different_time_limits_is_not_compared_by_time(
    tmp_path: Path,
) -> None:
    rows = planted(tmp_path)
    limited = [{**r, "limit_s": 20.0 if r["factor_task"] == "task1" else 40.0} for r in rows]
    put(tmp_path, limited, (*LEAN, "limit_s"))
    (one,) = [c for c in results(load_study(tmp_path)).compared if c.what.name == "time_s"]
    by_factor = {pair.factor: pair for pair in one.pairs}
    assert by_factor["task"].why == "their time limits differ"
    assert by_factor["encoder"].estimate.is_known
    assert "their time limits differ" in report(tmp_path).text


def test_a_rehearsal_that_a_simulated_user_played_is_never_taken_for_people(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # As `study run --pilot --device simulated` writes it: data of a pilot.
    rows = [{**row, "mode": "pilot"} for row in planted(tmp_path)]
    nobody = "No person took part: a simulated user played all trials."
    for name, source, telling in (
        ("played", "simulated user", nobody),
        ("some", "", "A simulated user, and no person, played 1 of"),
        ("device", "device", ""),
    ):
        told = [{**row, "label_truth": source} for row in rows]
        if name == "some":
            counted = [row for row in told if row["counted"] == "1" and row["practice"] == "0"]
            counted[0]["label_truth"] = "simulated user"
            counted[1]["label_truth"] = "device"
        folder = tmp_path / name
        put(folder, told, tuple(told[0]))
        data = load_study(folder)
        assert data.rehearsed.startswith(telling) and bool(data.rehearsed) == bool(telling), name
        assert main(["study", "report", str(folder)]) == 0
        said = " ".join(capsys.readouterr().out.split())
        page = (folder / "report" / "report.html").read_text(encoding="utf-8")
        assert (data.rehearsed in said) and (data.rehearsed in page)


def test_tables_without_records_are_named_in_the_first_line_of_their_report(tmp_path: Path) -> None:
    planted(tmp_path)
    alone = "There are no records in this folder"
    assert f"planted-1, simulated {alone}" in report(tmp_path).text
    (tmp_path / "3B5G5T/S001").mkdir(parents=True)
    (tmp_path / "3B5G5T/S001/session.jsonl").write_text("")
    assert alone not in report(tmp_path).text
