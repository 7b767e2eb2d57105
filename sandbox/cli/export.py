"""`sandbox export`: writes the motion of hands, and data sets of demonstrations, for other
programs."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from rich.console import Console
from rich.progress import Progress

from models.errors import InputError
from models.frames import FINGERS
from models.message import counted
from models.motion.bvh import BvhWriter
from models.motion.sampling import Poses
from sandbox.cli.common.command_line import SEVERAL, parse
from sandbox.datasets.data_set import NAMED, is_data_set
from sandbox.export.leap_source import Hand
from sandbox.export.sources import Of, open_source
from sandbox.export.targets import FORMATS, Exporter, ExportSettings, format_of
from sandbox.recording.recording import is_dump, is_recording, stored
from sandbox.recording.versions import bytes_digest
from sandbox.study.record.copies import JOURNAL
from sandbox.study.record.folder import is_study
from sandbox.study.record.journal import read_journal
from sandbox.study.record.state import SessionState
from sandbox.study.record.trial_files import find_recordings
from sandbox.system.files import resolved

Finger = Literal["thumb", "index", "middle", "ring", "little"]
Order = Literal["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"]


@dataclass(frozen=True, kw_only=True)
class ExportOptions:
    """Writes the motion of recorded hands for other programs, as keys at a constant rate. Or makes
    one data set of demonstrations from recordings.

    From a recording of a Leap, PAALM computes the motion of a hand in the frame of the device
    (docs/paalm.md); no task is needed. Recordings of sessions, trials and captures already contain
    poses.

    The suffix of the file chooses the format:

        .bvh   skeleton and motion; Blender, Maya, MotionBuilder, ..
        .glb   glTF 2.0: the skinned hand in motion; browsers, Blender, game engines
        .amc   motion, and its skeleton beside it in a file .asf
        .v     Vicon V: motion, and its skeleton beside it in a file .vsk
        .vsk   Vicon VSK: the skeleton alone
        .c3d   fingertips as points (--points joints adds the joints)
        .csv   the same points as a table: time, then x, y, z of each point, in m

    docs/formats.md lists axes, units and Euler orders, and the data that each format stores. Two
    hands are written to one .glb, .c3d or .csv, but to two files in other formats: out-right.bvh,
    out-left.bvh. `sandbox run --motion FILE` writes the same files during a run.

    A data set contains observations, actions and rewards of demonstrations (docs/data-sets.md).
    --to minari and --to lerobot, each with --name, make data sets of Minari and of LeRobot
    (LeRobotDataset v3.0). --to FILE.npz makes a NumPy file.

    Try:

        sandbox devices leap simulate --out leap.json
        sandbox export leap.json --to hand.bvh
        sandbox export both.json.lz --to hands.glb --hand both --calibration me.json
        sandbox run box-to-goal --device simulated --seed 3 --record run.jsonl
        sandbox export run.jsonl --to hand.bvh
        sandbox export run.jsonl --to hand.glb
        sandbox export run.jsonl --to commanded.bvh --of commanded --rate 120
        sandbox export run.jsonl --to tips.csv --fingers thumb index
        sandbox export NAME/3B5G5T/S001/T007 --to trial.glb
        sandbox regress --tasks box-to-goal --seeds 0:20 --record trials --record-all
        sandbox export trials --to demonstrations.npz
        sandbox export trials --to minari --name hand_sandbox/box-to-goal-v0
        sandbox export trials --to lerobot --name me/box-to-goal
    """

    file: Annotated[tuple[str, ...], Parameter(metavar="RECORDING|TRIAL|CAPTURE")] = field(
        kw_only=False
    )
    """A recording (--record), a trial of a study (NAME/PARTICIPANT/S001/T007, as for `sandbox
    replay`), a capture (.npz), or a recording of a Leap (`sandbox devices leap formats` lists
    them). A data set takes several recordings, folders of recordings, and all trials of a study."""

    to: Annotated[Path, Parameter(metavar="FILE|minari|lerobot")]
    """File to write; an existing file is replaced. Or `minari`, or `lerobot`."""

    name: str = ""
    """Name of a data set of Minari, such as hand_sandbox/box-to-goal/mine-v0, or of LeRobot, such
    as me/box-to-goal."""

    successes: bool = False
    """Only successful trials become demonstrations of a data set."""

    rate: Annotated[float, Parameter(metavar="HZ")] = 60.0
    """Keys per second. Poses are interpolated between those of the recording: a session has 62.5
    poses per second, a Leap its own times."""

    of: Of | None = None
    """simulated, the default: the pose of the simulated hand. commanded: the pose computed from
    the touches; the recording is replayed for it, which takes longer. Only for recordings of
    sessions."""

    hand: Hand | None = None
    """Hand of a Leap recording to export. Default: all hands. If the Leap does not report sides, a
    single hand counts as a right hand."""

    calibration: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """Calibration of your hands over a Leap, by `sandbox paalm calibrate --out FILE`. Default: from
    the open hand in the recording, the bones that the device reports, or an average hand."""

    unit: Annotated[str, Parameter(metavar="UNIT,...")] = ""
    """Units of a recording of a Leap or a camera, such as cm,ms. Lengths: m, cm, mm or in. Times:
    s, ms, us or ns. Places in a picture: px or 0..1. Default: units for which the hand has a
    possible size and the frames a possible rate. These units are reported if they differ from the
    format's units."""

    euler: Order = "ZXY"
    """Order of the rotations in a BVH file. The first axis is always that of flexion. The last axis
    is that of spreading (of twisting, if the order begins with Y). So angles never jump."""

    points: Literal["tips", "joints"] = "tips"
    """Points in .c3d and .csv. tips: fingertips. joints: fingertips, joints and wrist."""

    fingers: Annotated[tuple[Finger, ...], SEVERAL] = ("thumb", "index", "middle", "ring", "little")
    """Fingers whose points .c3d and .csv contain."""

    take: Annotated[int, Parameter(metavar="N")] = 1
    """Number of the take in a capture, from 1; one take is exported at a time."""

    out: Annotated[Path, Parameter(metavar="DIR")] = Path("studies")
    """Folder of studies."""


def main(argv: list[str]) -> int:
    """Runs `sandbox export ...`."""
    options = parse(ExportOptions, "sandbox export", argv)
    console, errors = Console(), Console(stderr=True)
    if is_data_set(options.to):
        return _data_set(options, console, errors)
    if options.name or options.successes:
        raise InputError(
            "this option is for data sets",
            where="--name" if options.name else "--successes",
            got=f"--to {options.to}",
            expected="--to minari, --to lerobot or --to FILE.npz",
        )
    settings = _settings(options)
    _check_effect(options, format_of(options.to).heeds)
    file = _input_file(options)
    if resolved(options.to, "--to") == resolved(file, "FILE"):
        raise InputError(
            "the output would replace the input",
            where=f"--to {options.to}",
            remedy="Name another file",
        )
    with Progress(console=errors, transient=True, disable=not errors.is_terminal) as progress:
        bar = progress.add_task("reading", total=None)
        source = open_source(
            file, options.of, options.take, options.hand, options.calibration, options.unit
        )
        for remark in source.remarks:
            errors.print(f"{file}: {remark}", soft_wrap=True, markup=False, style="yellow")
        progress.update(bar, description="writing keys", total=source.duration or None)
        with Exporter(options.to, source.armatures, source.names, settings) as exporter:

            def take(poses: Poses) -> None:
                exporter.take(poses)
                progress.update(bar, completed=float(poses.time[-1]))

            damage = source.play(take)
    for text in filter(None, (damage, source.report.line())):
        errors.print(f"{file}: {text}", soft_wrap=True, markup=False, style="yellow")
    seconds = (exporter.frames - 1) / options.rate
    names = ", ".join(map(str, exporter.paths))
    console.print(
        f"{names}: {exporter.frames:,} keys at {options.rate:g} Hz, {seconds:.1f} s of "
        f"{source.what}",
        soft_wrap=True,
        markup=False,
    )
    for writer, _ in exporter.writers:
        if isinstance(writer, BvhWriter):
            step, key, joint = writer.greatest_step
            console.print(
                f"{writer.paths[0].name}: angles in {options.euler} order, greatest step "
                f"between two keys {step:.1f} degrees ({joint}, at {key / options.rate:.2f} s)",
                soft_wrap=True,
                markup=False,
            )
    return 0


def _data_set(options: ExportOptions, console: Console, errors: Console) -> int:
    """Writes a data set."""
    such = NAMED.get(str(options.to), "")
    if (options.name != "") != (such != ""):
        raise InputError(
            f"a data set of {options.to} needs a name"
            if such
            else "--name has no effect on a NumPy file",
            where="--name",
            got=options.name or "nothing",
            expected=f"such as {such}" if such else "no --name",
        )
    from sandbox.datasets.written_data_set import export_data_set

    notes: list[str] = []
    found = [file for name in options.file for file in _recordings(name, options.out, notes)]
    files = [file for file, counts in found if counts]
    notes += _same_twice(files)
    if found and not files:
        raise InputError(
            "no demonstration is left",
            where=" ".join(options.file),
            got=f"{counted(len(found), 'attempt')}, all broken off or repeated",
            expected="a study with a valid attempt",
        )
    with Progress(console=errors, transient=True, disable=not errors.is_terminal) as progress:
        bar = progress.add_task("playing recordings", total=len(files))
        exported = export_data_set(
            files,
            options.to,
            options.name,
            options.successes,
            done=lambda count: progress.update(bar, completed=count),
        )
    for note in notes:
        errors.print(note, soft_wrap=True, markup=False, style="yellow")
    left_out = len(found) - len(files) + exported.broken_off
    if left_out:
        errors.print(
            f"{counted(left_out, 'attempt')} that {'does' if left_out == 1 else 'do'} not count "
            "(broken off or repeated) left out",
            soft_wrap=True,
            markup=False,
            style="yellow",
        )
    if exported.differing:
        errors.print(
            f"{exported.differing[0]}: the environment's states differ from the recorded ones "
            f"(in {len(exported.differing)} of {exported.episodes} recordings); "
            "the data set has those of the environment",
            soft_wrap=True,
            markup=False,
            style="yellow",
        )
    if exported.changed:
        others = len(exported.changed) - 1
        more = f" (also in {others} more recordings)" if others else ""
        errors.print(exported.changed[0] + more, soft_wrap=True, markup=False, style="yellow")
    console.print(
        f"{exported.where}: {exported.episodes:,} demonstrations of {exported.steps:,} steps, "
        f"{exported.successes:,} successful, {exported.simulated:,} by a simulated user",
        soft_wrap=True,
        markup=False,
    )
    return 0


def _recordings(name: str, out: Path, notes: list[str]) -> list[tuple[Path, bool]]:
    """Finds the recordings that a name refers to; True for each that belongs in a data set.

    In a folder, dumps of divergences are left out. Of the attempts at a trial of a study, only the
    valid one belongs in a data set.

    Args:
        name: A folder, which is searched with its subfolders, or a name that `sandbox replay`
            accepts.
        out: Folder of studies.
        notes: A line about other files in a folder is appended.

    Raises:
        InputError: A file in a folder is empty, or there is no such recording.
    """
    folder = Path(name)
    if folder.is_dir() and not (folder.parent / JOURNAL).exists():
        inside = [file for file in sorted(folder.rglob("*.jsonl*")) if not _of_study(file, folder)]
        files = [file for file in inside if is_recording(file)]
        for file in inside:
            if not file.stat().st_size:
                raise InputError(
                    "this file is no recording",
                    where=str(file),
                    got="an empty file",
                    remedy="Move it out of the folder",
                )
        others = [file for file in inside if file not in files]
        if others:
            notes.append(
                f"{counted(len(others), 'file')} in {name} left out, not a recording: {others[0]}"
            )
        if files:
            return [(file, True) for file in files if not is_dump(file)]
    files = find_recordings(name, out)
    if stored(folder).is_file():
        # A file that is named itself is never left out.
        return [(file, True) for file in files]
    counting = _counting({file.parent.parent for file in files})
    return [(f, f.name in counting.get(f.parent.parent, {f.name})) for f in files]


def _same_twice(files: Sequence[Path]) -> list[str]:
    """Returns a line about files with equal content; empty if all differ."""
    first: dict[str, Path] = {}
    again = []
    for file in files:
        digest = bytes_digest(file)
        if digest in first:
            again.append(f"{file} and {first[digest]} are equal")
        first.setdefault(digest, file)
    more = f", and {len(again) - 1} more" if len(again) > 1 else ""
    return [f"the same recording twice: {again[0]}{more}"] if again else []


def _of_study(file: Path, folder: Path) -> bool:
    """True if a file inside a folder belongs to a study or to a session of one."""
    above = [folder, *(p for p in file.parents if p.is_relative_to(folder))]
    return any((p / JOURNAL).is_file() or is_study(p) for p in above)


def _counting(sessions: set[Path]) -> dict[Path, set[str]]:
    """Returns, for each session with a journal, the names of the recordings of valid attempts.

    Raises:
        StudyError: A journal is damaged.
    """
    counting = {}
    for session in sessions:
        if (session / JOURNAL).exists():
            state = SessionState.of(read_journal(session / JOURNAL))
            attempts = (state.counted(trial) for trial in state.attempts)
            counting[session] = {Path(a.start["file"]).name for a in attempts if a is not None}
    return counting


def _input_file(options: ExportOptions) -> Path:
    """Returns the file that the options name."""
    files = [file for name in options.file for file in find_recordings(name, options.out)]
    if not files:
        raise InputError("no recording is named", expected="a file, or a trial of a study")
    if len(files) > 1:
        raise InputError(
            "only one recording can be exported at a time",
            where=" ".join(options.file),
            got=f"{len(files)} recordings",
            remedy=f"Name one of them, such as {files[0].stem}",
        )
    return files[0]


def _check_effect(options: ExportOptions, heeds: Container[str]) -> None:
    """Refuses options that have no effect on the format of the file.

    Args:
        options: The options.
        heeds: Names of the options that affect the format.
    """
    default = ExportOptions(file=options.file, to=options.to)
    for name in ("points", "fingers", "euler"):
        if name not in heeds and getattr(options, name) != getattr(default, name):
            raise InputError(
                "this option has no effect on such a file",
                where=f"--{name}",
                got=f"--to {options.to}",
                expected=", ".join(kind for kind, form in FORMATS.items() if name in form.heeds),
            )


def _settings(options: ExportOptions) -> ExportSettings:
    if not 1 <= options.rate <= 1000:
        raise InputError("out of range", where="--rate", got=options.rate, expected="1 to 1000 Hz")
    fingers = tuple(sorted({FINGERS.index(name) for name in options.fingers}))
    if not fingers:
        raise InputError("no finger is left", where="--fingers", expected=", ".join(FINGERS))
    return ExportSettings(options.rate, options.euler, options.points, fingers)
