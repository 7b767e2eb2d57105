"""Play on the page: one trial after another, as the person on it asks."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console

from models.errors import InputError
from models.person import HANDS
from sandbox.cli.common.latency import judge_latency, say_latency
from sandbox.cli.common.page_options import PageOptions, open_page
from sandbox.cli.common.second_view import invite, show_session, touched_pages
from sandbox.cli.play.screen_too_small import in_plain_words
from sandbox.cli.run import report_end
from sandbox.options.scene_options import Plan, SceneOptions, plan
from sandbox.server.page_server import PageServer
from sandbox.server.protocol.protocol import PlayerRequest
from sandbox.server.protocol.rectangle import common, rectangle
from sandbox.server.publishing import publish
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.device_makers import with_first
from sandbox.trial.driver import Trial, View, open_trial
from sandbox.trial.events import EventLog, NoticeEvents
from sandbox.trial.live import LiveTrial
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import RunSettings
from sandbox.trial.timing import Timing, timed
from tasks.registry import TASKS

TICK = 0.02
"""s between two looks at what the person wants."""

WAITED = 2.0
"""s that one of two pages is open before it is told that the other one is not."""


@dataclass
class Wishes:
    """The person's requests for this trial and the next one.

    Attributes:
        task: Name.
        sides: `right` or `left`, of every hand.
        trial: How many trials there were.
        again: A new trial is wanted.
        paused: Time is to stand still.
        seated: How often another page had become the player's when this trial was laid out.
    """

    task: str
    sides: tuple[str, ...]
    trial: int = 0
    again: bool = False
    paused: bool = False
    seated: int = 0

    @classmethod
    def of(cls, settings: RunSettings) -> Wishes:
        """The task and the hands of settings."""
        return cls(settings.task, tuple(hand.side for hand in settings.hands))

    def hear(self, asks: list[PlayerRequest], hand: int = 0) -> None:
        """Takes in what was asked on a hand's page; what makes no sense is passed over."""
        for ask in asks:
            match ask.what:
                case "retry":
                    self.again = True
                case "task" if ask.value in TASKS:
                    self.task, self.again = ask.value, True
                case "hand" if ask.value in HANDS:
                    self.sides = (*self.sides[:hand], ask.value, *self.sides[hand + 1 :])
                    self.again = True
                case "pause" | "resume":
                    self.paused = ask.what == "pause"

    def wanted(self, settings: RunSettings) -> RunSettings:
        """The settings with the wanted task and hands, and the seed of this trial."""
        hands = tuple(
            replace(hand, side=side) for hand, side in zip(settings.hands, self.sides, strict=False)
        )
        return replace(
            settings,
            task=self.task,
            hands=hands + settings.hands[len(hands) :],
            seed=settings.seed + self.trial,
        )


@dataclass(frozen=True)
class PagePlay:
    """A server and what its trials are made from.

    Attributes:
        options: Options of the scene.
        servers: Server of the page, or of every hand's page if hands have their own pages.
        events: Are told of trials.
        console: For words.
    """

    options: SceneOptions
    servers: tuple[PageServer, ...]
    events: EventLog
    console: Console

    def run(self) -> None:
        """Trials until the program is interrupted."""
        wishes = Wishes.of(plan(self.options).settings)
        self._wait_for_players()
        while True:
            self._trial(wishes)
            wishes.trial += 1
            while not wishes.again:
                self._hear(wishes)
                time.sleep(TICK)
            wishes.again = wishes.paused = False

    def _wait_for_players(self) -> None:
        """Until every page is open; who is there is told what is missing."""
        start, told = time.monotonic(), False
        while missing := [s for s in self.servers if not s.wait_for_player(0.0)]:
            time.sleep(TICK)
            if len(missing) < len(self.servers) and not told and time.monotonic() - start > WAITED:
                told = True
                for server in set(self.servers) - set(missing):
                    server.show_problem("The page of the other hand is not open yet.")
            elif len(missing) == len(self.servers):
                start = time.monotonic()

    def _hear(self, wishes: Wishes) -> None:
        """Handles the page's requests; for another person's screen, the trial is laid out again."""
        for hand, server in enumerate(self.servers):
            wishes.hear(server.asked(), hand)
        if self._seated != wishes.seated:
            wishes.again, wishes.paused = True, False

    @property
    def _seated(self) -> int:
        return sum(server.seated for server in self.servers)

    def _trial(self, wishes: Wishes) -> None:
        wishes.seated = self._seated
        chosen = self._chosen(wishes)
        record = self.options.record
        timing = Timing(self.servers[0].latency)
        makers = chosen.makers
        if chosen.live:
            makers = with_first(makers, lambda maker: timed(maker, timing))
        ended: list[TrialResult] = []
        with ExitStack() as closing:
            # Told once the recording is closed, also where the person interrupts the program.
            closing.callback(self._tell_end, ended)
            try:
                trial = closing.enter_context(
                    open_trial(
                        chosen.settings,
                        makers,
                        lambda session: self._views(session, timing),
                        numbered(record, wishes.trial) if record else None,
                        chosen.about,
                        self.options.dump,
                    )
                )
            except InputError as error:
                self._refuse(error, chosen.settings)
                return
            self._play(trial, chosen, wishes, ended)
        report_end(ended[0], self.console)

    def _tell_end(self, ended: list[TrialResult]) -> None:
        for result in ended:
            self.events.tell("trial_end", **result.as_json())

    def _play(self, trial: Trial, chosen: Plan, wishes: Wishes, ended: list[TrialResult]) -> None:
        """Plays until the trial is over or another one is wanted; adds its result to `ended`."""
        session = trial.session
        touched = [device for _, device in touched_pages(session)]
        for device in touched:
            # Whichever page is touched, its step is made at once.
            device.news = touched[0].news
        # Fingers elsewhere, as over TUIO, are seen on the page, and are no later for that.
        hears = touched[0] if touched else session.first_rig.device
        live = LiveTrial(trial, news=hears.news)
        self._show(session, chosen)
        # A person's time begins with their first touch: before, they look at the scene.
        waiting = bool(touched)
        live.pause(waiting)
        live.start()
        try:
            while not live.over and not wishes.again:
                self._hear(wishes)
                waiting = waiting and not any(device.touched for device in touched)
                live.pause(waiting or wishes.paused)
                if waiting or wishes.paused:
                    for server in self.servers:
                        server.publish(session.snapshot(), True)
                time.sleep(TICK)
        finally:
            live.stop()
            ended.append(trial.end(latency=self.servers[0].latency.as_json()))
        for server in self.servers:
            server.publish(session.snapshot())
        if live.failure:
            raise live.failure

    def _chosen(self, wishes: Wishes) -> Plan:
        chosen = plan(replace(self.options, record=None))
        settings = wishes.wanted(chosen.settings)
        screens = [server.screen for server in self.servers if server.screen]
        if "web" in (self.options.device, self.options.second_device) and screens:
            hands = len(settings.hands) if settings.one_surface else 1
            settings = replace(settings, **common([rectangle(s, hands) for s in screens]))
        return replace(chosen, settings=settings)

    def _show(self, session: Session, chosen: Plan) -> None:
        caption = "simulated user" if chosen.about.get("user") else ""
        hands, touched = chosen.settings.hands, touched_pages(session)
        for k, server in enumerate(self.servers):
            own, device = touched[k] if k < len(touched) else (None, None)
            show_session(server, session, hands[own or 0].side, caption, device, own)
        self.events.tell("trial_start", task=session.task.name, seed=session.task.seed)

    def _views(self, session: Session, timing: Timing) -> list[View]:
        notices = NoticeEvents(
            self.events, lambda notice: self.console.print(f"[yellow]{notice}[/]")
        )

        def on_pages(snapshot: Snapshot) -> None:
            for server in self.servers:
                publish(server, session, snapshot)

        return [timing.stepped, notices.show, on_pages]

    def _refuse(self, error: InputError, settings: RunSettings) -> None:
        """A task that this screen has no room for: said on the page; another can be chosen."""
        for server in self.servers:
            server.show_problem(in_plain_words(error, settings))
        self.events.tell("warning", what=str(error))
        self.console.print(f"[yellow]{error}[/]")


def play_on_page(
    options: SceneOptions, page: PageOptions, console: Console, limit: float | None = None
) -> int:
    """Serves the page until interrupted, then says how long touches took.

    Returns 1 where that was longer than `limit`, ms (see `judge_latency`); None sets none.
    """
    hands = [options.device, options.second_device].count("web")
    sides = [hand.side for hand in plan(options).settings.hands]
    names = sides if len(set(sides)) == len(sides) else ["first", "second"]
    events, servers = EventLog(options.events), [open_page(page, touch=hands > 0)]
    try:
        if hands == 2:
            # Each hand's page is at an address of its own, so that a link says whose page it is.
            beside = replace(page, page_port=page.page_port and page.page_port + 1)
            servers.append(open_page(beside))
        for server, whose in zip(servers, names, strict=False):
            if hands == 2:
                console.print(f"for the {whose} hand:")
            invite(server, page, events, console)
        PagePlay(options, tuple(servers), events, console).run()
    except KeyboardInterrupt:
        console.print("stopped")
    finally:
        for server, whose in zip(servers, names, strict=False):
            server.close()
            if len(servers) > 1 and server.latency.percentiles():
                console.print(f"the {whose} hand's page:")
            say_latency(server.latency, console)
            say_refusals(server, console)
        events.close()
    return max(judge_latency(server.latency, limit, console) for server in servers)


def numbered(path: Path, trial: int) -> Path:
    """A second trial is another file: nothing recorded is ever written over."""
    return path if not trial else path.with_stem(f"{path.stem}-{trial + 1}")


def say_refusals(server: PageServer, console: Console) -> None:
    """Prints the server's refusals by reason, if there were any."""
    refused = server.counters.as_dict()
    if refused:
        console.print("refused: " + ", ".join(f"{n} {reason}" for reason, n in refused.items()))
