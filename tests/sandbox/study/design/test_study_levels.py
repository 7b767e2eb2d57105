"""`study check` looks at levels: what they set, where they meet, and whether success can differ."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.study.design.checks import findings
from sandbox.study.design.design_file import parse_design
from tests.support.study_files import SOUND, design

PLAIN = SOUND[: SOUND.index("[[questionnaires]]")]

FACTOR = 'name = "contact"\norder = "latin"\nlevels = ["hard", "soft"]\n'
TEXT = '\n[[instructions]]\nat = "{}"\nlevel = "{}"\ntext = "{}"\n'


def one(text: str, wanted: str) -> None:
    """Asserts that a design has one finding, with these words; none if there are no words."""
    read = parse_design(text, Path("design.toml"), try_out=False)
    found = [finding.mistake for finding in findings(read)]
    assert len(found) == bool(wanted), found
    assert all(wanted in mistake.what and mistake.remedy for mistake in found), found


def varied(name: str, order: str, levels: str) -> str:
    """A sound design with another factor, and more people for groups."""
    text = PLAIN.replace(FACTOR, f'name = "{name}"\norder = "{order}"\nlevels = {levels}\n')
    text = text.replace('practice_each = "contact"', f'practice_each = "{name}"')
    return text.replace("participants = 24", "participants = 60")


def same(*names: str) -> str:
    """Levels that set the same."""
    return "[" + ", ".join(f'{{name = "{name}", contact = "soft"}}' for name in names) + "]"


def test_levels_that_set_the_same_differ_by_what_is_said_before_them_alone() -> None:
    one(varied("words", "latin", same("a", "b")), "are the same: they set the same")
    told = TEXT.format("words", "a", "Be quick.") + TEXT.format("words", "b", "Take care.")
    one(varied("words", "latin", same("a", "b")) + told, "")


@pytest.mark.parametrize(
    ("levels", "wanted"),
    [
        ('["hard", {name = "usual", solid = "fingertips"}]', "by default"),
        ('["soft", {name = "usual", solid = "fingertips"}]', ""),
        ('["soft", {name = "whole", solid = "hand"}]', "several settings at once"),
        ('["hard", {name = "usual", contact = "soft"}]', ""),
        (
            '["hard", "soft", {name = "other", contact = "none", encoder = "population"}]',
            "other in contact and encoder",
        ),
        (
            '["hard", "soft", {name = "c", contact = "hard", encoder = "population"}, '
            '{name = "d", contact = "soft", encoder = "population"}]',
            "",
        ),
    ],
)
def test_every_level_differs_from_another_one_in_one_setting(levels: str, wanted: str) -> None:
    one(varied("contact", "latin", levels), wanted)


NESTED = (
    'name = "turn"\norder = "latin"\nlevels = [0, 90]\n[[factors]]\nname = "contact"\n'
    'inside = "turn"\norder = "latin"\nlevels = {{0 = {}, 90 = {}}}\n'
)


@pytest.mark.parametrize(
    ("first", "second", "wanted"),
    [
        ('["hard", "soft"]', '["none", "soft"]', "hard and none never occur in the same"),
        ('["hard"]', '["soft"]', "has one level in each level of turn"),
        ('["hard", "soft"]', '["soft", "hard"]', ""),
        ('["hard", "soft", "none"]', '["hard", "soft"]', ""),
        ('["hard", "soft"]', '["none", {name = "firm", impulse = "safe"}]', ""),
    ],
)
def test_levels_that_never_meet_are_not_compared(first: str, second: str, wanted: str) -> None:
    text = PLAIN.replace(FACTOR, NESTED.format(first, second))
    text = text.replace("practice = 1", "practice = 6")
    told = [f.mistake.what for f in findings(design(text))]
    never = [what for what in told if "never occur" in what or "one level in each" in what]
    assert len(never) == bool(wanted) and all(wanted in what for what in never), told


@pytest.mark.parametrize(
    ("encoders", "wanted"),
    [
        ('["paper", "population"]', "are the same where encoder is paper"),
        ('["population", "paper"]', "are the same where encoder is paper"),
        ('["linear", "population"]', ""),
    ],
)
def test_levels_that_are_the_same_in_a_part_of_a_design_are_told_with_that_part(
    encoders: str, wanted: str
) -> None:
    """The first combination spoke for all: these were the same, or were not, by what came first."""
    outer = f'name = "encoder"\norder = "latin"\nlevels = {encoders}\n[[factors]]\n'
    text = varied("labels", "latin", '["paper", "population"]')
    text = text.replace('encoder = "linear"\n', "").replace(
        "[[factors]]\n", "[[factors]]\n" + outer
    )
    one(text, wanted)


@pytest.mark.parametrize(
    ("times", "primary", "wanted"),
    [
        ("expected_s = 10\ntime_limit_s = 300", '"success"', "nearly all succeed"),
        ("expected_s = 10\ntime_limit_s = 300", '"time_s", "success"', ""),
        ("expected_s = 10\ntime_limit_s = 20", '"success"', ""),
        ("time_limit_s = 300", '"success"', ""),
    ],
)
def test_success_can_differ(times: str, primary: str, wanted: str) -> None:
    text = PLAIN.replace('task = "tests/support/regress_tasks.py:Quick"', 'task = "stack"')
    text = text.replace("practice = 1", f"practice = 1\n{times}")
    one(text + f"[analysis]\nprimary = [{primary}]\n", wanted)


def test_a_hand_in_the_air_rests_sooner() -> None:
    text = PLAIN.replace('encoder = "linear"', 'device = "leap"')
    text = text.replace('"tests/support/regress_tasks.py:Quick"', '"box-to-goal"')
    text = text.replace("repetitions = 2", "repetitions = 30\nexpected_s = 15")
    one(text, "with the hand in the air")
    one(text.replace('"leap"', '"touch"'), "")


@pytest.mark.parametrize(
    ("device", "levels", "wanted"),
    [
        ("leap", '["paper", "population"]', "are the same with device leap"),
        ("webcam", '["paper", "population"]', "are the same with device webcam"),
        ("touch", '["paper", "population"]', ""),
        ("leap", '[{name = "a", contact = "hard"}, {name = "b", contact = "soft"}]', ""),
    ],
)
def test_only_touches_go_through_an_encoder(device: str, levels: str, wanted: str) -> None:
    text = varied("encoder", "latin", levels)
    text = text.replace('encoder = "linear"', f'device = "{device}"')
    one(text.replace('"tests/support/regress_tasks.py:Quick"', '"box-to-goal"'), wanted)
