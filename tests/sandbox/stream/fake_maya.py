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
from typing import Any

import numpy as np

from tests.sandbox.stream.fake_maya_joints import AXES, Node, orient, solve


class FakeMaya:
    """The commands; `nodes`, `warnings`, `undo` and `time` are there for tests to look at."""

    def __init__(
        self, fps: str = "ntscf", linear: str = "cm", up: str = "y", angle: str = "deg"
    ) -> None:
        self.nodes: list[Node] = []
        self.warnings: list[str] = []
        self.undo: list[str] = []
        self.ports: dict[str, dict[str, Any]] = {}
        self.selected: list[Node] = []
        self.time = 1.0
        self._units, self._up = {"time": fps, "linear": linear, "angle": angle}, up
        self._unit = np.degrees(1.0) if angle == "rad" else 1.0
        self.range = {"animationStartTime": 1.0, "minTime": 1.0}
        self.range.update({"animationEndTime": 200.0, "maxTime": 120.0})
        self._undo_on, self._chunks = True, 0
        self._dirty = False

    # What the script calls, by Maya's names and flags.

    def joint(self, *given: str, name: str = "", position: Any = None, **flags: Any) -> str:
        if given:
            assert flags.pop("edit") and flags.pop("children") and flags.pop("zeroScaleOrient")
            assert flags.pop("orientJoint") == "xyz"
            up = {"yup": (0, 1, 0), "zup": (0, 0, 1)}[flags.pop("secondaryAxisOrient")]
            assert not flags
            orient(self._find(given[0]), self.nodes, np.array(up, float))
            self._did("joint")
            return given[0]
        assert not flags
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

    def ls(
        self, *names: str, selection: bool = False, type: str | None = None, long: bool = False
    ) -> list[str]:
        found = self.selected if selection else [n for x in names for n in self._all(x)]
        return [n.path if long else self._said(n) for n in found if type in (None, n.kind)]

    def listRelatives(self, name: str, **flags: Any) -> list[str] | None:
        _only(flags, "parent", "children", "type", "fullPath")
        node, kind = self._find(name), flags.get("type")
        found = (
            [node.parent] if flags.get("parent") else [n for n in self.nodes if n.parent is node]
        )
        chosen = [n for n in found if n is not None and kind in (None, n.kind)]
        return [n.path if flags.get("fullPath") else self._said(n) for n in chosen] or None

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
        unit = 1.0 if name.startswith("translate") else self._unit
        if len(values) == 3:
            node.put(name, unit * np.array(values))
        elif len(values) == 1 and name[-1] in "XYZ":
            node.values[name] = unit * float(values[0])
        else:
            raise RuntimeError(f"Error reading data element number 1: {attribute}")
        self._did("setAttr")
        self._dirty = True

    def getAttr(self, attribute: str, *, lock: bool = False) -> Any:
        node, name = self._attribute(attribute)
        if lock:
            return name in node.locked
        self.evaluate()
        unit = 1.0 if name.startswith("translate") else self._unit
        return [tuple((node.triple(name) / unit).tolist())]

    def listConnections(self, attribute: str, **flags: bool) -> list[str] | None:
        assert flags == {"source": True, "destination": False}
        node, name = self._attribute(attribute)
        curve = [f"{node.name}_{name}"] if name in node.curves else []
        return [*node.drivers.get(name, []), *curve] or None

    def nodeType(self, name: str) -> str:
        found = self._get(name)
        return found.kind if found else "animCurveTA"

    def playbackOptions(self, *, query: bool = False, **flags: Any) -> float:
        ((flag, value),) = flags.items()
        if not query:
            self.range[flag] = float(value)
        return self.range[flag]

    def xform(self, name: str, **flags: bool) -> list[float]:
        wanted = set(flags) - {"query", "worldSpace"}
        assert len(flags) == 3 and all(flags.values()) and wanted <= {"translation", "matrix"}
        self.evaluate()
        place, turn = self._find(name).world()
        if "translation" in flags:
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

    def parentConstraint(self, *names: str, **flags: bool) -> list[str]:
        if flags == {"query": True, "targetList": True}:
            return [self._said(self._find(names[0]).about["target"])]
        assert flags == {"maintainOffset": True}
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

    def bakeResults(
        self, names: list[str], *, time: tuple[float, float], attribute: list[str], **flags: Any
    ) -> int:
        _only(flags, "sampleBy", "simulation", "disableImplicitControl", "preserveOutsideKeys")
        assert flags["simulation"] and flags["preserveOutsideKeys"]
        before, nodes = self.time, [self._find(n) for n in names]
        baked: dict[tuple[int, str], dict[float, float]] = {}
        for frame in np.arange(time[0], time[1] + 1e-6, flags["sampleBy"]).tolist():
            self.currentTime(frame)
            self.evaluate()
            for i, node in enumerate(nodes):
                for one in attribute:
                    baked.setdefault((i, one), {})[frame] = node.values.get(one, 0.0)
        for (i, one), keys in baked.items():
            nodes[i].curves[one] = keys
        for handle in (n for n in self.nodes if n.kind == "ikHandle"):
            baked_too = any(joint in nodes for joint in handle.about["chain"][:-1])
            if flags["disableImplicitControl"] and baked_too:
                handle.about["on"] = False
        self.currentTime(before)
        self._did("bakeResults")
        return len(nodes)

    def currentUnit(self, *, query: bool, **flags: bool) -> str:
        assert query and all(flags.values())
        (kind,) = flags
        return self._units[kind]

    def upAxis(self, *, query: bool, axis: bool) -> str:
        assert query and axis
        return self._up

    def undoInfo(self, **flags: Any) -> bool:
        _only(flags, "query", "state", "openChunk", "closeChunk", "chunkName", "stateWithoutFlush")
        if flags.get("openChunk"):
            self._did(flags["chunkName"])
            self._chunks += 1
        elif flags.get("closeChunk"):
            self._chunks -= 1
        else:
            self._undo_on = flags.get("stateWithoutFlush", self._undo_on)
        return self._undo_on

    def warning(self, text: str) -> None:
        self.warnings.append(text)

    def commandPort(self, port: str = "", *, name: str = "", **flags: Any) -> bool:
        if flags.get("query"):
            return port in self.ports
        if flags.get("close"):
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
            solve(handle)

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
        # As in Maya, only siblings may not share a name.
        while any(x.name == unique and x.parent is parent for x in self.nodes):
            n += 1
            unique = f"{name}{n}"
        node = Node(unique, kind, parent)
        self.nodes.append(node)
        self._did(kind)
        return node

    def _all(self, name: str) -> list[Node]:
        end = name if name.startswith("|") else "|" + name
        whole = name.startswith("|")
        return [n for n in self.nodes if n.path == end or (not whole and n.path.endswith(end))]

    def _get(self, name: str) -> Node | None:
        return next(iter(self._all(name)), None)

    def _find(self, name: str) -> Node:
        found = self._all(name)
        if len(found) > 1:
            raise ValueError(f"More than one object matches name: {name}")
        if not found:
            raise ValueError(f"No object matches name: {name}")
        return found[0]

    def _attribute(self, text: str) -> tuple[Node, str]:
        name, _, attribute = text.rpartition(".")
        if attribute.rstrip("XYZ") not in ("translate", "rotate", "jointOrient", "preferredAngle"):
            raise ValueError(f"No object matches name: {text}")
        return self._find(name), attribute

    def _said(self, node: Node) -> str:
        """The shortest name that no other node has."""
        words = node.path.split("|")
        ends = ("|".join(words[-n:]) for n in range(1, len(words)))
        return next((end for end in ends if len(self._all(end)) == 1), node.path)

    def _did(self, what: str) -> None:
        if self._undo_on and not self._chunks:
            self.undo.append(what)


def _only(flags: dict[str, Any], *known: str) -> None:
    """Any other flag is an error."""
    assert set(flags) <= set(known), flags


def _ids(about: dict[str, Any]) -> set[int]:
    nodes = [about.get(k) for k in ("target", "handle")]
    return {id(n) for n in nodes if n is not None}


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
