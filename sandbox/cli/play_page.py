"""Play on the page: one trial after another, as the person on it asks."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from rich.console import Console

from models.errors import InputError
from sandbox.assembly import build
from sandbox.cli.latency import judge_latency, say_latency
from sandbox.cli.page_options import PageOptions, open_page
from sandbox.cli.room import in_plain_words
from sandbox.cli.run import report_dump
from sandbox.cli.scene_options import Plan, SceneOptions, plan
from sandbox.cli.second_view import invite, publish, show_session
from sandbox.devices.web import WebDevice
from sandbox.events import EventLog, NoticeEvents
from sandbox.headless import looking_beside, trial_header
from sandbox.keeping import Keeping
from sandbox.live import LiveSession
from sandbox.messages import Snapshot
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import Ask, Screen
from sandbox.session import Session
from sandbox.settings import RunSettings
from sandbox.timing import Timing, timed
from sandbox.two_hands import with_first
from tasks.registry import TASKS
from tasks.score import result_line

TICK = 0.02
"""s between two looks at what the person wants."""

LARGEST = (10.32, 7.74)
"""in, of the touch rectangle: that of the largest tablets. On a larger screen it lies in the
middle, since a hand reaches no further."""


@dataclass
class Wishes:
    """What the person wants of the next trial, and of this one.

    Attributes:
        task: Name.
        hand: `right` or `left`.
        trial: How many trials there were.
        again: A new trial is wanted.
        paused: Time is to stand still.
        seated: How often another page had become the player's when this trial was laid out.
    """

    task: str
    hand: str
    trial: int = 0
    again: bool = False
    paused: bool = False
    seated: int = 0

    def hear(self, asks: list[Ask]) -> None:
        """Takes in what was asked; what makes no sense is passed over."""
        for ask in asks:
            match ask.what:
                case "retry":
                    self.again = True
                case "task" if ask.value in TASKS:
                    self.task, self.again = ask.value, True
                case "hand" if ask.value in ("right", "left"):
                    self.hand, self.again = ask.value, True
                case "pause" | "resume":
                    self.paused = ask.what == "pause"


@dataclass(frozen=True)
class PagePlay:
    """A server and what its trials are made from."""

    options: SceneOptions
    server: PageServer
    events: EventLog
    console: Console
    latest: dict[str, Any] = field(default_factory=dict)

    def run(self) -> None:
        """Trials until the program is interrupted."""
        first = plan(self.options).settings
        wishes = Wishes(first.task, first.hand)
        while not self.server.wait_for_player(TICK * 10):
            pass
        while True:
            self._trial(wishes)
            wishes.trial += 1
            while not wishes.again:
                self._hear(wishes)
                time.sleep(TICK)
            wishes.again = wishes.paused = False

    def _hear(self, wishes: Wishes) -> None:
        """What the page wants; on the screen of somebody else, a trial is laid out anew."""
        wishes.hear(self.server.asked())
        if self.server.seated != wishes.seated:
            wishes.again, wishes.paused = True, False

    def _trial(self, wishes: Wishes) -> None:
        wishes.seated = self.server.seated
        chosen = self._chosen(wishes)
        record = self.options.record
        keeping = Keeping(
            trial_header(chosen.settings, chosen.about),
            numbered(record, wishes.trial) if record else None,
            self.options.dump,
        )
        timing = Timing(self.server.latency)
        try:
            make = chosen.make_device
            if chosen.live:
                make = with_first(make, lambda maker: timed(maker, timing))
            session = build(chosen.settings, make, keeping.recorder)
        except InputError as error:
            keeping.close()
            self._refuse(error, chosen.settings)
            return
        touched = _touched(chosen)
        live = LiveSession(
            session, self._on_step(session, timing), news=getattr(touched, "news", None)
        )
        self._show(session, chosen)
        # A person's time begins with their first touch: before, they look at the scene.
        waiting = touched is not None
        live.pause(waiting)
        live.start()
        try:
            while not live.over and not wishes.again:
                self._hear(wishes)
                waiting = waiting and touched is not None and not touched.touched
                live.pause(waiting or wishes.paused)
                if waiting or wishes.paused:
                    self.server.publish(session.snapshot(), True)
                time.sleep(TICK)
        finally:
            live.stop()
            result = keeping.end(session, latency=self.server.latency.as_json())
            keeping.close()
            session.close()
            # Told here, since most sessions on the page end by being interrupted.
            self.latest.update(result)
            self.events.tell("trial_end", **result)
        self.server.publish(session.snapshot())
        if live.failure:
            raise live.failure
        report_dump(result, self.console)
        self.console.print(
            result_line(
                session.task.name,
                result["status"],
                result["success"],
                result["time_s"],
                result["reason"],
            )
        )

    def _chosen(self, wishes: Wishes) -> Plan:
        chosen = plan(replace(self.options, record=None))
        settings = replace(
            chosen.settings,
            task=wishes.task,
            hand=wishes.hand,
            seed=chosen.settings.seed + wishes.trial,
        )
        if self.options.device == "web" and self.server.screen:
            shared = settings.second is not None and settings.second.shared
            settings = replace(settings, **rectangle(self.server.screen, 2 if shared else 1))
        return replace(chosen, settings=settings)

    def _show(self, session: Session, chosen: Plan) -> None:
        caption = "simulated user" if chosen.about.get("user") else ""
        show_session(self.server, session, chosen.settings.hand, caption, _touched(chosen))
        self.events.tell("trial_start", task=session.task.name, seed=session.task.seed)

    def _on_step(self, session: Session, timing: Timing) -> Any:
        notices = NoticeEvents(
            self.events, lambda notice: self.console.print(f"[yellow]{notice}[/]")
        )
        looking = getattr(session.rigs[0].device, "show", None)
        others = looking_beside(session)

        def on_step(snapshot: Snapshot) -> None:
            timing.stepped(snapshot)
            notices.show(snapshot)
            if looking:
                looking(snapshot)
            for look in others:
                look(snapshot)
            publish(self.server, session, snapshot)

        return on_step

    def _refuse(self, error: InputError, settings: RunSettings) -> None:
        """A task that this screen has no room for: said on the page; another can be chosen."""
        self.server.tell(in_plain_words(error, settings))
        self.events.tell("warning", what=str(error))
        self.console.print(f"[yellow]{error}[/]")


def play_on_page(
    options: SceneOptions, page: PageOptions, console: Console, limit: float | None = None
) -> int:
    """Serves the page until interrupted, then says how long touches took.

    Returns 1 where that was longer than `limit`, ms (see `judge_latency`); None sets none.
    """
    events = EventLog(options.events)
    server = open_page(page, touch=options.device == "web")
    try:
        invite(server, page, events, console)
        PagePlay(options, server, events, console).run()
    except KeyboardInterrupt:
        console.print("stopped")
    finally:
        server.close()
        say_latency(server.latency, console)
        say_refusals(server, console)
        events.close()
    return judge_latency(server.latency, limit, console)


def rectangle(screen: Screen, hands: int = 1) -> dict[str, Any]:
    """The touch rectangle of a screen, as settings: all of it, up to the largest tablet's.

    Two hands on it have the width of two tablets.
    """
    inches = (screen.width_px / screen.px_per_in, screen.height_px / screen.px_per_in)
    most = (hands * LARGEST[0], LARGEST[1])
    size = tuple(round(min(side, end), 4) for side, end in zip(inches, most, strict=True))
    return {"surface_in": size, "surface_calibrated": screen.calibrated}


def _touched(chosen: Plan) -> WebDevice | None:
    """What takes the page's touches, also where two hands share it."""
    return next((d for d in reversed(chosen.opened) if isinstance(d, WebDevice)), None)


def numbered(path: Path, trial: int) -> Path:
    """A second trial is another file: nothing recorded is ever written over."""
    return path if not trial else path.with_stem(f"{path.stem}-{trial + 1}")


def say_refusals(server: PageServer, console: Console) -> None:
    """What the server refused, by reason; nothing where it refused nothing."""
    refused = server.counters.as_dict()
    if refused:
        console.print("refused: " + ", ".join(f"{n} {reason}" for reason, n in refused.items()))
