"""Trials from Python: play a task or a recording; get its score, film, trajectories and motion."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field, fields, replace
from difflib import get_close_matches
from inspect import signature
from pathlib import Path
from typing import Any, Literal, cast, get_type_hints

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError
from models.json_input import checked
from models.surface import Surface
from sandbox.devices.device import Closeable, Device, PlayedOptions
from sandbox.devices.own_device import adapted
from sandbox.devices.registry import (
    DeviceSettings,
    devices_with_option,
    find_device,
    unavailable_option,
)
from sandbox.export.sources import open_source
from sandbox.export.targets import Exporter, ExportSettings
from sandbox.library.trajectories import Trajectories, TrajectoryView
from sandbox.recording.recording import load_recording
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import DeviceMaker, device_makers, is_live, with_lift
from sandbox.trial.driver import RealTime, View, play_trial
from sandbox.trial.replay import Verification, replay
from sandbox.trial.settings import recorded_users
from sandbox.trial.trial_options import TrialOptions, trial_settings
from sandbox.views.overlay import OverlayTexts
from sandbox.views.renderer import Renderer
from tasks.registry import TASKS
from tasks.score import Score
from tasks.task import Task

PICTURE_RATE = 15.0
"""Pictures per second of simulated time, as in a film."""


class PictureView(Closeable):
    """A view of a session that draws pictures at an even rate and keeps them.

    Args:
        session: Session to draw.
        size: Width and height, px.
        caption: Name of the player, written on every picture.

    Raises:
        GraphicsError: OpenGL is missing on this machine.
        InputError: The size is invalid.
    """

    def __init__(self, session: Session, size: tuple[int, int], caption: str) -> None:
        words = OverlayTexts(caption)
        self._renderer = Renderer(session.scene, session.whole_surface, size, words)
        self._pictures: list[NDArray[np.uint8]] = []
        self._size = size

    def show(self, snapshot: Snapshot) -> None:
        """Draws a snapshot if the next picture is due."""
        if snapshot.time * PICTURE_RATE >= len(self._pictures):
            self._pictures.append(np.asarray(self._renderer.frame(snapshot)))

    def pictures(self) -> NDArray[np.uint8]:
        """(n, height, width, 3) RGB, 0 to 255."""
        width, height = self._size
        return np.array(self._pictures, np.uint8).reshape(-1, height, width, 3)

    def close(self) -> None:
        """Frees the OpenGL context; may be called twice."""
        self._renderer.close()


FROM_PYTHON = "from Python"
"""Name, in settings, of a device that is opened by a Python function."""

OpenDevice = Callable[[Surface], Device]
"""Function that opens a device on a placed surface. A subclass of `TouchDevice` can be used as this
function."""


@dataclass(frozen=True)
class TrialRun:
    """A trial that was played to its end.

    Attributes:
        score: Success, status at the end, duration, and reason for a failure.
        state_hash: Chained hash of all states; equal hashes mean that all states are equal.
        trajectories: Trajectories of objects, hands and touches; None if not requested.
        pictures: (n, height, width, 3) uint8 RGB, 15 per second; None if not requested.
        verification: Comparison of a replay with its recording; None for a new trial.
        result: The values that `sandbox run --json` writes; empty for a replay.
    """

    score: Score
    state_hash: str
    trajectories: Trajectories | None = None
    pictures: NDArray[np.uint8] | None = None
    verification: Verification | None = None
    result: Mapping[str, Any] = field(default_factory=dict)

    @property
    def success(self) -> bool:
        """True if the goal was held for the task's hold time."""
        return self.score.success


def run_trial(
    task: str | type[Task] = "box-to-goal",
    seed: int | None = None,
    device: str | OpenDevice = "simulated",
    *,
    record: Path | str | None = None,
    film: Path | str | None = None,
    pictures: tuple[int, int] | None = None,
    trajectories: bool = True,
    real_time: bool | None = None,
    **options: Any,
) -> TrialRun:
    """Plays one trial without a window and returns its score and trajectories.

    Args:
        task: A task's name, `FILE.py`, `FILE.py:CLASS`, or a task class.
        seed: Seed of start, goal and simulated user; equal seeds give equal trials. If it is None,
            the seed is 0, or that of the recording if `device` is a recording.
        device: A device as for `sandbox run --device` (`simulated`, `tuio`, a recording,
            `FILE.py:CLASS`), or a class or function that opens a device on a `Surface`.
        record: File of a recording to write; it must not exist.
        film: File of a film to write: .webp, .gif, or .mp4 with the extra `film`.
        pictures: Width and height in px of pictures to return; None draws no pictures.
        trajectories: True to return trajectories.
        real_time: True plays in real time, False as fast as possible. None plays in real time if
            `device` is the name of a device that a person or another program drives, and otherwise
            as fast as possible.
        options: Other options of `sandbox run`, with underscores: `encoder="paper"`, `fingers=5`,
            `hand="left"`, `correction=False`.

    Returns:
        The run.

    Warns:
        UserWarning: NumPy was imported before `sandbox`, so that states depend on the processor.

    Raises:
        InputError: The task, device or an option is invalid.
        GraphicsError: A film or pictures are requested and OpenGL is missing.
    """
    named = device if isinstance(device, str) else "simulated"
    chosen = trial_settings(_trial_options(named, task=_place(task), seed=seed, **options))
    if isinstance(device, str):
        makers, live = device_makers(chosen), is_live(chosen)
    else:
        makers, live = (_opens(device),), False
        chosen = replace(chosen, device=DeviceSettings(FROM_PYTHON, PlayedOptions()))
    if named == "mouse":
        raise InputError(
            "the mouse needs a window, which run_trial does not open",
            where="device",
            remedy="Use `sandbox play`",
        )
    if named in ("web", "webxr"):
        raise InputError(
            "this device needs a page, which run_trial does not serve",
            where="device",
            got=named,
            remedy="Use `sandbox play`",
        )
    caption = "simulated user" if chosen.device.user is not None else ""
    with _Views(film, pictures, trajectories, caption) as views:
        if live if real_time is None else real_time:
            views.pace = RealTime()
        result = play_trial(
            chosen,
            with_lift(makers, keys=False),
            views.make,
            Path(record) if record else None,
        )
    return views.run(result=result.as_json())


def replay_recording(
    path: Path | str,
    *,
    film: Path | str | None = None,
    pictures: tuple[int, int] | None = None,
    trajectories: bool = True,
) -> TrialRun:
    """Replays a recording, compares every state, and returns the trajectories.

    Args:
        path: A recording written by `record=FILE` or `--record FILE`, or a study's recording of a
            trial.
        film, pictures, trajectories: As in `run_trial`.

    Returns:
        The run; `verification.exact` is True if all states were equal.

    Warns:
        UserWarning: The recording's task is not built in, and has changed since the recording.

    Raises:
        RecordingError: The file is not a recording, or cannot be played with this installation.
        GraphicsError: A film or pictures are requested and this machine has no OpenGL.
    """
    recording = load_recording(Path(path))
    caption = "simulated user" if recorded_users(recording.header)[0] else ""
    with _Views(film, pictures, trajectories, caption) as views:
        _, verification = replay(recording, views.make)
    if verification.task_change:
        warnings.warn(verification.task_change, UserWarning, stacklevel=2)
    return views.run(verification=verification)


def _opens(device: OpenDevice) -> DeviceMaker:
    return lambda task, surface: cast(Device, adapted(device(surface), "device"))


class _Views:
    """The views of a trial while it is played; they collect the values of the resulting run."""

    def __init__(
        self,
        film: Path | str | None,
        pictures: tuple[int, int] | None,
        trajectories: bool,
        caption: str,
    ) -> None:
        self.pace: RealTime | None = None
        self._film, self._pictures, self._trajectories = film, pictures, trajectories
        self._caption = caption
        self._closing = ExitStack()
        self._made: dict[str, Callable[[], Any]] = {}

    def __enter__(self) -> _Views:
        return self

    def __exit__(self, *error: Any) -> None:
        self._closing.__exit__(*error)

    def make(self, session: Session) -> list[View]:
        """The views of a session that has not begun."""
        self._session = session
        views: list[View] = [self._wait] if self.pace else []
        if self._trajectories:
            kept = TrajectoryView(session)
            self._made["trajectories"] = kept.trajectories
            views.append(kept.show)
        if self._pictures:
            drawn = PictureView(session, self._pictures, self._caption)
            self._closing.callback(drawn.close)
            self._made["pictures"] = drawn.pictures
            views.append(drawn.show)
        if self._film:
            from sandbox.views.film import FilmView

            film = FilmView(self._film, session.scene, session.whole_surface, caption=self._caption)
            views.append(self._closing.enter_context(film).show)
        return views

    def run(self, **more: Any) -> TrialRun:
        """The run, once the session has ended."""
        arrays = {name: make() for name, make in self._made.items()}
        session = self._session
        return TrialRun(session.scorer.score, session.state_hash, **arrays, **more)

    def _wait(self, snapshot: Snapshot) -> None:
        assert self.pace is not None
        self.pace.wait(snapshot.time)


def _trial_options(device: str, **values: Any) -> TrialOptions:
    """Options of `sandbox run`, by name.

    Args:
        device: Name of the device.
        values: Values by the option's name, options of the device included.

    Raises:
        InputError: A name is not an option, or a value is of another type.
    """
    named = find_device(device)
    of_device = get_type_hints(named.entry.on_command_line) if named else {}
    types = {**get_type_hints(TrialOptions), **of_device}
    common = {f.name for f in fields(TrialOptions)} - {"given", "device_options"}
    known = common | {*of_device}
    unknown = sorted(set(values) - known)
    if unknown:
        if any(devices_with_option(name) for name in unknown):
            raise unavailable_option(unknown[0], [device])
        own = {*signature(run_trial).parameters} - {"options"}
        near = [get_close_matches(name, known | own, 1) for name in unknown]
        raise InputError(
            "this option is unknown",
            where="run_trial",
            got=", ".join(unknown),
            expected=", ".join(sorted(known | own)),
            remedy=f"Did you mean {', '.join(n[0] for n in near)}?" if all(near) else None,
        )
    typed = {name: _of_type(name, values[name], types[name]) for name in values}
    given = {name: typed.pop(name) for name in [*typed] if name not in common}
    options = TrialOptions(device=device, device_options=given, given=frozenset(typed))
    return replace(options, **typed)


def _of_type(name: str, value: Any, kind: Any) -> Any:
    """Converts a value to the type of its option.

    NumPy numbers are accepted, and a `Path` where the option is a text.
    """
    if isinstance(value, np.generic):
        value = value.item()
    if kind in (Path, Path | None):
        return None if value is None else Path(value)
    if isinstance(value, Path):
        value = str(value)
    remedy = None
    if name == "encoder" and not isinstance(value, str):
        remedy = (
            "Write a trained model to a file with `encoders.save_model(model, FILE)`, and give the "
            "file's name"
        )
    elif name == "vary" and isinstance(value, Mapping):
        remedy = 'Give a text, such as vary="size=0.8,latency=100"'
    return checked(
        value, kind, InputError, what="not a value of this option", where=name, remedy=remedy
    )


def _place(task: str | type[Task]) -> str:
    """Returns the text that identifies a task: its name, or `module:Class`."""
    if isinstance(task, str):
        return task
    return task.name if TASKS.get(task.name) is task else f"{task.__module__}:{task.__qualname__}"


def export_motion(
    source: Path | str,
    to: Path | str,
    *,
    rate: float = 60.0,
    of: Literal["simulated", "commanded"] | None = None,
    settings: ExportSettings | None = None,
) -> tuple[Path, ...]:
    """Writes the motion of the hands in a file in a format of animation programs.

    Args:
        source: A recording, a capture (.npz), or a recording of a Leap, for which PAALM computes
            the hand poses.
        to: File to write; its ending chooses the format: .bvh, .glb, .amc, .v, .vsk, .c3d or .csv.
            An existing file is replaced.
        rate: Rate of the keyframes, Hz.
        of: For recordings of sessions only. `simulated`, the default, is the motion of the
            simulated hand; `commanded` is the commanded pose.
        settings: Further choices, such as the Euler order; the rate in it replaces `rate`.

    Returns:
        The files that were written. If the format holds only one hand, two hands give two files.

    Warns:
        UserWarning: The source is damaged, or its replay differs; everything that could be read is
            written. Or the size of a hand over a Leap was not measured.

    Raises:
        InputError: The source cannot be read, or the file cannot be written.
    """
    opened = open_source(Path(source), of)
    for remark in opened.remarks:
        warnings.warn(f"{source}: {remark}", stacklevel=2)
    chosen = settings or ExportSettings(rate)
    with Exporter(Path(to), opened.armatures, opened.names, chosen) as exporter:
        damage = opened.play(exporter.take)
    for text in filter(None, (damage, opened.report.line())):
        warnings.warn(f"{source}: {text}", stacklevel=2)
    return tuple(exporter.paths)
