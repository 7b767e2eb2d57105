"""`sandbox demo`: plays a recorded trial in a few seconds, without any device."""

from __future__ import annotations

import time
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from models.errors import HandSandboxError
from sandbox.cli.common.command_line import parse
from sandbox.recording.recorded_device import RecordedDevice
from sandbox.recording.recording import load_recording
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import build
from sandbox.trial.driver import LiveRun, Trial
from sandbox.trial.settings import recorded_settings
from sandbox.views.display import GraphicsError, has_display
from tasks.score import ending

FILM_RATE = 15
"""Pictures per second of the film."""

CAPTION = "simulated user"

_WORDS = {
    "away": "the user looks at the scene; the hand waits in the air",
    "waiting": "fingers touch the tablet: which finger is which?",
    "above": "fingers are labelled; the hand moves above its place, still a ghost",
    "coming down": "the hand comes down around the box",
    "down": "the hand follows the touches",
}


@dataclass(frozen=True, kw_only=True)
class DemoOptions:
    """Plays recorded touches of a simulated user, who drags a box to its goal.

    Labels, hand pose, physics and score are computed during playback. With a display, the demo
    plays in a window. At the end it prints the score, and writes a film and a picture.
    """

    out: Annotated[Path, Parameter(metavar="DIR")] = Path("sandbox-demo")
    """Folder for the film and the picture; existing ones are replaced."""

    view: Literal["auto", "window", "film", "none"] = "auto"
    """auto, window: a window if there is a display, then film and picture. film: film and picture
    only. none: only the score."""


def main(argv: list[str]) -> int:
    """Runs `sandbox demo`."""
    options = parse(DemoOptions, "sandbox demo", argv)
    console = Console()
    recording = load_recording(Path(str(files("sandbox") / "data" / "demo.jsonl")))
    console.print(
        "[bold]Hand Sandbox[/]: recorded touches of the [bold]simulated[/] user on a tablet; "
        "no person took part."
    )
    session = build(
        recorded_settings(recording.header),
        (lambda task, surface: RecordedDevice(recording),),
    )
    kept: list[Snapshot] = []
    length = recording.end["step"] * session.scene.spec.timestep if recording.end else None
    shown = options.view in ("auto", "window") and has_display() and _live(session, kept, console)
    if not session.over and not shown:
        _headless(session, kept, console, length)
    score = session.scorer.score
    colour = "green" if score.success else "red"
    how = ending(score.status, score.success)
    console.print(
        f"[bold {colour}]{session.task.name}: {how}[/] after {score.time:.1f} s"
        + (f", {score.reason}" if score.reason else ", placed and let go")
    )
    if options.view != "none" and kept:
        _pictures(session, kept, options.out, console)
    console.print("Next: [bold]sandbox[/] lists all commands, tasks and devices.")
    return 0


def _keep(kept: list[Snapshot], snapshot: Snapshot) -> None:
    """Keeps a snapshot if the next picture of the film is due."""
    if not kept or snapshot.time >= kept[-1].time + 1.0 / FILM_RATE - 1e-9:
        kept.append(snapshot)


def _live(session: Session, kept: list[Snapshot], console: Console) -> bool:
    """Plays in a window in real time; returns False if no window can be opened."""
    from sandbox.views.window import Window

    surface = session.whole_surface
    try:
        window = Window(session.scene, surface, title="Hand Sandbox: demo", caption=CAPTION)
    except GraphicsError as error:
        console.print(f"[yellow]no window: {error}[/]")
        return False
    live = LiveRun(Trial(session, [lambda snapshot: _keep(kept, snapshot)]))
    with window:
        live.play(lambda: "" if window.pump(live.newest) else None, tick=0.0)
    return True


def _headless(
    session: Session, kept: list[Snapshot], console: Console, length: float | None
) -> None:
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    last = ""
    with Progress(*columns, console=console, transient=True) as progress:
        bar = progress.add_task("playing", total=length)

        def show(snapshot: Snapshot) -> None:
            nonlocal last
            _keep(kept, snapshot)
            progress.update(bar, completed=snapshot.time)
            phase = snapshot.hands[0].phase
            if phase != last:
                last = phase
                progress.console.print(f"[dim]{snapshot.time:5.2f} s[/]  {_WORDS[phase]}")

        Trial(session, [show]).run()


def _pictures(session: Session, kept: list[Snapshot], out: Path, console: Console) -> None:
    """Draws the film, and a picture of the box being dragged."""
    from sandbox.views.film import FilmView

    surface = session.whole_surface
    started = time.monotonic()
    try:
        out.mkdir(parents=True, exist_ok=True)
        film_path, picture_path = out / "demo.webp", out / "demo.png"
        held = [s for s in kept if s.hands[0].solid] or kept
        with (
            FilmView(film_path, session.scene, surface, fps=FILM_RATE, caption=CAPTION) as film,
            Progress(console=console, transient=True) as progress,
        ):
            for snapshot in progress.track(kept, description="drawing the film"):
                film.show(snapshot)
            film.picture(held[len(held) * 2 // 3], picture_path)
    except HandSandboxError as error:
        console.print(f"[yellow]no film: {error}[/]")
        return
    except OSError as error:
        console.print(f"[yellow]no film: {out} cannot be written ({error.strerror})[/]")
        return
    spent = time.monotonic() - started
    console.print(f"film     [bold]{film_path}[/] ({len(kept)} pictures, drawn in {spent:.1f} s)")
    console.print(f"picture  [bold]{picture_path}[/]")
