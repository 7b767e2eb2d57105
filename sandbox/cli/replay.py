"""`sandbox replay`: replays recordings, checks every state, and shows them."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape
from rich.progress import Progress

from models.errors import InputError
from sandbox.cli.common.command_line import FLAT, parse
from sandbox.recording.recording import Recording, load_recording
from sandbox.server.page_options import PageOptions
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.study.record.folder import is_study
from sandbox.study.record.trial_files import find_recordings, finished_only
from sandbox.study.share.verify import verified, verify
from sandbox.trial.driver import View
from sandbox.trial.logs import EventLog
from sandbox.trial.replay import BOUND_DEGREES, BOUND_MM, Agreement, Playback, Verification, replay
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import recorded_users
from tasks.score import Status, ending

RATE = 60.0
"""Snapshots per second that are sent to the page."""


def show_in_window(
    session: Session, snapshots: Sequence[Snapshot], speed: float, caption: str
) -> None:
    """Shows the trial until the window is closed.

    Raises:
        GraphicsError: No window can be opened here.
    """
    # glfw looks for a screen as soon as it is imported.
    from sandbox.play.pages import in_air
    from sandbox.views.window import REPLAY_HELP, Window

    with Window(
        session.scene,
        session.whole_surface,
        title=f"replay: {session.task.name}",
        caption=caption,
        in_air=in_air(session),
    ) as window:
        window.help = REPLAY_HELP
        playback = Playback(snapshots, speed)
        whole = snapshots[-1].time
        while window.pump(playback.now):
            moves = window.take_moves()
            if abs(moves) == 1:
                # Single steps pause the playback.
                window.paused = True
            if playback.paused != window.paused:
                playback.paused = window.paused
            playback.speed = speed * window.speed
            playback.move(moves)
            if window.take_reset():
                window.paused = False
                playback.restart()
            window.footer = (f"{playback.now.time:.2f} of {whole:.2f} s",)


def show_on_page(
    session: Session,
    snapshots: Sequence[Snapshot],
    speed: float,
    caption: str,
    hand: str,
    page: PageOptions,
    console: Console,
) -> None:
    """Shows the trial on a page until Ctrl-C. Requests from the page pause and restart playback.

    Raises:
        DeviceError: The page cannot be served.
    """
    from sandbox.play.pages import open_page, show_address, show_session

    server = open_page(page, touch=False)
    try:
        show_address(server, page, EventLog(None), console)
        console.print("Ctrl-C ends it")
        show_session(server, session, hand, caption)
        while not server.wait_for_player(1.0):
            pass
        playback = Playback(snapshots, speed)
        while True:
            for ask in server.take_requests():
                if ask.what in ("pause", "resume"):
                    playback.paused = ask.what == "pause"
                elif ask.what == "retry":
                    playback.restart()
            server.publish(playback.now, "menu" if playback.paused else "")
            time.sleep(1.0 / RATE)
    except KeyboardInterrupt:
        console.print("stopped")
    finally:
        server.close()


def study_folder(name: str, out: Path) -> Path | None:
    """Finds the folder of a study: `name` as a path, or `name` inside `out`.

    Returns None if neither is a study.
    """
    return next((path for path in (Path(name), out / name) if is_study(path)), None)


def verify_study(study: Path, console: Console, seals: Path | None = None) -> int:
    """Verifies a study. Prints one line for each check (`verify.POINTS`) and for each finding.

    Args:
        study: Folder of the study.
        console: Console for the lines.
        seals: Copy of `notes/SITE.jsonl` that was stored outside the study.

    Returns:
        The exit status.
    """
    done = verify(study, seals)
    for found in done.found.values():
        for finding in found:
            console.print(f"[red]{escape(str(finding))}[/]", highlight=False, soft_wrap=True)
    for note in done.notes:
        console.print(f"[dim]{escape(note)}[/]", highlight=False, soft_wrap=True)
    for line in done.lines():
        console.print(escape(line), highlight=False, soft_wrap=True)
    console.print(
        "[green]all is as it was written[/]" if done.sound else "[red]verification failed[/]"
    )
    return int(not done.sound)


def verdict(verification: Verification) -> str:
    """Returns the result of a replay in one line, with changes of the task since the recording."""
    changed = escape(verification.task_change)
    if not changed:
        return _compared(verification)
    if verification.exact:
        return f"{_compared(verification)}; [yellow]yet {changed}[/]"
    return f"{_compared(verification)}[red]: {changed}[/]"


def _compared(verification: Verification) -> str:
    if verification.exact:
        whole = "" if verification.complete else ", up to the end of the incomplete recording"
        return f"[green]exact[/]: {verification.compared} states are equal to the bit{whole}"
    if verification.compared == 0:
        return "[yellow]nothing to compare: the recording has no input[/]"
    differs = f"differs[/] from physics step {verification.first_difference} on"
    if verification.same_machine:
        return f"[red]{differs}"
    return f"[yellow]{differs}, which is allowed: {elsewhere(verification)}"


def elsewhere(verification: Verification) -> str:
    """Returns the differences between this machine and that of the recording, in words."""
    return f"it was recorded elsewhere; different: {' and '.join(verification.differs_in)}"


SELDOM = 64
"""Control periods between two updates of the progress bar.

One update takes longer than simulating one period.
"""


@dataclass(frozen=True, kw_only=True)
class ReplayOptions:
    """Replays recordings and compares each state with the recorded one, by its hash.

    Exit status 1: a state differs although versions and processor are those of the recording; or
    with --verify, a check fails.

        sandbox replay run.jsonl                                   a recording
        sandbox replay NAME/3B5G5T/S001/T007                       a trial of a study
        sandbox replay NAME/3B5G5T --verify                        all trials of a participant
        sandbox replay NAME --verify                               a study: records, files, states
        sandbox replay NAME/3B5G5T/T007 --view window              shows it at real speed
        sandbox replay run.jsonl --view film --film run.mp4        draws a film
    """

    trial: Annotated[str, Parameter(metavar="FILE|TRIAL")] = field(kw_only=False)
    """A recording written by --record. Or a trial of a study, NAME/PARTICIPANT/S001/T007, of which
    the valid attempt is replayed; leave out S001 to replay this trial of every session. Or a study,
    participant or session, to replay all its trials."""

    verify: bool = False
    """Exit status 1 unless the recording is complete and every state is equal. States of another
    machine's recording may differ if the outcome is the same and all objects and hands are within 1
    mm and 2 degrees of the recorded ones. For a whole study, also checks records, seals (hashes of
    closed sessions), recordings, frames, tables, trial orders and withdrawals, and lists everything
    that is missing or changed."""

    seals: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """With --verify of a study: a copy of its notes/SITE.jsonl (such as A.jsonl) that you stored
    elsewhere. The study must also match the session hashes in this copy."""

    view: Literal["none", "window", "web", "film"] = "none"
    """Show the trial after the comparison: in a window (h shows the keys: pause, steps, jumps), on
    a page, or as a film."""

    speed: float = 1.0
    """Simulated seconds per second, for --view window and web."""

    film: Annotated[Path | None, Parameter(metavar="FILE")] = None
    """File for a film: .webp, .gif, or .mp4 with the extra `film`. Default with --view film: a
    .webp with the recording's name."""

    out: Annotated[Path, Parameter(metavar="DIR")] = Path("studies")
    """Folder of studies."""

    page: Annotated[PageOptions, FLAT] = field(default_factory=PageOptions)


def main(argv: list[str]) -> int:
    """Runs `sandbox replay ...`."""
    options = parse(ReplayOptions, "sandbox replay", argv)
    console = Console()
    if not 0.001 <= options.speed <= 1000.0:
        raise InputError(
            "the speed is out of range",
            where="--speed",
            got=options.speed,
            expected="a factor from 0.001 to 1000; 1 is the recorded speed",
        )
    study = study_folder(options.trial, options.out)
    if options.verify and study is not None:
        return verify_study(study, console, options.seals)
    if options.seals is not None:
        raise InputError(
            "session hashes are checked only for a whole study with --verify",
            where=f"--seals {options.seals}",
            got=options.trial,
            expected="the folder of a study, and --verify",
        )
    files = find_recordings(options.trial, options.out)
    if len(files) > 1:
        files, broken = finished_only(files)
        if broken:
            console.print(f"{broken} unfinished attempts are left out", highlight=False)
    showing = options.view != "none" or options.film is not None
    if showing and len(files) > 1:
        raise InputError(
            "only one trial can be shown",
            where=options.trial,
            got=f"{len(files)} recordings",
            remedy="Name one of them, such as " + files[0].stem,
        )
    status = 0
    for file in files:
        status = max(status, _replay(file, options, len(files) > 1, console))
    if len(files) > 1:
        verdict = "all correct" if status == 0 else "[red]not all correct[/]"
        console.print(f"{len(files)} recordings: {verdict}")
    return status


def _replay(file: Path, options: ReplayOptions, brief: bool, console: Console) -> int:
    """Replays one recording; returns the exit status."""
    recording = load_recording(file)
    if recording.damage:
        console.print(f"[yellow]{escape(f'{file}: {recording.damage}')}[/]")
    kept: list[Snapshot] = []
    keeps = options.view in ("window", "web")
    film = options.film
    if options.view == "film" and film is None:
        film = Path(file.name).with_suffix(".webp")
    # A film of a simulated user must say so.
    caption = "simulated user" if recorded_users(recording.header)[0] else ""
    steps = recording.end["step"] if recording.end else None
    began = time.perf_counter()
    with ExitStack() as closing:
        progress = closing.enter_context(
            Progress(console=console, transient=True, disable=not console.is_terminal)
        )
        bar = progress.add_task("replaying", total=steps)

        def make_views(session: Session) -> list[View]:
            seldom = SELDOM * session.scene.substeps

            def show(snapshot: Snapshot) -> None:
                if snapshot.step % seldom == 0:
                    progress.update(bar, completed=snapshot.step)

            views: list[View] = [show]
            if keeps:
                views.append(kept.append)
            if film is not None:
                # This import loads OpenGL, which a replay without a film does not need.
                from sandbox.views.film import FilmView

                surface = session.whole_surface
                drawn = FilmView(film, session.scene, surface, caption=caption)
                views.append(closing.enter_context(drawn).show)
            return views

        session, verification = replay(recording, make_views)
    took = time.perf_counter() - began
    if brief:
        line = f"{file.stem}: {verdict(verification)}"
        console.print(line, highlight=False, soft_wrap=bool(verification.task_change))
    else:
        _report(recording, session, verification, console)
        if not keeps and film is None and took > 0 and verification.compared:
            console.print(
                f"[dim]{session.time:.1f} s of trial compared in {took:.2f} s: "
                f"{session.time / took:.1f} times real time[/]",
                highlight=False,
            )
    if film is not None:
        console.print(f"film: {film}", markup=False)
    if kept:
        caption = f"replay; {caption}" if caption else "replay"
        _show(recording, session, kept, options, caption, console)
    if options.verify:
        return 0 if verified(verification) else 1
    return 1 if verification.first_difference is not None and verification.same_machine else 0


def _show(
    recording: Recording,
    session: Session,
    snapshots: list[Snapshot],
    options: ReplayOptions,
    caption: str,
    console: Console,
) -> None:

    if options.view == "window":
        show_in_window(session, snapshots, options.speed, caption)
    else:
        hand = str(recording.header["settings"]["hands"][0]["side"])
        show_on_page(session, snapshots, options.speed, caption, hand, options.page, console)


def _second_verdict(agreement: Agreement) -> str:
    """Returns outcome and largest differences of a replay whose states differ, in a line."""
    outcome = {True: "the same outcome", False: "[red]another outcome[/]", None: "no recorded end"}
    colour = "green" if agreement.holds else "red"
    return (
        f"[{colour}]{'agrees' if agreement.holds else 'disagrees'}[/]: "
        f"{outcome[agreement.same_outcome]}; objects up to {agreement.objects_mm:.2f} mm and "
        f"{agreement.objects_degrees:.2f} degrees apart, hands up to {agreement.hands_mm:.2f} mm "
        f"and {agreement.hands_degrees:.2f} degrees (bounds {BOUND_MM:g} mm, "
        f"{BOUND_DEGREES:g} degrees)"
    )


def _report(
    recording: Recording, session: Session, verification: Verification, console: Console
) -> None:
    """Prints the result of a replay and of the trial."""
    score = session.scorer.score
    console.print(verdict(verification), soft_wrap=True)
    if verification.exact and not verification.same_machine:
        console.print(f"[yellow]{elsewhere(verification)}; yet every state is equal[/]")
    if verification.agreement:
        console.print(_second_verdict(verification.agreement), highlight=False)
    if (
        not verification.exact
        and verification.compared
        and not verification.same_machine
        and recording.end
    ):
        score = TrialResult.from_json(recording.end["result"], str(recording.path)).score
    elif verification.complete and recording.end and score.status is Status.INPUT_ENDED:
        # A person or a study's limit ended the trial: only the recorded end has the reason.
        score = TrialResult.from_json(recording.end["result"], str(recording.path)).score
    if not verification.same_machine:
        shown = (
            "the recorded poses"
            if verification.shown_recorded
            else "the poses simulated here, since the recording has none"
        )
        console.print(f"shown: {shown}")
    if verification.diverged:
        console.print(f"[yellow]the simulation diverged: {verification.diverged}[/]")
    how = ending(score.status, score.success)
    console.print(f"{session.task.name}: {how} after {score.time:.1f} s")
