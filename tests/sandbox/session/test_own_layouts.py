"""What a trial learns of a person's hand: layouts of five fingers, and nothing else."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.frames import Contact
from models.person import Person, PersonFrame
from models.surface import Surface
from sandbox.recording.recording import load_recording
from sandbox.session.own_layouts import Layouts, known_layouts, learned_layouts
from sandbox.trial.driver import open_trial
from sandbox.trial.replay import replay
from sandbox.trial.settings import HandSettings, Settings, recorded_settings
from tests.support.scripted import Script

FIVE = 1e-3 * np.array([[70, 100], [105, 58], [130, 45], [153, 52], [174, 74]])
"""Touches of a right hand of size 1, m on the surface, thumb first."""

KNOWN: Layouts = (
    ((0.0, 0.0), (0.04, -0.03), (0.07, -0.04), (0.095, -0.03), (0.115, -0.005)),
    ((0.0, 0.0), (0.030, -0.050), (0.05, -0.065), (0.075, -0.058), (0.110, -0.030)),
)
SETTINGS = Settings().changed(labels="population")
INDEX_AND_RING = (1, 3)
"""Fingers that look like thumb and index finger, unless five fingers have taught better."""


@dataclass
class Touched:
    """A trial in which some fingers touched and stayed, for a second.

    Attributes:
        learned: See `learned_layouts`.
        labels: Finger by contact id, which is the true finger.
        state_hash: The last state's.
        own: Layouts that the labeller knows at the end.
    """

    learned: dict[str, Layouts]
    labels: dict[int, int | None]
    state_hash: str
    own: Any


def touched(
    fingers: tuple[int, ...], settings: Settings = SETTINGS, record: Path | None = None
) -> Touched:
    person = settings.hands[0].person

    def maker(task: object, surface: Surface) -> Script:
        xy = PersonFrame(Person(person.hand), surface).outwards(FIVE * person.hand_size)
        contacts = [Contact(f, *xy[f].tolist()) for f in fingers]
        return Script(lambda now: contacts)

    with open_trial(settings, (maker,), record=record) as trial:
        trial.run(stop=lambda: trial.session.time >= 1.0)
        session = trial.session
        trial.end()
        reconstructor: Any = session.first_rig.reconstructor
        return Touched(
            learned_layouts(session),
            {c.id: c.label for c in session.reconstructions[0].contacts},
            session.state_hash,
            getattr(reconstructor, "trained", reconstructor).labeller.own,
        )


@pytest.mark.parametrize("fingers", [(0, 1), (1, 3), (0, 1, 2), (2, 3, 4), (0, 1, 2, 3)])
def test_names_of_fewer_than_five_fingers_teach_nothing_however_sure_they_are(
    fingers: tuple[int, ...],
) -> None:
    assert touched(fingers).learned == {}


@pytest.mark.parametrize(("side", "size"), [("right", 1.0), ("left", 0.8), ("left", 1.2)])
def test_five_fingers_teach_their_layout_in_the_persons_own_size(side: str, size: float) -> None:
    settings = replace(SETTINGS, hands=(HandSettings(side, size),))
    after = touched((0, 1, 2, 3, 4), settings)
    (hand,) = settings.with_layouts(after.learned).hands
    assert list(after.learned) == [side]
    (layout,) = np.array(hand.layouts)
    np.testing.assert_allclose(layout - layout[0], size * (FIVE - FIVE[0]), atol=3e-4)
    again = known_layouts(hand.layouts, size)
    np.testing.assert_allclose(again.layouts, after.own.layouts, atol=2e-3)


def test_every_trial_begins_with_the_settings_alone_so_that_their_order_does_not_matter() -> None:
    trials = [(0, 1, 2, 3, 4), INDEX_AND_RING, (2, 3, 4)]

    def hashes(order: list[int]) -> dict[int, str]:
        return {i: touched(trials[i]).state_hash for i in order}

    forwards = hashes([0, 1, 2])
    assert forwards == hashes([2, 1, 0])
    # It would matter if the first trial taught the second.
    taught = SETTINGS.with_layouts(touched(trials[0]).learned)
    assert touched(INDEX_AND_RING, taught).state_hash != forwards[1]


def test_layouts_of_five_fingers_mend_names_of_two() -> None:
    taught = SETTINGS.with_layouts(touched((0, 1, 2, 3, 4)).learned)
    assert touched(INDEX_AND_RING).labels == {1: 0, 3: 1}
    assert touched(INDEX_AND_RING, taught).labels == {1: 1, 3: 3}


def test_a_recording_holds_the_layouts_that_were_used_and_replays_without_a_profile(
    tmp_path: Path,
) -> None:
    taught = SETTINGS.with_layouts(touched((0, 1, 2, 3, 4)).learned)
    path = tmp_path / "known.jsonl"
    played = touched(INDEX_AND_RING, taught, path)
    recording = load_recording(path)
    assert recorded_settings(recording.header) == taught
    session, verification = replay(recording)
    assert verification.exact and session.reconstructions[0].contacts[1].label == 3
    assert played.learned == {}


def test_what_was_known_at_the_beginning_stays_and_the_new_comes_last() -> None:
    (after,) = touched((0, 1, 2, 3, 4), SETTINGS.with_layouts({"right": KNOWN})).learned.values()
    assert len(after) == len(KNOWN) + 1
    for kept, known in zip(after, KNOWN, strict=False):
        # Layouts have their middle at 0.
        shift = np.array(kept) - np.array(known)
        np.testing.assert_allclose(shift - shift[0], 0.0, atol=5e-5)
