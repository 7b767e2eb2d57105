"""Trials on the participant's page."""

from __future__ import annotations

import time
from dataclasses import replace

import msgspec

from models.errors import StudyError
from models.surface import Surface
from sandbox.server.protocol.describe import describe_scene
from sandbox.server.protocol.rectangle import rectangle
from sandbox.server.protocol.skins import pack_skin
from sandbox.server.publishing import publish
from sandbox.server.web import WebDevice
from sandbox.session.session import Session
from sandbox.study.design.page_options import PageOptions
from sandbox.study.run.players import PlayedAttempt, RunningAttempt, TrialRequest
from sandbox.study.run.study_page import TICK, StudyPage, inches, lacks_room
from sandbox.trial.driver import View
from sandbox.trial.live import LiveTrial
from sandbox.trial.settings import RunSettings

AFTER = 1.2
"""s for which the end of a trial is seen."""
SILENCE = 1.0
"""s without a word that are written down; the page beats twice a second."""


class PagePlayer:
    """Plays on the page, at real time; implements `sandbox.study.run.players.TrialPlayer`.

    Args:
        page: The participant's.
        options: What is seen, and when time begins and stands still.
        language: The participant's.
    """

    def __init__(self, page: StudyPage, options: PageOptions, language: str) -> None:
        self._page, self._options, self._language = page, options, language

    def play(self, request: TrialRequest) -> PlayedAttempt:
        self._page.server.latency.reset()
        self._page.device = None  # trials over a Leap have none
        attempt = RunningAttempt(request)
        try:
            with attempt.open(self._views) as trial:
                session = trial.session
                device = self._page.device
                live = LiveTrial(trial, news=device.news if device else None)
                watching = _PageClock(self._page, device, self._options)
                live.pause(True)
                self._show(session, request)
                live.start()
                try:
                    while not live.over and not attempt.broken:
                        still = watching.still(attempt)
                        live.pause(still)
                        if still:
                            self._page.server.publish(session.snapshot(), True)
                        time.sleep(TICK)
                finally:
                    live.stop()
                if live.failure:
                    raise live.failure
                played = attempt.end(trial, live.lost, watching.measures())
            self._page.server.publish(session.snapshot(), False)
            if not played.broken:
                time.sleep(AFTER)
            return played
        finally:
            self._page.wait()

    def close(self) -> None:
        """The page stays open: forms are on it, too."""

    def _show(self, session: Session, request: TrialRequest) -> None:
        server, scene = self._page.server, session.scene
        # The page is the first hand's, or that of both where they share its surface.
        surface = session.first_rig.reconstructor.surface
        side = request.settings.hands[0].side
        told = describe_scene(server.next_scene(), scene, session.task, surface, side, "")
        options, name = self._options, request.settings.task
        goal = options.goals.get(name, {}).get(self._language, told.goal)
        title = options.names.get(name, {}).get(self._language, _words(told.task))
        told = msgspec.structs.replace(told, task=title, goal=goal)
        apart = len(session.rigs) > 1 and not request.settings.one_surface
        skins = [pack_skin(hand) for hand in scene.spec.hands]
        server.show_scene(told, scene, self._page.device, skins, 0 if apart else None)
        self._page.reveal()

    def _views(self, session: Session) -> list[View]:
        return [lambda snapshot: publish(self._page.server, session, snapshot)]


class _PageClock:
    """Whether time stands still because nobody has touched yet, or the page is gone."""

    def __init__(self, page: StudyPage, device: WebDevice | None, options: PageOptions) -> None:
        self._page, self._device, self._options = page, device, options
        self._shown = time.monotonic()
        self._waiting = device is not None and options.starts == "touch"
        self._waited: float | None = None if self._waiting else 0.0
        self._away = 0.0
        self._last, self._times = self._shown, 0
        self._silent = self._halted = False

    def still(self, attempt: RunningAttempt) -> bool:
        """Whether time is to stand still now; may break the trial off."""
        self._page.look()
        self._pause(attempt.halted())
        now = time.monotonic()
        self._count(now)
        if self._page.gone:
            if self._options.when_gone == "repeat" and self._waited is not None:
                attempt.broken = attempt.broken or "the participant's page was gone"
            elif self._options.when_gone == "pause":
                self._waiting = True
        elif self._waiting and not self._halted and (not self._device or self._device.touched):
            self._waiting = False
            if self._waited is None:
                self._waited = now - self._shown
        return self._waiting or self._halted

    def _count(self, now: float) -> None:
        """Adds up how long the page said nothing."""
        silent = self._page.server.silence
        was, self._silent = self._silent, silent > SILENCE
        if self._silent:
            # The time that it took to notice counts as well.
            self._away += now - self._last if was else silent
            self._times += not was
        self._last = now

    def _pause(self, halted: bool) -> None:
        """Takes the scene out of sight while the experimenter pauses; then a touch goes on."""
        if halted == self._halted:
            return
        self._halted = halted
        if halted:
            self._waiting = True
            self._page.wait("paused")
        else:
            self._page.reveal()

    def measures(self) -> dict[str, float | int | None]:
        """s from the scene being seen to the first touch, and how long and often nothing was
        heard of the page meanwhile."""
        waited = None if self._waited is None else round(self._waited, 3)
        return {"waited_s": waited, "away_s": round(self._away, 3), "away": self._times}


def page_settings(page: StudyPage, settings: RunSettings, designed: bool) -> RunSettings:
    """A trial's settings on the screen that the participant has.

    Args:
        page: Open.
        settings: Of the design.
        designed: The design says how large the touch rectangle is; otherwise it is the screen.

    Raises:
        StudyError: There is no room for it on the screen.
    """
    screen = page.server.screen
    assert screen is not None, "the page is open"
    if not designed:
        hands = len(settings.hands) if settings.one_surface else 1
        return replace(settings, **rectangle(screen, hands))
    wanted = settings.surface_in
    if lacks_room(screen, wanted):
        raise StudyError(
            "the screen is too small for the design's touch rectangle",
            where="surface" if screen.calibrated else "surface; the screen was not measured",
            got=f"{inches(screen)} of screen",
            expected=f"{wanted[0]:g} x {wanted[1]:g} in",
            remedy="Turn it, use a larger one or a full screen, or leave `surface` out of the "
            "design; the session resumes at this trial",
        )
    return replace(settings, surface_calibrated=screen.calibrated)


def page_device(page: StudyPage, surface: Surface) -> WebDevice:
    """The device of a trial on the page."""
    return page.opened(WebDevice(surface, page.server.latency))


def _words(task: str) -> str:
    words = task.replace("-", " ").replace("_", " ")
    return words[:1].upper() + words[1:]
