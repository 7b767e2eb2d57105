"""The player's profile in `sandbox play`: what cannot be used, and what is learned into it."""

from __future__ import annotations

import io
import json
import time
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from models.errors import InputError
from models.person import Person
from sandbox.cli.play import PlayOptions
from sandbox.play.own_profile import Learner, with_usable_profile
from sandbox.play.page_play import PagePlay
from sandbox.play.pages import open_page
from sandbox.server.page_options import PageOptions
from sandbox.trial.logs import EventLog
from sandbox.trial.profiles import Profile, load_profile, save_profile
from sandbox.trial.trial_options import trial_settings
from tests.sandbox.play.played_page import played
from tests.support.page_client import Page

LAYOUT = ((0.0, 0.0), (0.035, -0.042), (0.06, -0.055), (0.083, -0.048), (0.104, -0.026))


MIRRORED = [[-x, y] for x, y in LAYOUT]


FAR = [[9 * x, 9 * y] for x, y in LAYOUT]


FIVE = [(f, 3.0 + x / 0.0254, 4.0 + y / 0.0254) for f, (x, y) in enumerate(LAYOUT, start=1)]
"""Id and place in inches of five touches on the page."""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "me.json"
    save_profile(Profile(Person("right", 0.9), (0.8, 1.0), "tuio", False), path)
    return path


def options(path: Path, **more: Any) -> PlayOptions:
    return PlayOptions(device="web", labels="population", profile=str(path), **more)


def usable(path: Path, **more: Any) -> tuple[PlayOptions, str]:
    """Options that go on, and what was said."""
    said = io.StringIO()
    chosen = with_usable_profile(options(path, **more), Console(file=said, width=1000))
    return chosen, said.getvalue()


@pytest.mark.parametrize(
    ("values", "says", "person"),
    [
        ({"schema": 99}, "another version", Person()),
        ({"kind": "shopping list"}, "not a profile", Person()),
        ({"hand_size": 77}, "out of range", Person()),
        ({"layouts": [FAR]}, "cannot be one hand", Person("right", 0.9)),
        ({"layouts": [MIRRORED]}, "other hand", Person("right", 0.9)),
    ],
)
def test_a_profile_that_cannot_be_used_is_one_line_and_play_goes_on_without_it(
    path: Path, values: dict[str, Any], says: str, person: Person
) -> None:
    path.write_text(json.dumps({**json.loads(path.read_text()), **values}))
    chosen, said = usable(path)
    assert says in said and len(said.splitlines()) == 1
    (hand,) = trial_settings(chosen).hands
    assert hand.layouts == () and hand.person == person
    # Runs and comparisons do not go on with other settings than those that were asked for.
    with pytest.raises(InputError, match=says):
        trial_settings(options(path))


def test_layouts_of_the_other_hand_are_left_out_and_one_line_says_so(path: Path) -> None:
    profile = Profile(Person("right", 0.9), (0.8, 1.0), "tuio", False, (LAYOUT,))
    save_profile(profile, path)
    chosen, said = usable(path, hand="left")
    assert "right hand" in said and len(said.splitlines()) == 1
    (hand,) = trial_settings(chosen).hands
    assert hand.person == Person("left", 0.9) and hand.layouts == ()
    assert usable(path) == (options(path), "")
    assert trial_settings(options(path)).hands[0].layouts == (LAYOUT,)


def touched_with_five(path: Path, learns: bool) -> None:
    """Plays a take on a page, touches with five fingers for a while, and begins another one."""
    chosen = options(path)
    learner = Learner.of(chosen, Console(quiet=True)) if learns else None
    server = open_page(PageOptions())
    on_page = PagePlay(chosen, (server,), EventLog(None), Console(quiet=True), learner)
    try:
        with played(on_page, server), Page(server.url) as page:
            number = page.until("scene")["scene"]
            for _ in range(200):
                page.touch(*FIVE)
                contacts = page.until("frame")["state"]["hands"][0]["contacts"]
                if [c["label"] for c in contacts] == [0, 1, 2, 3, 4]:
                    break
                time.sleep(0.01)
            else:
                raise AssertionError("five fingers got no names")
            page.say(type="ask", what="retry", value="")
            while page.until("scene")["scene"] == number:
                pass
    finally:
        server.close()


def test_play_leaves_a_profile_as_it_is_unless_it_is_asked_to_learn(path: Path) -> None:
    before = path.read_bytes()
    touched_with_five(path, learns=False)
    assert path.read_bytes() == before
    touched_with_five(path, learns=True)
    (layout,) = load_profile(path).layouts
    assert trial_settings(options(path)).hands[0].layouts == (layout,)
    for (x, y), (wanted_x, wanted_y) in zip(layout, LAYOUT, strict=True):
        assert x - layout[0][0] == pytest.approx(wanted_x, abs=2e-4)
        assert y - layout[0][1] == pytest.approx(wanted_y, abs=2e-4)


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"labels": "paper"}, "--labels population"),
        ({"device": "mouse"}, "fingers on a touch surface"),
        ({"device": "leap"}, "fingers on a touch surface"),
        ({"profile": "none"}, "no profile"),
        ({"device": "simulated"}, "simulated"),
    ],
)
def test_what_cannot_teach_a_profile_is_one_clear_error(
    path: Path, more: dict[str, str], says: str
) -> None:
    values: dict[str, Any] = {"device": "web", "labels": "population", "profile": str(path), **more}
    with pytest.raises(InputError, match=says):
        Learner.of(PlayOptions(**values), Console(quiet=True))
