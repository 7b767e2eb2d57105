"""Views of a replayed trial in a window or on a page: in real time, with pause and jumps."""

from __future__ import annotations

import time
from collections.abc import Sequence

from rich.console import Console

from sandbox.play.pages import in_air, open_page, show_address, show_session
from sandbox.server.page_options import PageOptions
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.logs import EventLog
from sandbox.trial.replay import Playback

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
    from sandbox.views.window.keys import REPLAY_HELP
    from sandbox.views.window.window import Window

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
    """Shows the trial until the program is interrupted; the page can pause and restart it.

    Raises:
        DeviceError: The page cannot be served.
    """
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
