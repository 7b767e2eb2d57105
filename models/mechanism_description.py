"""Compiles the MJCF description of a mechanism with MuJoCo and checks it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from models.errors import InputError
from models.mjcf_object import GEOM_KINDS, described_in, read_mjcf, solid_geoms, unreadable

PROBE = "hand sandbox probe"
"""Name of the probe: a ball with which MuJoCo measures distances to shapes without a formula."""
PROBE_RADIUS = 1e-3
"""Radius (m) of the probe; measured distances are corrected by it."""

_BASE_MASS, _BASE_INERTIA = 1e-3, 1e-6
"""Mass (kg) and inertia (kg m2) given to a fixed base that is described without mass."""

_HINGE, _SLIDE = mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE
_FREE = mujoco.mjtJoint.mjJNT_FREE


@dataclass(frozen=True)
class Compiled:
    """A compiled description.

    Attributes:
        model: MuJoCo's model. Body 0 is the world and the last body is the probe. All bodies
            between them belong to the mechanism, and the first of these carries the others.
        fixed: True if the description gives the first body no joint.
    """

    model: Any
    fixed: bool

    @property
    def bodies(self) -> range:
        """Indices of the mechanism's bodies, carriers first."""
        return range(1, self.model.nbody - 1)


def compile_mechanism(mjcf: str | Path, name: str) -> Compiled:
    """Compiles and checks a description.

    Args:
        mjcf: A whole description, or the path of a file.
        name: Name of the mechanism, for error messages.

    Raises:
        InputError: MuJoCo refuses the description, or it is not a mechanism.
    """
    where = described_in(mjcf, name)
    try:
        spec = read_mjcf(mjcf, "Mechanism")
        # MuJoCo merges bodies that are welded to each other.
        spec.compiler.fusestatic = True
        roots = list(spec.worldbody.bodies)
        if len(roots) != 1:
            raise InputError(
                "a mechanism needs one body in the world, which carries all others",
                where=where,
                got=f"{len(roots)} bodies",
            )
        _check_joints(spec, where)
        fixed = not roots[0].joints
        if fixed:
            # Without a joint, MuJoCo would merge the first body's geoms into the world.
            roots[0].add_freejoint()
        probe = spec.worldbody.add_body(name=PROBE, mocap=True)
        size = [PROBE_RADIUS, 0.0, 0.0]
        probe.add_geom(name=PROBE, type=mujoco.mjtGeom.mjGEOM_SPHERE, size=size)
        try:
            model = spec.compile()
        except ValueError:
            if not fixed:
                raise
            # MuJoCo refuses a free joint on a body without mass. The base is fixed in a scene, so
            # its mass and inertia have no effect there. If the description has another mistake,
            # the second attempt raises it.
            base = roots[0]
            base.explicitinertial, base.mass, base.inertia = True, _BASE_MASS, [_BASE_INERTIA] * 3
            base.ipos, base.iquat = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
            model = spec.compile()
    except (ValueError, OSError) as error:
        raise unreadable(mjcf, name, error) from None
    compiled = Compiled(model, fixed)
    _check_bodies(compiled, where)
    return compiled


def _check_joints(spec: Any, where: str) -> None:
    """Checks that every jointed body but the first has a name, and that every hinge and slide has
    a range or `limited="false"`.

    Raises:
        InputError: A name or range is missing, or a range begins with its highest value.
    """
    world = spec.worldbody.name
    for body in spec.bodies:
        if body.joints and not body.name and body.parent.name != world:
            inside = body.parent.parent.name != world
            carrier = "a body without a name" if inside else "the first body"
            raise InputError(
                "a body that moves needs a name",
                where=where,
                got=f"none for the body in {body.parent.name or carrier}, {body.info}",
            )
        for joint in body.joints:
            low, high = joint.range.tolist()
            endless = joint.limited == mujoco.mjtLimited.mjLIMITED_FALSE
            if joint.type not in (_HINGE, _SLIDE) or endless or low < high:
                continue
            called = body.name or "its first body"
            if low > high:
                raise InputError(
                    f"the range of the joint of {called} begins with its highest value",
                    where=where,
                    got=f"{low:g} {high:g}",
                    expected=f'the lowest value first, range="{high:g} {low:g}"',
                )
            example, unit = ("0 0.05", "m") if joint.type == _SLIDE else ("0 270", "degrees")
            if joint.type == _HINGE and not joint.compiler.degree:
                example, unit = "0 4.7", "rad"
            raise InputError(
                f"the {'slide' if joint.type == _SLIDE else 'hinge'} of {called} has no range",
                where=where,
                expected=f'its lowest and highest value in {unit}, such as range="{example}"',
                remedy='Write limited="false" for a joint without end stops',
            )


def _check_bodies(compiled: Compiled, where: str) -> None:
    """Checks that every body has one hinge or slide (the first body may have a free joint) and
    supported geoms only, and that one geom is solid.

    Raises:
        InputError: A check fails, or the description has an equality, tendon or actuator.
    """
    model = compiled.model
    more = {"equality": model.neq, "tendon": model.ntendon, "actuator": model.nu}
    if any(more.values()):
        raise InputError(
            "a mechanism has bodies and joints only",
            where=where,
            got=", ".join(what for what, count in more.items() if count),
            remedy="Give its joints stiffness, damping and frictionloss instead",
        )
    for body in compiled.bodies:
        name = model.body(body).name
        called = name or ("its first body" if body == 1 else "a body without a name")
        kinds = model.jnt_type[model.jnt_bodyid == body].tolist()
        allowed = {_HINGE, _SLIDE, _FREE} if body == 1 else {_HINGE, _SLIDE}
        if len(kinds) != 1 or kinds[0] not in {int(kind) for kind in allowed}:
            raise InputError(
                f"{called} is not joined by one hinge or one slide",
                where=where,
                got=f"{len(kinds)} joints" if len(kinds) > 1 else "another kind of joint",
            )
        if not set(model.geom_type[model.geom_bodyid == body].tolist()) <= set(GEOM_KINDS):
            raise InputError(
                f"{called} has a geom of an unsupported kind",
                where=where,
                expected=", ".join(kind for kind, _ in GEOM_KINDS.values()),
            )
        _check_losses(model, body, called, where)
    inside = np.isin(model.geom_bodyid, list(compiled.bodies))
    if not np.any(inside & solid_geoms(model)):
        raise InputError(
            "the mechanism has no solid geom",
            where=where,
            expected="a geom with contype or conaffinity",
        )


def _check_losses(model: Any, body: int, called: str, where: str) -> None:
    """Checks that a body's joint cannot create energy.

    MuJoCo accepts a negative damping, with which a joint drives itself. A negative stiffness is
    allowed: it describes a switch that snaps over.

    Raises:
        InputError: Damping, friction loss or armature is negative or not finite.
    """
    own = model.dof_bodyid == body
    for what, values in (
        ("damping", model.dof_damping),
        ("frictionloss", model.dof_frictionloss),
        ("armature", model.dof_armature),
    ):
        for value in values[own].tolist():
            if not 0.0 <= value < float("inf"):
                raise InputError(
                    f"the {what} of the joint of {called} is out of range",
                    where=where,
                    got=f"{value:g}",
                    expected="0 or more",
                )
