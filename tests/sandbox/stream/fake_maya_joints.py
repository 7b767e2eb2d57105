"""Nodes, turns and IK of the small scene that stands for Maya's (see `fake_maya`)."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from models.rotations import exp

AXES = ("X", "Y", "Z")
MOST_BEND = 180.0
"""Degrees that the solver bends a joint at most."""


def turned(degrees: Any) -> np.ndarray:
    """Rotation about x, then y, then z, Maya's default order; not to be written to."""
    return _turned(*map(float, degrees))


@lru_cache(maxsize=65_536)
def _turned(x: float, y: float, z: float) -> np.ndarray:
    (a, b, c), (d, e, f) = np.cos(np.radians((x, y, z))), np.sin(np.radians((x, y, z)))
    return np.array(
        [
            [b * c, d * e * c - a * f, a * e * c + d * f],
            [b * f, d * e * f + a * c, a * e * f - d * c],
            [-e, d * b, a * b],
        ]
    )


def degrees_of(m: np.ndarray) -> np.ndarray:
    """The angles of a rotation."""
    y = np.arcsin(np.clip(-m[2, 0], -1.0, 1.0))
    return np.degrees([np.arctan2(m[2, 1], m[2, 2]), y, np.arctan2(m[1, 0], m[0, 0])])


def about(vector: np.ndarray) -> np.ndarray:
    """Rotation by a rotation vector."""
    return np.asarray(exp(vector))


@dataclass
class Node:
    name: str
    kind: str
    parent: Node | None = None
    values: dict[str, float] = field(default_factory=dict)
    curves: dict[str, dict[float, float]] = field(default_factory=dict)
    about: dict[str, Any] = field(default_factory=dict)
    locked: set[str] = field(default_factory=set)
    drivers: dict[str, list[str]] = field(default_factory=dict)

    def triple(self, name: str) -> np.ndarray:
        return np.array([self.values.get(name + a, 0.0) for a in AXES])

    def put(self, name: str, values: Any) -> None:
        self.values.update({name + a: float(v) for a, v in zip(AXES, values, strict=True)})

    @property
    def path(self) -> str:
        return (self.parent.path if self.parent else "") + "|" + self.name

    def turn(self) -> np.ndarray:
        return self._turn_of("jointOrient") @ self._turn_of("rotate")

    def _turn_of(self, name: str) -> np.ndarray:
        value = self.values.get
        return _turned(value(name + "X", 0.0), value(name + "Y", 0.0), value(name + "Z", 0.0))

    def world(self) -> tuple[np.ndarray, np.ndarray]:
        if self.parent is None:
            return self.triple("translate"), self.turn()
        place, turn = self.parent.world()
        return place + turn @ self.triple("translate"), turn @ self.turn()

    def put_world(self, place: np.ndarray | None, turn: np.ndarray | None) -> None:
        above, frame = self.parent.world() if self.parent else (np.zeros(3), np.eye(3))
        if place is not None:
            self.put("translate", frame.T @ (place - above))
        if turn is not None:
            orient = turned(self.triple("jointOrient"))
            self.put("rotate", degrees_of((frame @ orient).T @ turn))


def orient(joint: Node, nodes: list[Node], up: np.ndarray) -> None:
    """Turns a joint's frame, and those below it, so that x points to the first joint below and y
    upwards; no joint moves."""
    below = [n for n in nodes if n.parent is joint and n.kind == "joint"]
    if not below:
        return
    places = [child.world()[0] for child in below]
    frames = [child.world()[1] for child in below]
    x = places[0] - joint.world()[0]
    x /= np.linalg.norm(x)
    y = up - x * (up @ x)
    y /= np.linalg.norm(y)
    above = joint.parent.world()[1] if joint.parent else np.eye(3)
    joint.put("rotate", (0, 0, 0))
    joint.put("jointOrient", degrees_of(above.T @ np.stack([x, y, np.cross(x, y)], axis=1)))
    for child, place, frame in zip(below, places, frames, strict=True):
        child.put("jointOrient", (0, 0, 0))
        child.put_world(place, None)
        child.put("jointOrient", degrees_of(joint.world()[1].T @ frame))
        orient(child, nodes, up)


def solve(handle: Node) -> None:
    """Moves the joints of a handle's chain."""
    chain: list[Node] = handle.about["chain"]
    goal, first = handle.world()[0], chain[0]
    start = first.world()[0]
    if handle.about["solver"] == "ikRPsolver":
        _bend(chain, float(np.linalg.norm(goal - start)))
    first.put("rotate", (0, 0, 0))
    turn = first.world()[1]
    shape = turn @ _reach(chain).T
    turn = _aim(shape[:, -1], goal - start) @ turn
    first.put_world(None, turn)
    pole = handle.about.get("pole")
    if pole is None:
        return
    axis = (goal - start) / np.linalg.norm(goal - start)
    bulge = (turn @ _reach(chain).T)[:, :-1].sum(axis=1)
    bulge, wanted = bulge - axis * (bulge @ axis), pole - axis * (pole @ axis)
    if min(np.linalg.norm(bulge), np.linalg.norm(wanted)) > 1e-6:
        angle = np.arctan2(axis @ np.cross(bulge, wanted), bulge @ wanted)
        first.put_world(None, about(axis * angle) @ turn)


def _reach(chain: list[Node]) -> np.ndarray:
    """(n, 3) where the joints of a chain are in the frame of its first one."""
    place, turn, out = np.zeros(3), np.eye(3), []
    for joint in chain[1:]:
        place = place + turn @ joint.triple("translate")
        turn = turn @ joint.turn()
        out.append(place)
    return np.array(out)


def _bend(chain: list[Node], distance: float) -> None:
    """Inner joints in proportion to their preferred angles, until the chain is as long."""
    inner = chain[1:-1]
    prefer = [joint.triple("preferredAngle") for joint in inner]
    most = max((float(np.abs(p).max()) for p in prefer), default=0.0)
    if most < 1e-9:
        return

    def reach(k: float) -> float:
        for joint, angles in zip(inner, prefer, strict=True):
            joint.put("rotate", k * angles)
        return float(np.linalg.norm(_reach(chain)[-1]))

    # A chain that was made bent is straight where its joints turn the other way.
    low = max((-k / most for k in (0, 10, 20, 30, 45, 60)), key=reach)
    high = MOST_BEND / most
    for _ in range(28):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if reach(middle) > distance else (low, middle)


def _aim(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    axis = np.cross(a, b)
    size = np.linalg.norm(axis)
    if size < 1e-12:
        return np.eye(3)
    return about(axis / size * np.arctan2(size, a @ b))
