"""Offsets from touches to fingertips: beside objects, and while fingers hold or release an object.

People put their fingers against an object. A touch is the place of the middle of a fingertip, and
the tip is a ball of 8 mm radius. Without an offset, a finger at a face would therefore become solid
inside the object. While the tip is still a ghost, it is moved out along the surface, by little more
than its radius. As long as the tip is solid near objects, it keeps this offset from its touch. The
offset rotates with the touches. So, when the fingers close, they press as soon as they reach the
face.

A grip stores force in the servos of every finger, also along the faces of the object. If fingers
opened slowly, this force would turn the object, and the object would follow the fingers. Lifted
fingers become ghosts in one step and leave the object in place. Spreading fingers also leave it in
place: while they open by a few millimetres their tips do not move, and then the hand becomes a
ghost.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import cos, expm1, sin, sqrt

import numpy as np

from encoders.reconstruction.hand_motion import common_motion
from encoders.reconstruction.reconstructor import Reconstruction
from models.arithmetic import Array, total
from models.frames import FINGERS
from models.objects import SceneObject
from models.scene import CONTROL_PERIOD, BodyPoses, Scene
from models.surface import Surface
from sandbox.session.collision_gating import GHOST, CollisionGate

OPENED = 0.004
"""Spread at which the fingers let go, m: the mean increase of the fingers' distances from their
centre. Resting touches tremble by a millimetre."""
SURE = 0.001
"""Spread above which the fingers are expected to spread further, m."""
RELEASED_FADING = 0.07
"""Speed at which tips return to their touches after a release, m/s."""
MEMORY = 1.0
"""Time constant with which the remembered narrowest width of a grip approaches the current width,
s. Fingers that open slowly therefore loosen the grip."""

_Touches = Mapping[int, tuple[float, float]]
"""Touches (x, y) on the surface by finger, m."""

_Offsets = list[tuple[float, float]]
"""Offsets (x, y) of the five fingers along the surface, m, y down."""


class Grip:
    """Keeps the width of a grip of solid fingers, and detects when the fingers let go."""

    def __init__(self) -> None:
        self._offsets: _Offsets | None = None
        self._narrow: dict[int, float] = {}
        self._held: dict[int, float] = {}

    @property
    def offsets(self) -> Array | None:
        """Offsets (5, 2) along the surface, m, y down, from touches to tips; None if all are 0."""
        return None if self._offsets is None else np.array(self._offsets)

    def step(self, touches: _Touches, solid: frozenset[int]) -> bool:
        """Updates the grip; returns True in the step in which the fingers let go.

        Args:
            touches: Touches of all fingers.
            solid: Fingers that are solid now.
        """
        self._offsets = _faded(self._offsets)
        holding = sorted(solid & touches.keys())
        if len(holding) < 2:
            self._narrow = {}
            return False
        n = len(holding)
        x = y = 0.0
        for finger in holding:
            right, down = touches[finger]
            x, y = x + right, y + down
        x, y = x / n, y / n
        ways: dict[int, tuple[float, float]] = {}
        far: dict[int, float] = {}
        for finger in holding:
            right, down = touches[finger]
            right, down = ways[finger] = right - x, down - y
            far[finger] = sqrt(right * right + down * down)
        if self._narrow.keys() != far.keys():
            self._narrow, self._held = far, {}
            return False
        before, kept = self._held, {}
        for finger, now in far.items():
            wider = now - self._narrow[finger]
            self._narrow[finger] += wider if wider < 0.0 else _FORGOTTEN * wider
            kept[finger] = now - self._narrow[finger]
        self._held = kept
        opened = total(kept.values()) / n
        if opened > OPENED:
            self._narrow = {}
            return True
        fading = self._offsets
        offsets = list(fading or [(0.0, 0.0)] * len(FINGERS))
        for finger, way in kept.items():
            # The offset applies in the next step, when the touches will have opened further.
            further = way - before.get(finger, way) if opened > SURE else 0.0
            share = (way + max(further, 0.0)) / far[finger] if way > 0.0 else 0.0
            right, down = ways[finger]
            x, y = -share * right, -share * down
            if fading is None or _length(x, y) >= _length(*offsets[finger]):
                offsets[finger] = x, y
        self._offsets = offsets
        return False


def _faded(offsets: _Offsets | None) -> _Offsets | None:
    """Offsets after a control period without a grip; None if all are 0."""
    if offsets is None:
        return None
    faded, any_left = [], False
    for x, y in offsets:
        if not (x or y):
            faded.append((x, y))
            continue
        far = _length(x, y)
        left = max(far - RELEASED_FADING * CONTROL_PERIOD, 0.0)
        share = left / max(far, 1e-12)
        faded.append((x * share, y * share))
        any_left = any_left or left > 0.0
    return faded if any_left else None


def _length(x: float, y: float) -> float:
    return sqrt(x * x + y * y)


_FORGOTTEN = -expm1(-CONTROL_PERIOD / MEMORY)


MARGIN = 0.0012
"""Clearance that an offset gives a fingertip from objects, m. A touch trembles, and the simulated
finger follows its command within less than a millimetre."""
REACH = 0.007
"""Largest offset minus the fingertip's radius, m. It covers the margin, and the additional offset
of a leaning finger beside a high object (measured at db485e42)."""
INSIDE = 0.002
"""Depth of a touch in an object, m. The finger of a deeper touch gets no offset, and the person
gets a notice. Smaller depths are allowed because touches tremble, and because people put a
fingertip's middle onto the visible edge."""
TOWARDS = 0.3
"""Cosine of the angle between an offset and the direction to the hand's other touches. Above it, a
finger gets no offset. In a grip the object is between the fingers, so that the way out leads away
from the other touches."""
SPEED = 0.15
"""Speed of an offset along the surface, m/s: 2.4 mm in a control period."""
FADING = 0.05
"""Speed at which a solid fingertip returns to a touch that is well clear of objects, m/s."""
WELL_CLEAR = 0.003
"""The offset of a solid finger fades if the finger, without the offset, would be farther than this
from all objects, m."""

_PROBE = 0.0005
"""Distance to either side at which the clearance is probed for its gradient, m."""
_LEAST_SLOPE = 0.3
"""Gradient of the clearance along the surface; below it, there is no way out along the surface."""
_ROUNDS = 12
_NONE = (0.0, 0.0)
_NO_OFFSETS = np.zeros((len(FINGERS), 2))

_Poses = dict[str, tuple[Array, Array]]
"""Position (3,), m, and rotation (3, 3) of objects by name."""

_Clearance = Callable[[Array], Array]
"""Function from points (n, 3) of a finger to the clearances (n,) of its surface, m."""


class TipOffsets:
    """Computes the offsets that move a hand's fingertips out of objects and keep the grip's width.

    Args:
        scene: The scene.
        hand: Index of the hand.
        surface: Touch surface of the hand.
        gate: The hand's collision gating.
    """

    def __init__(self, scene: Scene, hand: int, surface: Surface, gate: CollisionGate) -> None:
        self._scene, self._surface, self._gate = scene, surface, gate
        last = {link.finger: link for link in scene.spec.hands[hand].links}
        self._radius = {f: link.radius for f, link in last.items()}
        # World vectors of a step to the right and of a step down on the surface.
        self._right, self._down = surface.rotation[:, 0], -surface.rotation[:, 1]
        self._right_of, self._down_of = self._right.tolist(), self._down.tolist()
        self._corner = surface.corner.tolist()
        # Largest distance from a touch to any point of the finger's solid part, at the largest
        # offset.
        reach = {
            f: (1.0 - link.solid_from) * link.length + 2 * link.radius + REACH
            for f, link in last.items()
        }
        self._things = [
            (
                thing,
                scene.object_bodies[thing.name],
                {f: (scene.object_radius(thing.name) + far) ** 2 for f, far in reach.items()},
            )
            for thing in scene.spec.objects
        ]
        self._out: Array | None = None
        self._grip = Grip()
        self._touches: Mapping[int, tuple[float, float]] = {}
        self._near: dict[int, list[SceneObject]] = {}

    def releases(
        self, data: BodyPoses, reconstruction: Reconstruction, ghost: bool = False
    ) -> bool:
        """Returns True in the step in which the fingers spread and the hand becomes a ghost.

        Args:
            data: Current state of the simulation.
            reconstruction: Current reconstruction from touches.
            ghost: True if the contact mode lets the hand pass through all objects.
        """
        # A finger that a robot hand lacks cannot hold an object.
        touches = {f: xy for f, xy in reconstruction.touches.items() if f in self._radius}
        self._before, self._touches = self._touches, touches
        self._near = {} if ghost else self._objects_near(data)
        return self._grip.step(self._touches, self._gate.fingers if self._near else GHOST)

    def step(self, data: BodyPoses, reconstruction: Reconstruction) -> Array | None:
        """Returns the offsets (5, 2) from touches to fingertips in the next step, or None.

        Offsets are along the surface, m, y down. None means that all are 0.

        Args:
            data: Current state of the simulation.
            reconstruction: Current reconstruction from touches. `releases` must have been called
                with it.
        """
        solid = self._gate.fingers
        if self._out is not None or (self._near and not self._touches.keys() <= solid):
            out = np.zeros((len(FINGERS), 2))
            turned = self._turned()
            all_solid = self._touches.keys() <= solid
            behind = None if all_solid else self._gate.behind_tips(data)
            touches = np.array([*self._touches.values()]).reshape(-1, 2)
            tips = self._surface.to_world(touches, reconstruction.tip_height)
            poses: _Poses = {}
            for finger, tip in zip(self._touches, tips, strict=True):
                offset = turned[finger]
                if finger in solid and not (offset[0] or offset[1]):
                    out[finger] = offset
                    continue
                clear = self._clearance(data, finger, poses)
                if behind is None or finger in solid:
                    out[finger] = self._next_offset(offset, tip, data, clear, finger)
                else:
                    out[finger] = self._led_out(offset, tip, behind[:, finger], clear, finger)
            self._out = out if out.any() else None
        kept = self._grip.offsets
        if self._out is None:
            return kept
        return self._out if kept is None else self._out + kept

    def _objects_near(self, data: BodyPoses) -> dict[int, list[SceneObject]]:
        """Returns the objects in reach of each finger. Uses plain floats, as it runs every step."""
        near: dict[int, list[SceneObject]] = {}
        for thing, body, reach in self._things:
            a, b, c = data.xpos[body].tolist()
            a, b, c = a - self._corner[0], b - self._corner[1], c - self._corner[2]
            x = self._right_of[0] * a + self._right_of[1] * b + self._right_of[2] * c
            y = self._down_of[0] * a + self._down_of[1] * b + self._down_of[2] * c
            for finger, (right, down) in self._touches.items():
                if (right - x) * (right - x) + (down - y) * (down - y) < reach[finger]:
                    near.setdefault(finger, []).append(thing)
        return near

    def _turned(self) -> Array:
        """Returns the offsets, rotated by the rotation of the touches since the last step."""
        if self._out is None:
            return _NO_OFFSETS
        known = sorted(self._touches.keys() & self._before.keys())
        if len(known) < 2:
            return self._out
        motion = common_motion([self._before[f] for f in known], [self._touches[f] for f in known])
        # Counterclockwise on the screen, whose y points down.
        c, s = cos(motion.turn), sin(motion.turn)
        x, y = self._out[:, 0], self._out[:, 1]
        turned = np.empty(self._out.shape)
        turned[:, 0], turned[:, 1] = c * x + s * y, c * y - s * x
        return turned

    def _clearance(self, data: BodyPoses, finger: int, poses: _Poses) -> _Clearance | None:
        """Returns the clearance of a finger from the objects in its reach; None without any.

        Poses of these objects are added to `poses`.
        """
        if finger not in self._near:
            return None
        near = []
        for thing in self._near[finger]:
            if thing.name not in poses:
                poses[thing.name] = self._scene.object_pose(data, thing.name)
            near.append((thing, *poses[thing.name]))
        radius = self._radius[finger]

        def clear(points: Array) -> Array:
            distances = [
                thing.clearance(points, position, rotation) for thing, position, rotation in near
            ]
            nearest = distances[0]
            for other in distances[1:]:
                nearest = np.minimum(nearest, other)
            return nearest - radius

        return clear

    def _next_offset(
        self, offset: Array, tip: Array, data: BodyPoses, clear: _Clearance | None, finger: int
    ) -> Array:
        """Returns the next offset (2,) of a solid finger whose offset is not 0, m."""
        # Test the tip first: it is mostly sufficient, and some distances take long to compute.
        if clear is not None and (
            clear(tip[None]).min() <= WELL_CLEAR
            or clear(tip + self._gate.behind_tips(data)[:, finger]).min() <= WELL_CLEAR
        ):
            return offset
        return _towards(offset, _NONE, FADING)

    def _led_out(
        self, offset: Array, tip: Array, behind: Array, clear: _Clearance | None, finger: int
    ) -> Array:
        """Returns the next offset (2,) of a finger that is not solid yet, m.

        Args:
            offset: Current offset (2,), m.
            tip: Place (3,) of the tip without an offset, m.
            behind: Points (points, 3) of the finger, relative to its tip, m.
            clear: Clearance of the finger.
            finger: Label of the finger.
        """
        way: tuple[float, float] | None = _NONE
        if clear is not None:
            way = self._way_out(tip, behind, clear, self._radius[finger])
            if way is not None and self._towards_touches(finger, way):
                way = None
        # Without a way out the finger stays in place, and the person gets a notice.
        return offset if way is None else _towards(offset, way, SPEED)

    def _towards_touches(self, finger: int, way: tuple[float, float]) -> bool:
        """True if an offset (x, y), m, moves a finger towards the hand's other touches."""
        others = [touch for f, touch in self._touches.items() if f != finger]
        if not others:
            return False
        x, y = self._touches[finger]
        right = x - total(a for a, _ in others) / len(others)
        down = y - total(b for _, b in others) / len(others)
        far = _length(right, down) * _length(*way)
        return right * way[0] + down * way[1] < -TOWARDS * far

    def _way_out(
        self, tip: Array, behind: Array, clear: _Clearance, radius: float
    ) -> tuple[float, float] | None:
        """Returns the shortest offset (x, y) that clears a finger of objects, m.

        Returns None if there is none within reach, or if the touch is inside an object.
        """
        free = float(clear(tip + behind).min())
        if free >= MARGIN:
            return _NONE
        steps = _PROBE * np.stack([np.zeros(3), self._right, -self._right, self._down, -self._down])
        here, right, left, down, up = clear(tip + steps).tolist()
        if here < -radius - INSIDE:
            return None
        x, y = (right - left) / (2 * _PROBE), (down - up) / (2 * _PROBE)
        slope = sqrt(x * x + y * y)
        if slope < _LEAST_SLOPE:
            return None
        x, y = x / slope, y / slope
        out = x * self._right + y * self._down
        far = 0.0
        for _ in range(_ROUNDS):
            far += max(MARGIN - free, 1e-4)
            if far > radius + REACH:
                return None
            free = float(clear(tip + far * out + behind).min())
            if free >= MARGIN - 1e-6:
                return far * x, far * y
        return None


def _towards(offset: Array, goal: tuple[float, float], speed: float) -> Array:
    """The offset (2,) after it moved towards a goal for a control period, at a speed, m/s."""
    x, y = offset.tolist()
    right, down = goal[0] - x, goal[1] - y
    way, most = sqrt(right * right + down * down), speed * CONTROL_PERIOD
    if way <= most:
        return np.array(goal)
    return np.array([x + most / way * right, y + most / way * down])
