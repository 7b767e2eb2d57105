"""A hand turns solid outside of things only, and a person is told what keeps it a ghost."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest

from encoders.reconstruction.hand_motion import Phase
from encoders.reconstruction.reconstructor import Reconstruction
from models.hand import Hand
from models.kinematics import Kinematics
from models.objects import Box
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from sandbox.session.collision_gating import (
    GHOST,
    CollisionGate,
    CollisionGatingRules,
)
from sandbox.session.session import Session
from tests.support.scripted import box_xy, pinch, run, scripted

INTO_THE_BOX, BESIDE_IT = 0.03, 0.09
"""m between thumb and fingers; the box is 50 mm wide."""


def grip(gap: float, contact: str = "hard", until: float = 99.0, **settings: Any) -> Session:
    """A hand over the box, its fingers so far apart; beside it after `until` s."""
    empty = scripted(lambda now: (), seed=1)
    at = box_xy(empty)
    empty.close()
    touch = pinch(at, lambda now: gap if now < until else BESIDE_IT)
    return scripted(touch, seed=1, contact=contact, **settings)


@pytest.mark.parametrize(("gap", "contact"), [(BESIDE_IT, "hard"), (INTO_THE_BOX, "none")])
def test_a_hand_beside_things_or_one_that_wants_to_pass_through_is_told_nothing(
    gap: float, contact: str
) -> None:
    session = grip(gap, contact)
    for _ in range(5):
        run(session, 0.5)
        assert not session.snapshot().notice


@pytest.mark.parametrize("together", [True, False])
def test_one_finger_inside_a_thing_holds_up_the_others_where_a_hand_becomes_solid_as_a_whole(
    together: bool,
) -> None:
    q = np.zeros(48)
    q[2] = 0.3
    x, y, z = Kinematics(ADULT).tips(q)[1].tolist()
    scene = Scene(SceneSpec((Hand(),), (Box("bead", (0.003,) * 3, 0.01, (x, y, z)),)))
    data = mujoco.MjData(scene.model)
    data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, q)
    mujoco.mj_forward(scene.model, data)
    gate = CollisionGate(scene, 0, CollisionGatingRules(together=together))
    every = frozenset(range(5))

    def solid(fingers: frozenset[int]) -> frozenset[int]:
        gate.update(data, Reconstruction(q, Phase.DOWN, fingers, None, 1.0, 0.0))
        return gate.fingers

    assert solid(every) == (GHOST if together else every - {1})
    # Without it they are all outside, and then it has to stay out alone.
    assert solid(every - {1}) == every - {1}
    assert solid(every) == every - {1}
    assert solid(GHOST) == GHOST
