"""A left hand is the right-hand code between two mirrors, and a person may sit anywhere."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.reconstruction.reconstructor import Reconstruction
from models.arithmetic import Array
from models.frames import Contact, TouchFrame
from models.kinematics import Kinematics
from models.objects import Box
from models.person import HANDS, TURNS, Person, PersonFrame
from models.pose import mirrored
from models.rotations import exp
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.trial.assembly import build
from sandbox.trial.driver import play_trial
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import HandSettings, Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.simulated_user.view import Seat
from tasks.task import Goal
from tasks.user import SeenObject, Sight
from tests.support.scripted import Script
from tests.support.simulation import legal_poses

SCREEN = Surface(7.76, 5.82)


people = st.builds(Person, st.sampled_from(HANDS), st.floats(0.6, 1.6), st.sampled_from(TURNS))


places = st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0))


def trial(record: Path | None = None, **options: Any) -> TrialResult:
    chosen = trial_settings(TrialOptions(**options))
    return play_trial(chosen, record=record)


def grasp(now: float) -> list[Contact]:
    """One shortly after another, four fingers land; they move and turn."""
    x, y, turn = 0.09 + 0.02 * np.sin(3 * now), 0.08 + 0.01 * np.cos(2 * now), 0.3 * np.sin(now)
    c, s = np.cos(turn), np.sin(turn)
    offsets = [(-0.03, 0.03), (0.0, -0.03), (0.025, -0.035), (0.045, -0.025)]
    return [
        Contact(i, x + c * a - s * b, y + s * a + c * b)
        for i, (a, b) in enumerate(offsets)
        if now > 0.02 * i
    ]


def reconstructed(
    touch: Callable[[float], Iterable[Contact]], **about: Any
) -> tuple[Surface, list[Reconstruction]]:
    """Reconstructions of 2 s of touches, by the default settings."""
    session = build(Settings().changed(**about), (lambda task, surface: Script(lambda now: []),))
    reconstructor: Any = session.rigs[0].reconstructor
    frames = [TouchFrame(t, tuple(touch(t))) for t in np.arange(130) * 0.016]
    return reconstructor.surface, [reconstructor.step(f) for f in frames]


def test_mirrored_touches_give_the_mirrored_left_hand() -> None:
    surface, right = reconstructed(grasp)
    width = float(surface.size[0])

    def other_side(now: float) -> list[Contact]:
        return [replace(c, x=width - c.x) for c in grasp(now)]

    _, left = reconstructed(other_side, hands=(HandSettings("left"),))
    assert any(r.down and len(r.fingers) == 4 for r in right)
    for a, b in zip(right, left, strict=True):
        # The screen's middle is at x = 0 of the world, where the mirror stands.
        np.testing.assert_allclose(b.q, mirrored(a.q), atol=1e-12, rtol=0)
        assert [c.label for c in a.contacts] == [c.label for c in b.contacts]
        assert (a.phase, a.fingers) == (b.phase, b.fingers)
        assert b.probability == pytest.approx(a.probability, rel=1e-9)
        for mine, other in zip(a.contacts, b.contacts, strict=True):
            np.testing.assert_allclose([other.x, other.y], [width - mine.x, mine.y], atol=1e-15)


@pytest.mark.parametrize(("turn", "hand"), [(90, "right"), (180, "left"), (270, "left")])
def test_a_person_at_another_side_gets_the_same_hand_turned_about_the_screens_middle(
    turn: int, hand: str
) -> None:
    # On a square screen the same person may sit anywhere.
    square = (6.0, 6.0)
    _, here = reconstructed(grasp, hands=(HandSettings(hand),), size_in=square)
    middle = Surface(*square).size / 2
    angle = np.deg2rad(turn)
    # Counterclockwise seen from above, in a frame whose y points down.
    down = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])

    def there(now: float) -> Iterator[Contact]:
        for c in grasp(now):
            x, y = middle + down @ (np.array([c.x, c.y]) - middle)
            yield replace(c, x=float(x), y=float(y))

    turned = (HandSettings(hand, turn=turn),)
    _, found = reconstructed(there, hands=turned, size_in=square)
    rotation = exp(np.array([0.0, 0.0, angle]))
    for a, b in zip(here, found, strict=True):
        np.testing.assert_allclose(b.q[:3], rotation @ a.q[:3], atol=1e-9)
        np.testing.assert_allclose(exp(b.q[3:6]), rotation @ exp(a.q[3:6]), atol=1e-8)
        np.testing.assert_allclose(b.q[6:], a.q[6:], atol=1e-8)


@given(person=people, shares=st.lists(places, min_size=1, max_size=5))
def test_the_screen_and_all_on_it_come_back_from_a_persons_frame(
    person: Person, shares: list[tuple[float, float]]
) -> None:
    frame = PersonFrame(person, SCREEN)
    xy = np.array(shares) * SCREEN.size
    inside = frame.inwards(xy)
    np.testing.assert_allclose(frame.outwards(inside), xy, atol=1e-12)
    assert np.all(inside >= -1e-12) and np.all(inside <= frame.surface.size + 1e-12)
    # Distances are those of a hand of the trained size.
    np.testing.assert_allclose(
        np.linalg.norm(inside - inside[0], axis=1) * person.hand_size,
        np.linalg.norm(xy - xy[0], axis=1),
        atol=1e-12,
    )


@given(person=people, q=legal_poses)
def test_fingertips_of_the_pose_that_comes_back_are_where_their_points_come_back_to(
    person: Person, q: Array
) -> None:
    frame = PersonFrame(person, SCREEN)
    inside = Kinematics(ADULT).tips(q)
    tips = Kinematics(person.skeleton(ADULT)).tips(frame.outward_pose(q))
    xy = frame.outwards(inside[:, :2] * [1.0, -1.0])
    np.testing.assert_allclose(tips[:, :2] * [1.0, -1.0], xy, atol=1e-9)
    np.testing.assert_allclose(tips[:, 2], inside[:, 2] * person.hand_size, atol=1e-9)


@pytest.fixture(scope="module")
def left_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[TrialResult, Path]:
    path = tmp_path_factory.mktemp("left") / "run.jsonl"
    return trial(path, seed=5, fingers=3, hand="left"), path


def test_a_left_handed_recording_as_a_device_keeps_its_hand_unless_asked_otherwise(
    left_run: tuple[TrialResult, Path],
) -> None:
    result, path = left_run
    assert trial(device=str(path)).state_hash == result.state_hash
    assert trial_settings(TrialOptions(device=str(path), hand="right")).hands[0].side == "right"


@given(x=st.floats(-0.1, 0.1), y=st.floats(-0.1, 0.1), yaw=st.floats(-3.0, 3.0), person=people)
def test_a_seated_users_sight_keeps_distances_heights_and_what_is_at_its_goal(
    x: float, y: float, yaw: float, person: Person
) -> None:
    screen = SCREEN.centred_at((0.0, 0.0, 0.02))
    seat = Seat(person, screen)
    c, s = np.cos(yaw), np.sin(yaw)
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    box = Box("box", (0.02, 0.03, 0.025), 0.1, (x, y, 0.025), yaw)
    sight = Sight(
        0.0,
        {7: np.array([0.01, 0.02, 0.03])},
        True,
        {"box": SeenObject(box, np.array([x, y, 0.025]), rotation)},
        (Goal("box", (x, y, 0.025), yaw),),
        False,
    )
    seen = seat.sight(sight)
    box_seen, goal = seen.objects["box"], seen.goals[0]
    np.testing.assert_allclose(box_seen.position, goal.position, atol=1e-12)
    assert np.cos(box_seen.yaw - goal.yaw) == pytest.approx(1.0)
    assert np.linalg.det(box_seen.rotation) == pytest.approx(1.0)
    assert box_seen.position[2] == pytest.approx(0.025)
    apart = np.linalg.norm(sight.tips[7] - sight.objects["box"].position)
    assert np.linalg.norm(seen.tips[7] - box_seen.position) == pytest.approx(apart)
    # What the user touches on their screen is felt at the same place of the world.
    spot = np.array([x, y, 0.02])
    on_theirs = seat.surface.to_surface(seat.point(spot))
    frame = seat.frame(TouchFrame(0.0, (Contact(1, float(on_theirs[0]), float(on_theirs[1])),)))
    felt = screen.to_world((frame.contacts[0].x, frame.contacts[0].y))
    np.testing.assert_allclose(felt, spot, atol=1e-12)
