"""`sandbox hand measure`, `show` and `forget`: a profile is measured, used and forgotten."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.person.hand_size import REST, STILL, SpreadCollector
from models.arithmetic import Array
from models.errors import InputError
from models.frames import Contact, TouchFrame
from models.person import HANDS, TURNS, Person
from models.surface import Surface
from sandbox.cli.hand.command import main
from sandbox.cli.play import PlayOptions
from sandbox.devices.files.frame_file import frame_record, header_record
from sandbox.devices.simulated.spreads import SimulatedSpreads
from sandbox.trial.driver import open_trial, play_trial
from sandbox.trial.profiles import Profile, default_path, load_profile, save_profile
from sandbox.trial.settings import HandSettings, Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings

LAYOUT = np.array([(0.03, 0.09), (0.06, 0.05), (0.08, 0.04), (0.10, 0.05), (0.12, 0.07)])


def frame(now: float, xy: np.ndarray, first: int = 0) -> TouchFrame:
    return TouchFrame(
        now, tuple(Contact(first + i, float(x), float(y)) for i, (x, y) in enumerate(xy))
    )


def play(collector: SpreadCollector, *parts: tuple[float, np.ndarray, int]) -> None:
    """Parts of a second in which touches (k, 2) with ids from a first one on are down."""
    now = 0.0
    for seconds, xy, first in parts:
        for _ in range(round(seconds / 0.01)):
            collector.step(frame(now, xy, first))
            now += 0.01


def test_each_rest_of_five_fingers_counts_once_and_at_its_place() -> None:
    collector = SpreadCollector()
    play(
        collector,
        (2.0, LAYOUT, 0),
        (0.1, LAYOUT[:2], 0),
        (1.0, LAYOUT + 0.01, 7),
        (0.1, LAYOUT[:0], 0),
    )
    assert len(collector.layouts) == 2
    np.testing.assert_allclose(collector.layouts[0], LAYOUT)
    np.testing.assert_allclose(collector.layouts[1], LAYOUT + 0.01)


@pytest.mark.parametrize(
    "parts",
    [
        [(REST - 0.05, LAYOUT, 0)],
        [(3.0, LAYOUT[:4], 0)],
        [(3.0, np.vstack([LAYOUT, LAYOUT[:1] + 0.03]), 0)],
        [(0.2, LAYOUT + i * 1.1 * STILL, 0) for i in range(9)],
        [(0.3, LAYOUT, 0), (0.3, LAYOUT, 9), (0.3, LAYOUT, 18)],
    ],
    ids=["too short", "four fingers", "six touches", "moving", "other fingers"],
)
def test_what_is_no_rest_of_five_fingers_is_not_counted(
    parts: list[tuple[float, Array, int]],
) -> None:
    collector = SpreadCollector()
    play(collector, *parts)
    assert not collector.layouts


def test_a_hand_that_slides_into_another_spread_without_lifting_counts_once() -> None:
    collector = SpreadCollector()
    play(collector, (1.0, LAYOUT, 0), (1.0, LAYOUT * 1.2, 0))
    assert len(collector.layouts) == 1


@given(jitter=st.lists(st.floats(-0.45, 0.45), min_size=10, max_size=10))
def test_trembling_fingers_rest(jitter: list[float]) -> None:
    collector = SpreadCollector()
    shaken = LAYOUT + STILL * np.array(jitter).reshape(5, 2)
    play(collector, *[(0.01, xy, 0) for _ in range(40) for xy in (LAYOUT, shaken)])
    assert len(collector.layouts) == 1
    assert np.abs(collector.layouts[0] - LAYOUT).max() < STILL


def test_playing_with_ones_own_fingers_uses_ones_own_profile(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setattr(sys, "platform", "linux")
    assert PlayOptions(device="tuio").with_own_profile().profile is None
    save_profile(Profile(Person("left", 0.9), (0.8, 1.0), "tuio", False), default_path())
    assert PlayOptions(device="tuio").with_own_profile().profile == "default"
    for other in ("mouse", "simulated", str(default_path())):
        assert PlayOptions(device=other).with_own_profile().profile is None
    assert PlayOptions(device="tuio", profile="none").with_own_profile().profile == "none"
    assert trial_settings(TrialOptions(profile="default")).hands[0].person == Person("left", 0.9)
    assert trial_settings(TrialOptions(profile="none")).hands[0].person == Person()


def test_a_recording_of_five_fingers_in_three_spreads_gives_the_size_of_the_hand_in_it(
    tmp_path: Path,
) -> None:
    recorded = tmp_path / "spreads.jsonl"
    person = Person("left", 1.12)
    play_trial(
        Settings(hands=(HandSettings("left"),)),
        (lambda task, surface: SimulatedSpreads(person, surface, 3),),
        record=recorded,
        about={"device": "simulated", "user": {"kind": "spreads"}},
    )
    out = tmp_path / "p.json"
    assert main(["measure", "--device", str(recorded), "--out", str(out)]) == 0
    profile = load_profile(out)
    assert profile.person.hand == "left" and profile.simulated
    assert profile.interval[0] < 1.12 < profile.interval[1]
    assert 1 <= len(profile.layouts) <= 3


def touches_of_spreads(path: Path, surface: Surface, tells: bool = True) -> Path:
    """Writes three spreads of a hand of 1.12 as `sandbox touches record` does."""
    device = SimulatedSpreads(Person("right", 1.12), surface, 3)
    first = header_record(surface, "tuio")
    if not tells:
        # As files were before headers told whether the size was known.
        del first["surface_calibrated"]
    frames = (frame_record(frame) for tick in range(1500) for frame in device.poll(tick / 60))
    path.write_text("".join(json.dumps(line) + "\n" for line in (first, *frames)))
    return path


@pytest.mark.parametrize(
    ("guessed", "tells", "size", "says"),
    [
        (False, True, [], None),
        (False, False, ["--surface", "ipad2"], None),
        (False, False, [], "Measure"),
        (True, True, [], "Record again"),
        (True, True, ["--surface", "ipad2"], "Record again"),
    ],
)
def test_a_file_of_touches_measures_a_hand_where_its_size_is_known_and_no_guess(
    guessed: bool, tells: bool, size: list[str], says: str | None, tmp_path: Path
) -> None:
    surface, out = Surface(calibrated=not guessed), tmp_path / "p.json"
    touches = touches_of_spreads(tmp_path / "touches.jsonl", surface, tells)
    words = ["measure", "--device", str(touches), "--out", str(out), *size]
    if says is None:
        assert main(words) == 0
        low, high = load_profile(out).interval
        assert low < 1.12 < high
    else:
        with pytest.raises(InputError, match=says):
            main(words)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--device", "mouse"], "mouse"),
        (["--device", "web"], "cannot be measured with this device"),
        (["--device", "leap-simulated"], "cannot be measured with this device"),
        (["--device", "webxr-simulated"], "cannot be measured with this device"),
        (["--device", "tuio"], "--surface"),
        (["--device", "nothing-there"], "nothing-there"),
        (["--device", "simulated", "--hand-size", "7"], "--hand-size"),
        (["--device", "simulated", "--seconds", "nan"], "--seconds"),
        (["--device", "simulated", "--out", "/dev/null/p.json"], "no such folder"),
        (["--device", "simulated", "--out", "."], "this is a folder"),
        (["--device", "simulated", "--surface", "1x1in"], "spreads"),
    ],
)
def test_what_cannot_be_calibrated_is_one_clear_error(
    arguments: list[str], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    with pytest.raises(InputError, match=says):
        main(["measure", *arguments])


@given(
    person=st.builds(Person, st.sampled_from(HANDS), st.floats(0.6, 1.6), st.sampled_from(TURNS)),
    interval=st.tuples(st.floats(0.1, 1.0), st.floats(1.0, 3.0)),
    device=st.text(max_size=20),
    simulated=st.booleans(),
    spreads=st.lists(st.floats(0.8, 1.2), max_size=3),
)
def test_a_profile_survives_its_file(
    tmp_path_factory: pytest.TempPathFactory,
    person: Person,
    interval: tuple[float, float],
    device: str,
    simulated: bool,
    spreads: list[float],
) -> None:
    path = tmp_path_factory.mktemp("profile") / "p.json"
    low, high = (person.hand_size * bound for bound in interval)
    layouts = tuple(tuple(map(tuple, (LAYOUT * s).tolist())) for s in spreads)
    profile = Profile(person, (low, high), device, simulated, layouts)
    save_profile(profile, path)
    assert load_profile(path) == profile


@pytest.mark.parametrize(
    "task, device", [("carry-together", "simulated"), ("stack", "leap-simulated")]
)
def test_a_recording_of_two_hands_or_of_one_in_the_air_is_no_rest_of_five_fingers(
    task: str, device: str, tmp_path: Path
) -> None:
    chosen = trial_settings(TrialOptions(task=task, device=device))
    recorded = tmp_path / "run.jsonl"
    with open_trial(chosen, record=recorded) as trial:
        trial.session.advance()
        trial.end()
    with pytest.raises(InputError):
        main(["measure", "--device", str(recorded), "--out", str(tmp_path / "p.json")])


FIVE = ((0.0, 0.0), (0.035, -0.042), (0.06, -0.055), (0.083, -0.048), (0.104, -0.026))
MIRRORED = tuple((-x, y) for x, y in FIVE)
FAR = tuple((9 * x, 9 * y) for x, y in FIVE)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "me.json"
    save_profile(Profile(Person("left", 0.9), (0.8, 1.0), "tuio", False, (FIVE,)), path)
    return path


def with_value(path: Path, **values: Any) -> None:
    path.write_text(json.dumps({**json.loads(path.read_text()), **values}))


def test_layouts_of_a_profile_are_used_where_names_are_those_of_the_population(path: Path) -> None:
    def layouts(**options: Any) -> object:
        return trial_settings(TrialOptions(profile=str(path), **options)).hands[0].layouts

    assert layouts(labels="population") == (FIVE,)
    assert layouts(labels="paper") == ()
    assert layouts(labels="population", hand="left") == (FIVE,)
    assert layouts(labels="population", hand="right") == ()
    assert layouts(labels="population", hand_size=1.1) == (FIVE,)


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
        ([FAR], "cannot be one hand"),
        ([FIVE[:4]], "five places"),
        ([FIVE] * 25, "at most 24"),
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
