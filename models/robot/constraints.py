"""Constraints of a robot's model: joints that follow other joints, and parts that a scene leaves
out.

A scene contains a new description of the hand, made from the compiled model. Couplings of joints
become polynomials that the retargeting follows. All other differences are found by comparing both
compiled models field by field, and are reported.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
from numpy.polynomial import Polynomial

from models.robot.mapping import coefficients
from models.robot.robot_model import LEAST_ARMATURE, RobotModel

if TYPE_CHECKING:
    from models.robot.robot_hand import RobotHand

Law = tuple[float, ...]
"""Coefficients of a polynomial in the angle of another joint; the constant coefficient comes
first."""

NARROW = 0.01
"""Two joints on a tendon count as coupled if the tendon's range is narrower than this width (m or
rad)."""

_EQUAL = mujoco.mjtEq
_FIELDS = {
    "body": {
        "body_pos": "places of bodies",
        "body_quat": "directions of bodies",
        "body_ipos": "centres of mass",
        "body_iquat": "axes of inertia",
        "body_mass": "masses",
        "body_inertia": "inertias",
    },
    "joint": {
        "jnt_type": "types of joints",
        "jnt_pos": "places of joints",
        "jnt_axis": "axes of joints",
        "jnt_range": "ranges of joints",
        "jnt_stiffness": "springs of joints",
    },
    "dof": {
        "dof_armature": "armature of joints",
        "dof_damping": "damping of joints",
        "dof_frictionloss": "friction of joints",
    },
}
"""Fields of a compiled model that are compared, with their names in messages. These are all fields
that determine the places and movements of a hand's parts. Contacts and shapes are not compared,
since a scene sets them equally for all robot hands."""
_TRIES = 4
"""Number of random poses at which couplings are compared."""
_NAMES = 4
"""Largest number of names in a text."""
_SAME = 1e-6
"""Relative and absolute tolerance of a comparison (m, rad, kg and so on)."""


def coupling_laws(robot: RobotModel) -> Iterator[tuple[str, str, Law]]:
    """Yields the pairs of joints that an equality or a narrow tendon couples: names of follower and
    followed joint, and the follower's polynomial in the angle of the followed joint."""
    model = robot.model
    for e in range(model.neq):
        if _couples(model, e):
            follower, other = int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
            # y - y0 = a0 + a1 (x - x0) + .. + a4 (x - x0)^4, with the zeros of both joints.
            shift = Polynomial([-_zero(model, other), 1.0])
            curve = Polynomial(model.eq_data[e, :5])(shift) + _zero(model, follower)
            yield model.joint(follower).name, model.joint(other).name, _trimmed(curve.coef)
    for t in range(model.ntendon):
        joints = robot.fixed_tendon(t)
        if len(joints) == 2 and _is_narrow(model, t) and all(arm for _, arm in joints):
            (first, one), (second, two) = joints
            middle = float(np.mean(model.tendon_range[t]))
            law = (middle / one, -two / one)
            yield model.joint(first).name, model.joint(second).name, law


def not_followed(hand: RobotHand) -> list[str]:
    """Parts of the robot's model that the hand in a scene lacks, or that differ there: one text for
    each kind of part."""
    found: dict[str, list[str]] = {}
    robot = hand.robot
    for kind, name in (
        *robot.mended,
        *_constraints(hand),
        *_actuators(robot),
        *_differences(hand),
    ):
        found.setdefault(kind, []).append(name)
    return [
        f"{kind}: {', '.join(names[:_NAMES])}"
        + (f" and {len(names) - _NAMES} more" if len(names) > _NAMES else "")
        for kind, names in found.items()
    ]


def _constraints(hand: RobotHand) -> Iterator[tuple[str, str]]:
    """Yields kind and name of the equalities and tendons that have no effect on the hand in a
    scene."""
    robot, coupled = hand.robot, hand.mapping.coupled
    model, bodies = robot.model, set(robot.bodies)
    for e in range(model.neq):
        kind = int(model.eq_type[e])
        if not model.eq_active0[e]:
            continue
        one, two = int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
        name = model.equality(e).name
        if kind == int(_EQUAL.mjEQ_JOINT):
            ends = [model.joint(j).name for j in (one, two) if j >= 0]
            if one not in robot.joints or _is_followed(hand, e):
                continue
            what = "joints held by an equality" if two < 0 else "couplings of joints"
        elif kind == int(_EQUAL.mjEQ_TENDON):
            ends, what = [model.tendon(t).name for t in (one, two) if t >= 0], "tied tendons"
        else:
            if kind in (int(_EQUAL.mjEQ_CONNECT), int(_EQUAL.mjEQ_WELD)):
                sites = int(model.eq_objtype[e]) == int(mujoco.mjtObj.mjOBJ_SITE)
                pair = [int(model.site_bodyid[s]) for s in (one, two)] if sites else [one, two]
                if not bodies & set(pair):
                    continue
                ends, what = [model.body(b).name for b in pair], "closed loops"
            else:
                ends, what = [name], "equalities"
        yield what, " with ".join(filter(None, ends)) or name or f"number {e}"
    for t in range(model.ntendon):
        joints = robot.fixed_tendon(t)
        names = [model.joint(j).name for j, _ in joints]
        if joints and not set(names) & set(robot.joint_names()):
            continue
        name = model.tendon(t).name or f"number {t}"
        followed = len(joints) == 2 and any(joint in coupled for joint in names)
        if model.tendon_limited[t] and not (followed and _is_narrow(model, t)):
            yield "ranges of tendons", name
        if model.tendon_stiffness[t]:
            yield "springs of tendons", name
        if model.tendon_frictionloss[t]:
            yield "friction of tendons", name


def _is_followed(hand: RobotHand, equality: int) -> bool:
    """True if the hand's couplings satisfy an equality of two joints."""
    robot, model = hand.robot, hand.robot.model
    joints = [int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality])]
    if not set(joints) <= set(robot.joints):
        return False
    names = robot.joint_names()
    one, two = (names[robot.joints.index(j)] for j in joints)
    curve = Polynomial(model.eq_data[equality, :5])
    low, high = robot.limits().T
    rng = np.random.default_rng(0)
    for _ in range(_TRIES):
        angles = dict(zip(names, rng.uniform(low, high), strict=True))
        for joint, (other, law) in hand.mapping.coupled.items():
            angles[joint] = float(Polynomial(coefficients(law))(angles[other]))
        y, x = angles[one] - _zero(model, joints[0]), angles[two] - _zero(model, joints[1])
        if not abs(y - float(curve(x))) < _SAME:
            return False
    return True


def _actuators(robot: RobotModel) -> Iterator[tuple[str, str]]:
    """Yields kind and name of the actuators whose limits cannot become limits of joints."""
    model = robot.model
    known = (
        int(mujoco.mjtTrn.mjTRN_JOINT),
        int(mujoco.mjtTrn.mjTRN_JOINTINPARENT),
        int(mujoco.mjtTrn.mjTRN_TENDON),
    )
    for a in range(model.nu):
        kind, target = int(model.actuator_trntype[a]), int(model.actuator_trnid[a, 0])
        bent = kind == known[2] and not robot.fixed_tendon(target)
        if kind not in known or bent:
            yield "limits of actuators", model.actuator(a).name or f"number {a}"


def _differences(hand: RobotHand) -> Iterator[tuple[str, str]]:
    """Fields that differ between the robot's own model and the model of the hand in a scene.

    Yields:
        The field, and the name of a body or joint.
    """
    robot, own, ours = hand.robot, hand.robot.model, hand.kinematic
    bodies = [b for b in robot.bodies if b != robot.palm]
    joints = robot.joints
    names = hand.joint_names
    places = {
        "body": (bodies, [int(ours.body(hand.body_name(b)).id) for b in bodies]),
        "joint": (joints, [int(ours.joint(name).id) for name in names]),
        "dof": (
            [int(own.jnt_dofadr[j]) for j in joints],
            [int(ours.joint(name).dofadr[0]) for name in names],
        ),
    }
    for kind, fields in _FIELDS.items():
        here, there = places[kind]
        for field, word in fields.items():
            theirs, kept = getattr(own, field)[here], getattr(ours, field)[there]
            if field == "jnt_range":
                theirs = robot.limits()
            elif field == "dof_armature":
                theirs = np.maximum(theirs, LEAST_ARMATURE)
            apart = ~np.isclose(theirs, kept, rtol=_SAME, atol=_SAME)
            rows = apart.reshape(len(apart), -1).any(axis=1)
            which = robot.joint_names()
            if kind == "body":
                which = [own.body(b).name or f"number {b}" for b in bodies]
            for i in np.flatnonzero(rows):
                yield word, which[i]


def _couples(model: Any, equality: int) -> bool:
    """True for an active equality between two joints."""
    return bool(
        int(model.eq_type[equality]) == int(_EQUAL.mjEQ_JOINT)
        and model.eq_obj2id[equality] >= 0
        and model.eq_active0[equality]
    )


def _is_narrow(model: Any, tendon: int) -> bool:
    width = float(np.ptp(model.tendon_range[tendon]))
    return bool(model.tendon_limited[tendon]) and width < NARROW


def _zero(model: Any, joint: int) -> float:
    return float(model.qpos0[int(model.jnt_qposadr[joint])])


def _trimmed(coefficients: Any) -> Law:
    """Coefficients without zeros at the end, at least two."""
    law = [float(c) for c in coefficients]
    while len(law) > 2 and not law[-1]:
        law.pop()
    return (*law, *[0.0] * (2 - len(law)))
