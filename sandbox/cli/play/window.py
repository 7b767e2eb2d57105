"""Play in a window with a page beside it: one trial after another, as the player requests."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from models.errors import InputError
from models.surface import Surface
from sandbox.cli.common.latency import judge_latency, print_latency
from sandbox.cli.common.notices import NoticePrinter, address_line
from sandbox.cli.common.page_view import (
    SIMULATED_USER,
    in_air,
    open_page_beside_window,
    short_address,
    show_session,
    touched_pages,
)
from sandbox.cli.play.own_profile import Learner
from sandbox.cli.play.page import PlayerRequests, numbered, print_refusals
from sandbox.cli.run import report_end
from sandbox.devices.device import Device
from sandbox.devices.wrappers.first_touch import FirstTouch
from sandbox.devices.wrappers.merged import MergedDevice
from sandbox.options.page_options import PageOptions
from sandbox.options.scene_options import SceneOptions, scene_settings
from sandbox.server.page_device import PageDevice
from sandbox.server.page_server import PageServer
from sandbox.server.protocol.describe import summary
from sandbox.server.screen_too_small import CANNOT_BEGIN
from sandbox.server.web import WebDevice
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.system.ending import ending_as_by_ctrl_c
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers, with_first
from sandbox.trial.driver import View, open_trial
from sandbox.trial.events import EventLog, NoticeEvents
from sandbox.trial.latency import LatencyLog, Timing, timed
from sandbox.trial.lift import with_lift
from sandbox.trial.live import LiveTrial
from sandbox.trial.open_devices import device_makers, is_live
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from sandbox.views.window.window import SIZE, Window
from tasks.score import Status
from tasks.task import Task

WAITING = "time begins with your first touch"
WITH_MOUSE = "press 3 for a hand, drag beside it to move it; "
"""Hint for players with the mouse, before the first touch."""
RATE_PERIOD = 0.5
"""s between two measurements of the rate of pictures."""
NOTABLE_DELAY = 0.05
"""s behind real time from which the delay is shown."""


@dataclass
class Footer:
    """Texts at the bottom right: speed of drawing, lift, and the page's address."""

    address: str = ""
    _since: float = 0.0
    _pictures: int = 0
    _rate: str = ""

    def lines(self, window: Window, lost: float, session: Session) -> tuple[str, ...]:
        """Returns the current lines.

        Args:
            window: Window that drew the last picture.
            lost: s that the session is behind real time.
            session: Session, whose first hand may be lifted.
        """
        now = time.monotonic()
        if now - self._since >= RATE_PERIOD:
            rate = (window.pictures - self._pictures) / (now - self._since)
            self._since, self._pictures = now, window.pictures
            self._rate = f"{rate:.0f} pictures/s, {1000 * window.picture_time:.0f} ms each"
        texts = [self._rate]
        if lost > NOTABLE_DELAY:
            texts.append(f"{lost:.1f} s behind real time")
        # A hand in the air lifts itself.
        reach = 0.0 if in_air(session) else 1000.0 * session.task.lift_range
        if reach > 0.0:
            texts.append(f"lifted {reach * (session.lift(0) or 0.0):.0f} of {reach:.0f} mm")
        if session.scorer.score.status is not Status.RUNNING:
            texts.append("r starts again")
        if self.address:
            texts.append(f"in a browser: {self.address}")
        return tuple(line for line in texts if line)


@dataclass
class WindowPlay:
    """Play in a window, and on a page beside it if there is one.

    Attributes:
        options: Options of the scene.
        server: Server of the page; None without a page.
        share: True if touches on the page also move the hand.
        lan: True if the page is for a tablet, whose QR code is shown until it connects.
        events: Log of events.
        console: Console for messages.
        latency: Latency log of all trials.
        learner: Keeps layouts of five fingers in the player's profile; None keeps none.
        window: The window; None until it is open.
    """

    options: SceneOptions
    server: PageServer | None
    share: bool
    lan: bool
    events: EventLog
    console: Console
    latency: LatencyLog
    learner: Learner | None = None
    window: Window | None = None

    @cached_property
    def _notices(self) -> NoticePrinter:
        return NoticePrinter(self.console)

    def run(self) -> None:
        """Runs trials until the window is closed."""
        first = scene_settings(replace(self.options, record=None))
        wishes = PlayerRequests.of(first)
        done = wishes.task, wishes.sides
        try:
            while True:
                # The trial hears what the next one shall be.
                playing = wishes.task, wishes.sides
                try:
                    go_on = self._trial(wishes)
                    done = playing
                except InputError as error:
                    if self.window is None or playing == done:
                        raise
                    # The page's request cannot be met: show why there, and continue.
                    self._tell(str(error))
                    wishes.task, wishes.sides = done
                    go_on = True
                if not go_on:
                    return
                wishes.trial += 1
                wishes.again = wishes.paused = False
        finally:
            if self.window is not None:
                self.window.close()

    def _trial(self, wishes: PlayerRequests) -> bool:
        """Plays one trial; returns True if another one is requested."""
        chosen = self._chosen(wishes)
        record = self.options.record
        # A second trial gets another file, so that no recording is overwritten.
        kept = numbered(record, wishes.trial) if record else None
        timing = Timing(self.latency)
        self.latency.begin_trial()
        with open_trial(
            chosen,
            self._device_makers(chosen, timing),
            lambda session: self._views(session, timing),
            kept,
            dump=self.options.dump,
        ) as trial:
            session = trial.session
            ended: list[TrialResult] = []

            def end() -> None:
                if not ended:
                    ended.append(trial.end(latency=self.latency.as_json()))
                    # Whoever hears of the end may read the recording.
                    trial.settle()
                    self.events.tell("trial_end", **ended[0].as_json())
                    if self.learner is not None:
                        self.learner.after(session)

            try:
                window = self._open_window(session, chosen)
                live = LiveTrial(trial, window.speed, session.first_rig.device.frame_ready)
                try:
                    wishes.hands = (self._show_on_page(session, chosen),)
                    live.pause(_waiting(session))
                    live.start()
                    again = self._watch(session, live, wishes, timing, end)
                finally:
                    live.stop()
            finally:
                end()
        if live.failure:
            raise live.failure
        self._notices.wait()
        report_end(ended[0], self.console)
        return again

    def _watch(
        self,
        session: Session,
        live: LiveTrial,
        wishes: PlayerRequests,
        timing: Timing,
        end: Callable[[], None],
    ) -> bool:
        """Draws until the window is closed (False) or another trial is requested (True).

        `end` keeps the trial's result once the trial is over: its last picture may stay for long.
        """
        window = self.window
        assert window is not None
        footer = Footer(short_address(self.server) if self.server else "")
        seen: Snapshot | None = None
        waiting = _waiting(session)
        # The snapshot to show before the first step.
        first = self._before(session) if waiting else session.snapshot()
        while window.pump(live.newest or first):
            if live.over and live.failure:
                # A picture that stands still would not tell the person.
                return False
            if live.over:
                end()
            waiting = waiting and _waiting(session)
            if window.seen is not None and window.seen is not seen:
                seen = window.seen
                timing.drawn(seen)
                self.latency.add("picture", 1000.0 * window.picture_time)
            if self.server:
                wishes.paused = window.paused
                wishes.hear(self.server.asked(), wishes.hands[0])
                window.paused = wishes.paused
                if (window.paused or waiting) and seen is not None:
                    self.server.publish(
                        session.snapshot() if waiting else seen, "start" if waiting else "menu"
                    )
            window.link = self.server.url if self.server and self._inviting() else ""
            window.footer = footer.lines(window, live.lost, session)
            live.pause(window.paused or waiting)
            live.set_speed(window.speed)
            if window.take_contact() and not live.over:
                session.set_contact(session.contact.next)
            if window.take_reset() or wishes.again:
                return True
        return False

    def _before(self, session: Session) -> Snapshot:
        """Snapshot before the first touch: the scene, the goal and instructions."""
        snapshot = session.snapshot()
        score = replace(snapshot.score, reason=summary(type(session.task)))
        how = WITH_MOUSE if self.options.device == "mouse" else ""
        return replace(snapshot, score=score, notices=(how + WAITING,))

    def _inviting(self) -> bool:
        """True while the program waits for a tablet."""
        return self.lan and self.server is not None and not self.server.wait_for_player(0.0)

    def _chosen(self, wishes: PlayerRequests) -> Settings:
        return wishes.wanted(scene_settings(replace(self.options, record=None)))

    def _device_makers(self, chosen: Settings, timing: Timing) -> DeviceMakers:
        """Returns device makers; the first adds the page's touches and measures latency."""
        makers = device_makers(chosen)
        if self._waits(chosen):
            # Beneath what makes touches late or shares them: neither works while no time passes.
            makers = device_makers(chosen, _from_first_touch)
        makers = with_lift(makers, keys=True)

        def beside_page(maker: DeviceMaker) -> DeviceMaker:
            def make_both(task: Task, surface: Surface) -> Device:
                return MergedDevice((maker(task, surface), WebDevice(surface)), kept=1)

            return make_both

        if self.share:
            makers = with_first(makers, beside_page)
        # The offset of a Leap's clock from this machine's is unknown.
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
            self.events.tell("listening", address=address)
        self.events.tell("trial_start", task=session.task.name, seed=session.task.seed)
        return self.window

    def _show_on_page(self, session: Session, chosen: Settings) -> int:
        """Returns the index of the hand that the page is for."""
        if self.server is None:
            return 0
        caption = SIMULATED_USER if chosen.device.user is not None else ""
        # The page is for the second hand, or for touches beside the mouse.
        beside = session.first_rig.device.find(WebDevice)
        own, web = next(iter(touched_pages(session)), (0, beside))
        side = chosen.hands[own or 0].side
        show_session(self.server, session, side, caption, web, own)
        return own or 0

    def _views(self, session: Session, timing: Timing) -> list[View]:
        notices = NoticeEvents(self.events, self._notices.say)
        views: list[View] = [timing.stepped, notices.show]
        if server := self.server:
            views.append(lambda snapshot: server.publish_step(session, snapshot))
        return views

    def _tell(self, text: str) -> None:
        if self.server:
            self.server.show_problem(CANNOT_BEGIN)
        self.events.tell("warning", what=text)
        self.console.print(f"[yellow]{escape(text)}[/]")


def play_in_window(
    options: SceneOptions,
    page: PageOptions,
    limit: float | None,
    console: Console,
    learner: Learner | None = None,
) -> int:
    """Plays until the window is closed; returns 1 if latency exceeds the limit, else 0.

    Args:
        options: Options of the scene. The page is for the second hand if that is its device. Else
            it takes touches beside the mouse, and only shows the session beside other devices.
        page: Options of the page's server.
        limit: ms, see `judge_latency`; None sets no limit.
        console: Console for messages.
        learner: See `WindowPlay`.
    """
    events = EventLog(options.events)
    try:
        mouse, second = options.device == "mouse", options.second_device == "web"
        server = open_page_beside_window(page, mouse or second, events, console)
        latency = server.latency if server else LatencyLog()
        share = server is not None and mouse and not second
        lan = page.tablet or page.lan is not None
        play = WindowPlay(options, server, share, lan, events, console, latency, learner)
        try:
            with ending_as_by_ctrl_c():
                play.run()
        finally:
            if server:
                server.close()
                print_refusals(server, console)
            print_latency(latency, console)
    finally:
        events.close()
    return judge_latency(latency, limit, console)


def _from_first_touch(maker: DeviceMaker) -> DeviceMaker:
    return lambda task, surface: FirstTouch(maker(task, surface))


def _waiting(session: Session) -> bool:
    """True while a person has not touched the surface yet."""
    person = session.first_rig.device.find(FirstTouch)
    begun = any(
        isinstance(device, PageDevice) and device.touched
        for rig in session.rigs
        for device in rig.device.within()
    )
    return person is not None and not person.came() and not begun
