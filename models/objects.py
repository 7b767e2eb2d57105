"""Objects to manipulate: their contract, boxes, cylinders, wrenches and a tray."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from math import cos, sin
from pathlib import Path
from typing import ClassVar, Protocol, runtime_checkable
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array, matrix_product, squared_lengths
from models.hand import CONTACT_OBJECT, CONTACT_TABLE

RED = (0.86, 0.30, 0.24)
STEEL, BRIGHT_STEEL, DARK_STEEL = (0.52, 0.55, 0.59), (0.74, 0.77, 0.80), (0.30, 0.32, 0.35)


class SceneObject(Protocol):
    """Contract of an object that lies in a scene and is manipulated.

    Attributes:
        name: Name of its body, and of the joint that lets it move.
        mass: Mass (kg).
        position: (3,) m, its middle at the start.
        yaw: Yaw (rad) about the vertical at the start.
    """

    @property
    def name(self) -> str: ...

    @property
    def mass(self) -> float: ...

    @property
    def position(self) -> tuple[float, float, float]: ...

    @property
    def yaw(self) -> float: ...

    def body(self) -> Element:
        """MJCF of the body, a child of the world."""
        ...

    def clearance(self, points: ArrayLike, position: Array, rotation: Array) -> Array:
        """Signed distances (n,) m of world points (n, 3) to the object, negative inside."""
        ...


@runtime_checkable
class WithAssets(Protocol):
    """Contract of an object whose geoms have meshes."""

    def assets(self) -> list[Element]:
        """MJCF of the meshes, children of the scene's assets."""
        ...


@runtime_checkable
class Scalable(Protocol):
    """Contract of an object whose size can be varied."""

    def scaled(self, size: float) -> SceneObject:
        """The object in another size: all lengths multiplied by a factor, with the same mass, and
        standing at the same place."""
        ...


@runtime_checkable
class Symmetric(Protocol):
    """Contract of an object that looks the same from several sides.

    Attributes:
        symmetry: Number of equivalent angles in one full turn about the vertical; 0 if all angles
            are equivalent.
    """

    @property
    def symmetry(self) -> int: ...


@dataclass(frozen=True)
class Joint:
    """A hinge or a slide.

    Attributes:
        kind: `hinge` or `slide`.
        range: Lowest and highest value, rad or m; None without end stops.
        start: Position at the start, rad or m.
    """

    kind: str
    range: tuple[float, float] | None
    start: float

    @property
    def unit(self) -> str:
        """Unit of its values."""
        return "m" if self.kind == "slide" else "rad"

    @property
    def column(self) -> str:
        """End of the name of its column in tables: `hinge_rad` or `slide_m`."""
        return f"{self.kind}_{self.unit}"


class MechanismPart(ABC):
    """Contract of an object that is one body of a mechanism, in addition to that of `SceneObject`.

    Built by `models.mechanism`.
    """

    @property
    @abstractmethod
    def name(self) -> str:
        """Name of its body, and of its joint if it has one."""

    @property
    @abstractmethod
    def mass(self) -> float:
        """Mass (kg)."""

    @property
    @abstractmethod
    def position(self) -> tuple[float, float, float]:
        """(3,) m, origin of its body at the start."""

    @property
    @abstractmethod
    def yaw(self) -> float:
        """Yaw (rad) about the vertical, of its x axis at the start."""

    @property
    @abstractmethod
    def mjcf(self) -> str | Path:
        """Description of its mechanism: MJCF, or the path of a file."""

    @property
    @abstractmethod
    def carrier(self) -> str | None:
        """Name of the part whose MJCF contains this part; None for a child of the world."""

    @property
    @abstractmethod
    def together(self) -> tuple[str, ...]:
        """Names of all parts of its mechanism. They do not collide with each other."""

    @property
    @abstractmethod
    def fixed(self) -> bool:
        """True if it cannot move."""

    @property
    @abstractmethod
    def joint(self) -> Joint | None:
        """Its hinge or slide; None for a body that is fixed or free."""

    @abstractmethod
    def placed(self, value: float) -> tuple[tuple[float, float, float], float]:
        """Position (3,) m and yaw (rad) of its body, with its joint at a value (rad or m) and all
        other joints at their starts.

        Raises:
            InputError: It has no joint.
        """

    @abstractmethod
    def body(self) -> Element:
        """MJCF of the body, with all that it carries."""

    @abstractmethod
    def assets(self) -> list[Element]:
        """MJCF assets of its mechanism; only one part of the mechanism has them."""

    @abstractmethod
    def clearance(self, points: ArrayLike, position: Array, rotation: Array) -> Array:
        """Signed distances (n,) m of world points (n, 3) to the part, negative inside."""

    @abstractmethod
    def varied(self, size: float, mass: float, resistance: float) -> MechanismPart:
        """The same part with factors on all lengths, masses and the resistance of joints.

        The lowest point of a free mechanism keeps its height.

        Args:
            size: Factor on all lengths.
            mass: Factor on all masses.
            resistance: Factor on stiffness, damping and friction of joints.
        """


@dataclass(frozen=True)
class Box:
    """A solid box, free to move.

    Attributes:
        name: Name of its body.
        half_size: (3,) m, half its edges.
        mass: Mass (kg).
        position: (3,) m, centre at the start.
        yaw: Yaw (rad) about the vertical at the start.
        rgb: Colour, 0 to 1.
        friction: Coulomb coefficient; see `SceneSpec.own_friction`.
    """

    name: str
    half_size: tuple[float, float, float]
    mass: float
    position: tuple[float, float, float]
    yaw: float = 0.0
    rgb: tuple[float, float, float] = RED
    friction: float = 1.0

    def body(self) -> Element:
        """MJCF of the box."""
        quat = (cos(self.yaw / 2), 0.0, 0.0, sin(self.yaw / 2))
        body = Element(
            "body",
            {"name": self.name, "pos": mjcf_text(self.position), "quat": mjcf_text(quat)},
        )
        SubElement(body, "freejoint", {"name": self.name})
        SubElement(
            body,
            "geom",
            {
                "name": self.name,
                "type": "box",
                "size": mjcf_text(self.half_size),
                **_solid(self.mass, self.rgb, self.friction),
            },
        )
        return body

    def clearance(self, points: ArrayLike, position: Array, rotation: Array) -> Array:
        """Signed distances (n,) m of world points (n, 3) to the box, negative inside.

        Args:
            points: World points.
            position: (3,) m, current position of the box.
            rotation: (3, 3) current rotation.
        """
        away = np.asarray(points, float) - position
        return _box_clearance(matrix_product(away, rotation), self.half_size)


@dataclass(frozen=True)
class Cylinder:
    """A solid cylinder that stands on its end, free to move.

    Attributes:
        name: Name of its body.
        radius: Radius (m).
        half_height: Half its height (m).
        mass: Mass (kg).
        position: (3,) m, centre at the start.
        yaw: Yaw (rad) about the vertical at the start, which is not visible.
        rgb: Colour, 0 to 1.
        friction: Coulomb coefficient; see `SceneSpec.own_friction`.
        symmetry: Number of equivalent angles in one full turn; 0, since all are equivalent.
    """

    name: str
    radius: float
    half_height: float
    mass: float
    position: tuple[float, float, float]
    yaw: float = 0.0
    rgb: tuple[float, float, float] = RED
    friction: float = 1.0
    symmetry: ClassVar[int] = 0

    def scaled(self, size: float) -> Cylinder:
        """The same cylinder in another size, with the same mass and place."""
        x, y, z = self.position
        raised = (size - 1.0) * self.half_height
        return replace(
            self,
            radius=size * self.radius,
            half_height=size * self.half_height,
            position=(x, y, z + raised),
        )

    def body(self) -> Element:
        """MJCF of the cylinder."""
        quat = (cos(self.yaw / 2), 0.0, 0.0, sin(self.yaw / 2))
        body = Element(
            "body",
            {"name": self.name, "pos": mjcf_text(self.position), "quat": mjcf_text(quat)},
        )
        SubElement(body, "freejoint", {"name": self.name})
        SubElement(
            body,
            "geom",
            {
                "name": self.name,
                "type": "cylinder",
                "size": mjcf_text((self.radius, self.half_height)),
                **_solid(self.mass, self.rgb, self.friction),
            },
        )
        return body

    def clearance(self, points: ArrayLike, position: Array, rotation: Array) -> Array:
        """Signed distances (n,) m of world points (n, 3) to the cylinder, negative inside.

        Args:
            points: World points.
            position: (3,) m, current position of the cylinder.
            rotation: (3, 3) current rotation.
        """
        local = matrix_product(np.asarray(points, float) - position, rotation)
        aside = np.sqrt(squared_lengths(local[:, :2]))
        # In the plane of axis and point a cylinder is a rectangle.
        flat = np.column_stack([aside, local[:, 2]])
        return _box_clearance(flat, (self.radius, self.half_height))


@dataclass(frozen=True)
class _Piece:
    """A box of a wrench: its middle (3,) and half size (3,), m, and its turn, rad."""

    name: str
    middle: tuple[float, float, float]
    half_size: tuple[float, float, float]
    turn: float = 0.0


THICKNESS = 0.016
"""Thickness (m) of a wrench. All lengths here are those of a wrench of size 1."""
HANDLE_WIDTH = 0.022
"""Width (m) of the handle, on which fingers close."""
HANDLE = (-0.032, 0.060)
"""Positions (m) along a wrench's x axis at which the handle begins and ends."""
JAW = -0.052
"""Position (m) of the middle of jaws and bolt along a wrench's x axis."""
BOLT_FLAT = 0.0075
"""Half the width across the flats of the bolt's head (m)."""
BOLT_LIFT = 0.004
"""Height (m) of a wrench on a bolt above the table."""

_SPLAY = np.deg2rad(9.0)
_HALF = THICKNESS / 2
_PIECES = (
    _Piece(
        "handle",
        ((HANDLE[0] + HANDLE[1]) / 2, 0.0, 0.0),
        ((HANDLE[1] - HANDLE[0]) / 2, HANDLE_WIDTH / 2, _HALF),
    ),
    _Piece("neck", (-0.037, 0.0, 0.0), (0.005, 0.016, _HALF)),
    _Piece("jaw_left", (-0.052, 0.0135, 0.0), (0.012, 0.0045, _HALF), -_SPLAY),
    _Piece("jaw_right", (-0.052, -0.0135, 0.0), (0.012, 0.0045, _HALF), _SPLAY),
)


@dataclass(frozen=True)
class Wrench:
    """An open-ended wrench that lies flat, free to move or set on a bolt about which it turns.

    Its frame is at the middle of its length and thickness, x along the handle away from the jaws,
    z up. The bolt's head turns with it and only marks the axis; fingers pass through it.

    Attributes:
        name: Name of its body.
        mass: Mass (kg).
        position: (3,) m, middle at the start.
        yaw: Yaw (rad) about the vertical at the start.
        bolt: Dry friction (N m) about the bolt it sits on; None for a free wrench.
        rgb: Colour, 0 to 1.
        size: Factor on all its edges, and on the width of its bolt.
    """

    name: str
    mass: float
    position: tuple[float, float, float]
    yaw: float = 0.0
    bolt: float | None = None
    rgb: tuple[float, float, float] = RED
    size: float = 1.0

    @property
    def handle(self) -> tuple[float, float]:
        """Beginning and end of the handle (m along its x axis)."""
        return self.size * HANDLE[0], self.size * HANDLE[1]

    @property
    def handle_width(self) -> float:
        """Width of the handle, m."""
        return self.size * HANDLE_WIDTH

    @property
    def thickness(self) -> float:
        """Thickness, m."""
        return self.size * THICKNESS

    @property
    def jaw(self) -> float:
        """Middle of its jaws (m along its x axis)."""
        return self.size * JAW

    def bolt_place(self, middle: ArrayLike, yaw: float) -> tuple[float, float]:
        """Position (2,) m of its jaws, given its middle (2,) m and its yaw (rad)."""
        return bolt_place(middle, yaw, self.jaw)

    def scaled(self, size: float) -> Wrench:
        """The same wrench in another size, with the same mass, friction and place.

        A free wrench keeps the place of its middle. A wrench on a bolt keeps the place of the bolt.
        """
        x, y, z = self.position
        if self.bolt is not None:
            out = (1.0 - size) * self.jaw
            x, y = x + out * cos(self.yaw), y + out * sin(self.yaw)
        raised = (size - 1.0) * self.thickness / 2
        return replace(self, size=size * self.size, position=(float(x), float(y), z + raised))

    def body(self) -> Element:
        """MJCF of the wrench; for a wrench on a bolt, of the fixed plate with the wrench as its
        child."""
        quat = (cos(self.yaw / 2), 0.0, 0.0, sin(self.yaw / 2))
        body = Element(
            "body",
            {"name": self.name, "pos": mjcf_text(self.position), "quat": mjcf_text(quat)},
        )
        if self.bolt is None:
            SubElement(body, "freejoint", {"name": self.name})
        else:
            # The armature represents the bolt's thread. With less inertia, friction would make the
            # joint numerically stiff.
            SubElement(
                body,
                "joint",
                {
                    "name": self.name,
                    "type": "hinge",
                    "axis": "0 0 1",
                    "pos": mjcf_text((self.jaw, 0.0, 0.0)),
                    "armature": "2e-4",
                    "damping": "1e-3",
                    "frictionloss": f"{self.bolt:.9g}",
                    "solreffriction": ".004 1",
                    "solimpfriction": ".9999 .9999 .001",
                    "limited": "false",
                },
            )
        volume = [float(np.prod(piece.half_size)) for piece in _PIECES]
        for piece, share in zip(_PIECES, np.array(volume) / np.sum(volume), strict=True):
            turn = (cos(piece.turn / 2), 0.0, 0.0, sin(piece.turn / 2))
            middle, half = self.size * np.array([piece.middle, piece.half_size])
            SubElement(
                body,
                "geom",
                {
                    "name": f"{self.name}_{piece.name}",
                    "type": "box",
                    "pos": mjcf_text(middle),
                    "quat": mjcf_text(turn),
                    "size": mjcf_text(half),
                    **_solid(self.mass * share, self.rgb),
                },
            )
        if self.bolt is None:
            return body
        return self._on_bolt(body, quat)

    def _on_bolt(self, body: Element, quat: ArrayLike) -> Element:
        """The fixed plate under the bolt, with the wrench's body as its child."""
        x, y = self.bolt_place(self.position[:2], self.yaw)
        plate = Element(
            "body",
            {
                "name": f"{self.name}_bolt",
                "pos": mjcf_text((x, y, 0.0)),
                "quat": mjcf_text(quat),
            },
        )
        _add_visible_part(
            plate, "cylinder", (self.size * 0.012, BOLT_LIFT / 2), BOLT_LIFT / 2, DARK_STEEL
        )
        # In the plate's frame, which has the wrench's yaw at the start.
        body.set("pos", mjcf_text((-self.jaw, 0.0, self.position[2])))
        body.set("quat", "1 0 0 0")
        jaw, flat = (self.jaw, 0.0, 0.0), self.size * BOLT_FLAT
        head = SubElement(body, "body", {"name": f"{self.name}_head", "pos": mjcf_text(jaw)})
        for third in range(3):
            # Three crossed boxes form a hexagon; tops of equal height would flicker.
            half = self.thickness / 2 + 0.0014 + 0.0001 * third
            flats = (flat / np.sqrt(3.0), flat, half)
            _add_visible_part(
                head, "box", flats, half - self.thickness / 2, STEEL, third * np.pi / 3
            )
        top = self.thickness / 2 + 0.0036
        _add_visible_part(head, "cylinder", (0.93 * flat, 0.0004), top, BRIGHT_STEEL)
        plate.append(body)
        return plate

    def clearance(self, points: ArrayLike, position: Array, rotation: Array) -> Array:
        """Signed distances (n,) m of world points (n, 3) to the wrench, negative inside.

        Args:
            points: World points.
            position: (3,) m, current position of the wrench's middle.
            rotation: (3, 3) current rotation.
        """
        local = matrix_product(np.asarray(points, float) - position, rotation) / self.size
        distances = []
        for piece in _PIECES:
            c, s = cos(piece.turn), sin(piece.turn)
            turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
            own = matrix_product(local - piece.middle, turn)
            distances.append(_box_clearance(own, piece.half_size))
        return self.size * np.min(distances, axis=0)


def bolt_place(middle: ArrayLike, yaw: float, jaw: float = JAW) -> tuple[float, float]:
    """Position (2,) m of a wrench's jaws, from its middle (2,) m and yaw (rad)."""
    x, y = np.asarray(middle, float)
    return float(x + jaw * cos(yaw)), float(y + jaw * sin(yaw))


def _add_visible_part(
    body: Element,
    kind: str,
    size: ArrayLike,
    height: float,
    rgb: tuple[float, float, float],
    turn: float = 0.0,
) -> None:
    """Adds a visible part without collisions, `height` (m) above the body's middle and turned by
    `turn` (rad)."""
    SubElement(
        body,
        "geom",
        {
            "type": kind,
            "size": mjcf_text(size),
            "pos": mjcf_text((0.0, 0.0, height)),
            "quat": mjcf_text((cos(turn / 2), 0.0, 0.0, sin(turn / 2))),
            "mass": "0",
            "contype": "0",
            "conaffinity": "0",
            "rgba": mjcf_text((*rgb, 1.0)),
        },
    )


def _solid(mass: float, rgb: tuple[float, float, float], friction: float = 1.0) -> dict[str, str]:
    """MJCF attributes of a solid part of an object. It collides with hands, objects and the
    table."""
    return {
        "mass": f"{mass:.9g}",
        "contype": str(CONTACT_OBJECT | CONTACT_TABLE),
        "conaffinity": "7",
        "condim": "4",
        "friction": f"{friction:.9g} .01 .0001",
        "solref": ".004 1",
        "solimp": ".95 .99 .001",
        "rgba": mjcf_text((*rgb, 1.0)),
    }


def _box_clearance(points: Array, half_size: ArrayLike) -> Array:
    """Signed distances (n,) m of points (n, 3) in a box's own frame."""
    local = np.abs(points) - half_size
    beyond = np.maximum(local, 0.0)
    # Equal to `np.linalg.norm` to the bit, without its overhead.
    outside = np.sqrt(squared_lengths(beyond))
    return np.asarray(outside + np.minimum(np.maximum.reduce(local, axis=-1), 0.0))


def mjcf_text(values: ArrayLike) -> str:
    """Numbers as the value of an MJCF attribute."""
    return " ".join(f"{float(v):.9g}" for v in np.asarray(values, float))


WOOD, DARK_WOOD = (0.80, 0.60, 0.38), (0.55, 0.37, 0.22)

TRAY_DECK = (0.080, 0.060, 0.007)
"""Half the edges (m) of the deck of a tray whose `size` is 1. A hand cannot grasp the deck, which
is too wide."""
TRAY_HANDLE = (0.035, 0.015, 0.018)
"""Half the edges (m) of each handle; handles begin where the deck ends."""
TRAY_GRIP = 0.120
"""Distance (m) from a tray's middle to the grip on a handle."""


@dataclass(frozen=True)
class Tray:
    """A tray that lies on its deck and handles, free to move.

    Its frame is at the middle of its handles' height, x from handle to handle, z up.

    Attributes:
        name: Name of its body.
        mass: Mass (kg), nearly all in the deck.
        position: (3,) m, middle at the start.
        yaw: Yaw (rad) about the vertical at the start.
        size: Factor on all its edges.
    """

    name: str
    mass: float
    position: tuple[float, float, float]
    yaw: float = 0.0
    size: float = 1.0

    @property
    def grip(self) -> float:
        """Distance in m from the middle to the grip on a handle."""
        return self.size * TRAY_GRIP

    @property
    def handle(self) -> tuple[float, float, float]:
        """Half the edges (3,) m of a handle."""
        a, b, c = (self.size * half for half in TRAY_HANDLE)
        return a, b, c

    def scaled(self, size: float) -> Tray:
        """The same tray in another size, with the same place and mass."""
        x, y, z = self.position
        raised = (size - 1.0) * self.size * TRAY_HANDLE[2]
        return replace(self, size=self.size * size, position=(x, y, z + raised))

    def body(self) -> Element:
        """MJCF of the tray."""
        quat = (cos(self.yaw / 2), 0.0, 0.0, sin(self.yaw / 2))
        body = Element(
            "body",
            {"name": self.name, "pos": mjcf_text(self.position), "quat": mjcf_text(quat)},
        )
        SubElement(body, "freejoint", {"name": self.name})
        for name, middle, half in self._pieces():
            deck = name == "deck"
            SubElement(
                body,
                "geom",
                {
                    "name": f"{self.name}_{name}",
                    "type": "box",
                    "pos": mjcf_text(middle),
                    "size": mjcf_text(half),
                    "mass": f"{self.mass * (0.8 if deck else 0.1):.9g}",
                    "contype": str(CONTACT_OBJECT | CONTACT_TABLE),
                    "conaffinity": "7",
                    "condim": "4",
                    "friction": "1 .01 .0001",
                    "solref": ".004 1",
                    "solimp": ".95 .99 .001",
                    "rgba": mjcf_text((*(WOOD if deck else DARK_WOOD), 1.0)),
                },
            )
        return body

    def clearance(self, points: ArrayLike, position: Array, rotation: Array) -> Array:
        """Signed distances (n,) m of world points (n, 3) to the tray, negative inside.

        Args:
            points: World points.
            position: (3,) m, current position of the tray's middle.
            rotation: (3, 3) current rotation.
        """
        local = matrix_product(np.asarray(points, float) - position, rotation)
        distances = []
        for _, middle, half in self._pieces():
            off = np.abs(local - middle) - half
            outside = np.sqrt(squared_lengths(np.maximum(off, 0.0)))
            distances.append(outside + np.minimum(off.max(axis=-1), 0.0))
        return np.asarray(np.min(distances, axis=0))

    def _pieces(self) -> list[tuple[str, Array, Array]]:
        """Name, middle (3,) and half edges (3,), m, of deck and handles."""
        deck, handle = self.size * np.array(TRAY_DECK), self.size * np.array(TRAY_HANDLE)
        out = deck[0] + handle[0]
        # All of them stand on the table.
        return [
            ("deck", np.array([0.0, 0.0, deck[2] - handle[2]]), deck),
            ("right", np.array([out, 0.0, 0.0]), handle),
            ("left", np.array([-out, 0.0, 0.0]), handle),
        ]
