"""`sandbox replay`: plays a recording again, and checks every state."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console
from rich.progress import Progress

from sandbox.cli.films import open_film
from sandbox.cli.parse import parse
from sandbox.headless import View
from sandbox.messages import Snapshot
from sandbox.recorded_poses import recorded_score
from sandbox.recording import load_recording
from sandbox.replay import replay
from sandbox.session import Session

ELSEWHERE = "it was made with other versions or on another kind of processor"


@dataclass(frozen=True)
class ReplayOptions:
    """Plays a recording again and compares each state with the recorded one, hash by hash.

    Exit status 1 means that a state differs although versions and processor are the recording's.
    """

    file: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="FILE")]
    """A recording, made with --record."""

    film: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Draws a film: .webp, .gif, or .mp4 with the extra `film`."""


def main(argv: list[str]) -> int:
    """Runs `sandbox replay ...`."""
    options = parse(ReplayOptions, "sandbox replay", argv)
    console = Console()
    recording = load_recording(options.file)
    if recording.damage:
        console.print(f"[yellow]{options.file}: {recording.damage}[/]")
    steps = recording.end["step"] if recording.end else None
    with ExitStack() as closing:
        progress = closing.enter_context(Progress(console=console, transient=True))
        bar = progress.add_task("replaying", total=steps)

        def show(snapshot: Snapshot) -> None:
            progress.update(bar, completed=snapshot.step)

        def make_views(session: Session) -> list[View]:
            if options.film is None:
                return [show]
            # Who played is told by the recording; a film of a simulated user has to say so.
            caption = "simulated user" if recording.header.get("user") else ""
            return [show, closing.enter_context(open_film(options.film, session, caption)).show]

        session, found = replay(recording, make_views)
    score = session.scorer.score
    if found.exact:
        whole = "" if found.complete else ", up to where it breaks off"
        console.print(f"[green]exact[/]: {found.compared} states equal to the bit{whole}")
        if not found.same_machine:
            console.print(f"[yellow]{ELSEWHERE}; every state is the same here all the same[/]")
    elif found.compared == 0:
        console.print("[yellow]nothing to compare: it holds no input[/]")
    elif found.same_machine:
        console.print(f"[red]differs[/] from physics step {found.first_difference} on")
    else:
        console.print(
            f"[yellow]differs[/] from physics step {found.first_difference} on, as it may: "
            + ELSEWHERE
        )
        if recording.end:
            score = recorded_score(recording.end["result"])
    if not found.same_machine:
        shown = "its recorded poses" if found.shown_recorded else "what is simulated here"
        why = "" if found.shown_recorded else ", since an older version recorded no poses"
        console.print(f"shown: {shown}{why}")
    if found.diverged:
        console.print(f"[yellow]the simulation diverged: {found.diverged}[/]")
    console.print(f"{session.task.name}: {score.status.value} after {score.time:.1f} s")
    return 1 if found.first_difference is not None and found.same_machine else 0
