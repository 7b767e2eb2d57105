"""A robot's hand in a scene, in place of the built-in hand."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import cached_property
from typing import Any
from xml.etree.ElementTree import Element, SubElement, tostring

import mujoco
import numpy as np

from models.arithmetic import Array, length
from models.errors import InputError
from models.frames import FINGERS
from models.hand import (
    CONTACT_HAND,
    IMPULSE_PERIOD,
    IMPULSE_PROFILES,
    ROOT_INERTIA,
    ROOT_MASS,
    ROOT_STIFFNESS,
    ROOT_TURN_STIFFNESS,
    Link,
)
from models.objects import mjcf_text
from models.robot.mapping import RobotMapping, coefficients, digest
from models.robot.retargeting import PALM_MOVES, PALM_TURNS, ROOT_PLACE, Retargeter
from models.robot.robot_model import RobotModel, link_turn, of_mapping
from models.rotations import quaternion_log
from models.single_pose import SinglePose
from models.skeleton import ADULT, Skeleton

STIFFNESS = 4.0
"""Stiffness (N m/rad) of the servo of a finger's joint, at servo stiffness 1. The fingers of the
built-in hand have 1.5 to 8."""
CLASS = "robot"
"""MJCF default class of robots' hands."""


@dataclass(frozen=True, eq=False)
class RobotHand:
    """A robot's hand that follows a person's; implements `models.hand.SceneHand`.

    Its palm moves freely, carried by servos like those of the built-in hand, which represent the
    arm. The servos of the fingers are limited to the robot's own torques if its model contains
    them. Collisions use a capsule for every link, from joint to joint, and from the last joint to
    the fingertip. The robot's own shapes are only visible.

    Attributes:
        name: Prefix of its elements' names.
        mapping: The robot, and its mapping to a person's hand.
        person: The person's hand, whose poses the robot's hand follows.
        size: Length of the person's hand relative to the trained hand.
        impulse: Impulse limit of every servo, in N s or N m s per 1/60 s.
        stiffness: Factor on the stiffness of all servos.
        solid_end: Length (m) of the colliding part of a last link if only fingertips are solid,
            measured from the fingertip; None makes the whole link collide.
        skeleton: None, so that views show the robot's own shapes.
    """

    name: str
    mapping: RobotMapping
    person: Skeleton = ADULT
    size: float = 1.0
    impulse: float = IMPULSE_PROFILES["paper"]
    stiffness: float = 2.0
    solid_end: float | None = None
    skeleton: Skeleton | None = None

    @cached_property
    def robot(self) -> RobotModel:
        """The robot's own model."""
        return of_mapping(self.mapping)

    @property
    def digest(self) -> str:
        """Digest of all data on which its motion depends."""
        return hand_digest(self.mapping, self.robot)

    @property
    def palm(self) -> str:
        """Name of the palm's body."""
        return f"{self.name}_palm"

    @property
    def first_joint(self) -> str:
        """Name of the first of the slides that carry the palm."""
        return f"{self.name}_root_x"

    @cached_property
    def links(self) -> tuple[Link, ...]:
        """Links of its fingers. Each has its own body, with y along the link."""
        out: list[Link] = []
        for finger, label in enumerate(FINGERS[: len(self.mapping.tips)]):
            own = [link for link in self.robot.links if link.finger == finger]
            for i, link in enumerate(own):
                name = f"{self.name}_{label}_link{i}"
                reach = length(np.array(link.end))
                last = i == len(own) - 1
                radius = self.mapping.radii[finger]
                if not last or self.solid_end is None:
                    out.append(Link(finger, name, reach, radius, name, name))
                    continue
                start = max(0.0, 1.0 - self.solid_end / reach)
                out.append(Link(finger, name, reach, radius, name, f"{name}_end", start))
        return tuple(out)

    def defaults(self) -> Element:
        """The default class of robots' hands: contacts like those of the built-in hand."""
        default = Element("default", {"class": CLASS})
        SubElement(
            default,
            "geom",
            {
                "condim": "4",
                "friction": "1 .01 .0001",
                "solref": ".004 1",
                "solimp": ".95 .99 .001",
            },
        )
        return default

    def body(self) -> Element:
        """The palm's body with all fingers."""
        palm = Element("body", {"name": self.palm, "childclass": CLASS, "gravcomp": "1"})
        for axis, direction in zip("xyz", np.eye(3), strict=True):
            SubElement(
                palm,
                "joint",
                {
                    "name": f"{self.name}_root_{axis}",
                    "type": "slide",
                    "axis": mjcf_text(direction),
                    "armature": mjcf_text([ROOT_MASS]),
                    "damping": "0",
                },
            )
        SubElement(
            palm,
            "joint",
            {"name": f"{self.name}_root", "type": "ball", "armature": mjcf_text([ROOT_INERTIA])},
        )
        elements = self.robot.fill(palm, self.robot.palm, self._prefix)
        for link, own in zip(self.links, self.robot.links, strict=True):
            self._add_link(elements[own.body], link, own.end)
        return palm

    def assets(self) -> list[Element]:
        """MJCF assets of its meshes."""
        return self.robot.assets(self._prefix)

    def actuators(self) -> list[Element]:
        """Servos of the palm's place (3) and rotation vector (3), and of every joint."""
        limit = self.impulse / IMPULSE_PERIOD
        servos = [
            Element(
                "position",
                {
                    "name": f"{self.name}_root_{axis}",
                    "joint": f"{self.name}_root_{axis}",
                    "kp": mjcf_text([ROOT_STIFFNESS * self.stiffness]),
                    "dampratio": "1",
                    "forcerange": mjcf_text([-limit, limit]),
                },
            )
            for axis in "xyz"
        ]
        servos.append(
            Element(
                "orientation",
                {
                    "name": f"{self.name}_root",
                    "joint": f"{self.name}_root",
                    "kp": mjcf_text([ROOT_TURN_STIFFNESS * self.stiffness]),
                    "dampratio": "1",
                    "forcerange": mjcf_text([0.0, limit]),
                },
            )
        )
        for joint, force in zip(self.joint_names, self._forces(limit), strict=True):
            servos.append(
                Element(
                    "position",
                    {
                        "name": joint,
                        "joint": joint,
                        "kp": mjcf_text([STIFFNESS * self.stiffness]),
                        "dampratio": "1",
                        "forcerange": mjcf_text([-force, force]),
                    },
                )
            )
        return servos

    def controls(self, q: Array) -> Array:
        """Controls (6 + n,) for a pose (48,): the palm's place and rotation vector, and joints."""
        return _controls(self.joint_positions(q))

    def follower(self) -> RobotFollower:
        """Follower of one movement, which starts from its last pose."""
        return RobotFollower(self.retargeter())

    def coordinates(self, qpos: Array) -> Array:
        """Joint positions (..., 7 + n), converted to numbers (..., 6 + n) as in the controls."""
        return _controls(qpos)

    def joint_positions(self, q: Array) -> Array:
        """Joint positions (7 + n,) at a pose (48,), which do not depend on earlier poses."""
        self._still.reset()
        return self._still.follow(q)

    def tips_of(self) -> Callable[[Array], Array]:
        """Function from a pose (48,) to the fingertips (5, 3) m of the person's hand, which are the
        targets of the robot's fingertips."""
        return SinglePose(self.person).tips

    def retargeter(self, palm: tuple[float, float] = (PALM_MOVES, PALM_TURNS)) -> Retargeter:
        """A new retargeter of this hand.

        Args:
            palm: Variances (m2, rad2) of the palm's movement from its place.
        """
        names = self.robot.joint_names()
        master = np.arange(len(names), dtype=np.int64)
        laws = [coefficients(1.0)] * len(names)
        for joint, (other, law) in self.mapping.coupled.items():
            for name in (joint, other):
                if name not in names:
                    raise InputError(
                        "this robot has no such joint",
                        where=self.mapping.file,
                        got=name,
                        expected=", ".join(names),
                    )
            master[names.index(joint)] = names.index(other)
            laws[names.index(joint)] = coefficients(law)
        return Retargeter(
            self.kinematic,
            self.person,
            np.array(self.mapping.scales) / self.size,
            self.size * np.array(self.mapping.offset),
            np.array(self.mapping.turn),
            (master, laws),
            palm,
        )

    @property
    def _prefix(self) -> str:
        return f"{self.name}_"

    @cached_property
    def _still(self) -> Retargeter:
        return self.retargeter()

    @cached_property
    def joint_names(self) -> list[str]:
        """Names in the scene of the joints below the palm."""
        return [self._prefix + name for name in self.robot.scene_names()]

    def body_name(self, body: int) -> str:
        """Name in the scene of a body below the palm, by its number in the robot's model."""
        return self._prefix + self.robot.scene_body(body)

    @cached_property
    def kinematic(self) -> Any:
        """MuJoCo's model of this hand alone, with sites at the fingertips."""
        palm = self.body()
        for body in list(palm.iter("body")):
            for geom in body.findall("geom"):
                body.remove(geom)
        bodies = {body.get("name"): body for body in palm.iter("body")}
        for link in {link.finger: link for link in self.links}.values():
            place = {"name": FINGERS[link.finger], "pos": mjcf_text([0.0, link.length, 0.0])}
            SubElement(bodies[link.body], "site", place)
        root = Element("mujoco")
        SubElement(root, "compiler", {"angle": "degree", "autolimits": "true"})
        SubElement(root, "default").append(self.defaults())
        SubElement(root, "worldbody").append(palm)
        return mujoco.MjModel.from_xml_string(tostring(root, encoding="unicode"))

    def _forces(self, limit: float) -> list[float]:
        """Torque limits (N m) of the joints' servos: those of the robot, but at most `limit`."""
        names, own = self.robot.joint_names(), self.robot.force_limits()
        for joint, (other, _) in self.mapping.coupled.items():
            # A tendon pulls both joints.
            own[names.index(joint)] = min(own[names.index(joint)], own[names.index(other)])
        return [min(float(force), limit) for force in own]

    def _add_link(self, body: Element, link: Link, end: tuple[float, float, float]) -> None:
        frame = SubElement(
            body,
            "body",
            {"name": link.body, "quat": mjcf_text(link_turn(end)), "gravcomp": "1"},
        )
        capsule = {
            "type": "capsule",
            "size": mjcf_text([link.radius]),
            "contype": str(CONTACT_HAND),
            "conaffinity": "0",
            "mass": "0",
            "group": "3",
            "rgba": ".85 .86 .88 1",
        }
        along = mjcf_text([0, 0, 0, 0, link.length, 0])
        SubElement(frame, "geom", {"name": link.geom, "fromto": along, **capsule})
        if link.tip_geom != link.geom:
            start = min(link.solid_from, 1.0 - 1e-4 / link.length) * link.length
            along = mjcf_text([0, start, 0, 0, link.length, 0])
            SubElement(frame, "geom", {"name": link.tip_geom, "fromto": along, **capsule})


class RobotFollower:
    """Controls of a robot's hand, pose after pose; a `models.hand.Follower`."""

    def __init__(self, retargeter: Retargeter) -> None:
        self._retargeter = retargeter

    def __call__(self, q: Array, fingers: Collection[int]) -> Array:
        """Controls (6 + n,) for a pose (48,), and the fingers that touch."""
        return _controls(self._retargeter.follow(q, fingers))

    @property
    def missed(self) -> frozenset[int]:
        """Labels of the touching fingers that the robot could not bring to their places."""
        return self._retargeter.missed


def hand_digest(mapping: RobotMapping, robot: RobotModel) -> str:
    """Digest of the data on which a robot's motion depends: its model and its mapping."""
    numbers = (
        mapping.side,
        mapping.radii,
        mapping.scales,
        mapping.offset,
        mapping.turn,
        sorted(mapping.coupled.items()),
        robot.joint_names(),
    )
    return digest(robot.identity, repr(numbers).encode())


def _controls(qpos: Array) -> Array:
    turn = quaternion_log(qpos[..., 3:ROOT_PLACE])
    return np.concatenate([qpos[..., :3], turn, qpos[..., ROOT_PLACE:]], axis=-1)
