"""Observations of an agent in a session."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from gymnasium import spaces

from models.arithmetic.arrays import Array
from models.errors import InputError
from sandbox.gym.actions import SLOTS
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from tasks.task import Task

FAR, FAST, SPINNING = 10.0, 100.0, 1000.0
"""m, m/s and rad/s: bounds of what is seen. Nothing sound comes near them; what is beyond is shown
at the bound."""

_STATE = np.repeat([FAR, 1.0, FAST, SPINNING], [3, 4, 3, 3])
_LATE = 3600.0
"""s, longer than any trial."""


def observation_space(task: Task, hands: int = 1) -> spaces.Dict:
    """The space of a task's observations; see `HandSandboxEnv`."""
    things, goals = len(task.objects), len(task.goals)
    each = () if hands == 1 else (hands,)
    spaces_by_name: dict[str, spaces.Space] = {
        "pose": _symmetric(np.tile(np.repeat([FAR, np.pi], [3, 45]), (*each, 1))),
        "tips": _symmetric(np.full((*each, SLOTS, 3), FAR)),
        "solid": spaces.Box(0.0, 1.0, (*each, SLOTS), np.float64),
        "labels": spaces.Box(-1.0, SLOTS - 1.0, (*each, SLOTS), np.float64),
        "objects": _symmetric(np.tile(_STATE, (things, 1))),
        "time": spaces.Box(0.0, _LATE, (1,), np.float64),
    }
    if goals:
        spaces_by_name["goals"] = _symmetric(np.tile([FAR, FAR, FAR, np.pi], (goals, 1)))
    return spaces.Dict(spaces_by_name)


def check_counts(task: Task, space: spaces.Dict) -> None:
    """Checks that a trial has as many objects and goals as the space, which was made of another.

    NumPy would repeat one object until there are as many as there should be.

    Raises:
        InputError: It has more or fewer.
    """
    for what, things in (("objects", task.objects), ("goals", task.goals)):
        shape = space[what].shape if what in space.spaces else (0,)
        if shape is not None and len(things) != shape[0]:
            raise InputError(
                f"this trial has another number of {what} than an environment can show",
                where=f"{task.name}, seed {task.seed}",
                got=len(things),
                expected=f"{shape[0]}, as in the trial of seed 0",
                remedy=f"A task for Gymnasium places as many {what} in every trial",
            )


def _symmetric(bound: Array) -> spaces.Box:
    return spaces.Box(-bound, bound, dtype=np.float64)


def observe(
    session: Session,
    snapshot: Snapshot,
    touch_ids: Sequence[Sequence[int | None]],
    space: spaces.Dict,
) -> dict[str, Array]:
    """The current observation, as new arrays.

    Args:
        session: Session with one or two hands.
        snapshot: Current snapshot of the session.
        touch_ids: Contact of every slot, hand by hand.
        space: Bounds of the observation.
    """
    hands = [_hand(session, snapshot, i, ids) for i, ids in enumerate(touch_ids)]
    observation = {
        # One hand is seen by itself, two have a row each.
        **(hands[0] if len(hands) == 1 else {n: np.stack([h[n] for h in hands]) for n in hands[0]}),
        "objects": np.array([object_state(session, t.name) for t in session.task.objects]),
        "time": np.array([snapshot.time]),
    }
    if snapshot.goals:
        yaws = [float(np.arctan2(np.sin(g.yaw), np.cos(g.yaw))) for g in snapshot.goals]
        observation["goals"] = np.array(
            [[*g.position, yaw] for g, yaw in zip(snapshot.goals, yaws, strict=True)], float
        )
    return {name: _within(values, space[name]) for name, values in observation.items()}


def _hand(
    session: Session, snapshot: Snapshot, i: int, touch_ids: Sequence[int | None]
) -> dict[str, Array]:
    """Observation of one hand: its pose, fingertips, solid fingers, and labels of its touches."""
    hand, joints = snapshot.hands[i], session.data.qpos[session.scene.qpos_slice(i)]
    solid, labels = np.zeros(SLOTS), np.full(SLOTS, -1.0)
    solid[sorted(hand.solid)] = 1.0
    known = {c.id: c.label for c in hand.contacts}
    for slot, id in enumerate(touch_ids):
        label = None if id is None else known.get(id)
        labels[slot] = -1.0 if label is None else label
    return {
        "pose": session.scene.spec.hands[i].coordinates(joints),
        "tips": hand.tips,
        "solid": solid,
        "labels": labels,
    }


def _within(values: Array, space: spaces.Space[Any]) -> Array:
    assert isinstance(space, spaces.Box)
    return np.clip(values, space.low, space.high)


def object_state(session: Session, name: str) -> Array:
    """(13,) position, quaternion with w >= 0, speed, and speed of turning, all in the world."""
    model, data = session.scene.model, session.data
    body = session.scene.object_bodies[name]
    quat = data.xquat[body] * (-1.0 if data.xquat[body][0] < 0 else 1.0)
    velocity = np.empty(6)
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, velocity, 0)
    return np.concatenate([data.xpos[body], quat, velocity[3:], velocity[:3]])
