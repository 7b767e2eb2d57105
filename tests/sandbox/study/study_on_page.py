"""What tests of sessions on the page share: a session in a thread, and hands on its page."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from models.surface import METRES_PER_INCH
from sandbox.devices.registry import DeviceSettings
from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.server.page_server import PageServer
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.study.record.folder import PILOT, Participant, StudyFolder
from sandbox.study.record.records import SCREEN
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.controls import Controls
from sandbox.study.run.page_forms import PageForms, measure_screens
from sandbox.study.run.page_player import PagePlayer
from sandbox.study.run.run_device import person_devices, settings_fitter
from sandbox.study.run.runner import SessionOutcome, SessionRunner
from sandbox.study.run.study_page import StudyPage, study_view
from sandbox.trial.driver import View
from tasks.user import UserConfiguration
from tests.support.page_client import Page
from tests.support.study_files import design, rows_of, state_of

PPI = 64.0
WIDTH, HEIGHT = 640, 480
KNOWN = {f"hand-sandbox:px-per-inch:{HEIGHT}x{WIDTH}@1": str(PPI), "hand-sandbox:quality": "3"}

SMALL = """
name = "on-page"
seed = 2
languages = ["en", "de"]
[settings]
task = "box-to-goal"
surface = "9.0x6.0in"
[[factors]]
name = "contact"
order = "between"
levels = ["hard"]
[trials]
practice = 1
practice_each = "contact"
time_limit_s = 20
shows = ["task", "goal", "time"]
[breaks]
every = 1
least_s = 1
[[tasks]]
task = "box-to-goal"
name = {en = "The box", de = "Die Kiste"}
goal = {en = "Push it home.", de = "Schieben Sie sie ans Ziel."}
[consent]
text = {en = "Do you agree?", de = "Sind Sie einverstanden?"}
[[instructions]]
text = {en = "Push the box.", de = "Schieben Sie die Kiste."}
[[demographics]]
name = "handedness"
kind = "choice"
choices = ["right", "left", "both"]
ask = {en = "Which hand do you write with?", de = "Mit welcher Hand schreiben Sie?"}
[[demographics]]
name = "age"
kind = "number"
low = 18
ask = {en = "How old are you?", de = "Wie alt sind Sie?"}
[[demographics]]
name = "tablets"
kind = "scale"
low = 1
high = 7
low_means = {en = "never", de = "nie"}
high_means = {en = "daily", de = "täglich"}
ask = {en = "How often do you use a tablet?", de = "Wie oft benutzen Sie ein Tablet?"}
[[demographics]]
name = "remarks"
kind = "text"
optional = true
ask = {en = "Anything else?", de = "Noch etwas?"}
[[questionnaires]]
name = "effort"
title = {en = "About what you have just done", de = "Zu dem, was Sie gerade getan haben"}
[[questionnaires.items]]
name = "effort"
kind = "scale"
step = 5
low_means = {en = "none", de = "keine"}
high_means = {en = "very much", de = "sehr viel"}
ask = {en = "How much effort was it?", de = "Wie viel Mühe war es?"}
"""


class Watched(PagePlayer):
    """Hands every moment of its trials to whoever touches the page."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.moments: SimpleQueue[tuple[Session, Snapshot]] = SimpleQueue()

    def _views(self, session: Session) -> list[View]:
        return [*super()._views(session), lambda snapshot: self.moments.put((session, snapshot))]


class OnPage:
    """A session that runs in a thread of its own.

    Attributes:
        said: What the experimenter was told.
        played: The last session whose end was seen.
    """

    def __init__(
        self,
        study: StudyFolder,
        person: Participant,
        server: PageServer,
        second: PageServer | None = None,
    ) -> None:
        self.study, self.person, self.server = study, person, server
        self.said: list[str] = []
        self.played: Session | None = None
        self.controls = Controls(self.said.append)
        self.outcome: SessionOutcome | None = None
        self.failure: BaseException | None = None
        self.pictures: dict[str, str] = {}
        language = person.language
        self.page = StudyPage(
            server, language, self.said.append, study.design.page.words.get(language)
        )
        if second is not None:
            self.page.beside = StudyPage(second, language, self.said.append, whose="the second")
        self.player = Watched(self.page, study.design.page, person.language)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    @property
    def folder(self) -> Path:
        return session_path(self.study.path, self.person.ppid)

    @property
    def state(self) -> SessionState:
        return state_of(self.folder)

    def rows(self, table: str) -> list[dict[str, str]]:
        """Rows of a table of the study."""
        return rows_of(self.study.path / "tables" / table)

    def type(self, line: str) -> None:
        """The experimenter types."""
        self.controls.type(line)

    def heard(self, words: str, seconds: float = 20.0) -> None:
        """Waits until the experimenter was told something."""
        end = time.monotonic() + seconds
        while not any(words in line for line in self.said):
            assert self.failure is None, self.failure
            assert time.monotonic() < end, f"never said: {words}; {self.said[-5:]}"
            time.sleep(0.02)

    def ended(self, seconds: float = 60.0) -> SessionOutcome:
        """Waits for the end."""
        self._thread.join(seconds)
        if self.failure is not None:
            raise self.failure
        assert self.outcome is not None, self.said[-5:]
        return self.outcome

    def stop(self) -> None:
        """Ends it, whatever it does."""
        self.type("q")
        self._thread.join(20.0)

    def _run(self) -> None:
        touch = DeviceSettings.of("web")
        two = self.page.beside is not None
        try:
            with SessionFolder(self.study, self.person) as session:
                for page in self.page.pages:
                    page.record = partial(session.write, SCREEN)
                self.outcome = SessionRunner(
                    session,
                    self.player,
                    person_devices(touch, self.person, self.page, second=touch if two else None),
                    PageForms(self.page, lambda: self.controls.paused),
                    self.controls,
                    self.said.append,
                    DeviceSettings.of("web"),
                    settings_fitter("web", self.page, "web" if two else ""),
                    second_device=DeviceSettings.of("web" if two else "simulated"),
                    before_step=partial(measure_screens, self.page),
                    picture_of=lambda task, poll: self.pictures.get(task, ""),
                ).run()
            self.page.show_sheet("end", text=self.page.texts["end"])
        except BaseException as error:
            self.failure = error


def touch(page: Page, x: float = 5.0, y: float = 3.0) -> None:
    """Touches the table of a page until time runs."""
    page.until("sheet", kind="none")
    page.touch((1, x, y))
    while page.until("frame")["time"] == 0.0:
        pass


def study_in(out: Path, text: str = SMALL) -> StudyFolder:
    return StudyFolder(out, design(text), PILOT)


@contextmanager
def on_page(study: StudyFolder, person: Participant, pages: int = 1) -> Iterator[OnPage]:
    """A session with a page of its own, or with one more for the second hand."""
    view = study_view(study.design.page, person.language)
    servers = [PageServer(study=view) for _ in range(pages)]
    session = OnPage(study, person, *servers)
    try:
        yield session
    finally:
        session.stop()
        for server in servers:
            server.close()


def play(running: OnPage, tab: Any, enough: Callable[[Snapshot], bool] = lambda s: False) -> None:
    """Simulated hands on the page's glass, until the trial is over or somebody has seen enough."""
    user: SimulatedDevice | None = None
    last: list[tuple[int, float, float]] = []
    begin = [(99, WIDTH - 40.0, 90.0)]  # time begins with a touch, wherever it is
    patience = 20
    tab.touch(begin)
    while True:
        try:
            session, snapshot = running.player.moments.get(timeout=1.0)
        except Empty:
            # A browser that was too busy to say anything was taken for gone.
            patience -= 1
            assert patience, f"time stands still: {running.said[-4:]}"
            tab.touch([])
            tab.touch(begin)
            last = begin
            continue
        if session is running.played:
            continue  # the rest of the trial before
        if user is None:
            surface = session.rigs[0].reconstructor.surface
            user = SimulatedDevice(session.task, UserConfiguration(fingers=3), surface, 0)
            corner = (WIDTH - surface.width_in * PPI) / 2, (HEIGHT - surface.height_in * PPI) / 2
        user.show(snapshot)
        frames = user.poll(snapshot.time)
        if session.over:
            running.played = session
        if session.over or enough(snapshot):
            tab.touch([])
            return
        if not running.player.moments.empty() or not frames:
            continue  # the browser is slower than time: only the newest counts
        scale = PPI / METRES_PER_INCH
        wanted = [
            (c.id, round(corner[0] + c.x * scale, 2), round(corner[1] + c.y * scale, 2))
            for c in frames[-1].contacts
        ]
        if wanted != last:
            tab.touch(wanted)
            last = wanted
