"""Designs name every mistake; plans are balanced, and follow from design and number alone."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from models.errors import StudyError
from sandbox.study.design.conditions import combinations, run_settings
from sandbox.study.design.design import FILLED, Item
from sandbox.study.design.design_file import parse_design
from sandbox.study.design.power import detectable, power
from sandbox.study.design.reading import DesignError, TomlLines
from sandbox.study.design.session_plan import BreakStep, session_plan, trials_of
from sandbox.study.record.pseudonym import ALPHABET, new_pseudonym, read_pseudonym
from sandbox.study.run.answers import read_answer
from sandbox.study.run.forms import SimulatedForms
from sandbox.trial.settings import HandSettings
from tests.support.study_files import DESIGN, design
from tools.docs import design_fields

CROSSED = """
name = "crossed"
seed = 5
[settings]
encoder = "linear"
[[factors]]
name = "contact"
order = "latin"
levels = ["hard", "soft", "none"]
[[factors]]
name = "task"
order = "latin"
levels = ["box-to-goal", "wrench-turn"]
[trials]
repetitions = 2
[breaks]
every = 5
"""


@given(number=st.integers(1, 100))
def test_no_two_steps_have_one_name(number: int) -> None:
    for text in (DESIGN, CROSSED):
        ids = [step.id for step in session_plan(design(text), number)]
        assert len(set(ids)) == len(ids)


def test_a_session_has_its_parts_in_order() -> None:
    steps = session_plan(design(DESIGN), 1)
    block = ["trial", "trial", "trial", "form"]
    assert [step.id.split(":")[0] for step in steps] == ["consent", "form", *block, *block]
    assert [t.practice for t in trials_of(steps)] == [True, False, False, True, False, False]
    breaks = [s.id for s in session_plan(design(CROSSED), 1) if isinstance(s, BreakStep)]
    assert breaks == ["break:5", "break:10"]


def test_repetitions_go_round_inside_of_a_factor_where_asked() -> None:
    rounds = design(CROSSED.replace("[trials]", '[trials]\nrepeat_inside = "contact"'))
    trials = trials_of(session_plan(rounds, 1))[:4]
    assert len({t.levels["contact"] for t in trials}) == 1
    assert [t.repetition for t in trials] == [1, 1, 2, 2]
    assert len({t.levels["task"] for t in trials[:2]}) == 2
    assert len({t.block for t in trials}) == 1


def test_nested_levels_occur_only_where_they_belong() -> None:
    text = CROSSED.replace(
        'order = "latin"\nlevels = ["box-to-goal", "wrench-turn"]',
        'inside = "contact"\n'
        'levels = {hard = ["stack"], soft = ["box-to-goal", "wrench-turn"], none = ["stack"]}',
    )
    found = [tuple(x.name for x in c.values()) for c in combinations(design(text))]
    assert found == [
        ("hard", "stack"),
        ("soft", "box-to-goal"),
        ("soft", "wrench-turn"),
        ("none", "stack"),
    ]


def test_a_level_may_set_several_things() -> None:
    text = CROSSED.replace(
        '["hard", "soft", "none"]',
        '[{name = "gentle", contact = "soft", impulse = "safe"}, "hard"]',
    )
    trial = next(
        t for t in trials_of(session_plan(design(text), 1)) if t.levels["contact"] == "gentle"
    )
    settings = run_settings(trial.values, trial.seed, "left", 1.1)
    assert (settings.physics.contact, settings.physics.impulse) == ("soft", 0.5)
    assert settings.hands == (HandSettings("left", 1.1),) and settings.pipeline.encoder == "linear"


NAMES = [
    *(('name = "age"', f'name = "{name}"', name) for name in FILLED),
    ('name = "effort"\nat', 'name = "demographics"\nat', "questions about the person"),
    ("seed = 3\n", 'seed = 3\nlanguages = ["pt_BR"]\n', "'pt_BR' is not a language tag"),
    ('"hard", "soft"', '{name = "a, b", contact = "soft"}, "hard"', "'a, b' contains ', '"),
    ('"hard", "soft"', '{name = "a / b", contact = "soft"}, "hard"', "'a / b' contains ' / '"),
]


@pytest.mark.parametrize(("sound", "wrong", "told"), NAMES)
def test_a_name_that_tables_cannot_tell_from_another_is_refused_and_a_begun_study_opens(
    sound: str, wrong: str, told: str
) -> None:
    text = DESIGN.replace(sound, wrong, 1)
    assert text != DESIGN
    with pytest.raises(DesignError) as caught:
        design(text)
    (mistake,) = caught.value.mistakes
    assert told in mistake.what and mistake.remedy
    assert text.splitlines()[mistake.line - 1] in wrong or "levels" in mistake.where
    assert parse_design(text, Path("design.toml"), try_out=False).text == text


@pytest.mark.parametrize("text", ["name = ", "\x00", "[[factors]\n", "", "factors = 3", "name = 1"])
def test_what_is_no_design_is_refused(text: str) -> None:
    with pytest.raises(DesignError):
        parse_design(text, Path("x.toml"))


@example(n=3, tests=300, between=False)
@example(n=4, tests=100, between=True)
@example(n=4, tests=90, between=False)
@settings(max_examples=40, deadline=None)
@given(n=st.integers(1, 200), tests=st.integers(1, 10_000), between=st.booleans())
def test_what_is_detected_is_a_number_or_infinite(n: int, tests: int, between: bool) -> None:
    found = detectable(n, tests, between)
    assert found > 0.0
    if found < float("inf"):
        assert power(found, n, 0.05 / tests, between) == pytest.approx(0.8, abs=1e-3)


@given(st.integers(0, 5), st.sampled_from(ALPHABET))
def test_a_slip_in_a_pseudonym_is_seen(place: int, sign: str) -> None:
    name = new_pseudonym()
    assert read_pseudonym(f" {name.lower()} ") == name
    wrong = name[:place] + sign + name[place + 1 :]
    if wrong != name:
        with pytest.raises(StudyError, match="checksum"):
            read_pseudonym(wrong)


def test_two_tasks_of_one_name_are_refused_as_tables_could_not_tell_them_apart() -> None:
    quick, worse = (f"tests/support/regress_tasks.py:{kind}" for kind in ("Quick", "Worse"))
    text = CROSSED.replace('"wrench-turn"', f'"{quick}"')
    design(text)
    design(text.replace('"box-to-goal"', f'"./{quick}"'))
    with pytest.raises(DesignError, match=rf"factors\[2\].levels: .*{quick}: another of the tasks"):
        design(text.replace('"box-to-goal"', f'"{worse}"'))


@pytest.mark.parametrize("name", ["quick\\n", "qui\\nck", "\\nquick"])
def test_a_line_break_is_no_part_of_a_name(name: str) -> None:
    with pytest.raises(DesignError, match="name: got"):
        design(DESIGN.replace('"quick"', f'"{name}"', 1))


@pytest.mark.parametrize("space", ["\u2028", "\u2029", "\u0085"])
def test_only_line_breaks_of_toml_begin_a_line(space: str) -> None:
    lines = TomlLines(f'title = "a{space}b"\n[settings]\ntask = "x"')
    assert lines.of(("settings", "task")) == 3


@given(
    low=st.integers(-20, 20), steps=st.integers(1, 12), step=st.sampled_from([0.1, 0.25, 1.0, 3.0])
)
def test_simulated_answers_reach_both_ends_of_a_scale_and_are_answers_to_it(
    low: int, steps: int, step: float
) -> None:
    first = round(low * step, 10)
    item = Item("a", "scale", {}, low=first, high=round(first + steps * step, 10), step=step)
    answers = {SimulatedForms(seed)._answer("end", item) for seed in range(40 * steps)}
    for answer in answers:
        assert read_answer(item, str(answer)) == answer
    assert {min(answers), max(answers)} == {item.low, item.high}


def test_the_page_of_keys_is_what_the_reader_has() -> None:
    assert design_fields.PAGE.read_text(encoding="utf-8") == design_fields.page()
