"""Where a thing's friction counts, it is felt as written; elsewhere nothing has changed."""

from __future__ import annotations

from models.hand import Hand
from models.mechanisms.mechanism import Mechanism
from models.objects import Box, Cylinder, SceneObject, Tray, Wrench
from models.scene import Scene, SceneSpec

THINGS: tuple[SceneObject, ...] = (
    Box("box", (0.02, 0.02, 0.02), 0.1, (0.0, 0.0, 0.02), friction=0.2),
    Cylinder("pin", 0.01, 0.02, 0.1, (0.1, 0.0, 0.02), friction=0.3),
    Wrench("wrench", 0.1, (0.0, 0.1, 0.01), bolt=0.1),
    Tray("tray", 0.1, (0.0, -0.2, 0.018)),
)
DESK = """<mujoco><worldbody><body name="desk"><geom size=".02" friction=".4"/>
  <body name="lid"><joint range="0 90"/><geom size=".01" friction=".6"/></body>
</body></worldbody></mujoco>"""


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
