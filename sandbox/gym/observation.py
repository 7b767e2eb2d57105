"""Parts of an agent's observation, each with its bounds and its reader; and rendered pictures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from encoders.reconstruction.hand_motion import Phase
from models.arithmetic import Array
from models.errors import InputError
from models.pose import POSE_SIZE
from models.scene import Scene
from models.surface import Surface
from sandbox.gym.actions import SLOTS, Hands
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from tasks.task import Task

if TYPE_CHECKING:
    from sandbox.views.renderer import Renderer


class Pictures:
    """Renders pictures of scenes.

    Creating a renderer takes most of a second. A renderer is therefore reused while scenes look
    alike: objects may start at other places, but shapes and colours must be the same.

    Args:
        surface: The touch surface.
        size: Width and height of a picture, px.

    Attributes:
        made: Number of renderers created so far.
    """

    def __init__(self, surface: Surface, size: tuple[int, int]) -> None:
        self._surface, self._size = surface, size
        self._renderer: Renderer | None = None
        self._scene: Scene | None = None
        self.made = 0

    def draw(self, scene: Scene, snapshot: Snapshot) -> NDArray[np.uint8]:
        """Returns the picture (height, width, 3) of a snapshot.

        Raises:
            GraphicsError: There is no OpenGL on this machine.
        """
        if self._renderer is None or self._scene is None or not _alike(scene, self._scene):
            # The renderer loads OpenGL, which most training does not need.
            from sandbox.views.renderer import Renderer

            self.close()
            self._renderer = Renderer(scene, self._surface, self._size)
            self._scene, self.made = scene, self.made + 1
        return np.asarray(self._renderer.frame(snapshot))

    def close(self) -> None:
        """Closes the renderer."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None


def _alike(scene: Scene, other: Scene) -> bool:
    """True if two scenes differ at most in the places of objects."""
    return scene is other or all(
        np.array_equal(one, two)
        for one, two in zip(_appearance(scene), _appearance(other), strict=True)
    )


def _appearance(scene: Scene) -> tuple[NDArray[Any], ...]:
    """Arrays of the model that determine a scene's picture, except the places of objects."""
    m = scene.model
    return (
        m.geom_type,
        m.geom_size,
        m.geom_pos,
        m.geom_quat,
        m.geom_rgba,
        m.geom_dataid,
        m.geom_bodyid,
        m.geom_matid,
        m.body_parentid,
        m.jnt_bodyid,
        m.mesh_vert,
    )


FAR, FAST, SPINNING = 10.0, 100.0, 1000.0
"""Bounds of observed positions (m), speeds (m/s) and angular speeds (rad/s). Plausible values are
far below them; larger values are clipped to the bound."""
STRONG, HEAVY = 1e4, 1e3
"""Bounds of observed forces (N) and masses (kg)."""
PHASES = tuple(Phase)
"""Phases in the order of the observation `phase`."""
LATE = 3600.0
"""Bound of the observed time, s; longer than any trial."""
_STATE = np.repeat([FAR, 1.0, FAST, SPINNING], [3, 4, 3, 3])


@dataclass(frozen=True)
class Moment:
    """One moment of a session.

    Attributes:
        session: The session.
        snapshot: Its current snapshot.
        hands: The agent's devices, one for each hand.
    """

    session: Session
    snapshot: Snapshot
    hands: Sequence[Hands]

    @cached_property
    def forces(self) -> list[Array]:
        """(5, 2) for every hand: force of each finger on objects, N, and used share of the servos'
        limit."""
        return [
            np.array([(finger.force, finger.used) for finger in load.fingers])
            for load in self.session.loads()
        ]


@dataclass(frozen=True)
class Part:
    """A part of an observation.

    Attributes:
        bounds: Returns two arrays, the smallest and the largest allowed values in a session. The
            second argument is the index of the hand; parts of the scene ignore it.
        read: Returns the part's values at a moment. The second argument is the index of the hand.
    """

    bounds: Callable[[Session, int], tuple[Array, Array]]
    read: Callable[[Moment, int], Array]


def _even(most: Array) -> tuple[Array, Array]:
    return -most, most


def _pose_bounds(session: Session, i: int) -> tuple[Array, Array]:
    width = len(_pose_of(session, i))
    # A person's pose has rotation vectors. A robot's joints are angles, rad, or slides, m.
    turn = np.pi if width == POSE_SIZE else 2.0 * np.pi
    return _even(np.concatenate([np.full(3, FAR), np.full(width - 3, turn)]))


def _pose_of(session: Session, i: int) -> Array:
    qpos = session.data.qpos[session.scene.qpos_slice(i)]
    return session.scene.spec.hands[i].coordinates(qpos)


def _dofs(session: Session, i: int) -> NDArray[np.int64]:
    """Degrees of freedom of a hand."""
    model = session.scene.model
    palm = model.body(session.scene.spec.hands[i].palm).id
    return np.flatnonzero(model.body_rootid[model.dof_bodyid] == palm)


def _fingers(moment: Moment, i: int) -> Array:
    return np.array([moment.snapshot.hands[i].tips[f] for f in range(SLOTS)])


def _solid(moment: Moment, i: int) -> Array:
    solid = np.zeros(SLOTS)
    solid[sorted(moment.snapshot.hands[i].solid)] = 1.0
    return solid


def _touches(moment: Moment, i: int) -> Array:
    hand = moment.hands[i]
    down = np.array([[float(id is not None)] for id in hand.touch_ids])
    return np.concatenate([down, down * hand.places], axis=1)


def _touch_bounds(session: Session, i: int) -> tuple[Array, Array]:
    most = np.array([1.0, *session.rigs[i].reconstructor.surface.size])
    return np.zeros((SLOTS, 3)), np.tile(most, (SLOTS, 1))


def slot_labels(snapshot: Snapshot, hand: Hands, i: int) -> list[int | None]:
    """Returns the label of the touch in each slot of a hand; None without touch or label."""
    known = {c.id: c.label for c in snapshot.hands[i].contacts}
    return [None if id is None else known.get(id) for id in hand.touch_ids]


def _labels(moment: Moment, i: int) -> Array:
    labels = slot_labels(moment.snapshot, moment.hands[i], i)
    return np.array([-1.0 if label is None else float(label) for label in labels])


def _phase(moment: Moment, i: int) -> Array:
    now = moment.snapshot.hands[i].phase
    return np.array([float(now == phase.value) for phase in PHASES])


_HANDS: dict[str, Part] = {
    "pose": Part(_pose_bounds, lambda m, i: _pose_of(m.session, i)),
    "tips": Part(lambda s, i: _even(np.full((5, 3), FAR)), _fingers),
    "solid": Part(lambda s, i: (np.zeros(5), np.ones(5)), _solid),
    "labels": Part(lambda s, i: (np.full(5, -1.0), np.full(5, 4.0)), _labels),
    "touches": Part(_touch_bounds, _touches),
    "velocities": Part(
        lambda s, i: _even(np.full(len(_dofs(s, i)), SPINNING)),
        lambda m, i: m.session.data.qvel[_dofs(m.session, i)],
    ),
    "commanded": Part(
        lambda s, i: _even(np.repeat([FAR, np.pi], [3, POSE_SIZE - 3])),
        lambda m, i: m.snapshot.hands[i].target,
    ),
    "phase": Part(lambda s, i: (np.zeros(len(PHASES)), np.ones(len(PHASES))), _phase),
    "contact": Part(
        lambda s, i: (np.zeros((5, 2)), np.tile([STRONG, 1.0], (5, 1))),
        lambda m, i: m.forces[i],
    ),
}
"""Parts that each hand has. With two hands, a part has a row for each hand."""


def _properties(session: Session) -> Array:
    """Returns (n, 4): each object's mass, kg, and half its length, width and height, m."""
    return np.array([_object_properties(session, name) for name in session.scene.object_bodies])


def _object_properties(session: Session, name: str) -> Array:
    model, body = session.scene.model, session.scene.object_bodies[name]
    # A fixed base may have no geoms.
    corners = [np.zeros(3)] if not np.any(model.geom_bodyid == body) else []
    for geom in np.flatnonzero(model.geom_bodyid == body):
        centre, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
        turn = np.empty(9)
        mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
        middle = model.geom_pos[geom] + turn.reshape(3, 3) @ centre
        reach = np.abs(turn.reshape(3, 3)) @ half
        corners += [middle - reach, middle + reach]
    extent = np.max(corners, axis=0) - np.min(corners, axis=0)
    return np.array([model.body_mass[body], *(0.5 * extent)])


def object_state(session: Session, name: str) -> Array:
    """Returns the state (13,) of an object in the world frame.

    Position, m; quaternion (w, x, y, z) with w >= 0; velocity, m/s; angular velocity, rad/s.
    """
    model, data = session.scene.model, session.data
    body = session.scene.object_bodies[name]
    quat = data.xquat[body] * (-1.0 if data.xquat[body][0] < 0 else 1.0)
    velocity = np.empty(6)
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, velocity, 0)
    return np.concatenate([data.xpos[body], quat, velocity[3:], velocity[:3]])


def _goals(moment: Moment) -> Array:
    rows = [
        [*g.position, float(np.arctan2(np.sin(g.yaw), np.cos(g.yaw)))]
        for g in moment.snapshot.goals
    ]
    return np.array(rows, float)


_SCENE: dict[str, Part] = {
    "objects": Part(
        lambda s, _: _even(np.tile(_STATE, (len(s.task.objects), 1))),
        lambda m, _: np.array([object_state(m.session, t.name) for t in m.session.task.objects]),
    ),
    "goals": Part(
        lambda s, _: _even(np.tile([FAR, FAR, FAR, np.pi], (len(s.task.goals), 1))),
        lambda m, _: _goals(m),
    ),
    "properties": Part(
        lambda s, _: (
            np.zeros((len(s.task.objects), 4)),
            np.tile([HEAVY, FAR, FAR, FAR], (len(s.task.objects), 1)),
        ),
        lambda m, _: _properties(m.session),
    ),
    "time": Part(
        lambda s, _: (np.zeros(1), np.full(1, LATE)), lambda m, _: np.array([m.snapshot.time])
    ),
}
"""Parts of the whole scene."""

ALWAYS = ("pose", "tips", "solid", "labels", "objects", "goals", "time")
"""Parts that are always observed; `goals` only in tasks with goals."""


class Observing:
    """Reads the observations of an environment.

    Args:
        session: Any session of the environment.
        observe: Parts in addition to `ALWAYS`.

    Attributes:
        space: The space of observations, float64.
    """

    def __init__(self, session: Session, observe: Sequence[str]) -> None:
        self._names = [
            name for name in (*ALWAYS, *observe) if name != "goals" or session.task.goals
        ]
        count = len(session.rigs)
        boxes: dict[str, spaces.Space] = {}
        for name in self._names:
            if name in _HANDS:
                pairs = [_HANDS[name].bounds(session, i) for i in range(count)]
                low, high = (_together([pair[end] for pair in pairs]) for end in (0, 1))
            else:
                low, high = _SCENE[name].bounds(session, 0)
            boxes[name] = spaces.Box(low, high, dtype=np.float64)
        self.space = spaces.Dict(boxes)
        self._bounds: Mapping[str, spaces.Box] = {
            name: box for name, box in boxes.items() if isinstance(box, spaces.Box)
        }

    def read(self, moment: Moment) -> dict[str, Array]:
        """Returns the observation of a moment as new arrays; values are clipped to the bounds."""
        seen = {}
        for name in self._names:
            if name in _HANDS:
                count = len(moment.hands)
                values = _together([_HANDS[name].read(moment, i) for i in range(count)])
            else:
                values = _SCENE[name].read(moment, 0)
            bounds = self._bounds[name]
            seen[name] = np.clip(values, bounds.low, bounds.high)
        return seen


def check_counts(task: Task, space: spaces.Dict) -> None:
    """Checks that a trial has as many objects and goals as the environment's space.

    The space was made from another trial.

    Without the check, NumPy would broadcast a single object to the expected number.

    Raises:
        InputError: The trial has more or fewer objects or goals.
    """
    for what, shown in (("objects", task.objects), ("goals", task.goals)):
        shape = space[what].shape if what in space.spaces else (0,)
        if shape is not None and len(shown) != shape[0]:
            raise InputError(
                f"the number of {what} in this trial differs from that of the environment",
                where=f"{task.name}, seed {task.seed}",
                got=len(shown),
                expected=f"{shape[0]}, as in the trial of seed 0",
                remedy=f"Place the same number of {what} in every trial of the task",
            )


def _together(each: Sequence[Array]) -> Array:
    """Returns the values of a single hand unchanged, and stacks those of two hands in rows."""
    return each[0] if len(each) == 1 else np.stack(each)
