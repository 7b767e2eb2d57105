"""A small scene that behaves like `maya.cmds` as far as that is documented; no Maya.

Transforms, joints, locators, constraints, animation curves, IK, baking and undo, for the commands
and flags that `sandbox/stream/maya_side.py` uses: any other command or flag is an error, as is a
name that no node has. IK is as the documentation tells of ikRPsolver: inner joints bend in
proportion to their preferred angles until the distance is right, so that a straight chain without
any does not bend; the first joint then aims, and turns the bend towards the pole vector.
"""

from __future__ import annotations

import sys
import types
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from models.rotations import exp

AXES = ("X", "Y", "Z")
MOST_BEND = 180.0
"""Degrees that the solver bends a joint at most."""


def turned(degrees: Any) -> np.ndarray:
    """Rotation about x, then y, then z, Maya's default order."""
    (a, b, c), (d, e, f) = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
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

    def triple(self, name: str) -> np.ndarray:
        return np.array([self.values.get(name + a, 0.0) for a in AXES])

    def put(self, name: str, values: Any) -> None:
        self.values.update({name + a: float(v) for a, v in zip(AXES, values, strict=True)})

    @property
    def path(self) -> str:
        return (self.parent.path if self.parent else "") + "|" + self.name

    def turn(self) -> np.ndarray:
        return turned(self.triple("jointOrient")) @ turned(self.triple("rotate"))

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


class FakeMaya:
    """The commands; `nodes`, `warnings`, `undo` and `time` are there for tests to look at."""

    def __init__(self, fps: str = "ntscf", linear: str = "cm", up: str = "y") -> None:
        self.nodes: list[Node] = []
        self.warnings: list[str] = []
        self.undo: list[str] = []
        self.ports: dict[str, dict[str, Any]] = {}
        self.selected: list[Node] = []
        self.time = 1.0
        self._units, self._up = {"time": fps, "linear": linear}, up
        self._undo_on, self._chunks = True, 0
        self._dirty = False

    # What the script calls, by Maya's names and flags.

    def joint(self, *, name: str, position: Any) -> str:
        parent = self.selected[-1] if self.selected else None
        node = self._new(name, "joint", parent)
        node.put_world(np.array(position, float), None)
        node.put("jointOrient", (0, 0, 0))
        self.selected = [node]
        return self._said(node)

    def group(self, *, empty: bool, name: str, parent: str | None = None) -> str:
        assert empty
        return self._said(self._new(name, "transform", self._find(parent) if parent else None))

    def spaceLocator(self, *, name: str) -> list[str]:
        return [self._said(self._new(name, "locator"))]

    def parent(self, child: str, above: str, *, relative: bool = False) -> list[str]:
        node = self._find(child)
        self.evaluate()
        place, turn = node.world()
        node.parent = self._find(above)
        if not relative:
            node.put_world(place, turn)
        self._did("parent")
        return [self._said(node)]

    def select(self, *names: str, clear: bool = False) -> None:
        self.selected = [] if clear else [self._find(n) for n in names]

    def ls(self, *names: str, selection: bool = False, type: str | None = None,
           long: bool = False) -> list[str]:  # fmt: skip
        found = self.selected if selection else [n for x in names if (n := self._get(x))]
        return [n.path if long else self._said(n) for n in found if type in (None, n.kind)]

    def listRelatives(self, name: str, *, parent: bool = False, children: bool = False,
                      type: str | None = None, fullPath: bool = False) -> list[str] | None:  # fmt: skip
        node = self._find(name)
        found = [node.parent] if parent else [n for n in self.nodes if n.parent is node]
        chosen = [n for n in found if n is not None and type in (None, n.kind)]
        return [n.path if fullPath else self._said(n) for n in chosen] or None

    def objExists(self, name: str) -> bool:
        return self._get(name) is not None

    def delete(self, name: str) -> None:
        self.evaluate()
        gone = self._find(name)
        inside = [n for n in self.nodes if n is gone or n.path.startswith(gone.path + "|")]
        for node in inside:
            self.nodes.remove(node)
        # A handle takes its effector along, a target the constraints on it.
        for node in [n for n in self.nodes if {id(x) for x in inside} & _ids(n.about)]:
            if node in self.nodes:
                self.nodes.remove(node)
        self._did("delete")

    def setAttr(self, attribute: str, *values: float) -> None:
        node, name = self._attribute(attribute)
        if len(values) == 3:
            node.put(name, values)
        elif len(values) == 1 and name[-1] in "XYZ":
            node.values[name] = float(values[0])
        else:
            raise RuntimeError(f"Error reading data element number 1: {attribute}")
        self._did("setAttr")
        self._dirty = True

    def getAttr(self, attribute: str) -> list[tuple[float, ...]]:
        node, name = self._attribute(attribute)
        self.evaluate()
        return [tuple(node.triple(name).tolist())]

    def xform(self, name: str, *, query: bool, worldSpace: bool, translation: bool = False,
              matrix: bool = False) -> list[float]:  # fmt: skip
        assert query and worldSpace and translation != matrix
        self.evaluate()
        place, turn = self._find(name).world()
        if translation:
            return place.tolist()
        whole = np.eye(4)
        whole[:3, :3], whole[3, :3] = turn.T, place  # rows are axes
        return whole.ravel().tolist()

    def ikHandle(self, *, startJoint: str, endEffector: str, solver: str, name: str) -> list[str]:
        first, last = self._find(startJoint), self._find(endEffector)
        chain = [last]
        while chain[0] is not first:
            if chain[0].parent is None:
                raise RuntimeError("The start joint is not above the end effector")
            chain.insert(0, chain[0].parent)
        effector = self._new("effector", "ikEffector", last.parent)
        handle = self._new(name, "ikHandle")
        handle.put_world(last.world()[0], None)
        handle.about = {"chain": chain, "effector": effector, "solver": solver, "on": True}
        effector.about = {"handle": handle}
        for joint in chain:
            joint.about["rest"] = joint.triple("rotate")
        return [self._said(handle), self._said(effector)]

    def pointConstraint(self, target: str, name: str) -> list[str]:
        return [self._constrain("pointConstraint", target, name)]

    def poleVectorConstraint(self, target: str, name: str) -> list[str]:
        if self._find(name).about["solver"] != "ikRPsolver":
            raise RuntimeError("a pole vector needs a rotate plane handle")
        return [self._constrain("poleVectorConstraint", target, name)]

    def parentConstraint(self, *names: str, maintainOffset: bool = False, query: bool = False,
                         targetList: bool = False) -> list[str]:  # fmt: skip
        if query:
            assert targetList
            return [self._said(self._find(names[0]).about["target"])]
        assert maintainOffset
        target, moved = names
        return [self._constrain("parentConstraint", target, moved)]

    def setKeyframe(self, *names: str, attribute: str | list[str], time: float) -> int:
        attributes = [attribute] if isinstance(attribute, str) else attribute
        for node in map(self._find, names):
            for one in (a + axis for a in attributes for axis in AXES):
                node.curves.setdefault(one, {})[float(time)] = node.values.get(one, 0.0)
        self._did("setKeyframe")
        # A curve that was changed is looked up again, at the current time.
        self._from_curves([self._find(name) for name in names])
        return len(names)

    def currentTime(self, frame: float | None = None, *, query: bool = False) -> float:
        if not query:
            assert frame is not None
            self.time = float(frame)
            self._did("currentTime")
            self._from_curves()
        return self.time

    def bakeResults(self, names: list[str], *, time: tuple[float, float], attribute: list[str],
                    simulation: bool, sampleBy: float, disableImplicitControl: bool,
                    preserveOutsideKeys: bool) -> int:  # fmt: skip
        assert simulation and preserveOutsideKeys
        before, nodes = self.time, [self._find(n) for n in names]
        baked: dict[tuple[int, str], dict[float, float]] = {}
        for frame in np.arange(time[0], time[1] + 1e-6, sampleBy).tolist():
            self.currentTime(frame)
            self.evaluate()
            for i, node in enumerate(nodes):
                for one in attribute:
                    baked.setdefault((i, one), {})[frame] = node.values.get(one, 0.0)
        for (i, one), keys in baked.items():
            nodes[i].curves[one] = keys
        for handle in (n for n in self.nodes if n.kind == "ikHandle"):
            if disableImplicitControl and any(j in nodes for j in handle.about["chain"][:-1]):
                handle.about["on"] = False
        self.currentTime(before)
        self._did("bakeResults")
        return len(nodes)

    def currentUnit(self, *, query: bool, time: bool = False, linear: bool = False) -> str:
        assert query and time != linear
        return self._units["time" if time else "linear"]

    def upAxis(self, *, query: bool, axis: bool) -> str:
        assert query and axis
        return self._up

    def undoInfo(self, *, query: bool = False, state: bool = False, openChunk: bool = False,
                 closeChunk: bool = False, chunkName: str = "",
                 stateWithoutFlush: bool | None = None) -> bool:  # fmt: skip
        if openChunk:
            self._did(chunkName)
            self._chunks += 1
        elif closeChunk:
            self._chunks -= 1
        elif stateWithoutFlush is not None:
            self._undo_on = stateWithoutFlush
        return self._undo_on

    def warning(self, text: str) -> None:
        self.warnings.append(text)

    def commandPort(self, port: str | None = None, *, name: str = "", query: bool = False,
                    close: bool = False, **flags: Any) -> bool:  # fmt: skip
        if query:
            return port in self.ports
        if close:
            del self.ports[name]
        else:
            self.ports[name] = flags
        return True

    # How the scene works.

    def evaluate(self) -> None:
        """Constraints, then handles, if anything has changed since they were looked at."""
        if not self._dirty:
            return
        self._dirty = False
        for kind in ("parentConstraint", "pointConstraint", "poleVectorConstraint"):
            for node in (n for n in self.nodes if n.kind == kind):
                place, turn = node.about["target"].world()
                if kind == "parentConstraint":
                    shift, way = node.about["offset"]
                    node.about["moved"].put_world(place + turn @ shift, turn @ way)
                elif kind == "pointConstraint":
                    node.about["moved"].put_world(place, None)
                else:
                    start = node.about["moved"].about["chain"][0]
                    node.about["moved"].about["pole"] = place - start.world()[0]
        for handle in (n for n in self.nodes if n.kind == "ikHandle" and n.about["on"]):
            _solve(handle)

    def _from_curves(self, nodes: list[Node] | None = None) -> None:
        for node in self.nodes if nodes is None else nodes:
            for name, keys in node.curves.items():
                at = sorted(keys)
                node.values[name] = float(np.interp(self.time, at, [keys[t] for t in at]))
        self._dirty = True

    def _constrain(self, kind: str, target: str, moved: str) -> str:
        above = self._find(moved)
        node = self._new(f"{above.name}_{kind}1", kind, above)
        target_node = self._find(target)
        (a, r), (b, s) = target_node.world(), above.world()
        offset = (r.T @ (b - a), r.T @ s)
        node.about = {"target": target_node, "moved": above, "offset": offset}
        self._dirty = True
        return self._said(node)

    def _new(self, name: str, kind: str, parent: Node | None = None) -> Node:
        unique, n = name, 0
        while any(x.name == unique for x in self.nodes):
            n += 1
            unique = f"{name}{n}"
        node = Node(unique, kind, parent)
        self.nodes.append(node)
        self._did(kind)
        return node

    def _get(self, name: str) -> Node | None:
        return next((n for n in self.nodes if name in (n.name, n.path)), None)

    def _find(self, name: str) -> Node:
        found = self._get(name)
        if found is None:
            raise ValueError(f"No object matches name: {name}")
        return found

    def _attribute(self, text: str) -> tuple[Node, str]:
        name, _, attribute = text.rpartition(".")
        if attribute.rstrip("XYZ") not in ("translate", "rotate", "jointOrient", "preferredAngle"):
            raise ValueError(f"No object matches name: {text}")
        return self._find(name), attribute

    def _said(self, node: Node) -> str:
        return node.name

    def _did(self, what: str) -> None:
        if self._undo_on and not self._chunks:
            self.undo.append(what)


def _ids(about: dict[str, Any]) -> set[int]:
    nodes = [about.get(k) for k in ("target", "handle")]
    return {id(n) for n in nodes if n is not None}


def _solve(handle: Node) -> None:
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
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if reach(middle) > distance else (low, middle)


def _aim(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    axis = np.cross(a, b)
    size = np.linalg.norm(axis)
    if size < 1e-12:
        return np.eye(3)
    return about(axis / size * np.arctan2(size, a @ b))


@contextmanager
def maya_with(source: str, scene: FakeMaya) -> Iterator[tuple[dict[str, Any], Callable[..., Any]]]:
    """Runs a script as the script editor would, in a scene; gives its names, and `exec` there."""
    maya = types.ModuleType("maya")
    maya.cmds = scene  # type: ignore[attr-defined]
    main, before = types.ModuleType("__main__"), sys.modules["__main__"]
    sys.modules.update({"maya": maya, "__main__": main})
    try:
        exec(compile(source, "maya_script", "exec"), main.__dict__)
        yield main.__dict__, lambda text: exec(text, main.__dict__)
    finally:
        del sys.modules["maya"]
        sys.modules["__main__"] = before
