"""What a demonstration shows of the simulated user's play."""

from __future__ import annotations

import json
import struct
from typing import Any

import pytest

from sandbox.play.demonstration import demonstrated
from sandbox.trial.driver import open_trial
from sandbox.trial.settings import Settings


def states(message: bytes) -> list[dict[str, Any]]:
    """State of each frame of a demonstration."""
    found, at = [], 8
    for _ in range(struct.unpack_from("<H", message, 2)[0]):
        (length,) = struct.unpack_from("<I", message, at)
        frame = message[at + 4 : at + 4 + length]
        found.append(json.loads(frame[frame.index(b'{"') : frame.rindex(b"}") + 1]))
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
