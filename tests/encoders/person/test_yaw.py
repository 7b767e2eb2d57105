"""A hand that is turned further than any trained one is noticed, said once, and not too often."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.input_vector import contact_vector
from encoders.person.natural_layout import YawMonitor, YawRange, YawWarningSettings
from encoders.regression.trained import builtin_capture
from models.frames import Contact
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.simulated.spreads import spread_layout
from sandbox.trial.assembly import build
from sandbox.trial.settings import HandSettings, Settings
from tests.encoders.regression.turning import turned_places
from tests.support.scripted import Script


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


def u_of(
    turn: float, fingers: Iterable[int] = range(5), names: Iterable[int] | None = None
) -> np.ndarray:
    """Contact vector of a hand at a turn, with the names its fingers got."""
    xy = turned_places(natural(), turn - middle(), (0.0, 0.0)) / METRES_PER_INCH
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
def test_the_turn_of_two_or_three_touches_is_that_of_their_names_and_one_touch_has_none(
    turn: float, fingers: tuple[int, ...]
) -> None:
    assert np.cos(trained_range().turn(u_of(turn, fingers)) - turn) > np.cos(np.deg2rad(25.0))
    assert trained_range().turn(u_of(turn, fingers[:1])) is None


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


def resting(turn: float, seat: int = 0, watched: bool = True) -> tuple[list[str], str]:
    """Notices about turning of a session, step by step, in which five fingers of a turned hand
    rest, and its state hash; a hand that rests may also be told that it is in the box."""

    def device(task: object, surface: Surface) -> Script:
        xy = turned_places(natural(), turn - middle(), (0.0, 0.0)) + surface.size / 2
        contacts = [Contact(i, float(x), float(y)) for i, (x, y) in enumerate(xy)]
        return Script(lambda now: contacts if now > 0.2 else ())

    session = build(Settings(hands=(HandSettings(turn=seat),)), (device,))
    if not watched:
        session.rigs[0].yaw = None
    snapshots = [session.advance() for _ in range(150)]
    notices = ["; ".join(n for n in s.notices if "--turn" in n) for s in snapshots]
    return notices, session.state_hash


def test_a_person_at_the_far_side_of_the_screen_is_warned_unless_the_seat_is_set() -> None:
    notices, warned = resting(np.pi)
    assert notices[-1] and len(set(notices) - {""}) == 1
    assert not any(resting(np.pi, seat=180)[0])
    assert not any(resting(0.0)[0])
    # The warning changes no state of the simulation.
    assert resting(np.pi, watched=False)[1] == warned
