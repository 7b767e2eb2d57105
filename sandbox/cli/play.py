"""`sandbox play`: a task in a window, with the mouse or a tablet as fingers."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from rich.console import Console

from models.errors import InputError
from sandbox.assembly import build
from sandbox.cli.demo import has_display
from sandbox.cli.page_options import PageOptions
from sandbox.cli.parse import parse
from sandbox.cli.play_page import play_on_page
from sandbox.cli.run import report_dump
from sandbox.cli.scene_options import Plan, SceneOptions, plan
from sandbox.devices.lift_keys import with_lift
from sandbox.events import EventLog, NoticeEvents
from sandbox.headless import trial_header
from sandbox.keeping import Keeping
from sandbox.live import LiveSession
from sandbox.messages import Snapshot
from sandbox.profiles import DEFAULT, default_path, find_profile
from sandbox.views.window import Window


@dataclass(frozen=True)
class PlayOptions(PageOptions, SceneOptions):
    """Plays a task in a window with the mouse or a TUIO tablet, or on a page with your fingers.

    `sandbox play --tablet` prints a code: photograph it with a tablet, and play there. In the
    window, drag with the left button: one finger. Keys 1 to 5 put down a whole hand of so many
    fingers, and h shows all keys. r starts again, p pauses.
    """

    device: str = "mouse"
    """mouse, web (a page in a browser), tuio, simulated, or a file: a recording of ours, or a
    capture of TUIO packets."""

    view: Literal["window", "web"] = "window"
    """Where it is seen: in a window, or on a page, which --device web and --tablet imply."""

    def with_own_profile(self) -> PlayOptions:
        """The same, with this user's own profile where their own fingers touch."""
        other = self.profile is not None or self.device in ("mouse", "simulated")
        if other or Path(self.device).exists() or not default_path().exists():
            return self
        return replace(self, profile=DEFAULT)


def main(argv: list[str]) -> int:
    """Runs `sandbox play ...`."""
    options = parse(PlayOptions, "sandbox play", argv)
    if options.tablet or options.lan:
        options = replace(options, device="web")
    options = options.with_own_profile()
    console = Console()
    if options.device == "web" or options.view == "web":
        return play_on_page(options, options, console)
    if not has_display():
        raise InputError(
            "there is no display to open a window on",
            remedy="`sandbox run` does a task without one; on a remote machine try `xvfb-run`",
        )
    if options.profile not in (None, "none"):
        console.print(f"profile: {find_profile(str(options.profile)).line}")
    events = EventLog(options.events)
    window: Window | None = None
    again, trial = True, 0
    try:
        while again:
            chosen = plan(replace(options, record=None))
            if trial:
                seed = chosen.settings.seed + trial
                chosen = replace(chosen, settings=replace(chosen.settings, seed=seed))
            window, again = _trial(options, chosen, window, events, console, trial)
            trial += 1
    finally:
        if window is not None:
            window.close()
        events.close()
    return 0


def _trial(
    options: PlayOptions,
    chosen: Plan,
    window: Window | None,
    events: EventLog,
    console: Console,
    trial: int,
) -> tuple[Window, bool]:
    """One trial; returns the window and whether the person asked for another."""
    # A second trial is another file: nothing recorded is ever written over.
    record = options.record
    if record and trial:
        record = record.with_stem(f"{record.stem}-{trial + 1}")
    keeping = Keeping(trial_header(chosen.settings, chosen.about), record, options.dump)
    session = build(chosen.settings, with_lift(chosen.make_device, keys=True), keeping.recorder)
    device: Any = chosen.opened[-1]
    if window is not None:
        window.close()
    surface = session.rigs[0].reconstructor.surface
    simulated = chosen.about.get("user") is not None
    window = Window(
        session.scene,
        surface,
        title=f"Hand Sandbox: {session.task.name}",
        caption="simulated user" if simulated else "",
    )
    window.attach(session.rigs[0].device)
    address = getattr(device, "address", None)
    if address:
        console.print(f"listening for TUIO on [bold]{address}[/] (UDP)")
        events.tell("listening", address=address)
    events.tell("trial_start", task=session.task.name, seed=session.task.seed)
    notices = NoticeEvents(events, lambda notice: console.print(f"[yellow]{notice}[/]"))
    looking = getattr(device, "show", None)

    def on_step(snapshot: Snapshot) -> None:
        notices.show(snapshot)
        if looking:
            looking(snapshot)

    live = LiveSession(session, on_step)
    live.start()
    again = False
    try:
        while window.pump(live.newest):
            live.pause(window.paused)
            if window.take_contact():
                session.set_contact(session.contact.next)
            if window.take_reset():
                again = True
                break
    finally:
        live.stop()
        result = keeping.end(session)
        keeping.close()
        session.close()
    if live.failure:
        raise live.failure
    events.tell("trial_end", **result)
    report_dump(result, console)
    console.print(f"{session.task.name}: {result['status']} {result['reason']}")
    return window, again
