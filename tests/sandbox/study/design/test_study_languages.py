"""Words of a design in other languages, and questionnaires that have not the published wording."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest

from sandbox.study.design.checks import findings
from sandbox.study.design.design_file import parse_design
from sandbox.study.design.reading import DesignError
from sandbox.study.report.data import load_study
from sandbox.study.run.study_page import study_view
from sandbox.study.tables.codebook import codebook, columns_by_table
from sandbox.words.words import words_of_studies
from tests.sandbox.study.report.study_reports import planted
from tests.support.study_files import DESIGN, SOUND, design

CONSENT = "Your touches are recorded. You may stop at any time."
DUTCH = SOUND.replace("seed = 3", 'seed = 3\nlanguages = ["nl"]').replace(
    CONSENT, "Wij bewaren uw gegevens. U kunt altijd stoppen."
)
AUSTRIAN = SOUND.replace("seed = 3", 'seed = 3\nlanguages = ["de-AT"]').replace(
    CONSENT, "Wir zeichnen Daten auf. Sie können jederzeit aufhören."
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
        ('number = "Een getal van {low}"', "the values of"),
        ('number = "Een getal van {low} tot {hoog}"', "{high}, {low}"),
        ("next = 3", "Write a text"),
    ],
)
def test_wrong_words_are_named_with_their_line(lines: str, told: str) -> None:
    with pytest.raises(DesignError) as refused:
        design(with_words(lines))
    (mistake,) = refused.value.mistakes
    assert told in str(mistake) and mistake.line == with_words(lines).splitlines().index(lines) + 1


def test_words_of_a_language_that_nobody_reads_are_a_mistake() -> None:
    with pytest.raises(DesignError, match="unknown key"):
        design(DESIGN + '\n[words.nl]\nnext = "Volgende"\n')


def test_words_that_would_be_in_english_are_counted() -> None:
    (found,) = findings(design(with_words('next = "Volgende"')))
    assert f"{len(words_of_studies()) - 1} of them would be in English" in str(found)
    whole = "\n".join(f'"{key}" = """{text}"""' for key, text in words_of_studies().items())
    assert findings(design(with_words(whole))) == []
    assert findings(design(AUSTRIAN)) == []


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


def test_a_questionnaire_of_ones_own_says_where_its_wording_comes_from(tmp_path: Path) -> None:
    (tmp_path / "strain.toml").write_text(
        'wording = "translation"\ntitle = "Belasting"\n'
        '[[items]]\nname = "moe"\nkind = "scale"\nask = "Hoe moe bent u?"\n',
        encoding="utf-8",
    )
    added = '\n[[questionnaires]]\nfile = "strain.toml"\nname = "strain"\nat = "end"\n'
    some = parse_design(DUTCH + added, tmp_path / "design.toml")
    assert some.questionnaires[-1].wording == {"nl": "translation"}
    (tmp_path / "strain.toml").write_text('wording = "free"\ntitle = "x"\n', encoding="utf-8")
    with pytest.raises(DesignError, match="published, paraphrase"):
        parse_design(DUTCH + added, tmp_path / "design.toml")
