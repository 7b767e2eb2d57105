"""The whole path: touches in, a task done, the same to the bit every time."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.frames import Contact, TouchFrame
from models.kinematics import Kinematics
from sandbox.recording.recording import load_recording
from sandbox.session.collision_gating import STUCK
from sandbox.session.session import Session
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.driver import Trial, play_trial
from sandbox.trial.replay import replay
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.scripted import Played, Script, scripted


def trial(**options: Any) -> TrialResult:
    return play_trial(trial_settings(TrialOptions(**options)))


@pytest.mark.parametrize("fingers", [2, 3, 5])
def test_the_simulated_user_brings_the_box_to_its_goal(fingers: int) -> None:
    result = trial(seed=5, fingers=fingers)
    assert result.success, result.reason
    assert result.status == "held"
    assert result.instant and result.progress == 1.0 and not result.reason


def test_the_same_seed_gives_the_same_states_and_another_seed_others() -> None:
    first, again, other = (trial(seed=seed, fingers=3).state_hash for seed in (11, 11, 12))
    assert first == again != other


def test_a_device_that_fails_to_close_keeps_no_other_one_open() -> None:
    closed = []

    class Closes(Script):
        def close(self) -> None:
            closed.append(self)
            raise OSError("the cable is out")

    both = (lambda task, surface: Closes(lambda now: []),) * 2
    chosen = trial_settings(TrialOptions(task="carry-together"))
    session = build(chosen, both)
    with pytest.raises(OSError, match="the cable is out"):
        session.close()
    assert len(closed) == 2


def test_without_touches_nothing_is_touched() -> None:
    session = build(Settings(), (lambda task, surface: Script(lambda now: []),))
    before = session.data.qpos.copy()
    box = session.scene.model.joint("box").qposadr[0]
    for _ in range(60):
        snapshot = session.advance()
    assert snapshot.hands[0].phase == "away" and not snapshot.hands[0].solid
    assert np.abs(session.data.qpos - before)[box : box + 7].max() < 1e-4
    assert np.abs(session.data.qpos - before).max() < 0.01


def test_a_hand_put_down_inside_the_box_stays_a_ghost_until_its_fingers_are_out() -> None:
    settings = Settings(seed=4)
    place: dict[str, Any] = {}

    def touch(now: float) -> list[Contact]:
        # Two fingers, both in the middle of the box at first, then moved apart and out of it.
        apart = 0.01 + 0.05 * np.clip((now - 2.0) / 0.5, 0.0, 1.0)
        x, y = place["box"]
        return [
            Contact(1, x - apart, y + apart, label=0),
            Contact(2, x + apart, y - apart, label=1),
        ]

    session = build(replace(settings), (lambda task, surface: Script(touch),))
    surface = session.rigs[0].reconstructor.surface
    box = session.task.objects[0]
    place["box"] = surface.to_surface(np.array(box.position)).tolist()
    start = session.scene.object_pose(session.data, "box")[0]
    for _ in range(125):
        snapshot = session.advance()
    assert snapshot.hands[0].phase == "down" and not snapshot.hands[0].solid
    assert snapshot.notice == STUCK
    assert np.linalg.norm(snapshot.objects["box"].position - start) < 1e-4
    for _ in range(63):
        snapshot = session.advance()
    assert snapshot.hands[0].solid == frozenset({0, 1}) and not snapshot.notice
    assert np.linalg.norm(snapshot.objects["box"].position - start) < 1e-3


def test_fingertips_are_within_a_millimetre_of_resting_touches() -> None:
    places = [(0.03, 0.10), (0.05, 0.06), (0.07, 0.05), (0.09, 0.06), (0.11, 0.07)]
    contacts = [Contact(i, x, y) for i, (x, y) in enumerate(places)]
    # Beside a thing, a fingertip is led off its touch: far from the box, none is.
    session = build(Settings(seed=4), (lambda task, surface: Script(lambda now: contacts),))
    surface = session.rigs[0].reconstructor.surface
    box = surface.to_surface(session.scene.object_pose(session.data, "box")[0])
    assert np.linalg.norm(np.array(places) - box, axis=1).min() > 0.04
    for _ in range(130):
        session.advance()
    reconstruction = session.reconstructions[0]
    assert reconstruction.down
    tips = Kinematics(session.rigs[0].hand.skeleton).tips(reconstruction.q)
    for contact in reconstruction.contacts:
        off = surface.to_surface(tips[contact.label]) - [contact.x, contact.y]
        assert np.linalg.norm(off) < 1e-3


def test_the_labels_of_a_hand_that_is_down_never_change_and_a_new_finger_gets_a_free_one() -> None:
    def touch(now: float) -> list[Contact]:
        contacts = [Contact(1, 0.06, 0.10), Contact(2, 0.09, 0.05)]
        return [*contacts, Contact(3, 0.11, 0.055)] if now > 1.5 else contacts

    session = build(Settings(seed=1), (lambda task, surface: Script(touch),))
    named: dict[int, int] = {}
    for _ in range(180):
        session.advance()
        reconstruction = session.reconstructions[0]
        for contact in reconstruction.contacts:
            if contact.label is not None and reconstruction.down:
                assert named.setdefault(contact.id, contact.label) == contact.label
    assert len(named) == 3 and len(set(named.values())) == 3


@pytest.mark.parametrize("fingers", [(0, 1, 2, 3), (0, 1, 3, 4), (1, 2, 3, 4)])
def test_fingers_that_a_device_names_have_these_names(fingers: tuple[int, ...]) -> None:
    places = [(0.069, 0.096), (0.083, 0.059), (0.099, 0.053), (0.115, 0.056)]
    contacts = [Contact(f, *place, label=f) for f, place in zip(fingers, places, strict=True)]
    session = scripted(lambda now: contacts)
    played(session, 0.9)
    named = {c.id: c.label for c in session.snapshot().hands[0].contacts}
    assert named == dict(zip(fingers, fingers, strict=True))


def test_the_session_plays_a_closed_device_to_its_end() -> None:
    device = Script(lambda now: [])
    device.finished = True
    session = build(Settings(), (lambda task, surface: device,))
    Trial(session, []).run()
    assert session.scorer.score.status == "input_ended" and session.scorer.score.reason


def test_a_screen_that_loses_touches_changes_ids_only_and_costs_no_success() -> None:
    lossy = trial(seed=5, fingers=3, drop_outs=1.0)
    assert lossy.success, lossy.reason
    assert lossy.state_hash != trial(seed=5, fingers=3).state_hash


def test_a_snapshot_shows_its_own_moment_whenever_it_is_looked_at() -> None:
    chosen = trial_settings(TrialOptions(seed=1))
    session = build(chosen, device_makers(chosen))
    show = session.rigs[0].device.show
    while not session.solid(0):
        show(session.advance())
    looked_at, later = session.snapshot(), session.snapshot()
    hand, box = looked_at.hands[0], looked_at.objects["box"]
    for _ in range(60):
        show(session.advance())
    assert not np.array_equal(session.snapshot().objects["box"].position, box.position)
    np.testing.assert_array_equal(later.hands[0].tips, hand.tips)
    np.testing.assert_array_equal(later.hands[0].target, hand.target)
    assert (later.hands[0].solid, later.hands[0].phase) == (hand.solid, hand.phase)
    assert hand.contacts and len(later.hands[0].contacts) == len(hand.contacts)
    for a, b in zip(later.hands[0].contacts, hand.contacts, strict=True):
        assert (a.id, a.label, a.state) == (b.id, b.label, b.state)
    np.testing.assert_array_equal(later.hands[0].places, hand.places)
    np.testing.assert_array_equal(later.objects["box"].position, box.position)
    np.testing.assert_array_equal(later.objects["box"].rotation, box.rotation)
    assert later.goals == looked_at.goals
    assert later.hands is later.hands and later.goals is later.goals


GRIP = ((0.060, 0.090), (0.090, 0.055), (0.110, 0.055))
PALM = (0.12, 0.135)


def touched(now: float, sized: bool = True, palm: bool = True) -> list[Contact]:
    """A grip, and a palm that grows beside it once the hand is down; noisy sizes."""
    rng = np.random.default_rng(round(1e6 * now))
    contacts = [Contact(i, x, y, extent=(0.011, 0.009)) for i, (x, y) in enumerate(GRIP)]
    if palm and now > 1.0:
        size = 0.012 + 0.033 * min((now - 1.0) / 0.3, 1.0)
        width, height = (size * rng.normal(1.0, 0.1, 2)).tolist()
        contacts.append(Contact(9, *PALM, extent=(width, height)))
    return contacts if sized else [replace(c, extent=None) for c in contacts]


def played(session: Session, seconds: float = 2.0) -> str:
    while session.time < seconds:
        session.advance()
    return session.state_hash


def test_a_palm_changes_nothing_of_what_its_hand_does() -> None:
    with_palm, without = (
        scripted(touched, seed=3),
        scripted(lambda t: touched(t, palm=False), seed=3),
    )
    assert played(with_palm) == played(without)
    states = {c.id: c.state for c in with_palm.snapshot().hands[0].contacts}
    assert states == {0: "active", 1: "active", 2: "active", 9: "palm"}
    unsized = scripted(lambda t: touched(t, sized=False), seed=3)
    assert played(unsized) != with_palm.state_hash, "without sizes it is a finger"


def test_a_trial_with_a_palm_replays_to_the_bit(tmp_path: Path) -> None:
    path = tmp_path / "palm.jsonl"
    frames = [TouchFrame(t, tuple(touched(t))) for t in np.arange(125) * 0.016]
    result = play_trial(Settings(seed=3), (lambda task, surface: Played(frames),), record=path)
    session, found = replay(load_recording(path))
    assert found.exact and found.complete and session.state_hash == result.state_hash
    assert {c.state for c in session.snapshot().hands[0].contacts} == {"active", "palm"}
