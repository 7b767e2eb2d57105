"""What a demonstration shows of the simulated user's play."""

from __future__ import annotations

import json
import struct
from typing import Any

import pytest

from sandbox.play.demonstration import demonstrated
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
def test_a_chord_is_shown_pressed_once_without_tries_beside_its_keys(seed: int) -> None:
    shown = states(demonstrated(Settings(task="chords", seed=seed), 1))
    touched = [any(hand["contacts"] for hand in state["hands"]) for state in shown]
    assert touched and all(touched)
    # What led to nothing before took time.
    assert shown[-1]["reached"]
    assert shown[-1]["time"] - shown[0]["time"] < 3.0
