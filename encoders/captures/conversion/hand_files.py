"""Reads hands from files of motion capture, and mapping files for their names."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
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
from encoders.captures.conversion.sites import mapped, recognised, sites_of
from models.arithmetic.arrays import Array
from models.errors import CaptureError, InputError
from models.json_input import checked, decoded, read_bytes
from models.motion.motion import Motion
from models.motion.read.asf import read_amc, read_asf
from models.motion.read.bvh import CENTIMETRE, read_bvh
from models.motion.read.markers import MILLIMETRE, read_markers
from models.motion.read.pose_table import read_pose_table
from models.motion.read.vicon_v import motion_of, read_v
from models.motion.read.vsk import MILLIMETRE as VSK_MILLIMETRE
from models.motion.read.vsk import read_vsk
from models.pose import mirrored
from models.reader_report import ReaderReport
from models.skeleton import ADULT

SKELETONS = {"amc": ".asf", "v": ".vsk"}
"""Suffix of a motion file -> suffix of its skeleton file."""

_Coordinate = Annotated[float, Meta(ge=-1e9, le=1e9)]
Place = tuple[_Coordinate, _Coordinate, _Coordinate]
"""Three coordinates in a recording's units."""


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
        points: Name in the recording -> site, or a table with bone and position; empty: names are
            recognised.
        corners: Corners of the surface, each three numbers in the recording's units or the name of
            a point; empty: unknown.
    """

    points: dict[str, Any] = field(default_factory=dict)
    corners: tuple[str | Place, ...] = ()


def read_mapping(path: Path | None) -> Mapping:
    """Reads a mapping file, TOML or JSON.

    Raises:
        InputError: The file cannot be read, or has other content.
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
    unit: float | None,
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
        left: True for a left hand, which is mirrored into a right one.
        unit: Unit of length of the file in m; None: the usual one of its format.
        scale: Size of the hand in a CSV file relative to the adult hand; else the size is fitted.
        find_surface: True if an unknown surface may be estimated from fingertips.
        tolerance: m; distance from that surface within which a fingertip rests on it.
        progress: Called with the share done, 0 to 1.
        skeleton_file: `.asf` of an `.amc`, `.vsk` of a `.v`; None: the file of the same name.
        rate: Hz of an `.amc`, which does not store it.

    Raises:
        InputError: The file is unusable.
    """
    reading = ReaderReport()
    suffix = path.name.lower().removesuffix(".gz").rpartition(".")[2]
    if suffix == "csv":
        time, q = read_pose_table(path, reading)
        report.add_reading(reading)
        skeleton = ADULT.scaled(scale) if scale != 1.0 else ADULT
        return JointTrack(time, mirrored(q) if left else q, skeleton)
    if suffix == "bvh":
        unit = unit or CENTIMETRE
        motion = read_bvh(path, unit)
        reading, time, points = motion.report, motion.time, _points_of(motion)
    elif suffix in SKELETONS:
        motion, unit = _with_skeleton(path, suffix, skeleton_file, unit, rate)
        reading, time, points = motion.report, motion.time, _points_of(motion)
    elif suffix == "tsv":
        unit = unit or MILLIMETRE
        tracks = read_markers(path, unit)
        reading, time = tracks.report, tracks.time
        points = {name: tracks.places[:, m] for m, name in enumerate(tracks.names)}
    else:
        raise InputError(
            "this kind of file is not known",
            where=str(path),
            expected=".bvh, .amc, .v, .csv, .tsv, .tsv.gz",
            remedy="A skeleton (.asf, .vsk) does not move; give the motion (.amc, .v)"
            if f".{suffix}" in SKELETONS.values()
            else None,
        )
    report.add_reading(reading)
    if mapping.points:
        sites = mapped(mapping.points, list(points), ADULT)
    else:
        known = sites_of(ADULT)
        names = recognised(list(points), "left" if left else "right", ADULT)
        sites = {name: known[site] for name, site in names.items()}
    frame = _surface(mapping, points, unit, find_surface, path)
    return joints_from_points(
        time,
        points,
        sites,
        frame,
        ADULT,
        report,
        left=left,
        tolerance=tolerance,
        progress=progress,
    )


def _with_skeleton(
    path: Path, kind: str, skeleton: Path | None, unit: float | None, rate: float | None
) -> tuple[Motion, float]:
    """Reads a motion and the skeleton in another file; also returns their unit of length, m."""
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
    """Returns positions of joints by name, and of the ends of bones as `NAME end`."""
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
    """Returns a corner (3,), m, given by three numbers or by the name of a point on it."""
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
