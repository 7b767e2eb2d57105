"""What a demonstration shows of the simulated user's play."""

from __future__ import annotations

import json
import struct
from typing import Any

import pytest

from sandbox.play.demonstration import demonstrated
from sandbox.trial.driver import open_trial
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings


def states(message: bytes) -> list[dict[str, Any]]:
    """State of each frame of a demonstration."""
    found, at = [], 8
    for _ in range(struct.unpack_from("<H", message, 2)[0]):
        (length,) = struct.unpack_from("<I", message, at)
        frame = message[at + 4 : at + 4 + length]
        (text,) = struct.unpack_from("<I", frame, 24)
        found.append(json.loads(frame[-text:]))
        at += 4 + length
    return found


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("task", ["chords", "single-keys"])
def test_five_fingers_rest_on_the_keys_and_then_those_of_the_white_keys_lift(
    task: str, seed: int
) -> None:
    settings = Settings(task=task, seed=seed)
    with open_trial(settings) as trial:
        goals = trial.session.task.goals
    blue = {key for key, goal in enumerate(goals) if goal.shown}
    shown = states(demonstrated(settings, 1))
    touching = [
        {contact["label"] for hand in state["hands"] for contact in hand["contacts"]}
        for state in shown
    ]
    five = touching.index(set(range(5)))
    alone = touching.index(blue)
    # Fingers come down, and go up, within a few frames.
    assert five < 5 and touching[five:alone].count(set(range(5))) > (alone - five) - 5
    assert all(fingers == blue for fingers in touching[alone:])
    assert shown[-1]["reached"]
    assert shown[-1]["time"] - shown[0]["time"] < 4.0


@pytest.mark.parametrize("task", ["carry-together", "close-case"])
def test_both_hands_of_a_task_for_two_are_shown(task: str) -> None:
    """A person plays one hand on a page, and a simulated user the other."""
    shown = states(demonstrated(trial_settings(TrialOptions(task=task, device="web")), 1))
    assert shown[-1]["reached"]
    together = [state for state in shown if all(hand["contacts"] for hand in state["hands"])]
    assert together and all(len(state["hands"]) == 2 for state in shown)


@pytest.mark.parametrize("task", ["stack-vertical", "insert", "stack-three"])
def test_a_grip_is_shown_with_the_fingers_that_the_user_has_put_down(task: str) -> None:
    shown = states(demonstrated(Settings(task=task), 1))
    fingers = {c["label"] for state in shown for hand in state["hands"] for c in hand["contacts"]}
    # Without a label: touches that have just come down.
    assert fingers - {None} == {0, 1, 2}
