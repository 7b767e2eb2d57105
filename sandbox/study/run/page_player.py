"""Trials on the participant's page."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial

from models.errors import StudyError
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.play.demonstration import Demonstrator
from sandbox.play.pages import show_session
from sandbox.server.page_server import AutoPause
from sandbox.server.protocol import PageScreen, Pause
from sandbox.server.screen import common, rectangle
from sandbox.server.web import WebDevice
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.study.design.design import PageSettings
from sandbox.study.run.forms import task_hint, task_texts
from sandbox.study.run.players import PlayedAttempt, RunningAttempt, TrialRequest
from sandbox.study.run.study_page import StudyPage, inches, is_too_small, lift_size_note
from sandbox.trial.assembly import lifts
from sandbox.trial.driver import TICK, LiveRun, View
from sandbox.trial.logs import TimedDevice, Timing
from sandbox.trial.settings import Settings

AFTER, AFTER_WITH_RESULT = 1.2, 3.0
"""Times (s) for which the scene stays visible after a trial: without, and with its result."""
PATIENCE = 30.0
"""Longest time (s) for which a trial waits until its demonstration ends."""


class PagePlayer:
    """Runs trials on the page in real time; implements `sandbox.study.run.players.TrialPlayer`.

    Args:
        page: The participant's page. A page of the second hand may belong to it.
        options: Settings of trials on the page.
        language: Language of the participant.
    """

    def __init__(self, page: StudyPage, options: PageSettings, language: str) -> None:
        self._page, self._options, self._language = page, options, language

    def play(self, request: TrialRequest) -> PlayedAttempt:
        for page in self._page.pages:
            page.server.latency.begin_trial()
            page.device = None  # trials over a Leap have no device on the page
        attempt = RunningAttempt(request)
        try:
            with attempt.open(self._views) as trial:
                session = trial.session
                self._show(session, request)
                self._demonstrate(attempt, request)
                for page in self._trial_pages:
                    page.hide_sheet()
                clock = _PageClock(self._trial_pages, self._options)
                live = LiveRun(trial, [page.server for page in self._trial_pages])

                def turn() -> Pause | None:
                    pause = clock.pause(attempt, session)
                    return None if attempt.broken else pause

                live.play(turn)
                played = attempt.end(trial, live.lost, clock.measures())
            if not played.broken:
                time.sleep(AFTER_WITH_RESULT if "result" in self._options.shows else AFTER)
            return played
        finally:
            for page in self._page.pages:
                page.wait()

    def close(self) -> None:
        """Does nothing: the page stays open for forms."""

    @property
    def _trial_pages(self) -> list[StudyPage]:
        """The pages that show this trial: the participant's page, and any other that is touched."""
        return [page for page in self._page.pages if page is self._page or page.device]

    def _show(self, session: Session, request: TrialRequest) -> None:
        apart = len(session.rigs) > 1 and not request.settings.surface.shared
        for hand, page in enumerate(self._trial_pages):
            show_session(
                page.server,
                session,
                request.settings.hands[hand].side,
                device=page.device,
                own=hand if apart else None,
                texts=partial(self._texts, page, request.settings.task),
            )

    def _texts(self, page: StudyPage, key: str, name: str, goal: str) -> tuple[str, str, str]:
        title, goal = task_texts(self._options, key, name, goal, self._language, page.texts)
        return title, goal, task_hint(self._options, name, page.texts)

    def _demonstrate(self, attempt: RunningAttempt, request: TrialRequest) -> None:
        """Shows a demonstration, if the design has one and this is the first trial of its task."""
        due = "demo" in self._options.shows and request.first
        if not due or self._page.device is None or len(request.settings.hands) > 1:
            return
        server, sent = self._page.server, []

        def show(scene: int, message: bytes) -> None:
            server.show_demonstration(scene, message)
            sent.append(scene)

        demonstrator = Demonstrator(show)
        demonstrator.begin(request.settings, server.next_scene() - 1)
        end = time.monotonic() + PATIENCE
        try:
            while demonstrator.playing and time.monotonic() < end and not attempt.broken:
                attempt.check_pause()
                time.sleep(TICK)
        finally:
            demonstrator.stop()
        attempt.demonstrated = bool(sent)

    def _views(self, session: Session) -> list[View]:
        def on_pages(snapshot: Snapshot) -> None:
            for page in pages:
                page.server.publish(snapshot)

        pages = self._trial_pages
        return [on_pages]


class _PageClock:
    """Decides when simulated time stops, and measures how long a page was away.

    Time stops during a pause, and, depending on the settings of the page, before the first touch
    and while a page is away (`AutoPause`).
    """

    def __init__(self, pages: Sequence[StudyPage], options: PageSettings) -> None:
        self._pages, self._options = pages, options
        self._auto = AutoPause(
            [(page.server, page.device) for page in pages],
            begun=options.starts != "touch",
            stops=options.when_gone == "pause",
        )
        self._shown = time.monotonic()
        self._waited: float | None = 0.0 if self._auto.begun else None
        self._away = 0.0
        self._last, self._times = self._shown, 0
        self._was_away = self._paused = False
        self._seats = [(page.server.seated, page.server.screen) for page in pages]

    def pause(self, attempt: RunningAttempt, session: Session) -> Pause:
        """Reason why simulated time must stop now; empty if it may run.

        The attempt is broken off if another device becomes the page, or if the page is gone and the
        design repeats such attempts.
        """
        for page in self._pages:
            page.check_connection()
        self._follow_pause(attempt.check_pause())
        held = session.scorer.score.held
        pause = self._auto.check(session.time, held, self._paused)
        now = time.monotonic()
        if self._waited is None and (self._paused or self._auto.away):
            # The scene is not visible now, so this time does not count as waiting.
            self._shown += now - self._last
        if self._waited is None and self._auto.begun:
            self._waited = now - self._shown
        self._add_absence(now)
        gone = any(page.gone for page in self._pages)
        if gone and self._options.when_gone == "repeat" and self._waited is not None:
            attempt.broken = attempt.broken or "the participant's page was gone"
        if any(
            page.server.seated != seated and _is_another(page.server.screen, screen)
            for page, (seated, screen) in zip(self._pages, self._seats, strict=True)
        ):
            # The touch surface of this trial no longer exists.
            attempt.broken = attempt.broken or "another device became the participant's page"
        return pause

    def _add_absence(self, now: float) -> None:
        """Counts absences of pages, and adds up their duration."""
        was, self._was_away = self._was_away, bool(self._auto.away)
        if self._was_away:
            # An absence includes the silence after which a page counts as away.
            silence = max(self._pages[i].server.silence for i in self._auto.away)
            self._away += now - self._last if was else silence
            self._times += not was
        self._last = now

    def _follow_pause(self, paused: bool) -> None:
        """Hides the scene during a pause; after it, time starts with the next touch."""
        if paused == self._paused:
            return
        self._paused = paused
        for page in self._pages:
            if paused:
                page.wait("paused")
            else:
                page.hide_sheet()

    def measures(self) -> dict[str, float | int | None]:
        """Measures `waited_s`, `away_s` and `away`; see docs/measures.md."""
        waited = None if self._waited is None else round(self._waited, 3)
        return {"waited_s": waited, "away_s": round(self._away, 3), "away": self._times}


def settings_for_screen(page: StudyPage, settings: Settings, designed: bool) -> Settings:
    """Adapts the settings of a trial to the participant's screen.

    Args:
        page: The page, which must be open.
        settings: Settings from the design.
        designed: True if the design sets the size of the touch rectangle; else the screen's size
            is used.

    Raises:
        StudyError: The screen is too small for the touch rectangle.
    """
    screen = page.server.screen
    assert screen is not None, "the page is open"
    if screen.fit:
        raise StudyError(
            "a study cannot use a scaled table",
            where="the participant's page",
            got=f"a table that fills the screen of a {screen.fit}",
            expected="a table of true size",
            remedy="Open the study's own link again; the session resumes at this trial",
        )
    if not designed:
        hands = len(settings.hands) if settings.surface.shared else 1
        return settings.changed(**rectangle(screen, hands, lifts(settings)))
    wanted = settings.surface.size_in
    if is_too_small(screen, wanted, lifts(settings)):
        raise StudyError(
            "the screen is too small for the design's touch rectangle",
            where="surface" if screen.calibrated else "surface; the screen was not measured",
            got=f"{inches(screen)} of screen{lift_size_note(lifts(settings))}",
            expected=f"{wanted[0]:g} x {wanted[1]:g} in",
            remedy="Rotate the screen, use full screen or a larger screen, or remove `surface` "
            "from the design; the session resumes at this trial",
        )
    return settings.changed(calibrated=screen.calibrated)


def on_both_screens(settings: Settings, other: Settings) -> Settings:
    """The settings with a touch rectangle that fits on both screens.

    Args:
        settings: Settings fitted to the first screen.
        other: Settings fitted to the second screen.
    """
    sizes = [
        {"size_in": s.surface.size_in, "calibrated": s.surface.calibrated}
        for s in (settings, other)
    ]
    return settings.changed(**common(sizes))


def page_device(page: StudyPage, surface: Surface) -> Device:
    """Creates the device of a trial on the page, with a log of its latency."""
    return TimedDevice(page.use_device(WebDevice(surface)), Timing(page.server.latency))


def _is_another(now: PageScreen | None, before: PageScreen | None) -> bool:
    """True if a page is on another screen than before.

    A rotated screen is the same screen, as is one that has lost up to a fifth of its length or
    width to the browser's bars.
    """
    if now is None or before is None:
        return False
    sides = [sorted((s.width_px / s.px_per_in, s.height_px / s.px_per_in)) for s in (now, before)]
    return any(abs(a - b) > 0.2 * max(a, b) for a, b in zip(*sides, strict=True))
