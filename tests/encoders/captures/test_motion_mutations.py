"""Motion files of all formats that jump or are mirrored are read equal, reported or refused."""

from __future__ import annotations

import gzip
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from encoders.captures.conversion import ConversionReport
from encoders.captures.conversion.hand_files import Mapping, read_hand, read_points, read_poses
from models.arithmetic import Array
from models.errors import InputError
from models.motion.asf import AmcWriter
from models.motion.bvh import BvhWriter
from models.motion.vicon_v import VWriter
from models.plausible import JUMPED, POINT_JUMPED
from models.pose import mirrored
from models.reader_report import ReaderReport
from tests.support.hand_recording import (
    RATE,
    Truth,
    markers,
    played,
    write_pose_table,
    write_tsv,
)
from tests.support.motion_poses import written

WRITERS: dict[str, Callable[..., Any]] = {"bvh": BvhWriter, "amc": AmcWriter, "v": VWriter}
KINDS = (*WRITERS, "tsv", "csv")
FRAMES = 120

each = settings(
    max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
directions = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)


class Read(NamedTuple):
    """A motion: times (T,) s, places of points or the root (T, n), NaN where left out."""

    time: Array
    places: Array
    report: ReaderReport


def write(folder: Path, kind: str, truth: Truth) -> Path:
    """A hand's motion as a file of a kind."""
    path = folder / f"hand.{kind}"
    if kind == "tsv":
        write_tsv(path, markers(truth))
    elif kind == "csv":
        write_pose_table(path, truth.time, truth.q)
    else:
        written(lambda a: WRITERS[kind](path, a, RATE), truth.skeleton, truth.q)
    return path


def read(path: Path) -> Read:
    if path.suffix == ".csv":
        report = ReaderReport()
        time, q = read_poses(path, "", report)
        return Read(time, q[:, :3], report)
    found = read_points(path, Mapping())
    places = np.concatenate([found.points[name] for name in sorted(found.sites)], axis=1)
    return Read(found.time, places, found.report)


@pytest.fixture(scope="module")
def truth() -> Truth:
    whole = played(8.0, seed=3)
    some = slice(0, FRAMES)
    return Truth(whole.time[some], whole.down[some], whole.xy[some], whole.q[some], whole.skeleton)


def moved(truth: Truth, frames: slice, way: tuple[float, float, float]) -> Truth:
    """The hand a metre away in some frames."""
    q = truth.q.copy()
    q[frames, :3] += np.array(way) / np.linalg.norm(way)
    return replace(truth, q=q)


@each
@given(kind=st.sampled_from(KINDS), at=st.integers(1, FRAMES - 2), way=directions)
def test_a_frame_moved_by_a_metre_is_left_out_and_counted_and_costs_no_other(
    truth: Truth, tmp_path: Path, kind: str, at: int, way: tuple[float, float, float]
) -> None:
    whole = read(write(tmp_path, kind, truth))
    assert not whole.report
    found = read(write(tmp_path, kind, moved(truth, slice(at, at + 1), way)))
    assert found.report.left_out == {JUMPED: 1} and not found.report.assumed
    others = np.delete(np.arange(FRAMES), at)
    if len(found.time) == FRAMES:
        assert np.isnan(found.places[at]).all()
        np.testing.assert_allclose(found.places[others], whole.places[others], atol=1e-6)
    else:
        np.testing.assert_allclose(found.time, whole.time[others])
        np.testing.assert_allclose(found.places, whole.places[others], atol=1e-6)


@each
@given(
    kind=st.sampled_from(KINDS),
    at=st.integers(0, FRAMES - 1),
    count=st.integers(1, FRAMES),
    way=directions,
)
def test_any_stretch_moved_by_a_metre_is_reported_or_the_whole_is_moved(
    truth: Truth, tmp_path: Path, kind: str, at: int, count: int, way: tuple[float, float, float]
) -> None:
    away = moved(truth, slice(at, at + count), way)
    whole_or_none = at == 0 and count >= FRAMES
    assert bool(read(write(tmp_path, kind, away)).report.left_out[JUMPED]) != whole_or_none


@each
@given(at=st.integers(1, FRAMES - 2), marker=st.integers(0, 11), way=directions)
def test_a_marker_that_jumps_costs_no_other(
    truth: Truth, tmp_path: Path, at: int, marker: int, way: tuple[float, float, float]
) -> None:
    points = markers(truth)
    name = sorted(points)[marker]
    points[name][at] += np.array(way) / np.linalg.norm(way)
    path = tmp_path / "hand.tsv"
    write_tsv(path, points)
    found = read(path)
    assert found.report.line() == f"left out: 1 {POINT_JUMPED}"
    assert np.isnan(found.places[at]).sum() == 3 and np.isnan(found.places).sum() == 3


MIRROR = {"xposition": -1, "yrotation": -1, "zrotation": -1}


def mirrored_bvh(text: str) -> str:
    """A BVH file whose hands are those of a mirror across x = 0, under their old names."""
    signs: list[int] = []
    lines = []
    for line in text.splitlines():
        words = line.split()
        if words[:1] == ["OFFSET"]:
            line = f"OFFSET {-float(words[1])} {words[2]} {words[3]}"
        elif words[:1] == ["CHANNELS"]:
            signs += [MIRROR.get(channel.lower(), 1) for channel in words[2:]]
        elif words and re.fullmatch(r"[-+.\deE]+", words[0]):
            line = " ".join(str(s * float(w)) for s, w in zip(signs, words, strict=True))
        lines.append(line)
    return "\n".join(lines) + "\n"


def converted(path: Path, side: str) -> ConversionReport:
    """The report on a hand that is fitted in the file's own frame."""
    report = ConversionReport()
    corners = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    read_hand(
        path,
        Mapping(corners=corners),
        report,
        left=side == "left",
        unit="",
        scale=1.0,
        find_surface=False,
        tolerance=0.003,
        progress=lambda _: None,
    )
    return report


@pytest.mark.parametrize("kind", WRITERS)
def test_a_mirrored_hand_is_doubted_and_refused_and_is_the_other_one_of_a_mirror(
    truth: Truth, tmp_path: Path, kind: str
) -> None:
    other = replace(truth, q=mirrored(truth.q), skeleton=truth.skeleton.mirrored())
    path = write(tmp_path, kind, other)
    assert "the right hand is a left hand" in read_points(path, Mapping()).report.line()
    assert not read_points(path, Mapping(), left=True).report
    with pytest.raises(InputError, match="the right hand is a left hand"):
        converted(path, "right")
    assert "file" not in converted(path, "left").notes


REAL = ("fingers.bvh", "hand-markers.tsv.gz")


@pytest.mark.parametrize("name", REAL)
def test_real_recordings_give_no_report(shared_data: Path, name: str) -> None:
    for left in (False, True) if name.endswith("bvh") else (False,):
        assert not read_points(shared_data / "formats" / name, Mapping(), left).report


def test_a_real_hand_in_a_mirror_is_doubted_or_refused(shared_data: Path, tmp_path: Path) -> None:
    path = tmp_path / "fingers.bvh"
    path.write_text(mirrored_bvh((shared_data / "formats" / "fingers.bvh").read_text()))
    with pytest.raises(InputError):
        converted(path, "right")
    lines = gzip.decompress((shared_data / "formats" / "hand-markers.tsv.gz").read_bytes())
    rows = [line.split("\t") for line in lines.decode().splitlines()]
    numbers = [row for row in rows if re.fullmatch(r"-?[\d.]+", row[0])]
    for row in numbers:
        row[2::3] = [str(-float(x)) if x else x for x in row[2::3]]
    packed = tmp_path / "hand.tsv"
    packed.write_text("\n".join("\t".join(row) for row in rows) + "\n")
    with pytest.raises(InputError):
        converted(packed, "right")
