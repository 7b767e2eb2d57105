"""A solid hand that is led between things stays calm and legal."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from models.pose import JOINTS
from models.skeleton import ADULT
from sandbox.session import collision_avoidance
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import device_makers
from sandbox.trial.driver import play_trial
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.corrections import Changes

View = Callable[[Snapshot], None]


def between_books(seed: int, views: Callable[[Session], Sequence[View]]) -> bool:
    """Plays `books`, where the encoder's pose is inside of a book; tells whether it succeeded."""
    chosen = trial_settings(TrialOptions(task="books", seed=seed, solid="hand"))
    return play_trial(chosen, device_makers(chosen), views).success


def back(seed: int) -> float:
    """rad a control step that corrections take back of the step before, in one trial."""
    seen: list[Changes] = []

    def watch(session: Session) -> list[View]:
        seen.append(Changes(session))
        return [*seen]

    assert between_books(seed, watch)
    assert seen[0].steps > 100
    return seen[0].back / seen[0].steps


@pytest.mark.parametrize("seed", [9001, 9002])
def test_without_a_share_of_the_correction_before_a_hand_between_books_trembles_twice_as_much(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    steady = back(seed)
    monkeypatch.setattr(collision_avoidance, "STEADY", 1e3)
    assert back(seed) > 2.0 * steady


@pytest.mark.parametrize("seed", [7001, 7002, 7003])
def test_every_joint_of_a_hand_that_is_led_stays_in_its_range(seed: int) -> None:
    led: list[bool] = []

    def watch(session: Session) -> list[View]:
        def look(snapshot: Snapshot) -> None:
            led.append(session.correction(0) is not None)
            joints = session.reconstructions[0].q[JOINTS]
            assert np.all(joints >= ADULT.lower) and np.all(joints <= ADULT.upper)

        return [look]

    between_books(seed, watch)
    assert sum(led) > 50
