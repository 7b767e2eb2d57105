"""`sandbox run`: runs a task without a window, as fast as the machine can."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape

from models.errors import InputError
from models.surface import Surface
from sandbox.cli.common.command_line import parse
from sandbox.cli.common.json_out import TERMINAL, check_output, printing, refuse_same, write_json
from sandbox.cli.common.lsl_options import LslOptions, streaming
from sandbox.devices.device import Device
from sandbox.play.player_requests import NoticePrinter, address_line, report_end
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.system.ending import ending_as_by_ctrl_c
from sandbox.trial.assembly import DeviceMaker, device_makers, is_live, with_lift
from sandbox.trial.driver import RealTime, View, play_trial
from sandbox.trial.logs import EventLog, NoticeEvents
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import (
    COMMON,
    OUTPUT,
    TrialOptions,
    check_labels,
    check_names,
    trial_settings,
)
from tasks.task import Task


@dataclass(frozen=True, kw_only=True)
class RunOptions(LslOptions, TrialOptions):
    """Runs a task without a window, as fast as the machine can, and prints its score.

    Exit status 0: the trial was played, with or without success (`success` in --json). 1: an error
    of the program, or of a task's own code. 2: bad input, reported in one line. 130: stopped by
    Ctrl-C.

    Try: sandbox run box-to-goal --device simulated --seed 3 --json -
    """

    json: Annotated[Path | None, Parameter(group=COMMON, metavar="OUT")] = None
    """File for the result as JSON; - is the terminal."""

    film: Annotated[Path | None, Parameter(group=COMMON, metavar="FILE")] = None
    """File for a film: .webp, .gif, or .mp4 with the extra `film`."""

    motion: Annotated[Path | None, Parameter(group=OUTPUT, metavar="FILE")] = None
    """File for the motion of the hands, 60 keys per second: .bvh, .glb, .amc, .v, .c3d, .csv.
    `sandbox export` does the same with a recording and has more options."""


def main(argv: list[str]) -> int:
    """Runs `sandbox run ...`."""
    return perform(parse(RunOptions, "sandbox run", argv))


def perform(options: RunOptions) -> int:
    """Runs the trial that the options describe, and reports its result."""
    check_names(options)
    check_labels(options)
    chosen = trial_settings(options)
    if options.device == "mouse":
        raise InputError(
            "the mouse needs a window", where="--device mouse", remedy="Use `sandbox play`"
        )
    for option, device in (
        ("--device", options.device),
        ("--second-device", options.second_device),
    ):
        if device in ("web", "webxr"):
            raise InputError(
                "`sandbox run` serves no page",
                where=f"{option} {device}",
                remedy=f"Use `sandbox play {options.task} --device {device}`",
            )
    check_output(options.json)
    names = ("record", "film", "motion", "events", "json")
    refuse_same({f"--{name}": getattr(options, name) for name in names})
    events, before = EventLog(options.events), _written(options)
    # With `--json -`, only the result goes to standard output.
    console = Console(stderr=options.json == TERMINAL)
    try:
        # SIGTERM and SIGHUP end the run like Ctrl-C, so that the files are completed.
        with streaming(options.lsl, console), ending_as_by_ctrl_c():
            result = _run(options, chosen, events, console)
        with printing():
            _report(result, console)
            for what, path in (("recording", options.record), ("film", options.film)):
                if path is not None:
                    console.print(f"[dim]{what}: {escape(str(path))}[/]", soft_wrap=True)
        write_json(options.json, result.as_json())
    except KeyboardInterrupt:
        for file, _ in sorted(_written(options) - before):
            line = f"what came before is in {file}"
            Console(stderr=True).print(line, soft_wrap=True, markup=False)
        raise
    finally:
        events.close()
    return 0


def _written(options: RunOptions) -> set[tuple[str, int]]:
    """Returns path and modification time of each existing file that a stopped trial leaves."""
    files = [path for path in (options.record, options.motion) if path is not None]
    return {(str(path), path.stat().st_mtime_ns) for path in files if path.exists()}


def _run(options: RunOptions, chosen: Settings, events: EventLog, console: Console) -> TrialResult:
    clock: list[RealTime] = []
    started: list[bool] = []

    def pace(snapshot: Snapshot) -> None:
        if not clock:
            clock.append(RealTime())
        clock[0].wait(snapshot.time)

    # A simulated user does not act on notices: they go to stderr, and stdout has only the result.
    simulated = chosen.device.user is not None
    notices = NoticePrinter(Console(stderr=True) if simulated else console, wrap=False)

    def announced(make: DeviceMaker) -> DeviceMaker:
        def make_device(task: Task, surface: Surface) -> Device:
            return announce(make(task, surface), task)

        return make_device

    def announce(device: Device, task: Task) -> Device:
        address = device.address
        if address:
            console.print(address_line(address), soft_wrap=True)
            events.write("listening", address=address)
        damage = device.damage
        if damage:
            console.print(f"[yellow]{escape(str(damage))}[/]")
            events.write("warning", what=str(damage))
        if not started:
            started.append(True)
            events.write("trial_start", task=task.name, seed=task.seed)
        return device

    with ExitStack() as closing:
        closing.callback(notices.wait)

        def make_views(session: Session) -> list[View]:
            views: list[View] = [NoticeEvents(events, notices.say).show]
            if is_live(chosen):
                views.append(pace)
            if options.film:
                # This import loads OpenGL, which a run without a film does not need.
                from sandbox.views.film import FilmView

                surface = session.whole_surface
                drawn = FilmView(options.film, session.scene, surface, caption=caption)
                views.append(closing.enter_context(drawn).show)
            if options.motion:
                # This import loads all formats of motion files.
                from sandbox.export.targets import MotionView

                views.append(closing.enter_context(MotionView(options.motion, session)).show)
            return views

        caption = "simulated user" if simulated else ""
        makers = tuple(map(announced, with_lift(device_makers(chosen), keys=False)))
        result = play_trial(chosen, makers, make_views, options.record, dump=options.dump)
    events.write("trial_end", **result.as_json())
    if clock and clock[0].lost > 0:
        what = f"this machine fell behind real time by {clock[0].lost:.1f} s"
        console.print(f"[yellow]{what}[/]")
        events.write("warning", what=what)
    return result


def _report(result: TrialResult, console: Console) -> None:
    report_end(result, console)
    console.print(f"[dim]seed {result.seed}, {result.encoder}, state {result.state_hash}[/]")
