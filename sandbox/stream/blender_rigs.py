"""Hands inside Blender: the streamed hand as a new armature, or chains of the user's armature that
follow the streamed hand. This module is part of the script for Blender, as `blender_side` is."""

from __future__ import annotations

import math
from typing import Any, Dict, List, Optional, Sequence, Tuple

import bpy
import mathutils

from sandbox.stream.guest import (
    Line,
    Quaternion,
    Refused,
    Vector,
    between,
    cross,
    dot,
    inverse,
    length,
    minus,
    normal,
    palm_frame,
    plus,
    product,
    rotated,
    times,
    unit,
)

TURNED, AT_ONCE = math.radians(90.0), 0.1
"""Largest plausible turn of a palm (rad) within a time (s). With a larger turn, the pose before or
after it is wrong."""
BY_COUNT = {1: (1,), 2: (0, 1), 3: (0, 1, 2), 4: (1, 2, 3, 4), 5: (0, 1, 2, 3, 4)}
NOTHING: Quaternion = (1.0, 0.0, 0.0, 0.0)


class Editing:
    """Context in which an armature is in edit mode."""

    def __init__(self, armature: Any) -> None:
        self.armature = armature

    def __enter__(self) -> None:
        bpy.context.view_layer.objects.active = self.armature
        bpy.ops.object.mode_set(mode="EDIT")

    def __exit__(self, *_: Any) -> None:
        bpy.ops.object.mode_set(mode="OBJECT")


class Keyed:
    """An armature with keyframes: base class of both kinds of hands."""

    def __init__(self, armature: Any) -> None:
        self.armature = armature
        self.run = ""
        self.start: Tuple[float, float] = (0.0, 0.0)  # frame, and s of the stream
        self.frames: List[int] = []  # first and last
        self.last: Dict[str, Quaternion] = {}
        self.absolute = True
        self.palm: Optional[Tuple[Quaternion, float]] = None  # turn at the last moment, time (s)
        self.jumps: List[Tuple[float, int]] = []  # turns beyond TURNED, rad, and their frames

    def begin(self, line: Line) -> bool:
        """Starts a new take if the stream has begun again with this line; True if it has."""
        if line.run == self.run:
            return False
        self.run, self.start = line.run, (float(bpy.context.scene.frame_current), line.time)
        self.palm = None
        return True

    def frame_of(self, line: Line) -> int:
        """The frame of a moment; in a window, it becomes the current frame."""
        scene = bpy.context.scene
        rate = scene.render.fps / scene.render.fps_base
        frame = int(round(self.start[0] + (line.time - self.start[1]) * rate))
        self.frames = [min([frame, *self.frames]), max([frame, *self.frames])]
        if not bpy.app.background and scene.frame_current != frame:
            scene.frame_set(frame)
        before, since = self.palm or (line.turn, line.time)
        angle = apart(line.turn, before)
        if angle > TURNED and line.time - since < AT_ONCE:
            self.jumps.append((angle, frame))
        self.palm = line.turn, line.time
        return frame

    def put(self, name: str, turn: Quaternion, frame: int, place: Optional[Vector] = None) -> None:
        """Sets keyframes for turn and place of a bone, relative to rest, in the bone's own axes."""
        bone = self.armature.pose.bones[name]
        if sum(a * b for a, b in zip(turn, self.last.get(name, turn))) < 0.0:
            turn = (-turn[0], -turn[1], -turn[2], -turn[3])
        self.last[name] = turn
        bone.rotation_mode = "QUATERNION"
        bone.rotation_quaternion = turn
        bone.keyframe_insert("rotation_quaternion", frame=frame)
        if place is not None:
            bone.location = place
            bone.keyframe_insert("location", frame=frame)

    def rest(self, name: str) -> Quaternion:
        """Turn of a bone at rest, in the armature's frame."""
        return unit(self.armature.data.bones[name].matrix_local.to_quaternion())


class OwnHand(Keyed):
    """An armature with the joints and the motion of the streamed hand."""

    def __init__(self, line: Line) -> None:
        data = bpy.data.armatures.new("hand_sandbox_" + line.side)
        super().__init__(bpy.data.objects.new("hand_sandbox_" + line.side, data))
        bpy.context.scene.collection.objects.link(self.armature)
        self.names = [bone[0] for bone in line.bones]
        self.parents = [bone[1] for bone in line.bones]
        self.frames_at_rest: List[Quaternion] = []
        places: List[Vector] = []
        for _, parent, shift, turn in line.bones:
            above = self.frames_at_rest[parent] if parent >= 0 else NOTHING
            root = places[parent] if parent >= 0 else (0.0, 0.0, 0.0)
            places.append(plus(root, rotated(above, shift)))
            self.frames_at_rest.append(product(above, turn))
        with Editing(self.armature):
            self._bones(line, places)
        self.rests = [self.rest(name) for name in self.names]

    def _bones(self, line: Line, places: List[Vector]) -> None:
        made: List[Any] = []
        for j, name in enumerate(self.names):
            bone = self.armature.data.edit_bones.new(name)
            below = [places[k] for k, parent in enumerate(self.parents) if parent == j]
            if j in line.ends:
                below = [plus(places[j], rotated(self.frames_at_rest[j], line.ends[j]))]
            bone.head, bone.tail = places[j], below[len(below) // 2]
            if self.parents[j] >= 0:
                bone.parent = made[self.parents[j]]
            made.append(bone)

    def update(self, line: Line) -> None:
        """Processes one moment."""
        self.begin(line)
        frame = self.frame_of(line)
        turns = {0: line.turn, **line.turns}
        for j, turn in turns.items():
            if j >= len(self.names):
                raise Refused("the line turns a joint that the streamed hand does not have")
            above = self.frames_at_rest[self.parents[j]] if j else NOTHING
            moved = product(product(above, turn), inverse(self.frames_at_rest[j]))
            own = product(product(inverse(self.rests[j]), moved), self.rests[j])
            place = rotated(inverse(self.rests[0]), line.place) if j == 0 else None
            self.put(self.names[j], own, frame, place)


class ForeignRig(Keyed):
    """Chains of the user's armature. They follow the fingers as closely as their bones allow."""

    def __init__(
        self,
        armature: Any,
        firsts: Sequence[str],
        fingers: Optional[Sequence[int]],
        side: str,
        root: Optional[str],
        scale: Optional[float],
        absolute: bool = False,
    ) -> None:
        super().__init__(armature)
        if len(firsts) not in BY_COUNT:
            raise Refused(
                "%d bones are selected: select the first bones of 1 to 5 chains" % len(firsts)
            )
        self.fingers = BY_COUNT[len(firsts)] if fingers is None else tuple(fingers)
        if len(self.fingers) != len(firsts) or len({*self.fingers} & {*range(5)}) != len(firsts):
            raise Refused("fingers=%r do not name each of %d chains" % (self.fingers, len(firsts)))
        self.chains = [self._chain(name) for name in firsts]
        every = [name for chain in self.chains for name in chain]
        if len({*every}) != len(every):
            raise Refused("one of the bones is in the chain of another bone")
        bones = armature.data.bones
        self.bones = [
            [tuple(bones[n].tail_local - bones[n].head_local) for n in c] for c in self.chains
        ]
        self.lengths = [sum(length(b) for b in chain) for chain in self.bones]
        places = [
            [tuple(bones[c[0]].head_local), tuple(bones[c[-1]].tail_local)] for c in self.chains
        ]
        self.frame = palm_frame(places, self.fingers, side, (0.0, 0.0, 1.0))
        above = {bones[name].parent.name if bones[name].parent else "" for name in firsts}
        self.root = root if root is not None else above.pop() if len(above) == 1 else ""
        self.scale, self.absolute = scale, absolute
        self.first: Tuple[Vector, Quaternion] = ((0.0, 0.0, 0.0), NOTHING)

    def _chain(self, name: str) -> List[str]:
        if name not in self.armature.data.bones:
            there = ", ".join(bone.name for bone in self.armature.data.bones)
            raise Refused("no bone has the name %s; the armature's bones: %s" % (name, there))
        chain = [self.armature.data.bones[name]]
        while chain[-1].children:
            chain.append(chain[-1].children[0])
        return [bone.name for bone in chain]

    def update(self, line: Line) -> None:
        """Processes one moment."""
        if self.begin(line):
            self.first = (line.place, line.turn)
        frame = self.frame_of(line)
        known = [
            (size, line.chains[finger][2])
            for finger, size in zip(self.fingers, self.lengths)
            if finger in line.chains
        ]
        if self.scale is None and known:
            self.scale = sum(a for a, _ in known) / sum(b for _, b in known)
        if self.root and self.scale:
            self._follow(line, frame)
        for finger, chain, bones in zip(self.fingers, self.chains, self.bones):
            if finger in line.chains:
                way, back, _ = line.chains[finger]
                self._bend(chain, bones, self._out(way), self._out(back), frame)

    def _out(self, a: Vector) -> Vector:
        """Converts a vector from the palm's frame to the frame of the armature at rest."""
        rows = self.frame
        return (dot(rows[0], a), dot(rows[1], a), dot(rows[2], a))

    def _follow(self, line: Line, frame: int) -> None:
        rest = self.rest(self.root)
        turned, moved = self._placed(line) if self.absolute else self._moved(line)
        self.put(
            self.root,
            product(product(inverse(rest), turned), rest),
            frame,
            rotated(inverse(rest), moved),
        )

    def _moved(self, line: Line) -> Tuple[Quaternion, Vector]:
        """Turn and displacement of the palm from rest, in the armature's frame, equal to those of
        the streamed hand since its first moment."""
        there = unit(self.armature.matrix_world.to_quaternion())
        size = self.armature.matrix_world.median_scale or 1.0
        turned = product(line.turn, inverse(self.first[1]))
        turned = product(product(inverse(there), turned), there)
        moved = times(minus(line.place, self.first[0]), float(self.scale or 1.0) / size)
        return turned, rotated(inverse(there), moved)

    def _placed(self, line: Line) -> Tuple[Quaternion, Vector]:
        """Turn and displacement of the palm from rest, in the armature's frame, that bring the palm
        to the place of the streamed hand."""
        there = unit(self.armature.matrix_world.to_quaternion())
        palm = unit(mathutils.Matrix(self.frame).to_quaternion())
        turned = product(product(inverse(there), line.turn), inverse(palm))
        world = mathutils.Vector(times(line.place, float(self.scale or 1.0)))
        place = tuple(self.armature.matrix_world.inverted() @ world)
        return turned, minus(place, tuple(self.armature.data.bones[self.root].head_local))

    def _bend(
        self, chain: List[str], bones: List[Any], way: Vector, back: Vector, frame: int
    ) -> None:
        wanted = bent([length(b) for b in bones], way, back)
        above = NOTHING
        for name, bone, direction in zip(chain, bones, wanted):
            # Least twist: each bone continues from the turn of the bone above.
            now = product(between(rotated(above, bone), direction), above)
            rest = self.rest(name)
            turn = product(product(inverse(above), now), rest)
            self.put(name, product(inverse(rest), turn), frame)
            above = now


def apart(a: Quaternion, b: Quaternion) -> float:
    """Angle (rad) between two turns."""
    return 2.0 * math.acos(min(1.0, abs(sum(x * y for x, y in zip(a, b)))))


def bent(sizes: Sequence[float], way: Vector, back: Vector) -> List[Vector]:
    """Directions of the bones of an evenly bent chain that ends at a given place.

    Args:
        sizes: Lengths of the bones.
        way: Vector from the start to the end, divided by the length of the chain.
        back: Direction in which the chain bulges.
    """
    whole, reach = sum(sizes), length(way)
    if reach < 1e-6:
        raise Refused("a finger ends where it begins, so it has no direction")
    along = normal(way)
    across = cross(cross(along, back), along)
    if length(across) < 1e-6:
        across = cross(along, (0.0, 0.0, 1.0) if abs(along[2]) < 0.9 else (1.0, 0.0, 0.0))
    across = normal(across)

    def end(angle: float) -> Tuple[float, float]:
        return (
            sum(size * math.cos(i * angle) for i, size in enumerate(sizes)),
            -sum(size * math.sin(i * angle) for i, size in enumerate(sizes)),
        )

    # The end comes nearer as the angle grows, up to the angle `high`.
    low, high = 0.0, 2.0 * math.pi / max(len(sizes), 2)
    for _ in range(40):
        middle = 0.5 * (low + high)
        far = math.hypot(*end(middle)) > reach * whole
        low, high = (middle, high) if far else (low, middle)
    x, y = end(low)
    lean = -math.atan2(y, x)
    out = []
    for i in range(len(sizes)):
        a = lean - i * low
        out.append(plus(times(along, math.cos(a)), times(across, math.sin(a))))
    return out
