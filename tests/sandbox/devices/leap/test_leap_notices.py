"""People over a Leap are told why the drawn hand does not follow them."""

from dataclasses import replace
from typing import Any

import pytest

from encoders.evaluation.paalm_errors import moved, side_by_side
from encoders.paalm.hand_reconstructor import NOTICE_LASTS
from models.frames import HandFrame
from sandbox.devices.hand_input import HandInput
from sandbox.devices.leap.two_hands import SplitBySide
from sandbox.devices.wrappers.shared import SharedDevice
from sandbox.trial.assembly import build
from sandbox.trial.settings import HandSettings, Settings
from tests.support.leap_hands import take
from tests.support.scripted import Played, PlayedHands

STACKED = "one hand is above the other: hold them apart"


def stacked_for_a_while() -> list[HandFrame]:
    """Two hands beside each other, one above the other from 0.5 to 1 s, then beside again."""
    found = []
    for frame in side_by_side(take(1), take(2, side="left")):
        left, right = frame.hands
        if 0.5 <= frame.time < 1.0:
            x, y, z = (r - p for r, p in zip(right.palm, left.palm, strict=True))
            left = moved(left, (x, y, z + 0.12))
        found.append(replace(frame, hands=(left, right)))
    return found


def said(settings: Settings, makers: object, until: float) -> dict[float, tuple[str, ...]]:
    """What is said at every moment of a session."""
    session = build(settings, makers)  # type: ignore[arg-type]
    try:
        found = {}
        while session.time < until:
            snapshot = session.advance()
            found[round(snapshot.time, 3)] = snapshot.notices
        return found
    finally:
        session.close()


@pytest.mark.parametrize("task", ["box-to-goal", "carry-together"])
def test_hands_above_each_other_are_said_to_be_until_a_moment_after_they_are_not(task: str) -> None:
    frames, two = stacked_for_a_while(), task == "carry-together"
    sides = ("right", "left") if two else ("right",)
    hands = tuple(HandSettings(side, in_air=HandInput()) for side in sides)
    settings = Settings(task=task, hands=hands)
    shared = SharedDevice(PlayedHands(frames), SplitBySide(("right", "left")))
    parts: Any = tuple(lambda drawn, surface, i=i: shared.parts[i] for i in (0, 1))
    makers: Any = parts if two else (lambda drawn, surface: Played(frames),)
    told = said(settings, makers, 2.5)
    when = [t for t, words in told.items() if STACKED in words]
    assert when == [t for t in told if when[0] <= t <= when[-1]]
    assert when[0] == pytest.approx(0.5, abs=0.03)
    assert when[-1] == pytest.approx(1.0 + NOTICE_LASTS, abs=0.03)
    assert all(words.count(STACKED) <= 1 for words in told.values())


def test_a_hand_that_stays_away_is_missed_and_one_that_is_lost_for_a_moment_is_not() -> None:
    frames = [replace(f, hands=f.hands if not 1.0 <= f.time < 4.0 else ()) for f in take(1).frames]
    blink = [replace(f, hands=() if 0.4 <= f.time < 0.9 else f.hands) for f in frames]
    settings = Settings(hands=(HandSettings(in_air=HandInput()),))
    told = said(settings, (lambda drawn, surface: Played(blink),), 4.5)
    missed = [t for t, words in told.items() if any("is not seen" in w for w in words)]
    assert 2.2 < missed[0] < 2.5 and 3.9 < missed[-1] < 4.1
    assert not any("left" in w for words in told.values() for w in words)
