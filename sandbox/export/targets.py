"""Targets of an export: files, whose ending chooses the format, and the view that writes the
motion of a running or replayed session to them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from models.errors import InputError
from models.motion.armature import Armature, Keys
from models.motion.asf import AmcWriter
from models.motion.bvh import BvhWriter
from models.motion.c3d import C3dWriter
from models.motion.gltf import GltfWriter
from models.motion.output import MotionWriter
from models.motion.points import HandPoints, PointsCsvWriter
from models.motion.sampling import Poses, Sampler
from models.motion.vicon_v import VWriter
from models.motion.vsk import VskWriter
from sandbox.export.sources import Of, commanded_poses, poses_of_qpos
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session


@dataclass(frozen=True)
class ExportSettings:
    """Settings of written motion.

    Attributes:
        rate: Rate of the keyframes, Hz.
        euler: Order of Euler angles, for formats that allow a choice.
        points: Content of point files: `tips`, or `joints` for joints and tips.
        fingers: Labels of the fingers in point files.
    """

    rate: float = 60.0
    euler: str = "ZXY"
    points: str = "tips"
    fingers: tuple[int, ...] = (0, 1, 2, 3, 4)


Maker = Callable[[Path, Sequence[Armature], Sequence[str], ExportSettings], MotionWriter]


def _bvh(
    path: Path, hands: Sequence[Armature], names: Sequence[str], settings: ExportSettings
) -> MotionWriter:
    return BvhWriter(path, hands[0], settings.rate, settings.euler)


def _glb(
    path: Path, hands: Sequence[Armature], names: Sequence[str], settings: ExportSettings
) -> MotionWriter:
    return GltfWriter(path, tuple(hands), settings.rate, tuple(f"{n} hand" for n in names))


def _amc(
    path: Path, hands: Sequence[Armature], names: Sequence[str], settings: ExportSettings
) -> MotionWriter:
    return AmcWriter(path, hands[0], settings.rate)


def _v(
    path: Path, hands: Sequence[Armature], names: Sequence[str], settings: ExportSettings
) -> MotionWriter:
    return VWriter(path, hands[0], settings.rate, names[0])


def _vsk(
    path: Path, hands: Sequence[Armature], names: Sequence[str], settings: ExportSettings
) -> MotionWriter:
    return VskWriter(path, hands[0])


def _c3d(
    path: Path, hands: Sequence[Armature], names: Sequence[str], settings: ExportSettings
) -> MotionWriter:
    return C3dWriter(path, _points(hands, names, settings), settings.rate)


def _csv(
    path: Path, hands: Sequence[Armature], names: Sequence[str], settings: ExportSettings
) -> MotionWriter:
    return PointsCsvWriter(path, _points(hands, names, settings), settings.rate)


def _points(
    hands: Sequence[Armature], names: Sequence[str], settings: ExportSettings
) -> HandPoints:
    return HandPoints(hands, names, settings.points == "joints", settings.fingers)


@dataclass(frozen=True)
class Format:
    """A file format.

    Attributes:
        make: Function that opens a writer.
        all_hands: True if one file holds all hands; False if each hand needs its own file.
        heeds: Fields of `ExportSettings`, besides the rate, that affect this format.
    """

    make: Maker
    all_hands: bool
    heeds: tuple[str, ...] = ()


FORMATS: dict[str, Format] = {
    ".bvh": Format(_bvh, False, ("euler",)),  # skeleton and motion, y up, cm, degrees
    ".glb": Format(_glb, True),  # skinned hands in motion, y up, m, quaternions
    ".amc": Format(_amc, False),  # motion, with its skeleton in .asf; y up, cm, degrees
    ".asf": Format(_amc, False),  # the same
    ".v": Format(_v, False),  # motion, with its skeleton in .vsk; z up, mm, rad
    ".vsk": Format(_vsk, False),  # the skeleton alone
    ".c3d": Format(_c3d, True, ("points", "fingers")),  # points in motion, z up, mm
    ".csv": Format(_csv, True, ("points", "fingers")),  # points in motion, z up, m
}


_FROM_BLENDER = (
    "Blender writes it. Make the script with `sandbox stream --script blender > "
    "hand_sandbox_blender.py`, run it with --out FILE, and stream the recording to it "
    "(docs/stream.md)"
)


def format_of(path: Path) -> Format:
    """Returns the format of a file's suffix.

    Raises:
        InputError: The suffix is unknown.
    """
    export_format = FORMATS.get(path.suffix.lower())
    if export_format is None:
        raise InputError(
            "this kind of file cannot be written",
            where=str(path),
            got=path.suffix or "no ending",
            expected=", ".join(FORMATS),
            remedy=_FROM_BLENDER if path.suffix.lower() in (".fbx", ".blend") else None,
        )
    return export_format


class Exporter:
    """Resamples poses and writes keyframes, to one file or to one file per hand.

    It must be used in a `with` block; the files appear when the block ends without an error.

    Args:
        path: Path of the file. If there are two hands and the format holds only one hand, each
            file's name gets the name of its hand.
        armatures: Armatures of the hands.
        names: Names of the hands.
        settings: Settings of written motion.

    Raises:
        InputError: The file cannot be written, or not with these settings.
    """

    def __init__(
        self,
        path: Path,
        armatures: Sequence[Armature],
        names: Sequence[str],
        settings: ExportSettings,
    ) -> None:
        chosen = format_of(path)
        self._open = ExitStack()
        if not path.absolute().parent.is_dir():
            raise InputError("no such folder", where=str(path), remedy="Make it, or name another")
        self._sampler = Sampler(tuple(armatures), settings.rate)
        self.writers: list[tuple[MotionWriter, tuple[int, ...]]] = []
        with ExitStack() as undo:
            for file, hands in _files(path, names, chosen.all_hands):
                some = [armatures[i] for i in hands]
                writer = chosen.make(file, some, [names[i] for i in hands], settings)
                undo.callback(writer.abort)
                self.writers.append((writer, hands))
            undo.pop_all()
        for writer, _ in self.writers:
            self._open.enter_context(writer)

    @property
    def frames(self) -> int:
        """Number of keyframes written so far."""
        return self.writers[0][0].frames

    @property
    def paths(self) -> list[Path]:
        """The files."""
        return [path for writer, _ in self.writers for path in writer.paths]

    def take(self, poses: Poses) -> None:
        """Resamples poses and writes the keyframes up to the last pose."""
        keys = self._sampler.add(poses)
        if keys is not None:
            self.write(keys)

    def write(self, keys: Sequence[Keys]) -> None:
        """Writes keyframes of all hands."""
        for writer, hands in self.writers:
            writer.write(*(keys[i] for i in hands))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._open.__exit__(kind, error, trace)


def _files(path: Path, names: Sequence[str], all_hands: bool) -> list[tuple[Path, tuple[int, ...]]]:
    """Files, and the hands that each holds."""
    every = tuple(range(len(names)))
    if all_hands or len(names) == 1:
        return [(path, every)]
    return [(path.with_stem(f"{path.stem}-{name}"), (i,)) for i, name in enumerate(names)]


def simulated_poses(snapshot: Snapshot) -> Poses:
    """Poses of all hands at one moment."""
    return poses_of_qpos(np.array([snapshot.time]), snapshot.qpos[None], len(snapshot.hands))


class MotionView(Exporter):
    """Writes the motion of a session's hands; the files appear when it is closed.

    If a session is stopped (Ctrl-C), the motion written so far is kept.

    Args:
        path: Path of the file; its ending chooses the format.
        session: The session.
        settings: Settings of written motion.
        of: Simulated or commanded motion of the hands.

    Raises:
        InputError: The file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        session: Session,
        settings: ExportSettings | None = None,
        of: Of = "simulated",
    ) -> None:
        hands = [rig.hand for rig in session.rigs]
        self._poses = simulated_poses if of == "simulated" else commanded_poses
        armatures = tuple(Armature.of_hand(hand) for hand in hands)
        names = tuple(hand.name for hand in hands)
        super().__init__(path, armatures, names, settings or ExportSettings())

    def show(self, snapshot: Snapshot) -> None:
        """Writes the motion up to a snapshot."""
        self.take(self._poses(snapshot))

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        stopped = kind is not None and issubclass(kind, KeyboardInterrupt)
        if stopped and self.frames:
            kind, error, trace = None, None, None
        super().__exit__(kind, error, trace)
