"""Play on browser pages: one trial after another, as the player requests."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from rich.console import Console
from rich.markup import escape

from models.errors import InputError
from models.message import Message
from sandbox.devices.registry import LIVE_HEADSET as LIVE
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.play.demonstration import Demonstrator
from sandbox.play.own_profile import Learner
from sandbox.play.pages import (
    SIMULATED_USER,
    open_page,
    print_refusals,
    show_address,
    show_session,
    touched_pages,
)
from sandbox.play.player_requests import (
    Play,
    can_choose_fingers,
    judge_latency,
    print_latency,
    report_end,
)
from sandbox.server.page_options import PageOptions
from sandbox.server.page_server import AutoPause
from sandbox.server.protocol import LIFT_STRIP_PX, Pause
from sandbox.server.screen import common, explain_refusal, rectangle, scaled
from sandbox.session.session import Session
from sandbox.system.ending import ending_as_by_ctrl_c
from sandbox.trial.assembly import device_makers, is_live, lifts, with_first
from sandbox.trial.driver import TICK, LiveRun, Trial, open_trial
from sandbox.trial.logs import EventLog, Timing, timed
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings

OTHER_PAGE_PATIENCE = 2.0
"""Time (s) after which one page shows that the page of the other hand is not open."""

OTHER_SIZE = 0.05
"""Smallest relative difference of size between a headset's hand and the drawn hand that is
reported."""

OTHER_PAGE = Message("other_page", "The page of the other hand is not open yet.")


@dataclass
class PagePlay(Play):
    """Play on one page, or on a separate page for each hand; see `Play`."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.demonstrator = Demonstrator(self.servers[0].show_demonstration)

    def run(self) -> None:
        """Runs trials until the program is interrupted."""
        try:
            self._wait_for_players()
            while True:
                self._trial()
                while not self.requests.again:
                    self._take_requests()
                    time.sleep(TICK)
                self.requests.next_trial()
        finally:
            self.demonstrator.stop()

    def _wait_for_players(self) -> None:
        """Waits until every page is open. An open page shows that the other page is missing."""
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

    def _take_requests(self) -> None:
        """Handles requests; a change of the player's screen starts a new trial."""
        for hand, server in zip(self.requests.hands, self.servers, strict=False):
            self.requests.take(server.take_requests(), hand)
        if self._seated != self.requests.seated:
            self.requests.again, self.requests.paused = True, False

    @property
    def _seated(self) -> int:
        return sum(server.seated for server in self.servers)

    def _trial(self) -> None:
        self.requests.seated = self._seated
        chosen = self._on_screens(self.requests.applied_to(self.first_settings))
        timing = Timing(self.servers[0].latency)
        for server in self.servers:
            server.latency.begin_trial()
        makers = device_makers(chosen)
        if is_live(chosen):
            makers = with_first(makers, lambda maker: timed(maker, timing))
        ended: list[TrialResult] = []
        with ExitStack() as closing:
            # The end is logged after the recording is closed, even when the program is interrupted.
            closing.callback(self._log_end, ended)
            try:
                trial = closing.enter_context(
                    open_trial(
                        chosen,
                        makers,
                        lambda session: self.make_views(session, timing),
                        self.record,
                        dump=self.options.dump,
                    )
                )
            except InputError as error:
                self._refuse(error, chosen)
                return
            self._play(trial, chosen, ended)
        self.notices.wait()
        report_end(ended[0], self.console)

    def _log_end(self, ended: list[TrialResult]) -> None:
        for result in ended:
            self.events.write("trial_end", **result.as_json())

    def _play(self, trial: Trial, chosen: Settings, ended: list[TrialResult]) -> None:
        """Plays until the trial ends or a new trial is requested; appends the result to `ended`."""
        session = trial.session
        touched = [device for _, device in touched_pages(session)]
        auto_pause = AutoPause(list(zip(self.servers, touched, strict=False)))
        self.requests.hands = self._show(session, chosen)
        scene, demonstrated = self.servers[0].next_scene() - 1, False

        def turn() -> Pause | None:
            nonlocal demonstrated
            self._take_requests()
            if self.requests.again:
                self.demonstrator.stop()
                return None
            if self.requests.demonstrate and not demonstrated and self._can_demonstrate(chosen):
                demonstrated = True
                self.demonstrator.begin(chosen, scene)
            pause = auto_pause.check(session.time, session.scorer.score.held)
            if pause == "away":
                # When a player returns to a page, its menu is closed.
                self.requests.paused = False
            elif self.requests.paused:
                return "menu"
            return pause

        def end() -> None:
            latency = self.servers[0].latency.as_json()
            counts = _counts(chosen)
            absent = auto_pause.listed() or None
            self._report_hand_size(session, chosen)
            ended.append(trial.end(latency=latency, absences=absent, **counts))
            if self.learner is not None:
                self.learner.after(session)

        LiveRun(trial, self.servers).play(turn, end)

    def _can_demonstrate(self, settings: Settings) -> bool:
        """True if all hands play by touch, and one page shows them.

        Only the first page has demonstrations.
        """
        touches = all(hand.in_air is None for hand in settings.hands)
        return self.options.device == "web" and touches and len(self.servers) == 1

    def _report_hand_size(self, session: Session, settings: Settings) -> None:
        """Prints the size of the headset's hand if the drawn hand has another size."""
        headset = session.first_rig.device.find(HeadsetDevice)
        seen = headset.hand_size if headset is not None else None
        if seen is not None and abs(seen / settings.hands[0].size - 1.0) > OTHER_SIZE:
            self.console.print(
                f"the headset measures a hand {seen:.2f} times as long as the average hand: "
                f"use `--hand-size {seen:.2f}` to draw a hand of this size"
            )

    def _on_screens(self, settings: Settings) -> Settings:
        """Returns the settings with a surface that fits the screens of the touched pages."""
        screens = [server.screen for server in self.servers if server.screen]
        if "web" in (self.options.device, self.options.second_device) and screens:
            hands = len(settings.hands) if settings.surface.shared else 1
            # A single page may scale the table to fill the screen. Two tablets show true sizes.
            alone = len(self.servers) == 1 and not settings.surface.shared
            if alone and screens[0].fit:
                return settings.changed(**scaled(screens[0], lifts(settings)))
            sizes = [rectangle(screen, hands, lifts(settings)) for screen in screens]
            settings = settings.changed(**common(sizes))
        return settings

    def _show(self, session: Session, chosen: Settings) -> tuple[int, ...]:
        """Shows the session on every page; returns each page's hand, by index."""
        caption = SIMULATED_USER if chosen.device.user else ""
        hands, touched = chosen.hands, touched_pages(session)
        shown = []
        for k, server in enumerate(self.servers):
            own, device = touched[k] if k < len(touched) else (None, None)
            side, scored = hands[own or 0].side, chosen.scored
            sets = chosen.pipeline.finger_sets if can_choose_fingers(chosen) else None
            show_session(server, session, side, caption, device, own, scored, finger_sets=sets)
            shown.append(own or 0)
        language = self.servers[0].language
        of_page = {"language": language} if language else {}
        self.events.write("trial_start", task=session.task.name, seed=session.task.seed, **of_page)
        return tuple(shown)

    def _refuse(self, error: InputError, settings: Settings) -> None:
        """Shows on the page why a task does not fit this screen; the player can choose another."""
        for server in self.servers:
            strip = LIFT_STRIP_PX / server.screen.px_per_in if server.screen else 0.0
            server.show_problem(*explain_refusal(error, settings, strip))
        self.events.write("warning", what=str(error))
        self.console.print(f"[yellow]{escape(str(error))}[/]")


def play_on_page(
    options: TrialOptions,
    page: PageOptions,
    console: Console,
    limit: float | None = None,
    learner: Learner | None = None,
) -> int:
    """Serves the page until interrupted, then prints the latency of touches.

    Args:
        options: Options of the trials.
        page: Options of the page.
        console: Console for addresses, results and latency.
        limit: Limit of the latency, ms (see `judge_latency`); None sets no limit.
        learner: See `Play`.

    Returns:
        Exit status: 1 if the latency exceeds the limit, else 0.
    """
    hands = [options.device, options.second_device].count("web")
    settings = trial_settings(options)
    sides = [hand.side for hand in settings.hands]
    names = sides if len(set(sides)) == len(sides) else ["first", "second"]
    headset = options.device == LIVE
    opened = partial(open_page, task=settings.task)
    servers = [opened(page, touch=hands > 0 or headset, headset=headset)]
    events = EventLog(options.events)
    try:
        if hands == 2:
            # Each hand has its own page, at its own address.
            second = replace(page, page_port=page.page_port and page.page_port + 1)
            servers.append(opened(second))
        for server, whose in zip(servers, names, strict=False):
            if hands == 2:
                console.print(f"for the {whose} hand:")
            show_address(server, page, events, console)
        if headset:
            port = servers[0].access.port
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
    """Fields of the result that depend on the scale of the table."""
    scale = settings.surface.scale
    return {
        "surface_scale": None if scale == 1.0 else round(scale, 4),
        "scored": None if settings.scored else False,
    }
