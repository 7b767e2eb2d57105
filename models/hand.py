"""Contract of the hands of a scene, and the built-in hand: a palm, 14 ball joints, 48 servos.

`Hand` is the built-in hand with 48 degrees of freedom, driven by the pose itself. Its joints and
actuators are in the order of the pose `q`, so that a pose is also the control vector. The forces of
the servos are limited like those of the motors of the paper's Bullet hand. The paper limits the
impulse of a motor to J per step of 1/60 s. Here this is a force limit of J / (1/60 s) for any time
step.

Other hands, such as robot hands, have their own MJCF, convert a pose to their own controls, and
assign their links to fingers. Scene, session, collision gating, sensing and views use only the
contract, `SceneHand`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Protocol
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arithmetic import Array, length
from models.errors import SceneError
from models.rotations import matrix_to_quaternion, quaternion_exp, quaternion_log
from models.single_pose import SinglePose
from models.skeleton import ADULT, Bone, Skeleton


@dataclass(frozen=True)
class Link:
    """One link of a finger: a capsule along the y axis of its body, beginning at its joint.

    Attributes:
        finger: Label of its finger, thumb 0 to little 4.
        body: Name of its body in the model.
        length: Distance (m) from its joint to the next one, or to the centre of the fingertip.
        radius: Radius of the capsule (m).
        geom: Name of the geom that collides if the whole link is solid.
        tip_geom: Name of the geom that collides if only fingertips are solid; `geom` for a link
            that is solid as a whole or not at all.
        solid_from: Share of the length, from its joint, at which `tip_geom` begins.
    """

    finger: int
    body: str
    length: float
    radius: float
    geom: str
    tip_geom: str
    solid_from: float = 0.0


class Follower(Protocol):
    """Converts the poses of one movement to controls. It may use the last result as a start."""

    @property
    def missed(self) -> frozenset[int]:
        """Labels of those touching fingers whose tips could not reach their places in the last
        pose."""
        ...

    def __call__(self, q: Array, fingers: Collection[int]) -> Array:
        """Controls (m,) for a pose (48,).

        Args:
            q: The pose.
            fingers: Labels of the fingers that touch. If not all fingertips can reach their places
                in the pose, those of the touching fingers take precedence.
        """
        ...


class SceneHand(Protocol):
    """A hand of a scene."""

    @property
    def name(self) -> str:
        """Prefix of the names of its elements in the model: every name begins with the prefix and
        `_`."""
        ...

    @property
    def palm(self) -> str:
        """Name of the palm's body, a child of the world with all links below it."""
        ...

    @property
    def first_joint(self) -> str:
        """Name of its first joint."""
        ...

    @property
    def links(self) -> tuple[Link, ...]:
        """Links of its fingers, finger by finger, from the palm outwards; at least two per finger.

        A finger that the hand lacks has no links, and never becomes solid.
        """
        ...

    @property
    def skeleton(self) -> Skeleton | None:
        """Skeleton to which the shipped skin is fitted; None shows the hand's own geoms."""
        ...

    def defaults(self) -> Element:
        """MJCF default class of its elements; hands with a class of the same name share it."""
        ...

    def body(self) -> Element:
        """MJCF body of the palm with all links.

        The geoms of `links` are compiled with the collision bit `CONTACT_HAND` of `models.hand`:
        MuJoCo decides at compile time which bodies may collide at all.
        """
        ...

    def assets(self) -> list[Element]:
        """MJCF assets, such as meshes; every name begins with the hand's name and `_`."""
        ...

    def actuators(self) -> list[Element]:
        """MJCF actuators in the order of its controls."""
        ...

    def controls(self, q: Array) -> Array:
        """Controls (m,) that make the hand follow a pose q (48,) in the world; m is constant."""
        ...

    def follower(self) -> Follower | None:
        """Converter from the poses of one movement to controls; None for a hand that can take every
        pose and whose `controls` depend on the pose alone."""
        ...

    def coordinates(self, qpos: Array) -> Array:
        """Joint positions (..., n) of MuJoCo, converted to numbers without quaternions: the palm's
        place (m) and rotation vector (rad), then a rotation vector or an angle for every joint."""
        ...

    def joint_positions(self, q: Array) -> Array:
        """Joint positions (n,) of the hand at a pose q (48,), as in MuJoCo's qpos."""
        ...

    def tips_of(self) -> Callable[[Array], Array]:
        """Function from a pose (48,) to the intended positions (5, 3) m of the fingertips; the
        positions of missing fingers have no meaning.

        The function may use buffers of its own, so it serves one thread at a time.
        """
        ...


IMPULSE_PERIOD = 1.0 / 60.0
"""Time step (s) of the paper's physics engine, to which its impulse limit refers."""

IMPULSE_PROFILES: dict[str, float] = {"paper": 100.0, "safe": 0.5}
"""Impulse limits (N s, or N m s for rotations). `paper` is 6000 N, which is never reached; `safe`
is 30 N."""

CALM_ARMATURE = 3.0
"""Factor on the armature of the finger joints of a hand no stronger than `safe`. A lighter
fingertip that pushes with 100 N, and bounces off for a single physics step, returns at 1.6 m/s and
penetrates the object by 4 mm. A heavier fingertip does not (measured at db485e42)."""

SERVOS = ("orientation", "position")
"""`orientation`: one servo on the rotation of each ball joint, with a limit on the norm of its
torque, as in Bullet. `position`: three servos on the components of its rotation vector, each
limited."""

ROOT_MASS, ROOT_INERTIA = 1.0, 0.006
"""Mass (kg) and inertia (kg m2) of a forearm, added to the root's joints. Without them the hand
jitters."""
ROOT_STIFFNESS, ROOT_TURN_STIFFNESS = 8000.0, 40.0
"""Stiffness (N/m and N m/rad) of the root's servos, at servo stiffness 1."""

CONTACT_HAND, CONTACT_OBJECT, CONTACT_TABLE, CONTACT_HANDS = 1, 2, 4, 8
"""Collision bits. A hand collides with objects, and with the other hand if whole hands are solid.
It collides neither with itself nor with the table: at an upright surface, the wrist may have to be
below the table."""

FLESH_DENSITY = 1100.0
"""Density (kg/m3) of flesh."""

CUFF, SLEEVE = ".93 .94 .95 1", ".16 .20 .27 1"
"""Colours (red, green, blue, alpha) of the cuff and sleeve at the wrist."""


@dataclass(frozen=True)
class Hand:
    """The built-in hand; implements `models.hand.SceneHand`.

    Attributes:
        name: Prefix of its bodies, joints and actuators.
        skeleton: Skeleton of either side and any size.
        servo: One of `SERVOS`.
        impulse: Impulse limit of every servo, in N s or N m s per 1/60 s.
        stiffness: Factor on the servo stiffnesses of the skeleton and the root.
        finger_armature: Factor on the armature of the finger joints; see `finger_armature()`.
        solid_end: Length (m) of the colliding part of a last link if only fingertips are solid,
            measured from the middle of the fingertip; None makes the whole link collide.
        solid_palm: True if the palm can collide; otherwise objects pass through it.
    """

    name: str = "right"
    skeleton: Skeleton = field(default_factory=lambda: ADULT)
    servo: str = "orientation"
    impulse: float = IMPULSE_PROFILES["paper"]
    stiffness: float = 2.0
    finger_armature: float = 1.0
    solid_end: float | None = None
    solid_palm: bool = False

    def __post_init__(self) -> None:
        if self.servo not in SERVOS:
            raise SceneError(
                "no such servo", where="--servo", got=self.servo, expected=", ".join(SERVOS)
            )
        if not (np.isfinite(self.impulse) and self.impulse > 0):
            raise SceneError(
                "the impulse limit is out of range",
                where="--impulse",
                got=self.impulse,
                expected="a finite number above 0, in N s",
            )

    @property
    def force_limit(self) -> float:
        """Force limit of a servo, in N (slides) or N m (rotations): the impulse limit divided by
        1/60 s."""
        return self.impulse / IMPULSE_PERIOD

    def element_name(self, part: str) -> str:
        """Name in the MuJoCo model of a part of this hand: `palm` or a bone's name."""
        return f"{self.name}_{part}"

    @property
    def palm(self) -> str:
        """Name of the palm's body."""
        return self.element_name("palm")

    @property
    def first_joint(self) -> str:
        """Name of the first of the three slides that carry the palm."""
        return self.element_name("root_x")

    @cached_property
    def links(self) -> tuple[Link, ...]:
        """All bones except the palm, as links."""
        last = self.skeleton.last_bones
        return tuple(self._link(bone, bone is last[bone.finger]) for bone in self.skeleton.bones)

    def _link(self, bone: Bone, last: bool) -> Link:
        name = self.element_name(bone.name)
        if not last or self.solid_end is None:
            return Link(bone.finger, name, bone.length, bone.radius, name, name)
        start = max(0.0, 1.0 - self.solid_end / bone.length)
        return Link(bone.finger, name, bone.length, bone.radius, name, f"{name}_end", start)

    def defaults(self) -> Element:
        """The default class that all hands of this kind share."""
        return hand_default()

    def body(self) -> Element:
        """The palm's body with all fingers attached."""
        return hand_body(self)

    def actuators(self) -> list[Element]:
        """48 servos in the order of the pose."""
        return hand_actuators(self)

    def controls(self, q: Array) -> Array:
        """Controls (48,) for a pose (48,): the pose itself, one target per servo."""
        return q

    def assets(self) -> list[Element]:
        """No assets."""
        return []

    def follower(self) -> None:
        """None: the hand can take every pose."""

    def coordinates(self, qpos: Array) -> Array:
        """Poses (..., 48) of joint positions (..., 63)."""
        turns = quaternion_log(qpos[..., 3:].reshape(*qpos.shape[:-1], 15, 4))
        return np.concatenate([qpos[..., :3], turns.reshape(*qpos.shape[:-1], 45)], axis=-1)

    def joint_positions(self, q: Array) -> Array:
        """Joint positions (63,) at a pose (48,): three slides and 15 quaternions."""
        return np.concatenate([q[:3], quaternion_exp(q[3:].reshape(15, 3)).ravel()])

    def tips_of(self) -> Callable[[Array], Array]:
        """Forward kinematics: a function from a pose (48,) to the fingertips (5, 3) m."""
        return SinglePose(self.skeleton).tips


def is_gentle(impulse: float) -> bool:
    """True for a hand no stronger than `safe`, which also gets lower speeds and more armature."""
    return impulse <= IMPULSE_PROFILES["safe"]


def finger_armature(impulse: float) -> float:
    """Armature factor for an impulse limit, to be used as `Hand.finger_armature`."""
    return CALM_ARMATURE if is_gentle(impulse) else 1.0


def hand_default() -> Element:
    """The default class that every hand of a scene shares."""
    default = Element("default", {"class": "hand"})
    # condim 4 adds torsional friction. Without it, a pinched object spins between two fingertips.
    SubElement(
        default,
        "geom",
        {
            "type": "capsule",
            "contype": "0",
            "conaffinity": "0",
            "condim": "4",
            "friction": "1 .01 .0001",
            "density": _text(FLESH_DENSITY),
            "solref": ".004 1",
            "solimp": ".95 .99 .001",
            "rgba": ".905 .735 .64 1",
        },
    )
    SubElement(default, "joint", {"damping": ".002"})
    return default


def hand_body(hand: Hand) -> Element:
    """The palm's body with all fingers attached.

    The bones' geoms are compiled as solid, since MuJoCo decides at compile time which bodies may
    collide at all. A session switches their collisions off and on afterwards.
    """
    palm = Element(
        "body",
        {
            "name": hand.element_name("palm"),
            "childclass": "hand",
            "gravcomp": "1",
        },
    )
    for axis, direction in zip("xyz", np.eye(3), strict=True):
        SubElement(
            palm,
            "joint",
            {
                "name": hand.element_name(f"root_{axis}"),
                "type": "slide",
                "axis": _text(*direction),
                "armature": _text(ROOT_MASS),
                "damping": "0",
            },
        )
    SubElement(
        palm,
        "joint",
        {
            "name": hand.element_name("root"),
            "type": "ball",
            "armature": _text(ROOT_INERTIA),
        },
    )
    _palm_geoms(palm, hand)
    parents: dict[int, Element] = {}
    for bone in hand.skeleton.bones:
        body = SubElement(
            parents.get(bone.finger, palm),
            "body",
            {
                "name": hand.element_name(bone.name),
                "pos": _text(*bone.anchor),
                "quat": _text(*matrix_to_quaternion(bone.rest)),
                "gravcomp": "1",
            },
        )
        # The joint's own limit bounds only the total angle, a little outside the legal ranges. A
        # finger stays within the legal ranges because its target is legal and its servo stiff.
        reach = length(np.maximum(-bone.lower, bone.upper)) + np.deg2rad(10.0)
        SubElement(
            body,
            "joint",
            {
                "name": hand.element_name(bone.name),
                "type": "ball",
                "armature": _text(bone.armature * hand.finger_armature),
                "limited": "true",
                "range": _text(0.0, _deg(reach)),
                "solreflimit": ".01 1",
            },
        )
        SubElement(
            body,
            "geom",
            {
                "name": hand.element_name(bone.name),
                "fromto": _text(0, 0, 0, 0, bone.length, 0),
                "size": _text(bone.radius),
                "contype": str(CONTACT_HAND),
            },
        )
        if hand.solid_end is not None and bone is hand.skeleton.last_bones[bone.finger]:
            # The geom of the fingertip has no mass and is invisible; it only collides.
            start = bone.length - min(max(hand.solid_end, 1e-4), bone.length)
            fromto = _text(0, start, 0, 0, bone.length, 0)
            SubElement(
                body,
                "geom",
                {
                    "name": f"{hand.element_name(bone.name)}_end",
                    "fromto": fromto,
                    "size": _text(bone.radius),
                    "contype": str(CONTACT_HAND),
                    "mass": "0",
                    "group": "3",
                },
            )
        parents[bone.finger] = body
    return palm


def hand_actuators(hand: Hand) -> list[Element]:
    """Servos for 48 controls, in the order of the pose: root position, root rotation vector, ball
    joints."""
    servos = [
        Element(
            "position",
            {
                "name": hand.element_name(f"root_{axis}"),
                "joint": hand.element_name(f"root_{axis}"),
                "kp": _text(ROOT_STIFFNESS * hand.stiffness),
                "dampratio": "1",
                "forcerange": _text(-hand.force_limit, hand.force_limit),
            },
        )
        for axis in "xyz"
    ]
    # The root needs an orientation servo: three position servos fail beyond about 120 degrees.
    servos.append(_orientation(hand, "root", ROOT_TURN_STIFFNESS))
    for bone in hand.skeleton.bones:
        if hand.servo == "orientation":
            servos.append(_orientation(hand, bone.name, bone.stiffness))
            continue
        for axis, direction in zip("xyz", np.eye(3), strict=True):
            servos.append(
                Element(
                    "position",
                    {
                        "name": hand.element_name(f"{bone.name}_{axis}"),
                        "joint": hand.element_name(bone.name),
                        "gear": _text(*direction, 0, 0, 0),
                        "kp": _text(bone.stiffness * hand.stiffness),
                        "dampratio": "1",
                        "forcerange": _text(-hand.force_limit, hand.force_limit),
                    },
                )
            )
    return servos


def _orientation(hand: Hand, joint: str, stiffness: float) -> Element:
    return Element(
        "orientation",
        {
            "name": hand.element_name(joint),
            "joint": hand.element_name(joint),
            "kp": _text(stiffness * hand.stiffness),
            "dampratio": "1",
            "forcerange": _text(0.0, hand.force_limit),
        },
    )


def _palm_geoms(palm: Element, hand: Hand) -> None:
    """Metacarpals from the wrist to each knuckle, the thumb's ball, and a stub of forearm.

    The capsules with mass are the palm of the simulation and are hidden (group 3). The visible
    geoms have no mass, so that the look can change without changing the physics.
    """
    skeleton, radius = hand.skeleton, hand.skeleton.palm_radius
    knuckles = [np.array(skeleton.bones[i].anchor) for i in skeleton.first_bone]
    flesh: list[tuple[str, NDArray[np.float64], NDArray[np.float64], float]] = []
    for knuckle in knuckles[1:]:
        wrist = np.array([0.55 * knuckle[0], 0.06 * knuckle[1], -0.15 * radius])
        flesh.append((f"metacarpal_{len(flesh) + 1}", wrist, knuckle, radius))
    thumb = knuckles[0]
    flesh.append(("thenar", 0.35 * thumb, thumb, 1.15 * radius))
    across = np.array([0.55 * radius, -0.6 * radius, 0.0])
    for side, name in ((-1.0, "wrist_in"), (1.0, "wrist_out")):
        start = across * np.array([side, 1.0, 1.0])
        stub = start - np.array([0.0, 3.0 * radius, 0.0])
        flesh.append((name, stub, start, 1.35 * radius))
    for name, start, end, size in flesh:
        SubElement(
            palm,
            "geom",
            {
                "name": hand.element_name(name),
                "fromto": _text(*start, *end),
                "size": _text(size),
                "group": "3",
                **({"contype": str(CONTACT_HAND)} if hand.solid_palm else {}),
            },
        )
    _add_palm_geoms(palm, knuckles, radius)


def _add_palm_geoms(palm: Element, knuckles: list[NDArray[np.float64]], radius: float) -> None:
    """The visible palm: geoms without mass and collisions.

    Args:
        palm: Body to add to.
        knuckles: (3,) m each, thumb first, in the palm's frame.
        radius: Radius (m) of the palm's capsules.
    """

    def seen(start: ArrayLike, end: ArrayLike, size: float, **look: str) -> None:
        SubElement(
            palm,
            "geom",
            {
                "fromto": _text(*np.asarray(start, float), *np.asarray(end, float)),
                "size": _text(size),
                "mass": "0",
                "group": "1",
                **look,
            },
        )

    # Back of the hand: a capsule from the wrist to every knuckle, and to every web between two
    # knuckles, so that there are no grooves.
    rays = [knuckles[1]]
    for inner, outer in pairwise(knuckles[1:]):
        web = (inner + outer) / 2 - np.array([0.0, 0.9 * radius, 0.1 * radius])
        rays += [web, outer]
    for end in rays:
        root = np.array([0.60 * end[0], 0.5 * radius, 0.1 * radius])
        seen(root, end - np.array([0.0, 0.0, 0.12 * radius]), 0.97 * radius)
    # Inside of the hand: a cushion under the knuckles, the ball of the thumb, the edge of the hand.
    under = np.array([0.0, -0.7 * radius, -0.95 * radius])
    for end in rays[1::2]:
        root = np.array([0.60 * end[0], 0.9 * radius, -0.75 * radius])
        seen(root, end + under, 1.0 * radius)
    thumb, little = knuckles[0], knuckles[4]
    seen(
        little * [0.72, 0.16, 0.0] - [0.0, 0.0, 0.8 * radius],
        little * [0.93, 0.72, 1.0] - [0.0, 0.0, 0.5 * radius],
        1.2 * radius,
    )
    seen(thumb * [0.45, 0.5, 0.9], thumb, 1.3 * radius)
    seen(
        thumb * [1.0, 1.2, 0.9],
        knuckles[1] * [0.85, 0.62, 0.0] - [0.0, 0.0, 0.6 * radius],
        0.95 * radius,
    )
    # A flat dome covers the metacarpals, which would otherwise look like a rake.
    middle = (knuckles[1] + little) / 2
    SubElement(
        palm,
        "geom",
        {
            "type": "ellipsoid",
            "pos": _text(*(middle * [1.1, 0.46, 0.0])),
            "size": _text(0.5 * abs(little[0] - knuckles[1][0]), 0.62 * middle[1], 1.20 * radius),
            "mass": "0",
            "group": "1",
        },
    )
    # Wrist, cuff and sleeve. Each is made of three geoms side by side, so that it is wider than
    # thick. Their ends differ a little in length, since overlapping equal ends would flicker.
    for side in (-1.0, 0.0, 1.0):
        place = np.array([0.75 * side * radius, 0.0, -0.45 * radius])
        along = np.array([0.0, radius, 0.0])
        seen(place + 0.9 * along, place - 4.5 * along, 1.55 * radius)
        ends = (3.4 + 0.05 * side) * along
        seen(place - ends, place - ends - 1.2 * along, 1.80 * radius, type="cylinder", rgba=CUFF)
        seen(
            place - ends - 0.5 * along,
            place - ends - 3.6 * along,
            2.0 * radius,
            type="cylinder",
            rgba=SLEEVE,
        )


def _text(*values: float) -> str:
    return " ".join(f"{float(v):.9g}" for v in values)


def _deg(angle: float) -> float:
    return float(np.rad2deg(angle))
