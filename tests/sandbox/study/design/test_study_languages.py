"""Words of a design in other languages, and questionnaires that have not the published wording."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest

from sandbox.study.design.reading import DesignError
from sandbox.study.report.data import load_study
from sandbox.study.run.study_page import study_view
from sandbox.study.tables.codebook import codebook, columns_by_table
from tests.sandbox.study.report.study_reports import planted
from tests.support.study_files import DESIGN, SOUND, design

CONSENT = "Your touches are recorded. You may stop at any time."
DUTCH = SOUND.replace("seed = 3", 'seed = 3\nlanguages = ["nl"]').replace(
    CONSENT, "Wij bewaren uw gegevens. U kunt altijd stoppen."
)


def with_words(lines: str) -> str:
    return f"{DUTCH}\n[words.nl]\n{lines}\n"


def test_a_design_has_words_of_its_own_for_its_participants() -> None:
    some = design(with_words('next = "Volgende"\n"task_box-to-goal" = "De doos"'))
    own = {"next": "Volgende", "task_box-to-goal": "De doos"}
    assert study_view(some.page, "nl").words == own
    assert study_view(some.page, "nl").language == "nl"


@pytest.mark.parametrize(
    ("lines", "told"),
    [
        ('nxt = "Volgende"', "Did you mean next"),
        ('hint_close = "Sluit"', "unknown key"),
        ('number = "Een getal van {low}"', "the placeholders of"),
        ('number = "Een getal van {low} tot {hoog}"', "{high}, {low}"),
        ("next = 3", "Write a text"),
    ],
)
def test_wrong_words_are_named_with_their_line(lines: str, told: str) -> None:
    with pytest.raises(DesignError) as refused:
        design(with_words(lines))
    (mistake,) = refused.value.mistakes
    assert told in str(mistake) and mistake.line == with_words(lines).splitlines().index(lines) + 1


def test_a_wording_that_is_not_the_published_one_is_told_in_codebook_and_report(
    tmp_path: Path,
) -> None:
    asked = '\n[[questionnaires]]\nuse = "{}"\nat = "contact"\n'
    some = design(DESIGN + asked.format("nasa-tlx-raw") + asked.format("sus"))
    assert [form.wording["en"] for form in some.questionnaires] == [
        "own",
        "paraphrase",
        "published",
    ]
    rows = csv.DictReader(io.StringIO(codebook(some, columns_by_table(some)).decode()))
    planted(tmp_path)
    told = {row["column"]: row["meaning"] for row in rows if "wording" in row["column"]}
    assert list(told) == ["wording of nasa-tlx-raw"] and "a paraphrase in en" in str(told)
    (tmp_path / "tables/codebook.csv").write_bytes(codebook(some, columns_by_table(some)))
    assert list(load_study(tmp_path).wordings) == ["nasa-tlx-raw"]
