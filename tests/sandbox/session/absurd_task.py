"""A task whose simulation really diverges: a box on a spring that pushes the way it has gone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar, Self
from xml.etree.ElementTree import Element, SubElement

from models.objects import Box
from models.surface import Surface
from tasks.box_to_goal import BoxToGoal

GROWTH = 4.0
"""1/s, rate at which the box's turn grows: it passes every limit after a little over 2 s."""


class Runaway(Box):
    """A box that turns about an upright axis on a spring of negative stiffness."""

    def body(self) -> Element:
        body = super().body()
        for joint in body.findall("freejoint"):
            body.remove(joint)
        # Armature outweighs what a box of any mass in the task's range has by itself.
        inertia = 1e-3
        SubElement(
            body,
            "joint",
            {
                "name": self.name,
                "type": "hinge",
                "axis": "0 0 1",
                "armature": f"{inertia}",
                "stiffness": f"{-inertia * GROWTH**2}",
                "springref": "20",
            },
        )
        return body


class Absurd(BoxToGoal):
    """A box above the table that turns faster and faster until its speed means nothing."""

    name: ClassVar[str] = "absurd"

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Self:
        trial: Any = super().draw(seed, surface)
        box = trial.objects[0]
        x, y, z = box.position
        above = Runaway(box.name, box.half_size, box.mass, (x, y, z + 0.1), box.yaw)
        changed: Self = replace(trial, objects=(above,))
        return changed
