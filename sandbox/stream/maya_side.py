"""Hands from Hand Sandbox in Maya: paste into the script editor (Python), run, select, start().

Select the first joint of one to five chains, thumb first, then

    open_port()          # Maya's command port, which only this machine can reach
    start()              # the chains follow the hand that `sandbox stream --maya :7002` sends
    start(side="left")   # another rig, another selection, for a left hand
    stop()               # bakes the keyframes onto the joints and removes the targets

With nothing selected, start() makes a new hand like the streamed hand. Options of start:

    fingers   the finger of each chain, such as (1, 2): thumb 0 .. little 4
    root      the transform that follows the palm; by default the nearest one above all chains;
              root="" moves no transform with the palm
    absolute  True puts the palm at the place of the streamed palm; otherwise the rig starts at
              its own place, and then moves as the streamed hand moves
    key       False moves the rig without keyframes
    scale     scene units per metre of the palm's path; by default from the lengths of the chains

Written for Python 3.7 (Maya 2022) and later; it needs only Maya. It was NEVER RUN IN A REAL MAYA.
It was checked by types, and by tests with a small scene that imitates the documented behaviour of
Maya. See docs/stream.md.
"""

from __future__ import annotations

import math
import re
from typing import Any, Dict, List, Optional, Sequence, Tuple

from maya import cmds

import __main__
from sandbox.stream.guest import (
    Line,
    Quaternion,
    Refused,
    Rows,
    Vector,
    angles_of,
    into,
    inverse,
    length,
    minus,
    palm_frame,
    plus,
    product,
    quaternion_of,
    rotated,
    rows_of,
    times,
)

FINGERS = ("thumb", "index", "middle", "ring", "little")
BY_COUNT = {1: (1,), 2: (0, 1), 3: (0, 1, 2), 4: (1, 2, 3, 4), 5: (0, 1, 2, 3, 4)}
UNITS = {"mm": 1e3, "cm": 1e2, "m": 1.0, "km": 1e-3, "in": 39.3701, "ft": 3.28084, "yd": 1.09361}
RATES = {
    "game": 15.0,
    "film": 24.0,
    "pal": 25.0,
    "ntsc": 30.0,
    "show": 48.0,
    "palf": 50.0,
    "ntscf": 60.0,
    "millisec": 1000.0,
    "sec": 1.0,
    "min": 1.0 / 60.0,
    "hour": 1.0 / 3600.0,
}
STEP = 10.0  # preferred angle of straight joints for a solver, degrees
COUPLING = 2.0 / 3.0  # bend of a finger's last joint / bend of the joint before it, as in PAALM
TOLD = 3  # largest number of warnings about bad lines; more would fill the script editor

# Published stubs of maya.cmds do not declare `query` together with another flag.
asked: Any = cmds

hands: Dict[str, "HandRig"] = {}
waiting: Dict[str, Dict[str, Any]] = {}
counts: Dict[str, int] = {"lines": 0, "lines refused": 0}


class HandRig:
    """A rig that follows one streamed hand.

    All its nodes are in one group: a transform for the palm, and IK handles. Below the transform,
    in the palm's frame, each chain has a locator for its tip and a locator for the direction in
    which it bulges. The IK handles follow these locators.
    """

    def __init__(
        self,
        chains: List[List[str]],
        fingers: Sequence[int],
        side: str,
        root: Optional[str],
        scale: Optional[float],
        key: bool,
        absolute: bool,
        frame: Optional[Rows] = None,
    ) -> None:
        self.side, self.key, self.scale, self.absolute = side, key, scale, absolute
        self.fingers, self.chains, self.root = tuple(fingers), chains, root
        self.run = ""
        self.start: Tuple[float, float] = (0.0, 0.0)  # frame, and s of the stream
        self.keyed: List[int] = []  # first and last frame
        self.begin: Optional[Tuple[Vector, Quaternion]] = None
        self.bases: List[Vector] = []
        self.targets: List[str] = []
        self.poles: List[str] = []
        places = [[_place(joint) for joint in chain] for chain in chains]
        # A finger's length is the sum of its bones, as in the paper.
        self.lengths = [sum(length(minus(a, b)) for a, b in zip(p, p[1:])) for p in places]
        self.frame = frame or palm_frame(places, self.fingers, side, _up())
        self.group = _long(cmds.group(empty=True, name="hand_sandbox_" + side))
        try:
            self._build(places)
        except Exception:
            cmds.delete(self.group)
            raise

    def _build(self, places: List[List[Vector]]) -> None:
        where = _place(self.root) if self.root else places[0][0]
        self.rest = (where, quaternion_of(self.frame))
        self.palm = _long(cmds.group(empty=True, name="palm_" + self.side, parent=self.group))
        self._put_palm(*self.rest)
        for finger, chain, place, size in zip(self.fingers, self.chains, places, self.lengths):
            name = "%s_%s" % (FINGERS[finger], self.side)
            base = into(self.frame, where, place[0])
            self.bases.append(base)
            self.targets.append(self._locator(name + "_target", into(self.frame, where, place[-1])))
            self.poles.append(self._locator(name + "_pole", plus(base, (0.0, 0.0, size))))
            for joint in chain[1:-1]:
                last = finger > 0 and len(chain) > 3 and joint == chain[-2]
                _prefer(joint, self.frame, COUPLING if last else 1.0)
            solver = "ikRPsolver" if len(chain) > 2 else "ikSCsolver"
            made = cmds.ikHandle(
                startJoint=chain[0], endEffector=chain[-1], solver=solver, name=name + "_ik"
            )
            handle = _long(cmds.parent(made[0], self.group)[0])
            cmds.pointConstraint(self.targets[-1], handle)
            if solver == "ikRPsolver":
                cmds.poleVectorConstraint(self.poles[-1], handle)
        if self.root:
            cmds.parentConstraint(self.palm, self.root, maintainOffset=True)

    def _locator(self, name: str, place: Vector) -> str:
        made = _long(cmds.parent(cmds.spaceLocator(name=name)[0], self.palm, relative=True)[0])
        cmds.setAttr(made + ".translate", *place)
        return made

    def update(self, line: Line) -> None:
        """Processes one moment."""
        if line.run != self.run:
            # The sandbox was restarted: its time and its hand begin here.
            self.run, self.begin = line.run, None
            self.start = (float(asked.currentTime(query=True)), line.time)
        frame = int(round(self.start[0] + (line.time - self.start[1]) * _rate()))
        if self.key and asked.currentTime(query=True) != frame:
            # A keyframe at another time than the current time would not be visible.
            cmds.currentTime(frame)
        if self.root:
            self._follow(line)
        for finger, base, size, target, pole in zip(
            self.fingers, self.bases, self.lengths, self.targets, self.poles
        ):
            if finger in line.chains:
                way, back, _ = line.chains[finger]
                cmds.setAttr(target + ".translate", *plus(base, times(way, size)))
                cmds.setAttr(pole + ".translate", *plus(base, times(back, size)))
        if self.key:
            cmds.setKeyframe(*self.targets, *self.poles, attribute="translate", time=frame)
            if self.root:
                cmds.setKeyframe(self.palm, attribute=["translate", "rotate"], time=frame)
            self.keyed = [min([frame, *self.keyed]), max([frame, *self.keyed])]

    def _follow(self, line: Line) -> None:
        place, turn = line.place, line.turn
        if _up()[2]:
            quarter = math.sqrt(0.5)
            place = (place[0], -place[2], place[1])
            turn = product((quarter, quarter, 0.0, 0.0), turn)
        if self.scale is None:
            known = [
                (size, line.chains[finger][2])
                for finger, size in zip(self.fingers, self.lengths)
                if finger in line.chains
            ]
            if not known:
                return
            self.scale = sum(a for a, _ in known) / sum(b for _, b in known)
        if self.begin is None:
            self.begin = (place, turn)
        if self.absolute:
            self._put_palm(times(place, self.scale), turn)
            return
        moved = times(minus(place, self.begin[0]), self.scale)
        turned = product(turn, inverse(self.begin[1]))
        self._put_palm(plus(self.rest[0], moved), product(turned, self.rest[1]))

    def _put_palm(self, place: Vector, turn: Quaternion) -> None:
        unit = _degree()
        before = times(cmds.getAttr(self.palm + ".rotate")[0], 1.0 / unit)
        cmds.setAttr(self.palm + ".translate", *place)
        cmds.setAttr(self.palm + ".rotate", *times(angles_of(turn, before), unit))

    def finish(self, bake: bool) -> None:
        """Bakes the keyframes, and removes handles and targets."""
        if bake and self.keyed and cmds.objExists(self.group):
            nodes = [joint for chain in self.chains for joint in chain[:-1]]
            turns, moves = (
                ["%s%s" % (what, axis) for axis in "XYZ"] for what in ("rotate", "translate")
            )
            for some, attributes in ((nodes, turns), ([self.root], moves + turns)):
                if some[0]:
                    cmds.bakeResults(
                        some,
                        time=(self.keyed[0], self.keyed[1]),
                        attribute=attributes,
                        simulation=True,
                        sampleBy=1,
                        disableImplicitControl=True,
                        preserveOutsideKeys=True,
                    )
            _show(self.keyed[0], self.keyed[1])
        # A constraint is below the node that it moves; all other nodes are in the group.
        for one in (
            cmds.listRelatives(self.root, type="parentConstraint") or [] if self.root else []
        ):
            targets = asked.parentConstraint(one, query=True, targetList=True) or ()
            if self.palm in [_long(target) for target in targets]:
                cmds.delete(one)
        if cmds.objExists(self.group):
            cmds.delete(self.group)


def start(
    side: str = "right",
    fingers: Optional[Sequence[int]] = None,
    root: Optional[str] = None,
    scale: Optional[float] = None,
    key: bool = True,
    absolute: bool = False,
) -> None:
    """Makes the selected chains follow a streamed hand."""
    stop(side, bake=False)
    chosen = cmds.ls(selection=True, type="joint", long=True) or []
    options: Dict[str, Any] = {"root": root, "scale": scale, "key": key, "absolute": absolute}
    try:
        _rate()
    except Refused as error:
        cmds.warning("hand_sandbox: %s" % error)
        return
    if not chosen:
        waiting[side] = options
        print("hand_sandbox: no joint is selected; a new hand is made when the stream begins")
        return
    cmds.undoInfo(openChunk=True, chunkName="hand_sandbox start")
    try:
        hand = hands[side] = _hand(chosen, fingers, side, **options)
        for finger, chain in zip(hand.fingers, hand.chains):
            print("hand_sandbox: the %s moves %s" % (FINGERS[finger], chain[0]))
        if hand.root:
            print("hand_sandbox: the palm moves %s" % hand.root)
        elif root is None:
            cmds.warning(
                "hand_sandbox: the palm moves nothing, since no transform is above all chains; "
                'start(root="NAME") names one'
            )
    except Refused as error:
        cmds.warning("hand_sandbox: %s" % error)
    finally:
        cmds.undoInfo(closeChunk=True)


def stop(side: Optional[str] = None, bake: bool = True) -> None:
    """Bakes the keyframes of a hand, or of all hands, onto the joints, and releases the joints."""
    for name in [side] if side else [*hands, *waiting]:
        waiting.pop(name, None)
        hand = hands.pop(name, None)
        if hand is None:
            continue
        cmds.undoInfo(openChunk=True, chunkName="hand_sandbox stop")
        try:
            hand.finish(bake)
        finally:
            cmds.undoInfo(closeChunk=True)


def hand_sandbox(text: str) -> None:
    """Processes a line of the stream. A bad line raises no error, so that Maya continues."""
    undo = bool(cmds.undoInfo(query=True, state=True))
    try:
        line = Line(text)
        if line.kind == "stop":
            if line.side in hands:
                stop(line.side)
            return
        # A thousand small changes a minute would push everything else out of the undo queue.
        cmds.undoInfo(stateWithoutFlush=False)
        if line.kind == "rig" and line.side in waiting:
            _make(line, **waiting.pop(line.side))
        elif line.kind == "moment" and line.side in hands:
            hands[line.side].update(line)
        counts["lines"] += 1
    except Exception as error:  # an error that reaches the command port could end it
        counts["lines refused"] += 1
        if counts["lines refused"] <= TOLD:
            cmds.warning("hand_sandbox: %s" % error)
        for side in [s for s, hand in hands.items() if not cmds.objExists(hand.palm)]:
            cmds.warning("hand_sandbox: the %s hand's targets are gone; start() again" % side)
            del hands[side]
    finally:
        if undo:
            cmds.undoInfo(stateWithoutFlush=True)


def open_port(port: int = 7002) -> None:
    """Opens Maya's command port for this machine only. Any program that reaches it can run code."""
    if not asked.commandPort("127.0.0.1:%d" % port, query=True):
        cmds.commandPort(name="127.0.0.1:%d" % port, sourceType="python", noreturn=True)


def close_port(port: int = 7002) -> None:
    """Closes Maya's command port."""
    cmds.commandPort(name="127.0.0.1:%d" % port, close=True)


def _hand(
    chosen: Sequence[str],
    fingers: Optional[Sequence[int]],
    side: str,
    root: Optional[str],
    **options: Any,
) -> HandRig:
    if len(chosen) not in BY_COUNT:
        raise Refused(
            "%d joints are selected: select the first joints of 1 to 5 chains" % len(chosen)
        )
    wanted = BY_COUNT[len(chosen)] if fingers is None else tuple(fingers)
    if len(wanted) != len(chosen) or len({*wanted} & {*range(5)}) != len(chosen):
        raise Refused("fingers=%r do not name each of %d chains" % (wanted, len(chosen)))
    chains = [_chain(joint) for joint in chosen]
    every = [joint for chain in chains for joint in chain]
    if len({*every}) != len(every):
        raise Refused("one of the selected joints is in the chain of another joint")
    if root is None:
        root = _above(chains)
    elif root:
        root = _long(root)
    for chain in chains:
        for joint in chain[:-1]:
            _check_free(joint, "rotate")
    if root:
        _check_free(root, "translate", "rotate")
    return HandRig(chains, wanted, side, root or None, **options)


def _chain(joint: str) -> List[str]:
    """A joint and the joints below it; at every fork, the first joint."""
    chain = [joint]
    while True:
        below = cmds.listRelatives(chain[-1], children=True, type="joint", fullPath=True) or []
        if not below:
            break
        chain.append(below[0])
    if len(chain) < 2:
        raise Refused("%s has no joint below it" % joint)
    return chain


def _above(chains: Sequence[Sequence[str]]) -> str:
    """Path of the nearest transform above all chains; empty without one.

    There may be metacarpals between the transform and the chains.
    """
    shared: List[str] = []
    for names in zip(*(chain[0].split("|")[:-1] for chain in chains)):
        if len({*names}) > 1:
            break
        shared.append(names[0])
    return "|".join(shared)


def _check_free(node: str, *attributes: str) -> None:
    """Refuses attributes that cannot be baked, since their motion would be lost at the end."""
    for attribute in attributes:
        for axis in ("", "X", "Y", "Z"):
            plug = "%s.%s%s" % (node, attribute, axis)
            if cmds.getAttr(plug, lock=True):
                raise Refused("%s is locked, so it cannot be baked: unlock it" % plug)
            for source in cmds.listConnections(plug, source=True, destination=False) or []:
                if not str(cmds.nodeType(source)).startswith("animCurve"):
                    raise Refused("%s is driven by %s: disconnect it first" % (plug, source))


def _make(line: Line, **options: Any) -> None:
    """Makes joints of the streamed hand, with straight fingers and the palm down, and their rig."""
    metre = options["scale"] or UNITS.get(str(cmds.currentUnit(query=True, linear=True)), 100.0)
    quarter = math.sqrt(0.5)
    flat: Quaternion = (1.0, 0.0, 0.0, 0.0) if _up()[2] else (quarter, -quarter, 0.0, 0.0)
    made: List[Tuple[str, Vector, Quaternion]] = []
    for name, parent, shift, turn in line.bones:
        if parent < 0:
            made.append((_joint("%s_%s" % (name, line.side), shift, metre, None), shift, flat))
            continue
        above, place, so_far = made[parent]
        place = plus(place, rotated(so_far, shift))
        joint = _joint("%s_%s" % (name, line.side), place, metre, above)
        made.append((joint, place, product(so_far, turn)))
    for parent, reach in sorted(line.ends.items()):
        above, place, so_far = made[parent]
        name = "%s_tip_%s" % (line.bones[parent][0], line.side)
        _joint(name, plus(place, rotated(so_far, reach)), metre, above)
    firsts = [made[i][0] for i, bone in enumerate(line.bones) if bone[1] == 0]
    for first in firsts:
        # The usual convention of rigs: x along the bone, y out of the back of the hand.
        cmds.joint(
            first,
            edit=True,
            orientJoint="xyz",
            secondaryAxisOrient="zup" if _up()[2] else "yup",
            children=True,
            zeroScaleOrient=True,
        )
    options.update(root=made[0][0], scale=metre, absolute=True, frame=rows_of(flat))
    hands[line.side] = _hand(firsts, None, line.side, **options)


def _joint(name: str, place: Vector, metre: float, above: Optional[str]) -> str:
    cmds.select(clear=True)
    joint = str(cmds.joint(name=name, position=times(place, metre)))
    return _long(cmds.parent(joint, above)[0] if above else joint)


def _long(name: Any) -> str:
    """The full path of a node. Short names are not unique if two rigs share them."""
    paths = cmds.ls(str(name), long=True) or []
    if len(paths) != 1:
        raise Refused("%s %s" % ("more than one node is named" if paths else "there is no", name))
    return str(paths[0])


def _prefer(joint: str, frame: Rows, coupling: float) -> None:
    """Sets the direction in which a solver bends a joint: about the palm's x axis.

    Solvers bend the joints of a chain in proportion to their preferred angles.
    """
    step = STEP * coupling * _degree()
    m = asked.xform(joint, query=True, worldSpace=True, matrix=True)
    rest = cmds.getAttr(joint + ".rotate")[0]
    for i, letter in enumerate("XYZ"):
        share = sum(m[4 * i + k] * frame[k][0] for k in range(3))
        cmds.setAttr("%s.preferredAngle%s" % (joint, letter), rest[i] - step * share)


def _place(node: str) -> Vector:
    x, y, z = asked.xform(node, query=True, worldSpace=True, translation=True)
    return (x, y, z)


def _up() -> Vector:
    return (0.0, 0.0, 1.0) if cmds.upAxis(query=True, axis=True) == "z" else (0.0, 1.0, 0.0)


def _rate() -> float:
    """Frames per second of the scene."""
    unit = str(cmds.currentUnit(query=True, time=True))
    told = re.match(r"([0-9]+\.?[0-9]*)(fps|df)\Z", unit)
    if told is None and unit not in RATES:
        raise Refused("the scene's unit of time is not known: %s" % unit)
    return float(told.group(1)) if told else RATES[unit]


def _degree() -> float:
    """One degree in the scene's unit of angles."""
    return math.radians(1.0) if cmds.currentUnit(query=True, angle=True) == "rad" else 1.0


def _show(first: int, last: int) -> None:
    """Extends the time slider to the keyframes."""
    begin, end = ("animationStartTime", "minTime"), ("animationEndTime", "maxTime")
    for flag in begin + end:
        now = float(asked.playbackOptions(**{"query": True, flag: True}))
        wanted = min(now, first) if flag in begin else max(now, last)
        if wanted != now:
            asked.playbackOptions(**{flag: wanted})


# A command port runs its commands in __main__, independent of the module of this file.
__main__.hand_sandbox = hand_sandbox
