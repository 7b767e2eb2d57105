"""Reads hands from motion capture files, and the mapping files that explain their names."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import combinations, product
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from msgspec import Meta, Struct

from encoders.captures.conversion import (
    ConversionReport,
    JointTrack,
    SurfaceFrame,
    frame_from_corners,
    joints_from_points,
)
from encoders.captures.conversion.sites import PALM, Site, mapped, recognised, sites_of
from models.arithmetic import Array
from models.errors import CaptureError, InputError, MotionError
from models.frames import FINGERS
from models.json_input import checked, decoded, read_bytes
from models.motion.asf import read_amc, read_asf
from models.motion.bvh import CENTIMETRE, read_bvh
from models.motion.markers import MILLIMETRE, read_markers
from models.motion.motion import Motion
from models.motion.pose_table import read_pose_table
from models.motion.vicon_v import motion_of, read_v
from models.motion.vsk import MILLIMETRE as VSK_MILLIMETRE
from models.motion.vsk import read_vsk
from models.plausible import (
    ANGLE,
    HAND,
    HEIGHT,
    JUMPED,
    POINT_JUMPED,
    STEP,
    UNITS,
    SideDoubt,
    find_jumps,
    find_units,
    parse_units,
    unit_size,
)
from models.pose import ROOT_POSITION, joint_vectors, mirrored
from models.reader_report import ReaderReport
from models.skeleton import ADULT

SKELETONS = {"amc": ".asf", "v": ".vsk"}
"""Suffix of a motion file -> suffix of its skeleton file."""

_Coordinate = Annotated[float, Meta(ge=-1e9, le=1e9)]
Place = tuple[_Coordinate, _Coordinate, _Coordinate]
"""A point: three coordinates in the recording's units."""


class _Corners(Struct, forbid_unknown_fields=True):
    """Table [surface] of a mapping file."""

    top_left: str | Place
    top_right: str | Place
    bottom_left: str | Place


class _MappingFile(Struct, forbid_unknown_fields=True):
    """A mapping file; values of points are checked when they are used."""

    points: dict[str, Any] = {}
    surface: _Corners | None = None


@dataclass(frozen=True)
class Mapping:
    """Content of a mapping file.

    Attributes:
        points: Name in the recording -> site, or a table with bone and position. Empty if the
            names are to be recognised.
        corners: Corners of the surface, each as three numbers in the recording's units or as the
            name of a point. Empty if they are unknown.
    """

    points: dict[str, Any] = field(default_factory=dict)
    corners: tuple[str | Place, ...] = ()


def read_mapping(path: Path | None) -> Mapping:
    """Reads a mapping file, TOML or JSON.

    Raises:
        InputError: The file cannot be read, or its content is not a mapping.
    """
    if path is None:
        return Mapping()
    what, where, tables = "the mapping is damaged", str(path), "tables [points] and [surface]"
    data = read_bytes(path, InputError, what="the mapping cannot be read")
    if path.suffix.lower() == ".json":
        file = decoded(data, _MappingFile, InputError, what=what, where=where, expected=tables)
    else:
        try:
            values = tomllib.loads(data.decode())
        except (ValueError, RecursionError) as error:
            raise InputError(f"{what}: {error}", where=where, expected=tables) from None
        file = checked(values, _MappingFile, InputError, what=what, where=where, expected=tables)
    corners = file.surface
    if corners is None:
        return Mapping(file.points)
    return Mapping(file.points, (corners.top_left, corners.top_right, corners.bottom_left))


def read_hand(
    path: Path,
    mapping: Mapping,
    report: ConversionReport,
    *,
    left: bool,
    unit: str,
    scale: float,
    find_surface: bool,
    tolerance: float,
    progress: Callable[[float], None],
    skeleton_file: Path | None = None,
    rate: float | None = None,
) -> JointTrack:
    """Reads the poses in a file, whose suffix decides the format.

    Args:
        path: `.bvh`, `.amc`, `.v`, `.csv`, or `.tsv` and `.tsv.gz`.
        mapping: Meaning of the names in the file.
        report: Collects residuals and counts.
        left: True for a left hand, which is mirrored into a right hand.
        unit: Units of the file, such as `cm`, `cm,ms` or a number of metres. If a unit is not
            given, it is the format's usual unit. If the hand then has no plausible size, the unit
            that gives a plausible size is used.
        scale: Size of the hand in a CSV file relative to the adult hand. In other files the size
            is fitted.
        find_surface: True if an unknown surface may be estimated from fingertips.
        tolerance: Distance (m) from the estimated surface within which a fingertip rests on it.
        progress: Called with the share done, 0 to 1.
        skeleton_file: `.asf` of an `.amc`, `.vsk` of a `.v`; None takes the file of the same name.
        rate: Frame rate (Hz) of an `.amc`, which does not store it.

    Raises:
        InputError: The file is unusable.
    """
    if _kind(path) == "csv":
        reading = ReaderReport()
        time, q = read_poses(path, unit, reading)
        report.add_reading(reading)
        skeleton = ADULT.scaled(scale) if scale != 1.0 else ADULT
        return JointTrack(time, mirrored(q) if left else q, skeleton)
    read = read_points(path, mapping, left, unit, skeleton_file, rate)
    report.add_reading(read.report)
    frame = _surface(mapping, read.points, read.unit, find_surface, path)
    try:
        return joints_from_points(
            read.time,
            read.points,
            read.sites,
            frame,
            ADULT,
            report,
            left=left,
            tolerance=tolerance,
            progress=progress,
        )
    except CaptureError as error:
        if not read.report:
            raise
        # The likely reasons are frames that the reader left out, and its assumptions.
        raise CaptureError(
            error.what,
            where=error.where or str(path),
            got=error.got,
            expected=error.expected,
            remedy=". ".join(filter(None, (error.remedy, f"In the file: {read.report.line()}"))),
        ) from None


@dataclass(frozen=True)
class HandPoints:
    """Points of a hand in a file.

    Attributes:
        time: (T,) s.
        points: Name -> (T, 3) m, NaN where a point was not seen.
        sites: Name -> place on the hand, for the points that are used.
        unit: The file's unit of length (m).
        report: Rows that were left out, and assumptions that were made.
    """

    time: Array
    points: dict[str, Array]
    sites: dict[str, Site]
    unit: float
    report: ReaderReport


def read_points(
    path: Path,
    mapping: Mapping,
    left: bool = False,
    unit: str = "",
    skeleton_file: Path | None = None,
    rate: float | None = None,
) -> HandPoints:
    """Reads the points of the hand in a file other than a table of poses; see `read_hand`.

    Raises:
        InputError: The file is unusable, or the hand has a plausible size in no unit.
    """
    metres, given = _given(unit)
    suffix = _kind(path)
    if suffix == "bvh":
        metre = metres or CENTIMETRE
        motion = read_bvh(path, metre)
        reading, time, points = motion.report, motion.time, _points_of(motion)
    elif suffix in SKELETONS:
        motion, metre = _with_skeleton(path, suffix, skeleton_file, metres, rate)
        reading, time, points = motion.report, motion.time, _points_of(motion)
    elif suffix == "tsv":
        metre = metres or MILLIMETRE
        tracks = read_markers(path, metre)
        reading, time = tracks.report, tracks.time
        points = {name: tracks.places[:, m] for m, name in enumerate(tracks.names)}
    else:
        raise InputError(
            "files of this kind cannot be read",
            where=str(path),
            expected=".bvh, .amc, .v, .csv, .tsv, .tsv.gz",
            remedy="A skeleton (.asf, .vsk) does not move; give the motion (.amc, .v)"
            if f".{suffix}" in SKELETONS.values()
            else None,
        )
    if mapping.points:
        sites = mapped(mapping.points, list(points), ADULT)
    else:
        known = sites_of(ADULT)
        names = recognised(list(points), "left" if left else "right", ADULT)
        sites = {name: known[site] for name, site in names.items()}
    seen = {STEP: np.diff(time)}
    declared = {"time": "s"}
    named = [name for name, size in UNITS["length"].items() if size == metre]
    if metres is None:
        lengths = _hand_lengths(points, sites)
        if named:
            seen[HAND] = lengths / metre
            declared["length"] = named[0]
        elif len(lengths) and not HAND.includes(length := float(np.median(lengths))):
            # The skeleton states its unit as a number, so no named unit can replace it.
            raise MotionError(
                f"{HAND.name} is impossible in the unit that the skeleton states",
                where=str(path),
                got=f"{length:.3g} m",
                expected=f"{HAND.least:g} to {HAND.most:g} m",
                remedy="Give the unit with --unit: m, cm, mm, in, or a number of metres",
            )
    units = find_units(seen, declared, given, where=str(path), report=reading, error=MotionError)
    if "length" in units:
        factor = unit_size(units, "length") / metre
        points = {name: factor * places for name, places in points.items()}
        metre *= factor
    time = time * unit_size(units, "time")
    points = points | _without_jumps(time, {name: points[name] for name in sites}, reading)
    if doubt := _side_doubt("left" if left else "right", points, sites):
        reading.assume(doubt)
    return HandPoints(time, points, sites, metre, reading)


def _without_jumps(
    time: Array, points: dict[str, Array], reading: ReaderReport
) -> dict[str, Array]:
    """Points (T, 3) m of a hand, with NaN where they jump; jumps are counted in `reading`."""
    places = np.stack(list(points.values()), axis=1)
    jumped = find_jumps(time, places)
    if not jumped.any():
        return points
    # If more than half of the visible points jump in a frame, the whole frame is left out.
    seen = np.isfinite(places).all(axis=2)
    whole = jumped.any(axis=1) & (2 * jumped.sum(axis=1) > seen.sum(axis=1))
    reading.leave_out(JUMPED, int(whole.sum()))
    reading.leave_out(POINT_JUMPED, int(jumped[~whole].sum()))
    jumped |= whole[:, None]
    return {
        name: np.where(jumped[:, m, None], np.nan, places[:, m]) for m, name in enumerate(points)
    }


_SHOWING = (("mcp",), ("pip", "dip"), ("dip", "pip"), ("tip",))
"""Points of a finger that show how it bends; the second name is used if a file lacks the first."""


def _side_doubt(side: str, points: dict[str, Array], sites: dict[str, Site]) -> str:
    """Sentence that states why the hand may not be of the given side.

    The sentence is empty if there is no doubt, or if the points do not show how at least two
    fingers bend.
    """
    named = {site.name: name for name, site in sites.items()}
    fingers = []
    for finger, end in product(FINGERS[1:], ("", "_skin")):
        shown = [[f"{finger}_{level}{end}" for level in levels] for levels in _SHOWING]
        found = [next((named[at] for at in choice if at in named), None) for choice in shown]
        if None not in found:
            some = [points[name][_sampled(len(points[name]))] for name in found if name]
            fingers.append(np.stack(some, axis=1))
    doubt = SideDoubt()
    if len(fingers) > 1:
        doubt.look_through(side, np.stack(fingers, axis=1))
    return doubt.sentence


def _kind(path: Path) -> str:
    """The suffix of a file without its dot, in lower case and without a final `.gz`."""
    return path.name.lower().removesuffix(".gz").rpartition(".")[2]


def _given(unit: str) -> tuple[float | None, dict[str, str]]:
    """The unit of length in m (None if it is not given), and the named units by quantity.

    Raises:
        InputError: The text is not a list of units.
    """
    numbers = [part for part in unit.split(",") if part.strip()[:1].isdigit()]
    if not numbers:
        given = parse_units(unit)
        return (unit_size(given, "length") if "length" in given else None), given
    given = parse_units(",".join(part for part in unit.split(",") if part not in numbers))
    try:
        (metre,) = map(float, numbers)
        if "length" in given or not 0.0 < metre < 1000.0:
            raise ValueError
    except ValueError:
        raise InputError(
            "not a unit",
            where="--unit",
            got=unit,
            expected="m, cm, mm, in, or a number of metres below 1000; s, ms, us, ns",
        ) from None
    return metre, given


def _sampled(count: int) -> slice:
    """Slice of about `_SAMPLE` of `count` frames, from which units are determined."""
    return slice(None, None, count // _SAMPLE + 1)


_SAMPLE = 200


def _hand_lengths(points: dict[str, Array], sites: dict[str, Site]) -> Array:
    """Hand lengths (n,) m, estimated in each frame from the two palm points farthest apart."""
    palm = {name: site.at for name, site in sites.items() if site.bone == PALM}
    a, b = max(combinations(palm, 2), key=lambda pair: math.dist(palm[pair[0]], palm[pair[1]]))
    some = _sampled(len(points[a]))
    apart = np.linalg.norm(points[a][some] - points[b][some], axis=1)
    return apart[np.isfinite(apart)] * (_ADULT_LENGTH / math.dist(palm[a], palm[b]))


_ADULT_LENGTH = 0.19
"""Length (m) of a hand with the adult skeleton."""


def read_poses(path: Path, unit: str, reading: ReaderReport) -> tuple[Array, Array]:
    """Reads times (T,) s and poses (T, 48) from a table of poses in any units.

    Args:
        path: The file.
        unit: Units given by the user.
        reading: Receives the rows left out and the assumptions made.

    Raises:
        MotionError: The table is unusable, or its poses are possible in no unit.
    """
    _, given = _given(unit)
    time, q = read_pose_table(path, reading)
    some = q[_sampled(len(q))]
    seen = {
        STEP: np.diff(time),
        HEIGHT: np.abs(some[:, 2]),
        ANGLE: np.linalg.norm(joint_vectors(some), axis=-1).max(axis=1),
    }
    declared = {"time": "s", "length": "m", "angle": "rad"}
    units = find_units(seen, declared, given, where=str(path), report=reading, error=MotionError)
    if units != declared:
        q = q * unit_size(units, "angle")
        q[:, ROOT_POSITION] *= unit_size(units, "length") / unit_size(units, "angle")
    time = time * unit_size(units, "time")
    jumped = find_jumps(time, q[:, None, ROOT_POSITION])[:, 0]
    reading.leave_out(JUMPED, int(jumped.sum()))
    return (time[~jumped], q[~jumped]) if jumped.any() else (time, q)


def _with_skeleton(
    path: Path, kind: str, skeleton: Path | None, unit: float | None, rate: float | None
) -> tuple[Motion, float]:
    """Reads a motion and its skeleton from two files; also returns their unit of length (m)."""
    beside = skeleton or path.with_suffix(SKELETONS[kind])
    if not beside.exists():
        raise InputError(
            "the skeleton file is missing",
            where=str(path),
            got=str(beside),
            remedy=f"Put it there, or give --skeleton FILE{SKELETONS[kind]}",
        )
    if kind == "amc":
        bones = read_asf(beside, unit)
        return read_amc(path, bones, rate), bones.unit
    unit = unit or VSK_MILLIMETRE
    return motion_of(path, read_vsk(beside, unit), read_v(path), unit), unit


def _points_of(motion: Motion) -> dict[str, Array]:
    """Positions of joints by name, and positions of the ends of bones as `NAME end`."""
    placed = motion.place()
    points = {name: placed.positions[:, j] for j, name in enumerate(motion.names)}
    for j, name in enumerate(motion.names):
        if np.isfinite(motion.ends[j]).all():
            points[f"{name} end"] = placed.ends[:, j]
    return points


def _surface(
    mapping: Mapping, points: dict[str, Array], unit: float, find: bool, path: Path
) -> SurfaceFrame | None:
    if mapping.corners:
        return frame_from_corners(*(_corner(corner, points, unit) for corner in mapping.corners))
    if not find:
        raise CaptureError(
            "the position of the touch surface in this recording is unknown",
            where=str(path),
            remedy="Give a --mapping file with [surface] top_left, top_right and bottom_left, "
            "each [x, y, z] in the recording's units or a point's name",
        )
    return None


def _corner(corner: str | Place, points: dict[str, Array], unit: float) -> Array:
    """A corner (3,) m, from three numbers or from the name of a point at the corner."""
    if not isinstance(corner, str):
        return unit * np.array(corner)
    seen = points.get(corner, np.full((1, 3), np.nan))
    seen = seen[np.isfinite(seen).all(axis=1)]
    if not len(seen):
        raise InputError(
            "unknown corner",
            where="[surface]",
            got=corner[:40],
            expected="three numbers, or the name of a visible point",
        )
    return np.asarray(np.median(seen, axis=0))
