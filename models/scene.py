"""A scene: hands, a table and objects, as one MuJoCo model."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import NamedTuple, Protocol
from xml.etree.ElementTree import Element, SubElement, indent, tostring

import mujoco
import numpy as np

from models.arithmetic import Array, squared_lengths
from models.errors import SceneError
from models.hand import CONTACT_HAND, CONTACT_HANDS, CONTACT_TABLE, SceneHand
from models.objects import MechanismPart, SceneObject, WithAssets
from models.pose import POSE_SIZE

CONTROL_PERIOD = 0.016
"""Time (s) between two commanded poses: 62.5 Hz, the rate of a tablet rounded to whole physics
steps."""

TABLE = "table"

TABLE_PRIORITY = 1
"""Priority of the table's friction; that of hands, and by default of objects, is 0."""


@dataclass(frozen=True)
class PaintedRing:
    """A ring that is painted on the table: visible, without collisions.

    Lines, texts and other shapes cannot be painted.

    Attributes:
        name: Name of its geom.
        middle: (2,) m in the world.
        radius: Inner radius (m).
        width: Width of the line (m).
        rgb: Colour of the line, 0 to 1.
        inside: Colour inside of it.
    """

    name: str
    middle: tuple[float, float]
    radius: float
    width: float = 0.003
    rgb: tuple[float, float, float] = (0.95, 0.95, 0.95)
    inside: tuple[float, float, float] = (0.16, 0.36, 0.32)

    def geoms(self) -> list[Element]:
        """MJCF of a disc with a smaller disc on top, children of the world."""
        discs = (
            ("", self.radius + self.width, 0.0004, self.rgb),
            ("_inside", self.radius, 0.0006, self.inside),
        )
        return [
            Element(
                "geom",
                {
                    "name": self.name + part,
                    "type": "cylinder",
                    "size": f"{radius:.9g} {height / 2:.9g}",
                    "pos": f"{self.middle[0]:.9g} {self.middle[1]:.9g} {height / 2:.9g}",
                    "contype": "0",
                    "conaffinity": "0",
                    "rgba": " ".join(f"{value:.9g}" for value in (*rgb, 1.0)),
                },
            )
            for part, radius, height, rgb in discs
        ]


@dataclass(frozen=True)
class SceneSpec:
    """Description of a scene before it is compiled.

    Attributes:
        hands: One or two hands.
        objects: Objects on the table.
        table_friction: Coulomb coefficient between the table and the objects on it.
        timestep: Physics time step (s); a control period is a whole number of steps.
        hands_collide: True if the solid parts of two hands collide with each other.
        painted: Rings painted on the table.
        own_friction: True if the friction of an object applies to its contacts with hands and the
            table. Otherwise, contacts with the table use the table's friction, and contacts of an
            object with a hand use the larger of their coefficients.
    """

    hands: tuple[SceneHand, ...]
    objects: tuple[SceneObject, ...] = ()
    table_friction: float = 0.5
    timestep: float = 0.002
    hands_collide: bool = False
    painted: tuple[PaintedRing, ...] = ()
    own_friction: bool = False


class BodyPoses(Protocol):
    """Positions and rotations of all bodies: MuJoCo's data, or a copy of two of its arrays."""

    @property
    def xpos(self) -> Array:
        """Positions (bodies, 3) m."""
        ...

    @property
    def xmat(self) -> Array:
        """Rotations (bodies, 9)."""
        ...


class StillPoses(NamedTuple):
    """A copy of the positions and rotations of all bodies at one moment.

    Attributes:
        xpos: (bodies, 3) m.
        xmat: (bodies, 9) rotations.
    """

    xpos: Array
    xmat: Array


class Scene:
    """A compiled scene, with the indices of its parts in MuJoCo's arrays.

    Attributes:
        spec: The description from which the scene was compiled.
        xml: The whole scene as MJCF text.
        model: The compiled model. It belongs to one session, which switches collisions of geoms.
        substeps: Physics steps in one control period.
        joints: Hinges and slides of mechanisms by the part's name, each with its index in `qpos`.
    """

    def __init__(self, spec: SceneSpec) -> None:
        self.spec = spec
        substeps = CONTROL_PERIOD / spec.timestep if spec.timestep > 0 else 0.0
        # For less than one step, or more than a million, the time step was probably mistyped.
        if not (0.5 < substeps < 1e6 and np.isclose(substeps, round(substeps))):
            raise SceneError(
                "the control period is not a whole number of physics steps",
                where="timestep",
                got=spec.timestep,
                expected=f"{CONTROL_PERIOD} s divided by a whole number",
            )
        self.substeps = round(substeps)
        self.xml = scene_xml(spec)
        self.model = mujoco.MjModel.from_xml_string(self.xml)
        names = [o.name for o in spec.objects]
        self.object_bodies = {n: self.model.body(n).id for n in names}
        self.joints = {
            part.name: (part.joint, int(self.model.joint(part.name).qposadr[0]))
            for part in spec.objects
            if isinstance(part, MechanismPart) and part.joint is not None
        }
        geom = self.model.geom
        self._geoms = [{link.geom: geom(link.geom).id for link in h.links} for h in spec.hands]
        # The dictionary keeps the last link of every finger.
        self._ends = [{link.finger: geom(link.tip_geom).id for link in h.links} for h in spec.hands]
        self._palms = [self._palm_geoms(h) for h in spec.hands]
        # contype and conaffinity of solid parts.
        self._bits = [(CONTACT_HAND, 0) for _ in spec.hands]
        if spec.hands_collide and len(spec.hands) > 1:
            self._let_hands_collide()
        at_rest = np.zeros(POSE_SIZE)
        ends = np.cumsum([0, *(len(h.controls(at_rest)) for h in spec.hands)])
        self._controls = [slice(int(a), int(b)) for a, b in pairwise(ends)]
        starts = [int(self.model.joint(h.first_joint).qposadr[0]) for h in spec.hands]
        self._joints = [
            slice(start, start + len(h.joint_positions(at_rest)))
            for h, start in zip(spec.hands, starts, strict=True)
        ]

    def control_slice(self, hand: int) -> slice:
        """Slice of `ctrl` with the controls of a hand."""
        return self._controls[hand]

    def set_solid(
        self, hand: int, fingers: frozenset[int], whole: bool = False, links: int = 1
    ) -> None:
        """Chooses the parts of a hand that collide with objects.

        Args:
            hand: Index into `spec.hands`.
            fingers: Labels whose distal link is solid; empty makes the hand a ghost.
            whole: Makes every bone solid instead. This is meant for comparisons: people do not see
                where the rest of the hand is, so it only gets in their way.
            links: Number of solid links per finger, from its tip inwards.
        """
        geoms, ends = self._geoms[hand].values(), self._ends[hand]
        # The solid part of a last link is the link itself, or a separate geom.
        solid = set(geoms) if whole and fingers else {ends[f] for f in fingers}
        if links > 1:
            for finger in fingers:
                own = [k.geom for k in self.spec.hands[hand].links if k.finger == finger]
                solid |= {self._geoms[hand][name] for name in own[-links:-1]}
        self.set_solid_geoms(hand, solid)

    def set_solid_geoms(self, hand: int, solid: Collection[int]) -> None:
        """Chooses the geoms of a hand that collide.

        Args:
            hand: Index into `spec.hands`.
            solid: Indices of geoms, from those in `parts`. The other geoms do not collide.
        """
        mine, others = self._bits[hand]
        for geom in self.parts(hand):
            self.model.geom_contype[geom] = mine if geom in solid else 0
            self.model.geom_conaffinity[geom] = others if geom in solid else 0

    def parts(self, hand: int) -> list[int]:
        """Indices of all geoms of a hand that can be solid, in the order of the model."""
        links, ends = self._geoms[hand].values(), self._ends[hand].values()
        return sorted({*links, *ends, *self._palms[hand]})

    def _palm_geoms(self, hand: SceneHand) -> list[int]:
        """Geoms of a hand's palm that can be solid."""
        of_palm = self.model.geom_bodyid == self.model.body(hand.palm).id
        return [int(g) for g in np.flatnonzero(of_palm & (self.model.geom_contype > 0))]

    def _let_hands_collide(self) -> None:
        """Lets two hands collide with each other, but neither with itself: the second hand has an
        additional bit in contype, and only the first hand has this bit in conaffinity."""
        self._bits = [(CONTACT_HAND, CONTACT_HANDS), (CONTACT_HAND | CONTACT_HANDS, 0)]
        model = self.model
        for hand, (mine, others) in enumerate(self._bits):
            # MuJoCo stores the bits of all geoms of a body for the body, too.
            for body in np.unique(model.geom_bodyid[self.parts(hand)]):
                model.body_contype[body] |= mine
                model.body_conaffinity[body] |= others

    def object_pose(self, data: BodyPoses, name: str) -> tuple[Array, Array]:
        """Position (3,) and rotation (3, 3) of an object in the world."""
        body = self.object_bodies[name]
        return data.xpos[body].copy(), data.xmat[body].reshape(3, 3).copy()

    def clearance(self, data: BodyPoses, points: Array) -> Array:
        """Signed distances (n,) m of world points (n, 3) to the nearest object, negative inside;
        infinite without objects."""
        nearest = np.full(len(points), np.inf)
        for thing in self.spec.objects:
            position, rotation = self.object_pose(data, thing.name)
            nearest = np.minimum(nearest, thing.clearance(points, position, rotation))
        return nearest

    def object_radius(self, name: str) -> float:
        """Upper bound of the distance (m) from an object's origin to its farthest point."""
        model = self.model
        geoms = np.flatnonzero(model.geom_bodyid == self.object_bodies[name])
        ends = np.sqrt(squared_lengths(model.geom_pos[geoms])) + model.geom_rbound[geoms]
        return float(np.max(ends, initial=0.0))

    def object_width(self, name: str) -> float:
        """Upper bound of the diameter (m) of a ball around an object, wherever its origin is."""
        model = self.model
        geoms = np.flatnonzero(model.geom_bodyid == self.object_bodies[name])
        places, reach = model.geom_pos[geoms], model.geom_rbound[geoms][:, None]
        if not len(geoms):
            return 0.0
        middle = 0.5 * (np.min(places - reach, axis=0) + np.max(places + reach, axis=0))
        away = np.sqrt(squared_lengths(places - middle)) + reach[:, 0]
        return 2.0 * float(np.max(away))

    def pose_to_qpos(self, hand: int, q: Array) -> Array:
        """Joint positions (n,) of a hand at a pose (48,), in the order of its joints."""
        return self.spec.hands[hand].joint_positions(q)

    def qpos_slice(self, hand: int) -> slice:
        """Slice of `qpos` with the joint positions of a hand."""
        return self._joints[hand]


def touching_sensor(a: str, b: str) -> str:
    """Name of the contact sensor between two parts of a scene."""
    return f"touch:{a}:{b}"


def finger_sensor(name: str, hand: str, finger: int) -> str:
    """Name of the contact sensor between a part of a mechanism and a finger of a hand."""
    return f"finger:{name}:{hand}:{finger}"


def first_bodies(hand: SceneHand) -> dict[int, str]:
    """Body of each finger's first link, by label."""
    return {link.finger: link.body for link in reversed(hand.links)}


def scene_xml(spec: SceneSpec) -> str:
    """MJCF of a scene."""
    root = Element("mujoco", {"model": "hand sandbox"})
    SubElement(root, "compiler", {"angle": "degree", "autolimits": "true"})
    # impratio 100: friction otherwise creeps, and a held box sinks by millimetres.
    # The hand's kinematic tree makes the constraint matrices sparse; this saves a third of the time
    # in a grasp, and states are equal up to rounding.
    option = SubElement(
        root,
        "option",
        {
            "timestep": f"{spec.timestep:.9g}",
            "integrator": "implicitfast",
            "cone": "elliptic",
            "impratio": "100",
            "jacobian": "sparse",
        },
    )
    # MuJoCo's automatic reset would be silent. Without it, the session stops with an error.
    SubElement(option, "flag", {"autoreset": "disable"})
    _add_visual_settings(root)
    defaults = SubElement(root, "default")
    classes = {element.get("class"): element for element in (h.defaults() for h in spec.hands)}
    defaults.extend(classes.values())
    world = SubElement(root, "worldbody")
    _lights(world)
    SubElement(
        world,
        "geom",
        {
            "name": TABLE,
            "type": "plane",
            "size": "0 0 .05",
            "material": "floor",
            "contype": str(CONTACT_TABLE),
            "conaffinity": str(CONTACT_TABLE),
            "priority": str(TABLE_PRIORITY),
            "condim": "4",
            "friction": f"{spec.table_friction:.9g} .01 .0001",
            "solref": ".004 1",
            "solimp": ".95 .99 .001",
        },
    )
    SubElement(
        world,
        "geom",
        {
            "name": "mat",
            "type": "plane",
            "size": ".30 .21 .01",
            "pos": "0 0 .0002",
            "material": "mat",
            "contype": "0",
            "conaffinity": "0",
        },
    )
    for ring in spec.painted:
        world.extend(ring.geoms())
    for hand in spec.hands:
        world.append(hand.body())
    for obj in spec.objects:
        if not (isinstance(obj, MechanismPart) and obj.carrier):
            world.append(_with_own_friction(obj.body()) if spec.own_friction else obj.body())
    assets = root.find("asset")
    assert assets is not None
    for hand in spec.hands:
        assets.extend(hand.assets())
    for obj in spec.objects:
        if isinstance(obj, WithAssets):
            assets.extend(obj.assets())
    _keep_apart(root, spec)
    actuators = SubElement(root, "actuator")
    for hand in spec.hands:
        actuators.extend(hand.actuators())
    _touch_sensors(root, spec)
    indent(root)
    return tostring(root, encoding="unicode")


def _with_own_friction(body: Element) -> Element:
    """Gives the friction of a body precedence over that of hands and table; returns the body.

    For two geoms, MuJoCo uses the friction of the geom with the higher priority, or the larger
    friction if priorities are equal.
    """
    for geom in body.iter("geom"):
        geom.set("priority", str(TABLE_PRIORITY + 1))
    return body


def _keep_apart(root: Element, spec: SceneSpec) -> None:
    """Excludes contacts between parts of one mechanism."""
    pairs = {
        pair
        for obj in spec.objects
        if isinstance(obj, MechanismPart)
        for pair in combinations(obj.together, 2)
    }
    if pairs:
        contact = SubElement(root, "contact")
        for first, second in sorted(pairs):
            SubElement(contact, "exclude", {"body1": first, "body2": second})


def _touch_sensors(root: Element, spec: SceneSpec) -> None:
    """One contact sensor for every pair of parts whose contact a task may query."""
    sensors = SubElement(root, "sensor")
    for i, obj in enumerate(spec.objects):
        pairs = [(TABLE, {"geom2": TABLE})]
        pairs += [(h.name, {"subtree2": h.palm}) for h in spec.hands]
        pairs += [(other.name, {"body2": other.name}) for other in spec.objects[i + 1 :]]
        for name, match in pairs:
            SubElement(
                sensors,
                "contact",
                {
                    "name": touching_sensor(obj.name, name),
                    "body1": obj.name,
                    **match,
                    "data": "found force",
                    "reduce": "netforce",
                },
            )
    for obj in spec.objects:
        if not isinstance(obj, MechanismPart) or obj.fixed:
            continue
        for hand in spec.hands:
            for finger, body in first_bodies(hand).items():
                SubElement(
                    sensors,
                    "contact",
                    {
                        "name": finger_sensor(obj.name, hand.name, finger),
                        "body1": obj.name,
                        "subtree2": body,
                        "data": "found",
                        "num": "1",
                    },
                )


def _add_visual_settings(root: Element) -> None:
    """Colours, textures and render quality; without effect on the physics."""
    SubElement(root, "statistic", {"extent": ".45", "center": "0 .0 .05"})
    visual = SubElement(root, "visual")
    SubElement(visual, "global", {"offwidth": "1920", "offheight": "1080"})
    SubElement(visual, "rgba", {"haze": ".93 .945 .96 1"})
    SubElement(
        visual,
        "quality",
        {
            "shadowsize": "4096",
            "offsamples": "4",
            "numslices": "40",
            "numstacks": "20",
        },
    )
    SubElement(
        visual,
        "headlight",
        {
            "ambient": ".30 .30 .32",
            "diffuse": ".18 .18 .18",
            "specular": ".05 .05 .05",
        },
    )
    SubElement(
        visual,
        "map",
        {
            "znear": ".02",
            "zfar": "60",
            "shadowclip": "2.5",
            "shadowscale": ".6",
            "haze": ".35",
        },
    )
    asset = SubElement(root, "asset")
    SubElement(
        asset,
        "texture",
        {
            "type": "skybox",
            "builtin": "gradient",
            "rgb1": ".93 .945 .96",
            "rgb2": ".70 .77 .84",
            "width": "64",
            "height": "384",
        },
    )
    SubElement(
        asset,
        "texture",
        {
            "name": "floor",
            "type": "2d",
            "builtin": "checker",
            "rgb1": ".86 .85 .84",
            "rgb2": ".84 .83 .82",
            "width": "256",
            "height": "256",
        },
    )
    SubElement(
        asset,
        "material",
        {
            "name": "floor",
            "texture": "floor",
            "texrepeat": "4 4",
            "texuniform": "true",
            "specular": ".05",
        },
    )
    SubElement(
        asset,
        "texture",
        {
            "name": "mat",
            "type": "2d",
            "builtin": "flat",
            "mark": "edge",
            "rgb1": ".215 .275 .315",
            "markrgb": ".26 .32 .36",
            "width": "64",
            "height": "64",
        },
    )
    # One square of the grid is 2 cm, which gives a picture its scale.
    SubElement(
        asset,
        "material",
        {
            "name": "mat",
            "texture": "mat",
            "texrepeat": "100 100",
            "texuniform": "true",
            "specular": ".1",
        },
    )


def _lights(world: Element) -> None:
    """A warm key light over the left shoulder, aimed at the middle of the table, and a cool fill.

    Colours of all lights add up to less than 1; otherwise skin is overexposed.
    """
    SubElement(
        world,
        "light",
        {
            "type": "directional",
            "pos": "-.54 -.43 1.05",
            "dir": ".45 .33 -.83",
            "diffuse": ".64 .615 .575",
            "specular": ".22 .22 .22",
            "ambient": "0 0 0",
            "castshadow": "true",
        },
    )
    SubElement(
        world,
        "light",
        {
            "type": "directional",
            "pos": ".6 -.3 .7",
            "dir": "-.6 .5 -.45",
            "diffuse": ".14 .16 .20",
            "specular": "0 0 0",
            "castshadow": "false",
        },
    )
