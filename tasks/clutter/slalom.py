"""Bring a box to its goal through two gates of standing pins."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, sin
from typing import ClassVar

import numpy as np

from models.arithmetic.products import distance
from models.errors import SurfaceTooSmallError
from models.message import Message
from models.objects import Box, Cylinder
from models.surface import Surface
from tasks.box_to_goal import BORDER, POSITION_TOLERANCE, missing
from tasks.clutter.inside import inside
from tasks.clutter.slalom_user import SlalomUser
from tasks.sensing import Sensing
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import UserMaker

EDGE = 0.040
"""m, edge of the box: of the boxes of the stacking tasks, the smallest."""
MASS = (0.050, 0.150)
"""kg, of the box."""

PIN_RADIUS, PIN_HEIGHT = 0.00525, 0.0445
"""m, largest radius and height of an AAA battery (LR03 of IEC 60086-2). One that stands on its end
falls when it is tilted by 13 degrees."""
PIN_MASS = 0.0115
"""kg, of an AAA battery (alkaline; makers' data sheets say 11 to 12 g)."""
COLOURS = ((0.34, 0.71, 0.91), (0.90, 0.62, 0.0))
"""Colours of the pins of the first and of the second gate."""

OPENING = 0.100
"""m between the pins of a gate: the box with a fingertip on either side, 40 + 2 x 16 mm, and 14 mm
to spare on either side."""
GATES_APART = 0.050
"""m from the first gate to the second, along the way."""
LEAD = (0.026, 0.032)
"""m from the start to the first gate, and from the second gate to the goal."""
SHIFT = 0.008
"""m by which the gates are shifted off the straight way, to opposite sides: one who drags the box
straight ahead with fingers on either side has 6 mm to spare."""
PIN_BORDER = 0.005
"""m from the surface's border to the nearest place of a pin."""
TURN = float(np.deg2rad(30.0))
"""rad, largest turn from start to goal."""

STANDS, FALLEN = float(np.deg2rad(5.0)), float(np.deg2rad(30.0))
"""rad, tilt up to which a pin stands, and from which on it has been toppled."""

_TRIES = 20_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class Slalom(TaskDefaults):
    """Bring a box to its goal through two gates of standing pins, without toppling one.

    Scene: a box of 4 cm, 50 to 150 g, and four pins as large and heavy as AAA batteries, standing
    on their ends, two for each gate; friction 0.5 against the table.
    Goal: the box's ghost, 10.2 to 11.4 cm away behind both gates, turned by up to 30 degrees. The
    gates are 100 mm wide, 5 cm apart, and shifted off the straight way by 8 mm, the first to one
    side and the second to the other.
    Success: every pin stands (tilt under 5 degrees), and the box is at its goal as in
    `box-to-goal`: centre within 1 cm, yaw within 10 degrees of the nearest equivalent, tilt under 5
    degrees, on the table, slower than 1 cm/s and touched by no hand, all for 0.5 s without a break,
    within 60 s. The trial is lost once a pin is tilted by 30 degrees. A way around the gates is
    allowed where the surface has room for one.
    Start: place, direction of the way and distances uniform, redrawn until start and goal are 42 mm
    from the border and pins 5 mm; yaw uniform within 45 degrees of the surface's axes; turn uniform
    within 30 degrees; side of the first shift by chance.
    History: version 1.
    """

    name: ClassVar[str] = "slalom"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 60.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.5
    touch_height: ClassVar[float] = 0.022
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"
    user: ClassVar[UserMaker | None] = SlalomUser

    seed: int
    objects: tuple[Box | Cylinder, ...]
    goals: tuple[Goal, ...]

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Slalom:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            SurfaceTooSmallError: The surface has no room for the gates and the way through them.
        """
        rng = np.random.default_rng([seed, cls.version, 22])
        size = surface.size
        for _ in range(_TRIES):
            start = rng.uniform((0.0, 0.0), size)
            angle = float(rng.uniform(-np.pi, np.pi))
            first, last = rng.uniform(*LEAD, 2).tolist()
            side = float(rng.choice((-1.0, 1.0)))
            if not inside(start[None], BORDER, size):
                continue
            along = np.array([cos(angle), sin(angle)])
            across = np.array([-along[1], along[0]])
            end = start + (first + GATES_APART + last) * along
            middles = (
                start + first * along + side * SHIFT * across,
                start + (first + GATES_APART) * along - side * SHIFT * across,
            )
            out = OPENING / 2 + PIN_RADIUS
            pins = [middle + way * out * across for middle in middles for way in (1.0, -1.0)]
            if inside(np.stack([start, end]), BORDER, size) and inside(
                np.stack(pins), PIN_BORDER, size
            ):
                break
        else:
            raise SurfaceTooSmallError(
                cls.name, (surface.width_in, surface.height_in), "two gates of pins", (7.8, 5.9)
            )
        yaw = float(rng.uniform(-np.pi / 4, np.pi / 4))
        turn = float(rng.uniform(-TURN, TURN))
        mass = float(rng.uniform(*MASS))
        places = surface.to_world(np.stack([start, end, *pins]))[:, :2].tolist()
        half = EDGE / 2
        box = Box("box", (half, half, half), mass, (*places[0], half), yaw)
        standing = tuple(
            Cylinder(
                f"pin{i + 1}",
                PIN_RADIUS,
                PIN_HEIGHT / 2,
                PIN_MASS,
                (*place, PIN_HEIGHT / 2),
                rgb=COLOURS[i // 2],
            )
            for i, place in enumerate(places[2:])
        )
        return cls(seed, (box, *standing), (Goal("box", (*places[1], half), yaw + turn),))

    def shifted(self) -> tuple[str, ...]:
        """The box: the pins stay where they are."""
        return ("box",)

    def with_room(self, factor: float) -> Slalom:
        """The same trial with gates so much wider or narrower."""
        placed = {pin.name: pin.position for pin in self.objects[1:]}
        out = OPENING / 2 + PIN_RADIUS
        wider = (factor * OPENING / 2 + PIN_RADIUS) / out
        moved = []
        for pin in self.objects[1:]:
            number = int(pin.name.removeprefix("pin"))
            other = placed[f"pin{number + 1 if number % 2 else number - 1}"]
            x, y = (
                (a + b) / 2 + wider * (a - b) / 2
                for a, b in zip(pin.position[:2], other[:2], strict=True)
            )
            moved.append(replace(pin, position=(x, y, pin.position[2])))
        return replace(self, objects=(self.objects[0], *moved))

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the box is at its goal now, and every pin stands."""
        box, goal = sensing.object("box"), self.goals[0]
        pins = [sensing.object(pin.name) for pin in self.objects[1:]]
        tilt = max(pin.tilt for pin in pins)
        lost = tilt > FALLEN
        reason: str = missing(box, goal)
        if lost:
            reason = Message("pin_toppled", "a pin has been toppled")
        elif tilt > STANDS:
            reason = Message("pin_leans", "a pin does not stand upright")
        off = distance(box.position.tolist(), goal.position)
        way = max(distance(goal.position, self.objects[0].position) - POSITION_TOLERANCE, 1e-9)
        travelled = 1.0 - max(off - POSITION_TOLERANCE, 0.0) / way
        progress = 1.0 if not reason else min(max(travelled, 0.0), 0.99)
        return Measure(not reason, progress, reason, lost)
