"""Play on the browser page: one trial after another, as the player requests."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape

from models.errors import InputError
from models.message import Message
from models.person import HANDS
from sandbox.cli.common.latency import judge_latency, print_latency
from sandbox.cli.common.notices import NoticePrinter
from sandbox.cli.common.open_page import open_page
from sandbox.cli.common.page_view import SIMULATED_USER, show_address, show_session, touched_pages
from sandbox.cli.play.own_profile import Learner
from sandbox.cli.run import report_end
from sandbox.devices.kinds import LIVE_HEADSET as LIVE
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.options.page_options import PageOptions
from sandbox.options.scene_options import SceneOptions, scene_settings
from sandbox.server.absences import Absences
from sandbox.server.page_server import PageServer
from sandbox.server.protocol.protocol import LIFT_STRIP_PX, PlayerRequest
from sandbox.server.protocol.rectangle import common, rectangle, scaled
from sandbox.server.screen_too_small import explain_refusal
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.system.ending import ending_as_by_ctrl_c
from sandbox.trial.device_makers import with_first
from sandbox.trial.driver import Trial, View, open_trial
from sandbox.trial.events import EventLog, NoticeEvents
from sandbox.trial.latency import Timing, timed
from sandbox.trial.lift import lifts
from sandbox.trial.live import LiveTrial
from sandbox.trial.open_devices import device_makers, is_live
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from tasks.registry import TASKS

TICK = 0.02
"""s between two checks of the player's requests."""

OTHER_PAGE_PATIENCE = 2.0
"""s after which the player on one of two pages is told that the other page is not open."""

OTHER_SIZE = 0.05
"""Share by which a hand in a headset has to differ from the drawn one for its person to be told."""

OTHER_PAGE = Message("other_page", "The page of the other hand is not open yet.")


@dataclass
class PlayerRequests:
    """The person's requests for this trial and the next one.

    Attributes:
        task: Name.
        sides: `right` or `left`, of every hand.
        trial: Number of trials so far.
        again: True if a new trial is requested.
        paused: True if the trial is to pause.
        seated: Count of changes of the player's page at the start of this trial.
        hands: Index of the hand of every page.
    """

    task: str
    sides: tuple[str, ...]
    trial: int = 0
    again: bool = False
    paused: bool = False
    seated: int = 0
    hands: tuple[int, ...] = (0, 1)

    @classmethod
    def of(cls, settings: Settings) -> PlayerRequests:
        """The task and the hands of settings."""
        return cls(settings.task, tuple(hand.side for hand in settings.hands))

    def hear(self, asks: list[PlayerRequest], hand: int = 0) -> None:
        """Applies the requests from the page of a hand; invalid ones are ignored."""
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

    def wanted(self, settings: Settings) -> Settings:
        """The settings with the wanted task and hands, and the seed of this trial."""
        hands = tuple(hand.on(side) for hand, side in zip(settings.hands, self.sides, strict=False))
        return replace(
            settings,
            task=self.task,
            hands=hands + settings.hands[len(hands) :],
            seed=settings.seed + self.trial,
        )


@dataclass(frozen=True)
class PagePlay:
    """Play on pages: their servers, and what the trials need.

    Attributes:
        options: Options of the scene.
        servers: Server of the page, or of every hand's page if hands have their own pages.
        events: Log of events.
        console: Console for messages.
        learner: Keeps layouts of five fingers in the player's profile; None keeps none.
    """

    options: SceneOptions
    servers: tuple[PageServer, ...]
    events: EventLog
    console: Console
    learner: Learner | None = None

    @cached_property
    def _notices(self) -> NoticePrinter:
        return NoticePrinter(self.console)

    def run(self) -> None:
        """Runs trials until the program is interrupted."""
        wishes = PlayerRequests.of(scene_settings(self.options))
        self._wait_for_players()
        while True:
            self._trial(wishes)
            wishes.trial += 1
            while not wishes.again:
                self._hear(wishes)
                time.sleep(TICK)
            wishes.again = wishes.paused = False

    def _wait_for_players(self) -> None:
        """Waits until every page is open; an open page is told if the other one is missing."""
        start, notified = time.monotonic(), False
        while missing := [s for s in self.servers if not s.wait_for_player(0.0)]:
            time.sleep(TICK)
            if (
                len(missing) < len(self.servers)
                and not notified
                and time.monotonic() - start > OTHER_PAGE_PATIENCE
            ):
                notified = True
                for server in set(self.servers) - set(missing):
                    server.show_problem(OTHER_PAGE)
            elif len(missing) == len(self.servers):
                start = time.monotonic()

    def _hear(self, wishes: PlayerRequests) -> None:
        """Handles requests; a change of the player's screen starts a new trial."""
        for hand, server in zip(wishes.hands, self.servers, strict=False):
            wishes.hear(server.asked(), hand)
        if self._seated != wishes.seated:
            wishes.again, wishes.paused = True, False

    @property
    def _seated(self) -> int:
        return sum(server.seated for server in self.servers)

    def _trial(self, wishes: PlayerRequests) -> None:
        wishes.seated = self._seated
        chosen = self._chosen(wishes)
        record = self.options.record
        timing = Timing(self.servers[0].latency)
        for server in self.servers:
            server.latency.begin_trial()
        makers = device_makers(chosen)
        if is_live(chosen):
            makers = with_first(makers, lambda maker: timed(maker, timing))
        ended: list[TrialResult] = []
        with ExitStack() as closing:
            # The end is logged after the recording is closed, even when the program is interrupted.
            closing.callback(self._tell_end, ended)
            try:
                trial = closing.enter_context(
                    open_trial(
                        chosen,
                        makers,
                        lambda session: self._views(session, timing),
                        numbered(record, wishes.trial) if record else None,
                        dump=self.options.dump,
                    )
                )
            except InputError as error:
                self._refuse(error, chosen)
                return
            self._play(trial, chosen, wishes, ended)
        self._notices.wait()
        report_end(ended[0], self.console)

    def _tell_end(self, ended: list[TrialResult]) -> None:
        for result in ended:
            self.events.tell("trial_end", **result.as_json())

    def _play(
        self, trial: Trial, chosen: Settings, wishes: PlayerRequests, ended: list[TrialResult]
    ) -> None:
        """Plays until the trial is over or a new one is requested; adds its result to `ended`."""
        session = trial.session
        touched = [device for _, device in touched_pages(session)]
        for device in touched:
            # A touch on any page triggers the next step at once.
            device.frame_ready = touched[0].frame_ready
        # Touches elsewhere, as over TUIO, are shown on the page without additional delay.
        hears = touched[0] if touched else session.first_rig.device
        live = LiveTrial(trial, frame_ready=hears.frame_ready)
        wishes.hands = self._show(session, chosen)
        absences = Absences(list(zip(self.servers, touched, strict=False)))
        live.pause(bool(touched))
        live.start()
        try:
            while not live.over and not wishes.again:
                self._hear(wishes)
                pause = absences.check(session.time, session.scorer.score.held)
                if pause == "away":
                    # A menu that was open on a page that was left is open no more.
                    wishes.paused = False
                elif wishes.paused:
                    pause = "menu"
                live.pause(bool(pause))
                if pause:
                    for server in self.servers:
                        # The thread may still be in its last step.
                        server.publish(live.newest or session.snapshot(), pause)
                time.sleep(TICK)
        finally:
            live.stop()
            latency = self.servers[0].latency.as_json()
            counts = _counts(chosen)
            absent = absences.listed() or None
            self._tell_size(session, chosen)
            ended.append(trial.end(latency=latency, absences=absent, **counts))
            if self.learner is not None:
                self.learner.after(session)
        for server in self.servers:
            server.publish(session.snapshot())
        if live.failure:
            raise live.failure

    def _tell_size(self, session: Session, settings: Settings) -> None:
        """Tells a person in a headset whose hand has another size than the drawn one."""
        headset = session.first_rig.device.find(HeadsetDevice)
        seen = headset.hand_size if headset is not None else None
        if seen is not None and abs(seen / settings.hands[0].size - 1.0) > OTHER_SIZE:
            self.console.print(
                f"the headset sees a hand {seen:.2f} times as long as the average one: "
                f"`--hand-size {seen:.2f}` draws it so"
            )

    def _chosen(self, wishes: PlayerRequests) -> Settings:
        options = replace(self.options, record=None)
        return self._fitted(wishes.wanted(scene_settings(options)))

    def _fitted(self, settings: Settings) -> Settings:
        """The settings with the surface of the pages that are touched."""
        screens = [server.screen for server in self.servers if server.screen]
        if "web" in (self.options.device, self.options.second_device) and screens:
            hands = len(settings.hands) if settings.surface.shared else 1
            if self._scaled(settings):
                size = scaled(screens[0], lifts(settings))
                return settings.changed(**size)
            sizes = [rectangle(screen, hands, lifts(settings)) for screen in screens]
            settings = settings.changed(**common(sizes))
        return settings

    def _scaled(self, settings: Settings) -> bool:
        """True if the only page fills itself with its table. Two tablets have one scale, the true
        one."""
        screen = self.servers[0].screen
        alone = len(self.servers) == 1 and not settings.surface.shared
        return alone and screen is not None and screen.fit != ""

    def _show(self, session: Session, chosen: Settings) -> tuple[int, ...]:
        """Returns the index of the hand that each page is for."""
        caption = SIMULATED_USER if chosen.device.user else ""
        hands, touched = chosen.hands, touched_pages(session)
        shown = []
        for k, server in enumerate(self.servers):
            own, device = touched[k] if k < len(touched) else (None, None)
            side, scored = hands[own or 0].side, chosen.scored
            show_session(server, session, side, caption, device, own, scored)
            shown.append(own or 0)
        language = self.servers[0].language
        said = {"language": language} if language else {}
        self.events.tell("trial_start", task=session.task.name, seed=session.task.seed, **said)
        return tuple(shown)

    def _views(self, session: Session, timing: Timing) -> list[View]:
        notices = NoticeEvents(self.events, self._notices.say)

        def on_pages(snapshot: Snapshot) -> None:
            for server in self.servers:
                server.publish_step(session, snapshot)

        return [timing.stepped, notices.show, on_pages]

    def _refuse(self, error: InputError, settings: Settings) -> None:
        """A task that this screen has no room for: said on the page; another can be chosen."""
        for server in self.servers:
            strip = LIFT_STRIP_PX / server.screen.px_per_in if server.screen else 0.0
            server.show_problem(*explain_refusal(error, settings, strip))
        self.events.tell("warning", what=str(error))
        self.console.print(f"[yellow]{escape(str(error))}[/]")


def play_on_page(
    options: SceneOptions,
    page: PageOptions,
    console: Console,
    limit: float | None = None,
    learner: Learner | None = None,
) -> int:
    """Serves the page until interrupted, then prints the latency of touches.

    Returns 1 if the latency exceeds `limit`, ms (see `judge_latency`); None sets no limit. For
    `learner` see `PagePlay`.
    """
    hands = [options.device, options.second_device].count("web")
    sides = [hand.side for hand in scene_settings(options).hands]
    names = sides if len(set(sides)) == len(sides) else ["first", "second"]
    headset = options.device == LIVE
    first = open_page(page, touch=hands > 0 or headset, headset=headset)
    events, servers = EventLog(options.events), [first]
    try:
        if hands == 2:
            # Each hand has a page at an address of its own.
            beside = replace(page, page_port=page.page_port and page.page_port + 1)
            servers.append(open_page(beside))
        for server, whose in zip(servers, names, strict=False):
            if hands == 2:
                console.print(f"for the {whose} hand:")
            show_address(server, page, events, console)
        if headset:
            port = first.access.port
            console.print(
                f"a headset on a USB cable: `adb reverse tcp:{port} tcp:{port}`, then open the "
                "link in its browser (docs/headset.md)",
                soft_wrap=True,
                highlight=False,
            )
        with ending_as_by_ctrl_c():
            PagePlay(options, tuple(servers), events, console, learner).run()
    except KeyboardInterrupt:
        console.print("stopped")
    finally:
        for server, whose in zip(servers, names, strict=False):
            server.close()
            if len(servers) > 1 and server.latency.percentiles():
                console.print(f"the {whose} hand's page:")
            print_latency(server.latency, console)
            print_refusals(server, console)
        events.close()
    return max(judge_latency(server.latency, limit, console) for server in servers)


def _counts(settings: Settings) -> dict[str, Any]:
    """Fields of the result of a table that is not of true size."""
    scale = settings.surface.scale
    return {
        "surface_scale": None if scale == 1.0 else round(scale, 4),
        "scored": None if settings.scored else False,
    }


def numbered(path: Path, trial: int) -> Path:
    """Returns the file of a trial: later trials get a number, so that no recording is
    overwritten."""
    return path if not trial else path.with_stem(f"{path.stem}-{trial + 1}")


def print_refusals(server: PageServer, console: Console) -> None:
    """Prints what the server refused or lost, by reason, if there was anything."""
    refused = server.counters.as_dict()
    if refused:
        console.print(
            "connections refused or lost: "
            + ", ".join(f"{n} {reason}" for reason, n in refused.items())
        )
