"""A held box keeps still, touches that misbehave throw nothing, and the table is left alone."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import permutations
from typing import Any

import numpy as np
import pytest

from encoders.correction import PAD_HEIGHT
from models.frames import Contact
from models.hand import IMPULSE_PROFILES, SERVOS
from sandbox.session.collision_gating import ContactMode
from sandbox.session.session import Session
from sandbox.trial.settings import SOLID
from tasks.registry import TASKS, hands_of
from tests.support.held_boxes import CREEP, JITTER, boxes, hold
from tests.support.scripted import Touch, box_xy, scripted
from tests.support.violent_touches import DEEPEST, soak


@pytest.mark.parametrize("servo", SERVOS)
@pytest.mark.parametrize("profile", IMPULSE_PROFILES)
@pytest.mark.parametrize("fingers", [2, 3])
def test_a_lifted_box_neither_creeps_nor_trembles_while_the_pose_stays(
    servo: str, profile: str, fingers: int
) -> None:
    found = hold(boxes(1)[0], fingers, servo, IMPULSE_PROFILES[profile])
    assert found.held and found.creep < CREEP and found.jitter < JITTER


@pytest.mark.parametrize("box", [0, 2, 5])
@pytest.mark.parametrize("fingers", [2, 3])
def test_a_soft_grasp_holds_a_box_just_as_still(box: int, fingers: int) -> None:
    """Two of these boxes rocked in a pinch, because the solver stopped too early."""
    found = hold(boxes(6)[box], fingers, SERVOS[0], IMPULSE_PROFILES["safe"], ContactMode.SOFT)
    assert found.held and found.creep < CREEP and found.jitter < JITTER


def box_speed(session: Session) -> float:
    return float(np.linalg.norm(session.data.cvel[session.scene.object_bodies["box"]][3:]))


def around(session: Session, ids: Sequence[int] = (1, 2, 3)) -> list[Contact]:
    """Touches of thumb, index and middle finger around the box, beside its faces."""
    x, y = box_xy(session)
    return [
        Contact(ids[0], x - 0.035, y + 0.022),
        Contact(ids[1], x + 0.004, y - 0.040),
        Contact(ids[2], x + 0.030, y - 0.030),
    ]


def fastest(touch: Touch, start: dict[str, Any], **settings: Any) -> float:
    """m/s, of the box in 4 s of these touches."""
    session = scripted(touch, seed=4, **settings)
    start["contacts"], start["box"] = around(session), box_xy(session)
    speed = 0.0
    while session.time < 4.0:
        session.advance()
        speed = max(speed, box_speed(session))
    assert not session.diverged
    return speed


@pytest.mark.parametrize("servo", SERVOS)
@pytest.mark.parametrize("impulse", IMPULSE_PROFILES.values(), ids=IMPULSE_PROFILES)
def test_touches_that_go_and_come_back_inside_of_the_box_do_not_move_it(
    servo: str, impulse: float
) -> None:
    start: dict[str, Any] = {}

    def touch(now: float) -> Sequence[Contact]:
        if now < 1.2:
            return start["contacts"]
        if now < 1.3 or 1.6 < now < 2.4:
            return []
        # New ids in the middle of the box, and a third one that comes and goes.
        x, y = start["box"]
        inside = [Contact(10, x, y), Contact(11, x + 0.01, y + 0.01)]
        return inside if int(now / 0.2) % 2 else [*inside, Contact(12, x + 0.05, y)]

    assert fastest(touch, start, servo=servo, impulse=impulse) < 0.02


@pytest.mark.parametrize("impulse", IMPULSE_PROFILES.values(), ids=IMPULSE_PROFILES)
def test_ids_that_are_swapped_under_a_hand_wring_it_and_throw_nothing(impulse: float) -> None:
    """A swap asks the fingers to go through each other with the box between them. The box is
    pushed about as fast as the commanded hand may go, and not thrown as by a spring."""
    start: dict[str, Any] = {}
    orders = list(permutations((1, 2, 3)))

    def touch(now: float) -> Sequence[Contact]:
        order = orders[int((now - 1.2) / 0.25) % 6] if now > 1.2 else (1, 2, 3)
        return [Contact(i, c.x, c.y) for i, c in zip(order, start["contacts"], strict=True)]

    speed = fastest(touch, start, impulse=impulse)
    assert 0.05 < speed < 1.5


def test_a_hand_told_to_stay_in_a_closing_gap_pushes_the_table_with_nothing() -> None:
    """Fingertips are told to be a fingertip above the touch surface, whatever the touches do, and
    hand and table pass through each other: the hand has nothing to fight."""
    session = scripted(lambda now: list(where["contacts"]), seed=4)
    where = {"contacts": around(session)}
    model = session.scene.model
    table = model.geom("table").id
    hand = {g for g in range(model.ngeom) if model.geom(g).name.startswith("right_")}
    surface = session.rigs[0].reconstructor.surface
    while session.time < 3.0:
        x, y = box_xy(session)
        spread = 1.0 - 0.3 * np.clip(session.time - 1.5, 0.0, 1.0)
        where["contacts"] = [
            Contact(c.id, x + spread * (c.x - x), y + spread * (c.y - y)) for c in around(session)
        ]
        session.advance()
        for contact in session.data.contact[: session.data.ncon]:
            assert not (table in contact.geom and hand & set(contact.geom.tolist()))
        reconstruction = session.reconstructions[0]
        if reconstruction.down and session.solid(0):
            tips = session.tips(0, session.data)
            low = min(tips[f][2] for f in reconstruction.fingers)
            assert low > surface.origin[2] + PAD_HEIGHT - 0.004


@pytest.mark.full
@pytest.mark.parametrize("task", [name for name, t in TASKS.items() if hands_of(t) == 1])
@pytest.mark.parametrize("profile", IMPULSE_PROFILES)
@pytest.mark.parametrize("solid", SOLID)
def test_violent_touches_break_nothing_and_lose_nothing(
    task: str, profile: str, solid: str
) -> None:
    found = soak(task, 120.0, first_seed=100, impulse=IMPULSE_PROFILES[profile], solid=solid)
    assert not found.diverged and not found.lost and not found.hand_table
    assert found.steps == 60_000 + found.respawned and found.deepest > 0.0
    if profile == "safe":
        assert found.deepest < DEEPEST


@pytest.mark.parametrize("solid", SOLID)
def test_a_few_seconds_of_violent_touches_break_nothing_either(solid: str) -> None:
    found = soak("box-to-goal", 8.0, first_seed=1, impulse=IMPULSE_PROFILES["safe"], solid=solid)
    assert not found.diverged and not found.lost and not found.hand_table
    assert found.steps == 4000 + found.respawned and found.deepest > 0.0
    assert found.deepest < DEEPEST


def test_a_thumb_that_a_key_goes_right_through_stays_a_ghost() -> None:
    """MuJoCo calls both parts of it clear there; it was solid at once, 7.7 mm deep."""
    found = soak("chords", 9.0, first_seed=57, impulse=IMPULSE_PROFILES["safe"], solid="hand")
    assert found.deepest < DEEPEST
