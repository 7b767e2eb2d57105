"""Hands do not wait for screens with noise: touches that stay where they are rest."""

from __future__ import annotations

import pytest

from encoders.reconstruction.hand_motion import Phase
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import device_makers
from sandbox.trial.driver import play_trial
from sandbox.trial.trial_options import TrialOptions, trial_settings


class Waits:
    """A view that notes how long the first hand waits over its touches.

    Args:
        session: The session that is watched.
    """

    def __init__(self, session: Session) -> None:
        self._session, self._since, self._before = session, 0.0, Phase.AWAY
        self.waits: list[float] = []

    def __call__(self, snapshot: Snapshot) -> None:
        phase = self._session.reconstructions[0].phase
        if phase is Phase.ABOVE and self._before is not Phase.ABOVE:
            self._since = snapshot.time
        if phase is Phase.COMING_DOWN and self._before is Phase.ABOVE:
            self.waits.append(round(snapshot.time - self._since, 6))
        self._before = phase


def waits(noise: float) -> list[float]:
    """s that the hand waited over each of the simulated user's touches, with noise in mm."""
    watched: list[Waits] = []

    def watch(session: Session) -> list[Waits]:
        watched.append(Waits(session))
        return watched

    chosen = trial_settings(
        TrialOptions(seed=5, fingers=3, vary=f"noise={noise:g}" if noise else "")
    )
    result = play_trial(chosen, device_makers(chosen), watch)
    assert result.success, result.reason
    return watched[0].waits


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_a_millimetre_of_noise_costs_a_hand_no_time(noise: float) -> None:
    assert max(waits(noise)) < 0.2
