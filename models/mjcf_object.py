"""Custom objects described in MJCF, as text or as a file that any MuJoCo viewer opens.

MuJoCo compiles the description separately from the scene, with its defaults, meshes and includes.
The result, one rigid body of plain geoms, goes into the scene. So names and settings cannot clash
with those of the scene, and errors are reported before the scene is built.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import cos, sin
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arithmetic import Array, matrix_product, stacked_applied
from models.errors import InputError
from models.hand import CONTACT_HAND, CONTACT_OBJECT, CONTACT_TABLE
from models.objects import mjcf_text
from models.plausible import OBJECT

_GEOM = mujoco.mjtGeom
GEOM_KINDS = {
    int(_GEOM.mjGEOM_SPHERE): ("sphere", 1),
    int(_GEOM.mjGEOM_CAPSULE): ("capsule", 2),
    int(_GEOM.mjGEOM_ELLIPSOID): ("ellipsoid", 3),
    int(_GEOM.mjGEOM_CYLINDER): ("cylinder", 2),
    int(_GEOM.mjGEOM_BOX): ("box", 3),
    int(_GEOM.mjGEOM_MESH): ("mesh", 0),
}
"""MuJoCo's type of a geom -> its name in MJCF, and its number of sizes."""

_PROBE = 1e-3
"""Radius (m) of the ball with which distances are measured; results are corrected by it."""
_FLOOR = 10.0
"""Distance (m) from the object's origin down to the top of a block. The height of the object's
lowest point is measured from this block."""
_PROBE_NAME, _FLOOR_NAME = "hand sandbox probe", "hand sandbox floor"
"""Names of the ball and of the block. They are unusual, since many descriptions contain a floor."""
_BESIDE = 0.005
"""Tolerance (m) of the check that an object is at its body's origin: along x and along y, the
distance of its middle from the origin may be its width plus this number."""
_FAR = 100.0
"""Largest distance that is measured (m)."""

_BITS = (CONTACT_OBJECT | CONTACT_TABLE, CONTACT_HAND | CONTACT_OBJECT | CONTACT_TABLE)
"""Collision bits of solid geoms: contype and conaffinity."""

_WORLD_NAMES = ("table", "mat", "world")
"""Names that a scene uses itself and an object may not have."""


@dataclass(frozen=True)
class MjcfObject:
    """An object from MJCF: one rigid body, free to move.

    The scene uses these parts of the description: its one body with all bodies welded to it, their
    geoms (sphere, capsule, ellipsoid, cylinder, box and mesh), colours, friction and distribution
    of mass. A mesh collides as its convex hull. Geoms with contype and conaffinity 0 are only
    visible. The scene decides the softness of contacts and which parts collide. Everything else in
    the description, such as a floor or lights, is left out.

    Attributes:
        name: Name of its body.
        mjcf: A whole description, `<mujoco>...`, or the path of a file, such as
            `Path(__file__).parent / "mug.xml"`; a relative path starts at the current folder.
        mass: Mass (kg). It replaces the total mass in the description; the distribution is that of
            the description.
        position: (3,) m, the body's origin at the start. It replaces the position in the
            description.
        yaw: Yaw (rad) about the vertical at the start. It replaces the rotation in the description.
        symmetry: Rotational symmetry: the number of equivalent angles in one full turn about the z
            axis. 1 for an object with a front, 4 for a square object, 0 for a round object. The
            simulated user turns the object to the nearest equivalent angle.
        size: Factor on all lengths of the description.

    Raises:
        InputError: MuJoCo cannot compile the description, or it is not one rigid body.
    """

    name: str
    mjcf: str | Path = field(repr=False)
    mass: float
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw: float = 0.0
    symmetry: int = 1
    size: float = 1.0

    def __post_init__(self) -> None:
        check_object_name(self.name, "MjcfObject")
        check_position(self.position, self._where)
        for what, value in (("mass", self.mass), ("size", self.size)):
            if not 0.0 < value < float("inf"):
                raise InputError(
                    f"its {what} is out of range", where=self._where, got=value, expected="above 0"
                )
        self._check_middle()

    @classmethod
    def on_table(
        cls,
        name: str,
        mjcf: str | Path,
        mass: float,
        place: ArrayLike,
        yaw: float = 0.0,
        symmetry: int = 1,
    ) -> MjcfObject:
        """Creates the object standing on the table, upright as in its description.

        Args:
            name: Name of its body.
            mjcf: Its description.
            mass: Mass (kg).
            place: (2,) or (3,) m, position of its origin in the world. Only x and y are used; the
                height is computed.
            yaw: Yaw (rad) about the vertical.
            symmetry: See the class.
        """
        x, y = np.asarray(place, float)[:2]
        height = cls(name, mjcf, mass).height
        return cls(name, mjcf, mass, (float(x), float(y), height), yaw, symmetry)

    def body(self) -> Element:
        """MJCF of the body."""
        model = self._compiled
        quat = (cos(self.yaw / 2), 0.0, 0.0, sin(self.yaw / 2))
        body = Element(
            "body",
            {"name": self.name, "pos": mjcf_text(self.position), "quat": mjcf_text(quat)},
        )
        SubElement(body, "freejoint", {"name": self.name})
        share = self.size**2 * self.mass / model.body_mass[1]
        SubElement(
            body,
            "inertial",
            {
                "pos": mjcf_text(self.size * model.body_ipos[1]),
                "quat": mjcf_text(model.body_iquat[1]),
                "mass": f"{self.mass:.9g}",
                "diaginertia": mjcf_text(share * model.body_inertia[1]),
            },
        )
        for number, geom in enumerate(self._geoms):
            name = f"{self.name}_{number}"
            body.append(geom_element(model, geom, name, self.name, self.size, _BITS))
        return body

    def assets(self) -> list[Element]:
        """MJCF assets of its meshes, which contain the points themselves."""
        return mesh_assets(self._compiled, self._geoms, self.name, self.size)

    def clearance(self, points: ArrayLike, position: Array, rotation: Array) -> Array:
        """Signed distances (n,) m of world points (n, 3) to the object's solid geoms, negative
        inside. MuJoCo's collision functions measure them.

        Args:
            points: World points.
            position: (3,) m, current position of its origin.
            rotation: (3, 3) current rotation.
        """
        away = np.atleast_2d(np.asarray(points, float)) - position
        local = matrix_product(away, rotation) / self.size
        distances = np.full(len(local), np.inf)
        for i, point in enumerate(local):
            self._measuring.mocap_pos[0] = point
            mujoco.mj_kinematics(self._compiled, self._measuring)
            for geom in self._solid:
                distances[i] = min(distances[i], self._distance(geom, _PROBE_NAME) + _PROBE)
        return self.size * distances

    def scaled(self, size: float) -> MjcfObject:
        """The same object in another size, with the same mass and place."""
        x, y, z = self.position
        return replace(self, size=size * self.size, position=(x, y, z + (size - 1.0) * self.height))

    @cached_property
    def height(self) -> float:
        """Height in m of its origin above the table when it stands as described."""
        mujoco.mj_kinematics(self._compiled, self._measuring)
        lowest = min(self._distance(geom, _FLOOR_NAME) for geom in self._solid) - _FLOOR
        return -self.size * lowest

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """Lowest and highest corner (3,), (3,) m of a box around its solid geoms, in its frame."""
        model = self._compiled
        corners = []
        for geom in self._solid:
            middle, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
            turned = np.empty(9)
            mujoco.mju_quat2Mat(turned, model.geom_quat[geom])
            turn = turned.reshape(3, 3)
            centre = model.geom_pos[geom] + stacked_applied(turn, middle)
            reach = stacked_applied(np.abs(turn), half)
            corners += [centre - reach, centre + reach]
        return self.size * np.min(corners, axis=0), self.size * np.max(corners, axis=0)

    def _check_middle(self) -> None:
        """Refuses an object in another unit, and an object that is not at its body's origin.

        The origin is the object's position for tasks and views. It may be anywhere within the
        object, and outside by up to half the object's width. Meshes are often drawn far from their
        origin.
        """
        low, high = self.bounds
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        width = 2.0 * float(half.max())
        if not OBJECT.includes(width):
            raise InputError(
                f"{OBJECT.name} is impossible",
                where=self._where,
                got=f"{width:.3g} m",
                expected=f"{OBJECT.least:g} to {OBJECT.most:g} m",
                remedy='Lengths are in m; a mesh in mm is scaled: <mesh scale=".001 .001 .001" '
                ".../>",
            )
        beside = np.abs(middle[:2]) > 2.0 * half[:2] + _BESIDE
        if beside.any():
            offset = ", ".join(f"{v / self.size:.4g}" for v in middle)
            raise InputError(
                "the object is not at the origin of its body",
                where=self._where,
                got=f"its middle at ({1000 * middle[0]:.0f}, {1000 * middle[1]:.0f}) mm",
                expected="its middle at most its own width from the origin, along x and along y",
                remedy=f"Subtract ({offset}) m from the pos of each geom and each child body of "
                "this body in the description",
            )

    @property
    def _where(self) -> str:
        return described_in(self.mjcf, self.name)

    @cached_property
    def _compiled(self) -> Any:
        """MuJoCo's model of the body, with a ball and a block to measure distances to."""
        try:
            spec = read_mjcf(self.mjcf, MjcfObject.__name__)
            # Bodies welded to each other become one, so that sensors treat them as one object.
            spec.compiler.fusestatic = True
            bodies = spec.worldbody.bodies
            count = len(bodies)
            if count == 1 and not bodies[0].joints:
                bodies[0].add_freejoint()
            probe = spec.worldbody.add_body(name=_PROBE_NAME, mocap=True)
            probe.add_geom(name=_PROBE_NAME, type=_GEOM.mjGEOM_SPHERE, size=[_PROBE, 0.0, 0.0])
            floor = spec.worldbody.add_body(name=_FLOOR_NAME, mocap=True)
            floor.add_geom(name=_FLOOR_NAME, type=_GEOM.mjGEOM_BOX, size=[_FLOOR] * 3)
            model = spec.compile()
        except (ValueError, OSError) as error:
            raise unreadable(self.mjcf, self.name, error) from None
        free = count == 1 and model.njnt == 1 and model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE
        if model.nbody != 4 or not free:
            raise InputError(
                "this is not one rigid body that is free to move",
                where=self._where,
                got=f"bodies in the world: {count}, joints: {model.njnt}",
                expected="one body in the world with a free joint or no joint, and no moving body "
                "within it",
                remedy="For bodies on hinges and slides, use Mechanism" if count == 1 else None,
            )
        if not set(model.geom_type[model.geom_bodyid == 1].tolist()) <= set(GEOM_KINDS):
            raise InputError(
                "it has a geom of an unsupported kind",
                where=self._where,
                expected=", ".join(name for name, _ in GEOM_KINDS.values()),
            )
        if not np.any((model.geom_bodyid == 1) & solid_geoms(model)):
            raise InputError(
                "the object has no solid geom",
                where=self._where,
                expected="a geom with contype or conaffinity",
            )
        return model

    @cached_property
    def _measuring(self) -> Any:
        """MuJoCo's data for measuring: the body at the origin, and the block far below. The ball is
        moved for each measurement."""
        data = mujoco.MjData(self._compiled)
        data.qpos[:] = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
        data.mocap_pos[1] = (0.0, 0.0, -2 * _FLOOR)
        return data

    @cached_property
    def _geoms(self) -> list[int]:
        return np.flatnonzero(self._compiled.geom_bodyid == 1).tolist()

    @cached_property
    def _solid(self) -> list[int]:
        model = self._compiled
        return np.flatnonzero((model.geom_bodyid == 1) & solid_geoms(model)).tolist()

    def _distance(self, geom: int, other: str) -> float:
        model = self._compiled
        return float(
            mujoco.mj_geomDistance(model, self._measuring, geom, model.geom(other).id, _FAR, None)
        )


def solid_geoms(model: Any) -> NDArray[np.bool_]:
    """(ngeom,) bool, geoms that can collide: any bit of contype or conaffinity."""
    return np.asarray((model.geom_contype | model.geom_conaffinity) != 0)


def check_object_name(name: str, where: str) -> None:
    """Checks that an object may have a name.

    Raises:
        InputError: The name is not text, is empty, has a line break, or is used by the scene.
    """
    if not isinstance(name, str) or not name or name in _WORLD_NAMES or {"\n", "\r"} & set(name):
        raise InputError("an object cannot have this name", where=where, got=name)


def check_position(position: ArrayLike, where: str) -> None:
    """Checks that a position is three numbers.

    Raises:
        InputError: The position is something else.
    """
    try:
        shape = np.shape(np.asarray(position, float))
    except (TypeError, ValueError):
        shape = ()
    if shape != (3,):
        raise InputError(
            "its position is not three numbers",
            where=where,
            got=repr(position)[:80],
            expected="(x, y, z) in m",
        )


def described_in(mjcf: str | Path, name: str) -> str:
    """Place of a description, for messages: its file, or the object that it describes."""
    return str(mjcf) if _is_file(mjcf) else f"MJCF of {name}"


def unreadable(mjcf: str | Path, name: str, error: Exception) -> InputError:
    """The error for a description that MuJoCo refuses, in one line.

    Args:
        mjcf: The description.
        name: Name of the object that it describes.
        error: MuJoCo's error, whose text names the element and its line.
    """
    where, text = described_in(mjcf, name), " ".join(str(error).split())
    # MuJoCo's error for a missing mesh, texture or include does not contain the folder.
    opened = re.search("Error opening file '([^']+)'", text)
    if opened and not (beside := _folder(mjcf) / opened[1]).exists():
        return InputError(
            "no such file", where=where, got=opened[1], expected=f"a file in {beside.parent}"
        )
    return InputError("MuJoCo cannot read this object", where=where, got=text[:300])


def mesh_assets(model: Any, geoms: list[int], name: str, size: float) -> list[Element]:
    """MJCF assets of the meshes of some geoms, with their points written out.

    Args:
        model: MuJoCo's model of a description.
        geoms: Indices of geoms.
        name: Beginning of the meshes' names.
        size: Factor on all lengths.
    """
    elements = []
    for mesh in sorted({int(model.geom_dataid[g]) for g in geoms} - {-1}):
        points = size * mesh_points(model, mesh)
        faces = model.mesh_face[_part(model.mesh_faceadr, model.mesh_facenum, mesh)]
        values = {
            "name": f"{name}_mesh{mesh}",
            "vertex": mjcf_text(points.ravel()),
            "face": " ".join(map(str, faces.ravel().tolist())),
        }
        if _is_sheet(points, faces):
            # Otherwise MuJoCo would refuse the mesh because it has no volume, although the body's
            # inertia is given.
            values["inertia"] = "shell"
        elements.append(Element("mesh", values))
    return elements


_LEAST_VOLUME = 1e-14
"""Least volume (m3) of a mesh that is a solid. MuJoCo refuses volumes below 1e-15, and meshes whose
triangles face inwards."""


def _is_sheet(points: Array, faces: NDArray[np.int32]) -> bool:
    """True if a mesh has so little volume that MuJoCo refuses it as a solid."""
    corners = points[faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(across, axis=1)  # any order: only decides if there is a volume
    total = max(float(areas.sum()), _LEAST_VOLUME)
    middle = areas @ corners.mean(axis=1) / total  # any order: only decides if there is a volume
    a, b, c = (corners[:, i] - middle for i in range(3))
    return float((a * np.cross(b, c)).sum()) / 6.0 < _LEAST_VOLUME


def mesh_points(model: Any, mesh: int) -> Array:
    """Points (n, 3) m of a mesh of a description, in the frame of its geoms."""
    points: Array = model.mesh_vert[_part(model.mesh_vertadr, model.mesh_vertnum, mesh)]
    return points


def drawn_colour(model: Any, geom: int) -> Array:
    """RGBA (4,) in which MuJoCo draws a geom of a description: the geom's own colour, or that of
    its material if the geom states none."""
    own: Array = model.geom_rgba[geom]
    material = int(model.geom_matid[geom])
    if material < 0 or not np.array_equal(own, _PLAIN_RGBA):
        return own
    of_material: Array = model.mat_rgba[material]
    return of_material


_PLAIN_RGBA = np.array([0.5, 0.5, 0.5, 1.0], np.float32)
"""Colour of a geom that states none."""


def geom_element(
    model: Any, geom: int, name: str, mesh_name: str, size: float, bits: tuple[int, int]
) -> Element:
    """MJCF of a geom of a description.

    Args:
        model: MuJoCo's model of the description.
        geom: Index of the geom.
        name: Its name in the scene.
        mesh_name: Beginning of the names of meshes, as for `mesh_assets`.
        size: Factor on all lengths.
        bits: contype and conaffinity of a solid geom.
    """
    kind, sizes = GEOM_KINDS[int(model.geom_type[geom])]
    element = Element(
        "geom",
        {
            "name": name,
            "type": kind,
            "rgba": mjcf_text(drawn_colour(model, geom)),
            "pos": mjcf_text(size * model.geom_pos[geom]),
            "quat": mjcf_text(model.geom_quat[geom]),
        },
    )
    if sizes:
        element.set("size", mjcf_text(size * model.geom_size[geom, :sizes]))
    else:
        # The first compilation centred the mesh's points and moved the geom accordingly. The second
        # compilation does not change them.
        element.set("mesh", f"{mesh_name}_mesh{int(model.geom_dataid[geom])}")
    if solid_geoms(model)[geom]:
        solid = {
            "contype": str(bits[0]),
            "conaffinity": str(bits[1]),
            "condim": "4",
            "friction": mjcf_text(model.geom_friction[geom]),
            "solref": ".004 1",
            "solimp": ".95 .99 .001",
        }
    else:
        solid = {"contype": "0", "conaffinity": "0"}
    for key, value in solid.items():
        element.set(key, value)
    return element


def _is_file(mjcf: str | Path) -> bool:
    return isinstance(mjcf, Path) or "<" not in mjcf


def _folder(mjcf: str | Path) -> Path:
    """Absolute folder to which relative paths in a description refer."""
    return (Path.cwd() / mjcf).parent if _is_file(mjcf) else Path.cwd()


def read_mjcf(mjcf: str | Path, kind: str) -> Any:
    """MuJoCo's specification of a description. Relative paths in a file start at its folder.

    Args:
        mjcf: A whole description, or the path of a file, relative to the current folder.
        kind: Name of the class that uses the description, for messages.

    Raises:
        InputError: There is no such file.
    """
    if not _is_file(mjcf):
        return _without_references(mujoco.MjSpec.from_string(str(mjcf)))
    if not Path(mjcf).is_file():
        same_folder = f'Path(__file__).parent / "{Path(mjcf).name}"'
        raise InputError(
            "no such file",
            where=kind,
            got=str(mjcf),
            expected=f"a file in {_folder(mjcf)}",
            remedy=f"For a file in the same folder as the task's file, write {same_folder}",
        )
    return _without_references(mujoco.MjSpec.from_file(str(mjcf)))


def _without_references(spec: Any) -> Any:
    """The specification without sensors, contact pairs, contact exclusions and keyframes.

    A scene does not use these elements. If one of them refers to a body, MuJoCo does not merge this
    body with the body to which it is welded.
    """
    for element in (*spec.sensors, *spec.excludes, *spec.pairs, *spec.keys):
        spec.delete(element)
    return spec


def described_files(mjcf: str | Path) -> list[Path]:
    """Files of a description: the file itself, the files that it includes, and its meshes.

    Textures are left out, since objects have none.

    Args:
        mjcf: A whole description, or the path of a file, relative to the current folder.
    """
    found: list[Path] = []
    _find_files(mjcf, [_folder(mjcf)], found)
    return found


def _find_files(mjcf: str | Path, folders: list[Path], found: list[Path]) -> None:
    """Adds the files of a description to `found`; missing files are left out.

    Args:
        mjcf: A description.
        folders: Folders to which file names may be relative. Folders that the description names are
            added.
        found: Files that were found so far.
    """
    if _is_file(mjcf):
        file = Path.cwd() / mjcf
        if file in found or not file.is_file():
            return
        found.append(file)
    try:
        root = ElementTree.fromstring(file.read_bytes() if _is_file(mjcf) else str(mjcf))
    except (ElementTree.ParseError, LookupError, ValueError):
        # MuJoCo refuses such a file, with its line, when the object is compiled.
        return
    # With `strippath`, MuJoCo uses file names alone, without the folders in front of them.
    bare = False
    for compiler in root.iter("compiler"):
        bare = compiler.get("strippath") == "true" or bare
        named = (compiler.get("meshdir"), compiler.get("assetdir"))
        folders += [folders[0] / name for name in named if name]
    for element in root.iter():
        name = element.get("file")
        if name and element.tag != "texture":
            inside = re.split(r"[/\\]", name)[-1] if bare else name
            for place in [folder / inside for folder in folders]:
                if element.tag == "include":
                    _find_files(place, folders, found)
                elif element.tag == "model":
                    # Names in a model's file are relative to the folder of that file.
                    _find_files(place, [place.parent], found)
                elif place.is_file() and place not in found:
                    found.append(place)


def _part(starts: Any, counts: Any, i: int) -> slice:
    return slice(int(starts[i]), int(starts[i]) + int(counts[i]))
