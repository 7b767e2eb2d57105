"""A robot's hand as MuJoCo compiles it, cut off at its palm.

MuJoCo compiles the whole description separately, with its defaults, meshes and includes. The bodies
below the palm go into the scene as plain MJCF, so neither names nor settings can clash.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

import mujoco
import numpy as np

from models.arithmetic import Array, length, stacked_applied, total
from models.errors import InputError
from models.frames import FINGERS
from models.mjcf_object import drawn_colour
from models.objects import mjcf_text
from models.plausible import RANGE, UNITS
from models.robot.mapping import MODEL_SUFFIXES, URDF, RobotMapping
from models.rotations import matrix_to_quaternion

_GEOM = mujoco.mjtGeom
_TYPES = {
    int(_GEOM.mjGEOM_SPHERE): ("sphere", 1),
    int(_GEOM.mjGEOM_CAPSULE): ("capsule", 2),
    int(_GEOM.mjGEOM_ELLIPSOID): ("ellipsoid", 3),
    int(_GEOM.mjGEOM_CYLINDER): ("cylinder", 2),
    int(_GEOM.mjGEOM_BOX): ("box", 3),
    int(_GEOM.mjGEOM_MESH): ("mesh", 0),
}
"""MuJoCo's type of a geom -> its name in MJCF, and its number of sizes."""
_JOINTS = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
_HINGE = int(mujoco.mjtJoint.mjJNT_HINGE)
_SEEN_GROUPS = 3
"""MuJoCo's viewer shows the geoms of groups 0 to 2."""
_OURS = re.compile(rf"palm|root(_[xyz])?|({'|'.join(FINGERS)})_link\d+")
"""Names of bodies and joints that a hand in a scene already has; a robot's own parts with these
names are renamed."""
WORLD_PALM_MASS, WORLD_PALM_INERTIA = 0.3, 3e-4
"""Mass (kg) and inertia (kg m2) of a palm that is part of the world, similar to those of a person's
palm."""
_FINITE = ("body_pos", "body_quat", "body_ipos", "body_inertia", "jnt_pos", "jnt_axis", "jnt_range")
"""Numeric fields of MuJoCo's model that determine the places of fingers."""
DEGREES = UNITS["angle"]["deg"]
RADIANS = 1.0 / DEGREES
"""Factors that correct degrees that were read as radians, and radians that were read as degrees."""
MESHES = (".obj", ".stl", ".msh")
"""Suffixes of the meshes that MuJoCo reads."""
_BALANCED = "inertias that no body can have, made equal about all axes"
LEAST_LINK = 0.004
"""Shortest link of a finger (m); shorter links are parts of one joint."""


@dataclass(frozen=True)
class RobotLink:
    """A link of a finger.

    Attributes:
        finger: Label of its finger.
        body: Number of its body in the robot's own model.
        end: (3,) m, its end in the frame of its body, whose origin is at the link's joint.
    """

    finger: int
    body: int
    end: tuple[float, float, float]


class RobotModel:
    """A robot's hand.

    Args:
        path: Its MJCF or URDF file.
        palm: Name of the body that carries all fingers; `world` if the palm is a part of the world.
        tips: Names of the sites or bodies at the middle of the fingertips, thumb first.
        places: (3,) m each, the middle of the fingertips in the frames of these bodies; if empty,
            the bodies' origins.

    Attributes:
        path: Its MJCF file.
        model: MuJoCo's model of the whole description.
        mended: Repaired or omitted parts of the description, and warnings: kinds and names.
        joints: Numbers of the hinges and slides below the palm, in MuJoCo's order.
        links: Links with a length of their own, finger by finger, from the palm outwards.

    Raises:
        InputError: MuJoCo cannot compile the description, or it has no such palm or tips.
    """

    def __init__(
        self,
        path: Path,
        palm: str,
        tips: Sequence[str],
        places: Sequence[tuple[float, float, float]] = (),
    ) -> None:
        self.path, self._where = path, str(path)
        model, self.mended = compiled(path)
        self.model = model
        if not palm:
            raise InputError(
                "the palm's body has no name",
                where=self._where,
                remedy="Name it in the model: the body that carries all fingers",
            )
        self.palm = self._named(mujoco.mjtObj.mjOBJ_BODY, palm, "palm")
        self.bodies = [b for b in range(model.nbody) if self._below(b)]
        inside = set(self.bodies) - {self.palm}
        self.joints = [j for j in range(model.njnt) if int(model.jnt_bodyid[j]) in inside]
        wrong = [model.joint(j).name for j in self.joints if int(model.jnt_type[j]) not in _JOINTS]
        if wrong or not self.joints:
            raise InputError(
                "the fingers of a robot's hand must have hinges or slides",
                where=self._where,
                got=", ".join(wrong) or f"no joints below the body {palm}",
            )
        for field in _FINITE:
            if not np.isfinite(getattr(model, field)).all():
                raise InputError(
                    "a number of this robot's model is not finite",
                    where=self._where,
                    got=f"nan or inf in {field}",
                )
        self._check_ranges()
        # MuJoCo treats a joint with such a range as a joint without limits.
        empty = [j for j in self.joints if model.jnt_range[j, 0] > model.jnt_range[j, 1]]
        if empty:
            raise InputError(
                "a range of a joint of this robot's hand begins with its higher value",
                where=self._where,
                got=", ".join(model.joint(j).name for j in empty)[:400],
                expected="the lower value first",
            )
        self.tips = [
            self._tip(name, place)
            for name, place in zip(tips, places or [(0.0, 0.0, 0.0)] * len(tips), strict=True)
        ]
        self.links = tuple(link for finger in range(len(self.tips)) for link in self._links(finger))

    def _check_ranges(self) -> None:
        """Refuses ranges of hinges if degrees were read as radians, or radians as degrees."""
        model = self.model
        hinges = [j for j in self.joints if model.jnt_limited[j] and model.jnt_type[j] == _HINGE]
        if not hinges:
            return
        width = float(np.median(np.abs(np.diff(model.jnt_range[hinges], axis=1))))
        if width == 0.0 or RANGE.includes(width):
            return
        units = [unit for unit in (RADIANS, DEGREES) if RANGE.includes(width * unit)]
        raise InputError(
            "the joints of this hand have ranges that no finger has",
            where=self._where,
            got=f"{width:.3g} rad as the median",
            expected=f"{RANGE.least:g} to {RANGE.most:g} rad",
            remedy=f"Are they written in {'radians' if units[0] > 1 else 'degrees'}? The model's "
            "compiler says which unit angles have; those of a URDF are radians"
            if units
            else None,
        )

    def joint_names(self) -> list[str]:
        """Names of the joints below the palm."""
        return [self.model.joint(j).name for j in self.joints]

    def scene_names(self) -> list[str]:
        """Names, in a scene, of the joints below the palm, without the prefix of the hand."""
        return [_own(self.model.joint(j).name) or f"joint{j}" for j in self.joints]

    def limits(self) -> Array:
        """(n, 2) rad, least and greatest angle of every joint."""
        model = self.model
        limited = model.jnt_limited[self.joints].astype(bool)[:, None]
        return np.where(limited, model.jnt_range[self.joints], [[-np.pi, np.pi]])

    def force_limits(self) -> Array:
        """Greatest torque (n,) N m of the actuators of every joint, in its stronger direction.

        Actuators of fixed tendons count for all joints of the tendon. The torque of joints without
        a limit is infinite.
        """
        model = self.model
        actuators: dict[int, float] = {}
        for a in range(model.nu):
            force = self._actuator_force(a)
            for joint, arm in self._arms(a):
                actuators[joint] = actuators.get(joint, 0.0) + abs(arm) * force
        own = np.abs(model.jnt_actfrcrange).max(axis=1)
        own[~model.jnt_actfrclimited.astype(bool)] = np.inf
        return np.array([min(actuators.get(j, np.inf), own[j]) for j in self.joints])

    def _actuator_force(self, actuator: int) -> float:
        """Greatest force of an actuator, before its gear; infinite if the model has no limit."""
        model = self.model
        limits = [np.inf]
        if model.actuator_forcelimited[actuator]:
            limits.append(float(np.abs(model.actuator_forcerange[actuator]).max()))
        direct = (
            int(model.actuator_gaintype[actuator]) == int(mujoco.mjtGain.mjGAIN_FIXED)
            and int(model.actuator_biastype[actuator]) == int(mujoco.mjtBias.mjBIAS_NONE)
            and int(model.actuator_dyntype[actuator]) == int(mujoco.mjtDyn.mjDYN_NONE)
        )
        if direct and model.actuator_ctrllimited[actuator]:
            most = float(np.abs(model.actuator_ctrlrange[actuator]).max())
            limits.append(abs(float(model.actuator_gainprm[actuator, 0])) * most)
        return min(limits)

    def _arms(self, actuator: int) -> list[tuple[int, float]]:
        """Joints that an actuator moves, each with its torque per force of the actuator.

        Empty for actuators that move neither a joint nor a fixed tendon.
        """
        model = self.model
        kind, target = int(model.actuator_trntype[actuator]), int(model.actuator_trnid[actuator, 0])
        gear = float(model.actuator_gear[actuator, 0])
        if kind in (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT)):
            return [(target, gear)]
        if kind == int(mujoco.mjtTrn.mjTRN_TENDON):
            return [(joint, gear * arm) for joint, arm in self.fixed_tendon(target)]
        return []

    def fixed_tendon(self, tendon: int) -> list[tuple[int, float]]:
        """Joints of a fixed tendon with their coefficients; empty for a spatial tendon."""
        model = self.model
        start, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
        part = slice(start, start + count)
        if any(int(k) != int(mujoco.mjtWrap.mjWRAP_JOINT) for k in model.wrap_type[part]):
            return []
        pairs = zip(model.wrap_objid[part], model.wrap_prm[part], strict=True)
        return [(int(joint), float(arm)) for joint, arm in pairs]

    def bent(self, share: float) -> tuple[Array, Array]:
        """Beginnings of the fingers, and fingertips, (n, 3) m each in the palm's frame.

        Args:
            share: Share of its range by which a joint is bent if it bends in one direction only.
                Other joints are in the middle of their ranges.
        """
        model, data = self.model, mujoco.MjData(self.model)
        low, high = self.limits().T
        one_way = np.abs(low + high) > 0.5 * (high - low)
        straight = np.where(np.abs(low) < np.abs(high), low, high)
        angles = np.where(one_way, straight + share * (low + high - 2 * straight), (low + high) / 2)
        data.qpos[model.jnt_qposadr[self.joints]] = angles
        mujoco.mj_kinematics(model, data)
        turn = data.xmat[self.palm].reshape(3, 3).T

        def in_palm(body: int, place: Array) -> Array:
            here = data.xpos[body] + stacked_applied(data.xmat[body].reshape(3, 3), place)
            return stacked_applied(turn, here - data.xpos[self.palm])

        first = {link.finger: link.body for link in reversed(self.links)}
        bases = [in_palm(first[finger], np.zeros(3)) for finger in range(len(self.tips))]
        return np.array(bases), np.array([in_palm(b, np.array(p)) for b, p in self.tips])

    def reach(self, finger: int, most: int) -> float:
        """Total length of a finger's last `most` links (m)."""
        own = [link for link in self.links if link.finger == finger]
        return total(length(np.array(link.end)) for link in own[-most:])

    def fill(self, parent: Element, body: int, prefix: str) -> dict[int, Element]:
        """Adds the contents of a body, and the bodies below it, to an element of MJCF.

        Args:
            parent: Element of the body.
            body: Number of the body.
            prefix: Beginning of all names.

        Returns:
            Number of a body -> its element.
        """
        model, elements = self.model, {body: parent}
        for joint in range(model.njnt):
            if int(model.jnt_bodyid[joint]) == body and joint in self.joints:
                parent.append(self._joint(joint, prefix))
        mass, inertia = float(model.body_mass[body]), model.body_inertia[body]
        if body == 0:
            # The world has no mass.
            mass, inertia = WORLD_PALM_MASS, np.full(3, WORLD_PALM_INERTIA)
        if mass > 0.0:
            SubElement(
                parent,
                "inertial",
                {
                    "pos": mjcf_text(model.body_ipos[body]),
                    "quat": mjcf_text(model.body_iquat[body]),
                    "mass": f"{mass:.9g}",
                    "diaginertia": mjcf_text(inertia),
                },
            )
        for geom in self._seen(body):
            parent.append(self._geom(geom, prefix))
        for child in self.bodies:
            if child != body and int(model.body_parentid[child]) == body:
                element = SubElement(
                    parent,
                    "body",
                    {
                        "name": f"{prefix}{self.scene_body(child)}",
                        "pos": mjcf_text(model.body_pos[child]),
                        "quat": mjcf_text(model.body_quat[child]),
                        "gravcomp": "1",
                    },
                )
                elements |= self.fill(element, child, prefix)
        return elements

    def assets(self, prefix: str) -> list[Element]:
        """MJCF assets of its meshes, which contain the points themselves."""
        model, out = self.model, []
        seen = [g for body in self.bodies for g in self._seen(body)]
        for mesh in sorted({int(model.geom_dataid[g]) for g in seen} - {-1}):
            points = model.mesh_vert[_part(model.mesh_vertadr, model.mesh_vertnum, mesh)]
            faces = model.mesh_face[_part(model.mesh_faceadr, model.mesh_facenum, mesh)]
            out.append(
                Element(
                    "mesh",
                    {
                        "name": f"{prefix}mesh{mesh}",
                        "inertia": "shell",
                        "vertex": " ".join(f"{x:.7g}" for x in points.ravel().tolist()),
                        "face": " ".join(map(str, faces.ravel().tolist())),
                    },
                )
            )
        return out

    @cached_property
    def identity(self) -> bytes:
        """All data on which its motion depends, as bytes."""
        model, joints, bodies = self.model, self.joints, self.bodies
        arrays: list[Any] = [
            model.body_parentid[bodies],
            model.body_pos[bodies],
            model.body_quat[bodies],
            model.body_mass[bodies],
            model.body_ipos[bodies],
            model.body_iquat[bodies],
            model.body_inertia[bodies],
            model.jnt_bodyid[joints],
            model.jnt_type[joints],
            model.jnt_axis[joints],
            model.jnt_pos[joints],
            self.limits(),
            self.force_limits(),
            self._damping("dof_damping"),
            self._damping("dof_armature"),
            self._damping("dof_frictionloss"),
        ]
        zeros = model.qpos0[model.jnt_qposadr[joints]]
        if zeros.any():
            arrays.append(zeros)
        parts = [np.ascontiguousarray(a).tobytes() for a in arrays]
        return b"|".join([*parts, repr(self.tips).encode()])

    def _damping(self, what: str) -> Array:
        values = {
            "dof_damping": self.model.dof_damping,
            "dof_armature": self.model.dof_armature,
            "dof_frictionloss": self.model.dof_frictionloss,
        }[what]
        return np.asarray(values)[self.model.jnt_dofadr[self.joints]]

    def scene_body(self, body: int) -> str:
        """Name of a body in a scene, without the prefix of the hand."""
        return _own(self.model.body(body).name) or f"body{body}"

    def _below(self, body: int) -> bool:
        while body > 0 and body != self.palm:
            body = int(self.model.body_parentid[body])
        return body == self.palm

    def _named(self, kind: Any, name: str, what: str) -> int:
        number = int(mujoco.mj_name2id(self.model, kind, name))
        if number < 0:
            names = [self.model.body(b).name for b in range(1, self.model.nbody)]
            raise InputError(
                f"this robot has no body of this name for its {what}",
                where=self._where,
                got=name,
                expected="one of " + ", ".join(filter(None, names))[:400],
            )
        return number

    def _tip(
        self, name: str, inside: tuple[float, float, float]
    ) -> tuple[int, tuple[float, float, float]]:
        """Body of a fingertip, and its place in the body's frame.

        Args:
            name: Name of a site or body.
            inside: Position (m) of the fingertip in the frame of that body; ignored for a site.
        """
        model = self.model
        site = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name))
        if site >= 0:
            body, place = int(model.site_bodyid[site]), model.site_pos[site]
        else:
            body = int(mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name))
            place = np.array(inside)
        if body < 0:
            sites = [model.site(s).name for s in range(model.nsite)]
            raise InputError(
                "this robot has no site or body of this name for a fingertip",
                where=self._where,
                got=name,
                expected="one of " + (", ".join(filter(None, sites))[:400] or "its bodies"),
            )
        if body == self.palm or not self._below(body):
            raise InputError("this fingertip is not below the palm", where=self._where, got=name)
        return body, (float(place[0]), float(place[1]), float(place[2]))

    def _links(self, finger: int) -> list[RobotLink]:
        """Links of a finger that have a length, from the palm outwards: at least two."""
        model, (body, end) = self.model, self.tips[finger]
        links: list[RobotLink] = []
        while body != self.palm:
            if length(np.array(end)) > LEAST_LINK and model.body_jntnum[body] > 0:
                links.insert(0, RobotLink(finger, body, end))
                end = _tuple(model.body_pos[body])
            else:
                turn = np.empty(9)
                mujoco.mju_quat2Mat(turn, model.body_quat[body])
                end = _tuple(
                    model.body_pos[body] + stacked_applied(turn.reshape(3, 3), np.array(end))
                )
            body = int(model.body_parentid[body])
        if len(links) < 2:
            raise InputError(
                f"the {FINGERS[finger]} of a robot's hand must have two links or more",
                where=self._where,
                got=f"{len(links)} links longer than {1000 * LEAST_LINK:g} mm",
            )
        return links

    def _seen(self, body: int) -> list[int]:
        """Geoms that show a body: those of the visible groups, or all geoms if no geom is in a
        visible group."""
        model = self.model
        own = [g for g in range(model.ngeom) if int(model.geom_bodyid[g]) == body]
        own = [g for g in own if int(model.geom_type[g]) in _TYPES]
        own = [g for g in own if model.geom_group[g] < _SEEN_GROUPS] or own
        return list({self._shape(g): g for g in reversed(own)}.values())[::-1]

    def _shape(self, geom: int) -> tuple[object, ...]:
        """Key of a geom's shape and place. Some models contain each shape twice: once to be
        visible, and once to collide."""
        model, mesh = self.model, int(self.model.geom_dataid[geom])
        arrays = [model.geom_pos[geom], model.geom_quat[geom], model.geom_size[geom]]
        if int(model.geom_type[geom]) == int(_GEOM.mjGEOM_MESH):
            arrays.append(model.mesh_vert[_part(model.mesh_vertadr, model.mesh_vertnum, mesh)])
        return int(model.geom_type[geom]), *(array.tobytes() for array in arrays)

    def _joint(self, joint: int, prefix: str) -> Element:
        model, dof = self.model, int(self.model.jnt_dofadr[joint])
        slides = int(model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_SLIDE)
        low, high = self.limits()[self.joints.index(joint)]
        spread = (low, high) if slides else np.rad2deg([low, high])
        element = Element(
            "joint",
            {
                "name": prefix + self.scene_names()[self.joints.index(joint)],
                "type": "slide" if slides else "hinge",
                "pos": mjcf_text(model.jnt_pos[joint]),
                "axis": mjcf_text(model.jnt_axis[joint]),
                "limited": "true",
                "range": mjcf_text(spread),
                "damping": f"{model.dof_damping[dof]:.9g}",
                "armature": f"{max(float(model.dof_armature[dof]), LEAST_ARMATURE):.9g}",
                "frictionloss": f"{model.dof_frictionloss[dof]:.9g}",
            },
        )
        zero = float(model.qpos0[int(model.jnt_qposadr[joint])])
        if zero:
            element.set("ref", mjcf_text([zero if slides else np.rad2deg(zero)]))
        return element

    def _geom(self, geom: int, prefix: str) -> Element:
        model = self.model
        kind, sizes = _TYPES[int(model.geom_type[geom])]
        element = Element(
            "geom",
            {
                "type": kind,
                "rgba": mjcf_text(drawn_colour(model, geom)),
                "pos": mjcf_text(model.geom_pos[geom]),
                "quat": mjcf_text(model.geom_quat[geom]),
                "contype": "0",
                "conaffinity": "0",
                "mass": "0",
                "group": "1",
            },
        )
        if sizes:
            element.set("size", mjcf_text(model.geom_size[geom, :sizes]))
        else:
            element.set("mesh", f"{prefix}mesh{int(model.geom_dataid[geom])}")
        return element


LEAST_ARMATURE = 2e-4
"""Least armature (kg m2) of a joint. With less, a servo on links of a few grams is unstable."""


def of_mapping(mapping: RobotMapping) -> RobotModel:
    """The robot's hand of a mapping."""
    path = mapping.path
    changed = path.stat().st_mtime_ns
    return _of_file(path, changed, mapping.palm, mapping.tips, mapping.places)


@lru_cache(maxsize=8)
def _of_file(
    path: Path,
    changed: int,
    palm: str,
    tips: tuple[str, ...],
    places: tuple[tuple[float, float, float], ...],
) -> RobotModel:
    return RobotModel(path, palm, tips, places)


def compiled(path: Path) -> tuple[Any, tuple[tuple[str, str], ...]]:
    """MuJoCo's model of a file, and its repaired or omitted parts and warnings: kinds and names.

    A URDF that MuJoCo refuses is read again with repairs. If MuJoCo cannot read the file of a
    shape, the shape is left out, provided that the inertia of its link is given. Physically
    impossible inertias are corrected. MJCF is not repaired, since its author can set such options
    in the file.

    Raises:
        InputError: The file is of another kind, or MuJoCo cannot compile it.
    """
    if path.suffix.lower() not in MODEL_SUFFIXES:
        # MuJoCo would print a warning of its own in addition to its error.
        raise InputError(
            "this is not a model of a robot",
            where=str(path),
            expected="an MJCF file (.xml) or a URDF (.urdf)",
        )
    try:
        with _warnings() as warnings:
            try:
                model, mended = _spec(path).compile(), []
            except ValueError:
                if path.suffix.lower() != URDF:
                    raise
                spec = _spec(path)
                mended = [*_without_unreadable_shapes(spec), *_with_possible_inertias(spec)]
                model = spec.compile()
    except (ValueError, OSError) as error:
        raise InputError(
            "MuJoCo cannot read this robot",
            where=str(path),
            got=" ".join(str(error).split())[:300],
            remedy="Open it in MuJoCo's viewer (python -m mujoco.viewer) to see the whole error",
        ) from None
    mended += [("warnings of MuJoCo", " ".join(text.split())) for text in dict.fromkeys(warnings)]
    return model, tuple(mended)


@contextmanager
def _warnings() -> Iterator[list[str]]:
    """Collects the warnings that MuJoCo would print; yields the list of them."""
    found: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(found.append)
    try:
        yield found
    finally:
        mujoco.set_mju_user_warning(before)


def _spec(path: Path) -> Any:
    spec = mujoco.MjSpec.from_file(str(path))
    if path.suffix.lower() == URDF:
        # By default, MuJoCo merges the fixed links of a URDF, such as palms and fingertips, with
        # their parents.
        spec.compiler.fusestatic = False
    return spec


def _without_unreadable_shapes(spec: Any) -> list[tuple[str, str]]:
    """Leaves out meshes of a URDF whose files MuJoCo cannot read.

    Returns:
        Pairs of the kind of repair and the name of a link.
    """
    folder = Path(spec.modelfiledir) / spec.meshdir
    unreadable = {
        mesh.name
        for mesh in spec.meshes
        if Path(mesh.file).suffix.lower() not in MESHES or not (folder / mesh.file).is_file()
    }
    geoms = [g for g in spec.geoms if g.meshname in unreadable and g.parent.explicitinertial]
    links = [g.parent.name for g in geoms]
    left = {g.meshname for g in geoms}
    for geom in geoms:
        spec.delete(geom)
    for mesh in [m for m in spec.meshes if m.name in left]:
        spec.delete(mesh)
    return [("shapes in files that MuJoCo cannot read", name) for name in dict.fromkeys(links)]


def _with_possible_inertias(spec: Any) -> list[tuple[str, str]]:
    """Lets MuJoCo correct inertias that break A + B >= C.

    Returns:
        Pairs of the kind of repair and the name of a link.
    """
    spec.compiler.balanceinertia = True
    found = []
    for body in spec.bodies:
        xx, yy, zz, xy, xz, yz = body.fullinertia
        if body.explicitinertial and np.isfinite(xx):
            tensor = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
            small, middle, large = np.linalg.eigvalsh(tensor)  # any order: only compared
            if small + middle < large:
                found.append((_BALANCED, body.name))
    return found


def link_turn(end: tuple[float, float, float]) -> Array:
    """Quaternion (4,) of a frame whose y axis points along a link, in the frame of its body."""
    y = np.array(end) / length(np.array(end))
    other = np.array([1.0, 0.0, 0.0]) if abs(y[0]) < 0.9 else np.array([0.0, 0.0, 1.0])
    z = np.cross(other, y)
    z /= length(z)
    return matrix_to_quaternion(np.stack([np.cross(y, z), y, z], axis=1))


def _own(name: str) -> str:
    """Name, in a scene, of a part of a robot. It differs from the part's own name if the scene
    already uses that name."""
    return f"own_{name}" if _OURS.fullmatch(name) else name


def _tuple(v: Array) -> tuple[float, float, float]:
    return float(v[0]), float(v[1]), float(v[2])


def _part(starts: Any, counts: Any, i: int) -> slice:
    return slice(int(starts[i]), int(starts[i]) + int(counts[i]))
