"""Layouts of five fingers in a profile: where they are used, how they are forgotten, bad ones."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from models.errors import InputError
from models.person import Person
from sandbox.cli.hand.command import main
from sandbox.hand.profiles import Profile, load_profile, save_profile
from sandbox.trial.trial_options import TrialOptions, trial_settings

LAYOUT = ((0.0, 0.0), (0.035, -0.042), (0.06, -0.055), (0.083, -0.048), (0.104, -0.026))
MIRRORED = tuple((-x, y) for x, y in LAYOUT)
FAR = tuple((9 * x, 9 * y) for x, y in LAYOUT)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "me.json"
    save_profile(Profile(Person("left", 0.9), (0.8, 1.0), "tuio", False, (LAYOUT,)), path)
    return path


def with_value(path: Path, **values: Any) -> None:
    path.write_text(json.dumps({**json.loads(path.read_text()), **values}))


def test_layouts_of_a_profile_are_used_where_names_are_those_of_the_population(path: Path) -> None:
    def layouts(**options: Any) -> object:
        return trial_settings(TrialOptions(profile=str(path), **options)).hands[0].layouts

    assert layouts(labels="population") == (LAYOUT,)
    assert layouts(labels="paper") == ()
    assert layouts(labels="population", hand="left") == (LAYOUT,)
    assert layouts(labels="population", hand="right") == ()
    assert layouts(labels="population", hand_size=1.1) == (LAYOUT,)


def test_a_profile_shows_and_forgets_its_layouts(
    path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["show", str(path)]) == 0
    assert "1 layouts of five fingers" in capsys.readouterr().out.replace("\n", " ")
    assert main(["forget", str(path)]) == 0
    assert "0 layouts of five fingers" in capsys.readouterr().out.replace("\n", " ")
    profile = load_profile(path)
    assert profile.layouts == () and profile.person == Person("left", 0.9)


@pytest.mark.parametrize(
    ("layouts", "says"),
    [
        ([MIRRORED], "other hand"),
        ([FAR], "no hand"),
        ([LAYOUT[:4]], "five places"),
        ([LAYOUT] * 25, "at most 24"),
        ([[[0, "x"]] * 5], "a number"),
    ],
)
def test_layouts_that_cannot_be_used_are_one_clear_line_and_can_be_forgotten(
    path: Path, layouts: list[Any], says: str
) -> None:
    with_value(path, layouts=layouts)
    with pytest.raises(InputError, match=says) as raised:
        load_profile(path)
    assert str(path) in str(raised.value) and len(str(raised.value).splitlines()) == 1
    if says != "a number":
        main(["forget", str(path)])
        assert load_profile(path).person == Person("left", 0.9)
