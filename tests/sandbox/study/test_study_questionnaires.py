"""Questionnaires score as published, ask as designed, and never fill in what was not answered."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.study.design.design import Form
from sandbox.study.design.design_file import parse_design
from sandbox.study.design.questionnaires import arranged, instruments, score, tally
from sandbox.study.design.reading import DesignError
from tests.support.study_files import DESIGN, design

TLX = ("mental", "physical", "temporal", "performance", "effort", "frustration")


def form_of(use: str) -> Form:
    return design(DESIGN + f'[[questionnaires]]\nuse = "{use}"\nat = "contact"\n').questionnaires[1]


def test_sus_gives_the_score_of_brookes_own_example() -> None:
    # Brooke 1996: contributions 4 1 1 4 1 2 1 1 4 3, together 22, times 2.5.
    given = (5, 4, 2, 1, 2, 3, 2, 4, 5, 2)
    answers = {f"sus-{i}": value for i, value in enumerate(given, start=1)}
    found = score(form_of("sus").scales[0], answers)
    assert found.value == 55.0 and found.missing == 0


@given(st.lists(st.integers(-3, 3), min_size=8, max_size=8))
def test_the_short_ueq_is_the_means_of_its_halves_and_of_all(given: list[int]) -> None:
    form = form_of("ueq-s")
    assert [(i.low, i.high, i.step) for i in form.items] == [(-3.0, 3.0, 1.0)] * 8
    answers = {item.name: value for item, value in zip(form.items, given, strict=True)}
    found = {scale.name: score(scale, answers).value for scale in form.scales}
    halves = {"pragmatic": sum(given[:4]) / 4, "hedonic": sum(given[4:]) / 4}
    assert found == pytest.approx({"overall": sum(given) / 8, **halves})
    assert all(scale.range == (-3.0, 3.0) for scale in form.scales)


RANK = ("physical", "performance", "frustration", "effort", "mental", "temporal")
"""Items from the least to the most often chosen one; but frustration beats mental demand."""


@pytest.mark.parametrize(
    ("ratings", "total", "rounded"),
    [((30, 15, 60, 40, 40, 30), 640, 43), ((30, 25, 70, 50, 30, 50), 730, 49)],
)
def test_weighted_tlx_is_the_sum_of_ratings_by_tallies_over_fifteen(
    ratings: tuple[int, ...], total: int, rounded: int
) -> None:
    # Two tasks of one person, compared with the tallies MD 3, PD 0, TD 5, OP 1, EF 3, FR 3.
    weights = dict(zip(TLX, (3, 0, 5, 1, 3, 3), strict=True))
    form = form_of("nasa-tlx")
    answers: dict[str, object] = dict(zip(TLX, ratings, strict=True))
    for pair in (item for item in form.items if item.kind == "choice"):
        answers[pair.name] = max(pair.choices, key=RANK.index)
    answers["mental-frustration"] = "frustration"
    scale = form.scales[0]
    assert tally(scale, answers) == weights
    found = score(scale, answers).value
    assert found == pytest.approx(total / 15) and round(found) == rounded


@pytest.mark.parametrize("use", sorted(instruments()))
def test_an_answer_that_is_missing_gives_no_score_and_says_so(use: str) -> None:
    form = form_of(use)
    whole = {i.name: i.choices[0] if i.choices else i.low for i in form.items}
    for scale in form.scales:
        assert score(scale, whole).value is not None and not score(scale, whole).missing
        used = (*scale.items, *scale.pairs)
        assert score(scale, {**whole, used[-1]: None}).value is None
        assert score(scale, {k: v for k, v in whole.items() if k not in used}).missing == len(used)


@given(st.integers(0, 2**32))
def test_shuffling_loses_no_item_and_keeps_what_choices_are_called(seed: int) -> None:
    form = form_of("nasa-tlx")
    found = arranged(form, seed)
    assert sorted(i.name for i in found.items) == sorted(i.name for i in form.items)
    before = {i.name: i for i in form.items}
    for item in found.items:
        for choice in item.choices:
            assert item.called(choice, "en") == before[item.name].called(choice, "en")
    plain = replace(form, items=tuple(replace(i, shuffle=False) for i in form.items))
    assert arranged(plain, seed) == plain


OWN = """
title.ja = "いまの課題について"
[[items]]
name = "tired"
kind = "scale"
low = 1
high = 7
ask.ja = "どのくらい疲れましたか。"
low_means.ja = "全く疲れていない"
high_means.ja = "とても疲れた"
optional = true
[[items]]
name = "calm"
kind = "scale"
low = 1
high = 7
ask.ja = "どのくらい落ち着いていましたか。"
[[scales]]
name = "strain"
rule = "mean"
items = ["tired", "calm"]
reverse = ["calm"]
"""
JAPANESE = DESIGN.split("[[questionnaires]]")[0].replace("seed = 3", 'seed = 3\nlanguages = ["ja"]')


def own(tmp_path: Path, text: str) -> Form:
    (tmp_path / "strain.toml").write_text(text, encoding="utf-8")
    added = '[[questionnaires]]\nname = "strain"\nfile = "strain.toml"\nat = "contact"\n'
    return parse_design(JAPANESE + added, tmp_path / "design.toml").questionnaires[0]


def test_a_questionnaire_of_ones_own_is_scored_by_its_rules_in_any_script(tmp_path: Path) -> None:
    form = own(tmp_path, OWN)
    assert form.items[0].ask["ja"] == "どのくらい疲れましたか。"
    assert score(form.scales[0], {"tired": 6, "calm": 3}).value == (6 + 5) / 2
    assert form.scales[0].range == (1, 7)
    # Keys of all items are written once, and an item may have its own.
    ends = "low = 1\nhigh = 7\n"
    shared = f"[every_item]\n{ends}ask.ja = '?'\n" + OWN.replace(ends, "").split("\n", 2)[2]
    title = OWN.split("\n", 2)[1]
    assert own(tmp_path, f"{title}\n{shared}").items == form.items


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ('reverse = ["calm"]', 'reverse = ["claim"]', "'claim' is not among the items"),
        ('rule = "mean"', 'rule = "median"', "got 'median'"),
        ('rule = "mean"', 'rule = "weighted"', "require each other"),
        ('items = ["tired", "calm"]', 'items = ["tired", "sleep"]', "not an item of kind scale"),
        ('name = "calm"', 'name = "tired"', "used twice"),
        (
            "[[scales]]",
            '[[scales]]\nname = "strain"\nitems = ["calm"]\n[[scales]]',
            "'strain' is used twice",
        ),
        ("[[scales]]", "[[scale]]", "Did you mean scales"),
        ("low = 1\nhigh = 7", "low = 8\nhigh = 7", "not below"),
        ("high = 7", "high = 7\nstep = 4", "do not reach 7"),
        ("title.ja", "title.en", "missing in ja"),
        ("title.ja", "every_item = 3\ntitle.ja", "Write it as a table"),
    ],
)
def test_a_mistake_in_a_questionnaires_file_is_told_with_file_and_line(
    tmp_path: Path, old: str, new: str, what: str
) -> None:
    with pytest.raises(DesignError) as error:
        own(tmp_path, OWN.replace(old, new, 1))
    assert what in str(error.value) and "strain.toml, line " in str(error.value)


def test_two_scales_of_one_name_are_refused_in_a_design_and_do_not_close_a_study() -> None:
    twice = '[[questionnaires.scales]]\nname = "s"\nrule = "mean"\nitems = ["effort"]\n' * 2
    with pytest.raises(DesignError, match="'s' is used twice") as caught:
        design(DESIGN + twice)
    (mistake,) = caught.value.mistakes
    assert mistake.line == len((DESIGN + twice).splitlines()) - 2 and mistake.remedy
    # Whoever has begun with it must be able to export the data, and to delete those of a person.
    begun = parse_design(DESIGN + twice, Path("design.toml"), try_out=False)
    assert len(begun.questionnaires[0].scales) == 2


@pytest.mark.parametrize(
    "name",
    ["../strain.toml", "/etc/passwd", "design.toml", "./design.toml", "Design.toml", "strain.txt"],
)
def test_a_file_from_elsewhere_is_refused(tmp_path: Path, name: str) -> None:
    added = f'[[questionnaires]]\nname = "strain"\nfile = "{name}"\nat = "end"\n'
    for there in ("design.toml", "Design.toml", "strain.toml"):
        (tmp_path / there).write_text(OWN, encoding="utf-8")
    with pytest.raises(DesignError):
        parse_design(JAPANESE + added, tmp_path / "design.toml")


def test_another_text_of_a_questionnaire_is_another_design(tmp_path: Path) -> None:
    added = '[[questionnaires]]\nname = "strain"\nfile = "strain.toml"\nat = "end"\n'
    digests = set()
    for high in (7, 9):
        (tmp_path / "strain.toml").write_text(OWN.replace("high = 7", f"high = {high}"))
        digests.add(parse_design(JAPANESE + added, tmp_path / "design.toml").digest)
    assert len(digests) == 2
