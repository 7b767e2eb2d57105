"""Play in a window with a page beside it: one trial after another, as the player requests."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path
from textwrap import wrap

from rich.console import Console
from rich.markup import escape

from models.errors import InputError
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.wrappers.playing import FirstTouch, MergedDevice
from sandbox.play.own_profile import Learner
from sandbox.play.pages import (
    SIMULATED_USER,
    in_air,
    open_window_page,
    print_refusals,
    short_address,
    show_session,
    touched_pages,
)
from sandbox.play.player_requests import (
    Play,
    address_line,
    judge_latency,
    print_latency,
    report_end,
)
from sandbox.server.page_options import PageOptions
from sandbox.server.protocol import Pause
from sandbox.server.screen import CANNOT_BEGIN
from sandbox.server.web import PageDevice, WebDevice
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.system.ending import ending_as_by_ctrl_c
from sandbox.trial.assembly import (
    DeviceMaker,
    DeviceMakers,
    device_makers,
    is_live,
    with_first,
    with_lift,
)
from sandbox.trial.driver import LiveRun, open_trial
from sandbox.trial.logs import EventLog, LatencyLog, Timing, timed
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from sandbox.views.window import SIZE, Window
from sandbox.words import words_in
from tasks.score import Status
from tasks.task import Task, summary

WAITING = "time begins with your first touch"
WITH_MOUSE = "press 3 for a hand, drag beside it to move it; "
"""Hint for players with a mouse before the first touch."""
RATE_PERIOD = 0.5
"""Time (s) between two measurements of the rate of pictures."""
NOTABLE_DELAY = 0.05
"""Delay (s) behind real time above which the delay is shown."""
KNOB = "Here the keys up and down move the knob."
"""Line of the hint in tasks with a lift control."""
LINE = 60
"""Number of characters in a line of the hint."""


@dataclass
class Footer:
    """Texts at the bottom right: rate of pictures, lift, and the page's address."""

    address: str = ""
    _since: float = 0.0
    _pictures: int = 0
    _rate: str = ""

    def lines(self, window: Window, lost: float, session: Session) -> tuple[str, ...]:
        """Returns the current lines.

        Args:
            window: Window that drew the last picture.
            lost: Time that the session is behind real time, s.
            session: The session. The lift of its first hand is shown.
        """
        now = time.monotonic()
        if now - self._since >= RATE_PERIOD:
            rate = (window.pictures - self._pictures) / (now - self._since)
            self._since, self._pictures = now, window.pictures
            self._rate = f"{rate:.0f} pictures/s, {1000 * window.picture_time:.0f} ms each"
        texts = [self._rate]
        if lost > NOTABLE_DELAY:
            texts.append(f"{lost:.1f} s behind real time")
        # A hand in the air needs no lift control.
        reach = 0.0 if in_air(session) else 1000.0 * session.task.lift_range
        if reach > 0.0:
            texts.append(f"lifted {reach * (session.lift(0) or 0.0):.0f} of {reach:.0f} mm")
        if session.scorer.score.status is not Status.RUNNING:
            texts.append("r starts again")
        if self.address:
            texts.append(f"in a browser: {self.address}")
        return tuple(line for line in texts if line)


@dataclass
class WindowPlay(Play):
    """Play in a window, and on a page beside it if there is one; see `Play`.

    Attributes:
        share: True if touches on the page also move the hand.
        lan: True if the page is for a tablet; its QR code is shown until the tablet connects.
        latency: Latency log of all trials, shared with the page's server.
        window: The window; None until it is open.
    """

    share: bool = False
    lan: bool = False
    window: Window | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        self.latency = self.servers[0].latency if self.servers else LatencyLog()

    def run(self) -> None:
        """Runs trials until the window is closed."""
        requests = self.requests
        done = requests.task, requests.sides
        try:
            while True:
                # During a trial, `requests` changes to the task and hands of the next trial.
                playing = requests.task, requests.sides
                try:
                    go_on = self._trial()
                    done = playing
                except InputError as error:
                    if self.window is None or playing == done:
                        raise
                    # The page's request cannot be met: show this on the page, and continue.
                    self._refuse(str(error))
                    requests.task, requests.sides = done
                    go_on = True
                if not go_on:
                    return
                requests.next_trial()
        finally:
            if self.window is not None:
                self.window.close()

    def _trial(self) -> bool:
        """Plays one trial; returns True if another one is requested."""
        chosen = self.requests.applied_to(self.first_settings)
        timing = Timing(self.latency)
        self.latency.begin_trial()
        with open_trial(
            chosen,
            self._device_makers(chosen, timing),
            lambda session: self.make_views(session, timing),
            self.record,
            dump=self.options.dump,
        ) as trial:
            session = trial.session
            ended: list[TrialResult] = []

            def end() -> None:
                if ended:
                    return
                ended.append(trial.end(latency=self.latency.as_json()))
                # A program that reads the event of the end may then read the recording.
                trial.settle()
                self.events.write("trial_end", **ended[0].as_json())
                if self.learner is not None:
                    self.learner.after(session)

            try:
                window = self._open_window(session, chosen)
                live = LiveRun(trial, self.servers, window.speed)
                turns = _Turns(self, window, session, live, timing)
                self.requests.hands = (self._show_on_page(session, chosen),)
                live.play(turns.turn, end, tick=0.0, lingers=True)
            finally:
                end()
        self.notices.wait()
        report_end(ended[0], self.console)
        return turns.again

    @property
    def invitation(self) -> str:
        """The page's link while the program waits for a tablet; empty otherwise."""
        waiting = [s.url for s in self.servers if self.lan and not s.wait_for_player(0.0)]
        return waiting[0] if waiting else ""

    def _device_makers(self, chosen: Settings, timing: Timing) -> DeviceMakers:
        """Returns device makers. The first device has the page's touches and measures latency."""
        makers = device_makers(chosen)
        if self._waits(chosen):
            # This wrapper must be inside wrappers that delay or share touches, since they do not
            # run while simulated time stands still.
            makers = device_makers(chosen, _from_first_touch)
        makers = with_lift(makers, keys=True)

        def with_page(maker: DeviceMaker) -> DeviceMaker:
            def make_both(task: Task, surface: Surface) -> Device:
                return MergedDevice((maker(task, surface), WebDevice(surface)), kept=1)

            return make_both

        if self.share:
            makers = with_first(makers, with_page)
        # The offset between a Leap's clock and this machine's clock is unknown.
        if is_live(chosen) and not chosen.in_air:
            makers = with_first(makers, lambda maker: timed(maker, timing))
        return makers

    def _waits(self, chosen: Settings) -> bool:
        """True if time begins with the first touch, because a person plays with their fingers."""
        of_person = self.options.device != "simulated" and not Path(self.options.device).is_file()
        return is_live(chosen) and of_person and not chosen.in_air

    def _open_window(self, session: Session, chosen: Settings) -> Window:
        surface = session.whole_surface
        title = f"Hand Sandbox: {session.task.name}"
        caption = SIMULATED_USER if chosen.device.user is not None else ""
        if self.window is None:
            self.window = Window(session.scene, surface, title, SIZE, caption, in_air(session))
        else:
            self.window.show_scene(session.scene, surface, title, caption, in_air(session))
        self.window.attach(*(rig.device for rig in session.rigs))
        address = session.first_rig.device.address
        if address:
            self.console.print(address_line(address), soft_wrap=True)
            self.events.write("listening", address=address)
        self.events.write("trial_start", task=session.task.name, seed=session.task.seed)
        return self.window

    def _show_on_page(self, session: Session, chosen: Settings) -> int:
        """Shows the session on the page; returns the index of the page's hand."""
        if not self.servers:
            return 0
        caption = SIMULATED_USER if chosen.device.user is not None else ""
        # The page is for the second hand, or for touches beside the mouse.
        beside = session.first_rig.device.find(WebDevice)
        own, web = next(iter(touched_pages(session)), (0, beside))
        side = chosen.hands[own or 0].side
        show_session(self.servers[0], session, side, caption, web, own)
        return own or 0

    def _refuse(self, text: str) -> None:
        for server in self.servers:
            server.show_problem(CANNOT_BEGIN)
        self.events.write("warning", what=text)
        self.console.print(f"[yellow]{escape(text)}[/]")


class _Turns:
    """Turns of a live run in the window. Each turn draws a picture and handles keys and requests.

    Attributes:
        again: True if another trial is requested.
    """

    def __init__(
        self, play: WindowPlay, window: Window, session: Session, live: LiveRun, timing: Timing
    ) -> None:
        self._play, self._window, self._session = play, window, session
        self._live, self._timing = live, timing
        self._footer = Footer(short_address(play.servers[0]) if play.servers else "")
        self._seen: Snapshot | None = None
        self._waiting = _waiting(session)
        self._first = session.snapshot()
        """The snapshot to show before the first step."""
        goal = words_in("en").get(f"goal_{session.task.name}", summary(type(session.task)))
        window.goal, window.hint = goal, ()
        if self._waiting:
            lifts = (KNOB,) if session.task.lift_range > 0.0 else ()
            window.hint = hint_of(session.task.name) + lifts
            how = WITH_MOUSE if play.options.device == "mouse" else ""
            self._first = replace(self._first, notices=(how + WAITING,))
        self.again = False

    def turn(self) -> Pause | None:
        """Draws until the window is closed or another trial is requested; see `LiveRun.play`."""
        window, session, live = self._window, self._session, self._live
        requests = self._play.requests
        if not window.pump(live.newest or self._first):
            return None
        self._waiting = self._waiting and _waiting(session)
        if not self._waiting:
            window.hint = ()
        if window.seen is not None and window.seen is not self._seen:
            self._seen = window.seen
            self._timing.drawn(self._seen)
            self._play.latency.add("picture", 1000.0 * window.picture_time)
        for server in self._play.servers:
            requests.paused = window.paused
            requests.take(server.take_requests(), requests.hands[0])
            window.paused = requests.paused
        window.link = self._play.invitation
        window.footer = self._footer.lines(window, live.lost, session)
        live.set_speed(window.speed)
        if window.take_contact() and not live.over:
            session.set_contact(session.contact.next)
        if window.take_reset() or requests.again:
            self.again = True
            return None
        if self._waiting:
            return "start"
        return "menu" if window.paused else ""


def play_in_window(
    options: TrialOptions,
    page: PageOptions,
    limit: float | None,
    console: Console,
    learner: Learner | None = None,
) -> int:
    """Plays until the window is closed; returns 1 if latency exceeds the limit, else 0.

    Args:
        options: Options of the scene. If `web` is the second hand's device, the page is for this
            hand. Otherwise the page receives touches if the first device is the mouse, and only
            shows the session with any other device.
        page: Options of the page's server.
        limit: ms, see `judge_latency`; None sets no limit.
        console: Console for messages.
        learner: See `Play`.
    """
    events = EventLog(options.events)
    try:
        mouse, second = options.device == "mouse", options.second_device == "web"
        task = trial_settings(options).task
        server = open_window_page(page, mouse or second, events, console, task)
        share = server is not None and mouse and not second
        lan = page.tablet or page.lan is not None
        servers = () if server is None else (server,)
        play = WindowPlay(options, servers, events, console, learner, share, lan)
        try:
            with ending_as_by_ctrl_c():
                play.run()
        finally:
            if server:
                server.close()
                print_refusals(server, console)
            print_latency(play.latency, console)
    finally:
        events.close()
    return judge_latency(play.latency, limit, console)


def _from_first_touch(maker: DeviceMaker) -> DeviceMaker:
    return lambda task, surface: FirstTouch(maker(task, surface))


def hint_of(task: str) -> tuple[str, ...]:
    """Lines with the page's instructions for a task; general instructions for an external task."""
    words = words_in("en")
    return tuple(wrap(words.get(f"how_{task}", words["how_any"]), LINE))


def _waiting(session: Session) -> bool:
    """True as long as the person has not touched the surface yet."""
    person = session.first_rig.device.find(FirstTouch)
    begun = any(
        isinstance(device, PageDevice) and device.touched
        for rig in session.rigs
        for device in rig.device.within()
    )
    return person is not None and not person.came() and not begun
