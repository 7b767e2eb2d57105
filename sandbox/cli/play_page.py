"""Play on the page: one trial after another, as the person on it asks."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from models.errors import InputError
from sandbox.assembly import build
from sandbox.cli.page_options import PageOptions, open_page
from sandbox.cli.run import report_dump
from sandbox.cli.scene_options import Plan, SceneOptions, plan
from sandbox.devices.web import WebDevice
from sandbox.events import EventLog, NoticeEvents
from sandbox.headless import trial_header
from sandbox.keeping import Keeping
from sandbox.live import LiveSession
from sandbox.messages import Snapshot
from sandbox.server.describe import describe_scene
from sandbox.server.invitation import code, hints
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import Ask, Screen
from sandbox.server.senses import senses
from sandbox.server.skins import pack_skin
from sandbox.session import Session
from tasks.registry import TASKS

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
    """

    task: str
    hand: str
    trial: int = 0
    again: bool = False
    paused: bool = False

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
                wishes.hear(self.server.asked())
                time.sleep(TICK)
            wishes.again = wishes.paused = False

    def _trial(self, wishes: Wishes) -> None:
        chosen = self._chosen(wishes)
        record = self.options.record
        keeping = Keeping(
            trial_header(chosen.settings, chosen.about),
            _numbered(record, wishes.trial) if record else None,
            self.options.dump,
        )
        try:
            session = build(chosen.settings, chosen.make_device, keeping.recorder)
        except InputError as error:
            keeping.close()
            self._refuse(error)
            return
        device = chosen.opened[-1]
        live = LiveSession(session, self._on_step(session, wishes), news=_news(device))
        self._show(session, chosen)
        # A person's time begins with their first touch: before, they look at the scene.
        waiting = isinstance(device, WebDevice)
        live.pause(waiting)
        live.start()
        try:
            while not live.over and not wishes.again:
                wishes.hear(self.server.asked())
                waiting = waiting and not device.touched
                live.pause(waiting or wishes.paused)
                if waiting or wishes.paused:
                    self.server.publish(session.snapshot(), True)
                time.sleep(TICK)
        finally:
            live.stop()
            result = keeping.end(session, latency=self.server.latency.as_json())
            keeping.close()
            session.close()
        self.server.publish(session.snapshot())
        if live.failure:
            raise live.failure
        self.latest.update(result)
        self.events.tell("trial_end", **result)
        report_dump(result, self.console)
        self.console.print(f"{session.task.name}: {result['status']} {result['reason']}")

    def _chosen(self, wishes: Wishes) -> Plan:
        chosen = plan(replace(self.options, record=None))
        settings = replace(
            chosen.settings,
            task=wishes.task,
            hand=wishes.hand,
            seed=chosen.settings.seed + wishes.trial,
        )
        if self.options.device == "web" and self.server.screen:
            settings = replace(settings, **rectangle(self.server.screen))
        return replace(chosen, settings=settings)

    def _show(self, session: Session, chosen: Plan) -> None:
        device = chosen.opened[-1]
        touched = device if isinstance(device, WebDevice) else None
        if touched:
            touched.latency = self.server.latency
        message = describe_scene(
            self.server.next_scene(),
            session.scene,
            session.task,
            session.rigs[0].reconstructor.surface,
            chosen.settings.hand,
            "simulated user" if chosen.about.get("user") else "",
        )
        skins = [pack_skin(hand) for hand in session.scene.spec.hands]
        self.server.show_scene(message, session.scene, touched, skins)
        self.events.tell("trial_start", task=session.task.name, seed=session.task.seed)

    def _on_step(self, session: Session, wishes: Wishes) -> Any:
        notices = NoticeEvents(
            self.events, lambda notice: self.console.print(f"[yellow]{notice}[/]")
        )
        looking = getattr(session.rigs[0].device, "show", None)

        def on_step(snapshot: Snapshot) -> None:
            notices.show(snapshot)
            if looking:
                looking(snapshot)
            self.server.publish(snapshot, senses=senses(session))

        return on_step

    def _refuse(self, error: InputError) -> None:
        """A task that this screen has no room for: said on the page; another can be chosen."""
        self.server.tell(str(error))
        self.events.tell("warning", what=str(error))
        self.console.print(f"[yellow]{error}[/]")


def play_on_page(options: SceneOptions, page: PageOptions, console: Console) -> int:
    """Serves the page until interrupted, then says how long touches took."""
    events = EventLog(options.events)
    server = open_page(page)
    try:
        host = page.page_host
        if page.tablet or page.lan:
            console.print(code(server.url), highlight=False, soft_wrap=True)
        console.print(f"open [bold]{server.url}[/]", soft_wrap=True, highlight=False)
        for hint in hints(host):
            console.print(f"[dim]{hint}[/]")
        events.tell("listening", address=server.url)
        PagePlay(options, server, events, console).run()
    except KeyboardInterrupt:
        console.print("stopped")
    finally:
        server.close()
        events.close()
        _say_latency(server, console)
    return 0


def rectangle(screen: Screen) -> dict[str, Any]:
    """The touch rectangle of a screen, as settings: all of it, up to the largest tablet's."""
    inches = (screen.width_px / screen.px_per_in, screen.height_px / screen.px_per_in)
    size = tuple(round(min(side, most), 4) for side, most in zip(inches, LARGEST, strict=True))
    return {"surface_in": size, "surface_calibrated": screen.calibrated}


def _news(device: object) -> Any:
    return getattr(device, "news", None)


def _numbered(path: Path, trial: int) -> Path:
    """A second trial is another file: nothing recorded is ever written over."""
    return path if not trial else path.with_stem(f"{path.stem}-{trial + 1}")


def _say_latency(server: PageServer, console: Console) -> None:
    found = server.latency.percentiles()
    names = {
        "waited": "touch received to step",
        "acknowledged": "frame sent to page received",
        "round_trip": "page to server and back",
        "drawn": "touch event to picture drawn",
    }
    if any(kind in found for kind in names):
        table = Table("latency (ms)", "n", "p50", "p95", "p99")
        for kind, name in names.items():
            if kind in found:
                p = found[kind]
                table.add_row(name, str(p.n), *(f"{v:.1f}" for v in (p.p50, p.p95, p.p99)))
        console.print(table)
        console.print("[dim]What the display adds after a picture is drawn is not measured.[/]")
    refused = server.counters.as_dict()
    if refused:
        console.print("refused: " + ", ".join(f"{n} {reason}" for reason, n in refused.items()))
