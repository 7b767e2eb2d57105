"""What a trial learns of a person's hand: layouts of five fingers, and nothing else."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sandbox.options.scene_options import SceneOptions, plan
from sandbox.recording.recording import load_recording
from sandbox.session.own_layouts import Layouts, known_layouts, learned_layouts
from sandbox.trial.driver import open_trial
from sandbox.trial.headless import run_trial
from sandbox.trial.replay import replay
from sandbox.trial.settings import RunSettings

KNOWN: Layouts = (
    ((0.0, 0.0), (0.035, -0.042), (0.06, -0.055), (0.083, -0.048), (0.104, -0.026)),
    ((0.0, 0.0), (0.030, -0.050), (0.05, -0.065), (0.075, -0.058), (0.110, -0.030)),
)


def chosen(fingers: int, seed: int = 4, **more: Any) -> Any:
    return plan(SceneOptions(labels="population", fingers=fingers, seed=seed, **more))


def learned(fingers: int, **more: Any) -> dict[str, Layouts]:
    """What a trial of the simulated user has learned at its end."""
    planned = chosen(fingers, **more)
    with open_trial(planned.settings, planned.makers) as trial:
        trial.run()
        return learned_layouts(trial.session)


@pytest.mark.parametrize("fingers", [2, 3, 4])
def test_names_of_fewer_than_five_fingers_teach_nothing_however_sure_they_are(fingers):
    assert learned(fingers) == {}


@pytest.mark.parametrize("size", [0.8, 1.2])
def test_five_fingers_teach_their_layout_in_the_persons_own_size(size):
    planned = chosen(5, hand_size=size, hand="left")
    with open_trial(planned.settings, planned.makers) as trial:
        trial.run()
        hand: Any = trial.session.first_rig.reconstructor
        own = hand.trained.labeller.own
        found = learned_layouts(trial.session)
    (after,) = planned.settings.knowing(found).hands
    assert after.side == "left" and len(after.layouts) == len(own) > 0
    again = known_layouts(after.layouts, size)
    np.testing.assert_allclose(again.layouts, own.layouts, atol=2e-3)


def test_every_trial_begins_with_the_settings_alone_so_that_their_order_does_not_matter():
    trials = [chosen(fingers, seed) for fingers, seed in ((5, 1), (4, 2), (2, 3))]

    def hashes(order: list[int]) -> dict[int, str]:
        return {i: run_trial(trials[i].settings, trials[i].makers).state_hash for i in order}

    forwards = hashes([0, 1, 2])
    assert forwards == hashes([2, 1, 0])
    # They would depend on it if the first trial taught the others.
    taught = learned(5, seed=1)
    for i in (1, 2):
        settings = trials[i].settings.knowing(taught)
        assert run_trial(settings, trials[i].makers).state_hash != forwards[i]


def test_a_recording_holds_the_layouts_that_were_used_and_replays_without_a_profile(tmp_path):
    planned = chosen(3)
    settings = planned.settings.knowing({"right": KNOWN})
    path = tmp_path / "known.jsonl"
    run_trial(settings, planned.makers, record=path)
    recording = load_recording(path)
    assert RunSettings.from_json(recording.header["settings"]).hands[0].layouts == KNOWN
    _, verification = replay(recording)
    assert verification.exact and verification.complete


def test_what_was_known_at_the_beginning_stays_and_the_new_comes_last():
    planned = chosen(5)
    settings = planned.settings.knowing({"right": KNOWN})
    with open_trial(settings, planned.makers) as trial:
        trial.run()
        (after,) = learned_layouts(trial.session).values()
    assert len(after) > len(KNOWN)
    for kept, known in zip(after, KNOWN, strict=False):
        # Layouts have their middle at 0.
        for a, b in zip(kept, known, strict=True):
            assert a[0] - b[0] == pytest.approx(kept[0][0] - known[0][0], abs=5e-5)
            assert a[1] - b[1] == pytest.approx(kept[0][1] - known[0][1], abs=5e-5)


def test_layouts_are_for_names_by_the_population_and_for_the_same_side():
    settings = chosen(3).settings
    other = replace(settings, labels="history")
    assert other.knowing({"right": KNOWN}) == other
    assert settings.knowing({"left": KNOWN}) == settings
    known = settings.knowing({"right": KNOWN}).hands[0]
    assert known.on("right") == known
    assert known.on("left").layouts == ()
    assert known.other.layouts == ()
