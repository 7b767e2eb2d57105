"""A hand that is turned further than any trained one is noticed, said once, and not too often."""

from __future__ import annotations

import json
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.input_vector import contact_vector
from encoders.person.natural_layout import YawMonitor, YawRange, YawWarningSettings
from encoders.regression.trained import builtin_capture
from models.frames import Contact, TouchFrame
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH, Surface
from sandbox.cli import run
from sandbox.devices.device import Device
from sandbox.devices.simulated.spreads import spread_layout
from sandbox.session.messages import Snapshot
from sandbox.trial.assembly import build
from sandbox.trial.driver import play_trial
from sandbox.trial.settings import HandSettings, Settings


@cache
def trained_range() -> YawRange:
    return YawRange.of(builtin_capture().u)


@cache
def natural() -> np.ndarray:
    """(5, 2) m, x right, y down, about the middle: fingertips of a relaxed hand, thumb first."""
    return spread_layout(ADULT, 0.0, 0.0, 0.0) * [1.0, -1.0]


@cache
def middle() -> float:
    """rad, how that hand is turned: not quite as the trained hands were on average."""
    return float(trained_range().turn(contact_vector(dict(enumerate(map(tuple, natural()))))))


def turned(xy: np.ndarray, angle: float) -> np.ndarray:
    """Counterclockwise as seen on the screen, whose y points down."""
    c, s = np.cos(angle), np.sin(angle)
    return xy @ np.array([[c, -s], [s, c]])


def u_of(
    turn: float, fingers: Iterable[int] = range(5), names: Iterable[int] | None = None
) -> np.ndarray:
    """Contact vector of a hand at a turn, with the names its fingers got."""
    xy = turned(natural(), turn - middle()) / METRES_PER_INCH
    names = list(fingers) if names is None else names
    pairs = zip(names, fingers, strict=True)
    return contact_vector({int(n): (float(xy[f, 0]), float(xy[f, 1])) for n, f in pairs})


@given(
    turn=st.floats(-3.1, 3.1),
    fingers=st.sampled_from([(0, 1, 2, 3, 4), (0, 1, 2, 3), (0, 1, 2, 4)]),
    data=st.data(),
)
def test_the_turn_of_four_or_five_touches_does_not_depend_on_what_they_are_called(
    turn: float, fingers: tuple[int, ...], data: st.DataObject
) -> None:
    names = data.draw(st.permutations(fingers))
    plain = trained_range().turn(u_of(turn, fingers))
    # Whoever is leftmost stays so, hence positions are those of the true fingers.
    assert np.cos(trained_range().turn(u_of(turn, fingers, names)) - plain) == pytest.approx(1.0)
    assert np.cos(plain - turn) > np.cos(np.deg2rad(20.0))


@given(turn=st.floats(-3.1, 3.1), fingers=st.sampled_from([(0, 1), (0, 1, 2), (1, 2, 3), (2, 4)]))
def test_the_turn_of_two_or_three_touches_is_that_of_their_names(
    turn: float, fingers: tuple[int, ...]
) -> None:
    assert np.cos(trained_range().turn(u_of(turn, fingers)) - turn) > np.cos(np.deg2rad(25.0))


def test_one_touch_has_no_turn() -> None:
    assert trained_range().turn(u_of(0.3, (1,))) is None


def test_the_range_holds_the_turns_of_the_training_and_is_not_the_whole_circle() -> None:
    assert -np.pi < trained_range().low < -0.5 < 0.5 < trained_range().high < np.pi
    turns = trained_range().layout.turns
    beyond = np.array([trained_range().beyond(t) for t in turns])
    assert np.mean(beyond > 0) < 0.02
    assert np.mean(beyond > YawWarningSettings().outside) < 0.005


def watched(turns: list[float], watch: YawMonitor | None = None, dt: float = 0.1) -> list[str]:
    """Notices while a hand takes these turns, one after another."""
    watch = watch or YawMonitor(trained_range())
    return [watch.step(i * dt, u_of(t)) for i, t in enumerate(turns)]


@cache
def far() -> float:
    return trained_range().high + np.deg2rad(40.0)


def test_a_hand_turned_too_far_is_noticed_once_it_stays_so() -> None:
    notices = watched([0.0] * 5 + [far()] * 20)
    assert not any(notices[:8]) and all(notices[10:])
    assert len(set(notices[10:])) == 1 and "--turn" in notices[-1]


def test_a_short_excess_gives_no_warning() -> None:
    assert not any(watched(([0.0] * 5 + [far()] * 3) * 10))


def test_a_yaw_that_jitters_at_the_border_gives_one_warning() -> None:
    s = YawWarningSettings()
    border = trained_range().high + s.outside
    rng = np.random.default_rng(0)
    watch = YawMonitor(trained_range())
    turns = [0.0] * 5 + [far()] * 6 + list(border + rng.uniform(-0.05, 0.05, 600))
    notices = watched(turns, watch)
    assert watch.warnings == 1 and all(notices[12:])


def test_a_hand_that_turns_back_takes_its_notice_away() -> None:
    notices = watched([far()] * 10 + [0.0] * 10)
    assert notices[9] and not notices[-1]


def test_warnings_keep_their_distance_in_time() -> None:
    watch = YawMonitor(trained_range())
    # In and out once a second for a minute.
    turns = ([far()] * 5 + [0.0] * 5) * 60
    watched(turns, watch)
    assert 2 <= watch.warnings <= 60 / YawWarningSettings().apart + 1


def test_lifting_and_landing_again_is_no_new_warning() -> None:
    watch = YawMonitor(trained_range())
    for i in range(300):
        watch.step(0.1 * i, None if i % 10 > 7 else u_of(far()))
    assert watch.warnings == 1


def natural_touches(turn: float, surface: Surface) -> tuple[Contact, ...]:
    xy = turned(natural(), turn - middle()) + surface.size / 2
    return tuple(Contact(i, float(x), float(y)) for i, (x, y) in enumerate(xy))


class Resting(Device):
    """A device on which five fingers of a turned hand rest for some seconds."""

    name = "script"

    def __init__(self, surface: Surface, turn: float, seconds: float = 3.0) -> None:
        self.contacts = natural_touches(turn, surface)
        self.seconds, self.now = seconds, 0.0

    @property
    def finished(self) -> bool:
        return self.now >= self.seconds

    def poll(self, now: float) -> list[TouchFrame]:
        self.now = now
        return [TouchFrame(now, self.contacts if now > 0.2 else ())]

    def close(self) -> None:
        pass


def notices_of(settings: Settings, turn: float) -> list[str]:
    session = build(settings, (lambda task, surface: Resting(surface, turn),))
    return [about_turning(session.advance()) for _ in range(150)]


def about_turning(snapshot: Snapshot) -> str:
    """A hand that rests may also be told that it is in the box."""
    return "; ".join(n for n in snapshot.notices if "--turn" in n)


def test_a_person_at_the_far_side_of_the_screen_is_warned_unless_the_seat_is_set() -> None:
    far = notices_of(Settings(), np.pi)
    assert far[-1] and len(set(far) - {""}) == 1
    assert not any(notices_of(Settings(hands=(HandSettings(turn=180),)), np.pi))
    assert not any(notices_of(Settings(), 0.0))


def test_the_warning_changes_no_state_of_the_simulation() -> None:
    hashes = []
    for watched_too in (True, False):
        session = build(Settings(), (lambda task, surface: Resting(surface, np.pi),))
        if not watched_too:
            session.rigs[0].yaw = None
        for _ in range(100):
            session.advance()
        hashes.append(session.state_hash)
    assert hashes[0] == hashes[1]


def test_the_events_of_a_run_hold_one_warning(tmp_path: Path) -> None:
    recorded, events = tmp_path / "far.jsonl", tmp_path / "events.jsonl"
    play_trial(Settings(), (lambda task, surface: Resting(surface, np.pi),), record=recorded)
    assert run.main(["--device", str(recorded), "--events", str(events)]) == 0
    told = [json.loads(line) for line in events.read_text().splitlines()]
    warnings = [e for e in told if e["event"] == "warning"]
    assert len({w["what"] for w in warnings}) == len(warnings)
    warnings = [w for w in warnings if "--turn" in w["what"]]
    assert len(warnings) == 1
    assert warnings[0]["time_s"] < 2.0
