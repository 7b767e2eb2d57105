"""Where a thing's friction counts, it is felt as written; elsewhere nothing has changed."""

from __future__ import annotations

import pytest

from models.hand import Hand
from models.mechanisms.mechanism import Mechanism
from models.objects import Box, Cylinder, SceneObject, Tray, Wrench
from models.scene import Scene, SceneSpec
from tests.support.friction_felt import on_link, on_table, parts

THINGS: tuple[SceneObject, ...] = (
    Box("box", (0.02, 0.02, 0.02), 0.1, (0.0, 0.0, 0.02), friction=0.2),
    Cylinder("pin", 0.01, 0.02, 0.1, (0.1, 0.0, 0.02), friction=0.3),
    Wrench("wrench", 0.1, (0.0, 0.1, 0.01), bolt=0.1),
    Tray("tray", 0.1, (0.0, -0.2, 0.018)),
)
DESK = """<mujoco><worldbody><body name="desk"><geom size=".02" friction=".4"/>
  <body name="lid"><joint range="0 90"/><geom size=".01" friction=".6"/></body>
</body></worldbody></mujoco>"""


@pytest.mark.parametrize("written", [0.1, 0.4, 0.7, 1.0])
def test_the_friction_of_a_thing_is_felt_on_the_table_as_written(written: float) -> None:
    assert on_table(written, own=True) == pytest.approx(written, abs=0.01)
    assert on_table(written, own=False) == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("part", [0, 4, 9, 20])
def test_the_friction_of_a_thing_is_felt_on_every_part_of_the_hand_as_written(part: int) -> None:
    assert len(parts()) == 21
    assert on_link(0.1, own=True, part=part) == pytest.approx(0.1, abs=0.01)
    assert on_link(0.1, own=False, part=part) == pytest.approx(1.0, abs=0.01)


def test_of_things_whose_friction_counts_every_part_goes_before_hand_and_table() -> None:
    things = (*THINGS, *Mechanism("desk", DESK, position=(0.3, 0.0, 0.02)).parts)
    scene = Scene(SceneSpec((Hand(),), things, own_friction=True))
    model = scene.model
    highest = max(model.geom_priority[g] for g in (*scene.parts(0), model.geom("table").id))
    for body in scene.object_bodies.values():
        own = model.geom_priority[model.geom_bodyid == body]
        assert own.min() > highest
    assert model.geom_friction[model.geom("box").id, 0] == 0.2
    assert model.geom_friction[model.geom("pin").id, 0] == 0.3
