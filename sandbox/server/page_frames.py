"""A session's data for a page: its scene, the skins of its hands, and a frame per control step.

A frame is binary, little-endian: a header of 32 bytes, one pose of seven float32 per body (position
in m, quaternion w, x, y, z), and score, contacts and goals as JSON of `protocol.State`.

    offset  type     content
    0       uint8    PROTOCOL
    1       uint8    KIND, 1
    2       uint16   number of bodies
    4       uint32   number of the scene
    8       uint32   number of the frame, from 1
    12      uint32   `seq` of the newest touch message that took effect in the frame, lower 32 bits
    16      float64  simulated time, s
    24      uint32   length of the JSON, bytes
    28      uint32   0

A skin is sent once per hand, before the frames that move it: a header of 16 bytes, the names and
poses of 15 bodies, and arrays over n vertices and m triangles. Each array begins at a multiple of
four bytes.

    offset  type     content
    0       uint8    PROTOCOL
    1       uint8    SKIN_KIND, 2
    2       uint16   length of the JSON, bytes
    4       uint32   n
    8       uint32   m
    12      uint32   0
    16      JSON     names of the bodies that carry the skin, palm first
            float32  15 x 7: poses of these bodies in the bind pose of the vertices, as in a frame
            float32  n x 3: vertices, m
            uint8    n x 4: indices of the bodies that carry a vertex
            uint8    n x 4: weights of these bodies, 255 for a weight of 1
            uint8    n x 4: colour, sRGB, then 255
            uint16   m x 3: triangles, counterclockwise from outside
"""

from __future__ import annotations

import json
import struct
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.hand import SceneHand
from models.message import Message
from models.pose import POSE_SIZE
from models.rotations import matrix_to_quaternion
from models.scene import Scene as SimulatedScene
from models.skeleton import Skeleton
from models.skin.skin import BONES, CUFF, NAIL, SLEEVE, Skin, frames, tone_colours
from models.surface import Surface
from sandbox.server.protocol import (
    PROTOCOL,
    ContactState,
    Geom,
    GoalState,
    HandState,
    Localised,
    Pause,
    SceneMessage,
    State,
    SurfaceView,
    encode,
)
from sandbox.session.messages import NO_LOAD, HandLoad, HandView, Snapshot
from tasks.task import Task, summary

_KINDS: dict[Any, Any] = {
    mujoco.mjtGeom.mjGEOM_PLANE: "plane",
    mujoco.mjtGeom.mjGEOM_SPHERE: "sphere",
    mujoco.mjtGeom.mjGEOM_CAPSULE: "capsule",
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_CYLINDER: "cylinder",
    mujoco.mjtGeom.mjGEOM_BOX: "box",
}


def describe_scene(
    number: int,
    scene: SimulatedScene,
    task: Task,
    surface: Surface,
    hand: str,
    caption: str,
    in_air: bool = False,
    scored: bool = True,
) -> SceneMessage:
    """Returns the message with a scene's shapes, task and touch rectangle.

    Args:
        number: Number of the scene, counted by the server.
        scene: The compiled scene.
        task: The drawn task.
        surface: The surface, placed in the world.
        hand: `right` or `left`.
        caption: Text that is shown with the scene, such as `simulated user`; empty without.
        in_air: True if hands are tracked in the air.
        scored: False if the result does not count.
    """
    model = scene.model
    things = {thing.name for thing in task.objects}
    palms = {model.body(hand.palm).id for hand in scene.spec.hands}
    geoms = []
    for i in range(model.ngeom):
        root = model.body(int(model.body_rootid[model.geom_bodyid[i]])).name
        kind = _KINDS.get(mujoco.mjtGeom(int(model.geom_type[i])))
        if int(model.geom_bodyid[i]) in palms and kind is None:
            geoms.append(_palm_box(scene, i, root, things))
        if kind is None or model.geom_rgba[i, 3] == 0:
            continue
        geoms.append(
            Geom(
                int(model.geom_bodyid[i]),
                kind,
                _floats(model.geom_size[i]),
                _floats(model.geom_pos[i]),
                _floats(model.geom_quat[i]),
                _floats(model.geom_rgba[i]),
                _part(scene, root, things),
            )
        )
    return SceneMessage(
        number,
        task.name,
        summary(type(task)),
        task.seed,
        "left" if hand == "left" else "right",
        # A hand in the air needs no lift control.
        0.0 if in_air else float(task.lift_range),
        task.time_limit,
        SurfaceView(
            surface.width_in,
            surface.height_in,
            surface.origin,
            _floats(surface.rotation.ravel()),
            surface.calibrated,
            surface.scale,
        ),
        [model.body(i).name for i in range(model.nbody)],
        geoms,
        localised(caption) if caption else None,
        in_air,
        scored,
        fingers=task.fewest_fingers,
    )


def _palm_box(scene: SimulatedScene, geom: int, root: str, things: set[str]) -> Geom:
    """Returns a box around a mesh of a robot's palm, since the page draws no meshes."""
    model, turn, place = scene.model, np.empty(9), np.empty(3)
    mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
    mujoco.mju_mulMatVec3(place, turn, model.geom_aabb[geom, :3])
    return Geom(
        int(model.geom_bodyid[geom]),
        "box",
        _floats(model.geom_aabb[geom, 3:]),
        _floats(model.geom_pos[geom] + place),
        _floats(model.geom_quat[geom]),
        _floats(model.geom_rgba[geom]),
        _part(scene, root, things),
    )


def localised(text: str) -> Localised:
    """Returns a sentence in the form for the page; the key is empty if the text has none."""
    if isinstance(text, Message):
        return Localised(text.key, dict(text.values), str(text))
    return Localised("", {}, text)


def state_of(snapshot: Snapshot, pause: Pause, own: int | None = None) -> State:
    """Returns the values of a snapshot other than poses.

    Args:
        snapshot: The snapshot.
        pause: Reason why simulated time stands still; empty while it runs.
        own: Index of the hand whose contacts come from the page; None if all contacts come from one
            device. Contacts of other hands get negative ids, which the page's fingers do not use.
    """
    score, hands = snapshot.score, snapshot.hands
    loads = snapshot.loads or [NO_LOAD] * len(hands)
    return State(
        snapshot.time,
        score.status.value,
        score.progress,
        localised(score.reason) if score.reason else None,
        score.final,
        score.held,
        [
            _hand(hand, load, own in (None, i))
            for i, (hand, load) in enumerate(zip(hands, loads, strict=True))
        ],
        [GoalState(g.object, _floats(g.position), float(g.yaw)) for g in snapshot.goals if g.drawn],
        [localised(notice) for notice in snapshot.notices],
        pause,
    )


class BodyKinematics:
    """Computes the poses of all bodies of a scene from joint positions, in its own `MjData`."""

    def __init__(self, scene: SimulatedScene) -> None:
        self._model = scene.model
        self._data = mujoco.MjData(scene.model)
        self._out = np.empty((scene.model.nbody, 7), np.float32)

    def __call__(self, qpos: NDArray[np.float64]) -> NDArray[np.float32]:
        """Returns (bodies, 7): position (m) and quaternion (w, x, y, z) in the world."""
        self._data.qpos[:] = qpos
        mujoco.mj_kinematics(self._model, self._data)
        self._out[:, :3], self._out[:, 3:] = self._data.xpos, self._data.xquat
        return self._out


def _hand(hand: HandView, load: HandLoad, own: bool) -> HandState:
    full, contacts = load.full, []
    for c, place in zip(hand.contacts, hand.places, strict=True):
        finger = NO_LOAD.fingers[0] if c.label is None else load.fingers[c.label]
        contacts.append(
            ContactState(
                c.id if own else -1 - c.id,
                c.label,
                c.state,  # type: ignore[arg-type]
                round(finger.force, 2),
                _floats(place),
                c.sure,
                c.label in hand.inside,
                round(finger.stored, 2),
                c.label in full,
            )
        )
    return HandState(hand.phase, sorted(hand.solid), contacts, round(hand.probability, 3))


def _part(scene: SimulatedScene, root: str, things: set[str]) -> Any:
    if root in things or any(root == f"{name}_bolt" for name in things):
        return "object"
    hands = {h.palm for h in scene.spec.hands}
    return (
        "hand"
        if root in hands or any(root.startswith(h.name) for h in scene.spec.hands)
        else "scenery"
    )


def _floats(values: object) -> Any:
    """Returns all values as a tuple of rounded floats."""
    return tuple(round(v, 7) for v in np.asarray(values, float).ravel().tolist())


KIND = 1
_FRAME_HEADER = struct.Struct("<BBHIIIdII")
POSE_BYTES = 7 * 4


def pack(
    scene: int, touch: int, time: float, poses: NDArray[np.float32], state: State
) -> bytearray:
    """Encodes a frame without its number, which each connection sets by `number_frame`."""
    tail = encode(state)
    head = _FRAME_HEADER.pack(
        PROTOCOL, KIND, len(poses), scene, 0, touch & 0xFFFFFFFF, time, len(tail), 0
    )
    return bytearray(head + np.ascontiguousarray(poses, "<f4").tobytes() + tail)


def number_frame(frame: bytearray, number: int) -> bytes:
    """Sets the number of an encoded frame."""
    struct.pack_into("<I", frame, 8, number & 0xFFFFFFFF)
    return bytes(frame)


SKIN_KIND = 2
_SKIN_HEADER = struct.Struct("<BBHIII")
_FLAT = {"nail": NAIL, "cuff": CUFF, "sleeve": SLEEVE}


def pack_skin(hand: SceneHand) -> bytes:
    """Encodes the skin of a hand; empty if the hand has no skeleton or not the skin's bones."""
    skeleton = hand.skeleton
    if skeleton is None or len(skeleton.bones) != BONES - 1:
        return b""
    names = [hand.palm, *(link.body for link in hand.links)]
    return _packed(skeleton, tuple(names))


def _packed(skeleton: Skeleton, names: tuple[str, ...]) -> bytes:
    skin = Skin.builtin().fitted(skeleton)
    places, turns = frames(skeleton, np.zeros(POSE_SIZE))
    bind = np.concatenate([places, matrix_to_quaternion(turns)], axis=1)
    text = json.dumps(names).encode()
    head = _SKIN_HEADER.pack(PROTOCOL, SKIN_KIND, len(text), len(skin.rest), len(skin.triangles), 0)
    parts = (
        head,
        text,
        bind.astype("<f4").tobytes(),
        skin.rest.astype("<f4").tobytes(),
        skin.bones.tobytes(),
        skin.weights.tobytes(),
        _colours(skin).tobytes(),
        skin.triangles.astype("<u2").tobytes(),
    )
    return b"".join(part + b"\0" * (-len(part) % 4) for part in parts)


def _colours(skin: Skin) -> NDArray[np.uint8]:
    """Returns the colours (n, 4) of the vertices: sRGB, then 255."""
    colours = np.ones((len(skin.rest), 4))
    for part in skin.parts:
        flat = _FLAT.get(part.name.partition("_")[0])
        colours[part.vertices, :3] = (
            tone_colours(skin.tone[part.vertices]) if flat is None else flat
        )
    return np.round(255 * colours).astype(np.uint8)
