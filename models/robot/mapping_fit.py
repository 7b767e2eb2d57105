"""Fits a mapping between a robot hand and a person's hand.

The input is the robot's model and the names of its fingertips. The robot hand is a right or a left
hand, depending on which hand of a person has a more similar signed volume (`volume`). First, the
robot's palm is laid over the person's palm, so that knuckles and fingertips are near each other.
Then it is moved to the place at which the robot's fingers reach the person's fingertips best, in
many poses with joints near the middle of their ranges.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Any, NamedTuple

import mujoco
import numpy as np
from numpy.polynomial import Polynomial

from models.arithmetic import Array, length
from models.errors import InputError
from models.frames import FINGERS
from models.pose import JOINTS, POSE_SIZE
from models.robot.constraints import Law, coupling_laws, not_followed
from models.robot.mapping import RobotMapping, check_tips
from models.robot.retargeting import Retargeter
from models.robot.robot_hand import RobotHand
from models.robot.robot_model import RobotModel, compiled
from models.rotations import matrix_to_quaternion, quaternion_to_matrix
from models.single_pose import SinglePose
from models.skeleton import ADULT, Skeleton

SLICE = 0.006
"""Length (m) of the part of a link that counts as its end."""


class TipEnd(NamedTuple):
    """The round end of a link.

    Attributes:
        place: (3,) m, the middle of the end, in the frame of the link's body.
        radius: Half of the least width (m) of the end.
    """

    place: tuple[float, float, float]
    radius: float


def tip_ends(model: Any, bodies: Iterable[str]) -> list[TipEnd]:
    """Ends of links, at the points of their meshes that are farthest from the bodies' origins.

    Args:
        model: MuJoCo's model of the robot.
        bodies: Names of the bodies of the last links.

    Raises:
        InputError: There is no such body, or it has no mesh.
    """
    return [_end(model, name) for name in bodies]


def _end(model: Any, name: str) -> TipEnd:
    body = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name))
    points = _points(model, body) if body >= 0 else np.zeros((0, 3))
    if not len(points):
        raise InputError(
            "this robot has no body of this name with a mesh",
            where="--tips",
            got=name,
            remedy="Name sites at the fingertips, and leave --ends out",
        )
    far = points[np.argmax(np.sum(points * points, axis=1))]
    # The end may be cut off at an angle. Its direction is therefore that of all points near it.
    along = np.mean(_last(points, far), axis=0)
    along /= np.sqrt(np.sum(along * along))
    last = _last(points, along)
    height = last @ along
    across = last - height[:, None] * along
    middle = 0.5 * (across.min(axis=0) + across.max(axis=0))
    ways = np.linalg.svd(across - middle, full_matrices=False)[2][:2]
    radius = 0.5 * min(float(np.ptp(across @ way)) for way in ways)
    x, y, z = (round(float(v), 5) for v in middle + (height.max() - radius) * along)
    return TipEnd((x, y, z), round(radius, 5))


def _last(points: Array, along: Array) -> Array:
    """Points of a link within `SLICE` of its end in a direction (3,)."""
    height = points @ (along / np.sqrt(np.sum(along * along)))
    return points[height > height.max() - SLICE]


def _points(model: Any, body: int) -> Array:
    """(n, 3) m, points of a body's meshes in its frame."""
    out = [np.zeros((0, 3))]
    for geom in np.flatnonzero(model.geom_bodyid == body):
        mesh = int(model.geom_dataid[geom])
        if int(model.geom_type[geom]) == int(mujoco.mjtGeom.mjGEOM_MESH):
            start = int(model.mesh_vertadr[mesh])
            points = model.mesh_vert[start : start + int(model.mesh_vertnum[mesh])]
            turn = quaternion_to_matrix(model.geom_quat[geom])
            out.append(points @ turn.T + model.geom_pos[geom])
    return np.concatenate(out)


STRAIGHT, BENT = 0.1, 0.7
"""Shares of the range of flexion at which fingers count as straight and as bent."""
NEARER = 0.03
"""The thumb is beside one of the outer fingers if its distances to the tips of both differ by more
than this share."""
LEAST_WAY = 1e-6
"""Length (m) below which a vector has no usable direction."""


def volume(knuckles: Array, straight: Array, bent: Array) -> float:
    """Signed volume, -1 to 1, of the parallelepiped of three unit vectors.

    They point across the fingers, along them, and in the direction in which they close.

    The volume is NaN for fingers that do not bend, for example because their joints have no ranges.
    Left and right hands have opposite signs.

    Args:
        knuckles: (n, 3) m, beginnings of the fingers, from the index finger on.
        straight: (n, 3) m, tips of the straight fingers.
        bent: (n, 3) m, tips of the bent fingers.
    """
    across = knuckles[0] - knuckles[-1]
    along = np.mean(straight - knuckles, axis=0)
    closing = np.mean(bent - straight, axis=0)
    sides = (across, along, closing)
    if min(length(side) for side in sides) < LEAST_WAY:
        return math.nan
    (a, b, c), (d, e, f), (g, h, i) = (side / np.sqrt(np.sum(side * side)) for side in sides)
    return float(a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g))


def robot_volume(robot: RobotModel) -> float:
    """The signed volume (see `volume`) of a robot's hand."""
    knuckles, straight = robot.bent(STRAIGHT)
    return volume(knuckles[1:], straight[1:], robot.bent(BENT)[1][1:])


def order_of(robot: RobotModel) -> list[int]:
    """The numbers of the fingers without the thumb, 1 to n - 1, in their order across the palm.

    The first is the finger beside the thumb. If the thumb is about equally far from both outer
    fingers, the first is the outer finger with the smaller number.
    """
    knuckles, tips = robot.bent(STRAIGHT)
    fingers = range(1, len(knuckles))
    ends = max(
        combinations(fingers, 2), key=lambda pair: length(knuckles[pair[1]] - knuckles[pair[0]])
    )
    across = knuckles[ends[1]] - knuckles[ends[0]]
    order = sorted(fingers, key=lambda finger: float(np.sum(knuckles[finger] * across)))
    near, far = (length(tips[0] - tips[order[end]]) for end in (0, -1))
    beside = near > far if abs(near - far) > NEARER * max(near, far) else order[0] > order[-1]
    return order[::-1] if beside else order


def person_volume(person: Skeleton, fingers: int = len(FINGERS)) -> float:
    """The signed volume (see `volume`) of a person's hand.

    Args:
        person: The hand.
        fingers: Number of fingers that count, including the thumb, from the thumb on.
    """
    knuckles = np.array([person.bones[bone].anchor for bone in person.first_bone])
    straight, bent = (SinglePose(person).tips(flexed(person, share)) for share in (STRAIGHT, BENT))
    own = slice(1, fingers)
    return volume(knuckles[own], straight[own], bent[own])


def flexed(person: Skeleton, share: float) -> Array:
    """The pose (48,) of a hand at the origin with all fingers bent alike.

    Args:
        person: The hand.
        share: Share of the range of flexion by which the fingers are bent.
    """
    q = np.zeros(POSE_SIZE)
    # Flexion of a bone is a negative turn about its x axis.
    q[JOINTS][::3] = (person.upper + share * (person.lower - person.upper))[::3]
    return q


_GEOM = mujoco.mjtGeom

RADIUS = 0.008
"""Radius (m) of a fingertip whose shape has no radius."""
POSES, SPREAD = 16, 0.35
"""Number of poses of the fit, and the largest distance of their joints from the middle of the
range, as a share of half the range."""
ROUNDS = 5
"""Number of rounds. In each round, the robot hand follows every pose with a movable palm. The palm
of the mapping is then moved to the mean of the places that this palm took."""
READY = 1e-2, 1e-1
"""Variances (m2, rad2) of the palm's movement while its place is fitted."""
HELD = 1e-9, 1e-8
"""Variances (m2, rad2) of the palm's movement while errors are measured; the palm is then fixed."""
LEAST_SIZE, GREATEST_SIZE = 0.2, 5.0
"""Least and greatest possible length of a robot's fingers, relative to those of a person."""
UNITS = {"millimetres": 1e-3, "centimetres": 1e-2, "inches": 0.0254}
"""Units (m) that models use by mistake in place of metres."""
_BENT = (0.1, 0.4, 0.7)
"""Shares of the range of flexion at which hands are laid over each other."""
_MOST_LINKS = 3
"""Largest number of links in a finger's length, from the fingertip. Links before them belong to the
palm."""


def _check_order(robot: RobotModel, tips: Sequence[str]) -> None:
    """Checks that the fingertips are those of the thumb and then, in order, of the fingers beside
    it.

    In the opposite order, a right hand would count as a left hand.

    Raises:
        InputError: The fingertips are given in another order.
    """
    order = [tips[0], *(tips[finger] for finger in order_of(robot))]
    if order != list(tips):
        raise InputError(
            "the fingertips are in another order than the fingers",
            where="--tips",
            got=",".join(tips),
            expected="the thumb, then the other fingers in order, beginning beside the thumb",
            remedy=f"--tips {','.join(order)}, or --hand right or left for this order",
        )


@dataclass(frozen=True)
class MappingFit:
    """A fitted mapping.

    Attributes:
        mapping: The mapping.
        errors: (poses, n) m, distance of each fingertip from the person's fingertip, with a fixed
            palm.
        shape: Root mean square distance (m) between knuckles and fingertips of the robot's and the
            person's hand, laid over each other and equally bent.
        mirrored: The same distance (m) for the person's other hand.
        side: Difference between the signed volumes of the robot's and the person's hand (`volume`);
            NaN if the joints have no ranges.
        other_side: The same difference for the person's other hand.
        not_followed: Parts of the model that the hand in a scene lacks, or that differ there.
    """

    mapping: RobotMapping
    errors: Array
    shape: float
    mirrored: float
    side: float
    other_side: float
    not_followed: tuple[str, ...]


def fit_mapping(
    path: Path,
    tips: Sequence[str],
    palm: str = "",
    model: str = "",
    ends: bool = False,
    hand: str = "",
) -> MappingFit:
    """Fits a mapping to a model.

    Args:
        path: MJCF file of the robot.
        tips: Names of the sites or bodies at the middle of the n fingertips, thumb first. A hand
            with four fingertips lacks the little finger, a hand with three also the ring finger.
        palm: Name of the body that carries all fingers; empty finds it.
        model: Place of the model to be written into the mapping; empty uses the file's name.
        ends: True if `tips` are the bodies of the last links, and the ends of their meshes are the
            fingertips.
        hand: `right` or `left`; empty finds the side, for which the joints need ranges.

    Raises:
        InputError: The model cannot be used.
    """
    check_tips(tips, "--tips")
    palm = palm or _carrier(path, tips)
    rounded = tip_ends(compiled(path)[0], tips) if ends else []
    places = tuple(end.place for end in rounded)
    robot = RobotModel(path, palm, tips, places)
    people = {"right": ADULT, "left": ADULT.mirrored()}
    _check_size(robot, ADULT)
    own = robot_volume(robot)
    volumes = {side: person_volume(person, len(tips)) for side, person in people.items()}
    apart = {side: abs(own - volume) for side, volume in volumes.items()}
    if not hand and not np.isfinite(own):
        raise InputError(
            "the side of this hand cannot be found without ranges of its joints",
            where=str(path),
            remedy="Give it: --hand right or --hand left",
        )
    if not hand:
        _check_order(robot, tips)
    side = hand or min(apart, key=lambda name: apart[name])
    other = "left" if side == "right" else "right"
    laid = {name: _laid_over(robot, person) for name, person in people.items()}
    start = RobotMapping(
        model or path.name,
        side,
        palm,
        tuple(tips),
        tuple(end.radius for end in rounded) or _radii(robot),
        _scales(robot, people[side]),
        _three(laid[side].offset),
        _four(laid[side].turn),
        _coupled(robot),
        places,
        str(path.with_suffix(".toml")),
    )
    mapping, errors = _moved(start, people[side])
    return MappingFit(
        mapping,
        errors,
        laid[side].error,
        laid[other].error,
        apart[side],
        apart[other],
        tuple(not_followed(RobotHand("fit", mapping, people[side]))),
    )


class _Laid(NamedTuple):
    """A robot's palm laid over a person's palm.

    Attributes:
        turn: (4,) quaternion, person from robot.
        offset: (3,) m, origin of the robot's palm in the frame of the person's hand.
        error: Root mean square distance of knuckles and fingertips (m).
    """

    turn: Array
    offset: Array
    error: float


def _moved(mapping: RobotMapping, person: Skeleton) -> tuple[RobotMapping, Array]:
    """Moves the palm of a mapping to the best place.

    Returns:
        The changed mapping, and its errors (poses, n) m with a fixed palm.
    """
    poses = _poses(person)
    for _ in range(ROUNDS):
        follow = _retargeter(mapping, person, READY)
        places, turns = [], []
        for q in poses:
            follow.reset()
            qpos = follow.follow(q)
            places.append(qpos[:3])
            turns.append(qpos[3:7])
        # For a hand at the origin, `Retargeter` puts the palm at
        # mean((1 - scale) tip) + mean(scale) offset. This is solved for the offset.
        scales = np.array(mapping.scales)[:, None]
        tips = [SinglePose(person).tips(q)[: len(scales)] for q in poses]
        rest = [p - np.mean((1.0 - scales) * t, axis=0) for p, t in zip(places, tips, strict=True)]
        offset = np.mean(rest, axis=0) / np.mean(scales)
        turn = _mean_turn(np.array(turns))
        mapping = replace(mapping, offset=_three(offset), turn=_four(turn))
    follow = _retargeter(mapping, person, HELD)
    errors = []
    for q in poses:
        follow.reset()
        follow.follow(q)
        errors.append(follow.off)
    return mapping, np.array(errors)


def _retargeter(mapping: RobotMapping, person: Skeleton, palm: tuple[float, float]) -> Retargeter:
    return RobotHand("fit", mapping, person).retargeter(palm)


def _poses(person: Skeleton) -> list[Array]:
    """Poses (48,) of a hand at the origin: the zero pose, and random poses around the middle of the
    joints' ranges."""
    rng = np.random.default_rng(0)
    middle, half = 0.5 * (person.lower + person.upper), 0.5 * (person.upper - person.lower)
    out = []
    for i in range(POSES):
        q = np.zeros(POSE_SIZE)
        if i:
            q[JOINTS] = middle + half * rng.uniform(-SPREAD, SPREAD, len(half))
        out.append(q)
    return out


def _laid_over(robot: RobotModel, person: Skeleton) -> _Laid:
    """Lays the robot's hand over the person's hand, so that knuckles and fingertips of equally bent
    hands are near each other (least squares)."""
    fingers = len(robot.tips)
    knuckles = np.array([person.bones[i].anchor for i in person.first_bone])[:fingers]
    theirs, own = [], []
    for share in _BENT:
        # The joints of thumbs differ between hands, so only the beginning of the thumb is used.
        bases, tips = robot.bent(share)
        theirs += [knuckles, SinglePose(person).tips(flexed(person, share))[1:fingers]]
        own += [bases, tips[1:]]
    there, here = np.concatenate(theirs), np.concatenate(own)
    centre, middle = there.mean(axis=0), here.mean(axis=0)
    u, _, v = np.linalg.svd((there - centre).T @ (here - middle))
    turn = u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v
    offset = centre - turn @ middle
    apart = there - offset - here @ turn.T
    error = float(np.sqrt(np.mean(np.sum(apart * apart, axis=1))))
    return _Laid(matrix_to_quaternion(turn), offset, error)


def _carrier(path: Path, tips: Sequence[str]) -> str:
    """Name of the last body in the tree that carries all fingertips."""
    model, _ = compiled(path)
    above: list[int] | None = None
    for name in tips:
        site = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name))
        body = (
            int(model.site_bodyid[site])
            if site >= 0
            else int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name))
        )
        if body < 0:
            sites = ", ".join(filter(None, (model.site(s).name for s in range(model.nsite))))
            raise InputError(
                "this robot has no site or body of this name for a fingertip",
                where="--tips",
                got=name,
                expected=f"one of {sites[:400]}" if sites else "names of bodies",
                remedy=None if sites else "With --ends, give the fingers' last bodies",
            )
        way = [body]
        while body > 0:
            body = int(model.body_parentid[body])
            way.append(body)
        above = way if above is None else [b for b in above if b in way]
    carrier = above[0] if above else 0
    if carrier == 0 and _whole_hands(model):
        raise InputError(
            "these fingertips are not all on the same hand",
            where="--tips",
            got=", ".join(tips),
            remedy="Name the fingertips of one hand",
        )
    return str(model.body(carrier).name)


def _whole_hands(model: Any) -> bool:
    """True if a body other than the world carries several bodies. Such bodies are palms, so the
    world is not the palm."""
    parents = [int(model.body_parentid[b]) for b in range(1, model.nbody)]
    return any(parents.count(b) > 1 for b in range(1, model.nbody))


def _check_size(robot: RobotModel, person: Skeleton) -> None:
    """Refuses a hand that is many times larger or smaller than a person's.

    The unit of its model is probably not the metre.
    """
    sizes = _scales(robot, person)
    size = float(np.median(sizes))
    if LEAST_SIZE < size < GREATEST_SIZE:
        return
    units = [name for name, unit in UNITS.items() if LEAST_SIZE < size * unit < GREATEST_SIZE]
    raise InputError(
        "the fingers of this hand have lengths that no hand has",
        where=str(robot.path),
        got=f"{size:.3g} times the lengths of a person's fingers",
        expected=f"{LEAST_SIZE:g} to {GREATEST_SIZE:g} times",
        remedy=f"Is the model in {' or '.join(units)}? MuJoCo's unit is the metre"
        if units
        else None,
    )


def _coupled(robot: RobotModel) -> dict[str, tuple[str, float | tuple[float, ...]]]:
    """Joints coupled to other joints by equalities, or by tendons with a narrow range.

    The form is that of `RobotMapping.coupled`.
    """
    model, names = robot.model, set(robot.joint_names())
    driven = {
        model.joint(int(model.actuator_trnid[a, 0])).name
        for a in range(model.nu)
        if int(model.actuator_trntype[a]) == int(mujoco.mjtTrn.mjTRN_JOINT)
    }
    out: dict[str, tuple[str, Law]] = {}
    for first, second, law in coupling_laws(robot):
        if not any(law[1:]):
            continue
        straight = not any(law[2:])
        if straight and first in driven and second not in driven:
            first, second, law = second, first, (-law[0] / law[1], 1.0 / law[1])
        circle = second == first or (second in out and _free_joint(second, out)[0] == first)
        if {first, second} <= names and not circle and first not in out:
            out[first] = second, law
    return {name: _rounded(*_free_joint(name, out)) for name in out}


def _rounded(joint: str, law: Law) -> tuple[str, float | Law]:
    """A coupling in the form of a mapping: a ratio if the polynomial is only a ratio."""
    return joint, law[1] if not law[0] and not any(law[2:]) else law


def _free_joint(name: str, coupled: Mapping[str, tuple[str, Law]]) -> tuple[str, Law]:
    """The free joint at the end of a joint's chain of couplings, and the joint's polynomial in the
    angle of the free joint."""
    joint, law = coupled[name]
    while joint in coupled:
        joint, step = coupled[joint]
        whole = Polynomial(law)(Polynomial(step))
        law = tuple(float(c) for c in whole.coef)
    return joint, law


def _radii(robot: RobotModel) -> tuple[float, ...]:
    """Radii (m) of the capsules and spheres at the fingertips."""
    model, round_ = robot.model, [int(_GEOM.mjGEOM_CAPSULE), int(_GEOM.mjGEOM_SPHERE)]
    out = []
    for body, _ in robot.tips:
        own = [g for g in range(model.ngeom) if int(model.geom_bodyid[g]) == body]
        sizes = [float(model.geom_size[g, 0]) for g in own if int(model.geom_type[g]) in round_]
        out.append(round(max(sizes), 5) if sizes else RADIUS)
    return tuple(out)


def _scales(robot: RobotModel, person: Skeleton) -> tuple[float, ...]:
    """Length of each finger, relative to the person's finger."""
    out = []
    for finger in range(len(robot.tips)):
        theirs = sum(bone.length for bone in person.bones if bone.finger == finger)
        out.append(round(robot.reach(finger, _MOST_LINKS) / theirs, 4))
    return tuple(out)


def _mean_turn(turns: Array) -> Array:
    """Mean (4,) of nearby quaternions (n, 4)."""
    turns = turns * np.where(turns @ turns[0] < 0, -1.0, 1.0)[:, None]
    mean = turns.mean(axis=0)
    return matrix_to_quaternion(quaternion_to_matrix(mean / np.linalg.norm(mean)))


def _three(v: Array) -> tuple[float, float, float]:
    return round(float(v[0]), 5), round(float(v[1]), 5), round(float(v[2]), 5)


def _four(v: Any) -> tuple[float, float, float, float]:
    return float(v[0]), float(v[1]), float(v[2]), float(v[3])
